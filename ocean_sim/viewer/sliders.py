"""Sliders of the page: numbers of a running simulation that can change without building it anew."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ocean_sim.fluid import Fluid
from ocean_sim.simulation import Simulation
from ocean_sim.time_step import TimeStep


@dataclass
class Slider:
    """Slider of the page: a number between two limits; `apply` passes a new value to the running simulation."""

    label: str
    value: float
    low: float
    high: float
    apply: Callable[[float], None]

    def move(self, value: float) -> bool:
        """Set the value, clipped to the limits, and apply it; True if it changed by more than single precision."""
        value = min(max(value, self.low), self.high)
        if np.float32(value) == np.float32(self.value):
            return False
        self.value = value
        self.apply(value)
        return True


def sliders_of(simulation: Simulation) -> list[Slider]:
    """Sliders for all numbers that may change while a simulation runs: of wind, water and time step."""
    found, fluid, time_step = [], simulation.fluid, simulation.time_step
    if not simulation.scene.wind.still:
        found.append(Slider("wind strength, x the preset", 1.0, 0.0, 3.0, simulation.wind.strengthen))
    for part in (fluid, time_step):
        for name, (now, unit, ends) in part.adjustable.items():

            def adjust(value: float, part: Fluid | TimeStep = part, name: str = name) -> None:
                part.adjust(**{name: value})
                simulation.next_dt = time_step.next(simulation.limits())

            label, (low, high) = name.replace("_", " "), ends or (0.0, max(4.0 * now, 1.0))
            found.append(Slider(label if unit == "1" else f"{label} [{unit}]", now, low, high, adjust))
    return found
