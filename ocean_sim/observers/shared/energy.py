"""Energy of the water, and the forces that may give energy to it."""

from collections.abc import Sequence

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.fluid import Totals, with_particles
from ocean_sim.simulation import Simulation

INSEPARABLE_TERMS = ("pressure", "walls")  # only the sum of their work is known, see `separable_work_terms`
CONVERSION_TERMS = ("gravity", "pressure")  # their work turns one energy into another
DRIVING_TERMS = ("wind", "gravity", "walls", "sea", "obstacles", "ship", "emitter")  # the others only take energy
UNSTORED_SCALE = 0.01  # of the mass times the square of the reference speed, where no energy is stored


class Balance:
    """Compares the energy gained by the particles with the work of all forces, which the fluid has to sum."""

    at_first: float | None

    def __init__(self, simulation: Simulation, working: Sequence[str]) -> None:
        """`working`: names of the forces whose work is summed, in the order in which they are added."""
        inner = CONVERSION_TERMS[: 1 if simulation.fluid.solvers else 2]  # incompressible water stores no energy
        self.outer_terms = [term for term in working if term not in inner]  # they give and take energy
        self.driven = not simulation.basin.has_potential(simulation.scene.fluid.steady_force)
        self.at_first = None

    def residual(self, energy: float, potential_energy: float, work: dict[str, float]) -> float:
        """Gain of `energy` [J] since the first call that no force has given; `work`: of each force so far [J]."""
        given = sum(work[term] for term in self.outer_terms)
        if self.driven:
            given += work.get("gravity", 0.0) + potential_energy
        if self.at_first is None:
            self.at_first = energy - given
        return energy - given - self.at_first


def kinetic_energy(mass: float, totals: Totals) -> float:
    """Kinetic energy [J] of all particles; `mass`: of one particle [kg]."""
    return 0.5 * mass * totals.squared_speed


def potential_energy(mass: float, totals: Totals, gravity: Sequence[float] | np.ndarray) -> float:
    """Potential energy [J] of all particles in gravity [m/s2], zero at the origin; `mass`: of one particle [kg]."""
    with np.errstate(invalid="ignore"):  # infinite is NaN along axes without gravity
        return -mass * float(totals.position @ gravity)


def mechanical_energy(simulation: Simulation, totals: Totals) -> float:
    """Kinetic plus potential energy [J] of all particles, from their totals."""
    mass = with_particles(simulation.fluid).particles.mass
    return kinetic_energy(mass, totals) + potential_energy(mass, totals, simulation.basin.gravity)


def total_energy(simulation: Simulation) -> float:
    """Kinetic, potential and compression energy [J] of all particles together."""
    return mechanical_energy(simulation, with_particles(simulation.fluid).totals()) + simulation.fluid.internal_energy()


def stored_by_weight(simulation: Simulation) -> float:
    """Greatest energy [J] of compression by the water's weight, at rest: (g depth)^2 / (6 c^2) per kilogram."""
    fluid, basin = simulation.fluid, simulation.basin
    particles = with_particles(fluid).particles
    head = float(np.linalg.norm(basin.gravity)) * basin.depth  # [m2/s2]
    return particles.mass * particles.count.now * head**2 / (6.0 * fluid.sound_speed**2)


def energy_scale(simulation: Simulation) -> float:
    """Energy [J] in water at rest to which a gain is compared: that which its weight stores by compression, and in a
    patch of open sea that of its waves; where none is stored, a hundredth of mass times reference speed squared. Over
    a bed with a shape, and where none is stored, also the energy that lifts the water by a spacing: packed particles
    and solved water move by hundredths of one as their lattice gives way."""
    basin, particles = simulation.basin, with_particles(simulation.fluid).particles
    compresses = simulation.fluid.sound_speed > 0.0 and not simulation.fluid.solvers
    stored = stored_by_weight(simulation) if compresses else 0.0
    mass = particles.mass * particles.count.now
    lifted = mass * float(np.linalg.norm(basin.gravity)) * particles.spacing  # [J]
    if stored == 0.0:
        return mass * UNSTORED_SCALE * simulation.fluid.reference_speed**2 + lifted
    if basin.ground is not None:
        return stored + lifted
    sea = None if basin.sea is None else basin.sea.plane_waves(basin)
    if sea is None:
        return stored
    area = basin.config.length * (basin.config.width or 1.0)  # [m2]
    return stored + 0.5 * particles.rest_density * sea.gravity * float((sea.amplitude**2).sum()) * area


def separable_work_terms(simulation: Simulation) -> list[str]:
    """Names of the forces whose summed work is the energy given to the water; empty where that is unknown.

    Water that solves for its pressure stores no energy in it: pressure and walls give elsewhere the energy that
    pressure takes. Their sum holds the error of the solver and the work of the walls. The two cannot be separated where
    walls drive the water, and the list is empty.
    """
    fluid = simulation.fluid
    if not fluid.solvers:
        return list(fluid.work)
    return [] if has_driving_walls(simulation.basin) else [term for term in fluid.work if term not in INSEPARABLE_TERMS]


def has_driving_walls(basin: Basin) -> bool:
    """True if a wavemaker or a lid moves, or an absorbing zone relaxes the water towards a given motion."""
    lid, absorbing = basin.config.lid, [side.absorbing for side in basin.sides if side.absorbing is not None]
    moved = basin.config.wavemaker is not None or (lid is not None and any(lid.velocity))
    return moved or any(zone.target is not None for zone in absorbing)


def gains_energy(simulation: Simulation) -> bool:
    """True if wind, moving walls or obstacles, ships, inflow or a body force may give energy to the water."""
    scene, basin = simulation.scene, simulation.basin
    moved = has_driving_walls(basin) or basin.gates or simulation.ships
    return bool(
        not scene.wind.still or moved or scene.fluid.driven or not basin.has_potential(scene.fluid.steady_force)
    )
