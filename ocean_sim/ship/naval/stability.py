"""Stability of a loaded ship: righting levers, areas under them, flooding, and the criteria of the IMO.

Levers are those of a ship on even keel with free sinkage, to the side to which she heels by herself. The criteria are
those of IMO resolution A.749(18), 3.1.2, which the 2008 Intact Stability Code (MSC.267(85), A/2.2) keeps; no lever
counts beyond the heel at which water comes in. A tank that is not full costs metacentric height rho i / displacement, i
its surface's second moment, and that times sin(heel) of every lever.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, isinf, radians
from typing import NamedTuple

import numpy as np

from ocean_sim.model import Model, Vector3, quantity
from ocean_sim.ship.body.rigid_body import axis_rotation
from ocean_sim.ship.naval.hydrostatics import Hydrostatics, Matter

HEEL_STEP = 5.0  # [deg] between levers; a cubic goes through them
LAST_HEEL = 90.0  # [deg]
CURVE_POINTS = 901  # points of a curve
REST_HALVINGS = 12  # times that a step is halved to find a heel at rest
BEYOND_SIDES = ("abeam of the hull", "under the keel", "ahead or astern of the hull")  # along x, y and z
CROSS_HEELS = tuple(float(heel) for heel in range(10, 90, 10))  # [deg] of cross curves
LIST_TOLERANCE = 1e-3  # of the metacentric height: a lever upright, from which on a ship heels to one side
CROSS_SHARES = (0.4, 0.6, 0.8, 1.0, 1.2, 1.4)  # displacements of cross curves over the ship's own


class Weight(Model):
    """A weight on board."""

    mass: float = quantity("kg", gt=0.0)
    at: Vector3 = quantity("m")
    """Its centre from the hull's origin: x to port, y up, z to the bow."""


class Liquid(Weight):
    """The liquid in a tank."""

    length: float | None = quantity("m", None, gt=0.0)
    """Length of its free surface along the ship; null: it is full, or empty."""
    breadth: float | None = quantity("m", None, gt=0.0)
    """Breadth of its free surface across the ship."""
    density: float = quantity("kg/m3", 1000.0, gt=0.0)
    """Density of the liquid."""

    def contradictions(self) -> Iterator[str]:
        if (self.length is None) != (self.breadth is None):
            yield "a free surface has a length and a breadth; a tank that is full or empty has neither"

    @property
    def free_surface_moments(self) -> np.ndarray:
        """(2,) density times second moment of the free surface, across and along the ship [kg m]."""
        long, broad = self.length or 0.0, self.breadth or 0.0
        return self.density * np.array([long * broad**3, broad * long**3]) / 12.0


class Loading(Model):
    """A loading condition: a light ship and everything on board."""

    light: Weight
    """The ship itself."""
    weights: dict[str, Weight] = {}
    """Fixed weights."""
    tanks: dict[str, Liquid] = {}
    """Liquids."""
    openings: dict[str, Vector3] = {}
    """Openings through which water would come in, from the hull's origin [m]."""

    @property
    def matter(self) -> tuple[float, np.ndarray]:
        """Mass of ship and load [kg], and their centre (3,) from the hull's origin [m]."""
        parts = [self.light, *(of[name] for of in (self.weights, self.tanks) for name in sorted(of))]  # in one order
        mass = sum(part.mass for part in parts)
        return mass, np.sum([part.mass * np.array(part.at) for part in parts], axis=0) / mass

    @property
    def free_surface_loss(self) -> tuple[float, float]:
        """Loss of metacentric height [m] across and along the ship, by the free surfaces of all tanks."""
        moments = (self.tanks[name].free_surface_moments for name in sorted(self.tanks))
        across, along = sum(moments, np.zeros(2)) / self.matter[0]
        return float(across), float(along)

    def outside_hull(self, lower: np.ndarray, upper: np.ndarray) -> Iterator[str]:
        """Yield sentences on points beside or below the box of the hull, with corners `lower`, `upper` (3,) [m]."""
        low, high = np.array(lower), np.array([upper[0], inf, upper[2]])
        parts = {"light": self.light} | {f"weights.{name}": each for name, each in self.weights.items()}
        parts |= {f"tanks.{name}": each for name, each in self.tanks.items()}
        points = {name: part.at for name, part in parts.items()}
        points |= {f"openings.{name}": point for name, point in self.openings.items()}
        for what, point in points.items():
            out = np.maximum(low - point, point - high)
            if out.max() > 1e-9:
                yield f"{what} lies {out.max():.3g} m {BEYOND_SIDES[int(np.argmax(out))]}"
        for name, tank in self.tanks.items():
            for side, size in (("length", tank.length or 0.0), ("breadth", tank.breadth or 0.0)):
                whole = float(upper[2] - lower[2] if side == "length" else upper[0] - lower[0])
                if size > whole:
                    yield f"tanks.{name}.{side} is {size:g} m, more than the hull's {whole:g} m"


class Criterion(NamedTuple):
    """One stability criterion: value that the ship has, and least value required."""

    name: str
    value: float
    least: float
    unit: str

    @property
    def ok(self) -> bool:
        """True if the ship's value is at least the one required."""
        return self.value >= self.least


