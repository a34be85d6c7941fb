"""Water that meets a hull (thesis 4.2): the one arrow that goes back from the ship to the particles.

A ship that floats by its volume already carries what still water does to it. So its hull gives that back to the water,
as a wall would that shows every particle the pressure p = rho g (height of the water - y) of the nearest place of the
hull: a = -(2 p / rho) times the integral of grad W over the hull (both pressures of the symmetric gradient are p). What
still comes nearer then collides, and that alone is new to the ship. The water bears what it gives back and the
collisions; the ship is carried by its own law and the collisions. Afloat and at rest the hull's share balances the
water's own pressure, collisions have nothing to do in the mean, and the draught is that without contact: Archimedes is
counted once. Added mass and damping of a kind stay as they are, so slamming comes on top of them.

Collisions are solved together, not one by one (n particles would push a light ship n times). With J = (n, r x n) of a
particle at r from the centre of mass, U the ship's velocities and e the restitution, every particle that comes nearer
leaves with n . v' = J U' - e (n . v - J U), and (M + c A) (U' - U) = c b with A = m sum J J^T, c the response and
b = m (1 + e) sum J (n . v - J U). Impulses that would pull are none. Coulomb friction follows; how fast a particle
slips is reduced by M / (M + mass of the particles that touch the ship), so that friction does not turn a light ship.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import taichi as ti
import taichi.math as tm

from ocean_sim.basin import Basin
from ocean_sim.parts import PartConfig, quantity
from ocean_sim.ship import PARTS, Load
from ocean_sim.ship._distance import Distance
from ocean_sim.ship._rigid_body import RigidBody

TASK = 512  # a parallel loop is never cut finer than this
BLOCK = 512  # particles that are summed one after the other
FINE = 3.0  # cubes of the distance to a spacing
MARGIN = 0.2  # [spacings] before the hull, where a particle's centre stops
RIM = 3.0  # [spacings] around the hull, where a sheet over the particles sags into its hole
LEAPS = 3  # off the hull and back to the walls
WAVE = PARTS.index("wave")
PAIRS = tuple((i, j) for i in range(6) for j in range(i, 6))
TOUCHING, BACK, SPENT, B, A = 0, 1, 4, 5, 11  # particles, push given back and its work, b and A
SUMS = A + len(PAIRS)
WORK = 6  # after the impulse and its moment
POSE = (
    34  # place, turn, velocity, angular velocity, the same two before, box (6), step, friction, weight of water, push
)


class Contact(PartConfig):
    """How particles bounce from the hull."""

    restitution: float = quantity("1", 0.0, ge=0.0, le=1.0)
    """Share of the normal speed that is returned."""
    friction: float = quantity("1", 0.0, ge=0.0)
    """Coulomb friction: tangential over normal impulse, at most."""
    response: float = quantity("1", 1.0, ge=0.0, le=1.0)
    """Share of the collisions' impulse that the ship feels; below 1 momentum is lost."""


