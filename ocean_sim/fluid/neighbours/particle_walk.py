"""The walk over neighbours for graphics cards, with a thread for each particle: the same laws and the same sums; and
plans of the walk, for processors and for graphics cards.

No candidates are listed: a thread goes through the cells around its particle, and through those around its mirrored
places. A task and a row of accounts belong to one particle, while `cell_walk.CellWalk` has few long tasks and rows.
Sums are gathered, never scattered. Only the order of particles in a cell is left to the card, and corrected before use.
"""

from dataclasses import dataclass
from math import isqrt
from typing import ClassVar

import numpy as np

from ocean_sim.fluid.budget.momentum_budget import TERM_NAMES, WORK_COLUMN, Accounts
from ocean_sim.fluid.neighbours.cell_walk import CellWalk
from ocean_sim.fluid.neighbours.grid import Grid
from ocean_sim.fluid.neighbours.grid_size import GridSize, Plan
from ocean_sim.fluid.neighbours.kept_pairs import KeptPairs, PairSlots, flip_code, slot_count
from ocean_sim.fluid.neighbours.point_sum import PointSum
from ocean_sim.fluid.neighbours.thread_tasks import Tasks
from ocean_sim.fluid.sph.law import Law
from ocean_sim.fluid.sph.particles import Particles
from ocean_sim.fluid.sph.smoothing import Smoothing
from ocean_sim.kernel_library import ti
from ocean_sim.parts import LedgerRow
from ocean_sim.runtime import GRAPHICS_BACKENDS, GRAPHICS_CARD_CHOICES, Template, in_kernels

SUM_BLOCK_CELLS = 128  # cells that a thread adds up


