"""Water: every module of this folder is a kind a scene may name; `shared` holds what they have in common."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import Any, NamedTuple, Protocol

import numpy as np

from ocean_sim.conventions import Setting
from ocean_sim.kernel_library import ti
from ocean_sim.waves import Components


@dataclass(frozen=True)
class Limits:
    """What the time step must stay a fraction of [s]; infinite where there is no such limit.

    With h the smoothing length: acoustic h / (c + |v|), viscous h^2 / nu, force sqrt(h / |a|)
    (Monaghan 1992, Annu. Rev. Astron. Astrophys. 30; Morris, Fox & Zhu 1997, J. Comput. Phys. 136, eqs. 30-32).
    """

    acoustic: float = inf
    viscous: float = inf
    force: float = inf

    def and_of(self, other: "Limits") -> "Limits":
        """The shorter of each."""
        viscous, force = min(self.viscous, other.viscous), min(self.force, other.force)
        return Limits(min(self.acoustic, other.acoustic), viscous, force)


@dataclass(frozen=True)
class Status:
    """What the last step looked like, over all particles."""

    max_speed: float  # [m/s]
    max_acceleration: float  # [m/s2]
    min_density: float  # [kg/m3]
    max_density: float  # [kg/m3]
    clipped: int  # particles held back by `motion_limit`, since the start
    finite: bool  # no particle has a velocity or density that is not a number


class Totals(NamedTuple):
    """Sums over all particles, in float64, and the box that they lie in."""

    density: float  # [kg/m3]
    compression: float  # of max(density / rest density - 1, 0)
    most_compressed: float  # the largest of the same, 0 where none is compressed
    deficit: float  # of max(1 - density / rest density, 0)
    squared_speed: float  # [m2/s2]
    position: np.ndarray  # (3,) [m]
    velocity: np.ndarray  # (3,) [m/s]
    turning: np.ndarray  # (3,) of position x velocity [m2/s]
    lower: np.ndarray  # (3,) lowest coordinates of any [m]
    upper: np.ndarray  # (3,) highest coordinates of any [m]

    @property
    def finite(self) -> bool:
        """Whether all that is added up is a number."""
        return bool(np.isfinite(self.density + self.squared_speed + self.position.sum()))


class Lattice(Protocol):
    """Where the particles of a water are at first, counted but not yet made."""

    @property
    def boxes(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Lowest and highest corner of each box of water [m]."""
        ...

    @property
    def n(self) -> int:
        """Number of particles; where there is an emitter, the most there will be."""
        ...

    @property
    def spacing(self) -> float:
        """Distance between particles [m]."""
        ...

    @property
    def height(self) -> float:
        """Height of the tallest box of water [m]."""
        ...

    @property
    def deepest(self) -> float:
        """Height of its tallest column of water, of boxes that stand on one another [m]."""
        ...

    def positions(self) -> np.ndarray:
        """(n, 3) positions of the particles [m]."""
        ...


class Vectors(Protocol):
    """A vector for each particle, as three Taichi fields, in storage order."""

    x: ti.Field
    y: ti.Field
    z: ti.Field

    @property
    def precision(self) -> type:
        """The NumPy type of its numbers."""
        ...

    def to_numpy(self) -> np.ndarray:
        """(n, 3) of the particles that are there."""
        ...

    def from_numpy(self, values: np.ndarray) -> None:
        """Takes (n, 3)."""
        ...


class Count(Protocol):
    """How many particles there are; an emitter adds to them."""

    now: int

    def there(self) -> Any:
        """ti.func: the same in a kernel."""
        ...


class Copied(NamedTuple):
    """What n particles hold at a time, in storage order."""

    position: np.ndarray  # (n, 3) [m]
    velocity: np.ndarray  # (n, 3) [m/s]
    id: np.ndarray  # (n,)
    pressure: np.ndarray  # (n,) [Pa]


