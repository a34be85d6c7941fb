"""Water that is its own mirror image in the middle of its basin, and stays so until rounding has grown.

In the first 50 steps rounding parts images by up to 3e-5 spacings in single precision where pressures follow from the
density, and by 2.5e-3 where they are solved for; then it grows tenfold every few dozen steps, however exact a scheme
is, and after impacts two halves of a tank have nothing in common.
"""

from typing import TYPE_CHECKING

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.fluid import with_particles
from ocean_sim.observers.shared.energy import driven

if TYPE_CHECKING:
    from ocean_sim.simulation import Simulation

ALIKE = 1e-4  # of spacing and reference speed: within this two halves are images at first


class Symmetry:
    """The pairs of particles that are each other's image in x = 0 and in z = 0, where all of them are."""

    def __init__(self, simulation: "Simulation") -> None:
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

    def lost(self, simulation: "Simulation") -> float:
        """How far an image is from where it should be, at most, over the spacing; 0 where there were none."""
        if not self.twins:
            return 0.0
        place, _ = numbered(simulation)
        apart = [np.abs(across(place[twin], axis) - place).max() for axis, twin in self.twins.items()]
        return float(max(apart)) / with_particles(simulation.fluid).spacing


def numbered(simulation: "Simulation") -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) positions [m] and velocities [m/s] by the numbers of the particles."""
    copied = with_particles(simulation.fluid).particles.copied()
    order = np.argsort(copied.id)
    return copied.position[order].astype(float), copied.velocity[order].astype(float)


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
