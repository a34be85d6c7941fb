"""How well the water keeps what water keeps: density, energy, momentum, and which force gave the momentum."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ocean_sim.observers._csv import CsvFile, heading
from ocean_sim.observers._sampled import Sampled
from ocean_sim.parts import ObserverConfig, quantity

if TYPE_CHECKING:
    from ocean_sim.simulation import Simulation

IMPULSES = ("pressure", "viscosity", "wind", "gravity", "walls", "ship")
COLUMNS = (
    "compression_mean",
    "compression_max",
    "surface_deficit_mean",
    "kinetic_energy_J",
    "potential_energy_J",
    "internal_energy_J",
    "momentum_x_kg_m_s",
    "momentum_y_kg_m_s",
    "momentum_z_kg_m_s",
)


class Config(ObserverConfig):
    every: float = quantity("s", 0.1, gt=0.0)
    """Simulated time between rows."""

    def build(self, folder: Path, simulation: "Simulation") -> "Accuracy":
        return Accuracy(self, folder, simulation)


class Accuracy:
    """accuracy.csv: errors and balances of the whole water, summed in float64."""

    def __init__(self, config: Config, folder: Path, simulation: "Simulation") -> None:
        self.every = config.every
        self.gravity = np.array(simulation.basin.gravity)  # [m/s^2]
        self.terms = [term for term in IMPULSES if term in simulation.fluid.impulse]
        self.sampled = Sampled(config.every)
        self.at_start = self.potential_energy(simulation)
        self.csv = CsvFile(
            folder / "accuracy.csv",
            heading(
                simulation,
                f"every {config.every:g} s, linear between steps",
                compression="max(density / rest density - 1, 0)",
                surface_deficit="max(1 - density / rest density, 0): particles near the surface miss neighbours",
                potential_energy=f"zero in the first state, where it is {self.at_start:.9g} J from y = 0",
                impulse="momentum given to the water since the start, by force",
                clipped="particles that motion_limit held back since the start",
            ),
            [
                "time_s",
                *COLUMNS,
                *(f"impulse_{term}_{axis}_Ns" for term in self.terms for axis in "xyz"),
                "clipped",
                "time_step_s",
                "limited_by",
            ],
        )

    def potential_energy(self, simulation: "Simulation") -> float:
        """Of the particles in gravity, zero at the origin [J]."""
        particles = simulation.fluid.particles
        centre_times_n = particles.position.to_numpy().sum(axis=0, dtype=np.float64)
        return -float(particles.mass * (centre_times_n @ self.gravity))

    def observe(self, simulation: "Simulation") -> None:
        fluid, particles = simulation.fluid, simulation.fluid.particles
        excess = particles.density.to_numpy().astype(np.float64) / particles.rest_density - 1.0
        velocity = particles.velocity.to_numpy().astype(np.float64)
        impulse = fluid.impulse
        values = [
            np.maximum(excess, 0.0).mean(),
            max(excess.max(), 0.0),
            np.maximum(-excess, 0.0).mean(),
            0.5 * particles.mass * (velocity**2).sum(),
            self.potential_energy(simulation) - self.at_start,
            fluid.internal_energy(),
            *(particles.mass * velocity.sum(axis=0)),
            *(component for term in self.terms for component in impulse[term]),
        ]
        held = (fluid.status.clipped, simulation.next_dt, simulation.time_step.limited_by)
        for time, row, (clipped, dt, limit) in self.sampled.rows(simulation.time, np.array(values), held):
            self.csv.row([time, *row, clipped, float(dt), limit])

    def close(self) -> None:
        self.csv.close()
