"""Weakly compressible water with density diffusion: delta-SPH, the accuracy reference.

Density follows the continuity equation (Monaghan 1994, J. Comput. Phys. 110, eq. 2.4), smoothed by diffusion (Molteni &
Colagrossi 2009, Comput. Phys. Commun. 180; Antuono, Colagrossi, Marrone & Molteni 2010, eq. 1) of its part beyond the
hydrostatic (Fourtakas et al. 2019, Comput. Fluids 190, eq. 9); pressure forces are its exact counterpart, so momentum
is kept to rounding. Two dissipations belong to the scheme and leave smooth flow alone: a bulk viscosity, which damps
sound and nothing that keeps its volume (Sun, Pilloton, Antuono & Colagrossi 2023, J. Comput. Phys. 483, 112177), and
under a free surface that of a Riemann problem between particles that meet (Zhang, Hu & Adams 2017, J. Comput. Phys.
335, 605), which is quadratic in their speed. Steps are drift, kick, drift.
The carried density leaks where particles do not stand for it, so that water keeps its volume (Continuity.leak).
Stored is the deviation from the rest density, which single precision would lose in the density itself.

The kernel is one under which a lattice of particles behaves as water does (smoothing.NEUTRAL_KERNEL): where a lattice
bears shear waves run fast, however fine it is, and where it is unstable still water stirs. Where the surface cuts the
kernel, rows of particles rest under a pressure that is not smooth; diffusion would flatten it for ever, and take its
share of each wave that passes. So it is graded: next to a free surface none takes part but in water that is sheared.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import ClassVar, Literal

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.columns import Columns, vec3
from ocean_sim.conventions import Diverged
from ocean_sim.fluid import Limits
from ocean_sim.fluid.budget.momentum_budget import DIFFUSION, LEAK, PRESSURE, VISCOSITY
from ocean_sim.fluid.neighbours.grid import STATE_COLUMNS
from ocean_sim.fluid.neighbours.grid_size import GridSize
from ocean_sim.fluid.neighbours.images import hydrostatic_offset, mirror_midpoint, mirror_row_free_slip, row_at
from ocean_sim.fluid.patch.attenuation import Attenuation, Delay
from ocean_sim.fluid.sph.law import Law, WalkOptions
from ocean_sim.fluid.sph.pair_sph import MomentumLaw
from ocean_sim.fluid.sph.particles import Components, staggered_field
from ocean_sim.fluid.sph.smoothing import Smoothing, Stencil, lesser, positive
from ocean_sim.fluid.sph.sph import Sph, SphConfig, scheme_ledger, step_limits
from ocean_sim.fluid.sph.water_keys import Lattice
from ocean_sim.kernel_library import ti, tm
from ocean_sim.model import quantity
from ocean_sim.parts import LedgerRow, SceneFacts
from ocean_sim.runtime import Array, FieldCopy, Template, in_kernels, running_arch
from ocean_sim.wind import Wind

ARTIFICIAL_STRESS = 0.6  # on particles that approach: twice epsilon of Monaghan (2000, J. Comput. Phys. 159), eq. 3.2
CROWDING_WEIGHT = 0.2  # weight of near neighbours in a shift (Sun et al. 2017)
BULK_VISCOSITY = 0.7  # [h c]; at the default Courant number 1 is stable and 2 is not
MAX_BULK_VISCOSITY = 0.42  # [h^2 / dt]; steps longer than the default damp less, and stay stable
MIN_STEADY_SUPPORT = 2.5  # [spacings] support below which water at rest stirs and sinks
CUT_SHARE, FILLED_SHARE = 0.90, 0.97  # share of a kernel that is filled at which nothing and everything diffuses
# Spin over strain, both squared, from which diffusion comes back next to a surface, and up to which.
STRETCHED_RATIO, SHEARED_RATIO = 0.1, 0.6
SHEAR_MEMORY = 3.0  # [depth over reference speed] over which spin and strain are remembered
SHEAR_UPDATE_INTERVAL = 1.0 / 64.0  # [SHEAR_MEMORY]
# [c / h] strain below which water is still; less under a wind, whose drift may be as small.
CALM_STRAIN, WINDY_CALM_STRAIN = 1e-3, 1e-4
# Share of the density by which particles may stand too thin or too dense before pressure leaks: in full water, more of
# it in a unit of `edge`, and beyond it, up to which the leak grows.
PACKING_TOLERANCE, EDGE_TOLERANCE, PACKING_RANGE = 0.015, 0.06, 0.25
RELEASED_TENSION, TENSION_RANGE = 3e-4, 1e-3  # of density below rest, from which it ends at a surface; up to full rate
INNER_EDGE, EDGE_RANGE = 0.1, 0.5  # of `edge` inside water, beyond it at a surface; that of its third row is 0.01
RESISTED_APPROACH = 1e-4  # [c] of particles on which the stress under tension acts in full
PARTING_TENSION = 1e-3  # of the density below rest, from which on a face draws no water apart
IMPACT_DISSIPATION = 0.5  # between particles that meet, over their density and the square of their speed
# Deviation of the density, damped pressure over density squared; share of diffusion, spin, strain.
CARRIED_NUMBERS, GRADED_NUMBERS = 2, 3
NEAR_SUPPORT_SPACINGS = 3.5  # [spacings] support of the kernel that finds particles too near to each other


class Config(SphConfig):
    """Weakly compressible water with density diffusion."""

    carries_bodies: ClassVar[bool] = True
    leaks: ClassVar[bool] = True
    bears_shear: ClassVar[float] = 3.0e-3
    fineness: ClassVar[int] = 3
    attenuation: ClassVar = Attenuation(0.0, flat=1.0e-3, steep=2.7e-3, travelling=Attenuation(0.0, 2.0e-3, 7.9e-3))
    delay: ClassVar = Delay(0.33, high=0.12)
    kind: Literal["delta_sph"] = "delta_sph"
    support_ratio: float | None = quantity("spacings", None, ge=1.2, le=6.0)
    """Kernel support radius over the spacing; by default 4.0. At 4.0 the lattice from which water starts bears no
    shear, so that waves run at their speed, and hardly gives way; a much smaller support damps waves."""
    exponent: int = quantity("1", 1, ge=1, le=9)
    """gamma of p = c^2 rho0 / gamma ((rho / rho0)^gamma - 1): 1 is linear, 7 is Tait's."""
    density_diffusion: float = quantity("1", 0.1, ge=0.0, le=0.5)
    """delta: strength of the diffusion of density."""
    artificial_viscosity: float = quantity("1", 0.0, ge=0.0)
    """alpha of Monaghan (1992), on approaching particles: nu = alpha h c / 8 in 2-D, / 10 in 3-D; h is 0.4 of
    the kernel support radius."""
    collision_distance: float = quantity("spacings", 0.25, gt=0.0, le=1.0)
    """Least distance of a particle's centre from a wall or the floor; its ghost particles hold it before that."""

    def limits_at(self, smoothing: Smoothing, sound_speed: float, speed: float, acceleration: float) -> Limits:
        """Limits of the time step at these speeds [m/s] and acceleration [m/s2]. Viscosity, artificial included, counts
        twice: pair forces relax at rates of up to 14 nu / h^2, twice that of the Laplacian's sum."""
        nu = 2.0 * (self.kinematic_viscosity + self.artificial_nu(smoothing, sound_speed))
        return step_limits(smoothing, sound_speed, nu, speed, acceleration)

    def artificial_nu(self, smoothing: Smoothing, sound_speed: float) -> float:
        """Kinematic viscosity [m2/s] equivalent to the artificial viscosity in water that is compressed."""
        return self.artificial_viscosity * smoothing.length * sound_speed / (2.0 * (smoothing.dimension + 2.0))

    def viscosity(self, basin: Basin) -> float:
        """Kinematic viscosity [m2/s], the artificial one included."""
        return self.kinematic_viscosity + self.artificial_nu(self.smoothing(basin), self.sound_speed(basin))

    def settling(self, preflight: SceneFacts) -> float:
        """Settlement [m] of the deepest column of water under its own weight, g h^2 / (2 c^2)."""
        tank, lattice, pull = preflight.tank, preflight.untouched, -preflight.tank.gravity[1]
        if lattice is None or self.is_enclosed(tank) or pull <= 0.0:
            return 0.0
        return float(column_drop(0.0, pull * lattice.deepest, pull, self.sound_speed(tank)))

    def still_limits(self, preflight: SceneFacts) -> Limits:
        """Limits of the time step in still water, by sound and viscosity."""
        return self.limits_at(self.smoothing(preflight.tank), self.sound_speed(preflight.tank), 0.0, 0.0)

    def warnings(self, preflight: SceneFacts) -> Iterator[str]:
        yield from super().warnings(preflight)
        ratio = self.ratio(preflight.tank)
        if ratio < MIN_STEADY_SUPPORT and not self.is_enclosed(preflight.tank):
            begin = f"at a support of {ratio:g} spacings still water of delta_sph stirs and sinks: ten rows lost 28 %"
            yield f"{begin} of their depth in 3 s at 1.2 spacings, 10 % at 1.5 and 2 % at 2; take 4, its default"

    def ledger(self, preflight: SceneFacts) -> Iterator[LedgerRow]:
        """Rows of the memory ledger for the fields of this scheme."""
        what = "position, velocity, density, pressure, its deviation and rate, number"
        if not self.is_enclosed(preflight.tank):
            what += "; share of diffusion, spin, strain"
        numbers = 15 if self.is_enclosed(preflight.tank) else 12 + 2 * GRADED_NUMBERS
        sizes = self.list_sizes(self.start_lattice(preflight), preflight.arch)
        return scheme_ledger(preflight, sizes, numbers, what, self.told_to_bodies)

    def list_sizes(self, lattice: Lattice, arch: str) -> GridSize:
        """Sizes of the grid and of lists of candidates for neighbours (particles of near cells) on backend `arch`."""
        if self.is_enclosed(lattice.basin):
            return self.list_size(lattice, arch, Momentum.row.size, CARRIED_NUMBERS)
        return self.list_size(lattice, arch, Continuity.row.size, CARRIED_NUMBERS + GRADED_NUMBERS)

    def build(self, basin: Basin, seed: int, *, accounts: bool, wind: Wind) -> "DeltaSph":
        return DeltaSph(self, basin, accounts, wind)


