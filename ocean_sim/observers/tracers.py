"""Positions and velocities of tagged particles at a fixed rate; `ocean-sim waves` finds their orbits."""

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from ocean_sim.basin import Box
from ocean_sim.fluid import with_particles
from ocean_sim.model import Faults, quantity
from ocean_sim.observers.shared.csv_rows import CsvFile, Sampled, heading
from ocean_sim.parts import PeriodicConfig, SceneFacts
from ocean_sim.simulation import Observer, Simulation

MAX_TRACERS = 1000  # each has six columns
Number = Annotated[int, Field(ge=0)]
COLUMN_UNITS = {"x": "m", "y": "m", "z": "m", "u": "m_s", "v": "m_s", "w": "m_s"}


class Config(PeriodicConfig):
    leaves: ClassVar[str] = "tracers.csv"
    ids: list[Number] = []
    """Ids of particles to follow."""
    boxes: list[Box] = []
    """Boxes [m] whose particles, as they are at the start, are followed; in 2-D the points are [x, y]."""
    every: float = quantity("s", 0.05, gt=0.0)
    """Simulated time between rows."""

    def contradictions(self) -> Iterator[str]:
        if not self.ids and not self.boxes:
            yield "give at least one of ids and boxes"

    def mismatches(self, preflight: SceneFacts) -> Faults:
        lattice = preflight.untouched
        if lattice is None:
            yield (), f"fluid.kind {preflight.fluid.kind} has no particles to follow"
            return
        for k, name in enumerate(self.ids):
            if name >= lattice.n:
                yield ("ids", k), f"there is no particle {name}; there are {lattice.n}"
        x, near = lattice.positions(), lattice.spacing  # particles that begin in a wave are displaced by less
        for k, box in enumerate(self.boxes):
            d = len(box.min)
            if d < preflight.tank.dimension:
                yield ("boxes", k), f"a point of this basin has 3 numbers, got {d}"
            elif not ((x[:, :d] >= np.subtract(box.min, near)) & (x[:, :d] <= np.add(box.max, near))).all(axis=1).any():
                yield ("boxes", k), "holds no water"


class Tracers(Observer, of=Config):
    """Writes tracers.csv: position and velocity of each tagged particle; paths are unwrapped across periodic sides."""

    last: np.ndarray | None

    def __init__(self, config: Config, folder: Path, simulation: Simulation) -> None:
        self.every, self.sampled = config.every, Sampled(config.every)
        self.names = tracer_ids(config, simulation)
        self.periods = np.array(simulation.basin.periods)
        self.last = None
        self.unwrapping = np.zeros((len(self.names), 3))  # [m] added to positions
        columns = [f"p{name}_{what}_{unit}" for name in self.names for what, unit in COLUMN_UNITS.items()]
        rate = f"every {config.every:g} s, linear between steps"
        head = heading(simulation, rate, depth=f"{simulation.basin.depth:.9g} m", still_surface="y = 0")
        self.csv = CsvFile(folder / "tracers.csv", head, ["time_s", *columns])

    def observe(self, simulation: Simulation) -> None:
        particles = with_particles(simulation.fluid).particles
        order = np.argsort(particles.id.to_numpy())[self.names]
        x = particles.position.to_numpy()[order].astype(float)
        if self.last is not None:
            periods = np.where(self.periods > 0.0, self.periods, np.inf)
            wrapped = np.where(self.periods > 0.0, np.round((x - self.last) / periods) * self.periods, 0.0)
            self.unwrapping -= wrapped
        self.last = x
        values = np.concatenate([x + self.unwrapping, particles.velocity.to_numpy()[order]], axis=1)
        for time, row, _ in self.sampled.rows(simulation.time, values.ravel()):
            self.csv.row([time, *row])

    def close(self) -> None:
        self.csv.close()


def tracer_ids(config: Config, simulation: Simulation) -> np.ndarray:
    """Ids of the particles to follow, sorted, each once; raises ValueError if a box is empty or there are too many."""
    particles = with_particles(simulation.fluid).particles
    ids, x = particles.id.to_numpy(), particles.position.to_numpy()
    found = [np.array(config.ids, dtype=int)]
    for k, box in enumerate(config.boxes):
        along = x[:, : len(box.min)]
        inside = ids[((along >= box.min) & (along <= box.max)).all(axis=1)]
        if not len(inside):
            raise ValueError(f"tracers.boxes[{k}]: no particle is in it")
        found.append(inside)
    names = np.unique(np.concatenate(found))
    if len(names) > MAX_TRACERS:
        raise ValueError(f"tracers: {len(names)} particles are too many to follow, at most {MAX_TRACERS}")
    return names
