"""Iterative solvers for the pressures that keep water from being compressed, over kept pairs of neighbours.

With x_ij times grad W of every pair, B takes velocities to the change of the densities in a step and pressures, by its
transpose, to velocities; A = B B^T is symmetric. Sought are the pressures p with r = (density predicted with p) - (that
wanted), r <= 0, and r = 0 where p > 0.
"""

from typing import Any

from ocean_sim.columns import Columns, vec3
from ocean_sim.fluid.neighbours.images import row_at
from ocean_sim.fluid.neighbours.kept_pairs import KeptLaw
from ocean_sim.fluid.sph.particles import Components, staggered_field
from ocean_sim.kernel_library import ti, tm
from ocean_sim.runtime import in_kernels

REPORT_SIZE = 3  # numbers that an iteration reports: sums over all particles
TOO_DENSE, TOO_THIN, UPHILL_SLOPE = range(REPORT_SIZE)
# Of the error that a step begins with: in calm water iterations go on until it is less, so that it comes to rest.
ERROR_REDUCTION = 0.5


@in_kernels
class Compression(KeptLaw):
    """Pair law for each particle's density error r and next pressure (Bender & Koschier 2015, eqs. 6, 7, 12, 13)."""

    row, terms = Columns(position=3, velocity=3), Columns(rate=1)  # the row of what is summed over samples of bodies

    def __init__(self, fluid: Any, solver: "Solver") -> None:
        self.fluid, self.solver, self.pairs, self.reads = fluid, solver, fluid.pairs, solver.velocity
        self.rate = -fluid.particles.mass * fluid.stencil.slope
        self.relaxation = 1.0 / fluid.stencil.stiffest_mode  # in disorder or piled up particles are up to 1.31 as stiff
        self.add_bodies(fluid.boundary)

    @ti.func
    def begin(self, group):
        """Reset the sums of density errors of the particles of task `group` (a thread's share)."""
        self.fluid.rows.clear(group)

    @ti.func
    def kept_image(self, other, name, away):
        return self.pairs.image_velocity(other, name, away)

    @ti.func
    def kept_pair(self, own, other, gradient):
        """Density rate by a neighbour: v_ij . `gradient` (grad W without constant); `own`, `other`: velocities."""
        return ti.Vector([gradient.dot(own - other)])

    @ti.func
    def sample(self, own, s, d, mirror):
        """Position, velocity of boundary particle s, or its image by `mirror`, d [m] from a particle of those `own`."""
        return row_at(own, d, self.boundary.mirrored_velocity(s, mirror))

    @ti.func
    def pair(self, own, other):
        """Density rate by a body's particle: v_ij . grad W without constant; `own`, `other`: position, velocity."""
        x_ij = vec3(own, self.row.position) - vec3(other, self.row.position)
        v_ij = vec3(own, self.row.velocity) - vec3(other, self.row.velocity)
        return ti.Vector([v_ij.dot(self.fluid.smoothing.pair_gradient(x_ij))])

    @ti.func
    def finish(self, i, own, total, beyond, group):
        """Add bodies' share to the density rate of particle i, `total` + `beyond` (sums over neighbours, images); find
        its error, next pressure. `own`: its velocity; `group`: its task (a thread's share), row of error sums."""
        fluid, rate = self.fluid, total[self.terms.rate] + beyond[self.terms.rate]
        if ti.static(fluid.bodies):
            x = tm.vec3([component[i] for component in ti.static(tuple(fluid.particles.position))])
            rate += self.solid.total(x, ti.Vector([x.x, x.y, x.z, own.x, own.y, own.z]))[self.terms.rate]
        if ti.static(not self.solver.restores and not fluid.closed):
            fluid.rate[i] = rate
        self.judge_particle(i, rate, group)

    @ti.func
    def judge_particle(self, i, rate, group):
        """Compute the error of particle i's density after dt, by `rate` (sum of v_ij . grad W), and its pressure in the
        next iteration; add the error to the sums of its task `group` (a thread's share of particles)."""
        fluid, solver, dt = self.fluid, self.solver, self.fluid.dt[None]
        r = dt * self.rate * rate
        if ti.static(solver.restores):
            r += fluid.particles.density[i] - fluid.level[None]
        elif ti.static(not fluid.closed):
            r -= fluid.closing[i]
        start = solver.start_pressure(i)
        p, scale = start + solver.gain[i], dt * dt * fluid.diagonal[i]
        best, last = fluid.admissible_pressure(p + self.relaxation * r / scale), solver.best[i]
        ahead = fluid.admissible_pressure(best + fluid.momentum[None] * (best - last))
        solver.next[i], solver.best[i] = ahead - start, best
        thin = tm.max(-r, 0.0)
        if ti.static(not fluid.closed):
            thin = tm.min(thin, p * scale)  # what less pressure would undo
        fluid.rows.add(group, TOO_DENSE, tm.max(r, 0.0))
        fluid.rows.add(group, TOO_THIN, thin)
        fluid.rows.add(group, UPHILL_SLOPE, (p - best) * scale * (best - last))


