"""A constant time step, whatever the water does."""

from typing import Any, ClassVar, Literal

from ocean_sim.conventions import LEAST_STEP
from ocean_sim.fluid import Limits
from ocean_sim.model import quantity
from ocean_sim.parts import TimeStepConfig
from ocean_sim.time_step import TimeStep


class Config(TimeStepConfig):
    """A constant time step."""

    example: ClassVar[dict[str, Any]] = {"dt": 0.001}
    kind: Literal["fixed"] = "fixed"
    dt: float = quantity("s", ge=LEAST_STEP)
    """The time step."""

    def advice(self, limit: str, shortest: float) -> str:
        if self.dt > shortest:
            return f"try time_step: courant, or a dt below its {limit} limit (here {shortest:.3g} s)"
        return "try a smaller time_step.dt, or a weaker wind"

    def build(self) -> TimeStep:
        return TimeStep(self, "dt", "s")

    def longest_step(self, limits: Limits) -> tuple[float, str]:
        """The constant time step [s], whatever the limits, and "fixed" as the name of its limit."""
        return self.dt, "fixed"
