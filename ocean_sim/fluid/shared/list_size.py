"""How long lists of candidates are, known before anything is allocated."""

from dataclasses import dataclass
from math import pi

from ocean_sim.fluid.shared.grid_size import GridSize
from ocean_sim.kernel_library import knows_processor, ti

# candidates that a processor may sum up at once: eight lanes of f32, four times over, or four lanes twice
VECTOR = 32 if knows_processor() else 8
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
    def kept(self) -> int:
        """Pairs that one group of parts may keep, of all its particles with all candidates of their part: a quarter
        more than in water that has lost its lattice, where parts are full and candidates fill a support around them."""
        lattice, side = self.grid.lattice, 1.0 / self.grid.halves
        around = side**2 + 4.0 * side + pi
        if lattice.basin.dimension == 3:
            around = side**3 + 6.0 * side**2 + 3.0 * pi * side + 4.0 / 3.0 * pi
        each = int(1.25 * around * self.grid.full) + VECTOR
        crowd = 2 * self.capacity * int(self.grid.full / self.grid.parts)
        return each * (lattice.n // self.grid.groups) + crowd

    def bytes_kept(self, word: int) -> int:
        """Of pairs that are kept, and of their candidates."""
        return 4 * (4 * self.grid.occupied + self.grid.groups * (self.width + 2)) + self.grid.groups * (
            self.segment * (4 + 3 * word) + self.kept * word
        )

    def bytes(self, word: int) -> int:
        """Of lists and scratch, where `word` is the size of a `float` [bytes]."""
        return (
            4 * (self.grid.occupied + self.grid.groups * self.segment)
            + word * self.grid.groups * self.width * self.reads
        )
