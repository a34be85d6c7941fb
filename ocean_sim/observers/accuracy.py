"""Errors of density, energy and momentum of the water, and the impulse and work of each force."""

from pathlib import Path
from typing import ClassVar

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.fluid import ParticleFluid, Totals, with_particles
from ocean_sim.model import Faults, quantity
from ocean_sim.observers.shared.checks import Balance, distance_outside, kinetic_and_potential, surely_inside
from ocean_sim.observers.shared.csv_rows import CsvFile, Sampled, heading, legend
from ocean_sim.parts import PeriodicConfig, SceneFacts
from ocean_sim.simulation import Observer, Simulation
from ocean_sim.surface import Surface

FORCE_TERMS = (
    *("pressure", "viscosity", "wind", "gravity", "walls", "bed", "sea", "obstacles", "ship", "emitter"),
    *("diffusion", "leak", "shifting", "breaking"),
)
SOLVER_COLUMNS = ("iterations", "iterations_last", "error_last", "error_max", "unsolved")
MAX_ROWS_PER_STEP = 1000  # a step that passes more rows has two: values between them lie on a line
BALANCE_COLUMNS = (
    *("compression_mean", "compression_max", "surface_deficit_mean"),
    *("kinetic_energy_J", "potential_energy_J", "internal_energy_J", "energy_residual_J"),
    *(f"momentum_{axis}_kg_m_s" for axis in "xyz"),
    *(f"angular_momentum_{axis}_kg_m2_s" for axis in "xyz"),
)

SURFACE_COLUMN_WIDTH = 2.0  # [spacings] at least, of a column in which the highest particle is looked for


class Config(PeriodicConfig):
    turn: ClassVar[int] = -2
    leaves: ClassVar[str] = "accuracy.csv; sums over all particles"
    every: float = quantity("s", 0.1, gt=0.0)
    """Simulated time between rows."""

    def mismatches(self, preflight: SceneFacts) -> Faults:
        if not preflight.sums_impulses:
            yield (), "reads impulses, and the water sums none; set fluid.impulses: true, or accuracy: null"


