"""The thesis's water: Mueller, Charypar & Gross (2003), with symmetric pressure; (2.13) to (2.18), (2.25).

Weakly compressible by p = k (rho - rho0) (2.15). Density is summed, so the outermost layer, which lacks neighbours,
reads too thin; the clamp `minimum_pressure` keeps that from pulling the surface together.
"""

from math import sqrt
from typing import ClassVar, Literal

import numpy as np
import taichi as ti
import taichi.math as tm
from pydantic import model_validator

from ocean_sim.basin import Basin
from ocean_sim.fluid.shared.accounts import WALLS
from ocean_sim.fluid.shared.grid import TASK
from ocean_sim.fluid.shared.images import OfPlaces, beside, climbed, reflected
from ocean_sim.fluid.shared.smoothing import positive
from ocean_sim.fluid.shared.sph import Sph, SphConfig, rows
from ocean_sim.model import quantity
from ocean_sim.parts import LedgerRow, Preflight
from ocean_sim.wind import Wind

TINY = 1.0e-12  # [m2] keeps two particles in one place finite
PAIR = 3.6e-9  # [s] of processor time a neighbour
READS = 8  # fields of a neighbour that the momentum law reads
SLOPE, OFFSET, VISCOUS = range(3)  # what may change while the water moves


class Config(SphConfig):
    """Water by the scheme of the thesis."""

    carries_bodies: ClassVar[bool] = True
    fineness: ClassVar[int] = 1
    added_viscosity: ClassVar = ((50.0, 3.3e-3),)  # at Re 250, less its own: without any it grows
    kind: Literal["mueller"] = "mueller"
    stiffness: float | None = quantity("m2/s2", None, gt=0.0)
    """k of (2.15) outright, the square of the sound speed, in place of `compression`."""
    minimum_pressure: float | None = quantity("Pa", 0.0)
    """Pressures below it are raised to it; null: none."""

    @model_validator(mode="after")
    def _one_stiffness(self) -> "Config":
        if self.compression is not None and self.stiffness is not None:
            raise ValueError("give either compression or stiffness [m2/s2], not both")
        return self

    def sound_speed(self, basin: Basin) -> float:
        """c [m/s]: the square root of k of (2.15)."""
        return sqrt(self.stiffness) if self.stiffness else super().sound_speed(basin)

    def ledger(self, preflight: Preflight) -> list[LedgerRow]:
        sizes, word = self.sized(self.began(preflight), READS), preflight.word
        return rows(sizes, word, 9, "position, velocity, density, pressure, volume, number", PAIR)

    def build(self, basin: Basin, seed: int, *, ledger: bool, wind: Wind) -> "Mueller":
        return Mueller(self, basin, ledger, wind)


@ti.data_oriented
class Density(OfPlaces):
    """(2.13) with the poly6 kernel, then (2.15)."""

    apart, sums = False, 1

    def __init__(self, fluid: "Mueller") -> None:
        self.fluid = fluid
        self.reads = tuple(fluid.particles.position)
        self.constant = fluid.particles.mass * fluid.smoothing.poly6_constant
        self.clamped, self.minimum = fluid.config.minimum_pressure is not None, fluid.config.minimum_pressure or 0.0
        if fluid.bodies:
            self.solid = fluid.boundary.met(self)

    @ti.func
    def begin(self, group):
        self.fluid.ledger.begin_density(group)

    @ti.func
    def pair(self, own, other):
        x_ij = own - other
        r2 = x_ij.dot(x_ij)
        return ti.Vector([self.fluid.smoothing.shape_poly6(r2)])

    @ti.func
    def finish(self, i, own, total, beyond, group):
        fluid, particles = self.fluid, self.fluid.particles
        if ti.static(fluid.bodies):
            total += self.solid.total(own, own)
        rho_i = self.constant * total[0]
        p_i = fluid.factors[SLOPE] * total[0] - fluid.factors[OFFSET]  # k (rho - rho0) (2.15), multiplied out
        if ti.static(self.clamped):
            p_i = tm.max(p_i, self.minimum)
        particles.density[i], particles.pressure[i], fluid.specific_volume[i] = rho_i, p_i, 1.0 / rho_i
        fluid.ledger.count_density(group, rho_i)


