"""Stability of a loaded ship: righting levers, areas under them, flooding, and what the IMO asks of them.

Levers are those of a ship on even keel with free sinkage. The criteria are those of IMO resolution A.749(18), 3.1.2,
which the 2008 Intact Stability Code (MSC.267(85), A/2.2) keeps. A tank that is not full costs metacentric height
rho i / displacement, i its surface's second moment, and that times sin(heel) of every lever.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, isinf, radians, sin
from typing import NamedTuple

import numpy as np

from ocean_sim.model import Model, Vector3, quantity
from ocean_sim.ship.shared.hydrostatics import Hydrostatics, Matter
from ocean_sim.ship.shared.rigid_body import about

STEP = 5.0  # [deg] between levers; a cubic goes through them
LAST = 90.0  # [deg]
FINE = 901  # points of a curve
CROSS = tuple(float(heel) for heel in range(10, 90, 10))  # [deg] of cross curves
SHARES = (0.4, 0.6, 0.8, 1.0, 1.2, 1.4)  # displacements of cross curves over the ship's own


class Weight(Model):
    """Something on board."""

    mass: float = quantity("kg", gt=0.0)
    at: Vector3 = quantity("m")
    """Its centre from the hull's origin: x to port, y up, z to the bow."""


class Liquid(Weight):
    """What a tank holds."""

    length: float | None = quantity("m", None, gt=0.0)
    """Of its free surface along the ship; null: it is full, or empty."""
    breadth: float | None = quantity("m", None, gt=0.0)
    """Of its free surface across the ship."""
    density: float = quantity("kg/m3", 1000.0, gt=0.0)
    """Of the liquid."""

    @property
    def moment(self) -> float:
        """rho i of its free surface across the ship [kg m]."""
        return self.density * (self.length or 0.0) * (self.breadth or 0.0) ** 3 / 12.0


class Loading(Model):
    """A loading condition: what is on board of a light ship."""

    light: Weight
    """The ship itself."""
    weights: dict[str, Weight] = {}
    """What is fixed."""
    tanks: dict[str, Liquid] = {}
    """What is liquid."""
    openings: dict[str, Vector3] = {}
    """Where water would come in, from the hull's origin [m]."""

    @property
    def matter(self) -> tuple[float, np.ndarray]:
        """Mass [kg], and centre (3,) from the hull's origin [m]."""
        parts = [self.light, *self.weights.values(), *self.tanks.values()]
        mass = sum(part.mass for part in parts)
        return mass, np.sum([part.mass * np.array(part.at) for part in parts], axis=0) / mass

    @property
    def moment(self) -> float:
        """rho i of all free surfaces [kg m]."""
        return sum(tank.moment for tank in self.tanks.values())


class Criterion(NamedTuple):
    """What is asked of a ship, and what she has."""

    name: str
    value: float
    least: float
    unit: str

    @property
    def ok(self) -> bool:
        return self.value >= self.least


@dataclass(frozen=True)
class Stability:
    """A ship in still water with free surfaces on board, and openings."""

    still: Hydrostatics
    lost: float = 0.0  # of the metacentric height by free surfaces [m]
    openings: Mapping[str, Vector3] | None = None  # from the hull's origin [m]

    @cached_property
    def heels(self) -> np.ndarray:
        """(n,) [deg], starboard down."""
        return np.arange(0.0, LAST + STEP, STEP)

    @cached_property
    def levers(self) -> np.ndarray:
        """(n,) GZ at the heels, free surfaces taken off [m]."""
        return np.array([self.still.gz(heel) - self.lost * sin(radians(heel)) for heel in self.heels.tolist()])

    @property
    def gm(self) -> float:
        """Metacentric height, free surfaces taken off [m]."""
        return self.still.metacentric_height() - self.lost

    @cached_property
    def flooding(self) -> tuple[float, str]:
        """The least heel [deg] to either side at which an opening comes to the water, up to 90, and which it is;
        infinite where none does."""
        found = (inf, "")
        for name, point in (self.openings or {}).items():
            for side in (1.0, -1.0):
                clear = [self.clearance(point, side * heel) for heel in self.heels.tolist()]
                under = next((k for k, height in enumerate(clear) if height <= 0.0), None)
                if under is not None:
                    part = 0.0 if under == 0 else clear[under - 1] / (clear[under - 1] - clear[under])
                    found = min(found, (max(0.0, under - 1 + part) * STEP, name))
        return found

    @cached_property
    def waters(self) -> dict[float, tuple[np.ndarray, float]]:
        """By heel to both sides [deg]: what is up (3,), and how high along it the water stands [m]."""
        heels = [side * heel for heel in self.heels.tolist() for side in (1.0, -1.0)]
        ups = {heel: about(2, radians(heel))[1] for heel in heels}
        return {heel: (up, self.still.level(up)) for heel, up in ups.items()}

    def clearance(self, point: Sequence[float], heel: float) -> float:
        """Height of a point of the ship over the water [m] at one of these heels."""
        up, level = self.waters[heel]
        return float(up @ np.array(point)) - level

    @cached_property
    def curve(self) -> tuple[np.ndarray, np.ndarray]:
        """(m,) heels [deg] and (m,) levers [m] on a cubic through the levers."""
        from scipy.interpolate import CubicSpline

        fine = np.linspace(0.0, LAST, FINE)
        return fine, CubicSpline(self.heels, self.levers)(fine)

    def area(self, first: float, last: float) -> float:
        """Under the levers between two heels [deg], [m rad]."""
        heels = np.linspace(first, last, FINE)
        return float(np.trapezoid(np.interp(heels, *self.curve), np.radians(heels)))

    @property
    def vanishing(self) -> float:
        """Heel [deg] at which the lever comes back to 0; 90 where it does not, 0 where there is none."""
        heels, levers = self.curve
        gone = np.flatnonzero(levers[1:] <= 0.0)
        return float(heels[gone[0]]) if len(gone) else LAST

    @property
    def criteria(self) -> list[Criterion]:
        """A.749(18), 3.1.2.1 to 3.1.2.4; the levers end at the angle of flooding."""
        end = min(self.flooding[0], 40.0)
        heels, levers = self.curve
        beyond = levers[(heels >= 30.0) & (heels <= max(30.0, self.flooding[0]))]
        to_thirty = min(30.0, end)
        return [
            Criterion("area to 30 deg", self.area(0.0, to_thirty), 0.055, "m rad"),
            Criterion(f"area to {end:.3g} deg", self.area(0.0, end), 0.090, "m rad"),
            Criterion(f"area from 30 to {end:.3g} deg", self.area(30.0, end) if end > 30.0 else 0.0, 0.030, "m rad"),
            Criterion("largest lever at 30 deg or more", float(beyond.max()), 0.20, "m"),
            Criterion("heel of the largest lever", float(heels[np.argmax(levers)]), 25.0, "deg"),
            Criterion("initial metacentric height", self.gm, 0.15, "m"),
        ]

    def cross_curves(self) -> dict[float, list[float]]:
        """KN = GZ + KG sin(heel) [m] at the heels of CROSS, of displacements [kg] that the hull can carry."""
        own, found = self.still.matter, {}
        for share in SHARES:
            mass = share * own.mass
            keel = np.array([0.0, self.still.keel, own.centre[2]])
            other = replace(self.still, matter=Matter(mass, keel, own.inertia))
            if not isinf(other.draught):
                found[mass] = [other.gz(heel) for heel in CROSS]
        return found
