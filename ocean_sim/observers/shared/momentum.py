"""The momentum of the water against the impulses that all forces have given it."""

from typing import TYPE_CHECKING

import numpy as np

from ocean_sim.fluid import with_particles

if TYPE_CHECKING:
    from ocean_sim.simulation import Simulation


class Momentum:
    """Of particles, from now on; only where the fluid sums the impulse of each force, which `accuracy` asks it to."""

    def __init__(self, simulation: "Simulation") -> None:
        self.first = self.unaccounted(simulation, with_particles(simulation.fluid).particles.velocity.to_numpy())

    def unaccounted(self, simulation: "Simulation", velocity: np.ndarray) -> np.ndarray:
        """(3,) what no force has given since the fluid was made [kg m/s], at velocities (n, 3) [m/s]."""
        moving = with_particles(simulation.fluid).particles.mass * velocity.sum(axis=0, dtype=np.float64)
        return moving - sum(simulation.fluid.impulse.values(), np.zeros(3))

    def from_nowhere(self, simulation: "Simulation", velocity: np.ndarray) -> float:
        """What came from nowhere since, at velocities (n, 3) [m/s], over all impulses and the mass times the reference
        speed; 0 where nothing is summed, or where `motion_limit` has held particles back."""
        fluid = simulation.fluid
        impulses = fluid.impulse
        if not impulses or fluid.status.clipped:
            return 0.0
        given = sum(float(np.linalg.norm(impulse)) for impulse in impulses.values())
        scale = given + with_particles(fluid).particles.mass * len(velocity) * fluid.reference_speed
        return float(np.linalg.norm(self.unaccounted(simulation, velocity) - self.first)) / scale