@dataclass(frozen=True)
class Stability:
    """Stability of a ship in still water, with openings through which water may come in."""

    still: Hydrostatics
    openings: Mapping[str, Vector3] | None = None  # from the hull's origin [m]

    @cached_property
    def gm(self) -> float:
        """Metacentric height [m], less the loss by free surfaces."""
        return self.still.metacentric_height()

    @cached_property
    def heeling_side(self) -> float:
        """Side to which the ship heels by herself: -1 for port, else 1 for starboard."""
        return -1.0 if self.still.gz(0.0) > LIST_TOLERANCE * abs(self.gm) else 1.0

    @cached_property
    def heels(self) -> np.ndarray:
        """(n,) heels [deg] to the side `heeling_side`."""
        return np.arange(0.0, LAST_HEEL + HEEL_STEP, HEEL_STEP)

    @cached_property
    def levers(self) -> np.ndarray:
        """(n,) righting levers GZ [m] at `heels`, less the loss by free surfaces."""
        return np.array([self.lever_at(heel) for heel in self.heels.tolist()])

    def lever_at(self, heel: float) -> float:
        """Righting lever GZ [m] at a heel [deg] to the side `heeling_side`."""
        return self.heeling_side * self.still.gz(self.heeling_side * heel)

    @cached_property
    def flooding_heel(self) -> tuple[float, str]:
        """Smallest heel up to 90 [deg], to either side, that floods an opening, and its name; infinite if none is."""
        found = (inf, "")
        for name, point in (self.openings or {}).items():
            for side in (1.0, -1.0):
                levels = [self.water_levels[side * heel] for heel in self.heels.tolist()]
                clear = [float(up @ np.array(point)) - level for up, level in levels]  # over the water [m]
                under = next((k for k, height in enumerate(clear) if height <= 0.0), None)
                if under is not None:
                    part = 0.0 if under == 0 else clear[under - 1] / (clear[under - 1] - clear[under])
                    found = min(found, (max(0.0, under - 1 + part) * HEEL_STEP, name))
        return found

    @cached_property
    def water_levels(self) -> dict[float, tuple[np.ndarray, float]]:
        """Water surface by heel [deg] to both sides: upward unit vector (3,), hull's axes, and height along it [m]."""
        heels = [side * heel for heel in self.heels.tolist() for side in (1.0, -1.0)]
        ups = {heel: axis_rotation(2, radians(heel))[1] for heel in heels}
        return {heel: (up, self.still.water_level(up)) for heel, up in ups.items()}

    @cached_property
    def curve(self) -> tuple[np.ndarray, np.ndarray]:
        """Heels (m,) [deg] and righting levers (m,) [m] on a cubic spline through `levers`."""
        from scipy.interpolate import CubicSpline

        fine = np.linspace(0.0, LAST_HEEL, CURVE_POINTS)
        return fine, CubicSpline(self.heels, self.levers)(fine)

    def lever_area(self, first: float, last: float) -> float:
        """Area [m rad] under the curve of righting levers between the heels `first` and `last` [deg]."""
        heels = np.linspace(first, last, CURVE_POINTS)
        return float(np.trapezoid(np.interp(heels, *self.curve), np.radians(heels)))

    @cached_property
    def rest_heel(self) -> float | None:
        """Heel [deg] of the ship at rest (list or loll): 0 if upright, None if no righting lever is above 0."""
        righted = np.flatnonzero(self.levers[1:] > 0.0)
        if not len(righted):
            return None
        low, high = self.heels[righted[0] : righted[0] + 2].tolist()
        if low == 0.0 and self.lever_at(high / 2**REST_HALVINGS) > 0.0:  # the last heel that halving would ask for
            return low
        for _ in range(REST_HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if self.lever_at(middle) > 0.0 else (middle, high)
        return low

    @property
    def vanishing_heel(self) -> float:
        """Heel [deg] at which the righting lever falls to 0 again; 90 if it does not, 0 if it is never above 0."""
        heels, levers = self.curve
        if self.rest_heel is None:
            return 0.0
        first = int(np.argmax((levers > 0.0) & (heels > self.rest_heel)))
        gone = np.flatnonzero(levers[first:] <= 0.0)
        return float(heels[first + gone[0] - 1]) if len(gone) else LAST_HEEL

    @property
    def criteria(self) -> list[Criterion]:
        """Criteria of A.749(18), 3.1.2.1 to 3.1.2.4, with the ship's values; levers count up to the flooding angle."""
        end = min(self.flooding_heel[0], 40.0)
        heels, levers = (part[self.curve[0] <= self.flooding_heel[0]] for part in self.curve)
        beyond = float(levers[heels >= 30.0].max()) if heels[-1] >= 30.0 else 0.0
        to_thirty = min(30.0, end)
        return [
            Criterion("area to 30 deg", self.lever_area(0.0, to_thirty), 0.055, "m rad"),
            Criterion(f"area to {end:.3g} deg", self.lever_area(0.0, end), 0.090, "m rad"),
            Criterion(
                f"area from 30 to {end:.3g} deg", self.lever_area(30.0, end) if end > 30.0 else 0.0, 0.030, "m rad"
            ),
            Criterion("largest lever at 30 deg or more", beyond, 0.20, "m"),
            Criterion("heel of the largest lever", float(heels[np.argmax(levers)]), 25.0, "deg"),
            Criterion("initial metacentric height", self.gm, 0.15, "m"),
        ]

    def cross_curves(self) -> dict[float, list[float]]:
        """KN = GZ + KG sin(heel) [m] at CROSS_HEELS, by displacement [kg] that the hull can carry."""
        own, found = self.still.matter, {}
        for share in CROSS_SHARES:
            mass = share * own.mass
            keel = np.array([0.0, self.still.keel, own.centre[2]])
            other = replace(self.still, matter=Matter(mass, keel, own.inertia), free_surface_loss=(0.0, 0.0))
            if not isinf(other.draught):
                found[mass] = [other.gz(heel) for heel in CROSS_HEELS]
        return found
