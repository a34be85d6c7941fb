"""What pictures read of a simulation that goes on."""

from typing import Protocol

from ocean_sim.basin import Basin
from ocean_sim.fluid import Fluid, Limits
from ocean_sim.parts import Scene
from ocean_sim.ship import Ship
from ocean_sim.surface import Surface
from ocean_sim.time_step import TimeStep
from ocean_sim.wind import Wind


class Subject(Protocol):
    """A simulation, as its pictures and its panel know it."""

    scene: Scene
    basin: Basin
    wind: Wind
    fluid: Fluid
    surface: Surface | None
    ships: dict[str, Ship]
    time_step: TimeStep
    time: float  # [s]
    next_dt: float  # [s]

    def limits(self) -> Limits:
        """What the time step must stay a fraction of."""
        ...
