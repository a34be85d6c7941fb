"""What schemes share whose pressure is known before a step moves the particles: the law of momentum but for what a pair
adds, and, where the density is a sum, the whole step."""

from typing import ClassVar

from ocean_sim.columns import Columns, vec3
from ocean_sim.fluid.shared.accounts import BED, SEA, WALLS
from ocean_sim.fluid.shared.force import Force
from ocean_sim.fluid.shared.images import displaced, halfway, hydrostatic_offset, reflected
from ocean_sim.fluid.shared.law import Law
from ocean_sim.fluid.shared.sph import Sph
from ocean_sim.kernel_library import ti, tm
from ocean_sim.runtime import Array, in_kernels


@in_kernels
class MomentumLaw(Force):
    """What pushes particles and moves them: neighbours, wind, gravity (2.25), a hull, a bed, and walls.

    A scheme adds what is read (`row`, which begins with `position` and `velocity` and has a `pressure` in a form of its
    own, and `reads`), what a pair adds (`pair`, by way of `added`), and by how much a pressure rises (`risen`).
    """

    passed: ClassVar[float] = 0.0
    """Part of a step that the particles have gone before they are pushed; with their new velocity they go the rest."""

    def __init__(self, fluid: Sph) -> None:
        self.sheared = fluid.bodies and fluid.kinematic_viscosity > 0.0
        shear = {"shear": 3} if self.sheared else {}  # friction once more, by itself
        self.terms = Columns(push=3, rub=3, **shear) if fluid.accounts.impulses else Columns(push=3, **shear)
        super().__init__(fluid)
        self.told = (*self.reads, *fluid.last_acceleration)

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

    @ti.func
    def added(self, weight, push, rub, shear):
        """What a pair adds that presses with `push` and rubs with `rub`, of which `shear` is friction."""
        total = ti.Vector.zero(float, self.terms.size)
        for k in ti.static(range(3)):
            if ti.static(self.apart):
                total[self.terms.push + k], total[self.terms.rub + k] = weight * push[k], weight * rub[k]
            else:
                total[self.terms.push + k] = weight * (push[k] + rub[k])
            if ti.static(self.sheared):
                total[self.terms.shear + k] = weight * shear[k]
        return total

    @ti.func
    def scale(self, own):
        """Acceleration over what a particle has summed."""
        return 1.0

    @ti.func
    def acceleration(self, own, total):
        """Of a particle by what it has summed [m/s2]."""
        both = vec3(total, self.terms.push)
        if ti.static(self.apart):
            both += vec3(total, self.terms.rub)
        return self.scale(own) * both

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
        if ti.static(fluid.bodies):
            beyond += self.solid.total(x, ti.Vector([field[i] for field in ti.static(self.told)]))
        a_water, a_walls = self.acceleration(own, total), self.acceleration(own, beyond)
        a_wind = fluid.blown(i, x, v)
        a_pull = fluid.pull.at(x, v)
        a_hull = fluid.hull_push(x, self.passed * dt)
        a = a_water + a_walls + a_wind + a_pull + a_hull  # (2.25)
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
            pressed = fluid.pull.at_rest(x) + a_water + a_walls
            if ti.static(self.sheared):
                pressed -= self.scale(own) * (vec3(total, self.terms.shear) + vec3(beyond, self.terms.shear))
            for k, component in ti.static(enumerate(fluid.last_acceleration)):
                component[i] = pressed[k]
        fluid.leave(i, x_new, v_new)
        fluid.accounts.count_motion(group, v_new, a, fast)
        if ti.static(self.apart):
            a_pressure, mean = self.scale(own) * vec3(total, self.terms.push), 0.5 * (v + v_new)
            rubbed = a_water - a_pressure
            # What walls change: two forms of one difference, which round differently.
            kept = v_new - free + dt * a_walls if ti.static(self.passed == 0.0) else v_new - v - dt * (a - a_walls)
            if ti.static(self.passed == 0.0):
                if (x_new != x_free).any():  # forces work as far as the walls let it go; what else it loses, they took
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
