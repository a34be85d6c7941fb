"""Checks of the particles of water: walls hold them, they do not swell, images stay images, forces give momentum."""

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.fluid import Totals, with_particles
from ocean_sim.observers.shared.energy import driven
from ocean_sim.simulation import Simulation

ROUNDING = 1.0e-6  # of the basin's largest coordinate: a few roundings of a float32
COLUMN = 3.0  # [spacings] about as wide as the columns whose level is judged
ALIKE = 1e-4  # of spacing and reference speed: within this two halves are images at first


def kept(totals: Totals, basin: Basin) -> bool:
    """Whether all particles are where `beyond` finds none: quickly known, where there are no obstacles."""
    low, up = basin.stops()
    return not basin.obstacles and bool((totals.lower >= low).all() and (totals.upper <= up).all())


def beyond(position: np.ndarray, basin: Basin, time: float) -> np.ndarray:
    """How far each particle is at a time [s] beyond the walls, floor and lid that there are, or in an obstacle, (n,)
    [m]; 0 in the water and at open sides."""
    low, up = (np.array(stop) for stop in basin.stops())
    distance = np.linalg.norm(position - np.clip(position, low, up), axis=1)
    for least, most in basin.obstacles_at(time):
        distance = np.maximum(distance, np.minimum(position - least, np.array(most) - position).min(axis=1))
    return np.where(distance > ROUNDING * np.abs([basin.lower, basin.upper]).max(), distance, 0.0)


def level_ratio(position: np.ndarray, spacing: float, basin: Basin) -> float:
    """Height of the centre of mass of particles (n, 3) [m] over the bed, over what it would be if the water of each
    column, three spacings wide, lay on the bed and were as dense as at rest; a column holds a layer at least. NaN where
    a position is not a number."""
    if not np.isfinite(position).all():
        return float("nan")
    axes = [0, 2][: basin.dimension - 1]
    lower, size = np.array(basin.lower), np.subtract(basin.upper, basin.lower)[axes]
    counts = np.maximum(1.0, np.round(size / (COLUMN * spacing)))
    side = size / counts
    place = np.floor((position[:, axes] - lower[axes]) / side).astype(np.int64)
    place -= place.min(axis=0)
    column = place @ [1, *(place.max(axis=0) + 1)[:-1]]
    held = np.unique(column, return_counts=True)[1]
    tall = np.maximum(held * spacing**basin.dimension / side.prod(), spacing)  # of each column's water at rest [m]
    return float((position[:, 1] - lower[1]).sum() / (held * tall / 2.0).sum())


class Symmetry:
    """The pairs of particles that are each other's image in x = 0 and in z = 0, where all of them are.

    In the first 50 steps rounding parts images by up to 3e-5 spacings in single precision where pressures follow from
    the density, and by 2.5e-3 where they are solved for; then it grows tenfold every few dozen steps, however exact a
    scheme is, and after impacts two halves of a tank have nothing in common.
    """

    def __init__(self, simulation: Simulation) -> None:
        """From the state of the water now."""
        basin, self.twins = simulation.basin, dict[int, np.ndarray]()
        if driven(simulation) or basin.sea is not None:
            return
        place, velocity = numbered(simulation)
        spacing = with_particles(simulation.fluid).spacing
        for axis in (0, 2)[: basin.dimension - 1]:
            if not even(basin, axis):
                continue
            twin = images(place / spacing, axis)
            apart = across(place[twin], axis) - place, across(velocity[twin], axis) - velocity
            scales = spacing, simulation.fluid.reference_speed
            if all(np.abs(way).max(initial=0.0) <= ALIKE * scale for way, scale in zip(apart, scales)):
                self.twins[axis] = twin

    def lost(self, simulation: Simulation) -> float:
        """How far an image is from where it should be, at most, over the spacing; 0 where there were none."""
        if not self.twins:
            return 0.0
        place, _ = numbered(simulation)
        apart = [np.abs(across(place[twin], axis) - place).max() for axis, twin in self.twins.items()]
        return float(max(apart)) / with_particles(simulation.fluid).spacing


def numbered(simulation: Simulation) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) positions [m] and velocities [m/s] by the numbers of the particles."""
    snapshot = with_particles(simulation.fluid).particles.snapshot()
    order = np.argsort(snapshot.id)
    return snapshot.position[order].astype(float), snapshot.velocity[order].astype(float)


def across(vectors: np.ndarray, axis: int) -> np.ndarray:
    """(n, 3) vectors turned round along an axis."""
    return vectors * np.where(np.arange(3) == axis, -1.0, 1.0)


def images(place: np.ndarray, axis: int) -> np.ndarray:
    """(n,) the number of each particle's image, if all of them have one; places in spacings."""
    here, there = (np.lexsort(x.round(3).T + 0.0) for x in (place, across(place, axis)))
    twin = np.empty(len(place), dtype=int)
    twin[here] = there
    return twin


def even(basin: Basin, axis: int) -> bool:
    """Whether gravity, walls and obstacles are the same on both sides of an axis."""
    name = "xyz"[axis]
    walls = basin.walls.at(f"{name}_min") == basin.walls.at(f"{name}_max")
    boxes = {tuple(np.round([*low, *up], 9)) for low, up in basin.obstacles}
    turned = set()
    for low, up in basin.obstacles:
        ends = np.array([low, up], dtype=float)
        ends[:, axis] = -ends[::-1, axis]
        turned.add(tuple(np.round(ends.ravel(), 9)))
    return walls and basin.gravity[axis] == 0.0 and boxes == turned


class Momentum:
    """Momentum of the water against the impulses that all forces have given it from now on; only where the fluid sums
    the impulse of each force, which `accuracy` asks it to."""

    def __init__(self, simulation: Simulation) -> None:
        self.first = self.unaccounted(simulation, with_particles(simulation.fluid).totals())

    def unaccounted(self, simulation: Simulation, totals: Totals) -> np.ndarray:
        """(3,) what no force has given since the fluid was made [kg m/s]."""
        moving = with_particles(simulation.fluid).particles.mass * totals.velocity
        return moving - sum(simulation.fluid.impulse.values(), np.zeros(3))

    def from_nowhere(self, simulation: Simulation, totals: Totals) -> float:
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
