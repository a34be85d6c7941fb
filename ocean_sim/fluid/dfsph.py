"""Incompressible water: Bender & Koschier, "Divergence-free smoothed particle hydrodynamics" (SCA 2015; TVCG 23, 2017).

Twice a step pressures are sought: those under which the velocity does not compress the water (divergence), and those
under which the particles arrive at its rest density (density). Each solver iterates, for the pressures p,

    r = (density predicted with p) - rest density,   r <= 0,   r = 0 where p > 0

by relaxed Jacobi steps p = max(p + omega r / A_ii, 0) (their kappa is p / density), carried on along the way of the
last ones (Nesterov 1983) unless that leads uphill (O'Donoghue & Candes 2015, Found. Comput. Math. 15). An iteration
reads the kept pairs twice. The pressures of a step are where the next begins; iterations go on until the error is
within its tolerance and, in calm water and in brief steps, half of its first value, so that it comes to rest; in water
that breaks that would be half of the work, and changes nothing that is seen.

Where there is a free surface both pressures are forces, and never negative: with them the step is symplectic (it is
SHAKE; Leimkuhler & Skeel 1994, J. Comput. Phys. 112), and still water stays still. A gap inside the water may close
again, at GAP of its size a step. Where there is none pressures have either sign, particles are shifted along the
gradient of their number (Lind et al. 2012, J. Comput. Phys. 231), and the density's pressures only displace them
(Cornelis et al. 2019, Visual Computer 35). So they do before a run, where bodies lie off the lattice (make_room).

A known weakness: once its lattice has given way, the pressures of single particles scatter in water that hardly moves.
A lattice gives way where it is not elastically stable under the kernel.
"""

from collections.abc import Iterator
from math import sqrt
from typing import ClassVar, Literal

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.columns import Columns, vec3
from ocean_sim.fluid import Limits
from ocean_sim.fluid.budget import momentum_budget as budget
from ocean_sim.fluid.neighbours.thread_tasks import Rows
from ocean_sim.fluid.patch.attenuation import Attenuation, Delay
from ocean_sim.fluid.sph.law import Law, WalkOptions
from ocean_sim.fluid.sph.pair_sph import Force
from ocean_sim.fluid.sph.particles import Components, staggered_field
from ocean_sim.fluid.sph.pressure_solver import REPORT_SIZE, TOO_DENSE, UPHILL_SLOPE, Solver
from ocean_sim.fluid.sph.smoothing import Stencil
from ocean_sim.fluid.sph.sph import Sph, SphConfig, scheme_ledger, step_limits
from ocean_sim.kernel_library import ti, tm
from ocean_sim.model import quantity
from ocean_sim.parts import LedgerRow, SceneFacts
from ocean_sim.runtime import Array, Template, in_kernels, running_arch
from ocean_sim.wind import Wind

FORCE_ROW = Columns(position=3, velocity=3, pressure=1)  # read of a particle
CALM_ERRORS = {"density": 0.1, "divergence": 0.003}  # [tolerances] errors below which water counts as calm
BRIEF_STEP = 0.1  # [smoothing length over reference speed]; in shorter steps calm water compresses itself less
MIN_LIMIT_SPEED = 2.0  # [reference speeds] least speed by which the next step is chosen, see `limits`
CALM_RMS_SPEED = 0.3  # [reference speeds] root mean square speed about the mean up to which water is calm
MIN_STEADY_SUPPORT = (3.0, 3.5)  # [spacings] support below which water at rest stirs, in 2-D and in 3-D
MIN_DIAGONAL_SHARE = 0.05  # least A_ii over its value on the lattice; keeps coincident particles finite
MAX_ROOM_STEPS, ROOM_TOLERANCE = 20, 1.0e-6  # times that particles make room before a run, and mean error of each
GAP_CLOSING_SHARE = 0.1  # least share of a gap's missing density that closes in a step; wider gaps close faster


