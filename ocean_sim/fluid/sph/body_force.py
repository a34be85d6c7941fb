"""Accelerations of water by its surroundings: gravity, a body force, a moving tank, bed friction; heights of a bed.

Bed friction lies between free slip and no slip: a shear stress on the layer next to the bed, as thick as a row of the
lattice. A particle in this layer bears the stress on a share of the bed: its volume over that thickness, less where the
layer gives way to the next. On a lattice, even a quarter of a row too high or too low, the first row bears all and the
second nothing; in any water the shares sum to the bed in the mean. Where the row is not filled, as at the tip of a
front, the stress falls with the share that is: a lone particle is no layer of water on the bed.
"""

from math import ceil
from typing import TYPE_CHECKING

import numpy as np

from ocean_sim.basin import KARMAN_CONSTANT, MIN_ROW_SHARE, Basin, Floor
from ocean_sim.fluid.sph.lattice import Lattice
from ocean_sim.fluid.sph.smoothing import Smoothing, Stencil
from ocean_sim.kernel_library import ti, tm, to_numpy_type
from ocean_sim.runtime import in_kernels

if TYPE_CHECKING:
    from ocean_sim.basin.ground import Ground

FRAME_PUSH, FRAME_RATE, FRAME_TURN, FRAME_PIVOT = range(4)
FULL_SHARE_ROWS, NO_SHARE_ROWS = 0.75, 1.25  # [rows] height up to which a particle bears its share, from which none
NODES_A_SPACING = 2.0  # between which a bed that particles bounce from is plane
SLACK_NODES = 3.0  # by which samples may be nearer than nodes: within a cell, between heights, across a period


@in_kernels
class Pull:
    """Acceleration [m/s2] of water by gravity, a constant body force and the motion of the tank."""

    def __init__(self, basin: Basin, body_force: tuple[float, float, float]) -> None:
        self.gravity, self.body_force = np.array(basin.gravity), np.array(body_force)  # [m/s2]
        self.constant = tm.vec3(self.gravity + self.body_force)
        self.held = tm.vec3([0.0 if period > 0.0 else 1.0 for period in basin.periods])
        motion = basin.config.motion
        self.moving = motion is not None
        if motion is not None:
            self.motion = motion.build()
            self.frame = ti.Vector.field(3, float, shape=4)
            self.advance(0.0)

    def at_mouth(self) -> np.ndarray:
        """Constant acceleration (3,) [m/s2] of emitted water: gravity, body force, moving tank without rotation."""
        return np.array(self.frame[FRAME_PUSH]) if self.moving else self.gravity + self.body_force

    def advance(self, time: float) -> None:
        """Set acceleration and rotation of the tank to those at a time [s]."""
        if self.moving:
            frame = self.motion.at(time)
            self.frame[FRAME_PUSH] = frame.push(self.gravity) + self.body_force
            self.frame[FRAME_RATE], self.frame[FRAME_TURN] = frame.rate, frame.angular_acceleration
            self.frame[FRAME_PIVOT] = frame.pivot

    @ti.func
    def at(self, x, v):
        """Acceleration [m/s2] at x [m], v [m/s] in tank axes: g - a - alpha x r - omega x (omega x r) - 2 omega x v."""
        a = self.constant
        if ti.static(self.moving):
            r, omega = x - self.frame[FRAME_PIVOT], self.frame[FRAME_RATE]
            a = self.frame[FRAME_PUSH] - tm.cross(self.frame[FRAME_TURN], r)
            a -= tm.cross(omega, tm.cross(omega, r)) + 2.0 * tm.cross(omega, v)
        return a

    @ti.func
    def at_rest(self, x):
        """Acceleration [m/s2] of water at rest at x [m], to be balanced by pressure; zero along periodic axes."""
        return self.held * self.at(x, tm.vec3(0.0))


