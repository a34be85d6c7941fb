"""What schemes share whose pressure is known before a step moves the particles: the law of momentum but for what a pair
adds, and, where the density is a sum, the whole step."""

from abc import abstractmethod
from typing import Any, ClassVar

from ocean_sim.columns import Columns, vec3
from ocean_sim.fluid.shared.accounts import BED, SEA, WALLS
from ocean_sim.fluid.shared.force import Force
from ocean_sim.fluid.shared.images import displaced, halfway, hydrostatic_offset, reflected
from ocean_sim.fluid.shared.law import Law
from ocean_sim.fluid.shared.sph import Sph
from ocean_sim.kernel_library import ti, tm
from ocean_sim.runtime import Array, Template, in_kernels


@in_kernels
class MomentumLaw(Force):
    """What pushes particles and moves them: neighbours, wind, gravity (2.25), a hull, a bed, and walls.

    A scheme adds what is read (`row`, which begins with `position` and `velocity` and has a `pressure` in a form of its
    own, and `reads`), what a pair adds (`term`), and by how much a pressure rises (`risen`). Pressure and friction are
    summed together; where impulses are counted, once more by themselves (`parted`), and nothing else reads those sums.
    """

    apart: ClassVar[bool] = False
    parted: "Parted"
    passed: ClassVar[float] = 0.0
    """Part of a step that the particles have gone before they are pushed; with their new velocity they go the rest."""

    def __init__(self, fluid: Sph) -> None:
        self.sheared = fluid.bodies and fluid.kinematic_viscosity > 0.0
        shear = {"shear": 3} if self.sheared else {}  # friction once more, by itself
        self.terms, self.parts = Columns(both=3, push=3, **shear), Columns(push=3, rub=3, **shear)
        self.parted, self.pressing = Parted(self, fluid), self.terms.push
        super().__init__(fluid)

    @ti.func
    def risen(self, head):
        """Rise of the row's pressure where p / rho rises by `head` [m2/s2]."""
        return self.fluid.rest_density * head

    @ti.func
    def image(self, other, mirror):
        """A neighbour as a side shows it: its velocity turned round, its pressure continued hydrostatically."""
        x, image = vec3(other, self.row.position), reflected(mirror, other)
        pull = self.fluid.pull.at_rest(halfway(mirror, x))
        image[self.row.pressure] += self.risen(hydrostatic_offset(mirror, x, pull))
        return image

    @ti.func
    def sample(self, own, s, d, mirror):
        return self.continued(own, s, d, mirror)

    @ti.func
    def continued(self, own, s, d, mirror):
        """A sample of a solid body: it has all of the particle, the pressure continued to where it is."""
        other = displaced(own, d, self.boundary.rubbing(vec3(own, self.row.velocity), s, mirror))
        a = tm.vec3([own[self.row.size + k] for k in ti.static(range(3))])
        head = self.boundary.head(vec3(own, self.row.position), a, s, d, mirror)
        other[self.row.pressure] = own[self.row.pressure] + self.risen(head)
        return other

    @abstractmethod
    def term(self, own: Any, other: Any, tense: Any) -> Any:
        """ti.func: the weight of a neighbour, and times it what presses, what rubs, and what of that is friction;
        `tense`: whether a pressure may be negative."""

    @ti.func
    def pair(self, own, other):
        return self.together(own, other, True)

    @ti.func
    def pressed(self, own, other):
        """What a neighbour adds where no pressure is negative."""
        return self.together(own, other, False)

    @ti.func
    def together(self, own, other, tense: Template):
        """What a neighbour adds, pressure and friction in one sum."""
        weight, push, rub, shear = self.term(own, other, tense)
        total = ti.Vector.zero(float, self.terms.size)
        for k in ti.static(range(3)):
            total[self.terms.both + k] = weight * (push[k] + rub[k])
            if ti.static(self.sheared):
                total[self.terms.shear + k] = weight * shear[k]
        return total

    @ti.func
    def scale(self, own):
        """Acceleration over what a particle has summed."""
        return 1.0

    @ti.func
    def acceleration(self, own, total):
        """Acceleration [m/s2] of a particle by sums that have pressure and friction apart."""
        return self.scale(own) * (vec3(total, self.parts.push) + vec3(total, self.parts.rub))

    @ti.func
    def worked(self, own, total):
        """Whose work on the water stands under walls: all, unless a scheme puts what presses elsewhere."""
        return self.acceleration(own, total)

    @ti.func
    def finish(self, i, own, total, beyond, group):
        """Kick the particle and move it on, as far as walls, absorbing zones and the motion limit let it."""
        fluid, walls, m = self.fluid, self.fluid.walls, ti.static(self.fluid.particles.mass)
        dt = fluid.dt[None]
        x, v = vec3(own, self.row.position), vec3(own, self.row.velocity)
        solids = ti.Vector.zero(float, self.parts.size)
        if ti.static(fluid.bodies):
            solids = self.solid.total(x, ti.Vector([field[i] for field in ti.static(self.parted.told)]))
        a_pairs = self.scale(own) * vec3(total, self.terms.both) + self.acceleration(own, solids)
        a_wind = fluid.blown(i, x, v)
        a_pull = fluid.pull.at(x, v)
        a_hull = fluid.hull_push(x, self.passed * dt)
        a = a_pairs + a_wind + a_pull + a_hull  # (2.25)
        a_bed = tm.vec3(0.0)
        if ti.static(fluid.rubs):
            a_bed = fluid.bed.push(x, v + dt * a, dt)
            a += a_bed
        a_sea = tm.vec3(0.0)
        if ti.static(fluid.joined):
            a_sea = fluid.rim.push(x, v + dt * a, dt)
            a += a_sea
        free = v + dt * a
        pushed, fast = walls.held_back(walls.relaxed(x, free, dt), dt)
        x_free = x + fluid.grid.gone(i, ti.static(1.0 - self.passed) * dt * pushed)
        x_new, v_new = walls.bounced(x_free, pushed)
        if ti.static(fluid.bodies):  # pressure goes with what pulls and presses; friction and wind bend no isobar
            pressed = fluid.pull.at_rest(x) + a_pairs
            if ti.static(self.sheared):
                pressed -= self.scale(own) * (vec3(total, self.terms.shear) + vec3(solids, self.parts.shear))
            for k, component in ti.static(enumerate(fluid.last_acceleration)):
                component[i] = pressed[k]
        fluid.leave(i, x_new, v_new)
        fluid.accounts.count_motion(group, v_new, a, fast)
        if ti.static(fluid.accounts.countable):
            if fluid.accounts.counting():
                a_pressure = self.scale(own) * (vec3(total, self.terms.push) - vec3(beyond, self.parts.push))
                beyond += solids
                a_walls, mean = self.acceleration(own, beyond), 0.5 * (v + v_new)
                rubbed = a_pairs - a_walls - a_pressure
                # What walls change: two forms of one difference, which round differently.
                kept = v_new - free + dt * a_walls if ti.static(self.passed == 0.0) else v_new - v - dt * (a - a_walls)
                if ti.static(self.passed == 0.0):
                    if (x_new != x_free).any():  # forces work as far as walls let it go; what else it loses, they took
                        far = (x_new - x) / dt
                        fluid.accounts.count_work(group, WALLS, m * (v_new - v).dot(mean - far))
                        mean = far
                fluid.accounts.count_step(group, m * dt, a_pressure, rubbed, a_wind, a_pull, a_hull, m * kept, mean)
                if ti.static(fluid.rubs):
                    fluid.accounts.count_impulse(group, BED, m * dt * a_bed, mean)
                if ti.static(fluid.joined):
                    fluid.accounts.count_impulse(group, SEA, m * dt * a_sea, mean)
                self.account(beyond, mean, dt, group)

    @ti.func
    def account(self, beyond, mean, dt, group):
        """What else a scheme puts to the accounts, of what walls add to the sum of a particle and its mean velocity of
        the step."""