@in_kernels
class Push(KeptLaw):
    """Pair law for velocities under the pressures p of an iteration: base velocity plus sum of (p_i + p_j) grad W."""

    row, terms = Columns(position=3, pressure=1), Columns(push=3)  # the row of what is summed over samples of bodies

    def __init__(self, fluid: Any, solver: "Solver") -> None:
        self.fluid, self.solver = fluid, solver
        self.reads = (solver.next,)
        self.add_bodies(fluid.boundary)

    @ti.func
    def kept_image(self, other, name, away):
        """Pressure of the image of neighbour `other`: that of the neighbour; `name` and `away` are not used."""
        return other

    @ti.func
    def kept_pair(self, own, other, gradient):
        """Pressure force (p_i + p_j) `gradient` by a neighbour, to be scaled by `finish`; `own`, `other`: pressures."""
        return (own[0] + other[0]) * gradient

    @ti.func
    def sample(self, own, s, d, mirror):
        """Vector (4,), position and pressure 0, of boundary particle s or its image by `mirror`, d [m] from `own`."""
        return tm.vec4(vec3(own, self.row.position) + d, 0.0)

    @ti.func
    def pair(self, own, other):
        """Pressure force (p_i + p_j) grad W of a body's particle, unscaled; `own`, `other`: position, pressure."""
        x_ij = vec3(own, self.row.position) - vec3(other, self.row.position)
        return (own[self.row.pressure] + other[self.row.pressure]) * self.fluid.smoothing.pair_gradient(x_ij)

    @ti.func
    def body_total(self, i, own):
        """Pressure force (p_i + p_j) grad W of all bodies on particle i, before `finish` scales it; own[0]: p_i."""
        total = tm.vec3(0.0)
        if ti.static(self.fluid.bodies):
            x = tm.vec3([component[i] for component in ti.static(tuple(self.fluid.particles.position))])
            total = self.solid.total(x, tm.vec4(x, own[0]))
        return total

    @ti.func
    def finish(self, i, own, total, beyond, group):
        """Store pressure `own` and velocity of particle i in this iteration; `total`, `beyond`: sums of `kept_pair`
        over neighbours and over mirror images; `group` is not used."""
        fluid, solver = self.fluid, self.solver
        scale = fluid.dt[None] * fluid.pressing
        push = total + beyond + self.body_total(i, own)
        for k in ti.static(range(3)):
            solver.velocity[k][i] = fluid.base[k][i] + scale * push[k]
        solver.gain[i] = own[0]


@in_kernels
class Account(Push):
    """Pair law that adds the impulses of a solver's pressures to the momentum budget."""

    def __init__(self, fluid: Any, solver: "Solver") -> None:
        super().__init__(fluid, solver)
        self.reads = (solver.gain,)

    @ti.func
    def finish(self, i, own, total, beyond, group):
        """Book the change of velocity of particle i by its final pressure, `own`, in the budget: the sum `total` over
        neighbours as pressure, the sums over mirror images, `beyond`, and over bodies as walls."""
        self.fluid.apply_pressures(i, self.fluid.dt[None], total, beyond + self.body_total(i, own))


@in_kernels
class Solver:
    """One of two pressure solvers (divergence, density): pressures [Pa], velocity they change, iteration counts."""

    def __init__(
        self,
        fluid: Any,  # the Dfsph
        velocity: Components,
        tolerance: float,
        most: int,
        least: float,
        start: ti.Field | None = None,
        brief: float = 0.0,
    ) -> None:
        """Make a solver that changes `velocity`: at most `most` iterations, until the relative density error is below
        `tolerance`; in calm water and in steps shorter than `brief` [s] it may have to fall to `least` times that.
        `start`: initial pressures of the divergence solver; None makes the density solver."""
        self.velocity, self.restores = tuple(velocity), start is None
        self.start = start if start is not None else ti.field(float, shape=())
        self.forces = not (self.restores and fluid.closed)  # whether its pressures are forces
        self.tolerance, self.most, self.least, self.brief = tolerance, most, least * tolerance, brief
        self.gain, self.next, self.best = (staggered_field(float, fluid.particles.n) for _ in range(3))
        self.compression, self.push = Compression(fluid, self), Push(fluid, self)
        self.account = Account(fluid, self)
        self.last_iterations, self.last_error = 0, 0.0  # of the last step; the error is over the rest density
        self.iterations, self.error, self.unsolved = 0, 0.0, 0  # since the start: all, the worst, and steps above

    def error_goal(self, first: float, dt: float, calm: bool) -> float:
        """Error at which iterations stop, in a step of dt [s] that begins with the error `first`: the tolerance, or
        less in `calm` water and in brief steps, where pressing out the compression at once would add speed."""
        brief = dt < self.brief
        least = self.least * (dt / self.brief) ** 2 if brief else self.least
        return min(self.tolerance, max(least, ERROR_REDUCTION * first)) if calm or brief else self.tolerance

    def record_step(self, iterations: int, error: float) -> None:
        """Add a step's iterations and its remaining error to the record of the run."""
        self.last_iterations, self.last_error = iterations, error
        self.iterations, self.error = self.iterations + iterations, max(self.error, error)
        self.unsolved += not error <= self.tolerance

    @ti.func
    def start_pressure(self, i):
        """Pressure [Pa] of particle i from which the solver starts; 0 in the density solver."""
        p = 0.0
        if ti.static(not self.restores):
            p = self.start[i]
        return p

    @ti.func
    def begin(self, i):
        """Reset the pressure that the solver adds at particle i to 0."""
        self.gain[i] = self.next[i] = 0.0
        self.best[i] = self.start_pressure(i)
