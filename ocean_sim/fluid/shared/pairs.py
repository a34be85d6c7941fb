"""Pairs of neighbours kept for a step: what iterates over them again and again reads each once, with its gradient.

Each particle has its own slots, pairs with particles first and those with images after them. An image is named by its
particle and by the axes along which it is mirrored, so its velocity follows that of the particle.
"""

from ocean_sim.fluid.shared.emitter import MOST_PARTICLES
from ocean_sim.fluid.shared.images import SIDE, SIGN, Images
from ocean_sim.fluid.shared.particles import Particles
from ocean_sim.fluid.shared.tasks import Tasks
from ocean_sim.kernel_library import ti, tm
from ocean_sim.runtime import Template, in_kernels

ROOM = 2.5  # slots of a particle, over its neighbours on the lattice
LEAST = 48  # slots of a particle at least


def slots(neighbours: int) -> int:
    """Of a particle that has so many neighbours on the lattice."""
    return max(LEAST, int(ROOM * neighbours))


def size(n: int, neighbours: int, word: int) -> int:
    """Bytes of the pairs of n particles, where `word` is the size of a `float` [bytes]."""
    return n * (8 + slots(neighbours) * (4 + 3 * word))


@in_kernels
class Pairs:
    """Of each particle its neighbours and images, and x_ij times the shape of grad W."""

    def __init__(self, particles: Particles, images: Images, tasks: Tasks, neighbours: int) -> None:
        self.tasks, self.room = tasks, slots(neighbours)
        self.name = ti.field(int, shape=particles.n * self.room)
        self.gradient = ti.Vector.field(3, float, shape=particles.n * self.room)
        self.near, self.seen = (ti.field(int, shape=particles.n) for _ in range(2))  # particles, and images with them
        self.images = images
        self.pistons = tuple((s, side.axis, side.upper) for s, side, _ in images.pistons)

    @ti.func
    def velocity(self, v: Template, name, gradient):
        """Of an image [m/s]: only its normal velocity is turned round, whatever the slip."""
        j, flips = name % MOST_PARTICLES, name // MOST_PARTICLES
        image = tm.vec3([component[j] for component in ti.static(tuple(v))])
        for k in ti.static(range(3)):
            image[k] = ti.select(flips >> k & 1, -image[k], image[k])
        for s, axis, upper in ti.static(self.pistons):
            beyond = gradient[axis] < 0.0 if ti.static(upper) else gradient[axis] > 0.0
            image[axis] += ti.select(
                (flips >> axis & 1) and beyond, self.images.side[s, SIDE.twice_velocity + axis], 0.0
            )
        return image

    @ti.func
    def walk(self, law: Template):
        """For every particle i: sum law.near over its neighbours and law.image over its images, then law.finish it;
        call it at the top of a kernel."""
        for t in range(self.tasks.iterations):
            if t % self.tasks.stride == 0:
                self.walk_group(t // self.tasks.stride, law)

    @ti.func
    def walk_group(self, group, law: Template):
        """The same for the particles of a group."""
        law.begin(group)
        for i in range(self.tasks.first(group), self.tasks.first(group + 1)):
            own = law.own(i)
            first = i * self.room
            total, beyond = ti.Vector.zero(float, law.terms.size), ti.Vector.zero(float, law.terms.size)
            for a in range(first, first + self.near[i]):
                total += law.near(own, self.name[a], self.gradient[a])
            for a in range(first + self.near[i], first + self.seen[i]):
                beyond += law.image(own, self.name[a], self.gradient[a])
            law.finish(i, own, total, beyond, group)


@ti.func
def flips(mirror):
    """The axes along which a mirror turns what it shows, as a name has them."""
    turned = 0
    for k in ti.static(range(3)):
        turned += int(mirror[SIGN, k] < 0.0) << k
    return turned * MOST_PARTICLES
