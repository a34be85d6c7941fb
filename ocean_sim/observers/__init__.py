"""What watches a run: a module of this room may be named at a scene's top level."""

from collections.abc import Callable
from typing import TYPE_CHECKING, ClassVar

if TYPE_CHECKING:
    from ocean_sim.simulation import Simulation

Progress = Callable[[int, int], None]  # how many pieces of a long task are done, of how many


class Observer:
    """Reads the simulation, writes files of its own, never changes the physics."""

    every: float = 0.0
    """Simulated time between calls [s]; 0 is after every step."""
    left_out: ClassVar[tuple[str, ...]] = ()
    """Attributes that a checkpoint of it does not hold."""

    def observe(self, simulation: "Simulation") -> None:
        """Called at time 0 and after the steps that its schedule asks for."""

    def resumed(self) -> None:
        """Called once a checkpoint has been restored, before the run goes on."""

    def show_progress(self, progress: Progress) -> None:
        """Whom to call while a long task goes on."""

    def close(self) -> None:
        """Called once, also after a run that failed."""
