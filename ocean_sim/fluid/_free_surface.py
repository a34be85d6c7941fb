"""Where the water ends: the height at which the smoothed share of water falls through one half."""

import numpy as np
import taichi as ti
import taichi.math as tm

from ocean_sim.fluid._grid import Grid
from ocean_sim.fluid._particles import Particles
from ocean_sim.fluid._smoothing import Smoothing

PROBES = 4  # a support is searched in so many steps
HALVINGS = 4


@ti.data_oriented
class FreeSurface:
    """Elevation of the particles' surface. A flat wall is a mirror, so water does not seem to thin out beside it."""

    def __init__(self, particles: Particles, grid: Grid, smoothing: Smoothing) -> None:
        self.particles, self.grid, self.smoothing = particles, grid, smoothing
        self.volume = particles.mass / particles.rest_density
        basin = grid.basin
        self.bed = basin.lower[1]
        self.low, self.up = basin.stops()

    @ti.func
    def share_seen(self, x):
        """Smoothed share of water around x, walls apart."""
        p, grid = self.particles.position, self.grid
        place = grid.place(x)
        total = 0.0
        for dz in range(-1, 2):
            for dy in range(-1, 2):
                row = grid.cell_at(place + tm.ivec3(0, dy, dz))
                for j in range(grid.start[row - 1], grid.start[row + 2]):
                    x_j = tm.vec3(p.x[j], p.y[j], p.z[j])
                    total += self.smoothing.shape_poly6((x - x_j).dot(x - x_j))
        return self.volume * self.smoothing.poly6_constant * total

    @ti.func
    def share(self, x):
        """Smoothed share of water around x, 0 to about 1; images of x stand for those of the water in the walls."""
        mirror = tm.vec3(self.mirrored(x.x, 0), x.y, self.mirrored(x.z, 2))
        near = ti.abs(mirror - x) < 2.0 * self.smoothing.support
        total = 0.0
        for image in range(4):
            in_x, in_z = image % 2, image // 2
            if (in_x == 0 or near.x) and (in_z == 0 or near.z):
                total += self.share_seen(tm.vec3(tm.mix(x.x, mirror.x, in_x), x.y, tm.mix(x.z, mirror.z, in_z)))
        return total

    @ti.func
    def mirrored(self, a, k: ti.template()):
        """Coordinate a in the nearer wall of axis k."""
        return 2.0 * ti.select(a - self.low[k] < self.up[k] - a, self.low[k], self.up[k]) - a

    @ti.func
    def ceiling(self, x, z):
        """A height above which no particle reaches the vertical through x, z."""
        p, grid = self.particles.position, self.grid
        h = self.smoothing.support
        place = grid.place(tm.vec3(x, self.bed, z))
        top = self.bed
        for dz in range(-1, 2):
            for dx in range(-1, 2):
                found = 0
                for down in range(grid.cells[1] - 2):
                    c = grid.cell_at(tm.ivec3(place.x + dx, grid.cells[1] - 2 - down, place.z + dz))
                    if found == 0 and grid.start[c + 1] > grid.start[c]:
                        found = 1
                        for j in range(grid.start[c], grid.start[c + 1]):
                            top = ti.max(top, p.y[j])
        return top + h

    @ti.func
    def elevation(self, x, z):
        """Search down from above in steps, then halve the step that holds the surface, then interpolate in it [m]."""
        high = self.ceiling(x, z)
        low, share_low, share_high, halvings = high, 0.0, 0.0, 0
        while halvings <= HALVINGS and high > self.bed:
            y = ti.select(halvings > 0, 0.5 * (low + high), high - self.smoothing.support / PROBES)
            share = self.share(tm.vec3(x, y, z))
            if share >= 0.5:
                low, share_low = y, share
            else:
                high, share_high = y, share
            if share >= 0.5 or halvings > 0:
                halvings += 1
        between = low + (high - low) * (share_low - 0.5) / tm.max(share_low - share_high, 1e-6)
        return tm.max(ti.select(halvings > 0, between, self.bed), self.bed)

    @ti.kernel
    def fill(self, points: ti.types.ndarray(ndim=2), heights: ti.types.ndarray(ndim=1)):
        for k in range(points.shape[0]):
            heights[k] = self.elevation(points[k, 0], points[k, 1])

    def elevations(self, points: np.ndarray) -> np.ndarray:
        """(m, 2) points x, z [m] -> (m,) heights [m]."""
        precision = self.particles.position.precision
        heights = np.empty(len(points), dtype=precision)
        self.fill(np.ascontiguousarray(points, dtype=precision), heights)
        return heights.astype(float)
