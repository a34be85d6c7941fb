"""Sizes of the grid of cells and of the lists of candidates, known before anything is allocated."""

from dataclasses import dataclass
from math import floor, log2, pi
from typing import Any, ClassVar

import numpy as np

from ocean_sim.fluid.neighbours.thread_tasks import TASK_ITERATIONS
from ocean_sim.fluid.sph.lattice import Lattice
from ocean_sim.kernel_library import knows_processor

# Candidates summed at once: eight lanes of f32 four times, or four lanes twice.
VECTOR_LENGTH = 32 if knows_processor() else 8
MAX_KEPT_SHAPES = 2**30  # counted in 32 bits
FILLER_X = 1.0e9  # [m] x of candidates that fill a list up, out of reach of all
MAX_SERIAL_PARTICLES = 20_000  # up to so many particles one thread sorts faster than several
SORT_CHUNKS = 8
MIN_PART_PARTICLES = 7.0  # in a part of a cell; a list of candidates would serve too few
FEW_TASKS, MANY_TASKS = 16, 64  # groups of cells for few and many particles; each costs microseconds


@dataclass(frozen=True)
class Plan:
    """Division of work into tasks, and the classes that sort particles and walk over neighbours (particle_walk.PLANS).
    This one suits a processor's threads: few long tasks, each with candidate lists for its cells."""

    grid: Any  # constructor of the cells
    accounts: Any  # constructor of the accounts of a step
    walk: Any  # constructor of the walk over neighbours
    stride: ClassVar[int] = TASK_ITERATIONS  # iterations of a parallel loop for a task
    samples: ClassVar[int] = 32  # samples of solid bodies of a task

    def task_count(self, n: int) -> int:
        """Number of tasks for n particles; a task is a thread's share of them, with a row of the momentum budget."""
        return FEW_TASKS if n <= MAX_SERIAL_PARTICLES else MANY_TASKS

    def chunk_count(self, n: int) -> int:
        """Number of chunks into which the sort divides n particles, to count and place each chunk by itself."""
        return 1 if n <= MAX_SERIAL_PARTICLES else SORT_CHUNKS

    def parts_per_axis(self, full: float, dimension: int) -> int:
        """Number of parts into which a cell is cut along each axis, in 2-D or 3-D; `full`: particles in it at rest."""
        return 2 if full >= MIN_PART_PARTICLES * 2**dimension else 1

    def sorting_integers(self, n: int, cells: int) -> int:
        """Number of integers to sort n particles into `cells`, besides counters; 0 here, on a processor (CPU)."""
        return 0

    def list_bytes(self, size: "GridSize", word: int) -> int:
        """Memory [bytes] of candidate lists (possible neighbours) and scratch; `word`: bytes of a `float`."""
        return 4 * (size.occupied + size.groups * size.segment) + word * size.groups * size.width * size.reads

    def pair_bytes(self, size: "GridSize", neighbours: int, word: int) -> int:
        """Memory [bytes] of the stored pairs; `neighbours`: of a lattice particle; `word`: bytes of a `float`."""
        names = 4 * (4 * size.occupied + size.groups * (size.width + 2 + size.kept_candidates))
        shapes = size.lattice.n * size.shapes_per_particle + size.groups * size.spare_shapes
        return names + word * (shapes + 3 * size.groups * size.kept_candidates)

    def highest_index(self, size: "GridSize", neighbours: int) -> int:
        """Highest index into neighbour lists, to fit in 32 bits; `neighbours`: of a particle, 0 if unstored."""
        return size.groups * max(size.lattice.n, size.kept_candidates if neighbours else size.segment)

    def account_bytes(self, n: int, word: int, impulses: bool) -> int:
        """Memory [bytes] of the momentum budget (extremes and, if `impulses`, impulse and work of each force) of n
        particles, `word` bytes a float; 0 where it is negligible."""
        return 0


