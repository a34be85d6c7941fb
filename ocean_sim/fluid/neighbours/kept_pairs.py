"""Pairs of neighbours kept for a step, each with its gradient, for solvers that iterate over them.

An image is named by its particle and by the axes along which it is mirrored, so its fields follow its particle.
`PairSlots` keeps the pairs of each particle. `PairBlocks` keeps those of the particles of a sub-cell with all its
candidates, near or not. There a pair costs one number, the shape of grad W, instead of its gradient and a name;
and the fields of the candidates are fetched once for the sub-cell, so that sums run through adjacent numbers.
"""

from abc import ABC, abstractmethod
from typing import Any

from ocean_sim.fluid.bodies.emitter import MOST_PARTICLES
from ocean_sim.fluid.neighbours.grid import Grid
from ocean_sim.fluid.neighbours.grid_size import GridSize
from ocean_sim.fluid.neighbours.images import POSITION_SIGN, SIDE_COLUMNS, Images
from ocean_sim.fluid.neighbours.thread_tasks import TASK_ITERATIONS, Tasks
from ocean_sim.fluid.sph.law import Law
from ocean_sim.fluid.sph.particles import Components
from ocean_sim.fluid.sph.smoothing import Smoothing
from ocean_sim.kernel_library import ti
from ocean_sim.runtime import Template, in_kernels

SLOTS_PER_NEIGHBOUR = 2.5  # slots of a particle, over its neighbours on the lattice
MIN_SLOTS = 48  # slots of a particle at least


def slot_count(neighbours: int) -> int:
    """Number of slots for stored pairs of a particle that has `neighbours` on the lattice."""
    return max(MIN_SLOTS, int(SLOTS_PER_NEIGHBOUR * neighbours))


@in_kernels
class KeptLaw(Law):
    """Pair law summed over stored pairs. It reads no positions, since the pairs' gradients are stored, too."""

    @abstractmethod
    def kept_image(self, other: Any, name: Any, away: Any) -> Any:
        """Field values of the mirror image of a neighbour with values `other`. Axis k is mirrored if bit k of `name` //
        MOST_PARTICLES is set; the vector `away`, of any length, points from the image into the water."""

    @abstractmethod
    def kept_pair(self, own: Any, other: Any, gradient: Any) -> Any:
        """Contribution of one neighbour; `own`, `other`: field values; `gradient`: grad W over its constant, -slope."""


@in_kernels
class KeptPairs(ABC):
    """Interface of a store of the neighbours, mirror images included, of each particle for one step."""

    def __init__(self, images: Images) -> None:
        self.images = images
        self.pistons = tuple((s, side.axis, side.upper) for s, side, _ in images.pistons)

    @abstractmethod
    def walk(self, law: Any) -> None:
        """ti.func at a kernel's top level: sum law.kept_pair over the pairs of each particle, call law.finish."""

    @ti.func
    def particle_row(self, law: Template, j):
        """Vector of values, at particle j, of the fields that a pair law reads (law.reads)."""
        return ti.Vector([field[j] for field in ti.static(law.reads)])

    @ti.func
    def image_row(self, law: Template, name, away):
        """Vector of law.reads' values for an image: `name` is its particle's index + MOST_PARTICLES times one bit for
        each mirrored axis; `away`, of any length, points from the image into the water and so tells its side."""
        return law.kept_image(self.particle_row(law, name % MOST_PARTICLES), name, away)

    @ti.func
    def image_velocity(self, v, name, away):
        """Velocity [m/s] of the image of a particle with velocity v: component k changes sign if bit k of `name` //
        MOST_PARTICLES is set; a piston adds twice its velocity. `away`, from image into water, tells its side."""
        image, flips = v, name // MOST_PARTICLES
        for k in ti.static(range(3)):
            image[k] = ti.select(flips >> k & 1, -image[k], image[k])
        for s, axis, upper in ti.static(self.pistons):
            beyond = away[axis] < 0.0 if ti.static(upper) else away[axis] > 0.0
            twice = self.images.side[s, SIDE_COLUMNS.twice_velocity + axis]
            image[axis] += ti.select((flips >> axis & 1) and beyond, twice, 0.0)
        return image


