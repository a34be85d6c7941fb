"""Pressure and velocity of the water at any point, smoothed from the particles around it.

A normalised sum over neighbours (Shepard 1968), corrected so that it is exact for fields linear in position (moving
least squares; Liu & Liu 2006, Appl. Numer. Math. 56). Pressures are summed without the weight of still water,
p - rho0 g . x, so a pressure of rho0 g . x is exact at every point, also at walls. Walls are mirrors, for velocities
free slip or no slip. Where the smoothed share of water is below one half, which is how the free surface is found, it is
dry: pressure and velocity are 0 there.
"""

from typing import TYPE_CHECKING

import numpy as np

from ocean_sim.basin import OPEN
from ocean_sim.columns import Columns, vec3
from ocean_sim.fluid.neighbours.grid import Grid
from ocean_sim.fluid.neighbours.images import hydrostatic_offset, mirror_midpoint, mirror_velocity
from ocean_sim.fluid.neighbours.point_sum import PointSum
from ocean_sim.fluid.sph.body_force import Pull
from ocean_sim.fluid.sph.particles import Particles
from ocean_sim.fluid.sph.smoothing import Smoothing
from ocean_sim.kernel_library import ti, tm
from ocean_sim.runtime import Array, Array2, in_kernels, values_at

if TYPE_CHECKING:  # it is imported only where there are bodies
    from ocean_sim.fluid.bodies.boundary import Boundary

MOMENT_COLUMNS = Columns(share=1, first=3, xx=1, yy=1, zz=1, xy=1, yz=1, zx=1)
FACTOR_COLUMNS = Columns(constant=1, slope=3)
WET_SHARE = 0.5  # smoothed share of water at a flat surface
MAX_EXTRAPOLATION = 2.0  # [standard deviations of neighbours' positions] distance of a point outside its neighbours
MIN_SPREAD = 1.0e-6  # [supports^2] least spread of neighbours; less is a plane or a line, with a slope along it alone
STEPS_PER_SUPPORT = 4  # a support is searched in so many steps
SURFACE_HALVINGS = 4


@in_kernels
class Spread:
    """Summand of a PointSum (over particles near a point): share of space they fill, its first, second moments."""

    sums = MOMENT_COLUMNS.size

    def __init__(self, field: "Field") -> None:
        self.field = field

    @ti.func
    def term(self, own, j, d, mirror):
        """Share of space that particle j, d [m] away, fills, times 1 and products of d / support (MOMENT_COLUMNS);
        `own` and `mirror` are not used."""
        w, q = self.field.weight(d), d / self.field.smoothing.support
        return w * ti.Vector([1.0, q.x, q.y, q.z, q.x * q.x, q.y * q.y, q.z * q.z, q.x * q.y, q.y * q.z, q.z * q.x])


@in_kernels
class DynamicPressure:
    """Summand of a PointSum (over particles near a point): p - rho0 g . x [Pa] of a particle; of its image in a side,
    plus the rise of pressure from the particle to there by acceleration of side or tank."""

    sums = 1

    def __init__(self, field: "Field") -> None:
        self.field = field

    @ti.func
    def term(self, own, j, d, mirror):
        """Weighted p - rho0 g . x [Pa] of j or its image by matrix `mirror`, d [m] away; `own`: see Field.factor."""
        particles = self.field.particles
        x, weight = particles.position.at(j), self.field.weight(d) * self.field.factor(own, d)
        unsteady = self.field.unsteady_pull(mirror_midpoint(mirror, x))
        driven = ti.static(particles.rest_density) * hydrostatic_offset(mirror, x, unsteady)
        return ti.Vector([weight * (particles.pressure[j] - self.field.still_pressure(x) + driven)])


@in_kernels
class Velocity:
    """Summand of a PointSum: velocity [m/s] of a particle, or of its image in a wall with free slip or no slip."""

    sums = 3

    def __init__(self, field: "Field") -> None:
        self.field = field

    @ti.func
    def term(self, own, j, d, mirror):
        """Weighted velocity [m/s] of j or its image by matrix `mirror`, d [m] away; `own`: see Field.factor."""
        weight = self.field.weight(d) * self.field.factor(own, d)
        return weight * mirror_velocity(mirror, self.field.particles.velocity.at(j))


