"""The energy of the water, and whether anything but gravity could give it some."""

from typing import TYPE_CHECKING

import numpy as np

from ocean_sim.fluid import with_particles

if TYPE_CHECKING:
    from ocean_sim.simulation import Simulation


def mechanical(simulation: "Simulation", position: np.ndarray, velocity: np.ndarray) -> float:
    """Kinetic and potential (zero at the origin) energy [J] of particles (n, 3) [m], [m/s], summed in float64."""
    mass, centre_times_n = with_particles(simulation.fluid).particles.mass, position.sum(axis=0, dtype=np.float64)
    moving = 0.5 * mass * float(np.square(velocity, dtype=np.float64).sum())
    return moving - mass * float(centre_times_n @ simulation.basin.gravity)


def total(simulation: "Simulation") -> float:
    """The same of all particles, with the energy of compression [J]."""
    particles = with_particles(simulation.fluid).particles
    moving = mechanical(simulation, particles.position.to_numpy(), particles.velocity.to_numpy())
    return moving + simulation.fluid.internal_energy()


def stored_by_weight(simulation: "Simulation") -> float:
    """What the water's own weight compresses, at most: (g depth)^2 / (6 c^2) for each kilogram of a still basin [J]."""
    fluid, basin = simulation.fluid, simulation.basin
    particles = with_particles(fluid).particles
    head = float(np.linalg.norm(basin.gravity)) * basin.depth  # [m2/s2]
    return particles.mass * particles.count.now * head**2 / (6.0 * fluid.sound_speed**2)


def falls_around(simulation: "Simulation") -> bool:
    """Whether what the water falls through is not all in its potential energy: a body force, a tank that moves, or
    gravity along an axis that is periodic."""
    basin = simulation.basin
    around = any(period > 0.0 and g != 0.0 for period, g in zip(basin.periods, basin.gravity, strict=True))
    return around or any(simulation.scene.fluid.steady_force) or basin.config.motion is not None


def driven(simulation: "Simulation") -> bool:
    """Whether wind, walls or obstacles that move, ships, new water or a body force may give energy to the water."""
    scene, basin = simulation.scene, simulation.basin.config
    walls = basin.wavemaker or simulation.basin.gates or (basin.lid is not None and any(basin.lid.velocity))
    return bool(not scene.wind.still or walls or simulation.ships or scene.fluid.driven or falls_around(simulation))
