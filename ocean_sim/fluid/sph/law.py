"""Interface of a pairwise interaction: its inputs, the term of a pair, and the use of the sum.

A law is a sum over the neighbours j of each particle i,

    total_i = sum_j pair(own_i, other_j),

which `finish` multiplies by its `prefactor` and puts to use. A law fills in at most ten names.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

from ocean_sim.columns import Columns
from ocean_sim.fluid.neighbours.images import mirror_position
from ocean_sim.kernel_library import ti
from ocean_sim.runtime import in_kernels

NO_COLUMN = -1


@dataclass(frozen=True)
class WalkOptions:
    """Options of the walk over neighbours for a law."""

    apart: bool = False
    """True if the sum over images in the sides is kept by itself, as `beyond`."""
    padded: bool = False
    """True if candidates out of reach fill the lists up to whole vectors: worth it for pairs that take long."""
    tension_column: int = NO_COLUMN
    """Column of the row that is negative under tension. A cell none of whose candidates is so is summed by
    `pair_without_tension` instead of `pair`: the same term with less to do."""
    pair_without_tension: Any = None


@in_kernels
class Law(ABC):
    """Base class of all laws. The defaults suit one that reads nothing but positions. All functions are ti.funcs."""

    row: Columns = Columns(position=3)
    """Columns that are read of a particle, `own`, and of a neighbour, `other`; the position comes first."""
    reads: tuple[ti.Field, ...]
    """Fields of the row, one a column."""
    terms: Columns
    """Columns of the sum, `total`."""
    options: WalkOptions = WalkOptions()
    bodies = False
    boundary: Any
    solid: Any  # SampleSum of the boundary

    def add_bodies(self, boundary: Any) -> None:
        """Also sum over the samples of a Boundary's bodies; None: there are none. Call it once `terms` are known."""
        if boundary is not None:
            self.bodies, self.boundary, self.solid = True, boundary, boundary.sample_sum(self)

    @ti.func
    def prefactor(self, own):
        """Factor of the whole sum: constants of the kernel, masses, and the particle's own fields."""
        return 1.0

    @ti.func  # noqa: B027
    def begin(self, group):
        """Prepare for the first particle of a group; most laws have nothing to prepare."""

    @ti.func
    def image(self, other, mirror):
        """Row of a neighbour's image in a side."""
        return mirror_position(mirror, other)

    @ti.func
    def sample(self, own, s, d, mirror):
        """Row of sample s of a solid body, seen in a mirror at d [m] from the particle."""
        return own + d

    @abstractmethod
    def pair(self, own: Any, other: Any) -> Any:
        """Term of one neighbour, without the prefactor."""

    @abstractmethod
    def finish(self, i: Any, own: Any, total: Any, beyond: Any, group: Any) -> None:
        """Use the sums of particle i: `total`, and `beyond`, that of images, where these are summed apart."""

    @ti.func
    def with_bodies(self, total, x, own):
        """Sum of a law, and of its terms over the samples of solid bodies around x [m]."""
        both = total
        if ti.static(self.bodies):
            both += self.solid.total(x, own)
        return both