@dataclass(frozen=True)
class GridSize:
    """Sizes of the grid of cells and of the lists of candidates (possible neighbours)."""

    lattice: Lattice
    support: float  # [m]
    plan: Plan
    carried: int = 0  # numbers that a scheme carries along with each particle
    reads: int = 0  # the most fields that a pair law of this fluid reads of a neighbour

    @property
    def inner_cells(self) -> list[tuple[int, float]]:
        """Number of cells between the basin's sides and their width [m], at least a support, for each axis."""
        extents = np.subtract(self.lattice.basin.upper, self.lattice.basin.lower)
        counts = [max(1, int(extent / self.support + 1e-9)) for extent in extents]
        return [(n, float(extent) / n or self.support) for n, extent in zip(counts, extents, strict=True)]

    @property
    def cells(self) -> tuple[int, int, int]:
        """Numbers of cells along x, y and z, with one empty cell of padding at each end."""
        nx, ny, nz = (n + 2 for n, _ in self.inner_cells)
        return nx, ny, nz

    @property
    def sky(self) -> int:
        """Number of top cell layers that share particles above the grid, down and up by height: none is crowded."""
        return max(1, self.inner_cells[1][0] // 2)

    @property
    def cell_count(self) -> int:
        nx, ny, nz = self.cells
        return nx * ny * nz

    @property
    def count_numbers(self) -> int:
        """Number of counters for the sort: one for each sub-cell in each chunk (run of particles counted alone)."""
        return self.cell_count * self.parts * self.chunks

    @property
    def cell_particles(self) -> float:
        """Number of particles of water at rest in a cube (in 2-D a square) as wide as the support."""
        return float((self.support / self.lattice.spacing) ** self.lattice.basin.dimension)

    @property
    def parts_per_axis(self) -> int:
        """Number of sub-cells, 1 or 2, into which each cell is cut along an axis."""
        return self.plan.parts_per_axis(self.cell_particles, self.lattice.basin.dimension)

    @property
    def parts(self) -> int:
        """Number of sub-cells (1, or 2 along each axis) of a cell: each has fewer candidates (possible neighbours)."""
        return int(self.parts_per_axis**self.lattice.basin.dimension)

    def quantum(self, eps: float) -> float:
        """Unit [m] of particles' moves in a step, a power of two: positions add it exactly; `eps`: float precision."""
        basin = self.lattice.basin
        return eps * 2.0 ** floor(log2(max(map(abs, (*basin.lower, *basin.upper)))))

    @property
    def chunks(self) -> int:
        return self.plan.chunk_count(self.lattice.n)

    @property
    def groups(self) -> int:
        """Number of tasks (groups of cells or particles); it depends on the scene, not on the number of threads."""
        return self.plan.task_count(self.lattice.n)

    @property
    def occupied(self) -> int:
        """Upper bound of the number of sub-cells (see `parts`) that hold a particle."""
        return min(self.lattice.n, self.cell_count * self.parts)

    def bytes(self, word: int) -> int:
        """Memory [bytes] of the grid and of the sort's staging fields; `word`: bytes of a `float`."""
        return (
            4 * (2 * self.lattice.n + self.count_numbers + self.cell_count + 2 * self.occupied + 3)
            + word * (6 + 2 * self.lattice.basin.dimension + self.carried) * self.lattice.n
            + 4 * self.plan.sorting_integers(self.lattice.n, self.cell_count)
        )

    @property
    def rest_candidates(self) -> float:
        """Mean number of candidates (possible neighbours) of a sub-cell at rest: in a box two supports wider."""
        return (2.0 + 1.0 / self.parts_per_axis) ** self.lattice.basin.dimension * self.cell_particles

    @property
    def capacity(self) -> int:
        """Largest number of candidates (possible neighbours) of a sub-cell: four times that at rest, plus 256."""
        return int(4.0 * self.rest_candidates) + 256

    @property
    def segment(self) -> int:
        """Largest number of candidates listed for all sub-cells of a task (its segment): about twice that at rest."""
        parts = self.lattice.n / (self.cell_particles / self.parts)
        return int(2.0 * parts / self.groups * self.rest_candidates) + 4 * self.capacity

    @property
    def width(self) -> int:
        """Number of entries of a task's scratch, which holds the fields of one sub-cell's candidates (possible
        neighbours, images) at a time, and dummies that fill up whole vectors."""
        return self.capacity + 2 * VECTOR_LENGTH

    @property
    def shapes_per_particle(self) -> int:
        """Number of pairs per particle whose shape, grad W over distance, is stored; without room it is recomputed."""
        lattice, side = self.lattice, 1.0 / self.parts_per_axis
        around = side**2 + 4.0 * side + pi
        if lattice.basin.dimension == 3:
            around = side**3 + 6.0 * side**2 + 3.0 * pi * side + 4.0 / 3.0 * pi
        return min(int(1.25 * around * self.cell_particles) + VECTOR_LENGTH, MAX_KEPT_SHAPES // lattice.n)

    @property
    def spare_shapes(self) -> int:
        """Number of places in which a task stores shapes of pairs (grad W over distance) beyond `shapes_per_particle`,
        for crowded sub-cells. In the last `width` ones, those without others recompute theirs for each particle."""
        return 4 * self.capacity + self.width

    @property
    def kept_candidates(self) -> int:
        """Largest number of candidates stored with a task's pairs: those it lists (`segment`), and vector fillers."""
        return self.segment + VECTOR_LENGTH * (self.lattice.n // self.groups)
