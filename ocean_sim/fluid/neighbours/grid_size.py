"""How large the grid of cells is, known before anything is allocated."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from math import floor, log2
from typing import Any, ClassVar

import numpy as np

from ocean_sim.fluid.neighbours.thread_tasks import Tasks
from ocean_sim.fluid.sph.lattice import Lattice
from ocean_sim.fluid.sph.particles import Count, Particles


class Plan(ABC):
    """How particles are shared out to tasks, sorted, and walk (`walk_plan.PLANS`)."""

    stride: ClassVar[int]
    """Iterations of a parallel loop for a task."""
    samples: ClassVar[int]
    """Samples of solid bodies of a task."""

    @abstractmethod
    def groups(self, n: int) -> int:
        """Tasks of n particles, and rows of their accounts."""

    @abstractmethod
    def chunks(self, n: int) -> int:
        """Chunks in which n particles are counted and sorted."""

    @abstractmethod
    def halves(self, full: float, dimension: int) -> int:
        """Parts of a cell along each axis, where a cell of water at rest holds `full` particles."""

    @abstractmethod
    def sorting(self, n: int, cells: int) -> int:
        """Whole numbers that sorting n particles needs besides a count for each cell and chunk."""

    @abstractmethod
    def lists(self, size: Any, word: int) -> int:
        """Bytes of the lists of a `list_size.ListSize`, where `word` is the size of a `float` [bytes]."""

    @abstractmethod
    def pairs(self, size: Any, neighbours: int, word: int) -> int:
        """Bytes of the pairs that are kept of particles with so many neighbours on the lattice."""

    @abstractmethod
    def counted(self, size: Any, neighbours: int) -> int:
        """The highest number by which walks count, with the pairs that are kept of particles with so many neighbours on
        the lattice, if any."""

    @abstractmethod
    def rows(self, n: int, word: int, impulses: bool) -> int:
        """Bytes of the accounts of n particles that are worth telling."""

    @abstractmethod
    def grid(self, particles: Particles, size: "GridSize", carried: tuple) -> Any:
        """The cells: a `grid.Grid`."""

    @abstractmethod
    def accounts(self, groups: int, impulses: bool, absent: tuple[int, ...]) -> Any:
        """What a step did: `accounts.Accounts`."""

    @abstractmethod
    def walk(self, particles: Particles, grid: Any, accounts: Any, size: Any) -> Any:
        """What walks: a `walk_plan.Walk`."""

    def tasks(self, particles: Count, groups: int) -> Tasks:
        """The particles in as many groups as there are rows of accounts."""
        return Tasks(particles, groups, self.stride)


@dataclass(frozen=True)
class GridSize:
    """How large the grid is."""

    lattice: Lattice
    support: float  # [m]
    plan: Plan
    carried: int = 0  # numbers that a scheme carries along with each particle

    @property
    def inner(self) -> list[tuple[int, float]]:
        """Cells between the sides of the basin and their width [m], on each axis; at least a support wide."""
        extents = np.subtract(self.lattice.basin.upper, self.lattice.basin.lower)
        counts = [max(1, int(extent / self.support + 1e-9)) for extent in extents]
        return [(n, float(extent) / n or self.support) for n, extent in zip(counts, extents, strict=True)]

    @property
    def cells(self) -> tuple[int, int, int]:
        """Cells along x, y, z with one empty cell of padding all round."""
        nx, ny, nz = (n + 2 for n, _ in self.inner)
        return nx, ny, nz

    @property
    def sky(self) -> int:
        """Layers of cells over still water, or the uppermost one at least: they hold what flies above the grid, too."""
        return max(1, self.inner[1][0] // 2)

    @property
    def cell_count(self) -> int:
        nx, ny, nz = self.cells
        return nx * ny * nz

    @property
    def counts(self) -> int:
        """Numbers in which the particles of every part and chunk are counted."""
        return self.cell_count * self.parts * self.chunks

    @property
    def full(self) -> float:
        """Particles in a cube of the support (in 2-D a square), in water at rest."""
        return float((self.support / self.lattice.spacing) ** self.lattice.basin.dimension)

    @property
    def halves(self) -> int:
        """Parts of a cell along each axis."""
        return self.plan.halves(self.full, self.lattice.basin.dimension)

    @property
    def parts(self) -> int:
        """Parts of a cell, in whose order its particles are sorted: fewer are near one of them than near all of it."""
        return int(self.halves**self.lattice.basin.dimension)

    def quantum(self, eps: float) -> float:
        """Distance of the positions that numbers of a relative spacing `eps` can distinguish everywhere in the basin
        [m]: a power of two."""
        basin = self.lattice.basin
        return eps * 2.0 ** floor(log2(max(map(abs, (*basin.lower, *basin.upper)))))

    @property
    def chunks(self) -> int:
        """Chunks in which the particles are counted and sorted."""
        return self.plan.chunks(self.lattice.n)

    @property
    def groups(self) -> int:
        """Groups of cells or particles, each a task of its own: set by the scene, never by the number of threads."""
        return self.plan.groups(self.lattice.n)

    @property
    def occupied(self) -> int:
        """The most parts of cells that can hold a particle."""
        return min(self.lattice.n, self.cell_count * self.parts)

    def bytes(self, word: int) -> int:
        """Of the grid and the state on its way into it, where `word` is the size of a `float` [bytes]."""
        return (
            4 * (2 * self.lattice.n + self.counts + self.cell_count + 2 * self.occupied + 3)
            + word * (6 + 2 * self.lattice.basin.dimension + self.carried) * self.lattice.n
            + 4 * self.plan.sorting(self.lattice.n, self.cell_count)
        )
