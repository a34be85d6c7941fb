"""Length of the next step: every module of this folder is a kind that a scene may name."""

from typing import Any

from ocean_sim.conventions import Setting
from ocean_sim.fluid import Limits


class TimeStep:
    """Rule that chooses the length of each time step. One number of its config can be adjusted during a simulation."""

    limited_by = ""  # the limit that ruled the last answer: "acoustic", "viscous", "force", "longest" or "fixed"

    def __init__(self, config: Any, adjusted: str, unit: str) -> None:
        """`config`: keys of the rule, with `longest_step`; `adjusted`: key that `adjust` may change, in this `unit`."""
        self.config, self.adjusted, self.unit = config, adjusted, unit

    @property
    def adjustable(self) -> dict[str, Setting]:
        """Settings that `adjust` can change while a simulation goes on."""
        now = getattr(self.config, self.adjusted)
        return {self.adjusted: Setting(now, self.unit, (0.2 * now, 1.6 * now))}

    def adjust(self, **values: float) -> None:
        """Change adjustable settings from the next step on."""
        self.config = self.config.model_copy(update=values)

    def next(self, limits: Limits) -> float:
        """Length of the next time step [s] under these limits, of the water or of the whole simulation."""
        dt, self.limited_by = self.config.longest_step(limits)
        return float(dt)
