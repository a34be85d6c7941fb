"""Particles that ignore each other: exact parabolas under gravity, wind and walls (the listing's other method)."""

from typing import Literal

import numpy as np
import taichi as ti
import taichi.math as tm

from ocean_sim.basin import Basin
from ocean_sim.fluid import Limits
from ocean_sim.fluid.shared.accounts import GRAVITY, SHIP, WALLS, WIND
from ocean_sim.fluid.shared.field import Field
from ocean_sim.fluid.shared.grid import TASK, GridSize
from ocean_sim.fluid.shared.particle_water import ParticleWater
from ocean_sim.fluid.shared.water import WaterConfig, free_fall_speed
from ocean_sim.parts import LedgerRow, Preflight
from ocean_sim.wind import Wind

PARTICLE = 4.7e-8  # [s] of processor time a step
SUPPORT_RATIO = 2.0  # [spacings] the surface is smoothed over so much; nothing else has a support here


class Config(WaterConfig):
    """Particles without interaction."""

    kind: Literal["ballistic"] = "ballistic"

    def size(self, basin: Basin) -> GridSize:
        lattice = self.lattice(basin)
        return GridSize(lattice, self.ratio(basin) * lattice.spacing)

    def ratio(self, basin: Basin) -> float:
        """Support over spacing."""
        return SUPPORT_RATIO

    def ledger(self, preflight: Preflight) -> list[LedgerRow]:
        size, word = self.size(preflight.basin), preflight.word
        n, what = size.lattice.n, "position, velocity, density, pressure, number"
        return [
            LedgerRow("fluid", f"{n} particles", (8 * word + 4) * n, what, PARTICLE * n),
            LedgerRow("fluid", f"grid of {size.cell_count} cells", size.bytes(word), "the surface that gauges read"),
        ]

    def still_limits(self, preflight: Preflight) -> Limits:
        basin = preflight.tank
        return force_limit(preflight.support, float(np.linalg.norm(np.add(basin.gravity, self.body_force))))

    def build(self, basin: Basin, seed: int, *, ledger: bool, wind: Wind) -> "Ballistic":
        return Ballistic(self, basin, ledger, wind)


def force_limit(support: float, acceleration: float) -> Limits:
    """Parabolas are exact for any step; this one only keeps wind and walls from being stepped over."""
    return Limits(force=(0.5 * support / acceleration) ** 0.5) if acceleration > 0.0 else Limits()


@ti.data_oriented
class Ballistic(ParticleWater):
    """Particles that fall, bounce and are blown about; wind reaches all of them, but none has an exposed area."""

    sound_speed = 0.0

    def __init__(self, config: Config, basin: Basin, ledger: bool, wind: Wind) -> None:
        super().__init__(config, basin, config.size(basin), ledger, wind)
        self.particles.pressure.fill(0.0)
        self.field = Field(self.particles, self.grid, self.smoothing, np.zeros(3))
        self.reference_speed = free_fall_speed(basin)
        self.begin()
        self.count(self.summary)
        self.status = self.ledger.status(self.summary, self.grid)

    def begin(self) -> None:
        self.lift()
        self.settle()

    @ti.kernel
    def settle(self):
        self.grid.sort()

    @ti.kernel
    def count(self, summary: ti.types.ndarray(ndim=1)):
        """What there is before the first step."""
        for t in range(self.ledger.groups * TASK):
            if t % TASK == 0:
                group, p, u = t // TASK, self.particles.position, self.particles.velocity
                self.ledger.begin_motion(group)
                self.ledger.begin_density(group)
                for i in range(self.first(group), self.first(group + 1)):
                    x, v = tm.vec3(p.x[i], p.y[i], p.z[i]), tm.vec3(u.x[i], u.y[i], u.z[i])
                    self.ledger.count_motion(group, v, self.pull.at(x, v), 0)
                    self.ledger.count_density(group, self.particles.density[i])
        self.ledger.summarise(summary)

    @ti.func
    def first(self, group):
        """Number of the first particle of a group."""
        return group * self.particles.count.there() // self.ledger.groups

    @ti.func
    def move(self, i, dt, group):
        p, u, m = self.particles.position, self.particles.velocity, ti.static(self.particles.mass)
        x, v = tm.vec3(p.x[i], p.y[i], p.z[i]), tm.vec3(u.x[i], u.y[i], u.z[i])
        a_wind = self.wind.force(self.particles.id[i], x, v, tm.vec3(0.0), m) / m
        a_pull = self.pull.at(x, v)
        a_hull = self.hull_push(x, 0.0)
        a = a_wind + a_pull + a_hull
        mean, fast = self.walls.held_back(v + 0.5 * dt * a, dt)  # of the step; x + v dt + a dt^2 / 2 is exact
        x_new, v_new = self.walls.bounced(x + dt * mean, mean + 0.5 * dt * a)
        self.grid.leave(i, x_new, v_new)
        self.ledger.count_motion(group, v_new, a, fast)
        self.ledger.count_density(group, self.particles.density[i])
        if ti.static(self.ledger.impulses):
            between = 0.5 * (v + v_new)
            self.ledger.count_impulse(group, WIND, m * dt * a_wind, between)
            self.ledger.count_impulse(group, GRAVITY, m * dt * a_pull, between)
            self.ledger.count_impulse(group, SHIP, m * dt * a_hull, between)
            self.ledger.count_impulse(group, WALLS, m * (v_new - v - dt * a), between)

    @ti.kernel
    def step(self, dt: float, since: float, summary: ti.types.ndarray(ndim=1)):
        self.wind.set_clock(since, dt)
        for t in range(self.ledger.groups * TASK):
            if t % TASK == 0:
                group = t // TASK
                self.ledger.begin_motion(group)
                self.ledger.begin_density(group)
                for i in range(self.first(group), self.first(group + 1)):
                    self.move(i, dt, group)
        self.grid.sort()
        self.ledger.summarise(summary)

    def advance(self, dt: float) -> None:
        """One step of dt [s]."""
        self.drive(dt)
        self.step(dt, self.wind.since, self.summary)
        self.status = self.ledger.status(self.summary, self.grid)
        self.emit()

    def limits(self) -> Limits:
        return force_limit(self.grid.support, self.status.max_acceleration)

    def internal_energy(self) -> float:
        """None: nothing is compressed [J]."""
        return 0.0
