"""Length of the next step: every module of this folder is a kind that a scene may name."""

from typing import Protocol

from ocean_sim.conventions import Setting
from ocean_sim.fluid import Limits


class TimeStep(Protocol):
    """The length of the next step, and which limit set it."""

    limited_by: str  # the limit that ruled the last answer: "acoustic", "viscous", "force", "longest" or "fixed"

    @property
    def adjustable(self) -> dict[str, Setting]:
        """Settings that `adjust` can change while a simulation goes on."""
        ...

    def adjust(self, **values: float) -> None:
        """Go on with other values of adjustable settings."""
        ...

    def next(self, limits: Limits) -> float:
        """Next time step [s] under these limits, of the water or of the whole simulation."""
        ...
