"""The thesis's water: Mueller, Charypar & Gross (2003), with symmetric pressure; (2.13) to (2.18), (2.25).

Weakly compressible by p = k (rho - rho0) (2.15). Density is summed, so the outermost layer, which lacks neighbours,
reads too thin; the clamp `minimum_pressure` keeps that from pulling the surface together.
"""

from math import inf, sqrt
from typing import Literal

import numpy as np
import taichi as ti
import taichi.math as tm
from pydantic import model_validator

from ocean_sim.basin import Basin
from ocean_sim.fluid import Limits
from ocean_sim.fluid._free_surface import FreeSurface
from ocean_sim.fluid._grid import TASK, Grid, GridSize
from ocean_sim.fluid._ledger import GRAVITY, PRESSURE, SUMMARY, VISCOSITY, WALLS, WIND, Ledger
from ocean_sim.fluid._neighbours import ListSize, Neighbours
from ocean_sim.fluid._particles import Components, seeded
from ocean_sim.fluid._smoothing import Smoothing, positive
from ocean_sim.fluid._walls import Walls
from ocean_sim.fluid._water import WaterConfig, free_fall_speed
from ocean_sim.parts import LedgerRow, quantity
from ocean_sim.wind import Wind

TINY = 1.0e-12  # [m2] keeps two particles in one place finite
READS = 8  # fields of a neighbour that the momentum law reads


class Config(WaterConfig):
    """Water by the scheme of the thesis."""

    kind: Literal["mueller"] = "mueller"
    support_ratio: float = quantity("spacings", 2.0, ge=1.2, le=6.0)
    """Support radius of the smoothing kernels over the spacing: 2h in papers that call half the support h."""
    compression: float | None = quantity("1", None, gt=0.0, le=1.0)
    """Wanted rise of the density at the bed, (reference_speed / sound speed)^2; 0.01 where `stiffness` is not given."""
    stiffness: float | None = quantity("m2/s2", None, gt=0.0)
    """k of (2.15) outright, the square of the sound speed, in place of `compression`."""
    reference_speed: float | None = quantity("m/s", None, gt=0.0)
    """The speed that compression refers to; default sqrt(|g| depth)."""
    kinematic_viscosity: float = quantity("m2/s", 0.0, ge=0.0)
    """nu; mu of (2.18) is rest density times nu."""
    minimum_pressure: float | None = quantity("Pa", 0.0)
    """Pressures below it are raised to it; null: none."""

    @model_validator(mode="after")
    def _one_stiffness(self) -> "Config":
        if self.compression is not None and self.stiffness is not None:
            raise ValueError("give either compression or stiffness [m2/s2], not both")
        return self

    def speed(self, basin: Basin) -> float:
        """Reference speed [m/s]."""
        return self.reference_speed or free_fall_speed(basin)

    def sound_speed(self, basin: Basin) -> float:
        """c [m/s]: the square root of k of (2.15)."""
        return sqrt(self.stiffness) if self.stiffness else self.speed(basin) / sqrt(self.compression or 0.01)

    def problems(self, basin: Basin) -> list[tuple[tuple[str | int, ...], str]]:
        found = super().problems(basin)
        if self.stiffness is None and self.speed(basin) == 0.0:
            found.append((("reference_speed",), "is required without gravity: compression needs a speed to refer to"))
        return found

    def sizes(self, basin: Basin) -> ListSize:
        lattice = self.lattice(basin)
        return ListSize(GridSize(lattice, self.support_ratio * lattice.spacing), READS)

    def ledger(self, basin: Basin, word: int) -> list[LedgerRow]:
        sizes = self.sizes(basin)
        n, support = sizes.grid.lattice.n, sizes.grid.support
        return [
            LedgerRow(
                "fluid", f"{n} particles", (9 * word + 4) * n, "position, velocity, density, pressure, volume, number"
            ),
            LedgerRow(
                "fluid", f"grid of {sizes.grid.cell_count} cells", sizes.grid.bytes(word), f"support {support:g} m"
            ),
            LedgerRow("fluid", "candidate lists", sizes.bytes(word), "neighbours of every occupied cell"),
        ]

    def still_limits(self, basin: Basin) -> Limits:
        """Limits of the time step in still water, before anything is allocated."""
        return limits(self.sizes(basin).grid.support, self.sound_speed(basin), self.kinematic_viscosity, 0.0, 0.0)

    def build(self, basin: Basin, seed: int, *, ledger: bool, wind: Wind) -> "Mueller":
        return Mueller(self, basin, ledger, wind)


def limits(support: float, sound_speed: float, viscosity: float, speed: float, acceleration: float) -> Limits:
    """See Limits; h is half the support."""
    h = support / 2.0
    return Limits(
        acoustic=h / (sound_speed + speed),
        viscous=h * h / viscosity if viscosity > 0.0 else inf,
        force=sqrt(h / acceleration) if acceleration > 0.0 else inf,
    )


