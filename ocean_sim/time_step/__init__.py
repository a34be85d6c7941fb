"""Length of the next step: every module of this folder is a kind that a scene may name."""

from dataclasses import dataclass
from typing import Protocol

from ocean_sim.conventions import Setting
from ocean_sim.fluid import Limits


class Limited(Protocol):
    """Anything that a time step must suit: the water, or the whole simulation."""

    def limits(self) -> Limits:
        """Upper bounds of the time step."""
        ...


@dataclass(frozen=True)
class Known:
    """Known limits, of water that is not built yet."""

    known: Limits

    def limits(self) -> Limits:
        return self.known


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

    def next(self, limited: Limited) -> float:
        """The next time step [s]."""
        ...