class Particles(Protocol):
    """The particles of a fluid, in the order of their cells, which changes from step to step; `id` stays."""

    @property
    def n(self) -> int:
        """The most there will be: the length of the fields."""
        ...

    @property
    def count(self) -> Count:
        """How many there are."""
        ...

    @property
    def mass(self) -> float:
        """Of each [kg]; in 2-D [kg/m]."""
        ...

    @property
    def rest_density(self) -> float:
        """[kg/m3]"""
        ...

    @property
    def spacing(self) -> float:
        """Distance at rest [m]."""
        ...

    @property
    def position(self) -> Vectors:
        """[m]"""
        ...

    @property
    def velocity(self) -> Vectors:
        """[m/s]"""
        ...

    @property
    def id(self) -> ti.Field:
        """Number of the particle in the first lattice."""
        ...

    @property
    def density(self) -> ti.Field:
        """[kg/m3]"""
        ...

    @property
    def pressure(self) -> ti.Field:
        """[Pa]"""
        ...

    def copied(self) -> Copied:
        """All of them now, by one launch."""
        ...

    def in_box(self, middle: np.ndarray, scale: np.ndarray, most: float, every: int) -> np.ndarray:
        """(m, 4) of every so many, by identity: where it is from the middle [m] times `scale` [1/m], a whole number
        within -`most` and `most` along each axis, and its speed [m/s]."""
        ...


class Around(Protocol):
    """Sums over the water within one support of a point (`shared/around.py`)."""

    def total(self, x: Any, law: Any, own: Any) -> Any:
        """ti.func: what a law adds up around x [m]; the law gets `own` handed through."""
        ...


class Cells(Protocol):
    """The cells that particles are sorted into, at least a support wide, one empty layer all round."""

    support: float  # [m] of the kernels
    quantum: float  # [m] positions are multiples of it
    cells: tuple[int, int, int]  # along x, y and z
    sky: int  # uppermost layers in which what flies above them is, too
    lower: Any  # vec3 [m] where the first inner cell begins
    per_width: Any  # vec3 [1/m] one over the width of a cell
    start: ti.Field  # first particle of each cell

    def cell_at(self, indices: Any) -> Any:
        """ti.func: number of a cell, of its ivec3 of indices."""
        ...


class Stops(Protocol):
    """Where walls, floor and lid stop the centres of particles."""

    axes: range  # along which there are walls
    low: tuple[float, ...]  # [m]
    up: tuple[float, ...]  # [m]
    gap: float  # [m] between a wall and where it stops them


class SolidBodies(Protocol):
    """The solid bodies that the laws of a scheme meet (`shared/boundary.py`): obstacles first, then what floats."""

    bodies: Any  # samples of each: `volume` (m,) [m3], `position` (m, 3) [m] from its origin

    def place(
        self,
        body: int,
        position: np.ndarray,
        rotation: np.ndarray,
        velocity: Any,
        angular_velocity: Any,
        acceleration: Any,
        angular_acceleration: Any,
    ) -> None:
        """Say where a body is when the next step ends and how it moves."""
        ...

    def forces(self) -> tuple[np.ndarray, np.ndarray]:
        """Force (k, 3) [N] and torque (k, 3) [N m] about its origin of the water on each body in the last step."""
        ...


class Hull(Protocol):
    """A hull among particles, where it is now."""

    distance: Any  # what knows how far a point is from it

    def away(self, x: Any) -> Any:
        """ti.func: distance of x [m] from it [m]; inside it below 0, far from it as far as is known."""
        ...

    def push(self, x: Any, ahead: Any) -> Any:
        """ti.func: acceleration [m/s2] of water at x [m], `ahead` [s] of the beginning of the step."""
        ...


class Contact(Protocol):
    """A ship that the water meets."""

    @property
    def hull(self) -> Hull:
        """Which pushes."""
        ...

    given: np.ndarray  # (3,) impulse [N s] to the water by collisions, since the start
    work: float  # [J] of them


class Displacing(Protocol):
    """What floats in a water that answers to it."""

    body: Any  # `position` (3,) of its centre of mass [m]

    def displaced(self) -> tuple[np.ndarray, np.ndarray]:
        """Where it displaces water, x and z (m, 2) [m], and how much there (m,) [m3]; m is 0 where its law of motion
        does not say."""
        ...


class Iterations(Protocol):
    """How an iterative solver fared."""

    last_iterations: int  # in the last step
    last_error: float  # that it left, over the rest density
    iterations: int  # since the start
    error: float  # the worst since the start
    unsolved: int  # steps that ended above the tolerance


