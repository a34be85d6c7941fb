"""Gauges: the height of the water and its pressure at fixed points, read from the fluid, never from a drawn surface."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from pydantic import Field, model_validator

from ocean_sim.basin import Basin
from ocean_sim.model import quantity
from ocean_sim.observers.shared.csv_rows import CsvFile, heading
from ocean_sim.observers.shared.sampled import Sampled
from ocean_sim.parts import Key, Preflight, Problems
from ocean_sim.simulation import Observer, PeriodicConfig

if TYPE_CHECKING:
    from ocean_sim.simulation import Simulation

Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")]
Column = Annotated[tuple[float, ...], Field(strict=False, min_length=1, max_length=2)]
Point = Annotated[tuple[float, ...], Field(strict=False, min_length=2, max_length=3)]


class Config(PeriodicConfig):
    turn: ClassVar[int] = -1
    leaves: ClassVar[str] = "gauges.csv"
    takes: ClassVar[tuple[float, float]] = (3.4e-4, 4.3e-9)
    elevation: dict[Name, Column] = {}
    """Height of the water at points [x, z] in metres; in a slice [x]."""
    pressure: dict[Name, Point] = {}
    """Pressure of the water at points [x, y, z] in metres, also on bed and walls; in a slice [x, y]; 0 where dry."""
    every: float = quantity("s", 0.05, gt=0.0)
    """Simulated time between rows."""

    @model_validator(mode="after")
    def _measures(self) -> "Config":
        if not self.elevation and not self.pressure:
            raise ValueError("give at least one gauge, under elevation or pressure")
        return self

    def problems(self, preflight: Preflight) -> Problems:
        return self.misplaced(preflight.tank)

    def misplaced(self, basin: Basin) -> Problems:
        """What is wrong with the points in this basin."""
        points: dict[Key, tuple[tuple[float, ...], str]]
        points = {("elevation", name): (point, "xz") for name, point in self.elevation.items()}
        points |= {("pressure", name): (point, "xyz") for name, point in self.pressure.items()}
        found = [(key, misplaced(point, axes, basin)) for key, (point, axes) in points.items()]
        if self.elevation and basin.periods[1] > 0.0:
            found.append((("elevation",), "a basin that is periodic along y has no surface"))
        return [(key, sentence) for key, sentence in found if sentence is not None]

    def build(self, folder: Path, simulation: "Simulation") -> "Gauges":
        problems = self.misplaced(simulation.basin)
        if problems:
            raise ValueError("; ".join(f"gauges.{'.'.join(map(str, key))}: {text}" for key, text in problems))
        return Gauges(self, folder, simulation)


def misplaced(point: tuple[float, ...], axes: str, basin: Basin) -> str | None:
    """Why there is no water to measure at this point, or None; an open basin has no upper end."""
    wanted = axes if basin.dimension == 3 else axes.replace("z", "")
    if len(point) != len(wanted):
        slice_ = "" if basin.dimension == 3 else ", the basin is a slice"
        return f"{list(point)} should be [{', '.join(wanted)}]{slice_}"
    for axis, value in zip(wanted, point):
        low, high = basin.lower["xyz".index(axis)], basin.upper["xyz".index(axis)]
        if axis == "y" and not basin.closed:
            if value < low:
                return f"y = {value:g} m is outside the basin, whose bed is at {low:g} m"
        elif not low <= value <= high:
            return f"{axis} = {value:g} m is outside the basin, which reaches from {low:g} to {high:g} m"
    return None


class Gauges(Observer):
    """gauges.csv: one column a gauge."""

    def __init__(self, config: Config, folder: Path, simulation: "Simulation") -> None:
        self.every = config.every
        self.columns = np.array([(*point, 0.0)[:2] for point in config.elevation.values()]).reshape(-1, 2)  # x, z [m]
        self.points = np.array([(*point, 0.0)[:3] for point in config.pressure.values()]).reshape(-1, 3)  # [m]
        self.sampled = Sampled(config.every)
        meaning = {f"{name}_m": f"elevation at {list(point)} m" for name, point in config.elevation.items()}
        meaning |= {f"{name}_Pa": f"pressure at {list(point)} m" for name, point in config.pressure.items()}
        self.csv = CsvFile(
            folder / "gauges.csv",
            heading(simulation, f"every {config.every:g} s, linear between steps", **meaning),
            ["time_s", *meaning],
        )

    def observe(self, simulation: "Simulation") -> None:
        fluid, parts = simulation.fluid, []
        if len(self.columns):
            parts.append(fluid.elevations(self.columns))
        if len(self.points):
            parts.append(fluid.pressures(self.points))
        for time, values, _ in self.sampled.rows(simulation.time, np.concatenate(parts)):
            self.csv.row([time, *values])

    def close(self) -> None:
        self.csv.close()
