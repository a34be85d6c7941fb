"""Ships: every module of this folder without a leading underscore is a kind a scene may name."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

if TYPE_CHECKING:
    from ocean_sim.fluid import Fluid, Limits
    from ocean_sim.ship.shared.propulsion import Person
    from ocean_sim.ship.shared.rigid_body import RigidBody
    from ocean_sim.surface import Surface
    from ocean_sim.wind import Wind

PARTS = ("gravity", "buoyancy", "wind_drag", "wind_lift", "wave", "damping", "propeller", "rudder")


@dataclass(frozen=True)
class Load:
    """(4.27): force [N] and torque about the centre of mass [N m] of every part, (n, 2, 3), world axes."""

    parts: np.ndarray  # in the order of the ship's `parts`

    @classmethod
    def of(cls, forces: dict[str, np.ndarray], names: tuple[str, ...] = PARTS) -> "Load":
        """Of forces and torques by name, (2, 3) each; the other parts are zero. Raises ValueError for a name that is
        not one of the ship's parts."""
        parts = np.zeros((len(names), 2, 3))
        for name, force in forces.items():
            if name not in names:
                raise ValueError(f"a ship with a force {name!r} must name it in `parts`, which are {', '.join(names)}")
            parts[names.index(name)] = force
        return cls(parts)

    @property
    def force(self) -> np.ndarray:
        """Their sum, (3,), world axes [N]."""
        return self.parts[:, 0].sum(axis=0)

    @property
    def torque(self) -> np.ndarray:
        """Their sum, (3,), world axes [N m]."""
        return self.parts[:, 1].sum(axis=0)


class Look(NamedTuple):
    """What a picture needs of a ship besides its triangles."""

    name: str  # of its hull, if it has one, and of its shape
    submerged: float  # share of its volume that is under water at rest
    breadth: float  # [m]


class Ship(Protocol):
    """A floating body; `shared.vessel.Vessel` is the base class that has all of this."""

    @property
    def parts(self) -> tuple[str, ...]:
        """Of its load: PARTS first, then what a kind adds; columns of motion.csv."""
        ...

    body: "RigidBody"
    points: dict[str, np.ndarray]  # named points, body axes from the centre of mass [m]
    last: Load  # what acted in the last step
    acceleration: np.ndarray  # (3,) of the centre of mass in the last step, world axes [m/s2]
    turning: np.ndarray  # (3,) angular acceleration in the last step, world axes [rad/s2]
    groundings: int  # how often the hull has met the bed, each time after it was free
    added: np.ndarray  # (6,) mass [kg] and inertia [kg m2] of the water that moves along, in the order of `Motions`

    @property
    def orders(self) -> tuple[float, float]:
        """Throttle and rudder [rad] as they are now."""
        ...

    def load(self, wind: "Wind", fluid: "Fluid", surface: "Surface | Fluid") -> Load:
        """(4.27), now."""
        ...

    def advance(self, load: Load, dt: float) -> None:
        """(4.22) to (4.25); raises Diverged."""
        ...

    def hand_over(self) -> "Person":
        """A person takes the helm: what `give(throttle, rudder)` orders replaces the controls of the scene."""
        ...

    def drawn(self) -> tuple[np.ndarray, np.ndarray] | None:
        """Vertices from the centre of mass, body axes (n, 3) [m], and triangles (m, 3); None where it has no shape."""
        ...

    def displaced(self) -> tuple[np.ndarray, np.ndarray]:
        """Where it displaces water, x and z (m, 2) [m], and how much there (m,) [m3], as in its last load; m is 0 where
        its law of motion does not say."""
        ...

    def limits(self) -> "Limits":
        """What the time step must stay a fraction of."""
        ...