class Fluid(Protocol):
    """Water. `elevation` is callable from a Taichi kernel; between steps everything is current and in cell order.
    Kinds of water derive from it: what a kind has nothing of has its default here."""

    config: Any  # the kind's Config
    particles: Particles | None = None  # None where the water has none: a closed form
    sound_speed: float  # [m/s]; 0 where nothing is compressed
    reference_speed: float  # [m/s] that compression refers to
    rest_density: float  # [kg/m3]
    spacing: float  # [m] between particles at rest; of a closed form between points that show its waves
    status: Status
    boundary: SolidBodies | None = None  # None where the laws of the water meet no body
    current: tuple[float, float] = (0.0, 0.0)  # [m/s] along x and z, in which all of it flows
    sunk: float = 0.0  # [m] how far below the level that was asked for its surface begins
    solvers: Mapping[str, Iterations] = {}  # by name

    @property
    def of_particles(self) -> "ParticleFluid | None":
        """Itself where it is made of particles."""
        return None

    @property
    def in_closed_form(self) -> "ClosedForm | None":
        """Itself where it is one."""
        return None

    @property
    def plane_waves(self) -> Components | None:
        """The plane waves that it is the sum of, where it is a closed form, or a patch of."""
        return None

    @property
    def answers(self) -> bool:
        """Whether its surface is, or may become, more than the sum of its `plane_waves`."""
        return False

    @property
    def patch_centre(self) -> np.ndarray:
        """(2,) x, z in the world [m] of the middle of a patch of open sea, which follows its ships; elsewhere of the
        basin."""
        return np.zeros(2)

    def in_rim(self, points: np.ndarray) -> np.ndarray:
        """(m,) whether points x, z (m, 2) in the world [m] lie in the rim of a patch of open sea."""
        return np.zeros(len(points), dtype=bool)

    @property
    def count(self) -> int:
        """Number of particles now, 0 of a closed form."""
        return 0 if self.particles is None else int(self.particles.count.now)

    @property
    def impulse(self) -> dict[str, np.ndarray]:
        """Impulse of each term since the start [N s], (3,) each; empty where no accounts are kept."""
        return {}

    @property
    def work(self) -> dict[str, float]:
        """Work of each term since the start [J], gravity's with the body force's; diffusion's is what it compresses;
        breaking's what it takes of a tile of nonlinear sea. Empty where no accounts are kept."""
        return {}

    @property
    def adjustable(self) -> dict[str, Setting]:
        """What `adjust` can change while the water moves."""
        return {}

    def adjust(self, **values: float) -> None:
        """Go on with other values of what is adjustable; nothing is compiled for it."""
        return

    def carry(self, ships: "Sequence[Displacing]") -> "tuple[Fluid, ...]":
        """The water as each of these ships feels it, which from now on they displace: this one for all of them, unless
        a kind distinguishes what each of them makes."""
        return (self,) * len(ships)

    def advance(self, dt: float) -> None:
        """One step of dt [s] under the wind it was built with; raises Diverged when a neighbour list overflows."""
        ...

    def elevation(self, x: Any, z: Any) -> Any:
        """ti.func: height of the water [m] above the still surface; the bed where it is dry."""
        ...

    def elevations(self, points: np.ndarray) -> np.ndarray:
        """The same from Python: (m, 2) points x, z [m] -> (m,) heights [m]."""
        ...

    def undisturbed(self, points: np.ndarray, elevation: np.ndarray) -> np.ndarray | None:
        """The same without what ships do to it, where with that the `elevation` is (m,) [m]; None where the water does
        not keep that apart."""
        return None

    def pressures(self, points: np.ndarray) -> np.ndarray:
        """(m, 3) points [m], also on sides and bed -> (m,) pressures [Pa]; 0 where it is dry."""
        ...

    def velocities(self, points: np.ndarray) -> np.ndarray:
        """(m, 3) points [m] -> (m, 3) velocities [m/s]; 0 where it is dry."""
        ...

    def surface_velocities(self, points: np.ndarray) -> np.ndarray:
        """(m, 2) points x, z [m] -> (m, 3) velocities of the surface there [m/s]."""
        return self.velocities(np.insert(points, 1, self.elevations(points), axis=1))

    def foam(self, points: np.ndarray) -> np.ndarray | None:
        """(m, 2) points x, z [m] -> (m,) share of the surface that broken crests have made white; None where it does
        not know of crests that break."""
        return None

    def limits(self) -> Limits:
        """What the next step must stay a fraction of."""
        ...

    def internal_energy(self) -> float:
        """Energy of compression [J]; 0 where nothing is compressed."""
        ...


