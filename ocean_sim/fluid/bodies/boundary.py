"""Solid bodies in the water, as samples within one support of their faces: samples stand in the sums of the water's
laws as particles would, and the forces of the water on them are summed.

A sample counts by its volume over that of a particle (Akinci et al. 2012, ACM Trans. Graph. 31). To each particle it
shows that particle's own pressure, continued to the sample: across the nearest face by the weight of the water less the
acceleration of the body (the pressure gradient at a wall of Adami, Hu & Adams 2012, J. Comput. Phys. 231, eq. 26),
along the face by that weight less the acceleration of the particle in its last step without wind and viscosity, which
is the pressure gradient there: friction and wind bend no isobar. A body that pulled water along its faces would carry
half a spacing of it as mass. Both sides of a thin body keep their own pressure, and still water is exact. The velocity
of a sample is the body's in compression, that of a mirror image in friction. Action equals reaction. Flat sides mirror
samples as they do particles: an image's push across its side is on that side, all else on the body.

A gate is a body that moves as the scene says, under any load; once it has left, its samples are in no cell. A step uses
its place at the end of the step. Its work is that of its force along its way; impulses of particles that bounce from
its faces are booked to walls. Samples hold up part of the weight of the water next to them, as walls do: for a gate
that slides along water that is work which the water does not gain; it shows in the residual of the energy.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ocean_sim.basin import MeshObstacle
from ocean_sim.basin.motion import Gate
from ocean_sim.columns import Columns
from ocean_sim.fluid.neighbours.grid import Grid
from ocean_sim.fluid.neighbours.images import POSITION_SIGN, mirror_direction, mirror_velocity
from ocean_sim.fluid.neighbours.point_sum import PointSum
from ocean_sim.fluid.sph.body_force import Pull, Relief
from ocean_sim.fluid.sph.lattice import Lattice
from ocean_sim.fluid.sph.law import Law
from ocean_sim.fluid.sph.particles import Components, Particles
from ocean_sim.fluid.sph.smoothing import Smoothing
from ocean_sim.kernel_library import ti, tm
from ocean_sim.runtime import Doubles2, Doubles3, Template, in_kernels

MOTION_COLUMNS = Columns(
    position=3, rotation=9, velocity=3, angular_velocity=3, acceleration=3, angular_acceleration=3, gone=1
)
NO_ROTATION = np.eye(3)
ZERO_VECTOR = np.zeros(3)


@dataclass(frozen=True)
class Body:
    """Boundary particles (samples) of a solid body, with the volume of each and the normal of its nearest face."""

    position: np.ndarray  # (m, 3) in the body's axes, from its origin [m]
    volume: np.ndarray  # (m,) [m3]; in 2-D [m2]
    normal: np.ndarray  # (m, 3) of the nearest face, outward, in the body's axes
    no_slip: bool
    origin: np.ndarray  # (3,) where it is at first [m]
    gate: Gate | None = None  # how it moves, where that is given
    across: tuple[int, float] = (0, 0.0)  # of a gate: layers of samples across it, and how far they are apart [m]
    floats: bool = False  # whether it answers to the water
    counts: bool = True  # whether the forces of the water on it are summed

    def strength(self, smoothing: Smoothing, spacing: float) -> float:
        """Factor by which each boundary particle counts in sums over neighbours (`spacing` [m] apart at rest): 1, but
        more in a gate thinner than a kernel support, so that its few layers push water as those of a thick body do."""
        count, apart = self.across
        if count == 0:
            return 1.0
        rows = np.arange(1, ceil(smoothing.support / spacing) + 1) * spacing  # of solid ground, from the first of water
        layers = 0.5 * spacing + (np.arange(count) + 0.5) * apart
        return plane_pressure(rows, smoothing, spacing) / (plane_pressure(layers, smoothing, spacing) * apart / spacing)


def plane_pressure(away: np.ndarray, smoothing: Smoothing, spacing: float) -> float:
    """Relative push of a uniform pressure on a particle by whole planes of particles (`spacing` [m] apart) at distances
    `away` (k,) [m]: the sum of grad W across the planes over its constant `slope` [m]."""
    last = ceil(smoothing.support / spacing)
    along = spacing * np.array(list(product(range(-last, last + 1), repeat=smoothing.dimension - 1)), dtype=float)
    r = np.sqrt(away[:, None] ** 2 + (along**2).sum(axis=1))
    weights = smoothing.kernel.gradient(np.maximum(1.0 - r / smoothing.support, 0.0))
    return float((away[:, None] * weights).sum())


def fixed_bodies(lattice: Lattice, support: float) -> list[Body]:
    """Sample obstacles and an uneven bed by boundary particles, down to one `support` [m] below their faces."""
    basin, bodies = lattice.basin, []
    for k, obstacle in enumerate(basin.config.obstacles):
        if isinstance(obstacle, MeshObstacle):
            mesh = basin.meshes[k]
            samples = mesh.samples(lattice.spacing, support)
            bodies.append(Body(*samples, obstacle.slip == "no_slip", mesh.origin, obstacle.gate))
            continue
        d = basin.dimension
        low, up = np.array(obstacle.min), np.array(obstacle.max)
        count = np.maximum(1, np.round((up - low) / lattice.spacing)).astype(int)
        apart = (up - low) / count
        index = np.array(list(product(*(range(n) for n in count[::-1]))))[:, ::-1]
        felt = (np.minimum(index, count - 1 - index) * apart < support).any(axis=1)
        position, normal = np.zeros((2, int(felt.sum()), 3))
        position[:, :d] = (index[felt] + 0.5) * apart - 0.5 * (up - low)
        deep = (0.5 * (up - low) - np.abs(position[:, :d])) / lattice.spacing
        face = deep.round(6).argmin(axis=1)[:, None]  # of two as near the first, on the left as on the right
        np.put_along_axis(normal, face, np.where(np.take_along_axis(position, face, 1) < 0.0, -1.0, 1.0), 1)
        origin = np.zeros(3)
        origin[:d] = 0.5 * (low + up)
        volume, no_slip = np.full(len(position), apart.prod()), obstacle.slip == "no_slip"
        thin = int(np.argmin(up - low))
        across = (int(count[thin]), float(apart[thin])) if obstacle.gate is not None else (0, 0.0)
        bodies.append(Body(position, volume, normal, no_slip, origin, obstacle.gate, across))
    if (ground := basin.ground) is not None:
        samples = ground.samples(lattice.spacing, support)
        bodies.append(Body(*samples, ground.no_slip, ground.origin, counts=False))
    return bodies


def floating_bodies(lattice: Lattice, support: float) -> dict[str, Body]:
    """Sample, within `support` [m] of the surface, floating bodies that push water by boundary particles; by name."""
    bodies = {}
    for name, solid in lattice.basin.afloat.items():
        if solid.is_sampled:
            bodies[name] = Body(*solid.samples(lattice.spacing, support), False, solid.origin, floats=True)
    return bodies


def any_moves(bodies: Sequence[Body]) -> bool:
    """True if any of these bodies moves (a gate or a floating body), and so does work on the water."""
    return any(body.floats or body.gate is not None for body in bodies)


def memory(samples: int, bodies: int, cells: int, word: int, working: bool) -> int:
    """Memory [bytes] of a Boundary with so many `samples` (boundary particles), bodies and grid cells; `word`: bytes of
    a `float`; `working`: True if the work of moving bodies is summed."""
    return samples * (26 * word + 20 + 24 + 16 * working) + 6 * word * bodies + 4 * (cells + 1)


@ti.func
def body_vector(rows: Template, body, first: Template):
    """Vector of three adjacent numbers, from column `first` on, of row `body` of a table."""
    return ti.Vector([rows[body, first + k] for k in ti.static(range(3))])


@in_kernels
class Boundary:
    """Solid bodies as boundary particles (samples) by cell. A step calls `place`, `sort`, `react`, then `forces`."""

    def __init__(
        self,
        bodies: Sequence[Body],
        particles: Particles,
        grid: Grid,
        pull: Pull,
        smoothing: Smoothing,
        accounts: bool,
        relief: Relief | None = None,
    ) -> None:
        """`pull`: gravity and tank motion; `accounts`: True to sum work of moving bodies; `relief`: uneven bed."""
        self.bodies, self.mass, self.grid, self.pull = bodies, particles.mass, grid, pull
        self.owners = np.repeat(np.arange(len(bodies)), [len(body.position) for body in bodies])
        self.n = n = len(self.owners)
        plan = grid.size.plan
        self.block, self.stride = plan.samples, plan.stride
        self.blocks = -(-n // self.block)
        self.motion = np.zeros((len(bodies), MOTION_COLUMNS.size))  # where they are and how they move
        self.moved = True  # whether they have, since they were sorted
        self.gates = [(k, body.gate) for k, body in enumerate(bodies) if body.gate is not None]
        self.moving, self.working = bool(self.gates), accounts and any_moves(bodies)
        self.given = sum(not body.floats for body in bodies)  # they come first; what floats moves after the water
        self.shaped = relief is not None
        self.relief: Any = relief
        self.uncounted = next((k for k, body in enumerate(bodies) if not body.counts), -1)
        self.speed = 0.0  # [m/s] of the fastest gate
        # In the order of the bodies; positions are from the origin [m], in the body's axes and in those of the tank.
        self.local, self.arm, self.force = Components(n), Components(n), Components(n)
        self.facing = Components(n)  # as `local`
        self.impulse = ti.field(ti.f64, shape=(n, 3))
        if self.moving:
            self.strength = ti.field(float, shape=len(bodies))
            strengths = [body.strength(smoothing, particles.spacing) for body in bodies]
            self.strength.from_numpy(np.array(strengths, dtype=self.arm.precision))
        if self.working:
            self.work = ti.field(ti.f64, shape=(n, 2))  # [J] on the water, and what its law has put under walls
        self.shares, self.slips = ti.field(float, shape=n), ti.field(int, shape=n)
        self.owner, self.cell = ti.field(int, shape=n), ti.field(int, shape=n)
        # In the order of the cells, whose `name` is the number in the other.
        self.position, self.velocity, self.acceleration = Components(n), Components(n), Components(n)
        self.normal = Components(n)
        self.share, self.free, self.name = ti.field(float, shape=n), ti.field(int, shape=n), ti.field(int, shape=n)
        self.start = ti.field(int, shape=self.grid.cell_count + 1)
        self.box = ti.field(float, shape=(len(bodies), 2, 3))  # half the size of each body and its middle [m]
        self.around = PointSum(self.position, self.grid, self.start)
        self.water = PointSum(particles.position, self.grid)
        unit = particles.mass / particles.rest_density
        self.solid_share = SolidShare(self, smoothing, unit)
        self.local.from_numpy(np.concatenate([body.position for body in bodies]))
        self.facing.from_numpy(np.concatenate([body.normal for body in bodies]))
        shares = np.concatenate([body.volume for body in bodies]) / unit
        self.shares.from_numpy(shares.astype(self.arm.precision))
        self.slips.from_numpy(np.array([not body.no_slip for body in bodies], dtype=np.int32)[self.owners])
        self.owner.from_numpy(self.owners.astype(np.int32))
        for k, body in enumerate(bodies):
            self.place(k, body.origin)
        self.advance(0.0)
        self.sort()

    def advance(self, time: float) -> None:
        """Move gates to their places at `time` [s], the end of the next step; remove gates that have left the basin."""
        self.speed = 0.0
        for k, gate in self.gates:
            moved = gate.at(time)
            if moved is None:
                self.moved = self.moved or not self.motion[k, MOTION_COLUMNS.gone]
                self.motion[k, MOTION_COLUMNS.gone] = 1.0
            else:
                self.speed = max(self.speed, float(np.linalg.norm(moved.velocity)))
                place = self.bodies[k].origin + moved.way
                self.place(k, place, NO_ROTATION, moved.velocity, ZERO_VECTOR, moved.acceleration)

    def place(
        self,
        body: int,
        position: np.ndarray,
        rotation: np.ndarray = NO_ROTATION,
        velocity: ArrayLike = ZERO_VECTOR,
        angular_velocity: ArrayLike = ZERO_VECTOR,
        acceleration: ArrayLike = ZERO_VECTOR,
        angular_acceleration: ArrayLike = ZERO_VECTOR,
    ) -> None:
        """Set a body's position [m], `rotation` (3, 3) from body to tank, velocities [m/s], [rad/s], accelerations."""
        rates = (velocity, angular_velocity, acceleration, angular_acceleration)
        row = np.concatenate([position, np.ravel(rotation), *rates, [0.0]])  # as MOTION_COLUMNS has them
        self.moved = self.moved or bool((row != self.motion[body]).any())
        self.motion[body] = row

    def sort(self) -> None:
        """Move boundary particles with their bodies and sort them by cell, if any body has moved since."""
        if self.moved:
            self.moved = False
            self.sort_samples(self.motion)

    @ti.kernel
    def sort_samples(self, motion: Doubles2):
        """Move boundary particles with their bodies and sort them by cell, keeping their order; `motion` (bodies,
        MOTION_COLUMNS): position, rotation and rates of each body."""
        ti.loop_config(serialize=True)
        for _ in range(1):
            for c in range(self.grid.cell_count + 1):
                self.start[c] = 0
            for b, k in ti.ndrange(motion.shape[0], 3):
                self.box[b, 0, k], self.box[b, 1, k] = -tm.inf, tm.inf
            for s in range(self.n):
                self.turn_arm(s, motion)
                c = self.grid.cell_at(self.grid.indices_at(self.sample_position(s, motion)))
                if ti.static(self.moving):
                    if motion[self.owner[s], MOTION_COLUMNS.gone] > 0.0:
                        c = self.grid.cell_count  # after all cells
                        self.force.put(s, tm.vec3(0.0))
                self.cell[s], self.start[c] = c, self.start[c] + 1
            for c in range(self.grid.cell_count):
                self.start[c + 1] = self.start[c + 1] + self.start[c]  # where a cell ends
            for k in range(self.n):
                s = self.n - 1 - k
                to = self.start[self.cell[s]] - 1
                self.start[self.cell[s]] = to  # and at last where it begins
                self.store_sample(s, to, motion)
            for b, k in ti.ndrange(motion.shape[0], 3):
                up, low = self.box[b, 0, k], self.box[b, 1, k]
                self.box[b, 0, k] = 0.5 * (up - low) + self.grid.support
                self.box[b, 1, k] = ti.cast(motion[b, MOTION_COLUMNS.position + k], float) + 0.5 * (up + low)
                if ti.static(self.moving):
                    if motion[b, MOTION_COLUMNS.gone] > 0.0:
                        self.box[b, 0, k] = -tm.inf  # near nothing

    @ti.func
    def turn_arm(self, s, motion: Template):
        """Rotate the vector from its body's origin to boundary particle s by the rotation in `motion`, which has a row
        (MOTION_COLUMNS) for each body; extend the body's bounding box to it."""
        b, local = self.owner[s], self.local.at(s)
        for k, arm in ti.static(enumerate(self.arm)):
            along = ti.cast(body_vector(motion, b, MOTION_COLUMNS.rotation + 3 * k).dot(local), float)
            arm[s] = along
            self.box[b, 0, k] = tm.max(self.box[b, 0, k], along)
            self.box[b, 1, k] = tm.min(self.box[b, 1, k], along)

    @ti.func
    def sample_position(self, s, motion: Template):
        """Position [m] in the tank of boundary particle s: its body's position, from `motion` (for each body a row of
        MOTION_COLUMNS), plus the vector to s, which `turn_arm` has to rotate before."""
        return self.grid.wrap_position(
            ti.cast(body_vector(motion, self.owner[s], MOTION_COLUMNS.position) + self.arm.at(s), float)
        )

    @ti.func
    def store_sample(self, s, to, motion: Template):
        """Store position, velocity, acceleration, normal of boundary particle s at index `to` of the fields in the
        order of cells, from its body's row of `motion` (MOTION_COLUMNS)."""
        b, arm, x, facing = self.owner[s], self.arm.at(s), self.sample_position(s, motion), self.facing.at(s)
        spin = body_vector(motion, b, MOTION_COLUMNS.angular_velocity)
        swept = spin.cross(arm)
        v = body_vector(motion, b, MOTION_COLUMNS.velocity) + swept
        a = body_vector(motion, b, MOTION_COLUMNS.acceleration) + body_vector(
            motion, b, MOTION_COLUMNS.angular_acceleration
        ).cross(arm)
        a += spin.cross(swept)
        self.position.put(to, x)
        self.velocity.put(to, v)
        self.acceleration.put(to, a)
        for k, normal in ti.static(enumerate(self.normal)):
            normal[to] = ti.cast(body_vector(motion, b, MOTION_COLUMNS.rotation + 3 * k).dot(facing), float)
        self.share[to], self.free[to], self.name[to] = self.shares[s], self.slips[s], s

    @ti.func
    def near(self, x):
        """True if x [m] lies within one support of the bounding box of any body, and not too high over the bed."""
        found = False
        for b in range(ti.static(len(self.bodies))):
            away = tm.vec3(0.0)
            for k, period in ti.static(enumerate(self.grid.basin.periods)):
                away[k] = x[k] - self.box[b, 1, k]
                if ti.static(period > 0.0):
                    away[k] -= period * ti.round(away[k] / period)
                away[k] = ti.abs(away[k]) - self.box[b, 0, k]
            here = away.max() < 0.0
            if ti.static(self.shaped):
                here = here and (b != self.uncounted or self.relief.is_reached(x))
            found = found or here
        return found

    @ti.func
    def head(self, x, a, s, d, mirror):
        """Rise of p / rho [m2/s2], by gravity less acceleration, from a particle at x [m], accelerated by a [m/s2], to
        boundary particle s at x + d, or to its image there by matrix `mirror` (Images.mirror)."""
        n, a_s = mirror_direction(mirror, self.normal.at(s)), mirror_direction(mirror, self.acceleration.at(s))
        return (self.pull.at_rest(x + 0.5 * d) - a).dot(d) + (a - a_s).dot(n) * n.dot(d)

    @ti.func
    def mirrored_velocity(self, s, mirror):
        """Velocity [m/s] of boundary particle s, seen in the matrix `mirror` (Images.mirror)."""
        return mirror_velocity(mirror, self.velocity.at(s))

    @ti.func
    def rubbing_velocity(self, v, s, mirror):
        """Velocity [m/s] that boundary particle s, or its image by matrix `mirror`, shows to water at v for friction: v
        itself, without friction, on a free-slip body, else the body's reflected, 2 v_body - v."""
        return ti.select(self.free[s] == 1, v, 2.0 * self.mirrored_velocity(s, mirror) - v)

    @ti.func
    def react(self, law: Template, dt):
        """Sum force [N] and, over dt [s], impulse [N s] of the water on each boundary particle by the Reaction `law`,
        into `force` and `impulse`; call it at a kernel's top level."""
        for t in range(self.blocks * self.stride):
            if t % self.stride == 0:
                b = t // self.stride
                for s in range(b * self.block, ti.min((b + 1) * self.block, self.sample_count())):
                    x, name = self.position.at(s), self.name[s]
                    force = ti.Vector.zero(float, ti.static(law.sums))
                    if self.owner[name] != self.uncounted:
                        force = self.water.total(x, law, s)
                    self.force.put(name, force)
                    for k in ti.static(range(3)):
                        self.impulse[name, k] = self.impulse[name, k] + ti.cast(dt * force[k], ti.f64)
                    if ti.static(self.working):
                        late = ti.select(self.owner[name] < self.given, -0.5, 0.5) * dt  # to the mean of the step
                        v = self.velocity.at(s) + late * self.acceleration.at(s)
                        for k in ti.static(range(3)):
                            self.work[name, 0] = self.work[name, 0] - ti.cast(dt * force[k] * v[k], ti.f64)
                            self.work[name, 1] = self.work[name, 1] - ti.cast(dt * force[3 + k] * v[k], ti.f64)

    @ti.func
    def particle_equivalent(self, s):
        """Weight of boundary particle s in sums over neighbours, as a number of water particles."""
        share = self.share[s]
        if ti.static(self.moving):
            share *= self.strength[self.owner[self.name[s]]]
        return share

    @ti.func
    def sample_count(self):
        """Number of boundary particles in the basin; those of gates that have left are sorted behind them."""
        n = self.n
        if ti.static(self.moving):
            n = self.start[self.grid.cell_count]
        return n

    @ti.func
    def solid(self, x):
        """Smoothed share of the space around x [m] that is solid: 1 inside a body, one half on a face."""
        share = 0.0
        if self.near(x):
            share = self.around.total(x, self.solid_share, 0.0)[0]
        return share

    def sample_sum(self, law: Law) -> "SampleSum":
        return SampleSum(self, law)

    def forces(self) -> tuple[np.ndarray, np.ndarray]:
        """Force (k, 3) [N] on k bodies in the last step, torque (k, 3) [N m] about their origins; 2-D: per metre."""
        borne = np.zeros((2, len(self.bodies), 3))
        self.sum_forces(borne)
        return borne[0], borne[1]

    @ti.kernel
    def sum_forces(self, borne: Doubles3):
        """Add the force [N] and torque [N m] on each of k bodies, from its boundary particles, to `borne` (2, k, 3)."""
        ti.loop_config(serialize=True)
        for s in range(self.n):
            b = self.owner[s]
            force = ti.cast(self.force.at(s), ti.f64)
            torque = ti.cast(self.arm.at(s), ti.f64).cross(force)
            for k in ti.static(range(3)):
                borne[0, b, k] = borne[0, b, k] + force[k]
                borne[1, b, k] = borne[1, b, k] + torque[k]

    def works(self) -> np.ndarray:
        """Work (k, 2) [J] of k bodies on the water since the start: by all forces, and by those whose work the budget
        books to walls (friction alone if Force.stores_pressure_work, as pressure then changes internal energy)."""
        return self.sum_by_body(self.work)

    def impulses(self) -> np.ndarray:
        """Impulse (k, 3) of the water on each body since the start [N s]."""
        return self.sum_by_body(self.impulse)

    def sum_by_body(self, summed: ti.Field) -> np.ndarray:
        """Sums (k, ...) of a field `summed` of the boundary particles over those of each of the k bodies."""
        each = summed.to_numpy()
        return np.array([each[self.owners == k].sum(axis=0) for k in range(len(self.bodies))])