def column_drop(top: np.ndarray | float, bottom: np.ndarray | float, pull: float, sound_speed: float) -> np.ndarray:
    """Settlement [m] of a column of water by its weight; `top`, `bottom`: p / rho [m2/s2]; `pull`: gravity [m/s2]."""
    return np.maximum(np.square(bottom) - np.square(top), 0.0) / (2.0 * pull * sound_speed**2)


@in_kernels
class Momentum(MomentumLaw):
    """Pair law for the acceleration (Monaghan 1992, eq. 3.3): damped pressure, viscosity, dissipation of impacts.
    Functions of a pair return factors of x_ij (or a vector); `pair` and `prefactor` multiply by -m grad W / x_ij."""

    fluid: "DeltaSph"
    row = Columns(position=3, velocity=3, pressure=1)  # damped, over the square of the density
    drifted = 0.5
    stores_pressure_work = True

    def __init__(self, fluid: "DeltaSph") -> None:
        self.reads = (*fluid.particles.position, *fluid.particles.velocity, fluid.pressing)
        config, h, rho_0 = fluid.config, fluid.smoothing.length, fluid.rest_density
        self.factor = fluid.slope  # particle mass times the constant of grad W
        self.laminar = 2.0 * config.kinematic_viscosity / rho_0
        self.per_component = fluid.smoothing.dimension + 2.0  # of the central form over that of one component
        self.artificial = config.artificial_viscosity * h * fluid.sound_speed / rho_0
        self.impact = IMPACT_DISSIPATION / rho_0
        self.per_approach = 1.0 / (RESISTED_APPROACH * fluid.sound_speed)  # [s/m]
        self.is_enclosed = fluid.shifting
        self.viscous = self.laminar > 0.0 or self.artificial > 0.0 or not self.is_enclosed
        self.squared_gap = 1e-6 * h * h  # [m2] keeps two particles in one position finite
        super().__init__(fluid)
        column, plain = self.row.pressure, self.pair_without_tension
        self.options = replace(self.options, tension_column=column, pair_without_tension=plain)

    @ti.func
    def pressure_rise(self, head):
        """Rise of p / rho^2, this law's form of the pressure, for a rise `head` [m2/s2] of p / rho."""
        return head / self.fluid.rest_density

    @ti.func
    def pressure(self, p_i, p_j):
        """Pressure part of a pair (Monaghan 1992, eq. 3.3): the sum of `p_i`, `p_j`, each p / rho^2 of a particle."""
        return p_i + p_j

    @ti.func
    def artificial_stress(self, p_i, p_j, r):
        """Stress against clumping under tension: 0.6 (W(r) / W(spacing))^4 (|p_i| / rho_i^2 + |p_j| / rho_j^2) of
        negative pressures (Monaghan 2000, eqs. 3.1, 3.2); `p_i`, `p_j`: p / rho^2. The caller applies it to approaching
        pairs only: it stores no energy, and would add some to pairs that separate."""
        near = self.fluid.closeness(r)
        return ARTIFICIAL_STRESS * near * near * near * near * (positive(-p_i) + positive(-p_j))

    @ti.func
    def viscosity(self, closing):
        """Viscous part of a pair: 2 (d + 2) nu u_ij / rho0; `closing`: u_ij = -v_ij . x_ij / r^2 (Monaghan & Gingold
        1983). No stress at a free surface (Colagrossi, Antuono, Souto-Iglesias & Le Touze 2011, Phys. Rev. E 84)."""
        return self.laminar * self.per_component * closing

    @ti.func
    def viscosity_without_surface(self, v_ij):
        """Viscous part of a pair without a free surface: -2 nu v_ij / rho0 (Morris, Fox & Zhu 1997, eq. 22)."""
        return -self.laminar * v_ij

    @ti.func
    def artificial_viscosity(self, closing):
        """Artificial viscosity alpha h c u_ij / rho0 of approaching pairs; `closing`: u_ij (Monaghan 1992, eq. 4.2)."""
        return self.artificial * positive(closing)

    @ti.func
    def riemann_dissipation(self, closing, r):
        """Dissipation of a pair that approaches at u = r u_ij [m/s] (`closing` is u_ij): beta u / (rho0 r), with beta =
        min(u / 2, c) (Zhang, Hu & Adams 2017, who have a factor 3 in place of 1/2)."""
        met = positive(closing)
        return lesser(r * met, self.fluid.sound_speed / IMPACT_DISSIPATION) * r * self.impact * met

    @ti.func
    def sample(self, own, s, d, mirror):
        """Values (`row`) to use in `pair` for boundary particle s (or its image by matrix `mirror`), d [m] from the
        particle with values `own`: pressure continued from there; with a free surface it cannot pull water."""
        other = self.continued_sample(own, s, d, mirror)
        if ti.static(not self.is_enclosed):
            other[self.row.pressure] = ti.max(other[self.row.pressure], -own[self.row.pressure])
        return other

    @ti.func
    def pair(self, own, other):
        """Forces (`terms`) by a neighbour at pressures of any sign; `own`, `other`: values of the two (`row`)."""
        return self.sum_of_terms(own, other, True)

    @ti.func
    def pair_without_tension(self, own, other):
        """Forces by a neighbour as in `pair` where neither pressure is negative, so without artificial stress."""
        return self.sum_of_terms(own, other, False)

    @ti.func
    def sum_of_terms(self, own, other, tense: Template):
        """Forces by a neighbour as in `pair`; `tense`: True if a pressure may be negative: with artificial stress."""
        x_ij = self.fluid.smoothing.difference(own, other, self.row.position)
        r2 = x_ij.dot(x_ij)
        r = ti.sqrt(r2)
        p_i, p_j = own[self.row.pressure], other[self.row.pressure]
        push, rub, shear = self.pressure(p_i, p_j) * x_ij, tm.vec3(0.0), tm.vec3(0.0)
        v_ij = self.fluid.smoothing.difference(own, other, self.row.velocity)
        closing = -v_ij.dot(x_ij) / (r2 + self.squared_gap)  # u_ij [1/s]
        if ti.static(self.viscous):
            if ti.static(self.is_enclosed):
                shear = self.viscosity_without_surface(v_ij)
                rub = shear + self.artificial_viscosity(closing) * x_ij
            else:
                lost = self.riemann_dissipation(closing, r)
                if ti.static(self.artificial > 0.0):
                    lost += self.artificial_viscosity(closing)
                if ti.static(self.laminar > 0.0):
                    shear = self.viscosity(closing) * x_ij
                    lost += self.viscosity(closing)
                rub = lost * x_ij
        if ti.static(tense):
            share = tm.clamp(r * closing * self.per_approach, 0.0, 1.0)  # of the stress: all of it resists approach
            rub += share * self.artificial_stress(p_i, p_j, r) * x_ij
        return self.row_of_terms(self.fluid.smoothing.shape_gradient(r), push, rub, shear, x_ij)


