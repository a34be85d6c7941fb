"""Ships: every module of this folder is a kind that a scene may name."""

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from ocean_sim.basin import whole_sides

if TYPE_CHECKING:
    from ocean_sim.fluid import Fluid, Limits
    from ocean_sim.ship.body.rigid_body import RigidBody
    from ocean_sim.ship.forces.propulsion import Helmsman, Person
    from ocean_sim.surface import Surface
    from ocean_sim.wind import Wind

PARTS = ("gravity", "buoyancy", "wind_drag", "wind_lift", "wave", "damping", "propeller", "rudder")
NO_FORCE = np.zeros((2, 3))  # a part that does not act


@dataclass(frozen=True)
class Load:
    """Loads on a ship by cause, as `wave`: force [N], torque about centre of mass [N m], world axes (thesis 4.27)."""

    parts: np.ndarray  # in the order of the ship's `parts`

    @classmethod
    def of(cls, forces: dict[str, np.ndarray], names: tuple[str, ...] = PARTS) -> "Load":
        """Load of `forces` by cause, (2, 3) as in `total`; 0 for other `names`. Raises ValueError for unknown names."""
        for name in forces:
            if name not in names:
                raise ValueError(f"a ship with a force {name!r} must name it in `parts`, which are {', '.join(names)}")
        return cls(np.concatenate([forces.get(name, NO_FORCE) for name in names]).reshape(-1, 2, 3))

    def plus(self, name: str, more: np.ndarray) -> "Load":
        """Copy of this load with `more`, a (2, 3) force and torque, added to those of cause `name`, one of PARTS."""
        parts = self.parts.copy()
        parts[PARTS.index(name)] += more
        return Load(parts)

    @property
    def total(self) -> np.ndarray:
        """(2, 3) sum over all causes: force [N], and torque about the centre of mass [N m]."""
        return self.parts.sum(axis=0)

    @property
    def force(self) -> np.ndarray:
        """(3,) total force [N], world axes."""
        return self.total[0]

    @property
    def torque(self) -> np.ndarray:
        """(3,) total torque about the centre of mass [N m], world axes."""
        return self.total[1]


class Look(NamedTuple):
    """Data that a picture of a ship shows besides her hull: name, still water at rest, and breadth."""

    name: str  # of its hull, if it has one, and of its shape
    still_water: np.ndarray  # (4,) afloat at rest: upward normal, body axes, and its centre of mass over the water [m]
    breadth: float  # [m]


class Afloat(NamedTuple):
    """Hydrostatic data of a ship at rest in still water: mass, draught, metacentric heights and natural periods."""

    displacement: float  # [kg]
    draught: float  # [m]; infinite where she sinks
    gm: float  # metacentric heights of the hull as it is simulated, in cubes [m]
    gm_longitudinal: float
    periods: dict[str, float | None]  # natural, of heave, roll and pitch [s]; None where nothing rights her
    gm_of_faces: float | None = None  # of the hull itself, by its faces [m]; None where they only approach it


class Outline(NamedTuple):
    """Space that a hull occupies: its outline in plan view, and its lowest and highest point."""

    plan: np.ndarray  # (n, 2) corners of a convex polygon, x and z [m]
    lowest: float  # [m]
    highest: float  # [m]

    def overlap(self, other: "Outline") -> float:
        """Length [m] of the shortest shift that would separate this hull from another; 0 if they do not overlap."""
        least = min(self.highest, other.highest) - max(self.lowest, other.lowest)
        for polygon in (self.plan, other.plan):
            along = np.roll(polygon, -1, axis=0) - polygon
            across = np.stack([along[:, 1], -along[:, 0]]) / np.linalg.norm(along, axis=1)
            a, b = self.plan @ across, other.plan @ across
            ways = np.minimum(a.max(axis=0) - b.min(axis=0), b.max(axis=0) - a.min(axis=0))
            least = min(least, float(ways.min()))
        return max(least, 0.0)

    def images(self, other: "Outline", periods: Sequence[float]) -> list["Outline"]:
        """Copies of this outline by `periods` (3,) [m] of the basin: the nearest to `other`, and those around it."""
        apart = other.plan.mean(axis=0) - self.plan.mean(axis=0)
        sides = np.array(periods[::2])
        next_to = product(*([-side, 0.0, side] if side else [0.0] for side in sides))
        nearest = whole_sides(apart, sides)
        return [self._replace(plan=self.plan + (nearest + way)) for way in next_to]

    def middle(self, other: "Outline") -> np.ndarray:
        """(2,) x and z [m] of the middle of the rectangle in which the bounding boxes of both outlines overlap."""
        low = np.maximum(self.plan.min(axis=0), other.plan.min(axis=0))
        high = np.minimum(self.plan.max(axis=0), other.plan.max(axis=0))
        return 0.5 * (low + high)


class Ship(Protocol):
    """Interface of a ship: state, loads and motion; `ship.body.vessel.Vessel` is the base class of all kinds."""

    name: str  # in the scene
    parts: tuple[str, ...] = PARTS  # names of the parts of its load, then those of the kind; columns of motion.csv
    body: "RigidBody"
    points: dict[str, np.ndarray]  # named points, body axes from the centre of mass [m]
    last: Load  # what acted in the last step
    acceleration: np.ndarray  # (3,) of the centre of mass in the last step, world axes [m/s2]
    turning: np.ndarray  # (3,) angular acceleration in the last step, world axes [rad/s2]
    airborne: bool  # whether none of its hull was under water in the last step
    groundings: int  # how often the hull has met the bed, each time after it was free
    added: np.ndarray  # (6,) mass [kg] and inertia [kg m2] of the water that moves along, in the order of `Motions`

    @property
    def orders(self) -> tuple[float, float]:
        """Present throttle (-1 to 1) and rudder angle [rad], as far as they have followed the crew's orders."""

    @abstractmethod
    def load(self, wind: "Wind", fluid: "Fluid", surface: "Surface | Fluid") -> Load:
        """Compute the forces and torques on the ship at her present pose, by cause (thesis 4.27). `surface`: object
        that gives the height of the water, which is the fluid in a scene without a surface."""

    def advance(self, load: Load, dt: float) -> None:
        """Move the ship by a time step dt [s] under a load (thesis 4.22 to 4.25); raises Diverged."""

    def hand_over(self) -> "Person":
        """Replace the crew by a person at the helm, who is returned and takes orders by `give(throttle, rudder)`."""

    def sail(self, route: list[tuple[float, float]], speed: float) -> "Helmsman":
        """Replace the crew by a pilot, who is returned, on a route of waypoints x, z [m] at a speed [m/s]; a waypoint
        counts as reached a ship's length before it."""

    def drawn(self) -> tuple[np.ndarray, np.ndarray] | None:
        """Mesh of the hull for pictures: vertices (n, 3) [m] from the centre of mass, body axes; triangles (m, 3)."""

    def outline(self) -> Outline | None:
        """Plan-view outline and height range of the hull at its present pose; None where the ship has no shape."""

    def displaced(self) -> tuple[np.ndarray, np.ndarray]:
        """Water displaced by the hull, in m pieces (or none): x, z, depth of each (m, 3) [m], and volume (m,) [m3]."""
        return np.zeros((0, 3)), np.zeros(0)

    def limits(self) -> "Limits":
        """Time scales [s] of the fastest motion of the ship, a fraction of which bounds the time step."""
