"""Sums over all particles in float64: of fixed blocks, added in their order, so that threads change nothing."""

import numpy as np

from ocean_sim.columns import Columns
from ocean_sim.fluid import Totals
from ocean_sim.fluid.neighbours.thread_tasks import TASK
from ocean_sim.fluid.sph.particles import Particles
from ocean_sim.kernel_library import ti, tm
from ocean_sim.runtime import Doubles2, Template, in_kernels

BLOCKS = 16
SUMS = Columns(density=1, compression=1, deficit=1, squared_speed=1, position=3, velocity=3, turning=3)
MOST = Columns(compression=1, low=3, high=3)  # behind the sums; `low` is the highest of what is below 0
FAR = 1.0e30  # [m]


@in_kernels
class Summing:
    """Adds up what particles have now."""

    def __init__(self, particles: Particles) -> None:
        self.particles = particles
        self.table = np.zeros((BLOCKS, SUMS.size + MOST.size))

    def now(self) -> Totals:
        """Of the state that the particles are in."""
        self.add_up(self.table)
        with np.errstate(invalid="ignore"):  # infinite both ways is NaN
            total, most = self.table[:, : SUMS.size].sum(axis=0), self.table[:, SUMS.size :].max(axis=0)
        return Totals(
            density=float(total[SUMS.density]),
            compression=float(total[SUMS.compression]),
            most_compressed=float(most[MOST.compression]),
            deficit=float(total[SUMS.deficit]),
            squared_speed=float(total[SUMS.squared_speed]),
            position=total[SUMS.position : SUMS.velocity],
            velocity=total[SUMS.velocity : SUMS.turning],
            turning=total[SUMS.turning :],
            lower=-most[MOST.low : MOST.high],
            upper=most[MOST.high :],
        )

    @ti.kernel
    def add_up(self, table: Doubles2):
        for b in range(BLOCKS * TASK):
            if b % TASK == 0:
                self.add_block(b // TASK, table)

    @ti.func
    def add_block(self, block, table: Template):
        p, u, n = self.particles.position, self.particles.velocity, self.particles.count.there()
        total, compressed = ti.Vector.zero(ti.f64, SUMS.size), ti.cast(0.0, ti.f64)
        low, high = tm.vec3(FAR), tm.vec3(-FAR)
        each = (n + BLOCKS - 1) // BLOCKS
        for i in range(block * each, ti.min((block + 1) * each, n)):
            x, v = tm.vec3(p.x[i], p.y[i], p.z[i]), tm.vec3(u.x[i], u.y[i], u.z[i])
            low, high = tm.min(low, x), tm.max(high, x)
            at = ti.Vector([ti.cast(x[k], ti.f64) for k in ti.static(range(3))])
            way = ti.Vector([ti.cast(v[k], ti.f64) for k in ti.static(range(3))])
            density = ti.cast(self.particles.density[i], ti.f64)
            excess = density / ti.static(self.particles.rest_density) - 1.0
            compressed = ti.max(compressed, excess)
            total[SUMS.density] += density
            total[SUMS.compression] += ti.max(excess, 0.0)
            total[SUMS.deficit] += ti.max(-excess, 0.0)
            total[SUMS.squared_speed] += way.dot(way)
            turning = at.cross(way)
            for k in ti.static(range(3)):
                total[SUMS.position + k] += at[k]
                total[SUMS.velocity + k] += way[k]
                total[SUMS.turning + k] += turning[k]
        for c in ti.static(range(SUMS.size)):
            table[block, c] = total[c]
        table[block, SUMS.size + MOST.compression] = compressed
        for k in ti.static(range(3)):
            table[block, SUMS.size + MOST.low + k] = -low[k]
            table[block, SUMS.size + MOST.high + k] = high[k]
