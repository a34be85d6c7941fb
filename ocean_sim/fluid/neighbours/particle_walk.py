"""The walk over neighbours where each particle has a thread, as on graphics cards: the same laws, the same sums.

Nothing is listed: a thread goes through the cells around its particle, and through those around where sides show it.
What `neighbours.Neighbours` does with few long tasks, and few rows of accounts, this does with a task and a row a
particle. All is gathered; the one thing whose order is left to the card, which particle of a cell is put down first,
is put right before anything reads it.
"""

from math import isqrt
from typing import ClassVar

import numpy as np

from ocean_sim.fluid.budget.momentum_budget import WORK, Accounts
from ocean_sim.fluid.neighbours.grid import Grid
from ocean_sim.fluid.neighbours.grid_size import GridSize, ListSize
from ocean_sim.fluid.neighbours.kept_pairs import KeptPairs, Pairs, flips
from ocean_sim.fluid.neighbours.point_sum import Around
from ocean_sim.fluid.neighbours.thread_tasks import Tasks
from ocean_sim.fluid.sph.law import Law
from ocean_sim.fluid.sph.particles import Particles
from ocean_sim.fluid.sph.smoothing import Smoothing
from ocean_sim.kernel_library import ti
from ocean_sim.runtime import Template, in_kernels

SUM_BLOCK_CELLS = 128  # cells that a thread adds up