@in_kernels
class PairSlots(KeptPairs):
    """Stored pairs in the same number of slots for each particle: pairs with particles first, then with images."""

    def __init__(self, n: int, images: Images, tasks: Tasks, neighbours: int) -> None:
        super().__init__(images)
        self.tasks, self.slots = tasks, slot_count(neighbours)
        self.name = ti.field(int, shape=n * self.slots)
        self.gradient = ti.Vector.field(3, float, shape=n * self.slots)
        self.near, self.seen = (ti.field(int, shape=n) for _ in range(2))  # particles, and images with them

    @ti.func
    def walk(self, law: Template):
        for t in range(self.tasks.iterations):
            if t % self.tasks.stride == 0:
                self.walk_group(t // self.tasks.stride, law)

    @ti.func
    def walk_group(self, group, law: Template):
        law.begin(group)
        for i in range(self.tasks.first_particle(group), self.tasks.first_particle(group + 1)):
            own, first = self.particle_row(law, i), i * self.slots
            total, beyond = ti.Vector.zero(float, law.terms.size), ti.Vector.zero(float, law.terms.size)
            for a in range(first, first + self.near[i]):
                total += law.kept_pair(own, self.particle_row(law, self.name[a]), self.gradient[a])
            for a in range(first + self.near[i], first + self.seen[i]):
                gradient = self.gradient[a]
                beyond += law.kept_pair(own, self.image_row(law, self.name[a], gradient), gradient)
            law.finish(i, own, total, beyond, group)


@ti.func
def flip_code(mirror):
    """Three-bit code of the axes that matrix `mirror` reverses, shifted above the bits of a particle's index."""
    mirror_velocity = 0
    for k in ti.static(range(3)):
        mirror_velocity += int(mirror[POSITION_SIGN, k] < 0.0) << k
    return mirror_velocity * MOST_PARTICLES


@in_kernels
class PairBlocks(KeptPairs):
    """Store of pairs by sub-cell (GridSize.parts): candidates of each (particles, then images, both filled with dummies
    to whole vectors), and of each pair its gradient shape, a number: grad W over the distance vector."""

    def __init__(
        self, position: Components, grid: Grid, scratch: tuple[ti.Field, ...], smoothing: Smoothing, size: GridSize
    ) -> None:
        """Make the pair store; `scratch`: columns (position first) of fields of a sub-cell's possible neighbours."""
        super().__init__(grid.images)
        self.position, self.grid, self.scratch, self.smoothing = position, grid, scratch, smoothing
        self.groups, self.width, self.segment = size.groups, size.width, size.kept_candidates
        self.shapes_per_particle, self.spare_shapes = size.shapes_per_particle, size.spare_shapes
        # Of a part: where its candidates and its shapes begin, candidates that are particles, and with images.
        self.first, self.begun, self.near, self.seen = (ti.field(int, shape=size.occupied) for _ in range(4))
        self.next_first, self.next_begun = (ti.field(int, shape=self.groups) for _ in range(2))  # of the next part
        self.name = ti.field(int, shape=self.groups * self.segment)
        self.place = Components(self.groups * self.segment)  # [m]
        self.shape = ti.field(float, shape=size.lattice.n * self.shapes_per_particle + self.groups * self.spare_shapes)

    @ti.func
    def begin(self, group):
        """Empty the lists of a task (`group` of sub-cells), before pairs are stored anew."""
        self.next_first[group], self.next_begun[group] = group * self.segment, self.shape_start(group)

    @ti.func
    def shape_start(self, group):
        """Index in `shape` (grad W over distance, of pairs) at which task `group` begins, behind tasks before it."""
        return self.shapes_per_particle * self.grid.first[self.grid.first_part(group)] + group * self.spare_shapes

    @ti.func
    def spare_start(self, group):
        """Index in the array `shape` (grad W of kept pairs) of the last `width` entries of parallel task `group`, where
        sub-cells that find no room write theirs, one over the other."""
        return self.shape_start(group + 1) - self.width

    @ti.func
    def keep_part(self, k, group, names: Template, n, images, m, end):
        """Store sub-cell k's m candidates from the scratch of task `group`: n particles; images, entries `images` to
        `end` - 1; both with dummies. `names`: index, mirrored axes (flip_code) of each. Return index in `shape` of its
        first pair, step to the next particle's (0: no room, all reuse one place), and 1, or 0 if it has no room."""
        scratch, first, begun = group * self.width, self.next_first[group], self.next_begun[group]
        near, seen, room = images - scratch, end - scratch, 1
        if first + seen > (group + 1) * self.segment:
            near, seen, n, m, room = 0, 0, 0, 0, 0
        further = seen
        if begun + (self.grid.first[k + 1] - self.grid.first[k]) * seen > self.spare_start(group):
            begun, further = self.spare_start(group), 0
        x, y, z = ti.static(self.place.x, self.place.y, self.place.z)
        px, py, pz = ti.static(self.scratch[0], self.scratch[1], self.scratch[2])
        for a in range(seen):
            listed, to = scratch + a, first + a
            x[to], y[to], z[to] = px[listed], py[listed], pz[listed]
            self.name[to] = names[listed] if a < n or near <= a < near + m - n else 0
        self.first[k], self.begun[k], self.near[k], self.seen[k] = first, begun, near, seen
        self.next_first[group] = first + seen
        self.next_begun[group] += (self.grid.first[k + 1] - self.grid.first[k]) * further
        return begun, further, room

    @ti.func
    def keep_shape(self, away, to):
        """Store a pair's gradient shape (grad W over its distance vector, `away` [m]) at index `to` of `shape`."""
        self.shape[to] = self.smoothing.shape_gradient(ti.sqrt(away.dot(away)))

    @ti.func
    def walk(self, law: Template):
        for g in range(self.groups * TASK_ITERATIONS):
            if g % TASK_ITERATIONS == 0:
                self.walk_group(g // TASK_ITERATIONS, law)

    @ti.func
    def walk_group(self, group, law: Template):
        law.begin(group)
        for k in range(self.grid.first_part(group), self.grid.first_part(group + 1)):
            self.gather(k, law, group * self.width)
            self.sum_up(k, law, group)

    @ti.func
    def gather(self, k, law: Template, scratch):
        """Copy fields law.reads of the stored candidates of sub-cell k to scratch columns, from entry `scratch` on."""
        first, near = self.first[k], self.near[k]
        own = self.position.at(self.grid.first[k])  # of one of them, in the water
        for a in range(near):
            other = self.particle_row(law, self.name[first + a])
            for t in ti.static(range(len(law.reads))):
                self.scratch[t][scratch + a] = other[t]
        for a in range(near, self.seen[k]):
            other = self.image_row(law, self.name[first + a], own - self.place.at(first + a))
            for t in ti.static(range(len(law.reads))):
                self.scratch[t][scratch + a] = other[t]

    @ti.func
    def sum_up(self, k, law: Template, group):
        """Sum `law` (KeptLaw) for particles of sub-cell k, task `group`, over its candidates; call law.finish."""
        begun, near, seen = self.begun[k], self.near[k], self.seen[k]
        kept = begun < self.spare_start(group)
        for i in range(self.grid.first[k], self.grid.first[k + 1]):
            place, own = self.position.at(i), self.particle_row(law, i)
            if not kept:
                for a in range(seen):  # there was no room for them
                    self.keep_shape(place - self.place.at(self.first[k] + a), begun + a)
            total = self.pair_sum(law, place, own, k, group, begun, 0, near)
            beyond = self.pair_sum(law, place, own, k, group, begun, near, seen)
            law.finish(i, own, total, beyond, group)
            if kept:
                begun += seen

    @ti.func
    def pair_sum(self, law: Template, place, own, k, group, begun, begin, end):
        """Sum of law.kept_pair (KeptLaw) for a particle at `place` [m] of values `own`, over stored candidates `begin`
        to `end` - 1 of sub-cell k, task `group`. `begun`: index in `shape` (grad W over distance) of its first pair."""
        first, scratch, total = self.first[k], group * self.width, ti.Vector.zero(float, law.terms.size)
        for a in range(begin, end):
            away = place - self.place.at(first + a)
            other = ti.Vector([self.scratch[t][scratch + a] for t in ti.static(range(len(law.reads)))])
            total += law.kept_pair(own, other, self.shape[begun + a] * away)
        return total
