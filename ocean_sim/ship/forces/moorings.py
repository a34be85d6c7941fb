"""Lines that hold a ship and fenders that keep it off: straight springs from a point of the ship to one of the world.

A line pulls with k (l - l0) + c l' where it is longer than its slack length l0, a fender pushes with k (l0 - l) - c l'
where it is shorter (Faltinsen 1990, Sea Loads on Ships and Offshore Structures, 8.2, linearised).
"""

from collections.abc import Mapping
from math import sqrt
from typing import Literal

import numpy as np
from pydantic import ConfigDict, Field

from ocean_sim.model import Model, Vector3, quantity
from ocean_sim.ship.body.rigid_body import RigidBody, cross


class Mooring(Model):
    """One line or fender."""

    model_config = ConfigDict(serialize_by_alias=True)

    fairlead: str | Vector3 = Field(alias="from", json_schema_extra={"unit": "m"})
    """The name of one of the ship's `points`, or a point from the hull's origin [m]."""
    to: Vector3 = quantity("m")
    """Anchor point in the world."""
    kind: Literal["line", "fender"] = "line"
    """`line`: it only pulls; `fender`: it only pushes."""
    stiffness: float = quantity("N/m", gt=0.0)
    """Force over the length beyond `slack_length`; of a fender, over the length below it."""
    damping: float = quantity("N s/m", 0.0, ge=0.0)
    """Force over the speed at which it lengthens, while it holds."""
    slack_length: float | None = quantity("m", None, ge=0.0)
    """Length without force; null: the length at the beginning."""


class Moorings:
    """Forces of all lines and fenders on one ship."""

    def __init__(
        self, configs: list[Mooring], points: Mapping[str, tuple[float, ...]], centre: np.ndarray, body: RigidBody
    ) -> None:
        """`points` of the ship by name, `centre` of mass, from the hull's origin [m]; `body`: ship at the start."""
        at = [points[c.fairlead] if isinstance(c.fairlead, str) else c.fairlead for c in configs]
        self.arm = np.array(at).reshape(-1, 3) - centre  # (n, 3) body axes [m]
        self.to = np.array([c.to for c in configs]).reshape(-1, 3)
        self.stiffness, self.damping = np.array([[c.stiffness, c.damping] for c in configs]).reshape(-1, 2).T
        self.pulls = np.array([1.0 if c.kind == "line" else -1.0 for c in configs])
        first = np.linalg.norm(self.line_spans(body), axis=1)
        self.slack = np.array([l if c.slack_length is None else c.slack_length for c, l in zip(configs, first)])

    def line_spans(self, body: RigidBody) -> np.ndarray:
        """(n, 3) vectors from each line's point on the ship to its anchor point, world axes [m]."""
        return self.to - body.position - self.arm @ body.matrix.T

    def load(self, body: RigidBody) -> np.ndarray:
        """(2, 3) force [N] and torque about the centre of mass [N m] of all lines and fenders, world axes."""
        total = np.zeros((2, 3))
        for k, span in enumerate(self.line_spans(body)):
            length = sqrt(float(span @ span))
            along = span / max(length, 1e-9)
            faster = -float(along @ body.point_velocity(self.arm[k]))  # [m/s] at which it lengthens
            stretched = self.pulls[k] * (length - self.slack[k])
            if stretched > 0.0:
                held = max(self.stiffness[k] * stretched + self.pulls[k] * self.damping[k] * faster, 0.0)
                force = self.pulls[k] * held * along
                total += [force, cross(body.matrix @ self.arm[k], force)]
        return total
