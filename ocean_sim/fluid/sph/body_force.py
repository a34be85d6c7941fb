"""Accelerations of water by its surroundings: gravity, a body force, the motion of a tank, and friction of a bed.

Bed friction lies between free slip and no slip: a shear stress on the layer next to the bed, as thick as a row of the
lattice. A particle in this layer bears the stress on a share of the bed: its volume over that thickness, less where the
layer gives way to the next. On a lattice, even a quarter of a row too high or too low, the first row bears all and the
second nothing; in any water the shares sum to the bed in the mean. Where the row is not filled, as at the tip of a
front, the stress falls with the share that is: a lone particle is no layer of water on the bed.
"""

from typing import TYPE_CHECKING

import numpy as np

from ocean_sim.basin import KARMAN_CONSTANT, MIN_ROW_SHARE, Basin, Floor
from ocean_sim.fluid.sph.lattice import Lattice
from ocean_sim.fluid.sph.smoothing import Smoothing, Stencil
from ocean_sim.kernel_library import ti, tm
from ocean_sim.runtime import in_kernels

if TYPE_CHECKING:  # it is imported only where a bed has a shape
    from ocean_sim.fluid.bodies.relief import Relief

FRAME_PUSH, FRAME_RATE, FRAME_TURN, FRAME_PIVOT = range(4)
FULL_SHARE_ROWS, NO_SHARE_ROWS = 0.75, 1.25  # [rows] height up to which a particle bears its share, from which none


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
        """Acceleration (3,) [m/s2] of water that leaves an emitter, without the terms of a turning tank."""
        return np.array(self.frame[FRAME_PUSH]) if self.moving else self.gravity + self.body_force

    def advance(self, time: float) -> None:
        """Set the motion of the tank to that at a time [s]."""
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
        """Acceleration [m/s2] of water at rest at x [m], which pressure balances; zero along a periodic axis."""
        return self.held * self.at(x, tm.vec3(0.0))


@in_kernels
class Bed:
    """Friction of a rough bed on the lowest row of particles."""

    def __init__(self, bed: Floor, lattice: Lattice, smoothing: Smoothing, relief: "Relief | None") -> None:
        """`relief`: heights of a bed with a shape, else None."""
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
        """Acceleration [m/s2] by bed friction over dt [s] at x [m] for a velocity v [m/s] without it: by the solution u
        / (1 + k |u| dt) of du/dt = -k |u| u, k = drag share / row. No step turns the water round. `row`,
        `images`: sums over the neighbours and their images as of Stencil.row_on_bed, by which the share is less where
        the row is not full; a bed of another shape has no images."""
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
