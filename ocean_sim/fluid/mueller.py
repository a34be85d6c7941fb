"""Water by the thesis's scheme: Mueller, Charypar & Gross (2003), symmetric pressure; (2.13) to (2.18), (2.25).

Weakly compressible by p = k (rho - rho0) (2.15). Density is summed, so the outermost layer, which lacks neighbours,
reads too thin; the clamp `minimum_pressure` keeps that from pulling the surface together.
"""

from collections.abc import Iterator
from math import sqrt
from typing import ClassVar, Literal

import numpy as np

from ocean_sim import waves
from ocean_sim.basin import Basin
from ocean_sim.columns import Columns, vec3
from ocean_sim.conventions import Setting
from ocean_sim.fluid.patch.attenuation import Attenuation
from ocean_sim.fluid.sph.law import Law
from ocean_sim.fluid.sph.pair_sph import MomentumLaw, PairSph
from ocean_sim.fluid.sph.particles import staggered_field
from ocean_sim.fluid.sph.smoothing import WENDLAND, Kernel, positive
from ocean_sim.fluid.sph.sph import SphConfig, scheme_ledger
from ocean_sim.kernel_library import ti, tm
from ocean_sim.model import quantity
from ocean_sim.parts import LedgerRow, SceneFacts
from ocean_sim.runtime import FieldCopy, in_kernels, running_arch
from ocean_sim.wind import Wind

SQUARED_GAP = 1.0e-12  # [m2] keeps two particles in one position finite
CALMING_VISCOSITY = (3.6e-3, 1.8e-3)  # [c spacing] in 2-D and 3-D: less lets still water boil
BOILING_TIME = 10.0  # [sqrt(depth / g)] after which it boils: 0.5 m of a slice at 2 m/s rms, which is sqrt(g depth)
SLOPE_FACTOR, OFFSET_FACTOR, VISCOUS_FACTOR = range(3)  # rows of the factors that `adjust` may change


class Config(SphConfig):
    """Water by the scheme of the thesis."""

    carries_bodies: ClassVar[bool] = True
    misread: ClassVar[str] = (
        "pressures of mueller are no measurements: the sum of its density is off by percents, each of them worth the "
        "pressure at the bed (in still water gauges read 1.5 times that and more at the bed, and 2.7 times what they "
        "should half way up); take delta_sph or dfsph"
    )
    fineness: ClassVar[int] = 1
    attenuation: ClassVar = Attenuation(even=3.3e-3)  # 50 spacings to the wave, Re 250: without viscosity it grows
    default_ratio: ClassVar[tuple[float, float]] = (2.0, 2.0)
    kernel: ClassVar[Kernel] = WENDLAND
    kind: Literal["mueller"] = "mueller"
    support_ratio: float = quantity("spacings", 2.0, ge=1.2, le=6.0)
    """Kernel support radius over the spacing: 2h in papers that call half the support h."""
    stiffness: float | None = quantity("m2/s2", None, gt=0.0)
    """k of (2.15), the square of the sound speed, given in place of `compression`."""
    minimum_pressure: float | None = quantity("Pa", 0.0)
    """Lowest pressure, to which lower ones are raised; null: none."""

    def contradictions(self) -> Iterator[str]:
        yield from super().contradictions()
        if self.compression is not None and self.stiffness is not None:
            yield "give either compression or stiffness [m2/s2], not both"

    def speed(self, basin: Basin) -> float:
        """Reference speed [m/s]: given or sqrt(|g| depth); without gravity 0.1 sqrt(`stiffness`): 1 % compression."""
        return super().speed(basin) or 0.1 * sqrt(self.stiffness or 0.0)

    def sound_speed(self, basin: Basin) -> float:
        """Sound speed c [m/s]: the square root of k in p = k (rho - rho0), thesis eq. 2.15."""
        return sqrt(self.stiffness) if self.stiffness else super().sound_speed(basin)

    def warnings(self, preflight: SceneFacts) -> Iterator[str]:
        yield from super().warnings(preflight)
        basin = preflight.tank
        least = CALMING_VISCOSITY[basin.dimension - 2] * self.sound_speed(basin) * self.lattice(basin).spacing
        pull = waves.downward_gravity(basin)
        seen = pull > 0.0 and preflight.duration > BOILING_TIME * sqrt(basin.depth / pull)
        if seen and self.kinematic_viscosity < 0.9 * least:
            boils = f"still water of mueller boils within seconds below a viscosity of about {least:.1g} m2/s"
            yield f"{boils}; set fluid.kinematic_viscosity, or take delta_sph"

    def notes(self, preflight: SceneFacts) -> Iterator[str]:
        yield from super().notes(preflight)
        yield "the forces of mueller heat or damp what moves: the event `energy that no work has given` says how much"

    def ledger(self, preflight: SceneFacts) -> Iterator[LedgerRow]:
        sizes = self.list_size(self.start_lattice(preflight), preflight.arch, Momentum.row.size)
        what = "position, velocity, density, pressure, volume, number"
        return scheme_ledger(preflight, sizes, 9, what, self.told_to_bodies)

    def build(self, basin: Basin, seed: int, *, accounts: bool, wind: Wind) -> "Mueller":
        return Mueller(self, basin, accounts, wind)


