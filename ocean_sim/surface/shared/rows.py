"""The band of a grid that is kept: its rows of nodes along x that lie near water."""

import numpy as np

from ocean_sim.conventions import Diverged
from ocean_sim.kernel_library import ti
from ocean_sim.runtime import in_kernels
from ocean_sim.surface.shared.nodes import Nodes


@in_kernels
class Rows:
    """Which rows of nodes are kept, and where. All others are one dry row, which is read and never written."""

    def __init__(self, nodes: Nodes, most_nodes: int) -> None:
        """All rows, or at first none where that would be more than `most_nodes`."""
        self.length, self.across, along = nodes.shape
        self.all, self.most_nodes = self.across * along, most_nodes
        self.most = self.fitting(nodes, most_nodes)
        self.first = ti.field(int, shape=self.all)  # node of each row of the grid
        self.row = ti.field(int, shape=self.most)  # of the grid, of each row kept, in the order of the grid
        self.count = ti.field(int, shape=())
        self.near = ti.field(int, shape=self.all)
        self.near.fill(int(self.most == self.all))
        self.keep()

    @staticmethod
    def fitting(nodes: Nodes, most_nodes: int) -> int:
        """Rows that can be kept."""
        nx, ny, nz = nodes.shape
        return min(ny * nz, max(1, most_nodes // nx))

    @classmethod
    def bytes(cls, nodes: Nodes, most_nodes: int) -> int:
        """Of the fields."""
        return 4 * (2 * nodes.shape[1] * nodes.shape[2] + cls.fitting(nodes, most_nodes) + 1)

    def keep(self) -> None:
        """The rows marked `near`, from now on; raises Diverged where they are too many."""
        if (wanted := self.renew()) > self.most:
            raise Diverged(
                f"{wanted * self.length} nodes of the surface lie near water, more than surface.most_nodes "
                f"{self.most_nodes}; try a larger surface.spacing, or see whether the water has come apart"
            )

    @ti.kernel
    def renew(self) -> int:
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
    def indices(self, n):
        """j and k of the n-th row kept."""
        return self.row[n] % self.across, self.row[n] // self.across

    def spread(self, values: np.ndarray) -> np.ndarray:
        """(nz, ny, nx) values at all nodes of the grid, of those at the nodes kept."""
        found = values.reshape(-1, self.length)[self.first.to_numpy() // self.length]
        return found.reshape(-1, self.across, self.length)
