"""How long the next step is: every module of this folder without a leading underscore is a kind a scene may name."""

from typing import Protocol

from ocean_sim.fluid import Fluid


class TimeStep(Protocol):
    """The length of the next step, and which limit set it."""

    limited_by: str  # name of the limit that ruled the last answer: "acoustic", "viscous", "force" or "fixed"

    def next(self, fluid: Fluid) -> float:
        """The next time step [s]."""
        ...
