"""Which walk over neighbours suits a machine: what each makes room for, and what does it."""

from abc import ABC, abstractmethod
from typing import Any, ClassVar, Protocol

from ocean_sim.fluid.shared.accounts import TERMS, Accounts
from ocean_sim.fluid.shared.grid import Grid
from ocean_sim.fluid.shared.grid_size import GridSize
from ocean_sim.fluid.shared.neighbours import ListSize, Neighbours
from ocean_sim.fluid.shared.pairs import Pairs
from ocean_sim.fluid.shared.particle_walk import ParticleWalk, WideAccounts, WideGrid, levels
from ocean_sim.fluid.shared.particles import Count, Particles
from ocean_sim.fluid.shared.smoothing import Smoothing
from ocean_sim.fluid.shared.tasks import TASK, Tasks
from ocean_sim.parts import LedgerRow
from ocean_sim.runtime import CARDS, GRAPHICS

SERIAL = 20_000  # up to so many particles one thread sorts faster than several
CHUNKS = 8
FEW, MANY = 16, 64  # groups of cells for few and many particles: threads share them, each costs microseconds


class Walk(Protocol):
    """Sums laws of pairs over the neighbours of every particle."""

    def keep(self, pairs: Pairs, smoothing: Smoothing) -> None:
        """From now on a walk that finds its candidates also keeps their pairs."""
        ...

    def walk(self, law: Any, find: Any) -> None:
        """ti.func, at the top of a kernel: for every particle, sum law.pair over its neighbours, then law.finish it.
        `find`: whether the particles have been sorted since the last walk."""
        ...


class WalkPlan(ABC):
    """How particles are shared out to tasks, and walk."""

    stride: ClassVar[int]
    """Iterations of a parallel loop for a task."""
    samples: ClassVar[int]
    """Samples of solid bodies of a task."""

    @abstractmethod
    def groups(self, n: int) -> int:
        """Tasks of n particles, and rows of their accounts."""

    @abstractmethod
    def chunks(self, n: int) -> int:
        """Parts in which n particles are counted and sorted."""

    @abstractmethod
    def sorting(self, n: int, cells: int) -> int:
        """Whole numbers that sorting n particles needs besides a count for each cell and chunk."""

    @abstractmethod
    def lists(self, size: ListSize, word: int) -> int:
        """Bytes of the lists of candidates, where `word` is the size of a `float` [bytes]."""

    @abstractmethod
    def rows(self, n: int, word: int, impulses: bool) -> int:
        """Bytes of the accounts of n particles that are worth telling."""

    @abstractmethod
    def grid(self, particles: Particles, size: GridSize, carried: tuple) -> Grid:
        """The cells."""

    @abstractmethod
    def accounts(self, groups: int, impulses: bool, absent: tuple[int, ...]) -> Accounts:
        """What a step did."""

    @abstractmethod
    def walk(self, particles: Particles, grid: Grid, accounts: Accounts, size: ListSize) -> Walk:
        """What walks."""

    def tasks(self, particles: Count, groups: int) -> Tasks:
        """The particles in as many parts as there are rows of accounts."""
        return Tasks(particles, groups, self.stride)


class OfCells(WalkPlan):
    """Few long tasks, each with a list of candidates for its cells, for the threads of a processor."""

    stride, samples = TASK, 32

    def groups(self, n: int) -> int:
        return FEW if n <= SERIAL else MANY

    def chunks(self, n: int) -> int:
        return 1 if n <= SERIAL else CHUNKS

    def sorting(self, n: int, cells: int) -> int:
        return 0

    def lists(self, size: ListSize, word: int) -> int:
        return size.bytes(word)

    def rows(self, n: int, word: int, impulses: bool) -> int:
        return 0

    def grid(self, particles: Particles, size: GridSize, carried: tuple) -> Grid:
        return Grid(particles, size, carried)

    def accounts(self, groups: int, impulses: bool, absent: tuple[int, ...]) -> Accounts:
        return Accounts(groups, impulses, absent)

    def walk(self, particles: Particles, grid: Grid, accounts: Accounts, size: ListSize) -> Walk:
        return Neighbours(particles, grid, accounts, size)


class OfParticles(WalkPlan):
    """A task a particle, for the threads of a graphics card."""

    stride, samples = 1, 1

    def groups(self, n: int) -> int:
        return n

    def chunks(self, n: int) -> int:
        return 1

    def sorting(self, n: int, cells: int) -> int:
        return n + sum(levels(cells)[1:])

    def lists(self, size: ListSize, word: int) -> int:
        return 0

    def rows(self, n: int, word: int, impulses: bool) -> int:
        return n * (5 * word + 8 + (8 * 4 * len(TERMS) if impulses else 0))

    def grid(self, particles: Particles, size: GridSize, carried: tuple) -> Grid:
        return WideGrid(particles, size, carried)

    def accounts(self, groups: int, impulses: bool, absent: tuple[int, ...]) -> Accounts:
        return WideAccounts(groups, impulses, absent)

    def walk(self, particles: Particles, grid: Grid, accounts: Accounts, size: ListSize) -> Walk:
        return ParticleWalk(particles, grid, accounts)


CELLS, PARTICLES = OfCells(), OfParticles()
PLANS: dict[str, WalkPlan] = {"cpu": CELLS, "auto": CELLS} | dict.fromkeys((*CARDS, *GRAPHICS), PARTICLES)
"""By backend; before it is started `auto` counts as the processor, and `gpu` as a card."""


def of_accounts(size: GridSize, word: int, impulses: bool) -> list[LedgerRow]:
    """The ledger of what each particle writes of a step, where it writes a row of its own."""
    taken = size.plan.rows(size.lattice.n, word, impulses)
    return [LedgerRow("fluid", "accounts", taken, "a row for each particle")] if taken else []
