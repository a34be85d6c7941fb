"""Pair laws that push particles; and, for schemes whose pressure is known before a step moves the particles, all parts
but the pair terms and, where the density is a sum, the whole step."""

from abc import abstractmethod
from typing import TYPE_CHECKING, Any, ClassVar

from ocean_sim.columns import Columns, vec3
from ocean_sim.fluid.budget.momentum_budget import BED, GRAVITY, PRESSURE, SEA, SHIP, VISCOSITY, WALLS, WIND
from ocean_sim.fluid.neighbours.images import hydrostatic_offset, mirror_midpoint, mirror_row, row_at
from ocean_sim.fluid.sph.law import Law, WalkOptions
from ocean_sim.fluid.sph.sph import Sph
from ocean_sim.kernel_library import ti, tm
from ocean_sim.runtime import Array, Template, in_kernels

if TYPE_CHECKING:  # it is imported only where there are bodies
    from ocean_sim.fluid.bodies.boundary import Reaction


@in_kernels
class Force(Law):
    """Base class of pair laws that push particles. A subclass defines `row`, the columns read of a particle (position,
    velocity, pressure first), and `terms`, the columns of its sums: `push` (forces), `rub` (friction, if summed apart)
    and `filled` (over a rough bed, a sum that is less where the lowest layer has gaps: see Bed.push)."""

    stores_pressure_work: ClassVar[bool] = False
    """True if the work of pressure on images and bodies becomes internal energy of the water, not work of walls."""
    reaction: "Reaction"

    def __init__(self, fluid: Sph) -> None:
        """Attach the law to its water, bodies included, once `reads` (fields of `row`) and `terms` (sums) are set."""
        self.fluid = fluid
        self.options = WalkOptions(apart=fluid.accounts.impulses, padded=True)
        self.told = (*self.reads, *fluid.last_acceleration)  # what solid bodies read of a particle
        self.add_bodies(fluid.boundary)
        if fluid.boundary is not None:
            from ocean_sim.fluid.bodies.boundary import Reaction

            forces = (self.acceleration, self.wall_acceleration)
            self.reaction = Reaction(fluid.boundary, self, self.told, forces)

    @abstractmethod
    def acceleration(self, own: Any, total: Any) -> Any:
        """Acceleration [m/s2] of a particle with field values `own`, from the law's sum `total`."""

    @ti.func
    def wall_acceleration(self, own, total):
        """Part of the acceleration [m/s2], by sums `total` over images or bodies, whose work is counted as work of
        walls: friction alone if `stores_pressure_work`, else all. `own`: field values of the particle."""
        a = self.acceleration(own, total)
        if ti.static(self.stores_pressure_work):
            a = self.prefactor(own) * vec3(total, self.terms.rub)
        return a

    @ti.func
    def pressure_rise(self, head):
        """Rise of the column `pressure` for a rise `head` [m2/s2] of p / rho: in its unit, here [Pa]."""
        return self.fluid.rest_density * head

    @ti.func
    def begin(self, group):
        """Reset the largest speed and acceleration of the particles of task `group` (a thread's share)."""
        self.fluid.accounts.begin_motion(group)

    @ti.func
    def image(self, other, mirror):
        """Field values of the image of neighbour `other` by matrix `mirror`: velocity reversed as the side's slip
        demands, pressure changed by the hydrostatic difference between neighbour and image."""
        x, image = vec3(other, self.row.position), mirror_row(mirror, other)
        pull = self.fluid.pull.at_rest(mirror_midpoint(mirror, x))
        image[self.row.pressure] += self.pressure_rise(hydrostatic_offset(mirror, x, pull))
        return image

    @ti.func
    def rubbing_sample(self, own, s, d, mirror):
        """Field values to use for boundary particle s, d [m] away (or its image by matrix `mirror`): those of the
        particle, `own`, moved by d, with the body's velocity for friction: 2 v_body - v, on a free-slip body v."""
        return row_at(own, d, self.boundary.rubbing_velocity(vec3(own, self.row.velocity), s, mirror))

    @ti.func
    def react(self, dt):
        """Sum the forces of the water on solid bodies over dt [s]; call it at a kernel's top level."""
        if ti.static(self.fluid.bodies):
            self.boundary.react(self.reaction, dt)