@in_kernels
class SolidShare:
    """Summand of a PointSum over boundary particles: kernel-weighted share of space around a point that is solid."""

    sums = 1

    def __init__(self, boundary: Boundary, smoothing: Smoothing, unit: float) -> None:
        """Share of space that particles of `boundary` fill; `unit`: volume [m3] of a water particle, in 2-D [m2]."""
        self.boundary, self.smoothing, self.unit = boundary, smoothing, unit

    @ti.func
    def term(self, own, s, d, mirror):
        """Kernel-weighted share of space that boundary particle s, d [m] away, fills; `own`, `mirror` not used."""
        return ti.Vector([self.unit * self.boundary.share[s] * self.smoothing.W_poly6(d.dot(d))])


@in_kernels
class SampleSum:
    """Sum of a pair `law` over boundary particles as further neighbours; PointSum adds up `term`, of `sums` columns."""

    def __init__(self, boundary: Boundary, law: Law) -> None:
        self.boundary, self.law, self.sums = boundary, law, law.terms.size

    @ti.func
    def term(self, own, s, d, mirror):
        """Contribution of boundary particle s (index) to the sum of a particle of field values `own` (law.row); d [m]:
        from this particle to s, or to the image of s by matrix `mirror` (Images.mirror)."""
        total = ti.Vector.zero(float, self.sums)
        if d.dot(d) < self.boundary.grid.support**2:
            total = self.boundary.particle_equivalent(s) * self.law.pair(own, self.law.sample(own, s, d, mirror))
        return total

    @ti.func
    def total(self, x, own):
        """Sum of `law` over boundary particles around a particle at x [m] of values `own`; zero away from bodies."""
        total = ti.Vector.zero(float, self.sums)
        if self.boundary.near(x):
            total = self.boundary.around.total(x, self, own)
        return total


