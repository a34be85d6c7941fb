"""The momentum of the water against the impulses that all forces have given it."""

from typing import TYPE_CHECKING

import numpy as np

from ocean_sim.fluid import Totals, with_particles

if TYPE_CHECKING:
    from ocean_sim.simulation import Simulation


class Momentum:
    """Of particles, from now on; only where the fluid sums the impulse of each force, which `accuracy` asks it to."""

    def __init__(self, simulation: "Simulation") -> None:
        self.first = self.unaccounted(simulation, with_particles(simulation.fluid).totals())

    def unaccounted(self, simulation: "Simulation", totals: Totals) -> np.ndarray:
        """(3,) what no force has given since the fluid was made [kg m/s]."""
        moving = with_particles(simulation.fluid).particles.mass * totals.velocity
        return moving - sum(simulation.fluid.impulse.values(), np.zeros(3))

    def from_nowhere(self, simulation: "Simulation", totals: Totals) -> float:
        """What came from nowhere since, over all impulses and the mass times the reference speed; 0 where nothing is
        summed, or where `motion_limit` has held particles back."""
        fluid = simulation.fluid
        impulses = fluid.impulse
        if not impulses or fluid.status.clipped:
            return 0.0
        given = sum(float(np.linalg.norm(impulse)) for impulse in impulses.values())
        particles = with_particles(fluid).particles
        scale = given + particles.mass * particles.count.now * fluid.reference_speed
        return float(np.linalg.norm(self.unaccounted(simulation, totals) - self.first)) / scale
