"""Which walk over neighbours suits a machine: what each makes room for, and what does it."""

from typing import Any, Protocol

from ocean_sim.fluid.budget.momentum_budget import TERMS, Accounts
from ocean_sim.fluid.neighbours.cell_walk import Neighbours
from ocean_sim.fluid.neighbours.grid import Grid
from ocean_sim.fluid.neighbours.grid_size import GridSize, Plan
from ocean_sim.fluid.neighbours.list_size import ListSize
from ocean_sim.fluid.neighbours.pair_slots import KeptPairs, bytes_kept, slots
from ocean_sim.fluid.neighbours.particle_walk import ParticleWalk, WideAccounts, WideGrid, levels
from ocean_sim.fluid.neighbours.thread_tasks import TASK, Tasks
from ocean_sim.fluid.sph.particles import Particles
from ocean_sim.fluid.sph.smoothing import Smoothing
from ocean_sim.parts import LedgerRow
from ocean_sim.runtime import GRAPHICS_BACKENDS, GRAPHICS_CARD_CHOICES

SERIAL = 20_000  # up to so many particles one thread sorts faster than several
CHUNKS = 8
LEAST = 7.0  # particles in a part of a cell, or its list of candidates serves too few
FEW, MANY = 16, 64  # groups of cells for few and many particles: threads share them, each costs microseconds


class Walk(Protocol):
    """Sums laws of pairs over the neighbours of every particle."""

    def keep(self, smoothing: Smoothing, neighbours: int, tasks: Tasks) -> KeptPairs:
        """From now on a walk that finds its candidates also keeps their pairs; `neighbours`: how many a particle has
        on the lattice."""
        ...

    def walk(self, law: Any, find: Any) -> None:
        """ti.func, at the top of a kernel: for every particle, sum law.pair over its neighbours, then law.finish it.
        `find`: whether the particles have been sorted since the last walk."""
        ...


class OfCells(Plan):
    """Few long tasks, each with a list of candidates for its cells, for the threads of a processor."""

    stride, samples = TASK, 32

    def groups(self, n: int) -> int:
        return FEW if n <= SERIAL else MANY

    def chunks(self, n: int) -> int:
        return 1 if n <= SERIAL else CHUNKS

    def halves(self, full: float, dimension: int) -> int:
        return 2 if full >= LEAST * 2**dimension else 1

    def sorting(self, n: int, cells: int) -> int:
        return 0

    def lists(self, size: ListSize, word: int) -> int:
        return size.bytes(word)

    def pairs(self, size: ListSize, neighbours: int, word: int) -> int:
        return size.bytes_kept(word)

    def counted(self, size: ListSize, neighbours: int) -> int:
        return size.grid.groups * max(size.grid.lattice.n, size.kept if neighbours else size.segment)

    def rows(self, n: int, word: int, impulses: bool) -> int:
        return 0

    def grid(self, particles: Particles, size: GridSize, carried: tuple) -> Grid:
        return Grid(particles, size, carried)

    def accounts(self, groups: int, impulses: bool, absent: tuple[int, ...]) -> Accounts:
        return Accounts(groups, impulses, absent)

    def walk(self, particles: Particles, grid: Grid, accounts: Accounts, size: ListSize) -> Walk:
        return Neighbours(particles, grid, accounts, size)


class OfParticles(Plan):
    """A task a particle, for the threads of a graphics card."""

    stride, samples = 1, 1

    def groups(self, n: int) -> int:
        return n

    def chunks(self, n: int) -> int:
        return 1

    def halves(self, full: float, dimension: int) -> int:
        return 1

    def sorting(self, n: int, cells: int) -> int:
        return n + sum(levels(cells)[1:])

    def lists(self, size: ListSize, word: int) -> int:
        return 0

    def pairs(self, size: ListSize, neighbours: int, word: int) -> int:
        return bytes_kept(size.grid.lattice.n, neighbours, word)

    def counted(self, size: ListSize, neighbours: int) -> int:
        return size.grid.lattice.n * (slots(neighbours) if neighbours else 1)

    def rows(self, n: int, word: int, impulses: bool) -> int:
        return n * (5 * word + 8 + (8 * 4 * len(TERMS) if impulses else 0))

    def grid(self, particles: Particles, size: GridSize, carried: tuple) -> Grid:
        return WideGrid(particles, size, carried)

    def accounts(self, groups: int, impulses: bool, absent: tuple[int, ...]) -> Accounts:
        return WideAccounts(groups, impulses, absent)

    def walk(self, particles: Particles, grid: Grid, accounts: Accounts, size: ListSize) -> Walk:
        return ParticleWalk(particles, grid, accounts)


CELLS, PARTICLES = OfCells(), OfParticles()
PLANS: dict[str, Plan] = {"cpu": CELLS, "auto": CELLS} | dict.fromkeys(
    (*GRAPHICS_CARD_CHOICES, *GRAPHICS_BACKENDS), PARTICLES
)
"""By backend; before it is started `auto` counts as the processor, and `gpu` as a card."""


def of_accounts(size: GridSize, word: int, impulses: bool) -> list[LedgerRow]:
    """The ledger of what each particle writes of a step, where it writes a row of its own."""
    taken = size.plan.rows(size.lattice.n, word, impulses)
    return [LedgerRow("fluid", "accounts", taken, "a row for each particle")] if taken else []
