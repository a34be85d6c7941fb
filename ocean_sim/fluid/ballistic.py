"""Particles that ignore each other: exact parabolas under gravity, wind and walls (the listing's other method)."""

from typing import ClassVar, Literal

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.conventions import GRAVITY as EARTH_GRAVITY
from ocean_sim.fluid import Limits
from ocean_sim.fluid.budget.field import Field
from ocean_sim.fluid.budget.momentum_budget import GRAVITY, SHIP, WALLS, WIND
from ocean_sim.fluid.neighbours.grid_size import GridSize
from ocean_sim.fluid.neighbours.particle_walk import PLANS, account_ledger, mesh_ledger
from ocean_sim.fluid.sph.particle_water import ParticleWater
from ocean_sim.fluid.sph.water_keys import WaterConfig, free_fall_speed
from ocean_sim.kernel_library import ti
from ocean_sim.model import Faults
from ocean_sim.parts import LedgerRow, SceneFacts
from ocean_sim.runtime import Array, in_kernels, running_arch
from ocean_sim.wind import Wind

SUPPORT_RATIO = 2.0  # [spacings] the surface is smoothed over so much; nothing else has a support here


class Config(WaterConfig):
    """Particles without interaction."""

    bears: ClassVar[bool] = False

    kind: Literal["ballistic"] = "ballistic"

    def problems(self, preflight: SceneFacts) -> Faults:
        yield from super().problems(preflight)
        if preflight.tank.rough_bed is not None:
            layer = "particles that ignore each other have no layer on which a bed could act"
            yield ("kind",), f"{layer}; leave basin.floor out"

    def size(self, basin: Basin, arch: str) -> GridSize:
        """Sizes of the grid of cells and of the tasks (shares of the work) into which backend `arch` divides it."""
        lattice = self.lattice(basin)
        return GridSize(lattice, self.ratio(basin) * lattice.spacing, PLANS[arch])

    def ratio(self, basin: Basin) -> float:
        """Ratio of the support radius of the smoothed surface to the particle spacing."""
        return SUPPORT_RATIO

    def ledger(self, preflight: SceneFacts) -> list[LedgerRow]:
        size, word = self.size(preflight.basin, preflight.arch), preflight.word
        n, what = size.lattice.n, "position, velocity, density, pressure, number"
        return [
            LedgerRow("fluid", f"{n} particles", (8 * word + 4) * n, what),
            LedgerRow("fluid", f"grid of {size.cell_count} cells", size.bytes(word), "the surface that gauges read"),
            *account_ledger(size, word, preflight.sums_impulses),
            *mesh_ledger(size, word),
        ]

    def still_limits(self, preflight: SceneFacts) -> Limits:
        basin = preflight.tank
        return force_limit(preflight.support, float(np.linalg.norm(np.add(basin.gravity, self.body_force))))

    def build(self, basin: Basin, seed: int, *, accounts: bool, wind: Wind) -> "Ballistic":
        return Ballistic(self, basin, accounts, wind)


def force_limit(support: float, acceleration: float) -> Limits:
    """Limit sqrt(support / (2 a)) [s] of the time step at acceleration a [m/s2]: in it, from rest, a particle moves a
    quarter of the `support` [m] of the smoothed surface, and so passes no wall or wind unnoticed."""
    return Limits(force=(0.5 * support / acceleration) ** 0.5) if acceleration > 0.0 else Limits()


@in_kernels
class Ballistic(ParticleWater):
    """Particles that fall, bounce and drift with the wind. Wind acts on all of them, not on exposed areas."""

    config: Config

    def __init__(self, config: Config, basin: Basin, accounts: bool, wind: Wind) -> None:
        super().__init__(config, basin, config.size(basin, running_arch()), accounts, wind)
        self.particles.pressure.fill(0.0)
        self.field = Field(self.particles, self.grid, self.smoothing, np.zeros(3))
        self.reference_speed = free_fall_speed(basin) or (EARTH_GRAVITY * basin.depth) ** 0.5
        self.begin()

    def arrive(self) -> None:
        self.settle(self.summary)

    def step(self, dt: float) -> None:
        self.advance_all(dt, self.wind.clock.since, self.summary)

    @ti.kernel
    def settle(self, summary: Array):
        """Sort the unmoved particles; fill `summary` (9,) with extremes of speed, density (see Accounts.summarise)."""
        self.grid.sort()
        for t in range(self.tasks.iterations):
            if t % self.tasks.stride == 0:
                group = t // self.tasks.stride
                self.accounts.begin_motion(group)
                self.accounts.begin_density(group)
                for i in range(self.tasks.first_particle(group), self.tasks.first_particle(group + 1)):
                    x, v = self.particles.position.at(i), self.particles.velocity.at(i)
                    self.accounts.count_motion(group, v, self.pull.at(x, v), 0)
                    self.accounts.count_density(group, self.particles.density[i])
        self.accounts.summarise(summary)

    @ti.func
    def advance_particle(self, i, dt, group):
        """Move particle i for dt [s]; record its speed, density and impulses in row `group` of the momentum budget."""
        m, x, v = ti.static(self.particles.mass), self.particles.position.at(i), self.particles.velocity.at(i)
        a_wind, a_pull, a_hull = self.wind_acceleration(i, x, v), self.pull.at(x, v), self.hull_push(x, 0.0)
        a = a_wind + a_pull + a_hull
        mean, fast = self.walls.limit_motion(v + 0.5 * dt * a, dt)  # of the step; x + v dt + a dt^2 / 2 is exact
        x_new, v_new = self.walls.bounce(x + dt * mean, mean + 0.5 * dt * a)
        self.stage_particle(i, x_new, v_new)
        self.accounts.count_motion(group, v_new, a, fast)
        self.accounts.count_density(group, self.particles.density[i])
        if ti.static(self.accounts.impulses):
            forces, v_mean = (a_wind, a_pull, a_hull), 0.5 * (v + v_new)
            self.accounts.count_impulses(group, (WIND, GRAVITY, SHIP), m * dt, forces, v_mean)
            self.accounts.count_impulse(group, WALLS, m * (v_new - v - dt * a), v_mean)

    @ti.kernel
    def advance_all(self, dt: float, since: float, summary: Array):
        """Move all particles for dt [s], sort them, fill `summary` (9,) with extremes of speed, density (see Accounts).
        `since` [s]: time since the wind's clock restarted, as it does to stay exact in single precision."""
        self.wind.set_clock(since, dt)
        for t in range(self.tasks.iterations):
            if t % self.tasks.stride == 0:
                group = t // self.tasks.stride
                self.accounts.begin_motion(group)
                self.accounts.begin_density(group)
                for i in range(self.tasks.first_particle(group), self.tasks.first_particle(group + 1)):
                    self.advance_particle(i, dt, group)
        self.grid.sort()
        self.accounts.summarise(summary)

    def limits(self) -> Limits:
        """Limits of the next step, by the largest acceleration in the last one."""
        return force_limit(self.grid.support, self.status.max_acceleration)
