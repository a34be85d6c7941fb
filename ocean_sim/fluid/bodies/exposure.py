"""Area that particles expose to the air: computed every few steps, stored by the particles' ids in between.

Under a wind that presses on slopes, the bend of the surface is computed, too. Exposed areas lie at a mean depth `skin`
below the surface, where a wave of wavenumber k moves less by the share k skin: a pressure P on them does too little
work by as much. The force -grad(P chi), with chi falling from 1 on the surface to 0 inside, does all of it. Its part -P
grad chi is P on the exposed areas; its part -chi grad P comes to -skin grad P on each plan area, as the integral of chi
over the depth is the mean depth of its slope.
"""

from typing import Any

from ocean_sim.columns import Columns, vec3
from ocean_sim.fluid.neighbours.images import POSITION_SIGN, mirror_position
from ocean_sim.fluid.sph.law import Law
from ocean_sim.fluid.sph.particles import Components
from ocean_sim.fluid.sph.smoothing import Stencil
from ocean_sim.kernel_library import ti, tm
from ocean_sim.runtime import in_kernels

MIN_EXPOSED_AREA = 0.1  # [spacing, in space squared] a particle with a smaller exposed area lies inside the water
AREAS_PER_THREAD = 4096  # particles whose areas are added by one thread
MAX_AREA_FACTOR = 2.0  # factor by which exposed areas are scaled at most
MAX_SURFACE_SLOPE = 1.0  # greatest slope in the fit of the bend
MIN_DETERMINANT = 0.01  # share of its greatest below which places lie on a line, and no bend across it is found
# [spacings] that water and crests may go before areas, smoothed over a support on each side, are found anew.
RENEWAL_DISTANCE = 0.5