@in_kernels
class Continuity(Law):
    """Pair law for the rate of density (Monaghan 1994, eq. 2.4), its diffusion and, in a closed basin, the shift of
    particles. It reads positions and velocities at the step's end, densities in its middle, and particles' shares of
    diffusion (0 to 1) of the last step's end. `pair`, `prefactor` multiply contributions by -m grad W / x_ij."""

    row = Columns(position=3, velocity=3, deviation=1, share=1)
    options = WalkOptions(padded=True)

    def __init__(self, fluid: "DeltaSph") -> None:
        self.fluid = fluid
        self.reads = (*fluid.grid.moved[: STATE_COLUMNS.id], fluid.deviation)
        if fluid.shifting:
            self.row = Columns(position=3, velocity=3, deviation=1)
        else:
            self.reads = (*self.reads, fluid.share)
        h, rho_0 = fluid.smoothing.length, fluid.rest_density
        self.diffusion = 2.0 * fluid.config.density_diffusion * h * fluid.sound_speed / rho_0
        self.factor = fluid.slope  # particle mass times the constant of grad W
        self.heavier = rho_0 / fluid.sound_speed**2  # density [kg/m3] over p / rho [m2/s2]
        filled = {} if fluid.shifting and not fluid.bodies else {"filled": 1}
        further = {"crowding": 3} if fluid.shifting else {"edge": fluid.smoothing.dimension}
        self.terms, lattice = Columns(rate=1, diffusion=1, **filled, **further), Stencil(fluid.smoothing, fluid.spacing)
        # Sum of `filled` on a lattice [kg/m3], times the prefactor.
        self.whole = lattice.filled_gain * fluid.smoothing.dimension * rho_0
        self.deficit, self.deficit_bend = lattice.surface_deficit
        self.add_bodies(fluid.boundary)

    @ti.func
    def begin(self, group):
        self.fluid.accounts.begin_density(group)

    @ti.func
    def image(self, other, mirror):
        """Image of values `other` by matrix `mirror`: normal velocity reversed, density risen as in still water."""
        x, image = vec3(other, self.row.position), mirror_row_free_slip(mirror, other)
        pull = self.fluid.pull.at_rest(mirror_midpoint(mirror, x))
        image[self.row.deviation] += self.heavier * hydrostatic_offset(mirror, x, pull)
        return image

    @ti.func
    def sample(self, own, s, d, mirror):
        """Values (`row`) to use in `pair` for boundary particle s (or its image by matrix `mirror`), d [m] from a
        particle with values `own`: a density without diffusion, the body's velocity. With that of a mirror image, 2
        v_body - v, water would approach faces twice as fast: its rise of density, and the push on it, would double."""
        other = row_at(own, d, self.boundary.mirrored_velocity(s, mirror))
        still = self.still_gradient(vec3(own, self.row.position) + 0.5 * d)
        other[self.row.deviation] = own[self.row.deviation] + still.dot(d)
        return other

    @ti.func
    def still_gradient(self, x):
        """Gradient [kg/m4] of the density of still water at x [m]: rho0 g / c^2."""
        return self.heavier * self.fluid.pull.at_rest(x)

    @ti.func
    def continuity(self, v_ij, x_ij):
        """Compression of a pair: -v_ij . x_ij, as d rho_i / dt = sum m v_ij . grad W (Monaghan 1994, eq. 2.4)."""
        return -v_ij.dot(x_ij)

    @ti.func
    def density_diffusion(self, own, other, x_ij):
        """Difference rho_j - rho_i less that of water at rest (Fourtakas et al. 2019, eq. 9); `own`, `other`: `row`s of
        i, j; x_ij [m]. `finish` applies 2 delta h c / rho0 (Molteni & Colagrossi 2009; Antuono et al. 2010, eq. 1)."""
        still = self.still_gradient(vec3(own, self.row.position) - 0.5 * x_ij)
        return other[self.row.deviation] - own[self.row.deviation] + still.dot(x_ij)

    @ti.func
    def crowding(self, r):
        """Weight of a neighbour in the shift: 1 + 0.2 (W(r) / W(spacing))^4 (Sun et al. 2017, eq. 16)."""
        near = self.fluid.closeness(r)
        return 1.0 + CROWDING_WEIGHT * near * near * near * near

    @ti.func
    def pair(self, own, other):
        """Contribution of a neighbour to `terms` (`own`, `other`: `row` of both): (a) compression, (b) diffusion, (c)
        filled part of the kernel, (d) gradient of the share of water, or in a closed basin particle shift."""
        smoothing = self.fluid.smoothing
        x_ij = smoothing.difference(own, other, self.row.position)
        v_ij = smoothing.difference(own, other, self.row.velocity)
        r2 = x_ij.dot(x_ij)
        r = ti.sqrt(r2)
        weight = smoothing.shape_gradient(r)
        total = ti.Vector.zero(float, self.terms.size)
        total[self.terms.rate] = weight * self.continuity(v_ij, x_ij)
        total[self.terms.diffusion] = weight * self.density_diffusion(own, other, x_ij)
        if ti.static(not self.fluid.shifting):  # the same share for both, so that no mass is made
            total[self.terms.diffusion] *= lesser(own[self.row.share], other[self.row.share])
        if ti.static(not self.fluid.shifting or self.fluid.bodies):
            total[self.terms.filled] = weight * r2
        if ti.static(not self.fluid.shifting):
            for k in ti.static(range(smoothing.dimension)):
                total[self.terms.edge + k] = weight * x_ij[k]
        else:
            weight *= self.crowding(r)
            for k in ti.static(range(3)):
                total[self.terms.crowding + k] = -weight * x_ij[k]
        return total

    @ti.func
    def grade_diffusion(self, i, filled):
        """Store particle i's share of density diffusion: 0 to 1 as neighbours fill CUT_SHARE to FILLED_SHARE (`filled`)
        of its kernel. The rest, near a surface, is added as squared spin over squared strain rate rises from
        STRETCHED_RATIO to SHEARED_RATIO, as it does in sheared water (Balsara 1995, J. Comput. Phys. 121)."""
        fluid, spin, strain = self.fluid, self.fluid.spin[i], self.fluid.strain[i]
        inside = tm.clamp((filled - CUT_SHARE) / (FILLED_SHARE - CUT_SHARE), 0.0, 1.0)
        beyond = spin / (strain + fluid.calm) - STRETCHED_RATIO
        sheared = tm.clamp(beyond / (SHEARED_RATIO - STRETCHED_RATIO), 0.0, 1.0)
        for k, value in ti.static(enumerate((inside + (1.0 - inside) * sheared, spin, strain))):
            fluid.fresh[k][i] = value

    @ti.func
    def filled_share(self, own, total):
        """Part M of a kernel that neighbours fill: sum `total` of m r |grad W| over a lattice's; `own`: row of i."""
        return self.prefactor(own) * total[self.terms.filled] / self.whole

    @ti.func
    def edge(self, own, total):
        """Closeness e to a surface, 0 inside: e = H |sum m / rho0 grad W|, by `total` of particle `own`; H: support."""
        squared = 0.0
        for k in ti.static(range(self.fluid.smoothing.dimension)):
            squared += total[self.terms.edge + k] ** 2
        return self.fluid.smoothing.support / self.fluid.rest_density * self.prefactor(own) * ti.sqrt(squared)

    @ti.func
    def swelling(self, filled, edge, deviation):
        """Share by which particles lie further apart than their density, rest density plus `deviation` [kg/m3], says:
        that density over rest density, less the `filled` share of the kernel, less the share that is empty at a flat
        surface with the slope `edge` of the filled share (fitted in `Stencil.surface_deficit`)."""
        return 1.0 + deviation / self.fluid.rest_density - filled - (self.deficit - self.deficit_bend * edge) * edge

    @ti.func
    def leak(self, thinner, edge, deviation):
        """Rate [1/s], up to c / support, at which a density's `deviation` [kg/m3] from rest leaks away where particles
        lie too far apart for it by a share `thinner` (`swelling`), or too near; near a surface (`edge` > 0) more is
        tolerated."""
        beyond = (ti.abs(thinner) - PACKING_TOLERANCE - EDGE_TOLERANCE * edge) / PACKING_RANGE
        rate = self.fluid.sound_speed / self.fluid.smoothing.support * tm.clamp(beyond, 0.0, 1.0)
        return ti.select(thinner * deviation > 0.0, rate, 0.0)

    @ti.func
    def tension_release(self, edge, deviation):
        """Rate [1/s], up to c / spacing, at which a `deviation` [kg/m3] of the density below rest ends near a surface
        (`edge`), beyond which nothing can pull; inside the water tension stays."""
        tense = tm.clamp((-deviation / self.fluid.rest_density - RELEASED_TENSION) / TENSION_RANGE, 0.0, 1.0)
        near = tm.clamp((edge - INNER_EDGE) / EDGE_RANGE, 0.0, 1.0)
        return self.fluid.sound_speed / self.fluid.spacing * tense * near

    @ti.func
    def finish(self, i, own, total, beyond, group):
        """Advance density and pressure of particle i to the step's end by the sums `total` over neighbours of `own`;
        store its share of diffusion or, in a closed basin, its shift. `group`: row of the budget."""
        fluid, particles, rho_0 = self.fluid, self.fluid.particles, ti.static(self.fluid.rest_density)
        dt, deviation = fluid.dt[None], own[self.row.deviation]
        if ti.static(fluid.bodies):
            solid = self.solid.total(vec3(own, self.row.position), own)
            if ti.static(not fluid.shifting):  # a face that parts from water under tension draws none apart
                held = tm.clamp(1.0 + deviation / (PARTING_TENSION * rho_0), 0.0, 1.0)
                solid[self.terms.rate] += (1.0 - held) * positive(-solid[self.terms.rate])
            total += solid
            fluid.damp_crowded(i, self.filled_share(own, solid))
        # Second half step of the density; the first was made before the sort.
        compressed, diffused = total[self.terms.rate], self.diffusion * total[self.terms.diffusion]
        rate = self.prefactor(own) * (compressed + diffused)
        excess = deviation + 0.5 * dt * rate
        unleaked = excess
        if ti.static(not fluid.shifting):
            filled = self.filled_share(own, total)
            self.grade_diffusion(i, filled)
            edge = self.edge(own, total)
            thinner = self.swelling(filled, edge, deviation)
            leak = tm.max(self.leak(thinner, edge, deviation), self.tension_release(edge, deviation))
            excess -= lesser(dt * leak, 1.0) * excess
            if edge < INNER_EDGE:
                fluid.accounts.count_packing(group, thinner)
        fluid.rate[i], fluid.excess[i] = rate, excess
        particles.density[i], particles.pressure[i] = rho_0 + excess, fluid.equation_of_state(excess)
        particles.position.put(i, fluid.grid.wrap_position(vec3(own, self.row.position)))
        particles.velocity.put(i, vec3(own, self.row.velocity))
        if ti.static(fluid.shifting):
            gradient = self.prefactor(own) / rho_0 * vec3(total, self.terms.crowding)  # of the share of water [1/m]
            fluid.shift.put(i, -gradient)
        fluid.accounts.count_density(group, rho_0 + excess)
        if ti.static(fluid.accounts.impulses):
            self.book_work(i, own, compressed, diffused, group)
            p = fluid.equation_of_state(0.5 * (unleaked + excess)) / (rho_0 + unleaked) ** 2
            fluid.accounts.count_work(group, LEAK, fluid.particles.mass * p * (excess - unleaked))

    @ti.func
    def book_work(self, i, own, compressed, diffused, group):
        """Add the work [J] of compression and diffusion on particle i (values `own`) to row `group` of the budget; that
        of bulk viscosity counts as viscosity. `compressed`, `diffused`: the law's sums for both."""
        fluid, deviation = self.fluid, own[self.row.deviation]
        closer = fluid.particles.mass * fluid.dt[None] * self.prefactor(own)
        p = fluid.equation_of_state(deviation) / (fluid.rest_density + deviation) ** 2
        damped = closer * compressed * (fluid.pressing[i] - p)
        fluid.accounts.count_work(group, DIFFUSION, closer * diffused * p)
        fluid.accounts.count_work(group, PRESSURE, damped)
        fluid.accounts.count_work(group, VISCOSITY, -damped)


