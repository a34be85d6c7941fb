"""Where a hull is among particles, and how it pushes them: as still water in its place would.

A ship that floats by its volume already carries what still water does to it. So its hull gives that back to the water,
as a wall would that shows every particle the pressure p = rho g (height of the water - y) of the nearest place of the
hull: a = -(2 p / rho) times the integral of grad W over the hull (both pressures of the symmetric gradient are p).

It is one of the forces of the water's own step. Given after it, water at rest would be moved by all other forces and
turned back each time: density would follow a speed that is not there, and no force would do the work that is counted.
"""

from typing import Any

import numpy as np
import taichi as ti
import taichi.math as tm
from taichi.lang.util import to_numpy_type

from ocean_sim.ship.shared.distance import Distance
from ocean_sim.ship.shared.rigid_body import RigidBody, tell

PLACE, TURN, VELOCITY, SPIN, MIDDLE, HALF, POSE = 0, 3, 12, 15, 18, 21, 24


@ti.data_oriented
class MovingHull:
    """A hull as it was last told to be."""

    def __init__(self, distance: Distance, bounds: np.ndarray, reach: float, periods: Any, gravity: float) -> None:
        """`bounds` (2, 3) of the hull from its centre of mass [m], `reach` of its push [m]. Hand it the `water` that
        its ship asks."""
        self.distance, self.reach, self.periods, self.gravity = distance, reach, periods, gravity
        self.middle, self.half = tm.vec3(bounds.mean(axis=0)), tm.vec3(0.5 * np.ptp(bounds, axis=0))  # [m]
        self.pose = ti.field(float, shape=POSE)
        self.water: Any = None

    def place(self, body: RigidBody) -> None:
        """Where it is at first."""
        pose = np.zeros(POSE)
        tell(pose, body)
        pose[MIDDLE:HALF] = body.matrix @ np.array(self.middle)
        pose[HALF:] = np.abs(body.matrix) @ np.array(self.half)
        self.pose.from_numpy(pose.astype(to_numpy_type(self.pose.dtype)))

    @ti.func
    def take(self, table: ti.template()):
        """Be where the first row of what is told says; call it at the top of a kernel."""
        ti.loop_config(serialize=True)
        for _ in range(1):
            for c in ti.static(range(MIDDLE)):
                self.pose[c] = ti.cast(table[0, c], float)
            turn = self.turn()
            middle, half = turn @ self.middle, abs(turn) @ self.half
            for c in ti.static(range(3)):
                self.pose[MIDDLE + c], self.pose[HALF + c] = middle[c], half[c]

    @ti.func
    def three(self, first: ti.template()):
        """Three numbers in a row of the pose."""
        return tm.vec3(self.pose[first], self.pose[first + 1], self.pose[first + 2])

    @ti.func
    def turn(self):
        """From its axes to those of the world."""
        return ti.Matrix.rows([self.three(TURN), self.three(TURN + 3), self.three(TURN + 6)])

    @ti.func
    def apart(self, x):
        """From the centre of mass to x [m], the nearest way where sides are periodic."""
        d = x - self.three(PLACE)
        for k, period in ti.static(enumerate(self.periods)):
            if ti.static(period > 0.0):
                d[k] -= period * ti.round(d[k] / period)
        return d

    @ti.func
    def around(self, d, more):
        """Whether a place from the centre of mass lies in the box around the hull, or so much beyond it [m]."""
        return (abs(d - self.three(MIDDLE)) < self.three(HALF) + more).all()

    @ti.func
    def velocity(self, d):
        """Of the hull at a place from the centre of mass [m/s]."""
        return self.three(VELOCITY) + self.three(SPIN).cross(d)

    @ti.func
    def seen(self, d, turn: ti.template()):
        """What the hull says at a place from its centre of mass, in world axes."""
        normal, away, thinning = self.distance.at(turn.transpose() @ d)
        return turn @ normal, away, turn @ thinning

    @ti.func
    def push(self, x, ahead):
        """Acceleration [m/s2] of water at x, where the hull is `ahead` [s] of its pose."""
        d, a = self.apart(x), tm.vec3(0.0)
        if self.around(d, self.reach):
            d -= ahead * self.velocity(d)
            turn = self.turn()
            normal, away, thinning = self.seen(d, turn)
            if away < self.reach:
                face = self.three(PLACE) + d - away * normal
                depth = tm.max(self.water.elevation(face.x, face.z) - face.y, 0.0)
                a = 2.0 * self.gravity * depth * thinning
        return a