@in_kernels
class Field:
    """Pressure and velocity of the water at any point, interpolated from particles."""

    def __init__(
        self,
        particles: Particles,
        grid: Grid,
        smoothing: Smoothing,
        gravity: np.ndarray,
        pull: Pull | None = None,
        boundary: "Boundary | None" = None,
    ) -> None:
        """`gravity` (3,) [m/s2]: constant accelerations; `pull`: all, if the tank moves; `boundary`: solid bodies."""
        self.particles, self.smoothing = particles, smoothing
        self.moving, self.bodies = False, boundary is not None
        if pull is not None:
            self.pull, self.moving = pull, pull.moving
        if boundary is not None:
            self.boundary = boundary
        self.around = PointSum(particles.position, grid)
        self.volume = particles.mass / particles.rest_density
        held = [0.0 if period > 0.0 else g for g, period in zip(gravity, grid.basin.periods, strict=True)]
        self.held, self.head = tm.vec3(held), tm.vec3([particles.rest_density * g for g in held])  # [m/s2], [Pa/m]
        self.spread, self.dynamic_pressure, self.motion = Spread(self), DynamicPressure(self), Velocity(self)

    @ti.func
    def weight(self, d):
        """Share of the space around a point that a particle d [m] away fills: its volume times the kernel W."""
        return self.volume * self.smoothing.W_poly6(d.dot(d))

    @ti.func
    def still_pressure(self, x):
        """Pressure [Pa] of still water at x [m], up to a constant."""
        return self.head.dot(x)

    @ti.func
    def unsteady_pull(self, x):
        """Acceleration [m/s2] of water at rest at x [m] in a moving tank, without gravity; zero in a tank at rest."""
        pull = tm.vec3(0.0)
        if ti.static(self.moving):
            pull = self.pull.at_rest(x) - self.held
        return pull

    @ti.func
    def is_wet(self, x, share):
        """True if water, which fills a `share` of the space around x [m], fills at least half of what is not solid."""
        least = WET_SHARE
        if ti.static(self.bodies):
            least *= 1.0 - self.boundary.solid(x)
        return share >= least

    @ti.func
    def factor(self, own, d):
        """Correction constant - slope . d / support of a neighbour's weight at d [m]; `own`: both, by `fit_plane`."""
        return own[FACTOR_COLUMNS.constant] - vec3(own, FACTOR_COLUMNS.slope).dot(d / self.smoothing.support)

    @ti.func
    def fit_plane(self, x):
        """Share of water around x [m]; constant and slope (FACTOR_COLUMNS) of the correction (`factor`) of neighbours'
        weights by which sums are exact for fields linear in position. Far from neighbours the slope is limited."""
        m = self.around.total(x, self.spread, 0.0)
        share = tm.max(m[MOMENT_COLUMNS.share], 1.0e-12)
        mean = vec3(m, MOMENT_COLUMNS.first) / share
        xx, xy = m[MOMENT_COLUMNS.xx] / share - mean.x**2, m[MOMENT_COLUMNS.xy] / share - mean.x * mean.y
        yy, yz = m[MOMENT_COLUMNS.yy] / share - mean.y**2, m[MOMENT_COLUMNS.yz] / share - mean.y * mean.z
        zz, zx = m[MOMENT_COLUMNS.zz] / share - mean.z**2, m[MOMENT_COLUMNS.zx] / share - mean.z * mean.x
        spread = tm.mat3([xx + MIN_SPREAD, xy, zx], [xy, yy + MIN_SPREAD, yz], [zx, yz, zz + MIN_SPREAD])
        slope = spread.inverse() @ mean
        slope *= tm.min(1.0, MAX_EXTRAPOLATION / ti.sqrt(tm.max(mean.dot(slope), 1.0e-12)))
        return m[MOMENT_COLUMNS.share], ti.Vector([1.0 + slope.dot(mean), slope.x, slope.y, slope.z]) / share

    @ti.func
    def pressure(self, x):
        """Pressure [Pa] at x [m]; 0 where there is no water."""
        share, factors = self.fit_plane(x)
        pressure = 0.0
        if self.is_wet(x, share):
            pressure = self.around.total(x, self.dynamic_pressure, factors)[0] + self.still_pressure(x)
        return pressure

    @ti.func
    def velocity(self, x):
        """Velocity [m/s] at x [m]; 0 where there is no water."""
        share, factors = self.fit_plane(x)
        velocity = tm.vec3(0.0)
        if self.is_wet(x, share):
            velocity = self.around.total(x, self.motion, factors)
        return velocity

    @ti.kernel
    def fill_pressures(self, points: Array2, pressures: Array):
        """Write the pressure [Pa] at each of the points (m, 3) [m] to `pressures` (m,)."""
        for k in range(points.shape[0]):
            pressures[k] = self.pressure(tm.vec3(points[k, 0], points[k, 1], points[k, 2]))

    @ti.kernel
    def fill_velocities(self, points: Array2, velocities: Array2):
        """Write the velocity [m/s] at each of the points (m, 3) [m] to `velocities` (m, 3)."""
        for k in range(points.shape[0]):
            velocity = self.velocity(tm.vec3(points[k, 0], points[k, 1], points[k, 2]))
            for c in ti.static(range(3)):
                velocities[k, c] = velocity[c]

    def pressures(self, points: np.ndarray) -> np.ndarray:
        """Pressures (m,) [Pa] at points (m, 3) [m]; 0 where there is no water."""
        return values_at(points, self.particles.position.precision, self.fill_pressures)

    def velocities(self, points: np.ndarray) -> np.ndarray:
        """Velocities (m, 3) [m/s] at points (m, 3) [m]; 0 where there is no water."""
        return values_at(points, self.particles.position.precision, self.fill_velocities, 3)


