"""Particles as arrays in the order of their ids: read, set, and sampled over time."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import fsum

import numpy as np

from ocean_sim.conventions import Diverged
from ocean_sim.fluid import with_particles
from ocean_sim.random_numbers import numpy_uniform3
from ocean_sim.simulation import Simulation

SHIFT_STREAM = 501  # of the random numbers that disturb a lattice


@dataclass(frozen=True)
class State:
    """State of all particles at one time, in the order of their ids, in double precision."""

    time: float  # [s]
    mass: float  # [kg] of each
    spacing: float  # [m]
    position: np.ndarray  # (n, 3) [m]
    velocity: np.ndarray  # (n, 3) [m/s]
    pressure: np.ndarray  # (n,) [Pa]
    density: np.ndarray  # (n,) [kg/m3]

    @property
    def kinetic_energy(self) -> float:
        return 0.5 * self.mass * float((self.velocity**2).sum())

    @property
    def momentum(self) -> np.ndarray:
        """Total momentum (3,) [N s], summed exactly: if momenta cancel, a plain sum consists of rounding errors."""
        return self.mass * np.array([fsum(component) for component in self.velocity.T])

    @property
    def angular_momentum(self) -> float:
        """Angular momentum about z [N m s]."""
        x, v = self.position, self.velocity
        return self.mass * fsum(x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0])

    @property
    def max_speed(self) -> float:
        return float(np.sqrt((self.velocity**2).sum(axis=1).max()))


def particle_state(simulation: Simulation) -> State:
    """Read the present state of all particles."""
    water = with_particles(simulation.fluid)
    particles = water.particles
    order = np.argsort(particles.id.to_numpy())
    fields = (particles.velocity, particles.pressure, particles.density)
    arrays = [values.to_numpy()[order].astype(float) for values in fields]
    return State(simulation.time, particles.mass, particles.spacing, water.positions()[order], *arrays)


def set_state(
    simulation: Simulation, position: np.ndarray, velocity: np.ndarray, pressure: np.ndarray | None = None
) -> None:
    """Set positions (n, 3) [m], velocities (n, 3) [m/s] and pressures (n,) [Pa] (None: unchanged) of all particles in
    the order of their ids, and restart the water from them."""
    water = with_particles(simulation.fluid)
    particles = water.particles
    order = particles.id.to_numpy()
    particles.position.from_numpy(position[order])
    particles.velocity.from_numpy(velocity[order])
    if pressure is not None:
        particles.pressure.from_numpy(pressure[order].astype(particles.position.precision))
    water.begin()
    simulation.next_dt = simulation.time_step.next(simulation.fluid.limits())


def random_shifts(simulation: Simulation, at: np.ndarray, size: float) -> np.ndarray:
    """Random displacements (n, 3) of positions `at` (n, 3), each in a cube of half-width `size` [m]; z is 0 in 2-D."""
    random = size * numpy_uniform3(simulation.scene.seed, SHIFT_STREAM, np.arange(len(at)), 0)
    random[:, simulation.basin.dimension :] = 0.0
    return random


def sampled_states(simulation: Simulation, until: float, every: float) -> Iterator[State]:
    """Run until a time [s]; yield the state now and about every `every` [s]; raises Diverged if one is not finite."""
    yield particle_state(simulation)
    for moment in np.arange(every, until + 0.5 * every, every):
        simulation.run(until=float(moment))
        if not simulation.fluid.status.finite:
            raise Diverged(f"velocities or densities are not finite; t = {simulation.time:.4g} s")
        yield particle_state(simulation)


def record_run(
    simulation: Simulation, every: float, quantity: Callable[[State], float | Sequence[complex] | np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Run to the end, and evaluate `quantity` of the state about every `every` [s]. Return times (n,) [s] and its
    values, (n,) or (n, m)."""
    seen = [(state.time, quantity(state)) for state in sampled_states(simulation, simulation.scene.duration, every)]
    times, values = zip(*seen)
    return np.array(times), np.array(values)