@in_kernels
class Density(Law):
    """Pair law (sum over neighbours) for the density (thesis eq. 2.13, poly6 kernel), and pressure by it (eq. 2.15)."""

    terms = Columns(density=1)

    def __init__(self, fluid: "Mueller") -> None:
        self.fluid = fluid
        self.reads = tuple(fluid.particles.position)
        self.factor = fluid.particles.mass * fluid.smoothing.poly6_constant
        self.clamped, self.minimum = fluid.config.minimum_pressure is not None, fluid.config.minimum_pressure or 0.0
        self.add_bodies(fluid.boundary)

    @ti.func
    def begin(self, group):
        self.fluid.accounts.begin_density(group)

    @ti.func
    def pair(self, own, other):
        """Poly6 kernel for positions `own`, `other` [m] of a pair, without its constant (thesis eq. 2.13)."""
        x_ij = own - other
        return ti.Vector([self.fluid.smoothing.shape_poly6(x_ij.dot(x_ij))])

    @ti.func
    def equation_of_state(self, density_sum):
        """Pressure [Pa] k (rho - rho0) (thesis 2.15), at least `minimum_pressure`; `density_sum`: rho / `prefactor`."""
        p = self.fluid.factors[SLOPE_FACTOR] * density_sum - self.fluid.factors[OFFSET_FACTOR]
        if ti.static(self.clamped):
            p = tm.max(p, self.minimum)
        return p

    @ti.func
    def finish(self, i, own, total, beyond, group):
        fluid, particles = self.fluid, self.fluid.particles
        if ti.static(self.bodies):
            solid = self.solid.total(own, own)
            total += solid
            fluid.damp_crowded(i, self.prefactor(own) * solid[self.terms.density] / fluid.rest_density)
        rho = self.prefactor(own) * total[self.terms.density]
        particles.density[i], particles.pressure[i] = rho, self.equation_of_state(total[self.terms.density])
        fluid.specific_volume[i] = 1.0 / rho
        fluid.accounts.count_density(group, rho)


