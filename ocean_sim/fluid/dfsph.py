"""Incompressible water: Bender & Koschier, "Divergence-free smoothed particle hydrodynamics" (SCA 2015; TVCG 23, 2017).

Twice a step pressures are sought that keep the water from being compressed: those under which its velocity does not
compress it (divergence), and those that take it to its rest density (density). The first are forces. The second only
displace the particles: as a velocity, which they are in the papers, a density error over a time step is energy from
nowhere, and still water boils (Cornelis et al., "An optimized source term formulation for incompressible SPH", Visual
Computer 35, 2019). Both solve for pressures p >= 0 with

    r = (density predicted with p) - rest density,   r <= 0,   r = 0 where p > 0.

The papers iterate p = max(p + omega r / A_ii, 0) (relaxed Jacobi; their kappa is p / density); here each iteration is
carried on along the way of the last ones (Nesterov 1983), which starts afresh when it leads uphill (O'Donoghue & Candes
2015, Found. Comput. Math. 15, gradient scheme). Each iteration is two walks over the neighbours. As in the papers
nothing pulls: pressures are never negative.

A known fault: the lattice of still water without viscosity gives way after about a second, and the water then simmers
(speeds of 0.2 sqrt(g depth), 3 % lower).
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import product
from math import sqrt
from typing import Literal

import numpy as np
import taichi as ti
import taichi.math as tm

from ocean_sim.basin import Basin
from ocean_sim.fluid import Limits
from ocean_sim.fluid._grid import TASK
from ocean_sim.fluid._images import PUSH, SIGN, climbed, mirrored, turned
from ocean_sim.fluid._ledger import GRAVITY, PRESSURE, VISCOSITY, WALLS, WIND
from ocean_sim.fluid._particles import Components
from ocean_sim.fluid._smoothing import positive
from ocean_sim.fluid._sph import Sph, SphConfig, limits, rows
from ocean_sim.parts import LedgerRow, quantity
from ocean_sim.wind import Wind

READS = 7  # fields of a neighbour that the law of the forces reads
SLOW = 2.0  # of the reference speed: water counts as no slower when the next step is chosen, see `limits`
PILED = 4.0  # largest eigenvalue of A / A_ii for particles piled up in one place beside a wall
SPRAY = 0.7  # of the rest density: thinner water may be compressed up to it; a flat surface reads 0.77 to 0.85
LEAST = 0.05  # of its value on the lattice: A_ii is taken to be no less, which keeps coincident particles finite
REPORT = 3  # numbers that an iteration reports: sums over all particles
TOO_DENSE, TOO_THIN, UPHILL = range(REPORT)


class Config(SphConfig):
    """Incompressible water, for large time steps."""

    kind: Literal["dfsph"] = "dfsph"
    minimum_pressure: float | None = quantity("Pa", 0.0, ge=0.0, le=0.0)
    """Zero: this scheme knows no negative pressures."""
    density_tolerance: float = quantity("1", 5.0e-4, gt=0.0)
    """Mean error of the density that the step may end with, over the rest density."""
    divergence_tolerance: float = quantity("1", 1.0e-3, gt=0.0)
    """Mean compression in a step that the velocity may end with, over the rest density."""
    max_density_iterations: int = quantity("1", 100, ge=0)
    """The most iterations for the density; steps that would need more are counted."""
    max_divergence_iterations: int = quantity("1", 100, ge=0)
    """The most iterations for the divergence; steps that would need more are counted."""

    def ledger(self, basin: Basin, word: int) -> list[LedgerRow]:
        what = "position, velocity, density, pressure, number; predicted velocity and two solvers' fields"
        return rows(self.sized(basin, READS, 1), word, 19, what)

    def still_limits(self, basin: Basin) -> Limits:
        """Limits of the time step in still water, before anything is allocated."""
        support = self.ratio(basin) * self.lattice(basin).spacing
        pull = float(np.linalg.norm(np.add(basin.gravity, self.body_force)))
        return limits(support, 0.0, self.kinematic_viscosity, SLOW * self.speed(basin), pull)

    def build(self, basin: Basin, seed: int, *, ledger: bool, wind: Wind) -> "Dfsph":
        return Dfsph(self, basin, ledger, wind)


@dataclass(frozen=True)
class Bell:
    """W = constant (1 - r^2/h^2)^4, whose gradient -slope (1 - r^2/h^2)^3 x needs neither root nor division.

    `constant` gives a lattice of particles exactly its rest density.
    """

    dimension: int
    support: float  # [m]
    spacing: float  # [m]

    @cached_property
    def offsets(self) -> np.ndarray:
        """Places of the neighbours on the lattice [m], and of the particle itself."""
        reach = range(-int(self.support / self.spacing) - 1, int(self.support / self.spacing) + 2)
        return self.spacing * np.array(list(product(reach, repeat=self.dimension)), dtype=float)

    @cached_property
    def w(self) -> np.ndarray:
        """1 - r^2/h^2 of each neighbour on the lattice, where it is positive."""
        return np.maximum(1.0 - (self.offsets**2).sum(axis=1) / self.support**2, 0.0)

    @property
    def constant(self) -> float:
        """[m^-3], in a slice [m^-2]."""
        return 1.0 / (self.spacing**self.dimension * float((self.w**4).sum()))

    @property
    def slope(self) -> float:
        """[m^-5], in a slice [m^-4]."""
        return 8.0 * self.constant / self.support**2

    @property
    def gain(self) -> float:
        """What the lattice makes of a gradient of one; forces are divided by it."""
        moment = self.w**3 @ self.offsets[:, 0] ** 2
        return self.slope * self.spacing**self.dimension * float(moment)

    @property
    def squares(self) -> float:
        """Sum of the squared gradients on the lattice [m^-8], in a slice [m^-6]."""
        return self.slope**2 * float(self.w**6 @ (self.offsets**2).sum(axis=1))

    @property
    def stiffest(self) -> float:
        """Largest eigenvalue of A / A_ii on the lattice, of plane waves along its axes and diagonals."""
        largest = 0.0
        for wave in product(np.linspace(0.0, np.pi, 13), repeat=self.dimension):
            gradients = (self.slope * self.w**3 * np.sin(self.offsets @ wave / self.spacing)) @ self.offsets
            largest = max(largest, float(gradients @ gradients) / self.squares)
        return largest


@ti.data_oriented
class Density:
    """Density by summation, and the diagonal A_ii of the solvers over dt^2 (2015, eq. 9: their 1 / alpha); more of it
    where particles crowd, since the more neighbours there are the further A / A_ii reaches beyond one."""

    apart = False
    sums = 5

    def __init__(self, fluid: "Dfsph") -> None:
        self.fluid = fluid
        self.reads = tuple(fluid.particles.position)
        bell, m = fluid.bell, fluid.particles.mass
        self.slope, self.square, self.mass = -bell.slope, bell.slope**2, m * bell.constant
        self.scale, self.least, self.volume = m * fluid.weight, LEAST * bell.squares, m / fluid.particles.rest_density
        if fluid.bodies:
            self.solid = fluid.boundary.met(self)

    @ti.func
    def begin(self, group):
        self.fluid.ledger.begin_density(group)

    @ti.func
    def image(self, other, mirror):
        """A neighbour as a side shows it."""
        return mirrored(mirror, other)

    @ti.func
    def sample(self, own, s, d, mirror):
        """A sample of a solid body."""
        return own + d

    @ti.func
    def pair(self, own, other):
        x_ij = own - other
        r2 = x_ij.dot(x_ij)
        w = self.fluid.share(r2)
        w3 = w * w * w
        return ti.Vector([w3 * w, w3 * x_ij[0], w3 * x_ij[1], w3 * x_ij[2], w3 * w3 * r2])

    @ti.func
    def finish(self, i, own, total, beyond, group):
        fluid = self.fluid
        if ti.static(fluid.bodies):
            solid = self.solid.total(own, own)
            solid[4] = 0.0  # no pressure moves a body
            total += solid
        gradient = self.slope * tm.vec3(total[1], total[2], total[3])
        squares = gradient.dot(gradient) + self.square * total[4]
        fluid.particles.density[i] = self.mass * total[0]
        crowding = tm.max(fluid.particles.density[i] / fluid.particles.rest_density, 1.0)
        fluid.diagonal[i] = self.scale * crowding * tm.max(squares, self.least)
        fluid.particles.pressure[i] = fluid.divergence.pressure[i]
        if ti.static(fluid.exposed):
            fluid.expose(i, self.volume * gradient)
        fluid.ledger.count_density(group, fluid.particles.density[i])


@ti.data_oriented
class Forces:
    """Everything but pressure, and the pressures of the last step, from which the solver for the divergence starts.

    Viscosity as Morris, Fox & Zhu (1997), eq. 22. An image continues the pressure hydrostatically, which is how
    water at a side is held: dp/dn = rho g . n.
    """

    def __init__(self, fluid: "Dfsph") -> None:
        self.fluid = fluid
        self.viscous = fluid.config.kinematic_viscosity > 0.0
        self.reads = (*fluid.particles.position, fluid.divergence.pressure)
        if self.viscous:
            self.reads += tuple(fluid.particles.velocity)
        self.apart = fluid.ledger.impulses
        self.sums = 6 if self.viscous else 3
        volume = fluid.particles.mass / fluid.particles.rest_density
        if fluid.bodies:
            self.solid, self.reaction = fluid.boundary.met(self), fluid.boundary.reaction(self)
        self.rubbing = 2.0 * fluid.config.kinematic_viscosity * volume * fluid.bell.slope / fluid.bell.gain

    @ti.func
    def begin(self, group):
        self.fluid.ledger.begin_motion(group)

    @ti.func
    def image(self, other, mirror):
        x = tm.vec3(other[0], other[1], other[2])
        x_image, image = mirrored(mirror, x), other
        for k in ti.static(range(3)):
            image[k] = x_image[k]
        image[3] += self.fluid.particles.rest_density * climbed(mirror, x, self.fluid.pull.at_rest(x))
        if ti.static(self.viscous):
            v_image = turned(mirror, tm.vec3(other[4], other[5], other[6]))
            for k in ti.static(range(3)):
                image[4 + k] = v_image[k]
        return image

    @ti.func
    def sample(self, own, s, d, mirror):
        """A sample of a solid body, which has no pressure of its own (2017, section 5)."""
        other = own
        for k in ti.static(range(3)):
            other[k] = own[k] + d[k]
        other[3] = 0.0
        if ti.static(self.viscous):
            v = self.fluid.boundary.rubbing(tm.vec3(own[4], own[5], own[6]), s, mirror)
            for k in ti.static(range(3)):
                other[4 + k] = v[k]
        return other

    @ti.func
    def acceleration(self, own, total):
        a = self.fluid.pressing * tm.vec3(total[0], total[1], total[2])
        if ti.static(self.viscous):
            a += self.rubbing * tm.vec3(total[3], total[4], total[5])
        return a

    @ti.func
    def pair(self, own, other):
        x_ij = tm.vec3(own[0] - other[0], own[1] - other[1], own[2] - other[2])
        w = self.fluid.share(x_ij.dot(x_ij))
        w3 = w * w * w
        along = (own[3] + other[3]) * w3
        total = ti.Vector.zero(float, self.sums)
        for k in ti.static(range(3)):
            total[k] = along * x_ij[k]
            if ti.static(self.viscous):
                total[3 + k] = w3 * (other[4 + k] - own[4 + k])
        return total

    @ti.func
    def finish(self, i, own, total, beyond, group):
        fluid, m = self.fluid, ti.static(self.fluid.particles.mass)
        dt = fluid.dt[None]
        x, v = tm.vec3(own[0], own[1], own[2]), fluid.particles.velocity
        if ti.static(fluid.bodies):
            beyond += self.solid.total(x, own)
        before = tm.vec3(v.x[i], v.y[i], v.z[i])
        a_wind = fluid.wind.force(fluid.particles.id[i], x, before, fluid.area(i), m) / m
        u = fluid.pushed(group, WIND, before, dt * a_wind)
        a_pull = fluid.pull.at(x, before)
        u = fluid.pushed(group, GRAVITY, u, dt * a_pull)
        a = a_wind + a_pull
        if ti.static(self.viscous):
            rub, rub_walls = tm.vec3(total[3], total[4], total[5]), tm.vec3(beyond[3], beyond[4], beyond[5])
            u = fluid.pushed(group, VISCOSITY, u, dt * self.rubbing * rub)
            u = fluid.pushed(group, WALLS, u, dt * self.rubbing * rub_walls)
            a += self.rubbing * (rub + rub_walls)
        u = fluid.pushed(group, WALLS, u, fluid.walls.calmed(x, u, dt) - u)
        u = fluid.pressed(group, u, dt, total, beyond)
        for k, component in ti.static(enumerate(fluid.predicted)):
            component[i] = u[k]
        fluid.divergence.best[i] = own[3]
        fluid.ledger.count_motion(group, before, a, 0)


@ti.data_oriented
class Compression:
    """The residual r of each particle with the pressures so far, and the next pressures; 2015, eqs. 6, 7, 12, 13."""

    apart = False
    sums = 1

    def __init__(self, fluid: "Dfsph", solver: "Solver") -> None:
        self.fluid, self.solver = fluid, solver
        self.reads = (*fluid.particles.position, *solver.velocity)
        self.rate = -fluid.particles.mass * fluid.bell.slope
        self.relaxation = 1.0 / max(fluid.bell.stiffest, PILED)
        if fluid.bodies:
            self.solid = fluid.boundary.met(self)

    @ti.func
    def begin(self, group):
        for k in ti.static(range(REPORT)):
            self.fluid.rows[group, k] = 0.0

    @ti.func
    def image(self, other, mirror):
        """A neighbour as a side shows it: only its normal velocity is turned round, whatever the slip."""
        x, v = tm.vec3(other[0], other[1], other[2]), tm.vec3(other[3], other[4], other[5])
        x_image, image = mirrored(mirror, x), other
        for k in ti.static(range(3)):
            image[k] = x_image[k]
            image[3 + k] = mirror[SIGN, k] * v[k] + ti.select(mirror[SIGN, k] < 0.0, mirror[PUSH, k], 0.0)
        return image

    @ti.func
    def sample(self, own, s, d, mirror):
        """A sample of a solid body."""
        other, v = own, self.fluid.boundary.own_velocity(s, mirror)
        for k in ti.static(range(3)):
            other[k], other[3 + k] = own[k] + d[k], v[k]
        return other

    @ti.func
    def pair(self, own, other):
        x_ij = tm.vec3(own[0] - other[0], own[1] - other[1], own[2] - other[2])
        v_ij = tm.vec3(own[3] - other[3], own[4] - other[4], own[5] - other[5])
        w = self.fluid.share(x_ij.dot(x_ij))
        return ti.Vector([w * w * w * v_ij.dot(x_ij)])

    @ti.func
    def finish(self, i, own, total, beyond, group):
        fluid, solver = self.fluid, self.solver
        dt = fluid.dt[None]
        if ti.static(fluid.bodies):
            total += self.solid.total(tm.vec3(own[0], own[1], own[2]), own)
        rho, rest = fluid.particles.density[i], ti.static(fluid.particles.rest_density)
        excess = rho - rest
        if ti.static(not solver.restores):
            excess = tm.min(rho - SPRAY * rest, 0.0)
        r = excess + dt * self.rate * total[0]
        p, scale = solver.pressure[i], dt * dt * fluid.diagonal[i]
        best, last = tm.max(p + self.relaxation * r / scale, 0.0), solver.best[i]
        ahead = tm.max(best + fluid.momentum[None] * (best - last), 0.0)
        solver.change[i], solver.best[i] = ahead - p, best
        fluid.rows[group, TOO_DENSE] += tm.max(r, 0.0)
        fluid.rows[group, TOO_THIN] += tm.min(tm.max(-r, 0.0), p * scale)  # what less pressure would undo
        fluid.rows[group, UPHILL] += (p - best) * scale * (best - last)


@ti.data_oriented
class Push:
    """The change of the velocity by a change of the pressures; it is the adjoint of Compression."""

    sums = 3

    def __init__(self, fluid: "Dfsph", solver: "Solver") -> None:
        self.fluid, self.solver = fluid, solver
        self.reads = (*fluid.particles.position, solver.change)
        self.apart = fluid.ledger.impulses and not solver.restores
        if fluid.bodies:
            self.solid = fluid.boundary.met(self)

    @ti.func
    def begin(self, group):
        pass

    @ti.func
    def image(self, other, mirror):
        """A neighbour as a side shows it: with its own change of pressure."""
        x_image = mirrored(mirror, tm.vec3(other[0], other[1], other[2]))
        return tm.vec4(x_image, other[3])

    @ti.func
    def sample(self, own, s, d, mirror):
        """A sample of a solid body."""
        return tm.vec4(own[0] + d[0], own[1] + d[1], own[2] + d[2], 0.0)

    @ti.func
    def pair(self, own, other):
        x_ij = tm.vec3(own[0] - other[0], own[1] - other[1], own[2] - other[2])
        w = self.fluid.share(x_ij.dot(x_ij))
        return (own[3] + other[3]) * w * w * w * x_ij

    @ti.func
    def finish(self, i, own, total, beyond, group):
        fluid, solver = self.fluid, self.solver
        u = tm.vec3([component[i] for component in ti.static(tuple(solver.velocity))])
        if ti.static(fluid.bodies):
            solid = self.solid.total(tm.vec3(own[0], own[1], own[2]), own)
            if ti.static(self.apart):
                beyond += solid
            else:
                total += solid
        if ti.static(solver.restores):
            u += fluid.dt[None] * fluid.pressing * total
        else:
            u = fluid.pressed(group, u, fluid.dt[None], total, beyond)
        for k, component in ti.static(enumerate(solver.velocity)):
            component[i] = u[k]
        solver.pressure[i] = solver.pressure[i] + own[3]


@ti.data_oriented
class Solver:
    """One of the two: its pressures [Pa] and the velocity [m/s] that they change."""

    def __init__(self, fluid: "Dfsph", pressure: ti.Field, velocity: Components, restores: bool) -> None:
        """`restores`: whether it undoes compression that is there already, or only what the velocity adds."""
        n = fluid.particles.n
        self.pressure, self.velocity, self.restores = pressure, velocity, restores
        self.best, self.change = ti.field(float, shape=n), ti.field(float, shape=n)
        self.compression, self.push = Compression(fluid, self), Push(fluid, self)


@ti.data_oriented
class Dfsph(Sph):
    """Particles that keep each other from being compressed; between steps they are sorted, with density and pressure
    current.

    `sound_speed` is that of weakly compressible water with the same `compression`; no step waits for it.
    """

    def __init__(self, config: Config, basin: Basin, ledger: bool, wind: Wind) -> None:
        super().__init__(config, basin, config.sized(basin, READS, 1), ledger, wind)
        particles, n = self.particles, self.particles.n
        volume = particles.mass / particles.rest_density
        self.bell = Bell(basin.dimension, self.smoothing.support, volume ** (1.0 / basin.dimension))
        self.weight = particles.mass / (self.bell.gain * particles.rest_density**2)  # of p_i + p_j in an acceleration
        self.predicted = Components(n)  # velocity at the end of the step [m/s]
        self.displacing = Components(n)  # the same and displacement over dt [m/s]
        self.diagonal = ti.field(float, shape=n)  # A_ii / dt^2
        self.momentum = ti.field(float, shape=())  # how far an iteration is carried on
        self.pressing = self.weight * self.bell.slope
        self.rows = ti.field(float, shape=(self.ledger.groups, REPORT))
        self.divergence = Solver(self, self.carried[0], self.predicted, restores=False)
        self.incompressible = Solver(self, ti.field(float, shape=n), self.displacing, restores=True)
        self.density, self.forces = Density(self), Forces(self)
        self.report = np.zeros(REPORT, dtype=particles.position.precision)
        self.iterations = {"density": 0, "divergence": 0}  # of the last step
        self.solver_error = {"density": 0.0, "divergence": 0.0}  # that the last step ended with, over the rest density
        self.unsolved = {"density": 0, "divergence": 0}  # steps since the start that ended above their tolerance
        self.begin()

    def begin(self) -> None:
        """Start from the particles as they are now."""
        self.divergence.pressure.fill(0.0)
        self.lift()
        self.arrive()

    def advance(self, dt: float) -> None:
        """One step of dt [s]; raises Diverged where more particles crowd together than the neighbour lists hold."""
        config = self.config
        self.drive(dt)
        self.predict(dt, self.report)
        self.solve("divergence", self.divergence, config.divergence_tolerance, config.max_divergence_iterations)
        self.compress(self.report)
        self.solve("density", self.incompressible, config.density_tolerance, config.max_density_iterations)
        self.move()
        self.arrive()
        self.emit()

    def arrive(self) -> None:
        """Make everything current and sorted where the particles are now."""
        self.settle(self.summary)
        self.status = self.ledger.status(self.summary, self.grid)

    def solve(self, name: str, solver: Solver, tolerance: float, most: int) -> None:
        """Iterate until the water is neither pressed together nor apart by more than its tolerance in the mean, at most
        so often."""
        scale = 1.0 / (self.particles.count.now * self.particles.rest_density)
        done, along = 0, 1.0
        while not (error := scale * float(self.report[:UPHILL].max())) <= tolerance and done < most:
            if self.report[UPHILL] > 0.0:
                along = 1.0
            ahead = 0.5 + sqrt(0.25 + along * along)
            self.iterate(solver, (along - 1.0) / ahead, self.report)
            done, along = done + 1, ahead
        self.iterations[name], self.solver_error[name] = done, error
        self.unsolved[name] += not error <= tolerance

    @ti.kernel
    def predict(self, dt: float, report: ti.types.ndarray(ndim=1)):
        """Velocities under all forces and the last pressures, and how far they compress the water."""
        self.dt[None], self.momentum[None] = dt, 0.0
        for g in range(self.ledger.groups * TASK):
            if g % TASK == 0:
                self.neighbours.walk(g // TASK, self.forces, False)
        for g in range(self.ledger.groups * TASK):
            if g % TASK == 0:
                self.neighbours.walk(g // TASK, self.divergence.compression, False)
        self.add(report)

    @ti.kernel
    def iterate(self, solver: ti.template(), momentum: float, report: ti.types.ndarray(ndim=1)):
        """One iteration of a solver."""
        self.momentum[None] = momentum
        for g in range(self.ledger.groups * TASK):
            if g % TASK == 0:
                self.neighbours.walk(g // TASK, solver.push, False)
        for g in range(self.ledger.groups * TASK):
            if g % TASK == 0:
                self.neighbours.walk(g // TASK, solver.compression, False)
        self.add(report)

    @ti.kernel
    def compress(self, report: ti.types.ndarray(ndim=1)):
        """The density that these velocities lead to."""
        self.momentum[None] = 0.0
        if ti.static(self.bodies):
            self.boundary.react(self.forces.reaction, self.dt[None])
        for i in range(self.particles.count.there()):
            self.incompressible.pressure[i] = self.incompressible.best[i] = 0.0
            for displacing, predicted in ti.static(zip(self.displacing, self.predicted)):
                displacing[i] = predicted[i]
        for g in range(self.ledger.groups * TASK):
            if g % TASK == 0:
                self.neighbours.walk(g // TASK, self.incompressible.compression, False)
        self.add(report)

    @ti.kernel
    def move(self):
        """Displace the particles, and take over their velocities."""
        for g in range(self.ledger.groups * TASK):
            if g % TASK == 0:
                group, n = g // TASK, self.particles.count.there()
                for i in range(group * n // self.ledger.groups, (group + 1) * n // self.ledger.groups):
                    dt, p = self.dt[None], self.particles.position
                    u = tm.vec3([component[i] for component in ti.static(tuple(self.predicted))])
                    way = tm.vec3([component[i] for component in ti.static(tuple(self.displacing))])
                    held, fast = self.walls.held_back(way, dt)
                    x, v = self.walls.bounced(tm.vec3(p.x[i], p.y[i], p.z[i]) + dt * held, u)
                    v = self.pushed(group, WALLS, u, v - u)
                    self.grid.leave(i, x, v)
                    self.ledger.count_motion(group, v, tm.vec3(0.0), fast)

    @ti.kernel
    def settle(self, summary: ti.types.ndarray(ndim=1)):
        """Sort, and find the new density."""
        self.grid.sort()
        for g in range(self.ledger.groups * TASK):
            if g % TASK == 0:
                self.neighbours.walk(g // TASK, self.density, True)
        self.ledger.summarise(summary)

    @ti.func
    def add(self, report: ti.template()):
        """The groups' rows into one, in their order."""
        for k in ti.static(range(REPORT)):
            report[k] = 0.0
        ti.loop_config(serialize=True)
        for g in range(self.ledger.groups):
            for k in ti.static(range(REPORT)):
                report[k] += self.rows[g, k]

    @ti.func
    def share(self, r2):
        """1 - r^2/h^2 within the support, else 0."""
        return positive(1.0 - r2 * (1.0 / self.smoothing.support**2))

    @ti.func
    def pressed(self, group, u, dt, total, beyond):
        """Velocity u after the pressures of the water, summed in the first three of `total`, and of the walls."""
        scale = dt * self.pressing
        u = self.pushed(group, PRESSURE, u, scale * tm.vec3(total[0], total[1], total[2]))
        return self.pushed(group, WALLS, u, scale * tm.vec3(beyond[0], beyond[1], beyond[2]))

    @ti.func
    def pushed(self, group, term: ti.template(), u, change):
        """Velocity u and its change by a term, put to its account."""
        if ti.static(self.ledger.impulses):
            self.ledger.count_impulse(group, term, self.particles.mass * change, u + 0.5 * change)
        return u + change

    def limits(self) -> Limits:
        """Nothing has to wait for sound, but a particle under a pressure p is held by its neighbours as by springs,
        whose frequency is about sqrt(p / density) / spacing. The acceleration is that of all forces but pressure."""
        status, nu = self.status, self.config.kinematic_viscosity
        speed = max(status.max_speed, SLOW * self.reference_speed)
        return limits(self.smoothing.support, 0.0, nu, speed, status.max_acceleration)

    def internal_energy(self) -> float:
        """None: what is not compressed stores nothing [J]."""
        return 0.0
