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
    """Options of a pair law for the walks that sum it over neighbours (CellWalk, ParticleWalk)."""

    apart: bool = False  # True if the sum over images in the sides is kept by itself, as `beyond`
    padded: bool = False
    """True if candidates out of reach fill the lists up to whole vectors: worth it for pairs that take long."""
    tension_column: int = NO_COLUMN
    """Column of the row that is negative under tension. A cell none of whose candidates is so is summed by
    `pair_without_tension` instead of `pair`: the same term with less to do."""
    pair_without_tension: Any = None


@in_kernels
class Law(ABC):
    """Base class of pair laws (sums over neighbours), all ti.funcs; defaults suit a law that reads positions only."""

    row: Columns = Columns(position=3)
    """Columns that are read of a particle, `own`, and of a neighbour, `other`; the position comes first."""
    reads: tuple[ti.Field, ...]  # fields of the row, one a column
    terms: Columns  # columns of the sum, `total`
    options: WalkOptions = WalkOptions()
    factor = 1.0  # of the whole sum: constants of the kernel, and masses
    bodies = False
    boundary: Any
    solid: Any  # SampleSum of the boundary

    def add_bodies(self, boundary: Any) -> None:
        """Add solid bodies, a Boundary (None: no bodies), to the sum; `terms` (columns of the sum) must be set."""
        if boundary is not None:
            self.bodies, self.boundary, self.solid = True, boundary, boundary.sample_sum(self)

    @ti.func
    def prefactor(self, own):
        """Factor by which the whole sum is multiplied: `factor`, in some laws times values of the particle, `own`."""
        return self.factor

    @ti.func  # noqa: B027
    def begin(self, group):
        """Reset the law's sums over particles of task `group` (a thread's share); most laws need none."""

    @ti.func
    def image(self, other, mirror):
        """Field values of the image of a neighbour, with values `other`, in the flat side of this `mirror` matrix."""
        return mirror_position(mirror, other)

    @ti.func
    def sample(self, own, s, d, mirror):
        """Field values to use in `pair` for boundary particle s of a body, beside a particle of values `own`; d [m]:
        from that particle to s, or to the image of s by matrix `mirror`."""
        return own + d

    @abstractmethod
    def pair(self, own: Any, other: Any) -> Any:
        """Contribution of one neighbour, without prefactor; `own`, `other`: field values of particle and neighbour."""

    @abstractmethod
    def finish(self, i: Any, own: Any, total: Any, beyond: Any, group: Any) -> None:
        """Use the sums over neighbours of particle i with field values `own` (`row`): `total`, and, if options.apart,
        `beyond` over images in the basin's sides. `group`: i's task (a thread's share), also its row of the budget."""

    @ti.func
    def with_bodies(self, total, x, own):
        """Sums `total` (columns `terms`) of a particle at x [m], values `own`, plus those over boundary particles."""
        both = total
        if ti.static(self.bodies):
            both += self.solid.total(x, own)
        return both
