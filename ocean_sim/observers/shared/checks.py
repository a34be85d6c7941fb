"""Checks of all particles: walls hold, water does not swell, symmetry and balances of momentum and energy persist."""

from collections.abc import Sequence

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.fluid import Totals, with_particles
from ocean_sim.simulation import Simulation

WALL_TOLERANCE = 1.0e-6  # of the basin's largest coordinate: a few rounding errors of a float32
LEVEL_COLUMN_WIDTH = 3.0  # [spacings] about, of the columns of `level_ratio`
IMAGE_TOLERANCE = 1e-4  # of spacing and reference speed, for two halves that begin as images
INSEPARABLE_TERMS = ("pressure", "walls")  # only the sum of their work is known, see `separable_work_terms`
CONVERSION_TERMS = ("gravity", "pressure")  # their work turns one energy into another
DRIVING_TERMS = ("wind", "gravity", "walls", "sea", "obstacles", "ship", "emitter")  # the others only take energy
UNSTORED_SCALE = 0.01  # of the mass times the square of the reference speed, where no energy is stored


def surely_inside(totals: Totals, basin: Basin) -> bool:
    """True if the bounding box in `totals` proves all particles inside the basin; else each has to be checked."""
    low, up = basin.stops()
    flat = not basin.config.obstacles and basin.ground is None
    return flat and bool((totals.lower >= low).all() and (totals.upper <= up).all())


def distance_outside(position: np.ndarray, basin: Basin, time: float, spacing: float) -> np.ndarray:
    """Distance (n,) [m] of particles at `position` (n, 3) [m], `spacing` [m] apart, beyond walls or inside obstacles at
    a time [s]; 0 if in the water."""
    low, up = (np.array(stop) for stop in basin.stops())
    distance = np.linalg.norm(position - np.clip(position, low, up), axis=1)
    for least, most in basin.obstacles_at(time):
        distance = np.maximum(distance, np.minimum(position - least, np.array(most) - position).min(axis=1))
    for mesh, way in basin.meshes_at(time):
        distance = np.maximum(distance, -mesh.distances(position - way, spacing))
    if basin.ground is not None:
        distance = np.maximum(distance, -basin.ground.distances(position))
    return np.where(distance > WALL_TOLERANCE * np.abs([basin.lower, basin.upper]).max(), distance, 0.0)


def level_ratio(position: np.ndarray, spacing: float, basin: Basin, time: float) -> float:
    """Height of the centre of mass of particles at `position` (n, 3) [m] over the bed and mesh obstacles at a `time`
    [s], as a ratio to its height at rest; NaN if a position is not finite. At rest, the particles of each column (three
    times `spacing` [m] wide) lie on the bed at rest density, in at least one layer."""
    if not np.isfinite(position).all():
        return float("nan")
    axes = [0, 2][: basin.dimension - 1]
    lower, size = np.array(basin.lower), np.subtract(basin.upper, basin.lower)[axes]
    side = size / np.maximum(1.0, np.round(size / (LEVEL_COLUMN_WIDTH * spacing)))
    place = np.floor((position[:, axes] - lower[axes]) / side).astype(np.int64)
    place -= place.min(axis=0)
    held = np.unique(place @ [1, *(place.max(axis=0) + 1)[:-1]], return_counts=True)[1]
    tall = np.maximum(held * spacing**basin.dimension / side.prod(), spacing)  # of each column's water at rest [m]
    foot = lower[1] if basin.ground is None else basin.ground.heights(position[:, [0, 2]])
    places = np.where([True, False, True], spacing * np.round(position / spacing), position)  # few columns for meshes
    for mesh, way in basin.meshes_at(time):
        foot = np.maximum(foot, mesh.tops_below(places - way) + way[1])
    return float((position[:, 1] - foot).sum() / (held * tall / 2.0).sum())


class Symmetry:
    """Check that water which begins symmetric about x = 0 or z = 0 stays so: pairs of particles ("twins") remain mirror
    images. Rounding separates them, in 50 steps by up to 3e-5 spacings (2.5e-3 with a pressure solver)."""

    def __init__(self, simulation: Simulation) -> None:
        basin, self.twins = simulation.basin, dict[int, np.ndarray]()
        if gains_energy(simulation) or basin.sea is not None:
            return
        place, velocity = sorted_by_id(simulation)
        spacing = with_particles(simulation.fluid).spacing
        for axis in (0, 2)[: basin.dimension - 1]:
            if not is_symmetric(basin, axis):
                continue
            here, there = (np.lexsort((x / spacing).round(3).T + 0.0) for x in (place, mirrored(place, axis)))
            twin = np.empty(len(place), dtype=int)
            twin[here] = there
            apart = mirrored(place[twin], axis) - place, mirrored(velocity[twin], axis) - velocity
            scales = spacing, simulation.fluid.reference_speed
            if all(np.abs(way).max(initial=0.0) <= IMAGE_TOLERANCE * scale for way, scale in zip(apart, scales)):
                self.twins[axis] = twin

    def largest_distance(self, simulation: Simulation) -> float:
        """Largest distance [spacings], along an axis, between a particle and the mirror image of its twin, the particle
        that was its image in x = 0 or z = 0 at first; 0 if there are no such pairs to check."""
        if not self.twins:
            return 0.0
        place, _ = sorted_by_id(simulation)
        apart = [np.abs(mirrored(place[twin], axis) - place).max() for axis, twin in self.twins.items()]
        return float(max(apart)) / with_particles(simulation.fluid).spacing


