"""Flat walls and floor as mirrors: a particle near one also meets the images of the water in it.

An image costs no particle: it is a candidate of a cell, seen in a side that the cell lies beside. Sides are taken one
after the other and mirror what was seen so far, so corners are images of images and come for free. The cells of the
grid end at the sides: only those beside one have images in reach.
"""

import numpy as np
import taichi as ti
import taichi.math as tm
from taichi.lang.util import to_numpy_type

from ocean_sim.basin import OPEN, Basin

AXIS, LAYER, WALL = range(3)


@ti.data_oriented
class Images:
    """Which sides of the basin mirror the water: for each its axis, the layer of cells beside it, and its place [m]."""

    def __init__(self, basin: Basin, cells: tuple[int, int, int]) -> None:
        low, up = basin.stops()
        mirrors = [(k, 1, wall) for k, wall in enumerate(low) if wall > -OPEN]
        mirrors += [(k, cells[k] - 2, wall) for k, wall in enumerate(up) if wall < OPEN]
        self.sides = len(mirrors)
        if mirrors:
            self.side = ti.field(float, shape=(self.sides, 3))
            self.side.from_numpy(np.array(mirrors, dtype=to_numpy_type(self.side.dtype)))

    @ti.func
    def beside(self, s, place):
        """Whether a cell lies beside this side."""
        return place[int(self.side[s, AXIS])] == int(self.side[s, LAYER])

    @ti.func
    def mirror(self, s):
        """Sign and offset [m] of the images in this side: they lie at sign * x + offset."""
        sign, offset = tm.vec3(1.0), tm.vec3(0.0)
        for k in ti.static(range(3)):
            if int(self.side[s, AXIS]) == k:
                sign[k], offset[k] = -1.0, 2.0 * self.side[s, WALL]
        return sign, offset
