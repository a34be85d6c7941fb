"""How long the next step is: every module of this folder is a kind that a scene may name."""

from typing import Protocol

from ocean_sim.fluid import Limits


class Limited(Protocol):
    """What a step must not be too long for: water, or a simulation of water and a ship."""

    def limits(self) -> Limits:
        """What the time step must stay a fraction of [s]."""
        ...


class TimeStep(Protocol):
    """The length of the next step, and which limit set it."""

    limited_by: str  # the limit that ruled the last answer: "acoustic", "viscous", "force", "longest" or "fixed"

    def next(self, limited: Limited) -> float:
        """The next time step [s]."""
        ...