def level_sizes(cells: int) -> list[int]:
    """Lengths of the levels of a prefix sum over cells; each number sums SUM_BLOCK_CELLS of the level below it."""
    sizes = [cells + 1]
    while sizes[-1] > 1:
        sizes.append(-(-sizes[-1] // SUM_BLOCK_CELLS))
    return sizes


@in_kernels
class WideGrid(Grid):
    """Grid for graphics cards: counting sort with a prefix sum over blocks of cells, one thread for each particle. The
    sort is stable, as each particle counts those of its cell that came before it in the old order."""

    def __init__(self, particles: Particles, size: GridSize, carried: tuple[ti.Field, ...] = ()) -> None:
        super().__init__(particles, size, carried)
        self.slot = ti.field(int, shape=self.n)  # the particles of each cell, before they are in order
        self.sums = (self.start, *(ti.field(int, shape=n) for n in level_sizes(self.cell_count)[1:]))

    @ti.func
    def sort(self):
        # Count the particles of each cell, and sum the counts to the first particle of each.
        for c in self.count:
            self.count[c] = 0
        for i in range(self.particles.there()):
            ti.atomic_add(self.count[self.part[i]], 1)
        for c in self.start:
            self.start[c] = self.count[c] if c < self.cell_count else 0
        self.scan_counts()
        # Put particles down in any order, then each where its order of storage says.
        for c in self.count:
            self.count[c] = self.start[c]
        for i in range(self.particles.there()):
            self.slot[ti.atomic_add(self.count[self.part[i]], 1)] = i
        for i in range(self.particles.there()):
            self.place_particle(i)

    @ti.func
    def scan_counts(self):
        """Replace the number of particles in each cell by the number in all cells before it (prefix sum)."""
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
    def place_particle(self, i):
        """Move particle i to its sorted place, behind those of its cell that had a lower index before."""
        c = self.part[i]
        to = self.start[c]
        for k in range(self.start[c], self.start[c + 1]):
            to += int(self.slot[k] < i)
        for moved, state in ti.static(zip(self.moved, self.state)):
            state[to] = moved[i]


@in_kernels
class WideAccounts(Accounts):
    """Momentum budget with a row for each particle, summed over blocks of rows in fixed order, whatever the threads."""

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
        """Reduce extremes, counts (Accounts.summarise) of block b, a run of particles, to row b of `blocks`."""
        blocks, end = self.blocks, ti.min((b + 1) * self.block, self.groups)
        v2, a2, thin, dense, total, clipped, crowded, thinner, inner = self.block_extremes(b * self.block, end)
        blocks.speed2[b, 0], blocks.acceleration2[b, 0], blocks.thin[b, 0], blocks.dense[b, 0] = v2, a2, thin, dense
        blocks.thinner[b, 0], blocks.inner[b, 0] = thinner, inner
        blocks.sum[b, 0], blocks.clipped[b, 0], blocks.overflow[b, 0] = total, clipped, crowded

    @ti.kernel
    def add_up_impulses(self):
        """Sum impulse and work of each force over each block (a run of particles), into its row of `blocks`."""
        for b in range(self.blocks.groups):
            for term in ti.static(self.terms):
                four = ti.Vector.zero(ti.f64, WORK_COLUMN + 1)
                for g in range(b * self.block, ti.min((b + 1) * self.block, self.groups)):
                    for k in ti.static(range(WORK_COLUMN + 1)):
                        four[k] += self.given[g, term, k]
                for k in ti.static(range(WORK_COLUMN + 1)):
                    self.blocks.given[b, term, k] = four[k]

    def totals(self) -> dict[str, np.ndarray]:
        if self.impulses:
            self.add_up_impulses()
        return self.blocks.totals()


@in_kernels
class RowLaw:
    """Adapter that lets a PointSum (sum over particles near a point) sum a pair law: `term` calls law.pair."""

    def __init__(self, law: Law, grid: Grid, reflected: bool) -> None:
        """`reflected`: True to sum images; `term` then reads their sides (a bit each) behind a particle's values."""
        self.law, self.images, self.reflected, self.sums = law, grid.images, reflected, law.terms.size
        self.periodic = any(grid.basin.periods)

    @ti.func
    def term(self, own_and_sides, j, d, mirror):
        """Value of law.pair for particle j at d [m], or for its image in sides if `reflected`. `own_and_sides`: field
        values of the particle summed for, then, if `reflected`, these sides, a bit each; `mirror` is not used."""
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
class PairCollector:
    """Summand for PointSum that adds nothing but stores each pair; `own` is the index of the particle at its point."""

    sums = 1

    def __init__(self, pairs: PairSlots, smoothing: Smoothing) -> None:
        self.pairs, self.smoothing = pairs, smoothing

    @ti.func
    def term(self, own, j, d, mirror):
        """Store the pair of particles of index `own` and j, or of `own` and the image of j by matrix `mirror`, d [m]
        away, if 0 < |d| < support; return 1 if so, else 0."""
        r2, found = d.dot(d), 0.0
        if r2 < self.smoothing.support * self.smoothing.support and r2 > 0.0:
            seen, found = self.pairs.seen[own], 1.0
            if seen < self.pairs.slots:
                self.pairs.name[own * self.pairs.slots + seen] = j ^ flip_code(mirror)
                self.pairs.gradient[own * self.pairs.slots + seen] = self.smoothing.pair_gradient(-d)
            self.pairs.seen[own] = seen + 1
        return ti.Vector([found])


@in_kernels
class ParticleWalk:
    """Neighbour walk for graphics cards: one thread for each particle goes through the cells around it."""

    left_out: ClassVar[tuple[str, ...]] = ("shown",)

    def __init__(self, particles: Particles, grid: Grid, accounts: Accounts, size: GridSize) -> None:
        self.particles, self.most = particles.count, size.lattice.n
        self.grid, self.accounts = grid, accounts
        self.shown: dict[Law, tuple[PointSum, RowLaw, RowLaw]] = {}  # what a law is shown, made when it first walks
        self.keeps = False

    def keep_pairs(self, smoothing: Smoothing, neighbours: int, tasks: Tasks) -> KeptPairs:
        """Make the store that `walk` with `find` fills; `neighbours`: number on a lattice; `tasks`: share its sums."""
        self.keeps, self.pairs = True, PairSlots(self.most, self.grid.images, tasks, neighbours)
        self.kept = PairCollector(self.pairs, smoothing)
        return self.pairs

    def sums_of(self, law: Law) -> tuple[PointSum, RowLaw, RowLaw]:
        """PointSum that finds neighbours for a pair `law`; its summands (RowLaw) for particles, for images: cached."""
        if law not in self.shown:
            places = PointSum(law.reads[:3], self.grid)
            self.shown[law] = places, RowLaw(law, self.grid, False), RowLaw(law, self.grid, True)
        return self.shown[law]

    @ti.func
    def walk(self, law: Template, find: Template):
        """Sum law.pair over the neighbours of each particle, then call law.finish; `find`: also store the pairs."""
        around, water, images = ti.static(self.sums_of(law))
        for i in range(self.most):
            law.begin(i)
            if ti.static(find):
                self.accounts.overflow[i, 0] = 0
            if i < self.particles.there():
                own = ti.Vector([field[i] for field in ti.static(law.reads)])
                x = ti.Vector([own[0], own[1], own[2]])
                total, beyond = around.water_total(x, water, own), self.image_total(x, own, around, images)
                if ti.static(not law.options.apart):
                    total += beyond
                    beyond = ti.Vector.zero(float, law.terms.size)
                if ti.static(find and self.keeps):
                    self.store_pairs(i, x, around)
                law.finish(i, own, total, beyond, i)

    @ti.func
    def image_total(self, x, own, around: Template, images: Template):
        """Sum of a pair law over images, for a particle at x [m], values `own`; `around`, `images`: of `sums_of`."""
        here, total = self.grid.wrap_position(x), ti.Vector.zero(float, images.sums)
        reach = around.sides_in_reach(here)
        own_and_sides = ti.Vector.zero(float, images.law.row.size + 1)
        for k in ti.static(range(images.law.row.size)):
            own_and_sides[k] = own[k]
        for sides in range(1, reach + 1):
            if sides & reach == sides:
                own_and_sides[images.law.row.size] = ti.cast(sides, float)
                total += around.mirror_total(here, around.mirror(sides), images, own_and_sides)
        return total

    @ti.func
    def store_pairs(self, i, x, around: Template):
        """Store pairs of particle i at x [m], first with particles, then images, as PointSum `around` finds them."""
        pairs = self.pairs
        pairs.seen[i] = 0
        around.water_total(x, self.kept, i)
        pairs.near[i] = pairs.seen[i]
        around.image_total(x, self.kept, i)
        if pairs.seen[i] > pairs.slots:
            pairs.near[i] = pairs.seen[i] = 0
            self.accounts.overflow[i, 0] = 1


@dataclass(frozen=True)
class ParticlePlan(Plan):
    """Plan for graphics cards: each particle is a task of its own, for one thread."""

    stride: ClassVar[int] = 1
    samples: ClassVar[int] = 1

    def task_count(self, n: int) -> int:
        return n

    def chunk_count(self, n: int) -> int:
        """Number of chunks in which n particles are counted: 1, as atomic counters replace chunks."""
        return 1

    def parts_per_axis(self, full: float, dimension: int) -> int:
        return 1

    def sorting_integers(self, n: int, cells: int) -> int:
        return n + sum(level_sizes(cells)[1:])

    def list_bytes(self, size: GridSize, word: int) -> int:
        return 0

    def pair_bytes(self, size: GridSize, neighbours: int, word: int) -> int:
        return size.lattice.n * (8 + slot_count(neighbours) * (4 + 3 * word))  # of PairSlots

    def highest_index(self, size: GridSize, neighbours: int) -> int:
        return size.lattice.n * (slot_count(neighbours) if neighbours else 1)

    def account_bytes(self, n: int, word: int, impulses: bool) -> int:
        return n * (5 * word + 8 + (8 * 4 * len(TERM_NAMES) if impulses else 0))


Walk = CellWalk | ParticleWalk
CELL_PLAN, PARTICLE_PLAN = Plan(Grid, Accounts, CellWalk), ParticlePlan(WideGrid, WideAccounts, ParticleWalk)
CARD_PLANS = dict.fromkeys((*GRAPHICS_CARD_CHOICES, *GRAPHICS_BACKENDS), PARTICLE_PLAN)
PLANS: dict[str, Plan] = {"cpu": CELL_PLAN, "auto": CELL_PLAN} | CARD_PLANS
"""Plans by backend. Before a backend is started, `auto` counts as the processor and `gpu` as a card."""


def mesh_ledger(size: GridSize, word: int) -> list[LedgerRow]:
    """Row of the memory ledger for tables of distance to meshes, `word` bytes a number; empty without meshes."""
    spacing, meshes = size.lattice.spacing, size.lattice.basin.meshes.values()
    sizes = [mesh.net_bytes(spacing, word) + 6 * word for mesh in meshes]
    return [LedgerRow("basin", "distances from meshes", sum(sizes), "basin.obstacles")] if sizes else []


def account_ledger(size: GridSize, word: int, impulses: bool) -> list[LedgerRow]:
    """Row, if any, of the memory ledger for a momentum budget with a row a particle (see `account_bytes`)."""
    taken = size.plan.account_bytes(size.lattice.n, word, impulses)
    return [LedgerRow("fluid", "accounts", taken, "a row for each particle")] if taken else []