def level_sizes(cells: int) -> list[int]:
    """How many sums there are of each level, of so many cells: sums of BLOCK sums of the last, down to one."""
    sizes = [cells + 1]
    while sizes[-1] > 1:
        sizes.append(-(-sizes[-1] // SUM_BLOCK_CELLS))
    return sizes


@in_kernels
class WideGrid(Grid):
    """The cells, sorted into by as many threads as there are particles: a counting sort whose sums are those of blocks
    of blocks of cells.

    Threads put particles down in their cells in any order; then each particle counts those of its cell that were stored
    before it. So the sort is stable, whatever the order was.
    """

    def __init__(self, particles: Particles, size: GridSize, carried: tuple[ti.Field, ...] = ()) -> None:
        super().__init__(particles, size, carried)
        self.slot = ti.field(int, shape=self.n)  # the particles of each cell, before they are in order
        self.sums = (self.start, *(ti.field(int, shape=n) for n in level_sizes(self.cell_count)[1:]))

    @ti.func
    def sort(self):
        """Stable counting sort of what was left, by cell, into the particles; call it at the top of a kernel."""
        for c in self.count:
            self.count[c] = 0
        for i in range(self.particles.there()):
            ti.atomic_add(self.count[self.part[i]], 1)
        for c in self.start:
            self.start[c] = self.count[c] if c < self.cell_count else 0
        self.scan()
        for c in self.count:
            self.count[c] = self.start[c]
        for i in range(self.particles.there()):
            self.slot[ti.atomic_add(self.count[self.part[i]], 1)] = i
        for i in range(self.particles.there()):
            self.place(i)

    @ti.func
    def scan(self):
        """The number of particles in each cell becomes that in all cells before it."""
        for level in ti.static(range(1, len(self.sums))):
            for b in self.sums[level]:
                total, here = 0, self.sums[level - 1].shape[0]
                for k in range(b * SUM_BLOCK_CELLS, ti.min((b + 1) * SUM_BLOCK_CELLS, here)):
                    one = self.sums[level - 1][k]
                    self.sums[level - 1][k] = total
                    total += one
                self.sums[level][b] = total
        for above in ti.static(range(len(self.sums) - 2, 0, -1)):
            for k in self.sums[above - 1]:
                self.sums[above - 1][k] = self.sums[above - 1][k] + self.sums[above][k // SUM_BLOCK_CELLS]

    @ti.func
    def place(self, i):
        """Put particle i where it belongs: after those of its cell that were stored before it."""
        c = self.part[i]
        to = self.start[c]
        for k in range(self.start[c], self.start[c + 1]):
            to += int(self.slot[k] < i)
        for moved, state in ti.static(zip(self.moved, self.state)):
            state[to] = moved[i]


@in_kernels
class WideAccounts(Accounts):
    """Each particle writes its own row; rows are added up in blocks, and the blocks in their order."""

    def __init__(self, groups: int, impulses: bool, absent: tuple[int, ...]) -> None:
        super().__init__(groups, impulses, absent, apart=1)
        self.block = max(1, isqrt(groups))
        self.blocks = Accounts(-(-groups // self.block), impulses, absent, apart=1)

    @ti.func
    def summarise(self, summary: Template):
        for b in range(self.blocks.groups):
            self.add_up(b)
        self.blocks.summarise(summary)

    @ti.func
    def add_up(self, b):
        """Put the rows of block b into one, but for impulses and work."""
        blocks, end = self.blocks, ti.min((b + 1) * self.block, self.groups)
        speed2, acceleration2, thin, dense, total, clipped, crowded = self.added_up(b * self.block, end)
        blocks.speed2[b, 0], blocks.acceleration2[b, 0] = speed2, acceleration2
        blocks.thin[b, 0], blocks.dense[b, 0] = thin, dense
        blocks.sum[b, 0], blocks.clipped[b, 0], blocks.overflow[b, 0] = total, clipped, crowded

    @ti.kernel
    def add_up_impulses(self):
        """Put the impulses and the work of the rows of each block into one."""
        for b in range(self.blocks.groups):
            for term in ti.static(self.terms):
                four = ti.Vector.zero(ti.f64, WORK + 1)
                for g in range(b * self.block, ti.min((b + 1) * self.block, self.groups)):
                    for k in ti.static(range(WORK + 1)):
                        four[k] += self.given[g, term, k]
                for k in ti.static(range(WORK + 1)):
                    self.blocks.given[b, term, k] = four[k]

    def total(self) -> dict[str, np.ndarray]:
        if self.impulses:
            self.add_up_impulses()
        return self.blocks.total()

    def total_work(self) -> dict[str, float]:
        if self.impulses:
            self.add_up_impulses()
        return self.blocks.total_work()


@in_kernels
class Seen:
    """What a law of pairs adds up of the particles around, or of their images."""

    def __init__(self, law: Law, grid: Grid, reflected: bool) -> None:
        """`reflected`: whether what is seen are images; then the set of sides that show them, a bit each, comes after
        the row of the particle."""
        self.law, self.images, self.reflected, self.sums = law, grid.images, reflected, law.terms.size
        self.periodic = any(grid.basin.periods)

    @ti.func
    def term(self, own_and_sides, j, d, mirror):
        own = ti.Vector([own_and_sides[k] for k in ti.static(range(self.law.row.size))])
        other = ti.Vector([field[j] for field in ti.static(self.law.reads)])
        if ti.static(self.reflected):
            sides = int(own_and_sides[self.law.row.size])
            for side in range(self.images.sides):
                if sides >> side & 1:  # one after the other: a law need not see two sides as it sees one
                    other = self.law.image(other, self.images.mirror(side))
        if ti.static(self.periodic):
            for k in ti.static(range(3)):
                other[k] = own[k] + d[k]
        return self.law.pair(own, other)


@in_kernels
class Kept:
    """Keeps the pairs of a particle, number `own`, that a PointLaw is shown."""

    sums = 1

    def __init__(self, pairs: Pairs, smoothing: Smoothing) -> None:
        self.pairs, self.smoothing = pairs, smoothing

    @ti.func
    def term(self, own, j, d, mirror):
        """1 where it is near, but not in the same place."""
        r2, found = d.dot(d), 0.0
        if r2 < self.smoothing.support * self.smoothing.support and r2 > 0.0:
            seen, found = self.pairs.seen[own], 1.0
            if seen < self.pairs.room:
                self.pairs.name[own * self.pairs.room + seen] = j ^ flips(mirror)
                self.pairs.gradient[own * self.pairs.room + seen] = self.smoothing.pair_gradient(-d)
            self.pairs.seen[own] = seen + 1
        return ti.Vector([found])


@in_kernels
class ParticleWalk:
    """The walk of a thread a particle."""

    left_out: ClassVar[tuple[str, ...]] = ("shown",)

    def __init__(self, particles: Particles, grid: Grid, accounts: Accounts, size: ListSize) -> None:
        self.particles, self.most = particles.count, size.grid.lattice.n
        self.grid, self.accounts = grid, accounts
        self.shown: dict[Law, tuple[Around, Seen, Seen]] = {}  # what a law is shown, made when it first walks
        self.keeps = False

    def keep(self, smoothing: Smoothing, neighbours: int, tasks: Tasks) -> KeptPairs:
        self.keeps, self.pairs = True, Pairs(self.most, self.grid.images, tasks, neighbours)
        self.kept = Kept(self.pairs, smoothing)
        return self.pairs

    def around(self, law: Law) -> tuple[Around, Seen, Seen]:
        """The water around a particle as a law reads it, and what sees particles and images there."""
        if law not in self.shown:
            places = Around(law.reads[:3], self.grid)
            self.shown[law] = places, Seen(law, self.grid, False), Seen(law, self.grid, True)
        return self.shown[law]

    @ti.func
    def walk(self, law: Template, find: Template):
        """As `Neighbours.walk`; to `find` candidates is to keep their pairs, where they are kept."""
        around, water, images = ti.static(self.around(law))
        for i in range(self.most):
            law.begin(i)
            if ti.static(find):
                self.accounts.overflow[i, 0] = 0
            if i < self.particles.there():
                own = ti.Vector([field[i] for field in ti.static(law.reads)])
                x = ti.Vector([own[0], own[1], own[2]])
                total, beyond = around.of_water(x, water, own), self.of_images(x, own, around, images)
                if ti.static(not law.options.apart):
                    total += beyond
                    beyond = ti.Vector.zero(float, law.terms.size)
                if ti.static(find and self.keeps):
                    self.keep_pairs(i, x, around)
                law.finish(i, own, total, beyond, i)

    @ti.func
    def of_images(self, x, own, around: Template, images: Template):
        """What all images add to the sum of a particle at x [m]."""
        here, total = self.grid.wrapped(x), ti.Vector.zero(float, images.sums)
        reach = around.reach(here)
        own_and_sides = ti.Vector.zero(float, images.law.row.size + 1)
        for k in ti.static(range(images.law.row.size)):
            own_and_sides[k] = own[k]
        for sides in range(1, reach + 1):
            if sides & reach == sides:
                own_and_sides[images.law.row.size] = ti.cast(sides, float)
                total += around.seen(here, around.mirror(sides), images, own_and_sides)
        return total

    @ti.func
    def keep_pairs(self, i, x, around: Template):
        """Keep the pairs of particle i, which is at x [m]."""
        pairs = self.pairs
        pairs.seen[i] = 0
        around.of_water(x, self.kept, i)
        pairs.near[i] = pairs.seen[i]
        around.of_images(x, self.kept, i)
        if pairs.seen[i] > pairs.room:
            pairs.near[i] = pairs.seen[i] = 0
            self.accounts.overflow[i, 0] = 1
