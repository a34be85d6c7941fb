"""Damping of a hull: linear in heave, pitch and roll, quadratic in surge and across, and lift at the stern.

Roll damping by components (`ikeda`) contains the sections' drag and the hull's lift; with it, the rate of roll adds
nothing to the cross-flow.

A hull that drifts under way is turned further by the water's pressure (Munk 1924, NACA report 184: the difference of
the added masses times both speeds), and held back by the lift of its after body, that of a slender body that ends in a
stern (Newman 1977, Marine Hydrodynamics, 7.9). With one alone it would turn on the spot, or hardly at all. The added
mass of a kind brings Munk's moment; for a kind without, it is here. The lift of model ships is (1 + 0.4 C_B B / T)
times that of a slender body (Clarke, Gedling & Hine 1983, Trans. RINA 125).
"""

from bisect import bisect_left
from collections.abc import Collection, Iterator
from math import copysign, pi, sqrt

import numpy as np

from ocean_sim.conventions import Motions
from ocean_sim.model import Model, quantity
from ocean_sim.ship.forces.roll_damping import Ikeda, RollDamping
from ocean_sim.ship.naval.hydrostatics import Hydrostatics

BY_RULE = {"heave": 0.12, "pitch": 0.06, "roll": 0.05}  # of critical: ours, of a bare hull of common form


class Damping(Model):
    """Shares of critical damping, and coefficients of drag; values that are null come by rule."""

    heave: float | None = quantity("1", None, ge=0.0)
    """Share of critical damping, mostly by the waves that the hull makes; null: 0.12, and 0 where `radiation` has
    heave."""
    pitch: float | None = quantity("1", None, ge=0.0)
    """Share of critical damping; null: 0.06, and 0 where `radiation` has pitch."""
    roll: float | None = quantity("1", None, ge=0.0)
    """Share of critical damping, mostly by eddies; null: 0.05, a mere guess for any hull, and 0 where `radiation`
    has roll or `ikeda` is given."""
    surge: float | None = quantity("N s2/m2", None, ge=0.0)
    """Resistance over the square of the speed; null: a coefficient of 0.1 on the largest section, and 0 where
    `radiation` has surge."""
    cross_flow: float = quantity("1", 0.8, ge=0.0)
    """Coefficient of drag of the sections as water crosses them (Hoerner 1965, Fluid-Dynamic Drag)."""
    roll_quadratic: float = quantity("N m s2", 0.0, ge=0.0)
    """Moment over the square of the roll rate."""
    ikeda: Ikeda | None = None
    """Damping of roll by friction, eddies, bilge keels, the hull's waves (not where `radiation` has roll) and lift, by
    regressions of its form; `{}` is a bare hull. Null: by `roll` and `roll_quadratic` alone."""


