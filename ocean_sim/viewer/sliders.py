"""Sliders of the page: numbers of a running simulation that can change without building it anew."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ocean_sim.simulation import Simulation

STEP_LABELS = {"courant_number": ("Courant number", 1.0), "dt": ("time step [ms]", 1e-3)}  # label and unit of a step


@dataclass
class Slider:
    """Slider of the page: a number between two ends; `apply` passes a new value to the running simulation."""

    label: str
    value: float
    low: float
    high: float
    apply: Callable[[float], None]

    def move(self, value: float) -> bool:
        """Set the value, clipped to the ends, and apply it; True if it changed by more than single precision."""
        value = min(max(value, self.low), self.high)
        if np.float32(value) == np.float32(self.value):
            return False
        self.value = value
        self.apply(value)
        return True


def sliders_of(simulation: Simulation) -> list[Slider]:
    """Sliders for all numbers of a simulation that may change while it runs: wind, water, time step."""
    found = []
    fluid, time_step = simulation.fluid, simulation.time_step
    if not simulation.scene.wind.still:
        found.append(Slider("wind strength, x the preset", 1.0, 0.0, 3.0, simulation.wind.strengthen))
    for name, (now, unit) in fluid.adjustable.items():
        ends = (0.25 * now, 4.0 * now) if name == "stiffness" else (0.0, max(4.0 * now, 1.0))

        def adjust_fluid(value: float, name: str = name) -> None:
            fluid.adjust(**{name: value})
            simulation.next_dt = time_step.next(simulation.limits())

        found.append(Slider(f"{name.replace('_', ' ')} [{unit}]", now, *ends, adjust_fluid))
    for name, (now, _) in time_step.adjustable.items():
        label, shown = STEP_LABELS[name]

        def adjust_time_step(value: float, name: str = name, shown: float = shown) -> None:
            time_step.adjust(**{name: value * shown})
            simulation.next_dt = time_step.next(simulation.limits())

        given = now / shown
        found.append(Slider(label, given, 0.2 * given, 1.6 * given, adjust_time_step))
    return found


def restore_sliders(sliders: list[Slider], before: list[Slider]) -> list[Slider]:
    """Move the sliders of a new simulation to the values of those `before` with equal labels; returns the new ones."""
    values = {slider.label: slider.value for slider in before}
    for slider in sliders:
        slider.move(values.get(slider.label, slider.value))
    return sliders
