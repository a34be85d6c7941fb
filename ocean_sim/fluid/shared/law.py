"""What a law of pairs is: what it reads of particles, what a neighbour adds to a sum, and what becomes of the sum."""

from typing import Any, Protocol

from ocean_sim.columns import Columns
from ocean_sim.fluid.shared.images import mirrored
from ocean_sim.kernel_library import ti
from ocean_sim.runtime import in_kernels

NONE = -1  # no column


class Law(Protocol):
    """What `Neighbours.walk` sums over the neighbours of every particle. All functions are ti.funcs."""

    row: Columns
    """What is read of a particle, `own`, and of a neighbour, `other`; its position first."""
    reads: tuple[ti.Field, ...]
    """The fields of the row, one a column."""
    terms: Columns
    """What a neighbour adds to the sum, `total`."""
    apart: bool
    """Whether what images in the sides add is summed by itself, as `beyond`."""
    padded: bool
    """Whether candidates out of reach fill lists up to whole vectors: worth it where a pair takes long."""

    tension: int
    """The column of the row that is negative under tension, or NONE. Where it is so for no candidate of a cell, each is
    summed by `pressed`, which does the same as `pair` there with less to do."""

    def begin(self, group: Any) -> None:
        """Before the first particle of a group."""
        ...

    def image(self, other: Any, mirror: Any) -> Any:
        """The row of a neighbour as a side shows it."""
        ...

    def pair(self, own: Any, other: Any) -> Any:
        """What a neighbour adds to the sum of a particle."""
        ...

    def finish(self, i: Any, own: Any, total: Any, beyond: Any, group: Any) -> None:
        """What becomes of the sums of particle i."""
        ...


class SampledLaw(Protocol):
    """What is summed over the samples of solid bodies, too (`boundary.SampleSum`)."""

    terms: Columns

    def sample(self, own: Any, s: Any, d: Any, mirror: Any) -> Any:
        """The row of sample s, which a mirror shows at d [m] from a particle."""
        ...

    def pair(self, own: Any, other: Any) -> Any:
        """What a sample of share 1 adds to the sum of a particle."""
        ...


class PushingLaw(SampledLaw, Protocol):
    """What pushes solid bodies back (`boundary.Reaction`)."""

    told: tuple[ti.Field, ...]
    """What samples are told of a particle: the fields of its row, and what its law adds."""

    def acceleration(self, own: Any, total: Any) -> Any:
        """Of a particle [m/s2], by its sum."""
        ...

    def worked(self, own: Any, total: Any) -> Any:
        """The part of it whose work the law puts under walls, where accounts are kept."""
        ...


@in_kernels
class PositionLaw:
    """A law that reads nothing but positions, whatever it sums."""

    row, padded, tension = Columns(position=3), False, NONE

    @ti.func
    def image(self, other, mirror):
        """A neighbour as a side shows it."""
        return mirrored(mirror, other)

    @ti.func
    def sample(self, own, s, d, mirror):
        """A sample of a solid body."""
        return own + d