class Config(SphConfig):
    """Incompressible water, for large time steps."""

    bears_shear: ClassVar[float] = 3.0e-3
    fineness: ClassVar[int] = 2
    misread: ClassVar[str] = "dfsph finds its pressures step by step: those that gauges read at 0 s are no measurements"
    attenuation: ClassVar = Attenuation(4.0e-4, 4.0e-3, 1.0e-2, travelling=Attenuation(4.0e-4, steep=8.0e-2))
    """Besides the artificial viscosity."""
    delay: ClassVar = Delay(0.2)
    unheeded: ClassVar[tuple[str, ...]] = ("compression",)
    told_to_bodies: ClassVar[int] = 0
    counts_in_doubles: ClassVar[bool] = True
    kind: Literal["dfsph"] = "dfsph"
    support_ratio: float | None = quantity("spacings", None, ge=1.2, le=6.0)
    """Kernel support radius over the spacing; by default 4.0."""
    minimum_pressure: float | None = quantity("Pa", 0.0, ge=0.0, le=0.0)
    """Zero: water with a free surface has no negative pressures."""
    artificial_viscosity: float = quantity("1", 0.01, ge=0.0)
    """alpha: in water with a free surface, alpha times reference_speed times 0.4 of the kernel support radius is
    added to the viscosity."""
    density_tolerance: float = quantity("1", 5.0e-4, gt=0.0)
    """Mean error of the density that a step may end with, over the rest density; calm water ends with less."""
    divergence_tolerance: float = quantity("1", 1.0e-3, gt=0.0)
    """Mean compression in a step that the velocity may end with, over the rest density; calm water ends with less."""
    max_density_iterations: int = quantity("1", 100, ge=0)
    """The most iterations for the density; steps that would need more are counted."""
    max_divergence_iterations: int = quantity("1", 100, ge=0)
    """The most iterations for the divergence; steps that would need more are counted."""

    def viscosity(self, basin: Basin) -> float:
        """Kinematic viscosity [m2/s], the artificial one included under a free surface."""
        h = self.smoothing(basin).length
        artificial = 0.0 if self.is_enclosed(basin) else self.artificial_viscosity * h * self.speed(basin)
        return self.kinematic_viscosity + artificial

    def viscosity_added(
        self, preflight: SceneFacts, length: float, height: float = 0.0, standing: bool = False
    ) -> float:
        """Numerical plus artificial viscosity [m2/s] for waves of a length and height [m], `standing` or not."""
        artificial = self.viscosity(preflight.tank) - self.kinematic_viscosity
        return artificial + super().viscosity_added(preflight, length, height, standing)

    def limits_at(self, basin: Basin, speed: float, acceleration: float) -> Limits:
        """Time step limits at this speed [m/s], at least 2 reference speeds (neighbours under a pressure p oscillate at
        sqrt(p / density) / spacing), and acceleration [m/s2]. Pairs relax at up to twice the viscous rate."""
        speed = max(speed, MIN_LIMIT_SPEED * self.speed(basin))
        return step_limits(self.smoothing(basin), 0.0, 2.0 * self.viscosity(basin), speed, acceleration)

    def still_limits(self, preflight: SceneFacts) -> Limits:
        basin = preflight.tank
        return self.limits_at(basin, 0.0, float(np.linalg.norm(np.add(basin.gravity, self.body_force))))

    def warnings(self, preflight: SceneFacts) -> Iterator[str]:
        yield from super().warnings(preflight)
        basin, ratio = preflight.tank, self.ratio(preflight.tank)
        if ratio < MIN_STEADY_SUPPORT[basin.dimension - 2] and not self.is_enclosed(basin):
            opening = f"at a support of {ratio:g} spacings still water of dfsph stirs,"
            middle = "and below 2.5 it sinks and may burst: ten rows of it lost 16 % of their depth"
            yield f"{opening} {middle} in 2 s at 1.2 spacings, 2 % at 2; take 4, its default"

    def statements(self, preflight: SceneFacts) -> Iterator[str]:
        yield from super().statements(preflight)
        yield "water that flies freely goes too far by the time step over the time of its fall (first order)"

    def neighbours_kept(self, basin: Basin) -> int:
        """Number of neighbours of a particle on the lattice: that many pairs are stored per particle during a step."""
        return Stencil(self.smoothing(basin), self.lattice(basin).spacing).neighbours

    def ledger(self, preflight: SceneFacts) -> list[LedgerRow]:
        basin, word = preflight.tank, preflight.word
        what = "position, velocity, density, pressure, number; predicted velocity, way and two solvers' fields"
        sizes = self.list_size(self.start_lattice(preflight), preflight.arch, FORCE_ROW.size, 1)
        neighbours = self.neighbours_kept(basin)
        numbers = 27 + self.is_enclosed(basin)
        if preflight.sums_impulses:
            numbers += 3 * len(budget.impulse_terms(budget.absent_terms(basin)))
        kept = sizes.plan.pair_bytes(sizes, neighbours, word)
        pairs = LedgerRow("fluid", "pairs", kept, f"{neighbours} neighbours on the lattice")
        return [*scheme_ledger(preflight, sizes, numbers, what), pairs]

    def build(self, basin: Basin, seed: int, *, accounts: bool, wind: Wind) -> "Dfsph":
        return Dfsph(self, basin, accounts, wind)