@in_kernels
class Shear(Law):
    """Pair law for squared spin and strain rate around each particle, averaged over time; summed every few steps."""

    row, options = Columns(position=3, velocity=3), WalkOptions(padded=True)

    def __init__(self, fluid: "DeltaSph") -> None:
        self.fluid, self.reads, self.dimension = fluid, fluid.grid.moved[: STATE_COLUMNS.id], fluid.smoothing.dimension
        self.terms = Columns(gradient=self.dimension**2)
        self.factor = -fluid.slope / fluid.rest_density  # by which the sum becomes the velocity gradient [1/s]
        self.add_bodies(fluid.boundary)

    @ti.func
    def image(self, other, mirror):
        """Position and velocity (`other`) of a neighbour, seen in matrix `mirror` of a side taken as frictionless."""
        return mirror_row_free_slip(mirror, other)

    @ti.func
    def sample(self, own, s, d, mirror):
        """Position and velocity of boundary particle s (or its image by matrix `mirror`), d [m] from particle `own`."""
        return row_at(own, d, self.boundary.mirrored_velocity(s, mirror))

    @ti.func
    def pair(self, own, other):
        """Velocity gradient by a neighbour, to be multiplied by `prefactor`; `own`, `other`: values (`row`) of both."""
        x_ij = self.fluid.smoothing.difference(own, other, self.row.position)
        v_ij = self.fluid.smoothing.difference(own, other, self.row.velocity)
        lever, total = self.fluid.smoothing.pair_gradient(x_ij), ti.Vector.zero(float, self.terms.size)
        for j, k in ti.static(ti.ndrange(self.dimension, self.dimension)):
            total[self.terms.gradient + self.dimension * j + k] = lever[j] * v_ij[k]
        return total

    @ti.func
    def finish(self, i, own, total, beyond, group):
        """Update particle i's means in time of squared spin and strain rate (equal in simple shear) by the sums `total`
        over neighbours, images included, of its values `own`."""
        fluid, both = self.fluid, self.with_bodies(total, vec3(own, self.row.position), own)
        gradient = ti.Matrix.zero(float, self.dimension, self.dimension)  # of velocity k along axis j [1/s]
        for j, k in ti.static(ti.ndrange(self.dimension, self.dimension)):
            gradient[j, k] = self.prefactor(own) * both[self.terms.gradient + self.dimension * j + k]
        spin, strain, mean = 0.0, 0.0, gradient.trace() / self.dimension
        for j, k in ti.static(ti.ndrange(self.dimension, self.dimension)):
            if ti.static(j == k):
                strain += 2.0 * (gradient[j, k] - mean) ** 2
            if ti.static(j < k):
                spin += (gradient[j, k] - gradient[k, j]) ** 2
                strain += (gradient[j, k] + gradient[k, j]) ** 2
        for k, now in ti.static(((1, spin), (2, strain))):
            fluid.fresh[k][i] = tm.mix(fluid.fresh[k][i], now, fluid.lately[None])


