"""A constant time step, whatever the water does."""

from typing import Any, ClassVar, Literal

from ocean_sim.conventions import LEAST_STEP, Setting
from ocean_sim.fluid import Limits
from ocean_sim.model import quantity
from ocean_sim.parts import TimeStepConfig


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

    def build(self) -> "Fixed":
        return Fixed(self)


class Fixed:
    """Constant time step `dt` of the config, never limited by anything."""

    limited_by = "fixed"

    def __init__(self, config: Config) -> None:
        self.config = config

    @property
    def adjustable(self) -> dict[str, Setting]:
        return {"dt": Setting(now := self.config.dt, "s", (0.2 * now, 1.6 * now))}

    def adjust(self, **values: float) -> None:
        self.config = self.config.model_copy(update=values)

    def next(self, limits: Limits) -> float:
        return self.config.dt
