"""The area that particles show to the air: found every few steps, kept by the particles' numbers in between."""

from typing import TYPE_CHECKING

import taichi as ti
import taichi.math as tm

from ocean_sim.fluid.shared.grid import TASK
from ocean_sim.fluid.shared.images import OfPlaces
from ocean_sim.fluid.shared.particles import Components

if TYPE_CHECKING:
    from ocean_sim.fluid.shared.sph import Sph

EXPOSED = 0.1  # of the spacing, in space squared: a particle with a smaller exposed area lies inside the water
BLOCK = 4096  # particles whose areas are added by one thread
UNEVEN = 2.0  # factor by which exposed areas are scaled at most
LAG = 0.5  # [spacings] that water and crests may go before areas, smoothed over a support on each side, are found anew


def memory(n: int, word: int) -> int:
    """Bytes of the fields for so many particles, in words of this size."""
    return (3 * n + 1) * word + 8 * -(-n // BLOCK)


@ti.data_oriented
class Exposure(OfPlaces):
    """Exposed area of every particle times its outward normal [m2]: a law of pairs, and its sum."""

    apart, sums = False, 3

    def __init__(self, fluid: "Sph", plan_area: float) -> None:
        """`plan_area` of the water [m2]; 0 where it is not known."""
        self.fluid, self.plan_area = fluid, plan_area
        particles, dimension = fluid.particles, fluid.smoothing.dimension
        self.reads = fluid.places
        self.constant = -2.0 * (particles.mass / particles.rest_density) ** 2 * fluid.smoothing.wendland_slope
        self.least = EXPOSED * particles.spacing ** (dimension - 1)  # [m2]
        self.area = Components(particles.n)  # by the number of the particle [m2]
        self.level = ti.field(ti.f64, shape=-(-particles.n // BLOCK))
        self.even = ti.field(float, shape=())  # plan area over the sum of level areas
        self.left = 0.0  # [m] that water and crests may still go
        if fluid.bodies:
            self.solid = fluid.boundary.met(self)

    def renew(self, dt: float) -> None:
        """Find the areas anew, if they may be out of date in a step of dt [s]."""
        if self.left <= 0.0:
            self.find()
            self.left = LAG * self.fluid.particles.spacing
        self.left -= dt * (self.fluid.status.max_speed + self.fluid.reference_speed)

    @ti.kernel
    def find(self):
        """Find all areas, then scale them so that, seen from above, they sum to the plan area of the water, where that
        is known: whatever the order of the particles, and however many of them count as exposed, a stress acts on the
        surface once. The sum alone is the area of the bed that the water presses on, but for the order of the
        particles."""
        for g in range(self.fluid.ledger.groups * TASK):
            if g % TASK == 0:
                self.fluid.neighbours.walk(g // TASK, self, False)
        for b in self.level:
            total = ti.cast(0.0, ti.f64)
            for i in range(b * BLOCK, ti.min((b + 1) * BLOCK, self.fluid.particles.count.there())):
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
        name = self.fluid.particles.id[i]
        return self.even[None] * tm.vec3(self.area.x[name], self.area.y[name], self.area.z[name])

    @ti.func
    def begin(self, group):
        pass

    @ti.func
    def pair(self, own, other):
        """x_ij, to be times grad W / x_ij."""
        x_ij = own - other
        return -self.fluid.smoothing.shape_grad_wendland(ti.sqrt(x_ij.dot(x_ij))) * x_ij

    @ti.func
    def finish(self, i, own, total, beyond, group):
        """Twice the volume of i times the gradient [1/m] of the smoothed share of water, turned outwards: the share
        falls from 1 to 1/2 on the water's side of a surface; walls are mirrors, so what faces them is not exposed."""
        if ti.static(self.fluid.bodies):
            total += self.solid.total(own, own)
        area = self.constant * total
        if area.norm() < self.least:
            area = tm.vec3(0.0)
        for k, component in ti.static(enumerate(self.area)):
            component[self.fluid.particles.id[i]] = area[k]