@in_kernels
class Density(Law):
    """Pair law for (a) the density sum, (b) its rise allowed in a step where water is too thin (a gap), (c) the
    diagonal A_ii / dt^2 (1 / alpha of Bender & Koschier 2015, eq. 9), raised in crowds lest Jacobi steps overshoot."""

    terms, options = Columns(density=1, gradient=3, squares=1), WalkOptions(apart=True, padded=True)

    def __init__(self, fluid: "Dfsph") -> None:
        self.fluid = fluid
        self.reads = tuple(fluid.particles.position)
        stencil, m = fluid.stencil, fluid.particles.mass
        self.slope, self.square = -stencil.slope, stencil.slope**2
        self.mass = m * stencil.slope * fluid.smoothing.support**2
        self.diagonal_scale, self.least = m * fluid.weight, MIN_DIAGONAL_SHARE * stencil.gradient_squares
        self.volume, self.top_deficit = stencil.volume, stencil.top_deficit
        self.add_bodies(fluid.boundary)

    @ti.func
    def begin(self, group):
        self.fluid.accounts.begin_density(group)
        self.fluid.rows.clear(group)

    @ti.func
    def pair(self, own, other):
        """W, grad W, |grad W|^2 (`terms`) of a neighbour, without constants; `own`, `other`: positions of both [m]."""
        x_ij = own - other
        r2 = x_ij.dot(x_ij)
        r, smoothing = ti.sqrt(r2), self.fluid.smoothing
        w = smoothing.shape_gradient(r)
        return ti.Vector([smoothing.shape_value(r), w * x_ij[0], w * x_ij[1], w * x_ij[2], w * w * r2])

    @ti.func
    def finish(self, i, own, total, beyond, group):
        """Store of particle i at `own` [m], by sums `total` over particles, `beyond` over images: density, A_ii / dt^2,
        rise of density allowed to close a gap or, without a surface, shift from crowds. `group`: row of the budget."""
        fluid, rest = self.fluid, ti.static(self.fluid.particles.rest_density)
        total += beyond
        if ti.static(fluid.bodies):
            solid = self.solid.total(own, own)
            solid[self.terms.squares] = 0.0  # no pressure moves a body
            total += solid
        # A_ii over dt^2: the squared sum of gradients and the sum of squared gradients.
        gradient = self.slope * vec3(total, self.terms.gradient)
        rho = self.mass * total[self.terms.density]
        squares = gradient.dot(gradient) + self.square * total[self.terms.squares]
        gradient *= self.volume  # of the share of water
        fluid.particles.density[i], fluid.particles.pressure[i] = rho, fluid.held_pressure[i]
        fluid.diagonal[i] = self.diagonal_scale * tm.max(rho / rest, 1.0) * tm.max(squares, self.least)
        fluid.rows.add(group, TOO_DENSE, rho)
        if ti.static(fluid.closed):
            fluid.shift.put(i, -gradient)
        else:
            gap = tm.max(1.0 - rho / rest - self.top_deficit * gradient.norm(), 0.0)
            fluid.closing[i] = rest * gap * tm.max(gap, GAP_CLOSING_SHARE)
        fluid.accounts.count_density(group, rho)