@ti.data_oriented
class Density:
    """(2.13) with the poly6 kernel, then (2.15); where the wind asks for it, the exposed area as well."""

    apart = False

    def __init__(self, fluid: "Mueller") -> None:
        self.fluid = fluid
        self.reads = tuple(fluid.particles.position)
        self.sums = 4 if fluid.exposed else 1
        self.constant = fluid.particles.mass * fluid.smoothing.poly6_constant
        self.clamped, self.minimum = fluid.config.minimum_pressure is not None, fluid.config.minimum_pressure or 0.0

    @ti.func
    def begin(self, group):
        self.fluid.ledger.begin_density(group)

    @ti.func
    def image(self, other, sign, offset):
        """A neighbour as a wall shows it."""
        return sign * other + offset

    @ti.func
    def pair(self, own, other):
        x_ij = own - other
        r2 = x_ij.dot(x_ij)
        total = ti.Vector.zero(float, self.sums)
        total[0] = self.fluid.smoothing.shape_poly6(r2)
        if ti.static(self.fluid.exposed):
            w = positive(self.fluid.smoothing.support**2 - r2)
            for k in ti.static(range(3)):
                total[1 + k] = w * w * x_ij[k]
        return total

    @ti.func
    def finish(self, i, own, total, beyond, group):
        fluid, particles = self.fluid, self.fluid.particles
        rho_i = self.constant * total[0]
        p_i = fluid.stiffness * (rho_i - particles.rest_density)  # (2.15)
        if ti.static(self.clamped):
            p_i = tm.max(p_i, self.minimum)
        particles.density[i], particles.pressure[i], fluid.specific_volume[i] = rho_i, p_i, 1.0 / rho_i
        if ti.static(fluid.exposed):
            fluid.expose(i, tm.vec3(total[1], total[2], total[3]))
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
        mu = particles.rest_density * fluid.config.kinematic_viscosity
        self.viscous = mu * particles.mass * smoothing.viscosity_constant / self.constant

    @ti.func
    def begin(self, group):
        self.fluid.ledger.begin_motion(group)

    @ti.func
    def image(self, other, sign, offset):
        """A neighbour as a wall shows it: its normal velocity turned round, its pressure continued hydrostatically."""
        x, v = tm.vec3(other[0], other[1], other[2]), tm.vec3(other[3], other[4], other[5])
        x_image, v_image = sign * x + offset, sign * v
        image = other
        for k in ti.static(range(3)):
            image[k], image[3 + k] = x_image[k], v_image[k]
        image[6] += self.fluid.particles.rest_density * self.fluid.gravity.dot(x_image - x)
        return image

    @ti.func
    def pair(self, own, other):
        """-m (p_i + p_j) / (2 rho_j) grad W (2.16) and mu m / rho_j v_ji laplacian W (2.18)."""
        x_ij = tm.vec3(own[0] - other[0], own[1] - other[1], own[2] - other[2])
        v_ji = tm.vec3(other[3] - own[3], other[4] - own[4], other[5] - own[5])
        r = ti.sqrt(x_ij.dot(x_ij) + TINY)
        q = positive(self.fluid.smoothing.support - r)
        weight = q * other[7]
        total = ti.Vector.zero(float, self.sums)
        if ti.static(self.apart):
            for k in ti.static(range(3)):
                total[k] = weight * ((own[6] + other[6]) * q / r * x_ij[k])
                total[3 + k] = weight * (self.viscous * v_ji[k])
        else:
            total = weight * ((own[6] + other[6]) * q / r * x_ij + self.viscous * v_ji)
        return total

    @ti.func
    def finish(self, i, own, total, beyond, group):
        fluid, m = self.fluid, ti.static(self.fluid.particles.mass)
        dt = fluid.dt[None]
        x, v = tm.vec3(own[0], own[1], own[2]), tm.vec3(own[3], own[4], own[5])
        scale = self.constant * own[7]
        a_water, a_walls = scale * self.added(total), scale * self.added(beyond)
        a_wind = self.wind.force(fluid.particles.id[i], x, v, fluid.area(i), m) / m
        a = a_water + a_walls + a_wind + fluid.gravity  # (2.25)
        pushed, fast = fluid.walls.held_back(v + dt * a, dt)
        x_new, v_new = fluid.walls.bounced(x + dt * pushed, pushed)
        fluid.grid.leave(i, x_new, v_new)
        fluid.ledger.count_motion(group, v_new, a, fast)
        if ti.static(self.apart):
            a_pressure = scale * tm.vec3(total[0], total[1], total[2])
            fluid.ledger.count_impulse(group, PRESSURE, m * dt * a_pressure)
            fluid.ledger.count_impulse(group, VISCOSITY, m * dt * (a_water - a_pressure))
            fluid.ledger.count_impulse(group, WIND, m * dt * a_wind)
            fluid.ledger.count_impulse(group, GRAVITY, m * dt * fluid.gravity)
            fluid.ledger.count_impulse(group, WALLS, m * (v_new - v - dt * (a - a_walls)))

    @ti.func
    def added(self, total):
        """Pressure and viscosity together."""
        both = tm.vec3(total[0], total[1], total[2])
        if ti.static(self.apart):
            both += tm.vec3(total[3], total[4], total[5])
        return both