@ti.data_oriented
class WaveContact:
    """The hull among the particles: `met` in every step."""

    def __init__(
        self, config: Contact, shape: Any, centre: np.ndarray, basin: Basin, fluid: Any, gravity: float
    ) -> None:
        """`centre` of mass from the hull's origin [m]. Hand it the `water` that the ship asks."""
        self.config, self.particles, self.periods = config, fluid.particles, basin.periods
        self.quantum, self.walls = fluid.grid.quantum, fluid.walls
        spacing = self.particles.spacing
        self.spacing, self.margin, self.mass = spacing, MARGIN * spacing, self.particles.mass
        self.rim = RIM * spacing  # around the hull, where the height of the water cannot be asked [m]
        self.water: Any = None
        self.reach = float(fluid.grid.support)  # of the hull [m]
        self.hull = Distance(shape, centre, spacing / FINE, self.reach, max(self.reach, self.rim))
        self.pull = gravity  # [m/s2]
        n = self.particles.n
        self.blocks = -(-n // BLOCK)
        self.near, self.count = ti.field(int, shape=self.blocks * BLOCK), ti.field(int, shape=self.blocks)
        self.table = np.zeros((1 + self.blocks, max(POSE, SUMS)))  # one array: each costs a kernel its time
        self.pose, self.touched, self.pushed = self.table[0], self.table[1:, :SUMS], self.table[1, : WORK + 1]
        self.impulse = np.zeros((2, 3))  # on the ship by collisions, and its moments about its places [N s], [N m s]
        self.lost = np.zeros((2, 3))  # what the water gave beyond that
        self.given, self.work = np.zeros(3), 0.0  # to the water by collisions [N s]; by both [J]
        self.back = np.zeros(3)  # to the water by the push given back [N s]

    def met(self, load: Load, after: Callable[[Load], RigidBody], dt: float) -> tuple[Load, RigidBody]:
        """The load with the collisions of a step of dt [s] under `wave`, and the body after it; `after` says how a load
        would leave it. The particles move off the hull."""
        trial = after(load)
        self.told(trial, trial, dt)
        self.press(self.water, self.table)
        total = self.touched.sum(axis=0)
        self.back += total[BACK:SPENT]
        self.work += float(total[SPENT])
        if total[TOUCHING] == 0.0:
            return load, trial
        response = self.config.response
        a = np.zeros((6, 6))
        for (i, j), value in zip(PAIRS, total[A:]):
            a[i, j] = a[j, i] = value
        turn = trial.matrix
        own = np.zeros((6, 6))
        own[:3, :3] = trial.mass * np.eye(3)
        own[3:, 3:] = turn @ trial.inertia_body @ turn.T
        change = own @ np.linalg.solve(own + response * a, response * total[B:A])
        expected = after(with_wave(load, change.reshape(2, 3) / dt))
        self.told(expected, trial, dt)
        self.pose[31] = trial.mass / (trial.mass + self.mass * total[TOUCHING])
        self.push(self.table)
        met = -self.pushed[:WORK].reshape(2, 3)
        self.impulse += response * met
        self.lost += (1.0 - response) * met
        self.given += self.pushed[:3]
        self.work += float(self.pushed[WORK])
        load = with_wave(load, response * met / dt)
        return load, after(load)

    def told(self, body: RigidBody, before: RigidBody, dt: float) -> None:
        """Where the hull is, for the kernels."""
        turn, pose = body.matrix, self.pose
        pose[:3], pose[3:12] = body.position, turn.ravel()
        pose[12:15], pose[15:18] = body.velocity, body.angular_velocity
        pose[18:21], pose[21:24] = before.velocity, before.angular_velocity
        middle = turn @ (0.5 * (self.hull.lower + self.hull.upper))
        half = np.abs(turn) @ (0.5 * (self.hull.upper - self.hull.lower))
        pose[24:27], pose[27:30] = middle, half
        pose[30], pose[31] = dt, 0.0

    @ti.func
    def three(self, table: ti.template(), first: ti.template()):
        """Three numbers in a row of what is told."""
        return ti.cast(tm.vec3(table[0, first], table[0, first + 1], table[0, first + 2]), float)

    @ti.func
    def apart(self, x, position):
        """From the ship to x [m], the nearest way where sides are periodic."""
        d = x - position
        for k, period in ti.static(enumerate(self.periods)):
            if ti.static(period > 0.0):
                d[k] -= period * ti.round(d[k] / period)
        return d

    @ti.func
    def seen(self, d, turn: ti.template()):
        """What the hull says at a place from its centre of mass, in world axes."""
        normal, distance, thinning = self.hull.at(turn.transpose() @ d)
        return turn @ normal, distance, turn @ thinning

    @ti.kernel
    def press(self, water: ti.template(), table: ti.types.ndarray(ndim=2)):
        """Give the push of still water back, and sum over what touches the hull."""
        for b in range(self.blocks * TASK):
            if b % TASK == 0:
                block = b // TASK
                total = ti.Vector.zero(ti.f64, SUMS)
                position, velocity, omega = self.three(table, 0), self.three(table, 12), self.three(table, 15)
                turn = ti.Matrix.rows([self.three(table, 3), self.three(table, 6), self.three(table, 9)])
                middle, half, dt = self.three(table, 24), self.three(table, 27), ti.cast(table[0, 30], float)
                p, u = self.particles.position, self.particles.velocity
                count = 0
                for i in range(block * BLOCK, ti.min((block + 1) * BLOCK, self.particles.count.there())):
                    d = self.apart(tm.vec3(p.x[i], p.y[i], p.z[i]), position)
                    if (abs(d - middle) < half).all():
                        normal, s, thinning = self.seen(d, turn)
                        if s < self.reach:
                            face = position + d - s * normal
                            depth = tm.max(water.elevation(face.x, face.z) - face.y, 0.0)
                            old = tm.vec3(u.x[i], u.y[i], u.z[i])
                            v = old + 2.0 * dt * self.pull * depth * thinning
                            u.x[i], u.y[i], u.z[i] = v.x, v.y, v.z
                            for c in ti.static(range(3)):
                                given = self.mass * (ti.cast(v[c], ti.f64) - ti.cast(old[c], ti.f64))
                                total[BACK + c] += given
                                total[SPENT] += 0.5 * given * ti.cast(v[c] + old[c], ti.f64)
                            if s < 0.5 * self.spacing:
                                self.near[block * BLOCK + count] = i
                                count += 1
                            if s < self.margin:
                                self.touch(total, normal, d, v - velocity - omega.cross(d))
                self.count[block] = count
                for c in ti.static(range(SUMS)):
                    table[1 + block, c] = total[c]

    @ti.func
    def touch(self, total: ti.template(), normal, d, v):
        """Add a particle that meets the hull with a relative velocity v."""
        total[TOUCHING] += 1.0
        speed = v.dot(normal)
        if speed < 0.0:
            moment = d.cross(normal)
            j = ti.cast(tm.vec3(normal), ti.f64)
            k = ti.cast(moment, ti.f64)
            six = ti.Vector([j.x, j.y, j.z, k.x, k.y, k.z])
            gain = ti.cast(self.mass * (1.0 + ti.static(self.config.restitution)) * speed, ti.f64)
            for c in ti.static(range(6)):
                total[B + c] += gain * six[c]
            for c, pair in ti.static(enumerate(PAIRS)):
                total[A + c] += self.mass * six[pair[0]] * six[pair[1]]

    @ti.kernel
    def push(self, table: ti.types.ndarray(ndim=2)):
        """Collide with the hull as it will move, and leave it; sums impulse, moment and work on the water."""
        ti.loop_config(serialize=True)
        for _ in range(1):
            position, velocity, omega = self.three(table, 0), self.three(table, 12), self.three(table, 15)
            first, spin = self.three(table, 18), self.three(table, 21)
            turn = ti.Matrix.rows([self.three(table, 3), self.three(table, 6), self.three(table, 9)])
            total = ti.Vector.zero(ti.f64, WORK + 1)
            for block in range(self.blocks):
                for k in range(self.count[block]):
                    i = self.near[block * BLOCK + k]
                    p, u = self.particles.position, self.particles.velocity
                    x, v = tm.vec3(p.x[i], p.y[i], p.z[i]), tm.vec3(u.x[i], u.y[i], u.z[i])
                    d = self.apart(x, position)
                    normal, s, _thinning = self.seen(d, turn)
                    if s < self.margin:
                        before = (v - first - spin.cross(d)).dot(normal)
                        slip = v - velocity - omega.cross(d)
                        speed = slip.dot(normal)
                        bounce = tm.max(-ti.static(self.config.restitution) * before, 0.0) - speed
                        if bounce > 0.0:
                            kick = bounce * normal
                            along = slip - speed * normal
                            rub = ti.static(self.config.friction) * bounce / tm.max(along.norm(), 1e-12)
                            kick -= tm.min(rub, 1.0) * ti.cast(table[0, 31], float) * along
                            new = v + kick
                            u.x[i], u.y[i], u.z[i] = new.x, new.y, new.z
                            impulse = ti.cast(self.mass, ti.f64) * (ti.cast(new, ti.f64) - ti.cast(v, ti.f64))
                            moment = ti.cast(d, ti.f64).cross(impulse)
                            for c in ti.static(range(3)):
                                total[c] += impulse[c]
                                total[3 + c] += moment[c]
                            total[WORK] += 0.5 * impulse.dot(ti.cast(new + v, ti.f64))
                        self.leave(i, x, position, turn)
            for c in ti.static(range(WORK + 1)):
                table[1, c] = total[c]

    @ti.func
    def leave(self, i, x, position, turn: ti.template()):
        """Put a particle off the hull, by whole quanta of the grid, but not through a wall."""
        for _ in range(LEAPS):
            normal, s, _thinning = self.seen(self.apart(x, position), turn)
            way = tm.max(self.margin - s, 0.0)
            x += self.quantum * ti.ceil(way * normal / self.quantum - 0.5)
            for k in ti.static(self.walls.axes):
                x[k] = tm.clamp(x[k], self.walls.low[k], self.walls.up[k])
        p = self.particles.position
        p.x[i], p.y[i], p.z[i] = x.x, x.y, x.z


def with_wave(load: Load, more: np.ndarray) -> Load:
    """The load with (2, 3) more under `wave`."""
    parts = load.parts.copy()
    parts[WAVE] += more
    return replace(load, parts=parts)
