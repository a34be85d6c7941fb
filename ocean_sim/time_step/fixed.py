"""The same time step always, whatever the water does."""

from typing import Literal

from ocean_sim.parts import PartConfig, quantity
from ocean_sim.time_step import Limited


class Config(PartConfig):
    """A constant time step."""

    kind: Literal["fixed"] = "fixed"
    dt: float = quantity("s", gt=0.0)
    """The time step."""

    def build(self) -> "Fixed":
        return Fixed(self)


class Fixed:
    """`dt`, never limited by anything."""

    limited_by = "fixed"

    def __init__(self, config: Config) -> None:
        self.config = config

    def next(self, limited: Limited) -> float:
        return self.config.dt