@in_kernels
class Forces(Force):
    """Pair law for all forces, those by last step's pressures among them: the divergence solver starts from these."""

    fluid: "Dfsph"
    row = FORCE_ROW

    def __init__(self, fluid: "Dfsph", viscosity: float) -> None:
        self.viscous = viscosity > 0.0
        self.reads = (*fluid.particles.position, *fluid.particles.velocity, fluid.held_pressure)
        further = ({"rub": 3} if self.viscous else {}) | ({"filled": 1} if fluid.rubs else {})
        self.terms = Columns(push=3, **further)
        # Of the pressure sum: m / rho0^2 times the constant of grad W, over `Stencil.gain`.
        self.factor = fluid.pressing
        self.rubbing = 2.0 * viscosity * fluid.stencil.volume * fluid.stencil.slope / fluid.stencil.gain
        self.per_component = fluid.smoothing.dimension + 2.0  # of the central form over that of one component
        self.squared_gap = 1e-6 * fluid.smoothing.support**2  # [m2] keeps two particles in one position finite
        super().__init__(fluid)

    @ti.func
    def sample(self, own, s, d, mirror):
        """Values (`row`) to use in `pair` for boundary particle s (or its image by matrix `mirror`), d [m] from the
        particle with values `own`: a velocity for friction, and pressure 0 (Bender & Koschier 2017, sect. 5)."""
        other = self.rubbing_sample(own, s, d, mirror)
        other[self.row.pressure] = 0.0
        return other

    @ti.func
    def acceleration(self, own, total):
        a = self.prefactor(own) * vec3(total, self.terms.push)
        if ti.static(self.viscous):
            a += self.rubbing * vec3(total, self.terms.rub)
        return a

    @ti.func
    def pressure(self, p_i, p_j, gradient):
        """Pressure force of a pair, -(p_i + p_j) grad W (Bender & Koschier 2017, eq. 3); `gradient` is -grad W."""
        return (p_i + p_j) * gradient

    @ti.func
    def viscosity(self, v_ij, x_ij, r2, gradient):
        """Viscous deceleration over 2 nu V (V: volume): -(d + 2) v_ij . x_ij / r^2 grad W (Monaghan & Gingold 1983);
        `r2`: r^2 [m2]; `gradient`: -grad W over its constant `slope`."""
        return self.per_component * v_ij.dot(x_ij) / (r2 + self.squared_gap) * gradient

    @ti.func
    def viscosity_without_surface(self, v_ij, r2):
        """Viscous deceleration as in `viscosity`, without free surface: -v_ij W' / r (Morris et al. 1997, eq. 22)."""
        return self.fluid.smoothing.shape_gradient(ti.sqrt(r2)) * v_ij

    @ti.func
    def pair(self, own, other):
        x_ij, smoothing = vec3(own, self.row.position) - vec3(other, self.row.position), self.fluid.smoothing
        gradient, total = smoothing.pair_gradient(x_ij), ti.Vector.zero(float, self.terms.size)
        push = self.pressure(own[self.row.pressure], other[self.row.pressure], gradient)
        for k in ti.static(range(3)):
            total[self.terms.push + k] = push[k]
        if ti.static(self.viscous):
            v_ij, r2 = vec3(own, self.row.velocity) - vec3(other, self.row.velocity), x_ij.dot(x_ij)
            rub = self.viscosity(v_ij, x_ij, r2, gradient)
            if ti.static(self.fluid.closed):
                rub = self.viscosity_without_surface(v_ij, r2)
            for k in ti.static(range(3)):
                total[self.terms.rub + k] = -rub[k]
        if ti.static(self.fluid.rubs):
            total[self.terms.filled] = gradient.dot(x_ij)
        return total

    @ti.func
    def finish(self, i, own, total, beyond, group):
        """Predict particle i's velocity, where the divergence solver starts, by sums `total`, `beyond` (of images)."""
        fluid = self.fluid
        dt, x, v = fluid.dt[None], vec3(own, self.row.position), fluid.particles.velocity.at(i)
        beyond = self.with_bodies(beyond, x, own)
        for change in ti.static(fluid.changes):
            for component in ti.static(change):
                component[i] = 0.0
        # Forces that do not depend on the new velocity.
        a_wind, a_pull, a_hull = fluid.wind_acceleration(i, x, v), fluid.pull.at(x, v), fluid.hull_push(x, 0.0)
        a = a_wind + a_pull + a_hull
        v_new = v + fluid.change_velocity(i, budget.WIND, dt * a_wind)
        v_new += fluid.change_velocity(i, budget.GRAVITY, dt * a_pull)
        v_new += fluid.change_velocity(i, budget.SHIP, dt * a_hull)
        if ti.static(self.viscous):
            rub, rub_walls = vec3(total, self.terms.rub), vec3(beyond, self.terms.rub)
            v_new += fluid.change_velocity(i, budget.VISCOSITY, dt * self.rubbing * rub)
            v_new += fluid.change_velocity(i, budget.WALLS, dt * self.rubbing * rub_walls)
            a += self.rubbing * (rub + rub_walls)
        v_new += fluid.apply_pressures(i, dt, vec3(total, self.terms.push), vec3(beyond, self.terms.push))
        # What follows slows the water: not the fall of a step, which pressure holds up.
        if ti.static(fluid.rubs):
            a_bed = fluid.bed.push(x, v_new, dt, total[self.terms.filled], beyond[self.terms.filled])
            v_new += fluid.change_velocity(i, budget.BED, dt * a_bed)
            a += a_bed
        if ti.static(fluid.joined):
            a_sea = fluid.rim.acceleration(x, v_new, dt)
            v_new += fluid.change_velocity(i, budget.SEA, dt * a_sea)
            a += a_sea
        v_new += fluid.change_velocity(i, budget.WALLS, fluid.walls.relax(x, v_new, dt) - v_new)
        for k, component in ti.static(enumerate(fluid.predicted)):
            component[i] = fluid.base[k][i] = v_new[k]
        fluid.divergence.begin(i)
        fluid.accounts.count_motion(group, v, a, 0)