@in_kernels
class Relief:
    """Uneven bed: heights on a regular grid, bilinear between, and height up to which its boundary particles act."""

    def __init__(self, ground: "Ground", spacing: float, support: float) -> None:
        """Tabulate height of the bed `ground`, and of its samples' reach, `support` [m]; `spacing` [m] of particles."""
        from scipy.ndimage import grey_dilation

        size = np.array([ground.x[-1] - ground.x[0], ground.z[-1] - ground.z[0]])
        counts = np.maximum(1, np.ceil(NODES_A_SPACING * size / spacing)).astype(int)
        counts[1] = counts[1] if ground.dimension == 3 else 1
        nodes = [np.linspace(nodes[0], nodes[-1], n + 1) for nodes, n in zip((ground.x, ground.z), counts)]
        heights = ground.heights(np.stack(np.meshgrid(*nodes, indexing="ij"), axis=-1).reshape(-1, 2))
        heights = heights.reshape(counts + 1)
        steps = size / counts
        across = [np.arange(-n, n + 1) for n in (ceil(SLACK_NODES + support / step) for step in steps)]
        across[1] = across[1] if ground.dimension == 3 else np.zeros(1)
        away = [step * np.maximum(np.abs(nodes) - SLACK_NODES, 0.0) for nodes, step in zip(across, steps)]
        ball = np.sqrt(np.maximum(support**2 - np.add.outer(away[0] ** 2, away[1] ** 2), 0.0))
        reached = grey_dilation(heights, structure=ball, mode="wrap" if any(ground.periodic) else "nearest")
        self.height, self.reach = ti.field(float, shape=counts + 1), ti.field(float, shape=counts + 1)  # [m]
        for field, values in ((self.height, heights), (self.reach, reached)):
            field.from_numpy(values.astype(to_numpy_type(field.dtype)))
        self.first, self.last = tm.vec2(ground.x[0], ground.z[0]), tm.ivec2(counts - 1)
        self.per_step = tm.vec2(counts / size)  # [1/m]

    @ti.func
    def cell(self, x):
        """Coordinates of x [m] in grid steps from the first node, and the indices of the grid cell."""
        at = (tm.vec2(x.x, x.z) - self.first) * self.per_step
        return at, tm.clamp(int(ti.floor(at)), 0, self.last)

    @ti.func
    def is_reached(self, x):
        """True if boundary particles of the bed may lie within a support of x [m]."""
        _at, c = self.cell(x)
        return x.y < self.reach[c.x, c.y]

    @ti.func
    def distance(self, x):
        """Distance [m] of x [m] from the bed's tangent plane, negative below it; and the plane's unit normal."""
        at, c = self.cell(x)
        f = tm.clamp(at - c, 0.0, 1.0)
        low = tm.vec2(self.height[c.x, c.y], self.height[c.x + 1, c.y])
        high = tm.vec2(self.height[c.x, c.y + 1], self.height[c.x + 1, c.y + 1])
        here = tm.mix(low, high, f.y)
        normal = tm.vec3(
            (here.x - here.y) * self.per_step.x, 1.0, tm.mix(low.x - high.x, low.y - high.y, f.x) * self.per_step.y
        ).normalized()
        return (x.y - tm.mix(here.x, here.y, f.x)) * normal.y, normal


@in_kernels
class Bed:
    """Friction of a rough bed on the lowest row of particles."""

    def __init__(self, bed: Floor, lattice: Lattice, smoothing: Smoothing, relief: Relief | None) -> None:
        """`relief`: heights of an uneven bed; None for a flat one."""
        self.level, self.row, self.z0 = lattice.basin.lower[1], lattice.row, bed.z0  # [m]
        self.logarithmic, self.in_row = bed.roughness is not None, bed.drag(0.5 * self.row)
        self.flat = relief is None
        if relief is not None:
            self.relief = relief
        self.full_row = Stencil(smoothing, lattice.spacing).row_on_bed(self.flat)

    @ti.func
    def drag(self, z):
        """Drag coefficient tau / (rho u^2) of the bed for the velocity u at a height z [m] above it."""
        coefficient = float(self.in_row)
        if ti.static(self.logarithmic):
            share = KARMAN_CONSTANT / ti.log(tm.max(z, MIN_ROW_SHARE * self.row) / self.z0)
            coefficient = share * share
        return coefficient

    @ti.func
    def push(self, x, v, dt, row, images):
        """Acceleration [m/s2] of water at x [m], v [m/s] by bed friction: du/dt = -k |u| u, solved exactly over dt [s],
        so that no step reverses the flow. k is the drag coefficient times a share, over the height of the lowest layer.
        The share falls where gaps bring `row` + `images` below the sum of a full layer (Stencil.row_on_bed): sums of
        r^2 f [m2] over neighbours, and over their images (not used at an uneven bed); grad W = -slope f x."""
        z, along, filled = x.y - self.level, tm.vec3(v.x, 0.0, v.z), row
        if ti.static(self.flat):
            filled += images
        else:
            z, normal = self.relief.distance(x)
            along = v - v.dot(normal) * normal
        share = tm.clamp((NO_SHARE_ROWS - z / self.row) / (NO_SHARE_ROWS - FULL_SHARE_ROWS), 0.0, 1.0)
        share *= tm.min(1.0, filled / self.full_row)
        rate = self.drag(z) * share / self.row * along.norm()
        return -rate / (1.0 + rate * dt) * along
