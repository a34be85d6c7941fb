"""Observers with a schedule: a module without a leading underscore may be named at a scene's top level."""

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from ocean_sim.simulation import Simulation


class Observer(Protocol):
    """Reads the simulation, writes files of its own, never changes the physics."""

    every: float  # simulated time between calls [s]; 0 is after every step

    def observe(self, simulation: "Simulation") -> None:
        """Called at time 0 and after the steps that its schedule asks for."""
        ...

    def close(self) -> None:
        """Called once, also after a run that failed."""
        ...
