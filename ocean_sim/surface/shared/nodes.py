"""Nodes of a regular grid that fills a box, and the rows of them along x near water, where a field is kept."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ocean_sim.conventions import Diverged
from ocean_sim.kernel_library import ti
from ocean_sim.runtime import in_kernels

MAX_NODES = 2**26  # the vertices between them are numbered in 28 bits


@dataclass(frozen=True)
class Nodes:
    """Regular grid of nodes, one in the middle of each of the equal cells of a box, and one row beyond each side.

    So a side of the box lies half-way between two rows, and a surface that closes there lies on it.
    """

    lower: tuple[float, float, float]  # [m]
    upper: tuple[float, float, float]  # [m]
    cell: float  # [m] at most

    @cached_property
    def inner(self) -> tuple[int, int, int]:
        """Numbers of cells of the box, each with one node, along x, y and z: as few as `cell` allows, at least 1."""
        extents = np.subtract(self.upper, self.lower)
        return tuple(max(1, int(np.ceil(extent / self.cell - 1.0e-6))) for extent in extents)  # type: ignore[return-value]

    @cached_property
    def shape(self) -> tuple[int, int, int]:
        """Numbers of nodes along x, y and z, with the row beyond each side."""
        nx, ny, nz = self.inner
        return nx + 2, ny + 2, nz + 2

    @property
    def count(self) -> int:
        nx, ny, nz = self.shape
        return nx * ny * nz

    @cached_property
    def width(self) -> tuple[float, float, float]:
        """Distance between nodes along x, y and z [m]."""
        return tuple(np.subtract(self.upper, self.lower) / self.inner)

    def axis(self, k: int) -> np.ndarray:
        """Positions of all nodes along axis k [m]."""
        return self.lower[k] + (np.arange(self.shape[k]) - 0.5) * self.width[k]

    def positions(self) -> np.ndarray:
        """Positions (nz, ny, nx, 3) of all nodes [m], in the order in which the field is stored: x runs fastest."""
        z, y, x = np.meshgrid(self.axis(2), self.axis(1), self.axis(0), indexing="ij")
        return np.stack([x, y, z], axis=-1)


@in_kernels
class Rows:
    """Rows of nodes along x whose field is stored. All others share one dry row, which is read and never written."""

    def __init__(self, nodes: Nodes, most_nodes: int) -> None:
        """Store all rows, or none at first if that would be more than `most_nodes` nodes."""
        self.length, self.across, along = nodes.shape
        self.all, self.most_nodes = self.across * along, most_nodes
        self.most = self.fitting_rows(nodes, most_nodes)
        self.first = ti.field(int, shape=self.all)  # node of each row of the grid
        self.row = ti.field(int, shape=self.most)  # of the grid, of each row kept, in the order of the grid
        self.count = ti.field(int, shape=())
        self.near = ti.field(int, shape=self.all)
        self.near.fill(int(self.most == self.all))
        self.keep_rows()

    @staticmethod
    def fitting_rows(nodes: Nodes, most_nodes: int) -> int:
        """Number of rows that can be stored within `most_nodes` nodes."""
        nx, ny, nz = nodes.shape
        return min(ny * nz, max(1, most_nodes // nx))

    @classmethod
    def bytes(cls, nodes: Nodes, most_nodes: int) -> int:
        """Memory [bytes] of the fields of `Rows`."""
        return 4 * (2 * nodes.shape[1] * nodes.shape[2] + cls.fitting_rows(nodes, most_nodes) + 1)

    def keep_rows(self) -> None:
        """Store only the rows marked `near` from now on; raises Diverged if their nodes exceed `most_nodes`."""
        if (wanted := self.renew_rows()) > self.most:
            raise Diverged(
                f"{wanted * self.length} nodes of the surface lie near water, more than surface.most_nodes "
                f"{self.most_nodes}; try a larger surface.spacing, or see whether the water has come apart"
            )

    @ti.kernel
    def renew_rows(self) -> int:
        """Number the rows marked `near` in the order of the grid; returns how many there are."""
        wanted = 0
        ti.loop_config(serialize=True)
        for row in range(self.all):
            self.first[row] = self.most * self.length
            if self.near[row]:
                if wanted < self.most:
                    self.first[row] = wanted * self.length
                    self.row[wanted] = row
                wanted += 1
        self.count[None] = ti.min(wanted, self.most)
        return wanted

    @ti.func
    def row_indices(self, n):
        """Indices j and k in the grid of the n-th stored row."""
        return self.row[n] % self.across, self.row[n] // self.across

    def spread_values(self, values: np.ndarray) -> np.ndarray:
        """Values (nz, ny, nx) at all nodes of the grid, from those at the stored nodes."""
        found = values.reshape(-1, self.length)[self.first.to_numpy() // self.length]
        return found.reshape(-1, self.across, self.length)
