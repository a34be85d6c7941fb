"""Triangles around the nodes where a field is positive: marching cubes (thesis 3.1, Algorithm 4; Lorensen & Cline
1987, SIGGRAPH '87).

The nodes of a regular grid fill a box; a field is kept on the rows of them along x near water.

Vertices are shared: each lies on an edge between two nodes and belongs to the lower of them. Slabs of rows of nodes are
counted apart and their vertices and triangles numbered in the order of slabs, so the mesh does not depend on threads.

A case has a bit for each corner of a cube, set if it is in the water; corner c lies at (c & 1, c >> 1 & 1, c >> 2 & 1),
edge e runs along axis e // 4. A row of cube_cases.csv is a case: 1 if it is ambiguous, and the edges on which the
corners a, b, c of its triangles lie. On every face each run of wet corners is cut off by a line of its own, so two wet
corners across a diagonal stay apart (the ambiguous face). The line depends on the four corners of that face alone, so
both cubes that share it draw the same one. The lines of the six faces join to loops, seen from outside the cube with
the water on one side. Every loop is cut into triangles by the shortest diagonals of which none lies on a face, where
the neighbour might draw one as well. So any field that is dry all round gives a closed surface, two triangles an edge.
"""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ocean_sim.conventions import Diverged
from ocean_sim.kernel_library import ti, tm, to_numpy_type
from ocean_sim.runtime import Array, Array2, Template, in_kernels
from ocean_sim.surface import Mesh

MAX_NODES = 2**26  # the vertices between them are numbered in 28 bits
CORNERS = np.array([(c & 1, c >> 1 & 1, c >> 2 & 1) for c in range(8)])
EDGES = tuple((c, c | 1 << axis) for axis in range(3) for c in range(8) if not c >> axis & 1)
EDGE_MIDDLES = np.array([CORNERS[list(edge)].mean(axis=0) for edge in EDGES])
MAX_TRIANGLES = 5  # triangles of a case, at most
CASE_FILE = Path(__file__).with_name("cube_cases.csv")


@dataclass(frozen=True)
class Nodes:
    """Regular grid of nodes: one in the middle of each cell of a box, and one more layer beyond each side.

    So a side of the box lies half-way between two layers, and a surface that closes there lies on it."""

    lower: tuple[float, float, float]  # [m]
    upper: tuple[float, float, float]  # [m]
    cell: float  # [m] at most

    @cached_property
    def inner(self) -> tuple[int, int, int]:
        """Numbers of cells, each with a node, of the box along x, y, z: the fewest at most `cell` wide, at least 1."""
        extents = np.subtract(self.upper, self.lower)
        return tuple(max(1, int(np.ceil(extent / self.cell - 1.0e-6))) for extent in extents)  # type: ignore[return-value]

    @cached_property
    def shape(self) -> tuple[int, int, int]:
        """Numbers of nodes along x, y and z, including the layers beyond the sides."""
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