@ti.data_oriented
class Momentum:
    """(2.16) with the spiky kernel, (2.18) with the viscosity kernel, wind and gravity (2.25); symplectic Euler."""

    def __init__(self, fluid: "Mueller", wind: Wind) -> None:
        self.fluid, self.wind = fluid, wind
        particles, smoothing = fluid.particles, fluid.smoothing
        self.reads = (*particles.position, *particles.velocity, particles.pressure, fluid.specific_volume)
        self.apart = fluid.ledger.impulses  # pressure and viscosity summed apart
        self.sums = 6 if self.apart else 3
        self.constant = 1.5 * particles.mass * smoothing.spiky_constant
        if fluid.bodies:
            self.solid, self.reaction = fluid.boundary.met(self), fluid.boundary.reaction(self)

    @ti.func
    def begin(self, group):
        self.fluid.ledger.begin_motion(group)

    @ti.func
    def image(self, other, mirror):
        """A neighbour as a side shows it: its velocity turned round, its pressure continued hydrostatically."""
        x, image = tm.vec3(other[0], other[1], other[2]), reflected(mirror, other)
        image[6] += self.fluid.particles.rest_density * climbed(mirror, x, self.fluid.pull.at_rest(x))
        return image

    @ti.func
    def sample(self, own, s, d, mirror):
        """A sample of a solid body, which has the rest density."""
        boundary = self.fluid.boundary
        other = beside(own, d, boundary.rubbing(tm.vec3(own[3], own[4], own[5]), s, mirror))
        head, rho_0 = boundary.head(tm.vec3(own[0], own[1], own[2]), s, d, mirror), self.fluid.particles.rest_density
        other[6], other[7] = own[6] + rho_0 * head, 1.0 / rho_0
        return other

    @ti.func
    def acceleration(self, own, total):
        return self.constant * own[7] * self.fluid.added(total)

    @ti.func
    def pair(self, own, other):
        """-m (p_i + p_j) / (2 rho_j) grad W (2.16) and mu m / rho_j v_ji laplacian W (2.18)."""
        x_ij = tm.vec3(own[0] - other[0], own[1] - other[1], own[2] - other[2])
        v_ji = tm.vec3(other[3] - own[3], other[4] - own[4], other[5] - own[5])
        r = ti.sqrt(x_ij.dot(x_ij) + TINY)
        q = positive(self.fluid.smoothing.support - r)
        weight = q * other[7]
        total, rubbing = ti.Vector.zero(float, self.sums), tm.vec3(0.0)
        if ti.static(self.fluid.viscous):
            rubbing = self.fluid.factors[VISCOUS] * v_ji
        if ti.static(self.apart):
            for k in ti.static(range(3)):
                total[k] = weight * ((own[6] + other[6]) * q / r * x_ij[k])
                total[3 + k] = weight * rubbing[k]
        else:
            total = weight * ((own[6] + other[6]) * q / r * x_ij + rubbing)
        return total

    @ti.func
    def finish(self, i, own, total, beyond, group):
        fluid, m = self.fluid, ti.static(self.fluid.particles.mass)
        dt = fluid.dt[None]
        x, v = tm.vec3(own[0], own[1], own[2]), tm.vec3(own[3], own[4], own[5])
        if ti.static(fluid.bodies):
            beyond += self.solid.total(x, own)
        scale = self.constant * own[7]
        a_water, a_walls = scale * fluid.added(total), scale * fluid.added(beyond)
        a_wind = self.wind.force(fluid.particles.id[i], x, v, fluid.area(i), m) / m
        a_pull = fluid.pull.at(x, v)
        a_hull = fluid.hull_push(x, 0.0)
        a = a_water + a_walls + a_wind + a_pull + a_hull  # (2.25)
        free = v + dt * a
        pushed, fast = fluid.walls.held_back(fluid.walls.calmed(x, free, dt), dt)
        grid = fluid.grid
        x_free = x + grid.gone(i, dt * pushed)
        x_new, v_new = fluid.walls.bounced(x_free, pushed)
        grid.leave(i, x_new, v_new)
        fluid.ledger.count_motion(group, v_new, a, fast)
        if ti.static(self.apart):
            a_pressure, mean = scale * tm.vec3(total[0], total[1], total[2]), 0.5 * (v + v_new)
            rubbed, held = a_water - a_pressure, m * (v_new - free + dt * a_walls)
            if (x_new != x_free).any():  # forces work as far as the walls let it go; what else it loses, they took
                far = (x_new - x) / dt
                fluid.ledger.count_work(group, WALLS, m * (v_new - v).dot(mean - far))
                mean = far
            fluid.ledger.count_step(group, m * dt, a_pressure, rubbed, a_wind, a_pull, a_hull, held, mean)