@in_kernels
class Reaction:
    """Force [N] of the water on a boundary particle and, if work is summed, its part whose work the budget books to
    walls: for a PointSum, which adds up `term`. Of a force by an image in a flat side, the body bears the components
    along the side; the component across acts on the side."""

    def __init__(self, boundary: Boundary, law: Law, told: tuple[ti.Field, ...], forces: tuple[Any, ...]) -> None:
        """Use the pair `law`, with field values `told` of a particle; `forces`: two ti.funcs (values, law's sums), for
        the acceleration [m/s2] by all forces, and for its part whose work the budget books to walls."""
        self.boundary, self.law, self.told, self.mass = boundary, law, told, boundary.mass
        self.forces = forces if boundary.working else forces[:1]
        self.sums = 3 * len(self.forces)

    @ti.func
    def term(self, own, j, d, mirror):
        """Force on boundary particle `own` (index) by particle j, or its image by matrix `mirror` (Images.mirror), d
        [m] away: minus the push on j by `own` (or its image). Of images, the components along their side alone."""
        law = self.law
        here = ti.Vector([field[j] for field in ti.static(self.told)])
        away = tm.vec3([-mirror[POSITION_SIGN, k] * d[k] for k in ti.static(range(3))])
        push = self.boundary.particle_equivalent(own) * law.pair(here, law.sample(here, own, away, mirror))
        total = ti.Vector.zero(float, self.sums)
        for first, acceleration in ti.static(enumerate(self.forces)):
            force = -self.mass * acceleration(here, push)
            for k in ti.static(range(3)):
                total[3 * first + k] = ti.select(mirror[POSITION_SIGN, k] > 0.0, force[k], 0.0)
        return total