@in_kernels
class Rows:
    """Rows of nodes along x whose field values are stored. All other rows share one dry row, which is never written."""

    def __init__(self, nodes: Nodes, most_nodes: int) -> None:
        """Store all rows along x if they have at most `most_nodes` nodes; else those near water, by `keep_rows`."""
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
        """Number of rows of nodes along x, of all in the grid, that can be stored within `most_nodes` nodes."""
        nx, ny, nz = nodes.shape
        return min(ny * nz, max(1, most_nodes // nx))

    @classmethod
    def bytes(cls, nodes: Nodes, most_nodes: int) -> int:
        """Memory [bytes] of the fields of `Rows` that may store `most_nodes` nodes."""
        return 4 * (2 * nodes.shape[1] * nodes.shape[2] + cls.fitting_rows(nodes, most_nodes) + 1)

    def keep_rows(self) -> None:
        """Store from now on only rows of nodes along x that are marked in the field `near` as near water; raises
        Diverged if these have more than `most_nodes` nodes."""
        if (wanted := self.renew_rows()) > self.most:
            begin = f"{wanted * self.length} nodes of the surface lie near water,"
            opening = f"more than surface.most_nodes {self.most_nodes}; try a larger surface.spacing,"
            raise Diverged(f"{begin} {opening} or see whether the water has come apart")

    @ti.kernel
    def renew_rows(self) -> int:
        """Number the rows along x marked in `near`, as near water, in the grid's order; return how many there are."""
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
        """Indices j, k along y, z of the n-th stored row of nodes, a row along x."""
        return self.row[n] % self.across, self.row[n] // self.across

    def spread_values(self, values: np.ndarray) -> np.ndarray:
        """Values (nz, ny, nx) at all nodes, from `values` of stored ones; nodes of other rows get the dry value."""
        found = values.reshape(-1, self.length)[self.first.to_numpy() // self.length]
        return found.reshape(-1, self.across, self.length)


def case_table() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Tables of the 256 cases of marching cubes: number of triangles (256,), cube edges of their corners (256, 3 *
    MAX_TRIANGLES), -1 where there is none, and 1 for an ambiguous case (256,)."""
    table = np.loadtxt(CASE_FILE, np.int32, delimiter=",", skiprows=1)
    edges = np.ascontiguousarray(table[:, 1:])
    return np.count_nonzero(edges >= 0, axis=1).astype(np.int32) // 3, edges, table[:, 0].copy()


TASK_ITERATIONS = 512  # Taichi never cuts a parallel loop finer than this: a task every TASK_ITERATIONS iterations
ROW_SLABS = 32  # of rows of nodes, each a task of its own; set here, never by the number of threads
LEAST_DRY = 1.0e-6  # a dry value that is not zero
VERTICES, TRIANGLES, CUT, AMBIGUOUS = range(4)  # what is counted


class Counts(NamedTuple):
    """Numbers of vertices, triangles, and cut cubes of a surface."""

    vertices: int
    triangles: int
    cut: int  # cubes that the surface passes through
    ambiguous: int  # of them, cubes with a face whose wet corners lie across a diagonal

    @property
    def ambiguous_share(self) -> float:
        """Share of the cut cubes that are ambiguous."""
        return self.ambiguous / max(self.cut, 1)


@in_kernels
class Isosurface:
    """Field stored at nodes, positive in the water, and the surface where it is zero, by marching cubes."""

    def __init__(
        self,
        nodes: Nodes,
        periodic: tuple[bool, bool, bool] = (False, False, False),
        most_nodes: int = MAX_NODES,
        dry: float = -1.0,
    ) -> None:
        """`periodic`: axes on which the field repeats; `most_nodes`: most nodes stored; `dry`: field at all others."""
        self.nodes, self.shape, self.periodic, self.rows = nodes, nodes.shape, periodic, Rows(nodes, most_nodes)
        self.lower, self.upper, self.width = tm.vec3(nodes.lower), tm.vec3(nodes.upper), tm.vec3(nodes.width)
        kept = (self.rows.most + 1) * self.rows.length
        self.value = ti.field(float, shape=kept)  # positive in the water
        self.value.fill(dry)
        self.owned = ti.field(int, shape=kept)  # 8 * first vertex of a node + a bit for each of its edges cut
        self.counted = ti.field(int, shape=(ROW_SLABS, 4))
        self.triangles_of, self.ambiguous = ti.field(int, shape=256), ti.field(int, shape=256)
        self.edges_of = ti.field(int, shape=(256, 3 * MAX_TRIANGLES))
        for field, numbers in zip((self.triangles_of, self.edges_of, self.ambiguous), case_table()):
            field.from_numpy(numbers)
        self.precision = to_numpy_type(self.value.dtype)

    @staticmethod
    def bytes(nodes: Nodes, most_nodes: int, word: int) -> int:
        """Memory [bytes] of an Isosurface that stores at most `most_nodes` nodes; `word`: size of a `float` [bytes]."""
        kept = (Rows.fitting_rows(nodes, most_nodes) + 1) * nodes.shape[0]
        return (word + 4) * kept + Rows.bytes(nodes, most_nodes) + 4 * (4 * ROW_SLABS + 256 * (2 + 3 * MAX_TRIANGLES))

    @ti.kernel
    def pad_field(self, open_sides: int):
        """Set the field beyond the sides of the box. Through sides with a bit in `open_sides` (2 axis, + 1 if upper) it
        continues, level or periodic, and the surface stays open; elsewhere it is dry, and the surface closes."""
        for n in range(self.rows.count[None] * self.rows.length):
            node = self.node_indices(n)
            inner = tm.clamp(node, 1, tm.ivec3(self.shape) - 2)
            if (node != inner).any():
                closed, other = False, inner
                for axis in ti.static(range(3)):
                    if node[axis] != inner[axis]:
                        closed |= (open_sides >> (2 * axis + int(node[axis] > 0)) & 1) == 0
                        if ti.static(self.periodic[axis]):
                            other[axis] = self.shape[axis] - 1 - inner[axis]
                ahead = self.node_at(inner.x, inner.y, inner.z), self.node_at(other.x, inner.y, inner.z)
                behind = self.node_at(inner.x, inner.y, other.z), self.node_at(other.x, inner.y, other.z)
                before = self.value[ahead[0]] + self.value[ahead[1]]
                mean = 0.25 * (before + self.value[behind[0]] + self.value[behind[1]])
                self.value[n] = -tm.max(ti.abs(mean), LEAST_DRY) if closed else mean

    def count_surface(self) -> Counts:
        """Number all vertices and triangles of the present field, and return the counts."""
        totals = np.zeros(4, dtype=np.int32)
        self.number_slabs(totals)
        return Counts(*totals.tolist())

    def mesh(self, counts: Counts) -> Mesh:
        """Mesh of the surface that `count_surface` has just numbered, with these counts."""
        vertices, normals = (np.empty((counts.vertices, 3), dtype=self.precision) for _ in range(2))
        triangles = np.empty((counts.triangles, 3), dtype=np.int32)
        if counts.triangles:
            self.write_mesh(vertices, normals, triangles)
        return Mesh(vertices, triangles, normals)

    @ti.func
    def node_at(self, i, j, k):
        """Index of node (i, j, k) in the stored field; rows along x that are not stored share one row of dry values."""
        return i + self.rows.first[j + self.shape[1] * k]

    @ti.func
    def node_indices(self, n):
        """Indices i, j, k of stored node n: the inverse of `node_at`."""
        j, k = self.rows.row_indices(n // self.rows.length)
        return tm.ivec3(n % self.rows.length, j, k)

    @ti.func
    def edge_rows(self, j, k):
        """Indices of the first nodes of the four rows of nodes at the edges of a row of cubes: (j, k), (j + 1, k), (j,
        k + 1), (j + 1, k + 1), clamped to the grid."""
        up, on = tm.min(j + 1, self.shape[1] - 1), tm.min(k + 1, self.shape[2] - 1)
        return tm.ivec4(self.node_at(0, j, k), self.node_at(0, up, k), self.node_at(0, j, on), self.node_at(0, up, on))

    @ti.func
    def wet_corners(self, rows, i):
        """Bits 0, 2, 4, 6 of a marching-cubes case, set where node i of row (j, k), (j + 1, k), (j, k + 1), (j + 1, k +
        1) along x is in the water (node i + 1 gives bits 1, 3, 5, 7); `rows`: first nodes of these rows."""
        wet = 0
        for corner in ti.static(range(4)):
            wet |= int(self.value[rows[corner] + i] >= 0.0) << 2 * corner
        return wet

    @ti.func
    def first_row(self, slab):
        """Index of the first stored row of a slab, which is a group of successive rows that one thread handles."""
        return slab * self.rows.count[None] // ROW_SLABS

    @ti.kernel
    def number_slabs(self, totals: Array):
        """Count vertices, triangles, cut and ambiguous cubes of each slab (group of rows); store for each the sum over
        those before it, and write the totals to `totals` (4,)."""
        for s in range(ROW_SLABS * TASK_ITERATIONS):
            if s % TASK_ITERATIONS == 0:
                self.count_slab(s // TASK_ITERATIONS)
        ti.loop_config(serialize=True)
        for what in range(4):
            total = 0
            for slab in range(ROW_SLABS):
                here = self.counted[slab, what]
                self.counted[slab, what] = total
                total += here
            totals[what] = total

    @ti.func
    def count_slab(self, slab):
        """Count vertices, triangles, cut and ambiguous cubes of one `slab` (group of rows); number its vertices."""
        nx, ny, nz = ti.static(self.shape)
        vertices, triangles, cut, ambiguous = 0, 0, 0, 0
        for n in range(self.first_row(slab), self.first_row(slab + 1)):
            j, k = self.rows.row_indices(n)
            rows = self.edge_rows(j, k)
            front = self.wet_corners(rows, 0)
            for i in range(nx):
                back = self.wet_corners(rows, tm.min(i + 1, nx - 1))
                case = front | back << 1
                front = back
                mask = (case ^ case >> 1) & 1 | ((case ^ case >> 2) & 1) << 1 | ((case ^ case >> 4) & 1) << 2
                self.owned[rows[0] + i] = vertices << 3 | mask
                vertices += (mask & 1) + (mask >> 1 & 1) + (mask >> 2)
                if i < nx - 1 and j < ny - 1 and k < nz - 1 and case > 0 and case < 255:
                    triangles += self.triangles_of[case]
                    cut += 1
                    ambiguous += self.ambiguous[case]
        for what, n in ti.static(enumerate((vertices, triangles, cut, ambiguous))):
            self.counted[slab, what] = n

    @ti.kernel
    def write_mesh(self, vertices: Array2, normals: Array2, triangles: Array2):
        """Write vertices (n, 3) [m], unit normals (n, 3) and triangles (m, 3), numbered before by `number_slabs`."""
        for s in range(ROW_SLABS * TASK_ITERATIONS):
            if s % TASK_ITERATIONS == 0:
                slab = s // TASK_ITERATIONS
                length = ti.static(self.rows.length)
                for n in range(length * self.first_row(slab), length * self.first_row(slab + 1)):
                    self.owned[n] = self.owned[n] + (self.counted[slab, VERTICES] << 3)
                    if self.owned[n] & 7:
                        self.write_vertices(n, vertices, normals)
        for s in range(ROW_SLABS * TASK_ITERATIONS):
            if s % TASK_ITERATIONS == 0:
                self.write_triangles(s // TASK_ITERATIONS, triangles)

    @ti.func
    def write_vertices(self, n, vertices: Template, normals: Template):
        """Write vertices and unit normals on the edges of node n; a vertex lies where the linear field is 0."""
        node = self.node_indices(n)
        vertex, mask = self.owned[n] >> 3, self.owned[n] & 7
        own, slope = self.value[n], self.gradient(node)
        for axis in ti.static(range(3)):
            if mask >> axis & 1:
                step = tm.ivec3([int(axis == k) for k in range(3)])
                there = self.value[self.node_at(node.x + step.x, node.y + step.y, node.z + step.z)]
                along = own / (own - there)
                x = self.lower + self.width * (ti.cast(node, float) - 0.5 + along * ti.cast(step, float))
                x = tm.clamp(x, self.lower, self.upper)
                normal = -tm.mix(slope, self.gradient(node + step), along)
                if node[axis] == 0 or node[axis] == self.shape[axis] - 2:  # it closes here, on a side of the box
                    normal = ti.cast(step, float) * ti.select(node[axis] == 0, -1.0, 1.0)
                normal /= tm.max(normal.norm(), 1.0e-30)
                for k in ti.static(range(3)):
                    vertices[vertex, k], normals[vertex, k] = x[k], normal[k]
                vertex += 1

    @ti.func
    def gradient(self, node):
        """Gradient of the field at a node, one-sided at the rim; thesis (3.2) to (3.4), which lack the factor 1/2."""
        gradient = tm.vec3(0.0)
        for axis in ti.static(range(3)):
            step = tm.ivec3([int(axis == k) for k in range(3)])
            up = tm.min(node + step, tm.ivec3(self.shape) - 1)
            down = tm.max(node - step, 0)
            rise = self.value[self.node_at(up.x, up.y, up.z)] - self.value[self.node_at(down.x, down.y, down.z)]
            gradient[axis] = rise / (self.width[axis] * (up[axis] - down[axis]))
        return gradient

    @ti.func
    def write_triangles(self, slab, triangles: Template):
        """Write the vertex numbers of all triangles of one slab of rows to `triangles`."""
        nx, ny, nz = ti.static(self.shape)
        written = self.counted[slab, TRIANGLES]
        for n in range(self.first_row(slab), self.first_row(slab + 1)):
            j, k = self.rows.row_indices(n)
            if j < ny - 1 and k < nz - 1:
                rows = self.edge_rows(j, k)
                front = self.wet_corners(rows, 0)
                for i in range(nx - 1):
                    back = self.wet_corners(rows, i + 1)
                    case = front | back << 1
                    front = back
                    for corner in range(3 * self.triangles_of[case]):
                        edge = self.edges_of[case, corner]
                        triangles[written + corner // 3, corner % 3] = self.vertex_on_edge(i, j, k, edge)
                    written += self.triangles_of[case]

    @ti.func
    def vertex_on_edge(self, i, j, k, edge):
        """Number of the vertex on an edge of cube (i, j, k): `edge` = 4 axis + e starts at the e-th corner whose bit of
        that axis is 0. The node at that corner owns the edge, and numbers its edges in the order of the axes."""
        axis, e = edge // 4, edge % 4
        corner = (e >> axis) << (axis + 1) | e & ((1 << axis) - 1)
        owned = self.owned[self.node_at(i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2))]
        before = owned & ((1 << axis) - 1)
        return (owned >> 3) + (before & 1) + (before >> 1)