def memory(n: int, word: int, bends: bool) -> int:
    """Memory [bytes] of an Exposure of n particles; `word`: bytes of a `float`; `bends`: True with curvature too."""
    return ((9 if bends else 3) * n + 1) * word + 8 * -(-n // AREAS_PER_THREAD)


@in_kernels
class Exposure(Law):
    """Pair law for each particle's area exposed to the air, times its outward normal [m2], stored by particle id."""

    terms = Columns(area=3)

    def __init__(self, water: Any, plan_area: float, bends: bool) -> None:
        """`water`: the Sph under the wind; `plan_area` [m2]: of its still surface, 0 if unknown; `bends`: True to find
        the curvature of the surface, too, for a wind that presses on slopes."""
        particles, smoothing = water.particles, water.smoothing
        self.particles, self.smoothing, self.neighbours = particles, smoothing, water.neighbours
        self.plan_area, self.reads = plan_area, water.listed_positions
        # 2 V^2, with V the volume of a particle, times the constant of grad W
        self.factor = -2.0 * (particles.mass / particles.rest_density) ** 2 * smoothing.slope
        self.least = MIN_EXPOSED_AREA * particles.spacing ** (smoothing.dimension - 1)  # [m2]
        self.area = Components(particles.n)  # by the number of the particle [m2]
        self.level = ti.field(ti.f64, shape=-(-particles.n // AREAS_PER_THREAD))
        self.even = ti.field(float, shape=())  # plan area over the sum of level areas
        self.left = 0.0  # [m] that water and crests may still go
        self.bends = bends
        if bends:
            self.surface = Components(particles.n)  # in storage order: slopes along x and z, and plan area [m2]
            self.bending = Bend(self)
        self.add_bodies(water.boundary)

    def renew_if_due(self, dt: float, speed: float) -> None:
        """Recompute exposed areas once water or crests at `speed` [m/s] have moved half a spacing since last time."""
        if self.left <= 0.0:
            self.find_areas()
            self.left = RENEWAL_DISTANCE * self.particles.spacing
        self.left -= dt * speed

    @ti.kernel
    def find_areas(self):
        """Compute all exposed areas; if the plan area is known, scale them so that their upward parts sum to it."""
        self.neighbours.walk(self, False)
        if ti.static(self.bends):
            self.neighbours.walk(self.bending, False)
        for b in self.level:
            total = ti.cast(0.0, ti.f64)
            for i in range(b * AREAS_PER_THREAD, ti.min((b + 1) * AREAS_PER_THREAD, self.particles.count.there())):
                total += self.area.y[i]
            self.level[b] = total
        ti.loop_config(serialize=True)
        for _ in range(1):
            level = ti.cast(0.0, ti.f64)
            for b in range(self.level.shape[0]):
                level += self.level[b]
            scale = ti.cast(1.0, ti.f64)
            if ti.static(self.plan_area > 0.0):
                wanted = self.plan_area / ti.max(level, 1e-9 * self.plan_area)
                scale = ti.min(ti.max(wanted, 1.0 / MAX_AREA_FACTOR), MAX_AREA_FACTOR)
            self.even[None] = ti.cast(scale, float)

    @ti.func
    def of(self, i):
        """Exposed area of particle i times its outward normal [m2]; zero inside the water."""
        return self.even[None] * self.area.at(self.particles.id[i])

    @ti.func
    def pair(self, own, other):
        """Gradient of the kernel from position `own` to a neighbour's, `other` [m], without constants (`factor`)."""
        return -self.smoothing.pair_gradient(own - other)

    @ti.func
    def finish(self, i, own, total, beyond, group):
        """Store the exposed area of particle i at `own` [m], outwards: -2 V grad c, with its volume V and share of
        water c around it (`total`: sum for grad c). It is doubled as particles see the inner half of the fall of c
        alone. Bodies count as water: water at walls is not exposed."""
        area = self.prefactor(own) * self.with_bodies(total, own, own)
        if area.norm() < self.least:
            area = tm.vec3(0.0)
        self.area.put(self.particles.id[i], area)
        if ti.static(self.bends):
            slope = tm.clamp(-tm.vec2(area.x, area.z) / area.y, -MAX_SURFACE_SLOPE, MAX_SURFACE_SLOPE)
            self.surface.put(i, tm.vec3(slope.x, slope.y, area.y) if area.y > 0.0 else tm.vec3(0.0))

    @ti.func
    def bend_of(self, i):
        """Second derivatives xx, xz, zz of surface height at i times `skin` [m], exposed areas' depth; 0 inside."""
        bend = tm.vec3(0.0)
        if ti.static(self.bends):
            bend = self.bending.bend.at(self.particles.id[i])
        return bend


@in_kernels
class Bend(Law):
    """Pair law for the bend of the water's surface (second derivatives of height), fitted to neighbours' slopes."""

    row = Columns(position=3, slope=2, area=1)
    terms = Columns(xx=1, xz=1, zz=1, x_along_x=1, cross=1, z_along_z=1)

    def __init__(self, exposure: Exposure) -> None:
        self.particles, self.smoothing = exposure.particles, exposure.smoothing
        self.reads = (*exposure.reads, *exposure.surface)
        self.skin = Stencil(exposure.smoothing, exposure.particles.spacing).skin_depth
        self.bend = Components(exposure.particles.n)  # by the number of the particle

    @ti.func
    def image(self, other, mirror):
        """Values (`row`) of the image of a neighbour of values `other` by matrix `mirror`: slope across it reversed."""
        x, image = mirror_position(mirror, vec3(other, self.row.position)), other
        for k in ti.static(range(3)):
            image[self.row.position + k] = x[k]
        image[self.row.slope] *= mirror[POSITION_SIGN, 0]
        image[self.row.slope + 1] *= mirror[POSITION_SIGN, 2]
        return image

    @ti.func
    def pair(self, own, other):
        """Terms of the sums in `finish` for a particle and a neighbour (values `own`, `other`): products of horizontal
        distances, and of these with the differences of surface slope, weighted by area and kernel."""
        x = vec3(other, self.row.position) - vec3(own, self.row.position)
        weight = other[self.row.area] * self.smoothing.shape_gradient(ti.sqrt(x.dot(x)))
        steeper_x = other[self.row.slope] - own[self.row.slope]
        steeper_z = other[self.row.slope + 1] - own[self.row.slope + 1]
        cross = 0.5 * (steeper_x * x.z + steeper_z * x.x)
        return weight * ti.Vector([x.x * x.x, x.x * x.z, x.z * x.z, steeper_x * x.x, cross, steeper_z * x.z])

    @ti.func
    def finish(self, i, own, total, beyond, group):
        """Store `skin` (mean depth [m] of exposed areas) times H, the Hessian of surface height at particle i, by least
        squares: H M + M H = 2 S, sums (`total`) over neighbours, M of x x^T, S of slope difference times x^T."""
        xx, xz, zz = total[self.terms.xx], total[self.terms.xz], total[self.terms.zz]
        along_x, along_z = total[self.terms.x_along_x], total[self.terms.z_along_z]
        bend, narrow = tm.vec3(0.0), xx * zz - xz * xz < MIN_DETERMINANT * xx * zz
        if own[self.row.area] > 0.0:
            if xx * zz > 0.0 and not narrow:
                mixed = 2.0 * total[self.terms.cross] - xz * (along_x / xx + along_z / zz)
                bend.y = mixed * xx * zz / ((xx + zz) * (xx * zz - xz * xz))
            if xx > 0.0:
                bend.x = (along_x - bend.y * xz) / xx
            if zz > 0.0:
                bend.z = (along_z - bend.y * xz) / zz
        self.bend.put(self.particles.id[i], self.skin * bend)
