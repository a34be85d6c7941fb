"""The energy of the water, and whether anything but gravity could give it some."""

from collections.abc import Sequence

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.fluid import Totals, with_particles
from ocean_sim.simulation import Simulation

HOLDING = ("pressure", "walls")  # forces of which only the sum tells, see `told_apart`
BETWEEN_ENERGIES = ("gravity", "pressure")  # their work turns one energy into another; pressure's where water stores it


class Balance:
    """The energy of particles against the work of all forces from the first look on; only where the fluid sums it."""

    at_first: float | None

    def __init__(self, simulation: Simulation, working: Sequence[str]) -> None:
        """`working`: the forces whose work is summed, in the order in which they are added."""
        between = BETWEEN_ENERGIES[: 1 if simulation.fluid.solvers else 2]  # what is not compressed stores nothing
        self.outer = [term for term in working if term not in between]  # forces that give and take energy
        self.driven = falls_around(simulation)
        self.at_first = None

    def residual(self, energy: float, potential: float, work: dict[str, float]) -> float:
        """Energy [J] that the water has gained since the first look and no force has given."""
        given = sum(work[term] for term in self.outer)
        if self.driven:
            given += work.get("gravity", 0.0) + potential
        if self.at_first is None:
            self.at_first = energy - given
        return energy - given - self.at_first


def kinetic(mass: float, totals: Totals) -> float:
    """Energy of motion [J] of particles that each have this mass [kg]."""
    return 0.5 * mass * totals.squared_speed


def potential(mass: float, totals: Totals, gravity: Sequence[float] | np.ndarray) -> float:
    """Energy [J] of the same in gravity [m/s2], zero at the origin."""
    with np.errstate(invalid="ignore"):  # infinite is NaN along axes without gravity
        return -mass * float(totals.position @ gravity)


def mechanical(simulation: Simulation, totals: Totals) -> float:
    """Kinetic and potential energy [J] of all particles."""
    mass = with_particles(simulation.fluid).particles.mass
    return kinetic(mass, totals) + potential(mass, totals, simulation.basin.gravity)


def total(simulation: Simulation) -> float:
    """The same, with the energy of compression [J]."""
    return mechanical(simulation, with_particles(simulation.fluid).totals()) + simulation.fluid.internal_energy()


def stored_by_weight(simulation: Simulation) -> float:
    """What the water's own weight compresses, at most: (g depth)^2 / (6 c^2) for each kilogram of a still basin [J]."""
    fluid, basin = simulation.fluid, simulation.basin
    particles = with_particles(fluid).particles
    head = float(np.linalg.norm(basin.gravity)) * basin.depth  # [m2/s2]
    return particles.mass * particles.count.now * head**2 / (6.0 * fluid.sound_speed**2)


def at_stake(simulation: Simulation) -> float:
    """Energy [J] beside which a gain counts: of the motion at the reference speed; in a patch of open sea with waves
    theirs, of motion and of height, and what the weight of the water stores, if the scheme stores any."""
    basin, particles = simulation.basin, with_particles(simulation.fluid).particles
    sea = None if basin.sea is None else basin.sea.plane_waves(basin)
    if sea is None or simulation.fluid.solvers:
        return particles.mass * particles.count.now * simulation.fluid.reference_speed**2
    area = basin.config.length * (basin.config.width or 1.0)  # [m2]
    waves = 0.5 * particles.rest_density * sea.gravity * float((sea.amplitude**2).sum()) * area
    return waves + stored_by_weight(simulation)


def falls_around(simulation: Simulation) -> bool:
    """Whether what the water falls through is not all in its potential energy: a body force, a tank that moves, or
    gravity along an axis that is periodic."""
    basin = simulation.basin
    around = any(period > 0.0 and g != 0.0 for period, g in zip(basin.periods, basin.gravity, strict=True))
    return around or any(simulation.scene.fluid.steady_force) or basin.config.motion is not None


def told_apart(simulation: Simulation) -> list[str]:
    """The forces whose work says what the water was given.

    Water that solves for its pressure stores no energy in it: what pressure takes, pressure and walls give elsewhere.
    Their sum is what its solvers make or take, and what walls give; where walls drive, that is not known: none.
    """
    fluid = simulation.fluid
    if not fluid.solvers:
        return list(fluid.work)
    return [] if walls_drive(simulation.basin) else [term for term in fluid.work if term not in HOLDING]


def walls_drive(basin: Basin) -> bool:
    """Whether a piston or a lid moves, or the zone before an absorbing side has a motion that it leaves alone."""
    lid, absorbing = basin.config.lid, [side.absorbing for side in basin.sides if side.absorbing is not None]
    moved = basin.config.wavemaker is not None or (lid is not None and any(lid.velocity))
    return moved or any(zone.target is not None for zone in absorbing)


def driven(simulation: Simulation) -> bool:
    """Whether wind, walls or obstacles that move, ships, new water or a body force may give energy to the water."""
    scene, basin = simulation.scene, simulation.basin
    walls = walls_drive(basin) or basin.gates
    return bool(not scene.wind.still or walls or simulation.ships or scene.fluid.driven or falls_around(simulation))