@ti.data_oriented
class Mueller:
    """Particles that press and rub on each other; between steps they are sorted, with density and pressure current."""

    def __init__(self, config: Config, basin: Basin, ledger: bool, wind: Wind) -> None:
        sizes = config.sizes(basin)
        self.config = config
        lattice, support = sizes.grid.lattice, sizes.grid.support
        self.particles = seeded(lattice)
        self.smoothing = Smoothing(basin.dimension, support)
        self.grid = Grid(self.particles, sizes.grid)
        self.ledger = Ledger(sizes.grid.groups, ledger)
        self.neighbours = Neighbours(self.particles, self.grid, self.ledger, sizes)
        self.surface = FreeSurface(self.particles, self.grid, self.smoothing)
        self.walls = Walls(lattice)
        self.reference_speed, self.sound_speed = config.speed(basin), config.sound_speed(basin)
        self.stiffness = self.sound_speed**2  # [m2/s2]
        self.gravity = tm.vec3(np.add(basin.gravity, config.body_force))  # [m/s2]
        self.specific_volume = ti.field(float, shape=self.particles.n)  # 1 / density [m3/kg]
        self.dt = ti.field(float, shape=())  # [s]
        self.exposed = wind.needs_area
        if self.exposed:
            self.exposed_area = Components(self.particles.n)  # times the outward normal [m2]
        self.density, self.momentum = Density(self), Momentum(self, wind)
        self.summary = np.zeros(SUMMARY, dtype=self.particles.position.precision)
        self.begin()

    def begin(self) -> None:
        """Start from the particles as they are now."""
        self.lift()
        self.arrive()

    def advance(self, dt: float) -> None:
        """One step of dt [s]; raises Diverged where more particles crowd together than the neighbour lists hold."""
        self.move(dt)
        self.arrive()

    def arrive(self) -> None:
        """Make everything current and sorted where the particles are now."""
        self.settle(self.summary)
        self.status = self.ledger.status(self.summary, self.grid)

    @ti.kernel
    def lift(self):
        """Leave all particles where they are, for the sort."""
        for i in range(self.particles.n):
            p, v = self.particles.position, self.particles.velocity
            self.grid.leave(i, tm.vec3(p.x[i], p.y[i], p.z[i]), tm.vec3(v.x[i], v.y[i], v.z[i]))

    @ti.kernel
    def move(self, dt: float):
        """Move by the forces of here and now."""
        self.dt[None] = dt
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

    def limits(self) -> Limits:
        status, nu = self.status, self.config.kinematic_viscosity
        return limits(self.smoothing.support, self.sound_speed, nu, status.max_speed, status.max_acceleration)

    @property
    def impulse(self) -> dict[str, np.ndarray]:
        """Impulse of each term since the start [N s], (3,) each; empty unless built with ledger=True."""
        return self.ledger.total()

    def internal_energy(self) -> float:
        """Work of compression, m times the integral of p / rho^2 from the rest density [J]."""
        ratio = self.particles.density.to_numpy().astype(float) / self.particles.rest_density
        energy = np.log(ratio) + 1.0 / ratio - 1.0
        if self.config.minimum_pressure is not None:
            energy = np.where(ratio > 1.0, energy, 0.0)
        return self.particles.mass * self.stiffness * float(energy.sum())

    @ti.func
    def elevation(self, x, z):
        return self.surface.elevation(x, z)

    def elevations(self, points: np.ndarray) -> np.ndarray:
        return self.surface.elevations(points)

    @ti.func
    def area(self, i):
        """Exposed area of particle i times its outward normal [m2]; zero inside the water."""
        area = tm.vec3(0.0)
        if ti.static(self.exposed):
            area = tm.vec3(self.exposed_area.x[i], self.exposed_area.y[i], self.exposed_area.z[i])
        return area

    @ti.func
    def expose(self, i, outward):
        """Twice the volume of i times the gradient of the smoothed share of water, which falls from 1 to 1/2 on the
        water's side of a surface; walls are mirrors, so what faces them is not exposed."""
        volume = ti.static(self.particles.mass / self.particles.rest_density)
        area = 12.0 * volume**2 * self.smoothing.poly6_constant * outward
        for k, component in ti.static(enumerate(self.exposed_area)):
            component[i] = area[k]