@in_kernels
class Dfsph(Sph):
    """Incompressible water by DFSPH. Between steps particles are sorted, with density and pressure current. Sound does
    not limit its steps; `sound_speed` is that of weakly compressible water with the same `compression`."""

    config: Config

    def __init__(self, config: Config, basin: Basin, accounts: bool, wind: Wind) -> None:
        sizes = config.list_size(config.lattice(basin), running_arch(), FORCE_ROW.size, 1)
        super().__init__(config, basin, sizes, accounts, wind)
        particles, n = self.particles, self.particles.n
        self.basin, self.closed = basin, config.is_enclosed(basin)
        side = (particles.mass / particles.rest_density) ** (1.0 / basin.dimension)
        self.stencil = Stencil(self.smoothing, side)
        self.weight = particles.mass / (self.stencil.gain * particles.rest_density**2)  # of p_i + p_j in acceleration
        self.pressing = self.weight * self.stencil.slope  # the same over x_ij times the shape of grad W
        self.predicted, self.way = Components(n), Components(n)  # velocity at the end of the step; way over dt [m/s]
        self.base = tuple(Components(n))  # [m/s] before what the pressures gain
        self.pairs = self.neighbours.keep_pairs(self.smoothing, self.stencil.neighbours, self.tasks)
        self.held_pressure = self.carried[0]  # [Pa]
        if self.closed:
            self.shift = Components(n)  # [1/m] where to
        else:
            self.closing = staggered_field(float, n)  # what a gap may gain in density in a step [kg/m3]
            self.rate = staggered_field(float, n)  # what the velocities that are left compress, a sum over pairs
        self.diagonal = staggered_field(float, n)  # A_ii / dt^2
        kept = self.accounts.impulse_terms if self.accounts.impulses else ()
        # Of the velocity by each term in this step [m/s]: its work takes the velocity that the step ends with.
        self.changes = tuple(tuple(Components(n)) if term in kept else () for term in range(len(budget.TERM_NAMES)))
        self.momentum, self.level = (ti.field(float, shape=()) for _ in range(2))  # how far an iteration is carried
        self.level[None] = particles.rest_density  # on; density that is sought [kg/m3]
        self.rows = Rows(self.accounts.groups, REPORT_SIZE)  # what groups of particles report
        calm, brief = CALM_ERRORS["divergence"], BRIEF_STEP * self.smoothing.length / self.reference_speed
        if self.closed:
            calm, brief = 1.0, 0.0  # without a surface less would damp the flow
        options = config.divergence_tolerance, config.max_divergence_iterations, calm
        self.divergence = Solver(self, self.predicted, *options, self.held_pressure, brief)
        options = config.density_tolerance, config.max_density_iterations, CALM_ERRORS["density"]
        self.incompressible = Solver(self, self.way, *options)
        self.solvers = {"density": self.incompressible, "divergence": self.divergence}
        self.density, self.forces = Density(self), Forces(self, config.viscosity(basin))
        self.report: np.ndarray = np.zeros(REPORT_SIZE, dtype=particles.position.precision)
        self.begin()
        if (basin.config.obstacles or basin.afloat) and not self.closed:
            self.make_room()

    def begin(self) -> None:
        """Start from the present positions and velocities, with zero pressures."""
        self.held_pressure.fill(0.0)
        super().begin()

    def make_room(self) -> None:
        """Spread out crowded particles near solid bodies before the run, since a short first step would throw them."""
        self.dt[None] = 2.0**-20  # [s] so brief that no body moves; beside that only the way counts
        for _ in range(MAX_ROOM_STEPS):
            if self.status.max_density <= (1.0 + self.config.density_tolerance) * self.particles.rest_density:
                break
            self.predict_density(0.0, self.report)
            self.iterate_to(self.incompressible, ROOM_TOLERANCE)
            self.displace_all()
            self.arrive()
            self.status = self.accounts.status(self.summary, self.grid)

    def arrive(self) -> None:
        self.settle(self.summary, self.report)
        if self.closed:
            self.level[None] = self.report[TOO_DENSE] / self.particles.count.now

    def step(self, dt: float) -> None:
        """Predict velocities, solve for divergence, then for density, move the particles, and update their fields."""
        total, n = self.totals(), self.particles.count.now
        stirred = total.squared_speed - total.velocity @ total.velocity / n  # about their mean velocity
        calm = stirred < n * (CALM_RMS_SPEED * self.reference_speed) ** 2
        self.predict(dt, self.wind.clock.since, self.report)
        self.solve(self.divergence, dt, calm)
        self.predict_density(self.status.max_speed, self.report)
        self.solve(self.incompressible, dt, calm)
        self.displace_and_react()
        self.arrive()

    def solve(self, solver: Solver, dt: float, calm: bool) -> None:
        """Iterate `solver` until its mean density error meets its goal (lower in `calm` water) or iterations end."""
        solver.record_step(*self.iterate_to(solver, solver.error_goal(self.error, dt, calm)))
        if self.accounts.impulses and solver.forces:
            self.book_pressures(solver)

    def iterate_to(self, solver: Solver, enough: float) -> tuple[int, float]:
        """Iterate a solver until the mean error is at most `enough`; return the number of iterations and that error."""
        done, along = 0, 1.0
        while not self.error <= enough and done < solver.most:
            if self.report[UPHILL_SLOPE] > 0.0:
                along = 1.0
            ahead = 0.5 + sqrt(0.25 + along * along)
            self.iterate(solver, (along - 1.0) / ahead, self.report)
            done, along = done + 1, ahead
        return done, self.error

    @property
    def error(self) -> float:
        """Mean density error relative to the rest density: the larger of those of too dense and too thin ones."""
        scale = 1.0 / (self.particles.count.now * self.particles.rest_density)
        return scale * float(self.report[:UPHILL_SLOPE].max())

    @ti.kernel
    def predict(self, dt: float, since: float, report: Array):
        """Predict velocities after dt [s]; fill `report` (3,) with sums of density errors (TOO_DENSE, TOO_THIN) and
        UPHILL_SLOPE. `since` [s]: time, at the step's end, since the wind's clock restarted."""
        self.dt[None], self.momentum[None] = dt, 0.0
        self.wind.set_clock(since, dt)
        self.neighbours.walk(self.forces, False)
        self.pairs.walk(self.divergence.compression)
        self.rows.sum_into(report)

    @ti.kernel
    def iterate(self, solver: Template, momentum: float, report: Array):
        """Run one iteration of a solver; fill `report` as `predict` does; `momentum`: factor of Nesterov's method."""
        self.momentum[None] = momentum
        self.pairs.walk(solver.push)
        self.pairs.walk(solver.compression)
        self.rows.sum_into(report)

    @ti.kernel
    def book_pressures(self, solver: Template):
        """Add the impulses of the pressures that a solver has computed to the momentum budget."""
        self.pairs.walk(solver.account)

    @ti.kernel
    def predict_density(self, speed: float, report: Array):
        """Predict densities after a step; fill `report` as `predict`. `speed` [m/s]: scales shifts in closed basins."""
        self.momentum[None] = 0.0
        for i in range(self.particles.count.there()):
            self.incompressible.begin(i)
            for way, predicted in ti.static(zip(self.way, self.predicted)):
                way[i] = predicted[i]
            if ti.static(self.closed):
                for way, shift in ti.static(zip(self.way, self.shift)):
                    way[i] = way[i] + speed * self.smoothing.support * shift[i]
            for base, way in ti.static(zip(self.base, self.way)):
                base[i] = way[i]
        if ti.static(self.closed):
            self.pairs.walk(self.incompressible.compression)
        else:
            for t in range(self.tasks.iterations):
                if t % self.tasks.stride == 0:  # by the compression that the divergence solver has left
                    group = t // self.tasks.stride
                    self.incompressible.compression.begin(group)
                    for i in range(self.tasks.first_particle(group), self.tasks.first_particle(group + 1)):
                        self.incompressible.compression.judge_particle(i, self.rate[i], group)
        self.rows.sum_into(report)

    @ti.kernel
    def displace_and_react(self):
        """Move the particles, store new velocities and pressures, and sum the forces on solid bodies."""
        for i in range(self.particles.count.there()):
            self.held_pressure[i] = self.held_pressure[i] + self.divergence.gain[i]
            if ti.static(not self.closed):
                self.held_pressure[i] = self.held_pressure[i] + self.incompressible.gain[i]
        self.forces.react(self.dt[None])
        for t in range(self.tasks.iterations):
            if t % self.tasks.stride == 0:
                group = t // self.tasks.stride
                for i in range(self.tasks.first_particle(group), self.tasks.first_particle(group + 1)):
                    self.displace(i, self.dt[None], group)

    @ti.kernel
    def displace_all(self):
        """Move all particles by dt times `way`, a move over dt [m/s], but not into walls; velocities do not change."""
        for i in range(self.particles.count.there()):
            v, way = self.particles.velocity.at(i), self.way.at(i)
            x, _ = self.landing(i, self.dt[None] * way, v)
            self.stage_particle(i, x, v)

    @ti.func
    def landing(self, i, way, u):
        """Position [m] and velocity [m/s] of particle i after a move by `way` [m] at velocity u and any bounce."""
        return self.walls.bounce(self.particles.position.at(i) + self.grid.whole_quanta(i, way), u)

    @ti.func
    def displace(self, i, dt, group):
        """Move particle i for dt [s] within walls and `motion_limit`; add impulses to row `group` of the budget."""
        way = self.way.at(i)
        u = way
        if ti.static(self.closed):
            u = self.predicted.at(i)
        held, fast = self.walls.limit_motion(way, dt)
        x, v = self.landing(i, dt * held, u)
        self.change_velocity(i, budget.WALLS, v - u)
        mean = 0.5 * (self.particles.velocity.at(i) + v)
        for term, change in ti.static(enumerate(self.changes)):
            if ti.static(len(change) > 0):
                impulse = self.particles.mass * tm.vec3([component[i] for component in ti.static(change)])
                self.accounts.count_impulse(group, term, impulse, mean)
        self.stage_particle(i, x, v)
        self.accounts.count_motion(group, v, tm.vec3(0.0), fast)

    @ti.kernel
    def settle(self, summary: Array, report: Array):
        """Sort the particles after a move, compute densities; fill `summary` (9,) with extremes of speed, density
        (Accounts.summarise), `report` (3,) with the sum of densities (at TOO_DENSE)."""
        self.grid.sort()
        self.neighbours.walk(self.density, True)
        self.rows.sum_into(report)
        self.accounts.summarise(summary)

    @ti.func
    def admissible_pressure(self, pressure):
        """Nearest pressure [Pa] that the water can bear: not negative if it has a free surface."""
        p = pressure
        if ti.static(not self.closed):
            p = tm.max(p, 0.0)
        return p

    @ti.func
    def apply_pressures(self, i, dt, total, beyond):
        """Record and return change of velocity [m/s] of i in dt [s] by pressure sums `total`, `beyond` (of walls)."""
        scale = dt * self.pressing
        by_walls = self.change_velocity(i, budget.WALLS, scale * beyond)
        return self.change_velocity(i, budget.PRESSURE, scale * total) + by_walls

    @ti.func
    def change_velocity(self, i, term: Template, change):
        """Record a change of velocity [m/s] of particle i by a force term, for the budget; return the change."""
        for k, component in ti.static(enumerate(self.changes[term])):
            component[i] = component[i] + change[k]
        return change

    def limits(self) -> Limits:
        """Limits of the next step, by the acceleration of all forces but pressure."""
        return self.config.limits_at(self.basin, self.max_speed, self.status.max_acceleration)