@in_kernels
class Momentum(MomentumLaw):
    """Pair law for accelerations by pressure (thesis eq. 2.16, spiky kernel) and viscosity (eq. 2.18, own kernel)."""

    stores_pressure_work: ClassVar[bool] = True
    fluid: "Mueller"
    row = Columns(position=3, velocity=3, pressure=1, volume=1)

    def __init__(self, fluid: "Mueller") -> None:
        particles = fluid.particles
        self.reads = (*particles.position, *particles.velocity, particles.pressure, fluid.specific_volume)
        self.constant = 1.5 * particles.mass * fluid.smoothing.spiky_constant  # the half of (2.16), times -W'/(h - r)^2
        super().__init__(fluid)

    @ti.func
    def prefactor(self, own):
        """Factor of the force sum: mass times 3/2 spiky constant over density, from the particle's values `own`."""
        return self.constant * own[self.row.volume]

    @ti.func
    def sample(self, own, s, d, mirror):
        """Values (`row`) of boundary particle s, or its image, d [m] away: pressure continued, 1 / rest density."""
        other = self.continued_sample(own, s, d, mirror)
        other[self.row.volume] = 1.0 / self.fluid.rest_density
        return other

    @ti.func
    def pressure(self, p_i, p_j, r, q):
        """Pressure force of a pair along x_ij (thesis eq. 2.16) without one factor q = h - r: (p_i + p_j) q / r."""
        return (p_i + p_j) * q / r

    @ti.func
    def viscosity(self, v_ji):
        """Viscous force of a pair (thesis eq. 2.18) divided by this law's prefactor; the factor h - r comes later."""
        return self.fluid.factors[VISCOUS_FACTOR] * v_ji

    @ti.func
    def pair(self, own, other):
        """Acceleration by a neighbour (thesis eqs. 2.16, 2.18) over `prefactor`; `own`, `other`: `row`s of both."""
        x_ij = vec3(own, self.row.position) - vec3(other, self.row.position)
        v_ji = vec3(other, self.row.velocity) - vec3(own, self.row.velocity)
        r = ti.sqrt(x_ij.dot(x_ij) + SQUARED_GAP)
        q = positive(self.fluid.smoothing.support - r)
        rub = tm.vec3(0.0)
        if ti.static(self.fluid.viscous):
            rub = self.viscosity(v_ji)
        push = self.pressure(own[self.row.pressure], other[self.row.pressure], r, q) * x_ij
        return self.row_of_terms(q * other[self.row.volume], push, rub, rub, x_ij)


@in_kernels
class Mueller(PairSph):
    """Water by the scheme of the thesis: weakly compressible SPH with summed density."""

    config: Config
    pressure_share = 0.5  # in (2.16) p_j / 2 sums to half the gradient, and p_i / 2 to nothing inside the water
    density: Density
    momentum: Momentum

    def __init__(self, config: Config, basin: Basin, accounts: bool, wind: Wind) -> None:
        sizes = config.list_size(config.lattice(basin), running_arch(), Momentum.row.size)
        super().__init__(config, basin, sizes, accounts, wind)
        self.viscous = config.kinematic_viscosity > 0.0
        self.factors = ti.field(float, shape=3)  # of pressure and viscosity: a field, so that a change compiles nothing
        self.specific_volume = staggered_field(float, self.particles.n)  # 1 / density [m3/kg]
        self.density, self.momentum = Density(self), Momentum(self)
        self.densities = FieldCopy(self.particles.density)
        self.stiffness = self.sound_speed**2
        self.adjust()
        self.begin()

    @property
    def adjustable(self) -> dict[str, Setting]:
        """Settings that `adjust` takes, by name; viscosity only if the scene has it, else its term is not compiled."""
        found = {"stiffness": Setting(self.stiffness, "m2/s2", (0.25 * self.stiffness, 4.0 * self.stiffness))}
        if self.viscous:
            found["kinematic_viscosity"] = Setting(self.kinematic_viscosity, "m2/s")
        return found

    def adjust(self, **values: float) -> None:
        """Set k of the thesis's eq. 2.15 (`stiffness` [m2/s2]) or nu (`kinematic_viscosity` [m2/s]) during a run."""
        particles, real = self.particles, self.particles.position.precision
        self.stiffness = values.get("stiffness", self.stiffness)
        self.kinematic_viscosity = values.get("kinematic_viscosity", self.kinematic_viscosity)
        self.sound_speed = sqrt(self.stiffness)
        self.factors[SLOPE_FACTOR] = real(self.density.factor) * real(self.stiffness)
        self.factors[OFFSET_FACTOR] = real(particles.rest_density) * real(self.stiffness)
        mu = particles.rest_density * self.kinematic_viscosity
        self.factors[VISCOUS_FACTOR] = mu * particles.mass * self.smoothing.viscosity_constant / self.momentum.constant

    def internal_energy(self) -> float:
        """Work of the forces in compression, m times half the integral of p / rho^2 from the rest density [J]."""
        density = self.densities.values()[: self.particles.count.now]
        ratio = density.astype(float) / self.particles.rest_density
        energy = np.log(ratio) + 1.0 / ratio - 1.0
        if self.config.minimum_pressure is not None:
            energy = np.where(ratio > 1.0, energy, 0.0)
        return self.pressure_share * self.particles.mass * self.stiffness * float(energy.sum())
