"""Solid bodies in the water, as samples of what lies within one support of their faces: they stand in the sums of the
water's laws as particles would, and what the water does to them is gathered back.

The pressure at a sample is that of the water around it, continued to the sample by the weight of the water less the
acceleration of the body; on a body without slip its velocity is twice its own less that of the water (Adami, Hu & Adams
2012, J. Comput. Phys. 231, eqs. 23 and 27). A sample counts by its volume over that of a particle, and it pushes a
particle as strongly as the particle pushes it. Flat sides mirror samples as they mirror particles: what an image of a
sample presses across its side is that side's, all else is the body's.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
import taichi as ti
import taichi.math as tm

from ocean_sim.fluid._around import Around, unmirrored
from ocean_sim.fluid._grid import TASK
from ocean_sim.fluid._images import SIGN, climbed, turned
from ocean_sim.fluid._particles import Components
from ocean_sim.fluid._water import Lattice

if TYPE_CHECKING:
    from ocean_sim.fluid._sph import Sph

BLOCK = 32  # samples of a task
LEAST = 1.0e-3  # share of water around a sample; where there is less, it is dry


@dataclass(frozen=True)
class Body:
    """Samples of a solid body."""

    place: np.ndarray  # (m, 3) in the body's axes, from its origin [m]
    volume: np.ndarray  # (m,) [m3]; in a slice [m2]
    no_slip: bool
    origin: np.ndarray  # (3,) where it is at first [m]


def boxes(lattice: Lattice, support: float) -> list[Body]:
    """The obstacles of the basin, sampled about as densely as the water, no deeper than it can feel."""
    basin, bodies = lattice.basin, []
    for obstacle in basin.config.obstacles:
        d = basin.dimension
        low, up = np.array(obstacle.min), np.array(obstacle.max)
        count = np.maximum(1, np.round((up - low) / lattice.spacing)).astype(int)
        apart = (up - low) / count
        index = np.array(list(product(*(range(n) for n in count[::-1]))))[:, ::-1]
        felt = (np.minimum(index, count - 1 - index) * apart < support).any(axis=1)
        place = np.zeros((int(felt.sum()), 3))
        place[:, :d] = (index[felt] + 0.5) * apart - 0.5 * (up - low)
        origin = np.zeros(3)
        origin[:d] = 0.5 * (low + up)
        bodies.append(Body(place, np.full(len(place), apart.prod()), obstacle.slip == "no_slip", origin))
    return bodies


@ti.data_oriented
class Boundary:
    """All solid bodies in the water: `place` them, `press` them, `react`; then `forces` says what they feel."""

    def __init__(self, bodies: Sequence[Body], fluid: "Sph") -> None:
        particles, self.grid, self.smoothing = fluid.particles, fluid.grid, fluid.smoothing
        self.fluid, self.bodies, self.pull = fluid, bodies, fluid.pull
        owners = [np.full(len(body.place), k) for k, body in enumerate(bodies)]
        self.owner = np.concatenate(owners)  # (n,) which body a sample is of
        self.n = n = len(self.owner)
        self.blocks = -(-n // BLOCK)
        unit = particles.mass / particles.rest_density
        self.shares = np.concatenate([body.volume for body in bodies]) / unit
        self.free_slip = np.concatenate([np.full(len(body.place), not body.no_slip, dtype=np.int32) for body in bodies])
        self.at = np.zeros((3, n, 3))  # place [m], velocity [m/s] and acceleration [m/s2] in the order of the bodies
        self.origins = np.array([body.origin for body in bodies])
        # From here on in the order of the cells, as `name` tells.
        self.position, self.velocity, self.acceleration = Components(n), Components(n), Components(n)
        self.share, self.free, self.name = ti.field(float, shape=n), ti.field(int, shape=n), ti.field(int, shape=n)
        self.start = ti.field(int, shape=self.grid.cell_count + 1)
        self.pressure, self.opposed = ti.field(float, shape=n), Components(n)
        # In the order of the bodies again.
        self.force, self.impulse = Components(n), ti.field(ti.f64, shape=(n, 3))
        self.box = ti.field(float, shape=(len(bodies), 2, 3))  # half the size of each body and its middle [m]
        self.around = Around(self, self.grid, self.start)
        self.water = Around(particles, self.grid)
        for k, body in enumerate(bodies):
            self.place(k, body.origin)

    def place(
        self,
        body: int,
        position: np.ndarray,
        rotation: np.ndarray | None = None,
        velocity: Any = 0.0,
        angular_velocity: Any = (0.0, 0.0, 0.0),
        acceleration: Any = 0.0,
        angular_acceleration: Any = (0.0, 0.0, 0.0),
    ) -> None:
        """Put a body's origin at `position` [m], turned by the (3, 3) matrix `rotation` from its axes to those of the
        tank; it moves with `velocity` [m/s], `angular_velocity` [rad/s] and their rates. What it is to the water it is
        from the next step on."""
        own = self.owner == body
        local = self.bodies[body].place
        arm = local if rotation is None else local @ np.asarray(rotation).T
        round_it = np.cross(angular_velocity, arm)
        centripetal = np.cross(angular_velocity, round_it)
        self.at[0, own], self.at[1, own] = position + arm, velocity + round_it
        self.at[2, own] = acceleration + np.cross(angular_acceleration, arm) + centripetal
        self.origins[body] = position
        self.moved = True

    def sort(self) -> None:
        """Take over where the bodies are, if they have moved."""
        if not self.moved:
            return
        self.moved = False
        grid, basin = self.grid, self.grid.basin
        low, cells = np.array(basin.lower), np.array(grid.cells)
        x = self.at[0].copy()
        for k, period in enumerate(basin.periods):
            if period > 0.0:
                x[:, k] -= period * np.floor((x[:, k] - low[k]) / period)
        place = np.clip(((x - low) * np.array(grid.per_width) + 1.0).astype(int), 1, cells - 2)
        cell = (place[:, 2] * cells[1] + place[:, 1]) * cells[0] + place[:, 0]
        order = np.argsort(cell, kind="stable")
        counts = np.bincount(cell, minlength=grid.cell_count)
        self.start.from_numpy(np.concatenate([[0], np.cumsum(counts)]).astype(np.int32))
        for components, values in zip((self.position, self.velocity, self.acceleration), (x, *self.at[1:])):
            components.from_numpy(values[order])
        self.share.from_numpy(self.shares[order].astype(self.position.precision))
        self.free.from_numpy(self.free_slip[order])
        self.name.from_numpy(order.astype(np.int32))
        spans = [(self.at[0, self.owner == k].min(axis=0), self.at[0, self.owner == k].max(axis=0)) for k in range(len(self.bodies))]
        sizes = np.array([(0.5 * (up - low) + grid.support, 0.5 * (up + low)) for low, up in spans])
        self.box.from_numpy(sizes.astype(self.position.precision))

    @ti.func
    def near(self, x):
        """Whether x lies within one support of a body."""
        found = False
        for b in range(ti.static(len(self.bodies))):
            away = tm.vec3(0.0)
            for k, period in ti.static(enumerate(self.grid.basin.periods)):
                away[k] = x[k] - self.box[b, 1, k]
                if ti.static(period > 0.0):
                    away[k] -= period * ti.round(away[k] / period)
                away[k] = ti.abs(away[k]) - self.box[b, 0, k]
            found = found or away.max() < 0.0
        return found

    @ti.func
    def drag_velocity(self, own, s, mirror):
        """Velocity [m/s] with which sample s rubs on water that moves with `own`: on a body with slip that of the
        water, so it does not."""
        opposed = turned(mirror, tm.vec3(self.opposed.x[s], self.opposed.y[s], self.opposed.z[s]))
        return ti.select(self.free[s] == 1, own, opposed)

    @ti.func
    def own_velocity(self, s, mirror):
        """Velocity [m/s] of sample s as a side shows it."""
        return turned(mirror, tm.vec3(self.velocity.x[s], self.velocity.y[s], self.velocity.z[s]))

    @ti.func
    def press(self, law: ti.template()):
        """Pressures and velocities of the samples from the water around them; call it at the top of a kernel."""
        for b in range(self.blocks * TASK):
            if b % TASK == 0:
                for s in range(b // TASK * BLOCK, ti.min((b // TASK + 1) * BLOCK, self.n)):
                    x = tm.vec3(self.position.x[s], self.position.y[s], self.position.z[s])
                    v = tm.vec3(self.velocity.x[s], self.velocity.y[s], self.velocity.z[s])
                    a = tm.vec3(self.acceleration.x[s], self.acceleration.y[s], self.acceleration.z[s])
                    total = self.water.total(x, law, self.pull.at_rest(x) - a)
                    wet = total[0] > LEAST
                    self.pressure[s] = ti.select(wet, total[1] / tm.max(total[0], LEAST), 0.0)
                    there = tm.vec3(total[2], total[3], total[4]) / tm.max(total[0], LEAST)
                    opposed = ti.select(wet, 2.0 * v - there, v)
                    self.opposed.x[s], self.opposed.y[s], self.opposed.z[s] = opposed.x, opposed.y, opposed.z

    @ti.func
    def react(self, law: ti.template(), dt):
        """Forces on the samples; call it at the top of a kernel."""
        for b in range(self.blocks * TASK):
            if b % TASK == 0:
                for s in range(b // TASK * BLOCK, ti.min((b // TASK + 1) * BLOCK, self.n)):
                    x = tm.vec3(self.position.x[s], self.position.y[s], self.position.z[s])
                    force, name = self.water.total(x, law, s), self.name[s]
                    self.force.x[name], self.force.y[name], self.force.z[name] = force.x, force.y, force.z
                    for k in ti.static(range(3)):
                        self.impulse[name, k] += ti.cast(dt * force[k], ti.f64)

    def continued(self, pressure: Any, per_head: float) -> "Continued":
        return Continued(self.fluid, pressure, per_head)

    def met(self, law: Any) -> "Met":
        return Met(self, law)

    def reaction(self, law: Any) -> "Reaction":
        return Reaction(self, law)

    def forces(self) -> tuple[np.ndarray, np.ndarray]:
        """Force (k, 3) [N] of the water on each body in the last step and its torque (k, 3) about its origin [N m], in
        the axes of the tank; in a slice per metre."""
        each = self.force.to_numpy().astype(float)
        torque = np.cross(self.at[0] - self.origins[self.owner], each)
        return self.by_body(each), self.by_body(torque)

    def impulses(self) -> np.ndarray:
        """Impulse (k, 3) of the water on each body since the start [N s]."""
        return self.by_body(self.impulse.to_numpy())

    def by_body(self, values: np.ndarray) -> np.ndarray:
        """(k, 3) sums of (n, 3) over the samples of each body."""
        return np.array([values[self.owner == k].sum(axis=0) for k in range(len(self.bodies))])


@ti.data_oriented
class Continued:
    """The water's pressure (or what else a scheme presses with) at a sample, and its velocity: share of water, then
    both times it. `own` is what pulls on water at rest with the body."""

    sums = 5

    def __init__(self, fluid: "Sph", pressure: Any, per_head: float) -> None:
        """`per_head`: rise of the pressure over g . x."""
        self.fluid, self.pressure, self.per_head = fluid, pressure, per_head
        self.volume = fluid.particles.mass / fluid.particles.rest_density

    @ti.func
    def term(self, own, j, d, mirror):
        fluid, p, u = self.fluid, self.fluid.particles.position, self.fluid.particles.velocity
        x, v = tm.vec3(p.x[j], p.y[j], p.z[j]), turned(mirror, tm.vec3(u.x[j], u.y[j], u.z[j]))
        head = climbed(mirror, x, fluid.pull.at_rest(x)) - own.dot(d)
        weight = self.volume * fluid.smoothing.W_poly6(d.dot(d))
        return weight * ti.Vector([1.0, self.pressure[j] + self.per_head * head, v.x, v.y, v.z])


@ti.data_oriented
class Met:
    """What a particle's pair law sums over the samples around it. The law has `sample(own, s, d, mirror)`: what it
    reads of sample s, seen at d [m] in a mirror."""

    def __init__(self, boundary: Boundary, law: Any) -> None:
        self.boundary, self.law, self.sums = boundary, law, law.sums

    @ti.func
    def term(self, own, s, d, mirror):
        return self.boundary.share[s] * self.law.pair(own, self.law.sample(own, s, d, mirror))

    @ti.func
    def total(self, x, own):
        total = ti.Vector.zero(float, self.sums)
        if self.boundary.near(x):
            total = self.boundary.around.total(x, self, own)
        return total


@ti.data_oriented
class Reaction:
    """Force [N] on a sample, number `own`, by the pair law that pushes the water; the law has `acceleration(own,
    total)`, that of a particle by what it has summed. Across a side, what an image does is the side's."""

    sums = 3

    def __init__(self, boundary: Boundary, law: Any) -> None:
        self.boundary, self.law, self.mass = boundary, law, boundary.fluid.particles.mass

    @ti.func
    def term(self, own, j, d, mirror):
        law = self.law
        here = ti.Vector([field[j] for field in ti.static(law.reads)])
        seen = law.image(here, mirror)
        push = self.boundary.share[own] * law.pair(seen, law.sample(seen, own, -d, unmirrored()))
        force = -self.mass * law.acceleration(here, push)
        return ti.Vector([ti.select(mirror[SIGN, k] > 0.0, force[k], 0.0) for k in ti.static(range(3))])
