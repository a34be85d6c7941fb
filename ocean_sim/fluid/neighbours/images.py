"""Flat sides as mirrors: a particle near one also interacts with the images of the water in it.

An image costs no particle: it is a candidate of a cell, seen in a side next to the cell. Sides are taken one after the
other and mirror all images so far, so corners come for free, as images of images. The cells of the grid end at the
sides: only those next to one have images in reach. Free slip turns the normal velocity round in the frame of the wall,
no slip turns all of it (Morris, Fox & Zhu 1997, J. Comput. Phys. 136, sect. 3.6, with mirrors for fixed particles).
"""

from math import ceil

import numpy as np

from ocean_sim.columns import Columns, vec3
from ocean_sim.fluid.neighbours.grid_size import GridSize
from ocean_sim.kernel_library import ti, tm, to_numpy_type
from ocean_sim.runtime import in_kernels

SIDE_COLUMNS = Columns(axis=1, first_layer=1, last_layer=1, position=1, no_slip=1, twice_velocity=3, acceleration=1)
MOTION_COLUMNS = Columns(position=3, velocity=3)  # what the row of a law begins with whose neighbours move
POSITION_SIGN, POSITION_OFFSET, VELOCITY_SIGN, VELOCITY_OFFSET, SIDE_ACCELERATION = range(5)  # rows of a mirror


@in_kernels
class Images:
    """Flat sides of the basin that mirror the water. A row of `side`: axis (0 to 2), first and last layer of cells next
    to it, position [m], no slip (1 or 0), twice its velocity [m/s] (added to images'), acceleration [m/s2]."""

    def __init__(self, size: GridSize) -> None:
        sides = size.lattice.basin.sides
        self.sides, self.deepest, self.support = len(sides), 1, size.support
        rows = []
        for side in sides:
            last = size.cells[side.axis] - 2
            layers = 1 if side.piston is None else 1 + ceil(side.piston.path.advance / size.inner_cells[side.axis][1])
            self.deepest = max(self.deepest, layers)
            near = (last + 1 - layers, last) if side.upper else (1, layers)
            row = (side.axis, *near, side.position, side.slip == "no_slip", *(2.0 * v for v in side.velocity), 0.0)
            rows.append(row)
        if rows:
            self.side = ti.field(float, shape=(self.sides, SIDE_COLUMNS.size))
            self.side.from_numpy(np.array(rows, dtype=to_numpy_type(self.side.dtype)))
        self.pistons = [(s, side, side.piston) for s, side in enumerate(sides) if side.piston is not None]
        self.advance(0.0)

    def advance(self, time: float) -> None:
        """Set position, velocity and acceleration of the moving sides (pistons) to a time [s]."""
        for s, side, piston in self.pistons:
            x, v, a = piston.at(time)
            self.side[s, SIDE_COLUMNS.position] = side.position + x
            self.side[s, SIDE_COLUMNS.twice_velocity + side.axis] = 2.0 * v
            self.side[s, SIDE_COLUMNS.acceleration] = a

    @ti.func
    def is_adjacent(self, s, cell):
        """True if a cell, given by its indices, lies next to side s."""
        layer, first = cell[int(self.side[s, SIDE_COLUMNS.axis])], int(self.side[s, SIDE_COLUMNS.first_layer])
        return layer >= first and layer <= int(self.side[s, SIDE_COLUMNS.last_layer])

    @ti.func
    def mirror(self, s):
        """Mirror matrix (5, 3) of side s, with rows POSITION_SIGN to SIDE_ACCELERATION. An image lies at sign * x +
        offset [m], moves with sign * v + offset [m/s], and its wall accelerates by the last row [m/s2]."""
        mirror = ti.Matrix.zero(float, 5, 3)
        for k in ti.static(range(3)):
            across = int(self.side[s, SIDE_COLUMNS.axis]) == k
            mirror_velocity = across or self.side[s, SIDE_COLUMNS.no_slip] > 0.5
            mirror[POSITION_SIGN, k] = ti.select(across, -1.0, 1.0)
            mirror[POSITION_OFFSET, k] = ti.select(across, 2.0 * self.side[s, SIDE_COLUMNS.position], 0.0)
            mirror[VELOCITY_SIGN, k] = ti.select(mirror_velocity, -1.0, 1.0)
            mirror[VELOCITY_OFFSET, k] = ti.select(mirror_velocity, self.side[s, SIDE_COLUMNS.twice_velocity + k], 0.0)
            mirror[SIDE_ACCELERATION, k] = ti.select(across, self.side[s, SIDE_COLUMNS.acceleration], 0.0)
        return mirror