def sorted_by_id(simulation: Simulation) -> tuple[np.ndarray, np.ndarray]:
    """Positions [m] and velocities [m/s], each (n, 3), of all particles in the order of their ids."""
    snapshot = with_particles(simulation.fluid).particles.snapshot()
    order = np.argsort(snapshot.id)
    return snapshot.position[order].astype(float), snapshot.velocity[order].astype(float)


def mirrored(vectors: np.ndarray, axis: int) -> np.ndarray:
    """(n, 3) vectors with the component along `axis` reversed."""
    return vectors * np.where(np.arange(3) == axis, -1.0, 1.0)


def is_symmetric(basin: Basin, axis: int) -> bool:
    """True if gravity, walls and boxes equal their mirror images across `axis` = 0, and there is no mesh."""
    name = "xyz"[axis]
    walls = basin.walls.at(f"{name}_min") == basin.walls.at(f"{name}_max")
    boxes = {tuple(np.round([*low, *up], 9)) for low, up in basin.obstacles}
    turned = set()
    for low, up in basin.obstacles:
        ends = np.array([low, up], dtype=float)
        ends[:, axis] = -ends[::-1, axis]
        turned.add(tuple(np.round(ends.ravel(), 9)))
    return walls and basin.gravity[axis] == 0.0 and boxes == turned and not basin.meshes


class Momentum:
    """Check of momentum: compares the gain of the water since this object was made with the impulses of all forces."""

    def __init__(self, simulation: Simulation) -> None:
        self.first = self.unexplained(simulation, with_particles(simulation.fluid).totals())

    def unexplained(self, simulation: Simulation, totals: Totals) -> np.ndarray:
        """Momentum (3,) [kg m/s] of the water less all impulses since it was built; `totals`: sums over particles."""
        moving = with_particles(simulation.fluid).particles.mass * totals.velocity
        return moving - sum(simulation.fluid.impulse.values(), np.zeros(3))

    def unexplained_share(self, simulation: Simulation, totals: Totals) -> float:
        """Momentum gained without an impulse, over the sum of all impulses plus mass times reference speed."""
        fluid = simulation.fluid
        impulses = fluid.impulse
        if not impulses or fluid.status.clipped:
            return 0.0
        given = sum(float(np.linalg.norm(impulse)) for impulse in impulses.values())
        particles = with_particles(fluid).particles
        scale = given + particles.mass * particles.count.now * fluid.reference_speed
        return float(np.linalg.norm(self.unexplained(simulation, totals) - self.first)) / scale


class Balance:
    """Check of energy: compares the energy gained by the particles with the work of all forces."""

    at_first: float | None

    def __init__(self, simulation: Simulation, working: Sequence[str]) -> None:
        """`working`: names of the forces whose work is summed, in the order of the sum."""
        inner = CONVERSION_TERMS[: 1 if simulation.fluid.solvers else 2]  # incompressible water stores no energy
        self.outer_terms = [term for term in working if term not in inner]  # they give and take energy
        self.driven = not simulation.basin.has_potential(simulation.scene.fluid.steady_force)
        self.at_first = None

    def residual(self, energy: float, potential_energy: float, work: dict[str, float]) -> float:
        """Error [J] of the energy balance since the first call: gain of `energy` minus work of the outer forces. `work`
        [J]: by force; `potential_energy` [J]: part of `energy`, taken off it where forces have no potential."""
        given = sum(work[term] for term in self.outer_terms)
        if self.driven:
            given += work.get("gravity", 0.0) + potential_energy
        if self.at_first is None:
            self.at_first = energy - given
        return energy - given - self.at_first


def kinetic_and_potential(simulation: Simulation, totals: Totals) -> tuple[float, float]:
    """Kinetic energy, and potential energy in gravity (zero at the origin), both [J], from sums over all particles."""
    mass = with_particles(simulation.fluid).particles.mass
    with np.errstate(invalid="ignore"):  # infinite is NaN along axes without gravity
        lifted = -mass * float(totals.position @ np.array(simulation.basin.gravity))
    return 0.5 * mass * totals.squared_speed, lifted


def stored_by_weight(simulation: Simulation) -> float:
    """Energy [J] stored in water at rest as its weight compresses it, at most: (g depth)^2 / (6 c^2) per kilogram."""
    fluid, basin = simulation.fluid, simulation.basin
    particles = with_particles(fluid).particles
    head = float(np.linalg.norm(basin.gravity)) * basin.depth  # [m2/s2]
    return particles.mass * particles.count.now * head**2 / (6.0 * fluid.pressure_share * fluid.sound_speed**2)


def energy_scale(simulation: Simulation) -> float:
    """Energy [J] with which unexplained gains are compared: that stored as the weight compresses the water, plus that
    of the waves on open sea, or of lifting all water by a spacing over an uneven bed, where particles settle. If none
    is stored: 1 % of mass times reference speed squared, plus lifting by a spacing."""
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
    """Names of the forces whose work adds up to the energy given to the water; empty if no such sum is known.

    With a pressure solver, the works of pressure inside the water and at walls are known only together: their sum is
    the solver's error plus the work of walls. Where walls drive the water, the two cannot be told apart."""
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
    moved = bool(has_driving_walls(basin) or basin.gates or simulation.ships or scene.fluid.driven)
    return moved or not scene.wind.still or not basin.has_potential(scene.fluid.steady_force)
