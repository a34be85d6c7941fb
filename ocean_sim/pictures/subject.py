"""What pictures read of a simulation that goes on."""

from typing import Any, Protocol

from ocean_sim.basin import Basin
from ocean_sim.fluid import Fluid
from ocean_sim.ship import Ship
from ocean_sim.surface import Surface
from ocean_sim.wind import Wind


class Water(Fluid, Protocol):
    """Water, as a panel knows it."""

    config: Any
    adjustable: dict[str, str]  # what may be set while it runs, and units; not every scheme has it

    def adjust(self, **values: float) -> None: ...


class Steered(Ship, Protocol):
    """A ship, as a panel knows it."""

    @property
    def orders(self) -> Any:
        """What throttle and rudder are set to."""
        ...


class Subject(Protocol):
    """A simulation, as its pictures and its panel know it."""

    scene: Any  # SceneConfig
    basin: Basin
    wind: Wind
    fluid: Water
    surface: Surface | None
    ship: Steered | None
    time_step: Any
    time: float  # [s]
    next_dt: float  # [s]
