"""How well the water conserves density, energy and momentum, and how much each force gave or took."""

from pathlib import Path
from typing import ClassVar

import numpy as np

from ocean_sim.fluid import ParticleFluid, Totals, with_particles
from ocean_sim.model import quantity
from ocean_sim.observers.shared.checks import beyond, kept
from ocean_sim.observers.shared.csv_rows import CsvFile, Sampled, heading
from ocean_sim.observers.shared.energy import Balance, kinetic, potential
from ocean_sim.observers.shared.surface_fit import SurfaceFit
from ocean_sim.parts import Preflight, Problems
from ocean_sim.simulation import Observer, PeriodicConfig, Simulation

TERMS = (
    "pressure",
    "viscosity",
    "wind",
    "gravity",
    "walls",
    "bed",
    "sea",
    "obstacles",
    "ship",
    "emitter",
    "diffusion",
    "shifting",
    "breaking",
)
SOLVED_FOR = {
    "density": "mean error of the density over the rest density",
    "divergence": "mean compression in a step over the rest density",
}
SOLVED = ("iterations", "iterations_last", "error_last", "error_max", "unsolved")
MOST_ROWS = 1000  # of a step: where it is longer than as many rows, it has two, for the line between them says no more
COLUMNS = (
    "compression_mean",
    "compression_max",
    "surface_deficit_mean",
    "kinetic_energy_J",
    "potential_energy_J",
    "internal_energy_J",
    "energy_residual_J",
    *(f"momentum_{axis}_kg_m_s" for axis in "xyz"),
    *(f"angular_momentum_{axis}_kg_m2_s" for axis in "xyz"),
)


class Config(PeriodicConfig):
    turn: ClassVar[int] = -2
    leaves: ClassVar[str] = "accuracy.csv; sums over all particles"
    every: float = quantity("s", 0.1, gt=0.0)
    """Simulated time between rows."""

    def mismatches(self, preflight: Preflight) -> Problems:
        if preflight.sums_impulses:
            return []
        return [((), "reads impulses, and the water sums none; set fluid.impulses: true, or accuracy: null")]

    def build(self, folder: Path, simulation: Simulation) -> "Accuracy":
        return Accuracy(self, folder, simulation)


class Accuracy(Observer):
    """accuracy.csv: errors and balances of the whole water, summed in float64; of water without particles there are
    only the works that it counts and the time step."""

    def __init__(self, config: Config, folder: Path, simulation: Simulation) -> None:
        self.every = config.every
        self.sampled = Sampled(config.every, most=MOST_ROWS)
        self.gravity = np.array(simulation.basin.gravity)  # [m/s2]
        self.pushing: list[str] = []
        self.surface: SurfaceFit | None = None
        if simulation.surface is not None:
            self.surface = SurfaceFit(simulation.surface, simulation.basin, with_particles(simulation.fluid))
        self.solvers: tuple[str, ...] = ()  # of a scheme that iterates
        self.working = [term for term in TERMS if term in simulation.fluid.work]
        meaning: dict[str, object] = {}
        if simulation.fluid.particles is not None:
            fluid = simulation.fluid
            self.pushing = [term for term in TERMS if term in fluid.impulse]
            water = with_particles(fluid)
            self.at_start = potential(water.particles.mass, water.totals(), self.gravity)
            self.balance = Balance(simulation, self.working)
            self.solvers = tuple(fluid.solvers)
            meaning = self.meaning() | (self.surface.meaning if self.surface else {})
        elif self.working:
            meaning = {"work": "energy given to a tile of the sea since the start, by what gives or takes it"}
        self.csv = CsvFile(
            folder / "accuracy.csv",
            heading(simulation, f"every {config.every:g} s, linear between steps", **meaning),
            [
                "time_s",
                *(COLUMNS if simulation.fluid.particles is not None else ()),
                *(f"impulse_{term}_{axis}_Ns" for term in self.pushing for axis in "xyz"),
                *(f"work_{term}_J" for term in self.working),
                *(self.surface.columns if self.surface else ()),
                *(("outside", "clipped") if simulation.fluid.particles is not None else ()),
                *(f"{solver}_{what}" for solver in self.solvers for what in SOLVED),
                "time_step_s",
                "limited_by",
            ],
        )

    def meaning(self) -> dict[str, object]:
        """What the columns mean."""
        given = " + ".join(f"work_{term}" for term in self.balance.outer) or "0"
        if self.balance.driven:
            given += " + (work_gravity + potential energy gained), the work of forces that have no potential"
        means: dict[str, object] = {
            "compression": "max(density / rest density - 1, 0)",
            "surface_deficit": "max(1 - density / rest density, 0): particles near the surface miss neighbours",
            "potential_energy": f"zero in the first state, where it is {self.at_start:.9g} J from y = 0",
            "energy_residual": f"kinetic + potential + internal energy gained since the first row - ({given})",
            "angular_momentum": "about the origin",
            "impulse": "momentum given to the water since the start, by force",
            "work": "energy given to the water since the start, by force; gravity with body force",
            "outside": "particles beyond a wall, floor or lid",
            "clipped": "particles that motion_limit held back since the start",
        }
        for solver in self.solvers:
            means[solver] = (
                f"its solver: iterations since the start and in the last step, {SOLVED_FOR[solver]} that the last step "
                "ended with and the worst since the start, steps that ended at the limit of iterations"
            )
        return means

    def balances(self, fluid: ParticleFluid, totals: Totals) -> list[float]:
        """The numbers of COLUMNS, then impulses and works."""
        n, mass = fluid.particles.count.now, fluid.particles.mass
        impulse, work = fluid.impulse, fluid.work
        moving, internal = kinetic(mass, totals), fluid.internal_energy()
        gained = potential(mass, totals, self.gravity) - self.at_start
        return [
            totals.compression / n,
            totals.most_compressed,
            totals.deficit / n,
            moving,
            gained,
            internal,
            self.balance.residual(moving + gained + internal, gained, work),
            *(mass * totals.velocity),
            *(mass * totals.turning),
            *(component for term in self.pushing for component in impulse[term]),
            *(work[term] for term in self.working),
        ]

    def observe(self, simulation: Simulation) -> None:
        fluid = simulation.fluid
        values = [fluid.work[term] for term in self.working] if fluid.particles is None else []
        counts: tuple[float, ...] = ()
        if fluid.particles is not None:
            water = with_particles(fluid)
            totals = water.totals()
            values = self.balances(water, totals) + (self.surface.values() if self.surface else [])
            outside = 0
            if not kept(totals, simulation.basin):
                away = beyond(water.particles.position.to_numpy(), simulation.basin, simulation.time)
                outside = int(np.count_nonzero(away))
            counts = (outside, fluid.status.clipped)
            for name in self.solvers:
                s = fluid.solvers[name]
                counts += (s.iterations, s.last_iterations, s.last_error, s.error, s.unsolved)
        unsampled = (*counts, float(simulation.next_dt), simulation.time_step.limited_by)
        for time, row, held in self.sampled.rows(simulation.time, np.array(values), unsampled):
            self.csv.row([time, *row, *held])

    def close(self) -> None:
        self.csv.close()