@in_kernels
class Parted:
    """A law of momentum with what presses and what rubs apart, as bodies feel it and accounts read it."""

    def __init__(self, law: MomentumLaw, fluid: Sph) -> None:
        self.law, self.row, self.reads, self.terms = law, law.row, law.reads, law.parts
        self.told = (*law.reads, *fluid.last_acceleration)

    @ti.func
    def image(self, other, mirror):
        return self.law.image(other, mirror)

    @ti.func
    def sample(self, own, s, d, mirror):
        return self.law.sample(own, s, d, mirror)

    @ti.func
    def pair(self, own, other):
        weight, push, rub, shear = self.law.term(own, other, True)
        total = ti.Vector.zero(float, self.terms.size)
        for k in ti.static(range(3)):
            total[self.terms.push + k], total[self.terms.rub + k] = weight * push[k], weight * rub[k]
            if ti.static(self.law.sheared):
                total[self.terms.shear + k] = weight * shear[k]
        return total

    @ti.func
    def acceleration(self, own, total):
        return self.law.acceleration(own, total)

    @ti.func
    def worked(self, own, total):
        return self.law.worked(own, total)


@in_kernels
class PairSph(Sph):
    """A scheme that moves particles by its `momentum`, sorts them, and sums up their `density`, which also finds their
    pressure: symplectic Euler."""

    momentum: MomentumLaw
    density: Law

    def arrive(self) -> None:
        self.settle(self.summary)

    def step(self, dt: float) -> None:
        self.move(dt, self.wind.since)
        self.settle(self.summary)

    @ti.kernel
    def move(self, dt: float, since: float):
        """Move by the forces of here and now."""
        self.dt[None] = dt
        self.wind.set_clock(since, dt)
        self.momentum.react(dt)
        self.neighbours.walk(self.momentum, False)

    @ti.kernel
    def settle(self, summary: Array):
        """Sort, and find the new density."""
        self.grid.sort()
        self.neighbours.walk(self.density, True)
        self.accounts.summarise(summary)
