"""Where the field is known from which cubes are cut: nodes of a regular grid that fills a box."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

MOST_NODES = 2**26  # the vertices between them are numbered in 28 bits


@dataclass(frozen=True)
class Nodes:
    """Cells of equal size fill a box; a node lies in the middle of each, and one more row of nodes beyond every side.

    So a side of the box lies half-way between two rows, and a surface that closes there lies on it.
    """

    lower: tuple[float, float, float]  # [m]
    upper: tuple[float, float, float]  # [m]
    cell: float  # [m] at most

    @cached_property
    def inner(self) -> tuple[int, int, int]:
        """Nodes within the box on each axis."""
        extents = np.subtract(self.upper, self.lower)
        return tuple(max(1, int(np.ceil(extent / self.cell - 1.0e-6))) for extent in extents)  # type: ignore[return-value]

    @cached_property
    def shape(self) -> tuple[int, int, int]:
        """Nodes on each axis, those beyond the sides counted."""
        nx, ny, nz = self.inner
        return nx + 2, ny + 2, nz + 2

    @property
    def count(self) -> int:
        nx, ny, nz = self.shape
        return nx * ny * nz

    @cached_property
    def width(self) -> tuple[float, float, float]:
        """Distance between nodes on each axis [m]."""
        return tuple(np.subtract(self.upper, self.lower) / self.inner)

    def axis(self, k: int) -> np.ndarray:
        """Positions of all nodes along an axis [m]."""
        return self.lower[k] + (np.arange(self.shape[k]) - 0.5) * self.width[k]

    def positions(self) -> np.ndarray:
        """(nz, ny, nx, 3) [m]: as the field is stored, x running fastest."""
        z, y, x = np.meshgrid(self.axis(2), self.axis(1), self.axis(0), indexing="ij")
        return np.stack([x, y, z], axis=-1)
