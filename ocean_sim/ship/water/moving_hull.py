"""Where a hull is among particles, and how it pushes them: as still water in its place would.

A ship that floats by its volume already carries what still water does to it. So its hull gives that back to the water,
as a wall would that shows every particle the pressure p = rho g (height of the water - y) of the nearest point of the
hull: a = -(2 p / rho) times the integral of grad W over the hull (both pressures of the symmetric gradient are p).

It is one of the forces of the water's own step. Given after it, water at rest would be moved by all other forces and
turned back each time: density would follow a speed that is not there, and no force would do the work that is counted.
"""

import numpy as np

from ocean_sim.columns import Columns
from ocean_sim.kernel_library import ti, tm
from ocean_sim.runtime import Template, in_kernels
from ocean_sim.ship.hull.distance import Distance
from ocean_sim.ship.water.water_samples import POSE, SurroundingSea, SurroundingWater

BOXED = Columns(**POSE, middle=3, half=3)  # a body, and the box around it: its middle from there, half its sides [m]


@in_kernels
class MovingHull:
    """A hull at its last pose."""

    def __init__(
        self, distance: Distance, bounds: np.ndarray, reach: float, periods: tuple[float, ...], gravity: float
    ) -> None:
        """`bounds` (2, 3) of the hull from its centre of mass [m], `reach` of its push [m]. Hand it the `water` that
        its ship asks."""
        self.distance, self.reach, self.periods, self.gravity = distance, reach, periods, gravity
        self.middle, self.half = tm.vec3(bounds.mean(axis=0)), tm.vec3(0.5 * np.ptp(bounds, axis=0))  # [m]
        self.pose = ti.field(float, shape=BOXED.size)
        self.water: SurroundingWater | SurroundingSea

    @ti.func
    def take(self, table: Template):
        """Take the pose in the first row of a table; call it at the top of a kernel."""
        ti.loop_config(serialize=True)
        for _ in range(1):
            for c in ti.static(range(BOXED.middle)):
                self.pose[c] = ti.cast(table[0, c], float)
            turn = self.turn()
            middle, half = turn @ self.middle, abs(turn) @ self.half
            for c in ti.static(range(3)):
                self.pose[BOXED.middle + c], self.pose[BOXED.half + c] = middle[c], half[c]

    @ti.func
    def three(self, first: Template):
        """Three numbers in a row of the pose."""
        return tm.vec3(self.pose[first], self.pose[first + 1], self.pose[first + 2])

    @ti.func
    def turn(self):
        """From its axes to those of the world."""
        return ti.Matrix.rows([self.three(BOXED.turn), self.three(BOXED.turn + 3), self.three(BOXED.turn + 6)])

    @ti.func
    def apart(self, x):
        """From the centre of mass to x [m], the nearest way where sides are periodic."""
        d = x - self.three(BOXED.position)
        for k, period in ti.static(enumerate(self.periods)):
            if ti.static(period > 0.0):
                d[k] -= period * ti.round(d[k] / period)
        return d

    @ti.func
    def around(self, d, more):
        """Whether a position from the centre of mass lies in the box around the hull, or so much beyond it [m]."""
        return (abs(d - self.three(BOXED.middle)) < self.three(BOXED.half) + more).all()

    @ti.func
    def velocity(self, d):
        """Of the hull at a position from the centre of mass [m/s]."""
        return self.three(BOXED.velocity) + self.three(BOXED.spin).cross(d)

    @ti.func
    def seen(self, d, turn: Template):
        """Outward normal, distance and thinning at a position from its centre of mass, in world axes."""
        normal, away, thinning = self.distance.at(turn.transpose() @ d)
        return turn @ normal, away, turn @ thinning

    @ti.func
    def away(self, x):
        """Distance of x [m] from it [m]."""
        _normal, away, _thinning = self.distance.at(self.turn().transpose() @ self.apart(x))
        return away

    @ti.func
    def push(self, x, ahead):
        """Acceleration [m/s2] of water at x, where the hull is `ahead` [s] of its pose."""
        d, a = self.apart(x), tm.vec3(0.0)
        if self.around(d, self.reach):
            d -= ahead * self.velocity(d)
            turn = self.turn()
            normal, away, thinning = self.seen(d, turn)
            if away < self.reach:
                face = self.three(BOXED.position) + d - away * normal
                depth = tm.max(self.water.elevation(face.x, face.z) - face.y, 0.0)
                a = 2.0 * self.gravity * depth * thinning
        return a
