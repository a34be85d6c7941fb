"""How long lists of candidates are, known before anything is allocated."""

from dataclasses import dataclass
from math import pi

from ocean_sim.fluid.neighbours.grid_size import GridSize
from ocean_sim.kernel_library import knows_processor, ti

# candidates that a processor may sum up at once: eight lanes of f32, four times over, or four lanes twice
VECTOR = 32 if knows_processor() else 8
MOST = 2**30  # shapes that are kept: they are counted in 32 bits
AWAY = 1.0e9  # [m] x of candidates that fill a list up, out of reach of all


@ti.func
def whole(count):
    """So many candidates or more, in whole vectors."""
    return (count + VECTOR - 1) // VECTOR * VECTOR


@dataclass(frozen=True)
class ListSize:
    """How long the candidate lists are, known before anything is allocated."""

    grid: GridSize
    reads: int  # the most fields that a pair law of this fluid reads of a neighbour

    @property
    def at_rest(self) -> float:
        """Candidates of a full part of a cell in water at rest: a box of two supports more (in 2-D a square)."""
        return (2.0 + 1.0 / self.grid.halves) ** self.grid.lattice.basin.dimension * self.grid.full

    @property
    def capacity(self) -> int:
        """Candidates that one part of a cell may have: water compressed four times, and a good deal for splashes."""
        return int(4.0 * self.at_rest) + 256

    @property
    def segment(self) -> int:
        """Candidates that one group of parts may have: twice those of water at rest, whose parts are full."""
        parts = self.grid.lattice.n / (self.grid.full / self.grid.parts)
        return int(2.0 * parts / self.grid.groups * self.at_rest) + 4 * self.capacity

    @property
    def width(self) -> int:
        """Numbers of a column of the scratch of a group: the candidates of a cell, filled up to whole vectors twice."""
        return self.capacity + 2 * VECTOR

    @property
    def each(self) -> int:
        """Shapes of pairs that are kept a particle: a quarter more than in water that has lost its lattice, where parts
        are full and candidates fill a support around them. What finds no room is found again when it is read."""
        lattice, side = self.grid.lattice, 1.0 / self.grid.halves
        around = side**2 + 4.0 * side + pi
        if lattice.basin.dimension == 3:
            around = side**3 + 6.0 * side**2 + 3.0 * pi * side + 4.0 / 3.0 * pi
        return min(int(1.25 * around * self.grid.full) + VECTOR, MOST // lattice.n)

    @property
    def spare(self) -> int:
        """Shapes of a group beyond those, the last `width` of them those of a particle that found no room."""
        return 4 * self.capacity + self.width

    @property
    def kept(self) -> int:
        """Candidates that one group of parts may keep: those that it lists, filled up where half of its particles are
        alone."""
        return self.segment + VECTOR * (self.grid.lattice.n // self.grid.groups)

    def bytes_kept(self, word: int) -> int:
        """Of pairs that are kept, and of their candidates."""
        groups = self.grid.groups
        names = 4 * (4 * self.grid.occupied + groups * (self.width + 2 + self.kept))
        return names + word * (self.grid.lattice.n * self.each + groups * (self.spare + 3 * self.kept))

    def bytes(self, word: int) -> int:
        """Of lists and scratch, where `word` is the size of a `float` [bytes]."""
        return (
            4 * (self.grid.occupied + self.grid.groups * self.segment)
            + word * self.grid.groups * self.width * self.reads
        )
