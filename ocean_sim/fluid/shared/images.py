"""Flat sides as mirrors: a particle near one also meets the images of the water in it.

An image costs no particle: it is a candidate of a cell, seen in a side that the cell lies beside. Sides are taken one
after the other and mirror what was seen so far, so corners are images of images and come for free. The cells of the
grid end at the sides: only those beside one have images in reach. Free slip turns the normal velocity round in the
frame of the wall, no slip turns all of it (Morris, Fox & Zhu 1997, J. Comput. Phys. 136, section 3.6, with the mirror
in place of their fixed boundary particles).
"""

from math import ceil
from typing import TYPE_CHECKING

import numpy as np
import taichi as ti
import taichi.math as tm
from taichi.lang.util import to_numpy_type

if TYPE_CHECKING:
    from ocean_sim.fluid.shared.grid import GridSize

AXIS, LOWER, UPPER, PLACE, NO_SLIP, DRIFT, LEAN = *range(6), 8
SIGN, OFFSET, TURN, PUSH, PULL = range(5)  # rows of a mirror


@ti.data_oriented
class Images:
    """The sides that mirror the water: of each its axis, the first and last layer of cells beside it, place [m], slip,
    twice its velocity [m/s] and its acceleration along the axis [m/s2]."""

    def __init__(self, size: "GridSize") -> None:
        sides = size.lattice.basin.sides
        self.sides, self.deepest = len(sides), 1
        rows = []
        for side in sides:
            last = size.cells[side.axis] - 2
            layers = 1 if side.piston is None else 1 + ceil(side.piston.reach / size.inner[side.axis][1])
            self.deepest = max(self.deepest, layers)
            near = (last + 1 - layers, last) if side.upper else (1, layers)
            row = (side.axis, *near, side.place, side.slip == "no_slip", *(2.0 * v for v in side.velocity), 0.0)
            rows.append(row)
        if rows:
            self.side = ti.field(float, shape=(self.sides, LEAN + 1))
            self.side.from_numpy(np.array(rows, dtype=to_numpy_type(self.side.dtype)))
        self.pistons = [(s, side) for s, side in enumerate(sides) if side.piston is not None]
        self.advance(0.0)

    def advance(self, time: float) -> None:
        """Put the pistons where they are at a time [s]."""
        for s, side in self.pistons:
            x, v, a = side.piston.at(time)
            self.side[s, PLACE], self.side[s, DRIFT + side.axis] = side.place + x, 2.0 * v
            self.side[s, LEAN] = a

    @ti.func
    def beside(self, s, place):
        """Whether a cell lies beside this side."""
        layer = place[int(self.side[s, AXIS])]
        return layer >= int(self.side[s, LOWER]) and layer <= int(self.side[s, UPPER])

    @ti.func
    def mirror(self, s):
        """How this side shows the water: an image lies at SIGN * x + OFFSET [m] and moves with TURN * v + PUSH [m/s],
        behind a wall that accelerates by PULL [m/s2]."""
        mirror = ti.Matrix.zero(float, 5, 3)
        for k in ti.static(range(3)):
            across = int(self.side[s, AXIS]) == k
            turned = across or self.side[s, NO_SLIP] > 0.5
            mirror[SIGN, k] = ti.select(across, -1.0, 1.0)
            mirror[OFFSET, k] = ti.select(across, 2.0 * self.side[s, PLACE], 0.0)
            mirror[TURN, k] = ti.select(turned, -1.0, 1.0)
            mirror[PUSH, k] = ti.select(turned, self.side[s, DRIFT + k], 0.0)
            mirror[PULL, k] = ti.select(across, self.side[s, LEAN], 0.0)
        return mirror


@ti.func
def mirrored(mirror, x):
    """Place of the image of x [m]."""
    return tm.vec3([mirror[SIGN, k] * x[k] + mirror[OFFSET, k] for k in ti.static(range(3))])


@ti.func
def climbed(mirror, x, pull):
    """(pull - acceleration of the side) . (image of x - x): rise of p / rho from x to its image [m2/s2]."""
    head = 0.0
    for k in ti.static(range(3)):
        head += (pull[k] - mirror[PULL, k]) * (mirror[SIGN, k] * x[k] + mirror[OFFSET, k] - x[k])
    return head


@ti.func
def turned(mirror, v):
    """Velocity of the image of what moves with v [m/s]."""
    return tm.vec3([mirror[TURN, k] * v[k] + mirror[PUSH, k] for k in ti.static(range(3))])


@ti.func
def reflected(mirror, other):
    """What a law reads of a neighbour, place and velocity first, as the side shows it; all else is as it was."""
    x_image = mirrored(mirror, tm.vec3(other[0], other[1], other[2]))
    v_image = turned(mirror, tm.vec3(other[3], other[4], other[5]))
    image = other
    for k in ti.static(range(3)):
        image[k], image[3 + k] = x_image[k], v_image[k]
    return image


@ti.func
def slid(mirror, other):
    """The same as `reflected`, but along the side as if it were slippery: what a side that holds fast drags along does
    not press water together or draw it apart (Marrone et al. 2011, CMAME 200, section 3.2)."""
    image = reflected(mirror, other)
    for k in ti.static(range(3)):
        if mirror[SIGN, k] > 0.0:
            image[3 + k] = other[3 + k]
    return image


@ti.func
def beside(own, d, v):
    """What a law reads, place and velocity first, of what lies at d [m] from a particle and moves with v [m/s]; all
    else is the particle's own."""
    other = own
    for k in ti.static(range(3)):
        other[k], other[3 + k] = own[k] + d[k], v[k]
    return other


@ti.data_oriented
class OfPlaces:
    """A law that reads nothing but places, whatever it sums."""

    @ti.func
    def image(self, other, mirror):
        """A neighbour as a side shows it."""
        return mirrored(mirror, other)

    @ti.func
    def sample(self, own, s, d, mirror):
        """A sample of a solid body."""
        return own + d