@in_kernels
class DeltaSph(Sph):
    """Water by delta-SPH. Between steps all fields hold at one time; particles are in the order of cells of mid-step.
    Without a free surface they are shifted to where fewer are, or they would line up along streamlines (Lind et al.
    2012, J. Comput. Phys. 231; Sun et al. 2017, CMAME 315, eq. 16)."""

    config: Config

    def __init__(self, config: Config, basin: Basin, accounts: bool, wind: Wind) -> None:
        sizes = config.list_sizes(config.lattice(basin), running_arch())
        super().__init__(config, basin, sizes, accounts, wind)
        particles, self.closed = self.particles, basin.closed
        # In mid-step: deviation [kg/m3] and (p + bulk rate) / rho^2; and the same before the sort of a step.
        self.deviation, self.pressing = self.carried[:CARRIED_NUMBERS]
        self.next_deviation, self.next_pressing = self.grid.carried[:CARRIED_NUMBERS]
        self.excess, self.rate = (staggered_field(float, particles.n) for _ in range(2))  # [kg/m3] at its end, and rate
        self.excesses = FieldCopy(self.excess)
        self.slope = particles.mass * self.smoothing.slope  # -m grad W / x_ij over its shape
        self.clamped, self.shifting = config.minimum_pressure is not None, config.is_enclosed(basin)
        if self.shifting:
            self.shift = Components(particles.n)  # [1/m] where to
        else:
            graded = self.carried[CARRIED_NUMBERS : CARRIED_NUMBERS + GRADED_NUMBERS]
            self.share, self.spin, self.strain = graded  # of diffusion, and squares [1/s2]
            self.fresh = tuple(staggered_field(float, particles.n) for _ in range(GRADED_NUMBERS))  # at its end
            self.memory = SHEAR_MEMORY * basin.depth / self.reference_speed  # [s]
            self.unseen, self.lately = 0.0, ti.field(float, shape=())  # [s] since the shear was looked at; over memory
            calm = WINDY_CALM_STRAIN if wind.blows else CALM_STRAIN
            self.calm = (calm * self.sound_speed / self.smoothing.length) ** 2  # [1/s2]
        self.per_reach = 1.0 / (NEAR_SUPPORT_SPACINGS * particles.spacing)  # [1/m]
        q = 1.0 - 1.0 / NEAR_SUPPORT_SPACINGS
        self.per_W_spacing = 1.0 / (q**4 * (5.0 - 4.0 * q))
        self.momentum, self.continuity = Momentum(self), Continuity(self)
        if not self.shifting:
            self.shear = Shear(self)
        pull, rho_0 = -self.pull.constant.y, particles.rest_density
        if pull > 0.0 and not self.closed:  # each particle lies lower by the settlement of its column
            x, p = particles.position.to_numpy().astype(float), particles.pressure.to_numpy().astype(float)
            bed = sizes.lattice.column_ends()[0]
            bed = np.append(bed, x[len(bed) :, 1])  # what has left an emitter stays
            lower = column_drop(p / rho_0, p / rho_0 + pull * (x[:, 1] - bed), pull, self.sound_speed)
            self.surface_drop = float(lower.max())
            x[:, 1] -= lower
            particles.position.from_numpy(x)
        self.begin()

    @property
    def listed_positions(self) -> tuple[ti.Field, ...]:
        """Fields x, y, z [m] of positions at the step's end, in order of the last sort, not wrapped into periods."""
        return self.grid.moved[: STATE_COLUMNS.velocity]

    def arrive(self) -> None:
        """Sort the particles after they were placed outside a step, and compute the rate of their density there."""
        self.settle(self.summary)

    def step(self, dt: float) -> None:
        """Move the particles by dt [s], compute the density's rate, and update the shear averages if they are due."""
        self.drift_kick_drift(dt, self.status.max_speed, self.wind.clock.since)
        self.find_density_rate(self.summary)
        if not self.shifting:
            self.unseen += dt
            if self.unseen > SHEAR_UPDATE_INTERVAL * self.memory:
                self.update_shear(min(1.0, self.unseen / self.memory))
                self.unseen = 0.0

    @ti.func
    def stage_particle(self, i, x, v):
        """Store position x [m], velocity v [m/s] of particle i at a step's end; particles are sorted in mid-step."""
        self.grid.stage_motion(i, x, v)

    @ti.func
    def closeness(self, r):
        """Ratio W(r) / W(spacing) of a Wendland kernel NEAR_SUPPORT_SPACINGS wide; narrower ones are unstable."""
        q = positive(1.0 - r * self.per_reach)
        return self.per_W_spacing * q * q * q * q * (5.0 - 4.0 * q)

    @ti.func
    def equation_of_state(self, excess):
        """Pressure [Pa] at an excess of density [kg/m3]: c^2 rho0 / gamma ((1 + e)^gamma - 1), without cancellation."""
        e, total = excess / self.particles.rest_density, 0.0
        for _ in ti.static(range(self.config.exponent)):
            total = 1.0 + (1.0 + e) * total
        p = self.sound_speed**2 / self.config.exponent * excess * total
        if ti.static(self.clamped):
            p = tm.max(p, self.config.minimum_pressure)
        return p

    @ti.kernel
    def settle(self, summary: Array):
        """Sort unmoved particles, find their rate of density; fill `summary` (9,) with extremes of speed, density."""
        self.dt[None] = 0.0
        for i in range(self.particles.count.there()):
            self.next_deviation[i] = self.excess_of(self.particles.pressure[i])
        self.grid.sort()
        for i in range(self.particles.count.there()):
            for k in ti.static(range(STATE_COLUMNS.id)):
                self.grid.moved[k][i] = self.grid.state[k][i]
        for group in range(self.accounts.groups):
            self.accounts.begin_motion(group)
        self.neighbours.walk(self.continuity, True)
        self.accounts.summarise(summary)

    @ti.func
    def excess_of(self, pressure):
        """Excess of density [kg/m3] at a pressure [Pa]: inverse of the equation of state."""
        gamma, rho_0 = ti.static(self.config.exponent, self.particles.rest_density)
        return rho_0 * ((1.0 + gamma * pressure / (rho_0 * self.sound_speed**2)) ** (1.0 / gamma) - 1.0)

    @ti.kernel
    def drift_kick_drift(self, dt: float, speed: float, since: float):
        """Move the particles by dt [s]: drift, sort, kick, drift. `speed` [m/s]: scale of shifts out of crowds, in a
        closed basin; `since` [s]: time since the wind's clock restarted."""
        self.dt[None] = dt
        self.wind.set_clock(since, dt)
        h = self.smoothing.length
        bulk = tm.min(BULK_VISCOSITY * self.sound_speed * h, MAX_BULK_VISCOSITY * h * h / dt)  # [m2/s]
        # First drift: half a step with the present velocity; density and damped pressure follow to mid-step.
        for i in range(self.particles.count.there()):
            x, v = self.particles.position.at(i), self.particles.velocity.at(i)
            way = 0.5 * dt * v
            if ti.static(self.shifting):
                way += dt * speed * self.smoothing.support * self.shift.at(i)
            middle = self.excess[i] + 0.5 * dt * self.rate[i]
            self.grid.stage_state(i, x + self.grid.whole_quanta(i, way), v)
            self.next_deviation[i] = middle
            pressed = self.equation_of_state(middle) + bulk * self.rate[i]
            self.next_pressing[i] = pressed / (self.particles.rest_density + middle) ** 2
            if ti.static(not self.shifting):
                for k, fresh in ti.static(enumerate(self.fresh)):
                    self.grid.carried[CARRIED_NUMBERS + k][i] = fresh[i]
        # Kick in mid-step; the momentum law also makes the second drift.
        self.grid.sort()
        self.momentum.react(dt)
        self.neighbours.walk(self.momentum, True)

    @ti.kernel
    def find_density_rate(self, summary: Array):
        """Compute the density's rate at a step's end; fill `summary` (9,) with extremes of speed, density. Its walk
        over neighbours is apart from that of `drift_kick_drift`: Taichi 1.7 compiles no kernel of both for Vulkan."""
        self.neighbours.walk(self.continuity, False)
        self.accounts.summarise(summary)

    @ti.kernel
    def update_shear(self, lately: float):
        """Update the averages of squared spin and strain rate; `lately`: weight of their present values, 0 to 1."""
        self.lately[None] = lately
        self.neighbours.walk(self.shear, False)

    def limits(self) -> Limits:
        return self.config.limits_at(self.smoothing, self.sound_speed, self.max_speed, self.status.max_acceleration)

    def internal_energy(self) -> float:
        """Energy of compression [J]: m times the integral of p / rho^2; raise Diverged if a density is not positive."""
        gamma = self.config.exponent
        ratio = 1.0 + self.excesses.values().astype(float) / self.particles.rest_density
        if not ratio.min() > 0.0:
            least = self.particles.rest_density * ratio.min()
            raise Diverged(f"density fell to {least:.4g} kg/m^3; it must stay above 0; try a shorter time step")
        powers = np.log(ratio) if gamma == 1 else (ratio ** (gamma - 1) - 1.0) / (gamma - 1)
        return self.particles.mass * self.sound_speed**2 / gamma * float((powers + 1.0 / ratio - 1.0).sum())
