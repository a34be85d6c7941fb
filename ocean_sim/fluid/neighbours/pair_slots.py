"""Pairs of neighbours kept for a step: what iterates over them again and again finds each with its gradient.

An image is named by its particle and by the axes along which it is mirrored, so what it has follows its particle.
"""

from abc import ABC, abstractmethod
from typing import Any

from ocean_sim.fluid.bodies.emitter import MOST_PARTICLES
from ocean_sim.fluid.neighbours.images import SIDE, SIGN, Images
from ocean_sim.fluid.neighbours.thread_tasks import Tasks
from ocean_sim.fluid.sph.law import Law
from ocean_sim.kernel_library import ti
from ocean_sim.runtime import Template, in_kernels

ROOM = 2.5  # slots of a particle, over its neighbours on the lattice
LEAST = 48  # slots of a particle at least


def slots(neighbours: int) -> int:
    """Of a particle that has so many neighbours on the lattice."""
    return max(LEAST, int(ROOM * neighbours))


def bytes_kept(n: int, neighbours: int, word: int) -> int:
    """Bytes of the Pairs of n particles, where `word` is the size of a `float` [bytes]."""
    return n * (8 + slots(neighbours) * (4 + 3 * word))


@in_kernels
class KeptLaw(Law):
    """A law summed over kept pairs, whose gradients are known: it `reads` the fields of its row but the position."""

    @abstractmethod
    def kept_image(self, other: Any, name: Any, away: Any) -> Any:
        """Row of a neighbour, `other`, as the sides show it that its name tells; `away` leads from there into the
        water."""

    @abstractmethod
    def kept_pair(self, own: Any, other: Any, gradient: Any) -> Any:
        """Term of one neighbour, as `pair`; `gradient`: x_ij times the shape of grad W."""


@in_kernels
class KeptPairs(ABC):
    """Of each particle its neighbours and images."""

    def __init__(self, images: Images) -> None:
        self.images = images
        self.pistons = tuple((s, side.axis, side.upper) for s, side, _ in images.pistons)

    @abstractmethod
    def walk(self, law: Any) -> None:
        """ti.func, at the top of a kernel: for every particle, sum law.kept_pair over its neighbours, and over its
        images, then law.finish it."""

    @ti.func
    def read(self, law: Template, j):
        """What a law reads of particle j."""
        return ti.Vector([field[j] for field in ti.static(law.reads)])

    @ti.func
    def seen_as(self, law: Template, name, away):
        """The same of an image."""
        return law.kept_image(self.read(law, name % MOST_PARTICLES), name, away)

    @ti.func
    def velocity(self, v, name, away):
        """Of the image of what moves with v [m/s]: only its normal velocity is turned round, whatever the slip."""
        image, flips = v, name // MOST_PARTICLES
        for k in ti.static(range(3)):
            image[k] = ti.select(flips >> k & 1, -image[k], image[k])
        for s, axis, upper in ti.static(self.pistons):
            beyond = away[axis] < 0.0 if ti.static(upper) else away[axis] > 0.0
            image[axis] += ti.select(
                (flips >> axis & 1) and beyond, self.images.side[s, SIDE.twice_velocity + axis], 0.0
            )
        return image


@in_kernels
class Pairs(KeptPairs):
    """The same, each particle with slots of its own: pairs with particles first, those with images after them."""

    def __init__(self, n: int, images: Images, tasks: Tasks, neighbours: int) -> None:
        super().__init__(images)
        self.tasks, self.room = tasks, slots(neighbours)
        self.name = ti.field(int, shape=n * self.room)
        self.gradient = ti.Vector.field(3, float, shape=n * self.room)
        self.near, self.seen = (ti.field(int, shape=n) for _ in range(2))  # particles, and images with them

    @ti.func
    def walk(self, law: Template):
        for t in range(self.tasks.iterations):
            if t % self.tasks.stride == 0:
                self.walk_group(t // self.tasks.stride, law)

    @ti.func
    def walk_group(self, group, law: Template):
        """The same for the particles of a group."""
        law.begin(group)
        for i in range(self.tasks.first(group), self.tasks.first(group + 1)):
            own, first = self.read(law, i), i * self.room
            total, beyond = ti.Vector.zero(float, law.terms.size), ti.Vector.zero(float, law.terms.size)
            for a in range(first, first + self.near[i]):
                total += law.kept_pair(own, self.read(law, self.name[a]), self.gradient[a])
            for a in range(first + self.near[i], first + self.seen[i]):
                gradient = self.gradient[a]
                beyond += law.kept_pair(own, self.seen_as(law, self.name[a], gradient), gradient)
            law.finish(i, own, total, beyond, group)


@ti.func
def flips(mirror):
    """The axes along which a mirror turns what it shows, as a name has them."""
    turned = 0
    for k in ti.static(range(3)):
        turned += int(mirror[SIGN, k] < 0.0) << k
    return turned * MOST_PARTICLES
