"""Ships: every module of this folder without a leading underscore is a kind a scene may name."""

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

PARTS = ("gravity", "buoyancy", "wind_drag", "wind_lift", "wave", "damping", "propeller", "rudder")


@dataclass(frozen=True)
class Load:
    """(4.27): force [N] and torque about the centre of mass [N m] of every part, (8, 2, 3) in the order of PARTS."""

    parts: np.ndarray

    @property
    def force(self) -> np.ndarray:
        """Their sum, (3,), world axes [N]."""
        return self.parts[:, 0].sum(axis=0)

    @property
    def torque(self) -> np.ndarray:
        """Their sum, (3,), world axes [N m]."""
        return self.parts[:, 1].sum(axis=0)


def loaded(**parts: np.ndarray) -> Load:
    """The load of parts by name, (2, 3) each; the others are nothing."""
    return Load(np.stack([np.asarray(parts.get(name, np.zeros((2, 3))), dtype=np.float64) for name in PARTS]))


class Ship(Protocol):
    """A floating body."""

    body: Any  # RigidBody
    points: dict[str, np.ndarray]  # named places, body axes from the centre of mass [m]
    last: Load  # what acted in the last step

    def load(self, wind: Any, fluid: Any, surface: Any) -> Load:
        """(4.27), now."""
        ...

    def advance(self, load: Load, dt: float) -> None:
        """(4.22) to (4.25)."""
        ...

    def hand_over(self) -> Any:
        """A person takes the helm: what `give(throttle, rudder)` orders replaces the controls of the scene."""
        ...

    def drawn(self) -> tuple[np.ndarray, np.ndarray] | None:
        """Vertices from the centre of mass, body axes (n, 3) [m], and triangles (m, 3), where it has a shape."""
        ...

    def limits(self) -> Any:
        """What the time step must stay a fraction of."""
        ...
