"""Where the water ends: the height at which the smoothed share of water falls through one half."""

import numpy as np

from ocean_sim.basin import OPEN
from ocean_sim.fluid.neighbours.grid import Grid
from ocean_sim.fluid.neighbours.point_sum import Around
from ocean_sim.fluid.sph.particles import Particles
from ocean_sim.fluid.sph.smoothing import Smoothing
from ocean_sim.kernel_library import ti, tm
from ocean_sim.runtime import Array, Array2, in_kernels

PROBES = 4  # a support is searched in so many steps
HALVINGS = 4


@in_kernels
class Share:
    """Smoothed share of water, 0 to about 1."""

    sums = 1

    def __init__(self, smoothing: Smoothing, volume: float) -> None:
        """`volume` of a particle [m3]; in 2-D its area."""
        self.smoothing, self.constant = smoothing, volume * smoothing.poly6_constant

    @ti.func
    def term(self, own, j, d, mirror):
        return ti.Vector([self.constant * self.smoothing.shape_poly6(d.dot(d))])


@in_kernels
class FreeSurface:
    """Elevation of the particles' surface. A flat side is a mirror, so water does not seem to thin out next to it."""

    def __init__(self, particles: Particles, grid: Grid, smoothing: Smoothing) -> None:
        self.particles, self.grid, self.smoothing = particles, grid, smoothing
        self.around = Around(particles.position, grid)
        self.share = Share(smoothing, particles.mass / particles.rest_density)
        basin = grid.basin
        self.bed = basin.lower[1]
        self.top = basin.upper[1] if basin.closed else OPEN

    @ti.func
    def ceiling(self, x, z):
        """A height above which no particle reaches the vertical through x, z, or that of the lid."""
        p, grid = self.particles.position, self.grid
        h = self.smoothing.support
        home = grid.indices_at(grid.wrapped(tm.vec3(x, self.bed, z)))
        top = self.bed
        for dz in range(-1, 2):
            for dx in range(-1, 2):
                found = 0
                for down in range(grid.cells[1] - 2):
                    there = tm.ivec3(home.x + dx, grid.cells[1] - 2 - down, home.z + dz)
                    c = grid.cell_at(self.around.home(there)[0])
                    if (found == 0 or down < grid.sky) and grid.start[c + 1] > grid.start[c]:
                        found = 1
                        for j in range(grid.start[c], grid.start[c + 1]):
                            top = ti.max(top, p.y[j])
        return tm.min(top + h, self.top)

    @ti.func
    def elevation(self, x, z):
        """Search down from above in steps, then halve the step that holds the surface, then interpolate in it [m]."""
        high = self.ceiling(x, z)
        low, share_low, share_high, halvings = high, 0.0, 0.0, 0
        while halvings <= HALVINGS and high > self.bed:
            y = ti.select(halvings > 0, 0.5 * (low + high), high - self.smoothing.support / PROBES)
            share = self.around.total(tm.vec3(x, y, z), self.share, 0.0)[0]
            if share >= 0.5:
                low, share_low = y, share
            else:
                high, share_high = y, share
            if share >= 0.5 or halvings > 0:
                halvings += 1
        between = low + (high - low) * (share_low - 0.5) / tm.max(share_low - share_high, 1e-6)
        return tm.max(ti.select(halvings > 0, between, self.bed), self.bed)

    @ti.kernel
    def fill(self, points: Array2, heights: Array):
        for k in range(points.shape[0]):
            heights[k] = self.elevation(points[k, 0], points[k, 1])

    def elevations(self, points: np.ndarray) -> np.ndarray:
        """(m, 2) points x, z [m] -> (m,) heights [m]."""
        precision = self.particles.position.precision
        heights: np.ndarray = np.empty(len(points), dtype=precision)
        self.fill(np.ascontiguousarray(points, dtype=precision), heights)
        return heights.astype(float)
