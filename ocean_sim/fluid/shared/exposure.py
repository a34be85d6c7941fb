"""The area that particles show to the air: found every few steps, kept by the particles' numbers in between."""

from typing import TYPE_CHECKING

import taichi as ti
import taichi.math as tm

from ocean_sim.columns import Columns
from ocean_sim.fluid.shared.law import PositionLaw
from ocean_sim.fluid.shared.neighbours import Neighbours
from ocean_sim.fluid.shared.particles import Components, Particles
from ocean_sim.fluid.shared.smoothing import Smoothing

if TYPE_CHECKING:  # it is imported only where there are bodies
    from ocean_sim.fluid.shared.boundary import Boundary

EXPOSED = 0.1  # of the spacing, in space squared: a particle with a smaller exposed area lies inside the water
BLOCK = 4096  # particles whose areas are added by one thread
UNEVEN = 2.0  # factor by which exposed areas are scaled at most
LAG = 0.5  # [spacings] that water and crests may go before areas, smoothed over a support on each side, are found anew


def memory(n: int, word: int) -> int:
    """Bytes of the fields for so many particles, in words of this size."""
    return (3 * n + 1) * word + 8 * -(-n // BLOCK)


@ti.data_oriented
class Exposure(PositionLaw):
    """Exposed area of every particle times its outward normal [m2]: a law of pairs, and its sum."""

    apart, terms = False, Columns(area=3)

    def __init__(
        self,
        particles: Particles,
        positions: tuple[ti.Field, ...],
        smoothing: Smoothing,
        neighbours: Neighbours,
        boundary: "Boundary | None",
        plan_area: float,
    ) -> None:
        """`positions` by which `neighbours` knows the particles; `plan_area` of the water [m2]; 0 where it is not
        known."""
        self.particles, self.smoothing, self.neighbours = particles, smoothing, neighbours
        self.plan_area, self.reads = plan_area, positions
        self.constant = -2.0 * (particles.mass / particles.rest_density) ** 2 * smoothing.slope
        self.least = EXPOSED * particles.spacing ** (smoothing.dimension - 1)  # [m2]
        self.area = Components(particles.n)  # by the number of the particle [m2]
        self.level = ti.field(ti.f64, shape=-(-particles.n // BLOCK))
        self.even = ti.field(float, shape=())  # plan area over the sum of level areas
        self.left = 0.0  # [m] that water and crests may still go
        self.bodies = boundary is not None
        if boundary is not None:
            self.solid = boundary.summed(self)

    def renew(self, dt: float, speed: float) -> None:
        """Find the areas anew, if they may be out of date in a step of dt [s] of water and crests of such a speed
        [m/s]."""
        if self.left <= 0.0:
            self.find()
            self.left = LAG * self.particles.spacing
        self.left -= dt * speed

    @ti.kernel
    def find(self):
        """Find all areas, then scale them so that, seen from above, they sum to the plan area of the water, where that
        is known: whatever the order of the particles, and however many of them count as exposed, a stress acts on the
        surface once. The sum alone is the area of the bed that the water presses on, but for the order of the
        particles."""
        self.neighbours.walk(self, False)
        for b in self.level:
            total = ti.cast(0.0, ti.f64)
            for i in range(b * BLOCK, ti.min((b + 1) * BLOCK, self.particles.count.there())):
                total += self.area.y[i]
            self.level[b] = total
        ti.loop_config(serialize=True)
        for _ in range(1):
            level = ti.cast(0.0, ti.f64)
            for b in range(self.level.shape[0]):
                level += self.level[b]
            scale = ti.cast(1.0, ti.f64)
            if ti.static(self.plan_area > 0.0):
                scale = ti.min(ti.max(self.plan_area / ti.max(level, 1e-9 * self.plan_area), 1.0 / UNEVEN), UNEVEN)
            self.even[None] = ti.cast(scale, float)

    @ti.func
    def of(self, i):
        """Exposed area of particle i times its outward normal [m2]; zero inside the water."""
        name = self.particles.id[i]
        return self.even[None] * tm.vec3(self.area.x[name], self.area.y[name], self.area.z[name])

    @ti.func
    def begin(self, group):
        pass

    @ti.func
    def pair(self, own, other):
        """x_ij, to be times grad W / x_ij."""
        x_ij = own - other
        return -self.smoothing.pair_gradient(x_ij)

    @ti.func
    def finish(self, i, own, total, beyond, group):
        """Twice the volume of i times the gradient [1/m] of the smoothed share of water, turned outwards: the share
        falls from 1 to 1/2 on the water's side of a surface; walls are mirrors, so what faces them is not exposed."""
        if ti.static(self.bodies):
            total += self.solid.total(own, own)
        area = self.constant * total
        if area.norm() < self.least:
            area = tm.vec3(0.0)
        for k, component in ti.static(enumerate(self.area)):
            component[self.particles.id[i]] = area[k]