class Window(Protocol):
    """Plane waves on a lattice of nodes and levels that lies still in the water for a moment."""

    depth: float  # of the water [m]
    span: float  # for so long it holds [s]

    @property
    def current(self) -> tuple[float, float]:
        """Velocity of the water along x and z, which carries the lattice with it [m/s]."""
        ...

    @property
    def step_taken(self) -> float:
        """How long the water's last step was, which bodies take after it [s]."""
        ...

    def now(self) -> tuple[float, float, bool]:
        """How much of its time has gone, 0 to 1, how far the waves have grown, as what it gives is of waves that are
        fully grown, and whether it still holds."""
        ...

    def lay(self, centre: tuple[float, float], heading: tuple[float, float]) -> None:
        """Around a place x, z [m], its first axis along a unit vector in x and z, from now on."""
        ...

    def elevation(self, i: Any, k: Any, late: Any) -> Any:
        """ti.func: of a node [m]."""
        ...

    def moving(self, i: Any, k: Any, l: Any, late: Any) -> Any:
        """ti.func: velocity [m/s] and acceleration [m/s2] there on a level."""
        ...


class Arriving(NamedTuple):
    """Plane waves at one place when the last step began, where bodies are that step after the water, n of them."""

    amplitude: np.ndarray  # [m]
    angle: np.ndarray  # phase [rad]: amplitude cos(angle) is the elevation
    omega: np.ndarray  # [rad/s], from water that goes with the current
    heading: np.ndarray  # to which they go [rad]: 0 along +z, a right angle along +x
    wavenumber: np.ndarray  # [rad/m]

    def met(self, velocity: np.ndarray) -> np.ndarray:
        """Their frequency [rad/s] from a place that moves through the water (3,) [m/s]; negative where it overtakes
        them."""
        ahead = np.sin(self.heading) * velocity[0] + np.cos(self.heading) * velocity[2]
        return self.omega - self.wavenumber * ahead


class ClosedForm(Fluid, Protocol):
    """What water without particles has beyond that: it can be asked below its surface from a kernel."""

    current: tuple[float, float]  # which carries the water, along x and z [m/s]

    def arriving(self, x: float, z: float) -> Arriving:
        """Its plane waves at a place [m], at the time of the bodies in it."""
        ...

    def rise(self, x: Any, z: Any) -> Any:
        """ti.func: elevation of what is not plane waves [m]."""
        ...

    def moving(self, x: Any, z: Any, depth: Any) -> Any:
        """ti.func: velocity [m/s] and acceleration [m/s2] of that, at a depth of the unstretched column [m]."""
        ...

    def window(self, size: tuple[int, int], step: tuple[float, float], depths: tuple[float, ...]) -> Window:
        """Its plane waves at so many nodes along and across, so far apart, and on levels at some depths [m]."""
        ...


class ParticleFluid(Fluid, Protocol):
    """What water made of particles has beyond that."""

    particles: Particles
    around: Around
    grid: Cells
    walls: Stops
    contacts: list[Contact]  # hulls that push it

    def begin(self) -> None:
        """Start from the particles as they are now."""
        ...

    def meet(self, contact: Contact) -> None:
        """From the first step on feel the push of one more hull."""
        ...

    def totals(self) -> Totals:
        """Sums over the particles as they are now."""
        ...

    def positions(self) -> np.ndarray:
        """(n, 3) of the particles [m], in float64, with more digits than `particles.position` may hold."""
        ...


def with_particles(fluid: Fluid) -> ParticleFluid:
    """Water that is known to be made of particles."""
    water = fluid.of_particles
    assert water is not None, "this water is a closed form"
    return water
