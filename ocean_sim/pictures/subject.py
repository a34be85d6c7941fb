"""What pictures read of a simulation that goes on."""

from typing import Any, Protocol

from ocean_sim.basin import Basin
from ocean_sim.fluid import Fluid
from ocean_sim.ship import Ship
from ocean_sim.surface import Surface
from ocean_sim.wind import Wind


class Subject(Protocol):
    """A simulation, as its pictures and its panel know it."""

    scene: Any  # SceneConfig
    basin: Basin
    wind: Wind
    fluid: Fluid
    surface: Surface | None
    ship: Ship | None
    time_step: Any
    time: float  # [s]
    next_dt: float  # [s]
