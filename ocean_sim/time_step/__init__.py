"""How long the next step is: every module of this folder is a kind that a scene may name."""

from dataclasses import dataclass
from typing import Protocol

from ocean_sim.conventions import Setting
from ocean_sim.fluid import Limits


class Limited(Protocol):
    """What a time step must suit: the water, or all that is simulated."""

    def limits(self) -> Limits:
        """What the time step must stay a fraction of."""
        ...


@dataclass(frozen=True)
class Known:
    """Something whose limits are known: water that is not built yet."""

    known: Limits

    def limits(self) -> Limits:
        return self.known


class TimeStep(Protocol):
    """The length of the next step, and which limit set it."""

    limited_by: str  # the limit that ruled the last answer: "acoustic", "viscous", "force", "longest" or "fixed"

    @property
    def adjustable(self) -> dict[str, Setting]:
        """What `adjust` can change while a simulation goes on."""
        ...

    def adjust(self, **values: float) -> None:
        """Go on with other values of what is adjustable."""
        ...

    def next(self, limited: Limited) -> float:
        """The next time step [s]."""
        ...
