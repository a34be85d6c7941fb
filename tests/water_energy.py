"""The energy of all water, for tests of what may change it."""

from ocean_sim.fluid import with_particles
from ocean_sim.observers.shared.checks import kinetic_and_potential
from ocean_sim.simulation import Simulation


def total_energy(simulation: Simulation) -> float:
    """Kinetic, potential and compression energy [J] of all particles together."""
    totals = with_particles(simulation.fluid).totals()
    return sum(kinetic_and_potential(simulation, totals)) + simulation.fluid.internal_energy()
