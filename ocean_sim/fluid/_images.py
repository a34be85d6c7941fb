"""Flat walls and floor as mirrors: a particle near one also meets the images of the water in it.

An image costs no particle: it is a candidate of a cell, seen in a side that the cell lies beside. Sides are taken one
after the other and mirror what was seen so far, so corners are images of images and come for free. The cells of the
grid end at the sides: only those beside one have images in reach.
"""

import numpy as np
import taichi as ti
import taichi.math as tm

from ocean_sim.basin import OPEN, Basin


@ti.data_oriented
class Images:
    """Which sides of the basin mirror the water: for each its axis, its place, and the layer of cells beside it."""

    def __init__(self, basin: Basin, cells: tuple[int, int, int]) -> None:
        low, up = basin.stops()
        sides = [(k, wall, 1) for k, wall in enumerate(low) if wall > -OPEN]
        sides += [(k, wall, cells[k] - 2) for k, wall in enumerate(up) if wall < OPEN]
        self.sides = len(sides)
        self.axis, self.wall, self.layer = (ti.field(kind, shape=max(1, self.sides)) for kind in (int, float, int))
        for field, column in zip((self.axis, self.wall, self.layer), zip(*sides, strict=True), strict=False):
            field.from_numpy(np.array(column))

    @ti.func
    def beside(self, side, place):
        """Whether a cell lies beside this side."""
        return place[self.axis[side]] == self.layer[side]

    @ti.func
    def mirror(self, side):
        """Sign and offset [m] of the images in this side: they lie at sign * x + offset."""
        sign, offset = tm.vec3(1.0), tm.vec3(0.0)
        for k in ti.static(range(3)):
            if self.axis[side] == k:
                sign[k], offset[k] = -1.0, 2.0 * self.wall[side]
        return sign, offset
