"""Solid bodies in the water, as samples of what lies within one support of their faces: they stand in the sums of the
water's laws as particles would, and what the water does to them is gathered back.

A sample counts by its volume over that of a particle (Akinci et al. 2012, ACM Trans. Graph. 31). To each particle it
shows that particle's own pressure, continued to its place by the weight of the water less the acceleration of the body
(the pressure gradient at a wall of Adami, Hu & Adams 2012, J. Comput. Phys. 231, eq. 26): both sides of a thin body
keep their own pressure, and still water is exact. Its velocity is the body's where water is pressed together, and that
which a mirror in its place would show where it rubs. A sample is pushed as strongly as it pushes. Flat sides mirror
samples as they mirror particles: what an image of a sample presses across its side is that side's, all else is the
body's.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
import taichi as ti
import taichi.math as tm

from ocean_sim.fluid._around import Around
from ocean_sim.fluid._grid import TASK
from ocean_sim.fluid._images import SIGN, turned
from ocean_sim.fluid._particles import Components
from ocean_sim.fluid._smoothing import Smoothing
from ocean_sim.fluid._water import Lattice

if TYPE_CHECKING:
    from ocean_sim.fluid._sph import Sph

BLOCK = 32  # samples of a task


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


def floating(lattice: Lattice, support: float) -> list[Body]:
    """What floats in the basin, likewise."""
    return [
        Body(*solid.samples(lattice.spacing, support), False, solid.origin)
        for solid in lattice.basin.afloat
        if solid.felt
    ]


def memory(samples: int, bodies: int, cells: int, word: int) -> int:
    """Bytes of the fields of a Boundary, where `word` is the size of a `float` [bytes]."""
    return samples * (13 * word + 8 + 24) + 6 * word * bodies + 4 * (cells + 1)


@ti.data_oriented
class Boundary:
    """All solid bodies in the water: `place` them, `sort`, `react`; then `forces` says what they feel."""

    def __init__(self, bodies: Sequence[Body], fluid: "Sph") -> None:
        particles, self.grid = fluid.particles, fluid.grid
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
        # In the order of the bodies again.
        self.force, self.impulse = Components(n), ti.field(ti.f64, shape=(n, 3))
        self.box = ti.field(float, shape=(len(bodies), 2, 3))  # half the size of each body and its middle [m]
        self.around = Around(self, self.grid, self.start)
        self.water = Around(particles, self.grid)
        self.volume = Volume(self, fluid.smoothing, unit)
        for k, body in enumerate(bodies):
            self.place(k, body.origin)
        self.sort()

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
        tank; it moves with `velocity` [m/s], `angular_velocity` [rad/s] and their rates. The next step takes it over:
        say where it is when that step ends."""
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
        spans = [
            (self.at[0, self.owner == k].min(axis=0), self.at[0, self.owner == k].max(axis=0))
            for k in range(len(self.bodies))
        ]
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
    def head(self, x, s, d, mirror):
        """Rise of p / rho [m2/s2] from a particle at x to sample s, seen at d [m] in a mirror."""
        a = self.acceleration
        pull, head = self.pull.at_rest(x), 0.0
        for k, along in ti.static(enumerate((a.x, a.y, a.z))):
            head += (pull[k] - mirror[SIGN, k] * along[s]) * d[k]
        return head

    @ti.func
    def own_velocity(self, s, mirror):
        """Of sample s [m/s], as a mirror shows it."""
        return turned(mirror, tm.vec3(self.velocity.x[s], self.velocity.y[s], self.velocity.z[s]))

    @ti.func
    def opposed(self, v, s, mirror):
        """Velocity [m/s] that keeps water of velocity v out of sample s: twice that of the sample less v."""
        return 2.0 * self.own_velocity(s, mirror) - v

    @ti.func
    def rubbing(self, v, s, mirror):
        """Velocity [m/s] with which sample s rubs on water of velocity v: the water's own where it slips."""
        return ti.select(self.free[s] == 1, v, self.opposed(v, s, mirror))

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

    @ti.func
    def solid(self, x):
        """Smoothed share of solid bodies around x; 1 inside, one half on a face."""
        share = 0.0
        if self.near(x):
            share = self.around.total(x, self.volume, 0.0)[0]
        return share

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
class Volume:
    """Smoothed share of solid bodies."""

    sums = 1

    def __init__(self, boundary: Boundary, smoothing: Smoothing, unit: float) -> None:
        """`unit`: volume of a particle [m3]."""
        self.boundary, self.smoothing, self.unit = boundary, smoothing, unit

    @ti.func
    def term(self, own, s, d, mirror):
        return ti.Vector([self.unit * self.boundary.share[s] * self.smoothing.W_poly6(d.dot(d))])


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
        away = tm.vec3([-mirror[SIGN, k] * d[k] for k in ti.static(range(3))])
        push = self.boundary.share[own] * law.pair(here, law.sample(here, own, away, mirror))
        force = -self.mass * law.acceleration(here, push)
        return ti.Vector([ti.select(mirror[SIGN, k] > 0.0, force[k], 0.0) for k in ti.static(range(3))])