class Resistance:
    """Damping law of one hull: linear in heave, pitch and roll, quadratic in surge, cross-flow drag, and lift."""

    def __init__(
        self, config: Damping, hull: Hydrostatics, added: np.ndarray, radiated: Collection[str] = (), munk: float = 0.0
    ) -> None:
        """`added`: (6,) added mass that oscillates with the hull; `radiated`: motions whose wave damping a table gives,
        not the rules; `munk`: added mass of sway less surge [kg], for Munk's moment in kinds without added mass."""
        whole, stiffness = hull.inertia, hull.stiffness
        extra, self.radiated, self.cross_flow = Motions(*added), radiated, config.cross_flow
        self.linear: dict[str, float] = {}
        for motion in BY_RULE:
            inertia = whole[motion] + getattr(extra, motion)
            ruled = motion not in radiated and (motion != "roll" or config.ikeda is None)
            given = getattr(config, motion)
            share = (BY_RULE[motion] if ruled else 0.0) if given is None else given
            self.linear[motion] = 2.0 * share * sqrt(inertia * abs(stiffness[motion]))
        z, breadth, draught = hull.stations
        self.z = z - hull.matter.centre[2]
        crossing = 0.5 * hull.density * config.cross_flow * draught * float(hull.voxels.size[2])
        self.crossing = CrossFlow(self.z, crossing)
        section = float((breadth * draught).max())
        rule = 0.0 if "surge" in radiated else 0.05 * hull.density * section
        self.surge = rule if config.surge is None else config.surge
        self.roll = config.roll_quadratic
        self.low = hull.keel + float(draught.max()) / 2.0 - hull.matter.centre[1]  # where water crosses [m]
        ikeda = config.ikeda
        self.rolling = None if ikeda is None else RollDamping(ikeda, hull, extra.roll, "roll" not in radiated)
        self.rolled = self.low if self.rolling is None else 0.0  # what a rate of roll adds to it: the rest counts it
        self.stern = float(self.z[draught > 0.0].min())
        slender = pi / 2.0 * hull.density * float(draught.mean()) ** 2  # [kg/m] of a body that ends in a stern
        volume = min(hull.needed_volume, hull.voxels.volume)
        form_factor = volume / (hull.length * float(draught.max()) ** 2)  # C_B B / T
        self.lift = (1.0 + 0.4 * form_factor) * slender
        self.munk = munk
        self.warnings = [] if self.rolling is None else self.rolling.warnings
        if self.rolling is not None and config.roll:
            adds = f"damping.roll, {config.roll:g} of critical, adds to that of damping.ikeda"
            self.warnings = [*self.warnings, adds]

    def undamped_warnings(self, free: Collection[str]) -> Iterator[str]:
        """Yield warnings of `free` motions without damping, or damped by the radiation table's waves alone."""
        if "roll" in free and not (self.linear["roll"] or self.roll or self.rolling):
            left = "the waves of the table" if "roll" in self.radiated else "the drag of what crosses her"
            adds = "damping.ikeda: {} adds both by her form, damping.roll as a share of critical"
            yield f"roll is damped by {left} alone, without friction and eddies, so too little at resonance; {adds}"
        for motion in ("heave", "pitch"):
            if motion in free and motion not in self.radiated and not self.linear[motion]:
                yield f"nothing damps {motion}; damping.{motion} does, as a share of critical"
        if "surge" in free and not self.surge:
            waves = "but waves, which a steady speed does not make, " if "surge" in self.radiated else ""
            yield f"nothing {waves}holds her back in surge; damping.surge [N s2/m2] does"
        across = [motion for motion in ("sway", "yaw") if motion in free]
        if across and not self.cross_flow:
            yield f"damping.cross_flow is 0: a steady drift in {' and '.join(across)} meets no drag of her sections"

    def load(self, motion: np.ndarray) -> np.ndarray:
        """(2, 3) damping force [N] and torque [N m] at a velocity `motion` (6,) through the water, in the order of
        `Motions` (sway, heave, surge, pitch, yaw, roll) [m/s], [rad/s]; all in body axes."""
        sway, heave, surge, pitch, yaw, roll = motion.tolist()
        middle = sway - roll * self.rolled  # where water crosses amidships (4.15)
        crossed, crossed_turn = self.crossing.strip_drag(middle, yaw)
        lift = -self.lift * max(surge, 0.0) * (middle + yaw * self.stern)
        side = lift - crossed
        ikeda = 0.0 if self.rolling is None else self.rolling.roll_moment(roll, surge)  # [N m]
        force = side, -self.linear["heave"] * heave, -self.surge * abs(surge) * surge
        torque = (
            -self.linear["pitch"] * pitch,
            lift * self.stern - crossed_turn - self.munk * surge * sway,
            -side * self.low - (self.linear["roll"] + self.roll * abs(roll)) * roll + ikeda,
        )
        return np.array((force, torque))


class CrossFlow:
    """Cross-flow drag: sum of c w |w| over sections at z in a flow w = v + r z, by moments of c (sums of c z^k)."""

    def __init__(self, z: np.ndarray, c: np.ndarray) -> None:
        """`z`: positions (n,) of sections from stern to bow [m]; `c`: their drag coefficients (n,) [N s2/m2]."""
        self.z: list[float] = z.tolist()
        moments = np.cumsum(np.stack([c * z**k for k in range(4)], axis=1), axis=0)
        self.behind: list[list[float]] = [[0.0] * 4, *moments.tolist()]  # of how many sections, from the stern on

    def strip_drag(self, v: float, r: float) -> tuple[float, float]:
        """Drag [N] and its moment about z = 0 [N m] in a cross-flow v + r z, with v [m/s] and r [rad/s]."""
        astern = self.behind[bisect_left(self.z, -v / r)] if r else self.behind[0]
        way = copysign(1.0, r or v)  # of the water ahead of there
        c_0, c_1, c_2, c_3 = (way * (whole - 2.0 * part) for whole, part in zip(self.behind[-1], astern))
        vv, vr, rr = v * v, 2.0 * v * r, r * r
        return c_0 * vv + c_1 * vr + c_2 * rr, c_1 * vv + c_2 * vr + c_3 * rr