@in_kernels
class MomentumLaw(Force):
    """Momentum equation of a particle (thesis eq. 2.25). A scheme sets (a) `row` and `reads`: position, velocity and
    pressure, or a multiple of it that its forces need, such as p / rho^2; (b) `pair`: the forces of a neighbour, put in
    columns by `row_of_terms`; (c) `prefactor` of their sum; (d) `pressure_rise`, in the unit of (a)."""

    drifted: ClassVar[float] = 0.0
    """Part of a step that the particles have gone before they are pushed; with their new velocity they go the rest."""

    def __init__(self, fluid: Sph) -> None:
        self.sheared = fluid.bodies and fluid.kinematic_viscosity > 0.0
        further = ({"shear": 3} if self.sheared else {}) | ({"filled": 1} if fluid.rubs else {})
        self.terms = Columns(push=3, rub=3, **further) if fluid.accounts.impulses else Columns(push=3, **further)
        super().__init__(fluid)

    @ti.func
    def row_of_terms(self, weight, push, rub, shear, x_ij):
        """Vector of sums (`terms`) for a neighbour at x_ij [m]: `weight` (shape of grad W, in mueller times volume)
        times `push` (pressure), `rub` (all friction), `shear` (viscous part); by `prefactor`, accelerations [m/s2]."""
        total = ti.Vector.zero(float, self.terms.size)
        if ti.static(self.fluid.rubs):
            total[self.terms.filled] = self.fluid.smoothing.pair_gradient(x_ij).dot(x_ij)
        for k in ti.static(range(3)):
            if ti.static(self.options.apart):
                total[self.terms.push + k], total[self.terms.rub + k] = weight * push[k], weight * rub[k]
            else:
                total[self.terms.push + k] = weight * (push[k] + rub[k])
            if ti.static(self.sheared):
                total[self.terms.shear + k] = weight * shear[k]
        return total

    @ti.func
    def continued_sample(self, own, s, d, mirror):
        """Field values to use for boundary particle s, d [m] from a particle of values `own`, or its image by matrix
        `mirror`: the pressure is that of `own` plus its rise over d (Boundary.head)."""
        other = self.rubbing_sample(own, s, d, mirror)
        a = tm.vec3([own[self.row.size + k] for k in ti.static(range(3))])
        head = self.boundary.head(vec3(own, self.row.position), a, s, d, mirror)
        other[self.row.pressure] = own[self.row.pressure] + self.pressure_rise(head)
        return other

    @ti.func
    def sample(self, own, s, d, mirror):
        return self.continued_sample(own, s, d, mirror)

    @ti.func
    def acceleration(self, own, total):
        both = vec3(total, self.terms.push)
        if ti.static(self.options.apart):
            both += vec3(total, self.terms.rub)
        return self.prefactor(own) * both

    @ti.func
    def finish(self, i, own, total, beyond, group):
        """Accelerate particle i by all forces (thesis eq. 2.25), move it, stop it at walls; add impulse and work to row
        `group` of the budget. `own`: its values; `total`, `beyond`: sums over neighbours and over images."""
        fluid, dt = self.fluid, self.fluid.dt[None]
        x, v = vec3(own, self.row.position), vec3(own, self.row.velocity)
        if ti.static(fluid.bodies):
            beyond += self.solid.total(x, ti.Vector([field[i] for field in ti.static(self.told)]))
        a, parts = self.kick(i, own, total, beyond, dt)
        if ti.static(fluid.bodies):
            self.remember_acceleration(i, own, total, beyond, parts)
        x_free, x_new, v_new, fast = self.constrain(i, x, v + dt * a, dt)
        fluid.stage_particle(i, x_new, v_new)
        fluid.accounts.count_motion(group, v_new, a, fast)
        if ti.static(fluid.accounts.impulses):
            self.book_step(group, own, total, beyond, a, parts, x_free, x_new, v_new, dt)

    @ti.func
    def kick(self, i, own, total, beyond, dt):
        """Acceleration [m/s2] of particle i over dt [s] and tuple of its parts: water, walls, wind, gravity, hulls,
        bed, sea. `own`: its values (`row`); `total`, `beyond`: sums of `pair` over neighbours; images and bodies."""
        fluid, x, v = self.fluid, vec3(own, self.row.position), vec3(own, self.row.velocity)
        a_water, a_walls = self.acceleration(own, total), self.acceleration(own, beyond)
        a_wind = fluid.wind_acceleration(i, x, v)
        a_pull = fluid.pull.at(x, v)
        a_hull = fluid.hull_push(x, self.drifted * dt)
        a = a_water + a_walls + a_wind + a_pull + a_hull
        a_bed, a_sea = tm.vec3(0.0), tm.vec3(0.0)
        if ti.static(fluid.rubs):
            a_bed = fluid.bed.push(x, v + dt * a, dt, total[self.terms.filled], beyond[self.terms.filled])
            a += a_bed
        if ti.static(fluid.joined):
            a_sea = fluid.rim.acceleration(x, v + dt * a, dt)
            a += a_sea
        return a, (a_water, a_walls, a_wind, a_pull, a_hull, a_bed, a_sea)

    @ti.func
    def constrain(self, i, x, v, dt):
        """Positions [m] after a step of particle i from x [m] at v [m/s], without and with walls; velocity [m/s] then;
        1 if it was cut to `motion_limit`, else 0."""
        fluid, walls = self.fluid, self.fluid.walls
        pushed, fast = walls.limit_motion(walls.relax(x, v, dt), dt)
        x_free = x + fluid.grid.whole_quanta(i, ti.static(1.0 - self.drifted) * dt * pushed)
        x_new, v_new = walls.bounce(x_free, pushed)
        return x_free, x_new, v_new, fast

    @ti.func
    def remember_acceleration(self, i, own, total, beyond, parts: Template):
        """Store the acceleration of particle i by gravity and pressure, by which bodies extrapolate its pressure in the
        next step (Boundary.head). `own`: its values; `total`, `beyond`: sums over neighbours, and over images and
        bodies; `parts`: its accelerations by each force, from `kick`."""
        a_water, a_walls = parts[:2]
        a = self.fluid.pull.at_rest(vec3(own, self.row.position)) + a_water + a_walls
        if ti.static(self.sheared):
            a -= self.prefactor(own) * (vec3(total, self.terms.shear) + vec3(beyond, self.terms.shear))
        for k, component in ti.static(enumerate(self.fluid.last_acceleration)):
            component[i] = a[k]

    @ti.func
    def book_step(self, group, own, total, beyond, a, parts: Template, x_free, x_new, v_new, dt):
        """Add impulse and work of each force on a particle to row `group` of the budget. `own`: its values; `total`,
        `beyond`: sums over neighbours, over images and bodies; `a`, `parts`: acceleration, its parts (`kick`);
        `x_free`, `x_new`: position after dt [s] without and with walls; `v_new`: velocity (`constrain`)."""
        fluid, m = self.fluid, ti.static(self.fluid.particles.mass)
        accounts = fluid.accounts
        x, v = vec3(own, self.row.position), vec3(own, self.row.velocity)
        a_water, a_walls, a_wind, a_pull, a_hull, a_bed, a_sea = parts
        a_pressure, mean = self.prefactor(own) * vec3(total, self.terms.push), 0.5 * (v + v_new)
        # Walls take what the other forces do not explain.
        by_walls = v_new - (v + dt * a) + dt * a_walls
        if ti.static(self.drifted == 0.0):
            if (x_new != x_free).any():  # forces work as far as the walls let it go; what else it loses, they took
                way = (x_new - x) / dt
                accounts.count_work(group, WALLS, m * (v_new - v).dot(mean - way))
                mean = way
        kick, forces = m * dt, (a_pressure, a_water - a_pressure, a_wind, a_pull, a_hull, a_bed, a_sea)
        accounts.count_impulses(group, (PRESSURE, VISCOSITY, WIND, GRAVITY, SHIP, BED, SEA), kick, forces, mean)
        accounts.count_impulse(group, WALLS, m * by_walls, mean)
        if ti.static(self.stores_pressure_work):
            push = kick * self.prefactor(own) * vec3(beyond, self.terms.push)
            stored = push.dot(mean - fluid.walls.piston_velocity(x))  # an image moves as the piston lets it
            accounts.count_work(group, WALLS, -stored)
            accounts.count_work(group, PRESSURE, stored)


@in_kernels
class PairSph(Sph):
    """Scheme of symplectic Euler steps: the law `momentum` moves particles, `density` sums density and pressure."""

    momentum: MomentumLaw
    density: Law

    def arrive(self) -> None:
        self.settle(self.summary)

    def step(self, dt: float) -> None:
        self.move(dt, self.wind.clock.since)
        self.settle(self.summary)

    @ti.kernel
    def move(self, dt: float, since: float):
        """Move particles for dt [s] by forces at their present positions; `since`: time of the gust clock [s]."""
        self.dt[None] = dt
        self.wind.set_clock(since, dt)
        self.momentum.react(dt)
        self.neighbours.walk(self.momentum, False)

    @ti.kernel
    def settle(self, summary: Array):
        """Sort moved particles by cell, sum density and pressure; fill `summary` (9,) as Accounts.summarise does."""
        self.grid.sort()
        self.neighbours.walk(self.density, True)
        self.accounts.summarise(summary)