@ti.data_oriented
class Mueller(Sph):
    """Particles that press and rub on each other; between steps they are sorted, with density and pressure current."""

    def __init__(self, config: Config, basin: Basin, ledger: bool, wind: Wind) -> None:
        super().__init__(config, basin, config.sized(config.lattice(basin), READS), ledger, wind)
        self.viscous = config.kinematic_viscosity > 0.0
        self.factors = ti.field(float, shape=3)  # of pressure and viscosity: a field, so that a change compiles nothing
        self.specific_volume = ti.field(float, shape=self.particles.n)  # 1 / density [m3/kg]
        self.density, self.momentum = Density(self), Momentum(self, wind)
        self.adjust(self.sound_speed**2, self.kinematic_viscosity)
        self.begin()

    @property
    def adjustable(self) -> dict[str, str]:
        """What `adjust` takes, and its unit; without viscosity in the scene its term is not compiled."""
        return {"stiffness": "m2/s2"} | ({"kinematic_viscosity": "m2/s"} if self.viscous else {})

    def adjust(self, stiffness: float, kinematic_viscosity: float = 0.0) -> None:
        """Go on with another k of (2.15) [m2/s2] and another nu [m2/s]; nothing is compiled for it."""
        particles, real = self.particles, self.particles.position.precision
        self.stiffness, self.kinematic_viscosity = stiffness, kinematic_viscosity
        self.sound_speed = sqrt(stiffness)
        self.factors[SLOPE] = real(self.density.constant) * real(stiffness)
        self.factors[OFFSET] = real(particles.rest_density) * real(stiffness)
        mu = particles.rest_density * kinematic_viscosity
        self.factors[VISCOUS] = mu * particles.mass * self.smoothing.viscosity_constant / self.momentum.constant

    def begin(self) -> None:
        """Start from the particles as they are now."""
        self.lift()
        self.arrive()

    def advance(self, dt: float) -> None:
        """One step of dt [s]; raises Diverged where more particles crowd together than the neighbour lists hold."""
        self.drive(dt)
        self.move(dt, self.wind.since)
        self.arrive()
        self.emit()

    def arrive(self) -> None:
        """Make everything current and sorted where the particles are now."""
        self.settle(self.summary)
        self.status = self.ledger.status(self.summary, self.grid)

    @ti.kernel
    def move(self, dt: float, since: float):
        """Move by the forces of here and now."""
        self.dt[None] = dt
        self.wind.set_clock(since, dt)
        if ti.static(self.bodies):
            self.boundary.react(self.momentum.reaction, dt)
        for g in range(self.ledger.groups * TASK):
            if g % TASK == 0:
                self.neighbours.walk(g // TASK, self.momentum, False)

    @ti.kernel
    def settle(self, summary: ti.types.ndarray(ndim=1)):
        """Sort, and find the new density."""
        self.grid.sort()
        for g in range(self.ledger.groups * TASK):
            if g % TASK == 0:
                self.neighbours.walk(g // TASK, self.density, True)
        self.ledger.summarise(summary)

    def internal_energy(self) -> float:
        """Work of compression, m times the integral of p / rho^2 from the rest density [J]."""
        ratio = self.particles.density.to_numpy().astype(float) / self.particles.rest_density
        energy = np.log(ratio) + 1.0 / ratio - 1.0
        if self.config.minimum_pressure is not None:
            energy = np.where(ratio > 1.0, energy, 0.0)
        return self.particles.mass * self.stiffness * float(energy.sum())