@ti.func
def identity_mirror():
    """Mirror matrix (5, 3), see Images.mirror, of signs 1 and offsets 0: positions and velocities stay the same."""
    mirror = ti.Matrix.zero(float, 5, 3)
    for k in ti.static(range(3)):
        mirror[POSITION_SIGN, k] = mirror[VELOCITY_SIGN, k] = 1.0
    return mirror


@ti.func
def join_mirrors(first, then):
    """Mirror matrix of two reflections in succession: `then` applied to images in `first`."""
    mirror = first
    for k in ti.static(range(3)):
        mirror[POSITION_SIGN, k] = then[POSITION_SIGN, k] * first[POSITION_SIGN, k]
        mirror[POSITION_OFFSET, k] = then[POSITION_SIGN, k] * first[POSITION_OFFSET, k] + then[POSITION_OFFSET, k]
        mirror[VELOCITY_SIGN, k] = then[VELOCITY_SIGN, k] * first[VELOCITY_SIGN, k]
        mirror[VELOCITY_OFFSET, k] = then[VELOCITY_SIGN, k] * first[VELOCITY_OFFSET, k] + then[VELOCITY_OFFSET, k]
        mirror[SIDE_ACCELERATION, k] = first[SIDE_ACCELERATION, k] + then[SIDE_ACCELERATION, k]
    return mirror


@ti.func
def mirror_position(mirror, x):
    """Position [m] of the image of a point x [m] in a mirror (a matrix of Images.mirror)."""
    return tm.vec3([mirror[POSITION_SIGN, k] * x[k] + mirror[POSITION_OFFSET, k] for k in ti.static(range(3))])


@ti.func
def mirror_midpoint(mirror, x):
    """Midpoint [m] between x [m] and its image by matrix `mirror`: there a linear field has its mean over both."""
    return 0.5 * (x + mirror_position(mirror, x))


@ti.func
def mirror_direction(mirror, d):
    """Image of a vector d by matrix `mirror` (see Images.mirror): components across sides change sign."""
    return tm.vec3([mirror[POSITION_SIGN, k] * d[k] for k in ti.static(range(3))])


@ti.func
def hydrostatic_offset(mirror, x, pull):
    """Hydrostatic rise of p / rho [m2/s2] from x to its image by `mirror`, by gravity `pull` and the side's motion."""
    wall = tm.vec3([mirror[SIDE_ACCELERATION, k] for k in ti.static(range(3))])
    return (pull - wall).dot(mirror_position(mirror, x) - x)


@ti.func
def mirror_velocity(mirror, v):
    """Velocity [m/s] of the image of a particle with velocity v [m/s] by matrix `mirror`, free-slip or no-slip."""
    return tm.vec3([mirror[VELOCITY_SIGN, k] * v[k] + mirror[VELOCITY_OFFSET, k] for k in ti.static(range(3))])


@ti.func
def mirror_row(mirror, other):
    """Field values `other` (MOTION_COLUMNS first) with position and velocity imaged by matrix `mirror`."""
    x_image = mirror_position(mirror, vec3(other, MOTION_COLUMNS.position))
    v_image = mirror_velocity(mirror, vec3(other, MOTION_COLUMNS.velocity))
    image = other
    for k in ti.static(range(3)):
        image[MOTION_COLUMNS.position + k], image[MOTION_COLUMNS.velocity + k] = x_image[k], v_image[k]
    return image


@ti.func
def mirror_row_free_slip(mirror, other):
    """Field values `other` imaged by matrix `mirror` as `mirror_row` does, but with free slip even at a no-slip side,
    which then neither compresses nor stretches water dragged along it (Marrone et al. 2011, CMAME 200, sect. 3.2)."""
    image = mirror_row(mirror, other)
    for k in ti.static(range(3)):
        if mirror[POSITION_SIGN, k] > 0.0:
            image[MOTION_COLUMNS.velocity + k] = other[MOTION_COLUMNS.velocity + k]
    return image


@ti.func
def row_at(own, d, v):
    """Field values `own` of a particle with its position moved by d [m] and its velocity replaced by v [m/s]."""
    other = own
    for k in ti.static(range(3)):
        other[MOTION_COLUMNS.position + k], other[MOTION_COLUMNS.velocity + k] = own[k] + d[k], v[k]
    return other
