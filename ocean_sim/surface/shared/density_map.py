"""The smoothed share of water around a point, gathered from particles (thesis 5.2.1, Algorithm 3).

1 in the water and 0 in the air, poly6 in shape (2.13). Flat walls and the bed are mirrors and periodic sides repeat the
water, so it does not seem to thin out next to them: the point is mirrored or shifted, not the water.
"""

from math import pi
from typing import TYPE_CHECKING

import numpy as np

from ocean_sim.basin import OPEN, Basin
from ocean_sim.kernel_library import ti, tm, to_numpy_type
from ocean_sim.runtime import Template, in_kernels
from ocean_sim.surface.shared.nodes import Nodes

if TYPE_CHECKING:
    from ocean_sim.fluid import Particles

TASK_ITERATIONS = 512  # Taichi never cuts a parallel loop finer than this: a task every TASK_ITERATIONS iterations
ROW_GROUPS = 32  # of rows of nodes, each a task of its own; set here, never by the number of threads
RUN_NODES = 4  # nodes along x that are gathered for at once
AXIS_IMAGES = 5  # of a point on each axis: itself, in either side or a period on, and in both sides or two periods on


def flat_share(radius: float, spacing: float) -> float:
    """Mean share in the plane half a spacing above the top layer of a cubic lattice: where flat water ends.

    Averaged over the plane each layer at distance u radius counts 315/256 (1 - u^2)^4, the integral of poly6 over it.
    """
    u = (np.arange(int(radius / spacing) + 1) + 0.5) * spacing / radius
    return float(315.0 / 256.0 * spacing / radius * (np.maximum(1.0 - u * u, 0.0) ** 4).sum())


def point_images(basin: Basin, nodes: Nodes) -> np.ndarray:
    """(3, AXIS_IMAGES, 2) sign and offset [m] of every image of a point on each axis; OPEN where there is none."""
    still = {(side.axis, side.upper) for side in basin.sides if side.piston is None}
    found = np.full((3, AXIS_IMAGES, 2), (1.0, OPEN))
    found[:, 0, 1] = 0.0
    for k, (low, up, period) in enumerate(zip(nodes.lower, nodes.upper, basin.periods)):
        if period > 0.0:
            found[k, 1:, 1] = [period, -period, 2.0 * period, -2.0 * period]
        else:
            for n, (position, upper) in enumerate(((low, False), (up, True))):
                if (k, upper) in still:
                    found[k, 1 + n] = -1.0, 2.0 * position
            if {(k, False), (k, True)} <= still:
                found[k, 3:, 1] = 2.0 * (up - low), 2.0 * (low - up)
    return found


