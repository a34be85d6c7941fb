"""Still water and a hull of cubes: where it floats, its stability, its dry periods.

A cube is wet as far as the water stands over its lower side; one that is turned has the same spread of heights, so a
straight ramp serves it too (variance side^2 / 12 in any direction).
"""

from dataclasses import dataclass
from functools import cached_property
from math import inf, pi, radians, sin, sqrt

import numpy as np

from ocean_sim.ship.shared.rigid_body import about
from ocean_sim.ship.shared.voxels import Voxels

UP = np.array([0.0, 1.0, 0.0])
SMALL = 0.5  # [deg] heel and trim at which metacentric heights are taken
HEELS = (5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 50.0, 60.0, 70.0, 80.0, 90.0)  # [deg]
ROUNDING = 1.0e-11  # of a hull's volume: many times what the order of a sum over its cubes changes


@dataclass(frozen=True)
class Matter:
    """What the water carries."""

    mass: float  # [kg]
    centre: np.ndarray  # (3,) from the hull's origin [m]
    inertia: np.ndarray  # (3, 3) about the centre, hull axes [kg m2]


@dataclass(frozen=True, eq=False)
class Hydrostatics:
    """A hull of given matter in still water."""

    voxels: Voxels
    matter: Matter
    density: float  # of the water [kg/m3]
    gravity: float  # [m/s2]
    lost: tuple[float, float] = (0.0, 0.0)  # of the metacentric heights across and along by liquids on board [m]

    @property
    def wanted(self) -> float:
        """Volume that carries the mass [m3]."""
        return self.matter.mass / self.density

    def wet(self, up: np.ndarray, level: float) -> np.ndarray:
        """Volume of each cube under a level [m3] along a unit vector of the hull's axes."""
        return self.whole * np.clip(self.shares(up, level), 0.0, 1.0)

    def shares(self, up: np.ndarray, level: float) -> np.ndarray:
        """How far each cube is wet: 0 where it touches the water, 1 where it is under it."""
        return (level - self.voxels.heights(up)) / self.voxels.spread(up) + 0.5

    @cached_property
    def whole(self) -> np.ndarray:
        """Volume of each cube inside the hull [m3]."""
        return self.voxels.size.prod() * self.voxels.share

    def level(self, up: np.ndarray) -> float:
        """How high along a unit vector the water stands where it carries the mass [m]; infinite where it cannot."""
        if self.wanted >= self.voxels.volume:
            return inf
        height, spread = self.voxels.heights(up), self.voxels.spread(up)
        low, high = float(height.min()) - spread, float(height.max()) + spread
        near, whole, sunk = height, self.whole, 0.0  # cubes that the surface may cut, and the volume of those under it
        for _ in range(40):
            middle = 0.5 * (low + high)
            volume = sunk + _under(middle, near, spread, whole)
            if abs(volume - self.wanted) < ROUNDING * self.voxels.volume:  # where the order of a sum may decide
                volume = _under(middle, height, spread, self.whole)
            low, high = (middle, high) if volume < self.wanted else (low, middle)
            if high - low > 0.25 * spread:
                under = near <= low - 0.5 * spread
                cut = (near < high + 0.5 * spread) & ~under
                near, whole, sunk = near[cut], whole[cut], sunk + float(whole[under].sum())
        return 0.5 * (low + high)

    @cached_property
    def draught(self) -> float:
        """Upright [m]."""
        return self.level(UP) - self.keel

    @cached_property
    def keel(self) -> float:
        """Height of the lowest cubes' lower side over the hull's origin [m]: 0, or that of an outline's points."""
        return float(self.voxels.lower[1])

    def centre_of_buoyancy(self, turn: np.ndarray | None = None) -> np.ndarray:
        """(3,) in the axes of a turned hull (upright by default), from its origin [m]."""
        turn = np.eye(3) if turn is None else turn
        share = self.shares(turn[1], self.level(turn[1]))
        volume = self.whole * np.clip(share, 0.0, 1.0)
        dx, dz = self.voxels.aside(turn.tolist(), float(self.whole[(share > 0.0) & (share < 1.0)].sum()))
        return (turn @ (volume[:, None] * self.voxels.centre).sum(axis=0) + [dx, 0.0, dz]) / volume.sum()

    def apart(self, turn: np.ndarray) -> np.ndarray:
        """(2,) from the centre of mass to that of buoyancy of a turned hull, to port and ahead [m]; free surfaces move
        the former to the lower side."""
        between = self.centre_of_buoyancy(turn) - turn @ self.matter.centre
        return between[[0, 2]] + self.lost * turn[1, [0, 2]]

    def lever(self, axis: int, degrees: float) -> float:
        """Righting lever [m] of a turn about z (2: GZ) or x (0: in trim), with free sinkage."""
        to_port, ahead = self.apart(about(axis, radians(degrees))).tolist()
        return -to_port if axis == 2 else ahead

    def gz(self, degrees: float) -> float:
        """Righting lever [m] at a heel, starboard down where positive."""
        return self.lever(2, degrees)

    @cached_property
    def kb(self) -> float:
        """Height of the centre of buoyancy over the keel [m]."""
        return float(self.centre_of_buoyancy()[1]) - self.keel

    def metacentric_height(self, axis: int = 2) -> float:
        """GM [m], by a small turn both ways."""
        return (self.lever(axis, SMALL) - self.lever(axis, -SMALL)) / (2.0 * sin(radians(SMALL)))

    @cached_property
    def waterplane(self) -> float:
        """Area of the hull at the still water [m2]."""
        level, step = self.draught + self.keel, 0.25 * self.voxels.size[1]
        return float(self.wet(UP, level + step).sum() - self.wet(UP, level - step).sum()) / (2.0 * step)

    @cached_property
    def stiffness(self) -> dict[str, float]:
        """Of heave [N/m], roll and pitch [N m/rad]."""
        weight = self.matter.mass * self.gravity
        gm, trim = self.metacentric_height(2), self.metacentric_height(0)
        return {"heave": self.density * self.gravity * self.waterplane, "roll": weight * gm, "pitch": weight * trim}

    @property
    def inertia(self) -> dict[str, float]:
        """Of heave [kg], roll and pitch [kg m2]."""
        m = self.matter
        return {"heave": m.mass, "roll": float(m.inertia[2, 2]), "pitch": float(m.inertia[0, 0])}

    def periods(self, added: dict[str, float] | None = None) -> dict[str, float | None]:
        """Natural periods of heave, roll and pitch [s], with added mass where given; None where nothing rights it."""
        found = {}
        for motion, k in self.stiffness.items():
            inertia = self.inertia[motion] + (added or {}).get(motion, 0.0)
            found[motion] = 2.0 * pi * sqrt(inertia / k) if k > 0.0 else None
        return found

    @cached_property
    def at_the_water(self) -> np.ndarray:
        """Volume of each cube within a quarter of a cube's height of the still water [m3]."""
        step = 0.25 * self.voxels.size[1]
        return self.wet(UP, self.waterline + step) - self.wet(UP, self.waterline - step)

    @cached_property
    def stations(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Position along z, breadth at the still water and draught of every slice of cubes [m]."""
        v, level = self.voxels, self.waterline
        _, tall, long = v.size
        number, n = self.slices
        lowest = np.full(n, level)
        np.minimum.at(lowest, number, self.keel + tall * v.cells[:, 1])
        along = v.lower[2] + long * (np.arange(n) + 0.5)
        return along, np.bincount(number, self.at_the_water, n) / (0.5 * tall * long), level - lowest

    @cached_property
    def ends(self) -> tuple[float, float]:
        """Position along z of the stern and of the bow at the still water [m], in the slices at the ends: a transom
        reaches twice as far into one as the middle of what is wet there, a wedge three times."""
        along, breadth, _ = self.stations
        number, _ = self.slices
        long = float(self.voxels.size[2])

        def end(k: int, way: int) -> float:
            inner, there = float(along[k]) - 0.5 * way * long, number == k
            middle = np.average(self.voxels.centre[there, 2], weights=self.at_the_water[there])
            reach = 2.0 * abs(float(middle) - inner)
            bluntness = float(breadth[k] * long / (reach * max(breadth[k - way], breadth[k])))  # a wedge's is 3/4
            return inner + way * reach * min(max(3.0 - 2.0 * bluntness, 1.0), 1.5)

        wet = np.flatnonzero(breadth > 0.0)
        return end(wet[0], -1), end(wet[-1], 1)

    @property
    def length(self) -> float:
        """Of the waterline [m]."""
        stern, bow = self.ends
        return bow - stern

    @cached_property
    def sections(self) -> np.ndarray:
        """(n,) area under the still water of every slice of cubes [m2]."""
        number, n = self.slices
        return np.bincount(number, self.wet(UP, self.waterline), n) / self.voxels.size[2]

    @property
    def waterline(self) -> float:
        """Height of the still water over the hull's origin [m]; of a ship that sinks, that of its deck."""
        return min(self.draught + self.keel, float(self.voxels.centre[:, 1].max()))

    @cached_property
    def slices(self) -> tuple[np.ndarray, int]:
        """In which slice along z each cube lies, and how many there are."""
        number = self.voxels.cells[:, 2]
        return number, int(number.max()) + 1


def _under(level: float, height: np.ndarray, spread: float, whole: np.ndarray) -> float:
    """Volume under a level [m3] of cubes of these heights of their centres and of this volume each."""
    return float((whole * np.clip((level - height) / spread + 0.5, 0.0, 1.0)).sum())