class Accuracy(Observer, of=Config):
    """Writes accuracy.csv: errors and balances summed over all water, in float64. Water without particles has only the
    work of each force and the time step."""

    def __init__(self, config: Config, folder: Path, simulation: Simulation) -> None:
        self.every = config.every
        self.sampled = Sampled(config.every, most=MAX_ROWS_PER_STEP)
        self.impulse_terms: list[str] = []
        self.surface = simulation.surface
        self.solvers: tuple[str, ...] = ()  # of a scheme that iterates
        self.work_terms = [term for term in FORCE_TERMS if term in simulation.fluid.work]
        meaning: dict[str, object] = {}
        if simulation.fluid.particles is not None:
            fluid = simulation.fluid
            self.impulse_terms = [term for term in FORCE_TERMS if term in fluid.impulse]
            self.at_start = kinetic_and_potential(simulation, with_particles(fluid).totals())[1]
            self.balance = Balance(simulation, self.work_terms)
            self.solvers = tuple(fluid.solvers)
            meaning = self.column_meaning()
            if self.surface is not None:
                measured = {name.rsplit("_m", 1)[0]: what for name, what in self.surface.measured.items()}
                meaning |= legend("accuracy_of_surface") | measured
        elif self.work_terms:
            meaning = legend("accuracy_of_tile")
        self.csv = CsvFile(
            folder / "accuracy.csv",
            heading(simulation, f"every {config.every:g} s, linear between steps", **meaning),
            [
                "time_s",
                *(BALANCE_COLUMNS if simulation.fluid.particles is not None else ()),
                *(f"impulse_{term}_{axis}_Ns" for term in self.impulse_terms for axis in "xyz"),
                *(f"work_{term}_J" for term in self.work_terms),
                *(() if self.surface is None else ("surface_offset_m", "surface_fit_m", *self.surface.measured)),
                *(("outside", "clipped") if simulation.fluid.particles is not None else ()),
                *(f"{solver}_{name}" for solver in self.solvers for name in SOLVER_COLUMNS),
                "time_step_s",
                "limited_by",
            ],
        )

    def column_meaning(self) -> dict[str, object]:
        """Comment lines of accuracy.csv: the meaning of each column, or group of columns, by name."""
        given = " + ".join(f"work_{term}" for term in self.balance.outer_terms) or "0"
        if self.balance.driven:
            given += " + (work_gravity + potential energy gained), the work of forces that have no potential"
        solvers = legend("accuracy_of_solvers")
        meaning = legend("accuracy", at_start=self.at_start, given=given)
        return meaning | {solver: solvers[solver] for solver in self.solvers}

    def balances(self, simulation: Simulation, totals: Totals) -> list[float]:
        """Values of the columns BALANCE_COLUMNS (compression, energies and momenta of all water), then impulse [N s]
        and work [J] of each force since the start. `totals`: sums over all particles."""
        fluid = with_particles(simulation.fluid)
        n, mass = fluid.particles.count.now, fluid.particles.mass
        impulse, work, internal = fluid.impulse, fluid.work, fluid.internal_energy()
        motion, lifted = kinetic_and_potential(simulation, totals)
        gained = lifted - self.at_start
        return [
            totals.compression / n,
            totals.most_compressed,
            totals.deficit / n,
            motion,
            gained,
            internal,
            self.balance.residual(motion + gained + internal, gained, work),
            *(mass * totals.velocity),
            *(mass * totals.turning),
            *(component for term in self.impulse_terms for component in impulse[term]),
            *(work[term] for term in self.work_terms),
        ]

    def observe(self, simulation: Simulation) -> None:
        fluid = simulation.fluid
        values = [fluid.work[term] for term in self.work_terms] if fluid.particles is None else []
        counts: tuple[float, ...] = ()
        if fluid.particles is not None:
            water = with_particles(fluid)
            totals = water.totals()
            values = self.balances(simulation, totals)
            if self.surface is not None:
                values += [*surface_fit(self.surface, highest_particles(simulation.basin, water))]
                values += self.surface.measures()
            outside = 0
            if not surely_inside(totals, simulation.basin):
                position = water.particles.position.to_numpy()
                away = distance_outside(position, simulation.basin, simulation.time, water.spacing)
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


def highest_particles(basin: Basin, fluid: ParticleFluid) -> np.ndarray:
    """Points (m, 3) [m] half a spacing above the top particle of each vertical column, two spacings wide, of water."""
    x = fluid.particles.snapshot().position
    lower, size = np.array(basin.lower)[[0, 2]], np.subtract(basin.upper, basin.lower)[[0, 2]]
    counts = np.maximum(1, (size / (SURFACE_COLUMN_WIDTH * fluid.spacing) + 1.0e-6).astype(int))
    # Sides in the precision of the positions: a particle on the border of two columns lies in the same one as ever.
    lower, size = (side.astype(x.dtype).astype(float) for side in (lower, np.where(size > 0.0, size, 1.0)))
    cell = np.clip(((x[:, [0, 2]].astype(float) - lower) / size * counts).astype(int), 0, counts - 1)
    upwards = x[:, 1].argsort(kind="stable")
    highest = np.full(counts.prod(), -1)
    highest[cell[upwards] @ [counts[1], 1]] = upwards  # the last that is assigned stays
    return x[highest[highest >= 0]].astype(float) + [0.0, 0.5 * fluid.spacing, 0.0]


def surface_fit(surface: Surface, points: np.ndarray) -> tuple[float, float]:
    """Mean and root mean square [m] of the height of the drawn `surface` above `points` (m, 3) [m]."""
    away = surface.elevations(points[:, [0, 2]]) - points[:, 1]
    return float(away.mean()), float(np.sqrt(np.square(away).mean()))
