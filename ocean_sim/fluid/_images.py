"""Flat walls and floor as mirrors: a particle near one also meets the images of the water in it.

An image costs no particle: it is the number of the particle and the sides that it is mirrored in. Corners are images
of images and come for free. The cells of the grid end at the sides, so the images of a cell beside a side are those
of its own layer.
"""

import taichi as ti
import taichi.math as tm

from ocean_sim.basin import OPEN, Basin

INDEX_BITS = 26  # of an entry of the candidate lists (MOST_PARTICLES); the rest says in which sides it is mirrored
INDEX = (1 << INDEX_BITS) - 1


@ti.data_oriented
class Images:
    """Which sides of the basin mirror the water, and how."""

    def __init__(self, basin: Basin) -> None:
        self.low, self.up = (tm.vec3(side) for side in basin.stops())
        self.has_low = tm.ivec3([int(side > -OPEN) for side in basin.stops()[0]])
        self.has_up = tm.ivec3([int(side < OPEN) for side in basin.stops()[1]])

    @ti.func
    def beside(self, place, cells):
        """Whether a cell lies beside a lower or an upper side that mirrors, on each axis."""
        return self.has_low * (place == 1), self.has_up * (place == tm.ivec3(cells) - 2)

    @ti.func
    def mirror(self, sides):
        """Sign and offset of the image in these sides, -1 lower, 1 upper, 0 neither: image = sign * x + offset [m]."""
        sign, offset = tm.vec3(1.0), tm.vec3(0.0)
        for k in ti.static(range(3)):
            if sides[k] != 0:
                sign[k], offset[k] = -1.0, 2.0 * ti.select(sides[k] < 0, self.low[k], self.up[k])
        return sign, offset

    @ti.func
    def entry(self, j, sides):
        return j | (((sides.x + 1) + 3 * (sides.y + 1) + 9 * (sides.z + 1)) << INDEX_BITS)

    @ti.func
    def sides(self, entry):
        code = entry >> INDEX_BITS
        return tm.ivec3(code % 3 - 1, code // 3 % 3 - 1, code // 9 - 1)