@in_kernels
class Share:
    """Summand of a PointSum: share of space filled by water around a point, 0 to about 1."""

    sums = 1

    def __init__(self, smoothing: Smoothing, volume: float) -> None:
        """Share of space that particles of this `volume` [m3], in 2-D area [m2], fill, by the poly6 kernel."""
        self.smoothing, self.constant = smoothing, volume * smoothing.poly6_constant

    @ti.func
    def term(self, own, j, d, mirror):
        """Share of the space around the point that particle j, d [m] away, fills; `own` and `mirror` are not used."""
        return ti.Vector([self.constant * self.smoothing.shape_poly6(d.dot(d))])


@in_kernels
class FreeSurface:
    """Height of the free surface of particles. Flat sides mirror the water, so that it is not thinner beside them."""

    def __init__(self, particles: Particles, grid: Grid, smoothing: Smoothing) -> None:
        self.particles, self.grid, self.smoothing = particles, grid, smoothing
        self.around = PointSum(particles.position, grid)
        self.share = Share(smoothing, particles.mass / particles.rest_density)
        basin = grid.basin
        self.bed = basin.lower[1]
        self.top = basin.upper[1] if basin.closed else OPEN

    @ti.func
    def ceiling(self, x, z):
        """Height [m] to search the surface down from at x, z [m]: a support over the highest particle, or the lid."""
        p, grid = self.particles.position, self.grid
        h = self.smoothing.support
        home = grid.indices_at(grid.wrap_position(tm.vec3(x, self.bed, z)))
        top = self.bed
        for dz in range(-1, 2):
            for dx in range(-1, 2):
                found = 0
                for down in range(grid.cells[1] - 2):
                    there = tm.ivec3(home.x + dx, grid.cells[1] - 2 - down, home.z + dz)
                    c = grid.cell_at(self.around.periodic_home(there)[0])
                    if (found == 0 or down < grid.sky) and grid.start[c + 1] > grid.start[c]:
                        found = 1
                        for j in range(grid.start[c], grid.start[c + 1]):
                            top = ti.max(top, p.y[j])
        return tm.min(top + h, self.top)

    @ti.func
    def elevation(self, x, z):
        """Height [m] of the surface at x, z [m], where half the space is water, by bisection; the bed if dry."""
        high = self.ceiling(x, z)
        low, share_low, share_high, halvings = high, 0.0, 0.0, 0
        while halvings <= SURFACE_HALVINGS and high > self.bed:
            y = ti.select(halvings > 0, 0.5 * (low + high), high - self.smoothing.support / STEPS_PER_SUPPORT)
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
        """Write the height [m] of the surface at each of the points x, z (m, 2) [m] to `heights` (m,)."""
        for k in range(points.shape[0]):
            heights[k] = self.elevation(points[k, 0], points[k, 1])

    def elevations(self, points: np.ndarray) -> np.ndarray:
        """Heights (m,) [m] of the surface at points x, z (m, 2) [m]."""
        return values_at(points, self.particles.position.precision, self.fill)