@in_kernels
class DensityMap:
    """The particles in a box, sorted into bins at least a radius wide, and sums over them."""

    def __init__(self, particles: "Particles", basin: Basin, nodes: Nodes, radius: float) -> None:
        """`radius` [m] of the sphere in which a particle counts."""
        self.particles, self.nodes, self.radius = particles, nodes, radius
        self.n, self.squared = particles.n, radius * radius
        self.constant = particles.mass / particles.rest_density * 315.0 / (64.0 * pi * radius**9)
        self.bins = self.bins_of(nodes, radius)
        self.lower, self.upper, self.width = tm.vec3(nodes.lower), tm.vec3(nodes.upper), tm.vec3(nodes.width)
        self.per_bin = tm.vec3(np.divide(self.bins, np.subtract(nodes.upper, nodes.lower)).tolist())
        self.x, self.y, self.z = (ti.field(float, shape=self.n) for _ in range(3))
        self.bin = ti.field(int, shape=self.n)
        bins = self.bins[0] * self.bins[1] * self.bins[2]
        self.start, self.next = ti.field(int, shape=bins + 1), ti.field(int, shape=bins + 1)  # the last is outside
        self.image = ti.field(float, shape=(3, AXIS_IMAGES, 2))
        self.image.from_numpy(point_images(basin, nodes).astype(to_numpy_type(self.image.dtype)))

    @staticmethod
    def bins_of(nodes: Nodes, radius: float) -> tuple[int, int, int]:
        """Bins on each axis."""
        nx, ny, nz = (max(1, int((up - low) / radius + 1.0e-9)) for low, up in zip(nodes.lower, nodes.upper))
        return nx, ny, nz

    @classmethod
    def bytes(cls, n: int, nodes: Nodes, radius: float, word: int) -> int:
        """Of the fields for n particles, where `word` is the size of a `float` [bytes]."""
        return (3 * word + 4) * n + 8 * (int(np.prod(cls.bins_of(nodes, radius))) + 1) + word * 6 * AXIS_IMAGES

    @ti.func
    def bin_of(self, x):
        """The bin of a point on each axis; a point beyond the box belongs to the bin at its side."""
        return ti.cast(tm.clamp((x - self.lower) * self.per_bin, 0.0, tm.vec3(self.bins) - 0.5), int)

    @ti.func
    def bin_at(self, i, j, k):
        return (k * self.bins[1] + j) * self.bins[0] + i

    @ti.kernel
    def sort_particles(self) -> int:
        """Stable counting sort of the particles in the box by bin; returns how many are outside."""
        p, bins = self.particles.position, ti.static(self.bins[0] * self.bins[1] * self.bins[2])
        outside = 0
        ti.loop_config(serialize=True)
        for _ in range(1):
            for c in range(bins + 1):
                self.next[c] = 0
            for i in range(self.particles.count.there()):
                x = tm.vec3(p.x[i], p.y[i], p.z[i])
                cell = self.bin_of(x)
                inside = (x >= self.lower).all() and (x <= self.upper).all()
                c = ti.select(inside, tm.clamp(self.bin_at(cell.x, cell.y, cell.z), 0, bins), bins)
                self.bin[i] = c
                self.next[c] = self.next[c] + 1
            total = 0
            for c in range(bins + 1):
                self.start[c] = total
                total += self.next[c]
                self.next[c] = self.start[c]
            outside = total - self.start[bins]
            for i in range(self.particles.count.there()):
                to = self.next[self.bin[i]]
                self.next[self.bin[i]] = to + 1
                self.x[to], self.y[to], self.z[to] = p.x[i], p.y[i], p.z[i]
        return outside

    @ti.func
    def shares_along(self, x, step, run: Template):
        """Around so many points that follow each other along x, `step` [m] apart; they may be anywhere."""
        total = ti.Vector.zero(float, run)
        for c in range(AXIS_IMAGES):
            z = self.image[2, c, 0] * x.z + self.image[2, c, 1]
            if self.in_reach(z, z, 2):
                for b in range(AXIS_IMAGES):
                    y = self.image[1, b, 0] * x.y + self.image[1, b, 1]
                    if self.in_reach(y, y, 1):
                        for a in range(AXIS_IMAGES):
                            sign = self.image[0, a, 0]
                            first = sign * x.x + self.image[0, a, 1]
                            last = first + sign * (run - 1) * step
                            if self.in_reach(first, last, 0):
                                total += self.gather_bins(tm.vec3(first, y, z), tm.vec3(last, y, z), sign * step, run)
        return self.constant * total

    @ti.func
    def in_reach(self, first, last, axis: Template):
        """Whether particles may be within a radius of what lies between two positions on an axis."""
        low, high = self.lower[axis] - self.radius, self.upper[axis] + self.radius
        return tm.max(first, last) > low and tm.min(first, last) < high

    @ti.func
    def gather_bins(self, x, last, step, run: Template):
        """Sums of (radius^2 - r^2)^3 over the particles of the bins around the points from x to `last`; the inner loop
        does not branch."""
        total, here, there = ti.Vector.zero(float, run), self.bin_of(x), self.bin_of(last)
        low = tm.max(tm.min(here, there) - 1, 0)
        high = tm.min(tm.max(here, there) + 1, tm.ivec3(self.bins) - 1)
        for k in range(low.z, high.z + 1):
            for j in range(low.y, high.y + 1):
                for n in range(self.start[self.bin_at(low.x, j, k)], self.start[self.bin_at(high.x, j, k) + 1]):
                    dx, dy, dz = self.x[n] - x.x, self.y[n] - x.y, self.z[n] - x.z
                    left = self.squared - (dy * dy + dz * dz)
                    for m in ti.static(range(run)):
                        along = dx - m * step
                        w = left - along * along
                        w = ti.select(w > 0.0, w, 0.0)
                        total[m] += w * w * w
        return total

    @ti.kernel
    def mark_rows(self, rows: Template):
        """The rows of nodes within a radius and a node of any particle that counts there, so that the next nodes around
        every wet one are marked, too; a row beyond a side is as near as the row next to it."""
        for row in rows.near:
            inner = tm.clamp(tm.ivec2(row % rows.across, row // rows.across) - 1, 0, tm.ivec2(self.nodes.inner[1:]) - 1)
            y = self.lower.y + self.width.y * (inner.x + 0.5)
            z = self.lower.z + self.width.z * (inner.y + 0.5)
            rows.near[row] = int(self.particles_near(y, z))

    @ti.func
    def particles_near(self, y, z):
        """Whether there are particles in the bins around a row of nodes and the rows next to it, or their images."""
        found = 0
        for c in range(AXIS_IMAGES):
            along = self.image[2, c, 0] * z + self.image[2, c, 1]
            if self.in_reach(along - self.width.z, along + self.width.z, 2):
                for b in range(AXIS_IMAGES):
                    up = self.image[1, b, 0] * y + self.image[1, b, 1]
                    if self.in_reach(up - self.width.y, up + self.width.y, 1):
                        margin = tm.vec3(0.0, self.width.y, self.width.z)
                        low = tm.max(self.bin_of(tm.vec3(self.lower.x, up, along) - margin) - 1, 0)
                        high = self.bin_of(tm.vec3(self.lower.x, up, along) + margin) + 1
                        high = tm.min(high, tm.ivec3(self.bins) - 1)
                        for k in range(low.z, high.z + 1):
                            for j in range(low.y, high.y + 1):
                                found |= int(
                                    self.start[self.bin_at(0, j, k)] < self.start[self.bin_at(self.bins[0], j, k)]
                                )
        return found == 1

    @ti.kernel
    def fill_rows(self, rows: Template, value: Template, level: float):
        """Share less `level` at all nodes of the rows kept that lie within the box."""
        for g in range(ROW_GROUPS * TASK_ITERATIONS):
            if g % TASK_ITERATIONS == 0:
                self.fill_group(g // TASK_ITERATIONS, rows, value, level)

    @ti.func
    def fill_group(self, group, rows: Template, value: Template, level):
        """Every GROUPS-th row of nodes."""
        nx, ny, nz = ti.static(self.nodes.inner)
        for turn in range((rows.count[None] - group + ROW_GROUPS - 1) // ROW_GROUPS):
            n = group + turn * ROW_GROUPS
            j, k = rows.row_indices(n)
            if 0 < j <= ny and 0 < k <= nz:
                first = n * rows.length + 1
                for part in range((nx + RUN_NODES - 1) // RUN_NODES):
                    i = part * RUN_NODES
                    x = self.lower + self.width * (tm.vec3(i, j - 1, k - 1) + 0.5)
                    shares = self.shares_along(x, self.width.x, RUN_NODES)
                    for m in ti.static(range(RUN_NODES)):
                        if i + m < nx:
                            value[first + i + m] = shares[m] - level
