"""Wave gauges: the height of the water at fixed points, read from the fluid itself, never from a drawn surface."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from ocean_sim.basin import Basin
from ocean_sim.observers._csv import CsvFile, heading
from ocean_sim.observers._sampled import Sampled
from ocean_sim.parts import ObserverConfig, quantity

if TYPE_CHECKING:
    from ocean_sim.simulation import Simulation

Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")]
Point = Annotated[tuple[float, ...], Field(strict=False, min_length=1, max_length=2)]


class Config(ObserverConfig):
    elevation: dict[Name, Point] = Field(min_length=1)
    """Height of the water at points [x, z] in metres; in a slice [x]."""
    every: float = quantity("s", 0.05, gt=0.0)
    """Simulated time between rows."""

    def problems(self, basin: Basin) -> list[tuple[str, str]]:
        """What is wrong with the points in this basin: (key, sentence)."""
        return [
            (f"elevation.{name}", sentence)
            for name, point in self.elevation.items()
            if (sentence := misplaced(point, basin)) is not None
        ]

    def build(self, folder: Path, simulation: "Simulation") -> "Gauges":
        problems = self.problems(simulation.basin)
        if problems:
            raise ValueError("; ".join(f"gauges.{key}: {sentence}" for key, sentence in problems))
        return Gauges(self, folder, simulation)


def misplaced(point: tuple[float, ...], basin: Basin) -> str | None:
    """Why there is no water to measure at this point, or None."""
    if len(point) != basin.dimension - 1:
        return f"{list(point)} should be {'[x, z]' if basin.dimension == 3 else '[x], the basin is a slice'}"
    for axis, value in zip("xz", point):
        low, high = basin.lower["xyz".index(axis)], basin.upper["xyz".index(axis)]
        if not low <= value <= high:
            return f"{axis} = {value:g} m is outside the basin, which reaches from {low:g} to {high:g} m"
    return None


class Gauges:
    """gauges.csv: one column a gauge."""

    def __init__(self, config: Config, folder: Path, simulation: "Simulation") -> None:
        self.every = config.every
        self.points = np.array([(*point, 0.0)[:2] for point in config.elevation.values()])  # x, z [m]
        self.sampled = Sampled(config.every)
        places = {name: f"elevation at {list(point)} m" for name, point in config.elevation.items()}
        self.csv = CsvFile(
            folder / "gauges.csv",
            heading(simulation, f"every {config.every:g} s, linear between steps", **places),
            ["time_s", *(f"{name}_m" for name in config.elevation)],
        )

    def observe(self, simulation: "Simulation") -> None:
        for time, elevation, _ in self.sampled.rows(simulation.time, simulation.fluid.elevations(self.points)):
            self.csv.row([time, *elevation])

    def close(self) -> None:
        self.csv.close()
