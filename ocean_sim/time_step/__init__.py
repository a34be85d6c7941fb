"""Length of the next step: every module of this folder is a kind that a scene may name."""

from typing import Protocol

from ocean_sim.conventions import Setting
from ocean_sim.fluid import Limits


class TimeStep(Protocol):
    """Interface of a rule for the length of the next time step."""

    limited_by: str  # the limit that ruled the last answer: "acoustic", "viscous", "force", "longest" or "fixed"

    @property
    def adjustable(self) -> dict[str, Setting]:
        """Settings that `adjust` can change while a simulation goes on."""

    def adjust(self, **values: float) -> None:
        """Change adjustable settings from the next step on."""

    def next(self, limits: Limits) -> float:
        """Length of the next time step [s] under these limits of the water or of the whole simulation."""
