"""Water: each module of this folder is a kind that a scene may name; sub-folders hold the parts that kinds share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from ocean_sim.conventions import Setting
from ocean_sim.waves import Components

if TYPE_CHECKING:  # other rooms know these by type alone; each is imported only where a scene needs it
    from ocean_sim.fluid.bodies.boundary import Boundary
    from ocean_sim.fluid.neighbours.grid import Grid
    from ocean_sim.fluid.neighbours.point_sum import PointSum
    from ocean_sim.fluid.open_sea.plane_waves import Window
    from ocean_sim.fluid.sph.lattice import Lattice as Lattice
    from ocean_sim.fluid.sph.particles import Particles
    from ocean_sim.fluid.sph.particles import Snapshot as Snapshot
    from ocean_sim.fluid.sph.pressure_solver import Solver


@dataclass(frozen=True)
class Limits:
    """Time scales [s] that bound the next time step, infinite where one does not apply: (a) acoustic h / (c + |v|), (b)
    viscous h^2 / nu, (c) force sqrt(h / |a|), with the smoothing length h (Monaghan 1992, Annu. Rev. Astron. Astrophys.
    30; Morris, Fox & Zhu 1997, J. Comput. Phys. 136, eqs. 30-32)."""

    acoustic: float = inf
    viscous: float = inf
    force: float = inf

    def and_of(self, other: Limits) -> Limits:
        """Shorter of each pair of time scales [s] of these limits and the `other` ones."""
        viscous, force = min(self.viscous, other.viscous), min(self.force, other.force)
        return Limits(min(self.acoustic, other.acoustic), viscous, force)


@dataclass(frozen=True)
class Status:
    """Extremes of speed, acceleration and density over all particles in the last step."""

    max_speed: float  # [m/s]
    max_acceleration: float  # [m/s2]
    min_density: float  # [kg/m3]
    max_density: float  # [kg/m3]
    clipped: int  # particles held back by `motion_limit`, since the start
    finite: bool  # no particle has a velocity or density that is not a number
    swelling: float = 0.0  # mean share by which particles inside the water stand thinner than their density says
    inner: int = 0  # particles so far inside the water that `swelling` counts them


class Totals(NamedTuple):
    """Sums over all particles in float64: density, its excess and lack, x, v, v^2, x cross v; and their bounds."""

    density: float  # [kg/m3]
    compression: float  # sum of max(density / rest density - 1, 0)
    most_compressed: float  # largest term of that sum, 0 where none is compressed
    deficit: float  # sum of max(1 - density / rest density, 0)
    squared_speed: float  # [m2/s2]
    position: np.ndarray  # (3,) [m]
    velocity: np.ndarray  # (3,) [m/s]
    turning: np.ndarray  # (3,) sum of position x velocity [m2/s]
    lower: np.ndarray  # (3,) lowest coordinates [m]
    upper: np.ndarray  # (3,) highest coordinates [m]

    @property
    def finite(self) -> bool:
        """True if every sum is a finite number."""
        return bool(np.isfinite(self.density + self.squared_speed + self.position.sum()))


class Stops(Protocol):
    """Interface of walls: coordinates [m] at which walls, floor and lid stop particle centres, and absorbing zones."""

    zones: tuple[tuple[Any, ...], ...]  # axis, begin and end along it [m], and how they absorb
    axes: range  # axes with walls
    low: tuple[float, ...]  # [m]
    up: tuple[float, ...]  # [m]
    gap: float  # [m] between a wall and where it stops them


class Hull(Protocol):
    """Interface of a ship's hull that pushes particles, at the hull's present position."""

    distance: Any  # signed distance of a point

    def distance_to(self, x: Any) -> Any:
        """ti.func: distance of x [m] from the hull [m], below 0 inside it; a lower bound far from it."""

    def push(self, x: Any, ahead: Any) -> Any:
        """ti.func: acceleration [m/s2] by which the hull pushes water at x [m], `ahead` [s] after the step began."""


class Contact(Protocol):
    """Interface of a ship that pushes particles: her hull, and the impulse and work of collisions with it."""

    @property
    def hull(self) -> Hull:
        """Ship's hull, whose ti.func `push` gives the acceleration [m/s2] of the water near it."""

    given: np.ndarray  # (3,) impulse [N s] of collisions on the water, since the start
    work: float  # [J] of these collisions


class Displacing(Protocol):
    """Interface of a floating body whose displacement makes waves, or whose position a patch of open sea follows."""

    body: Any  # `position` (3,) of its centre of mass [m]

    def displaced(self) -> tuple[np.ndarray, np.ndarray]:
        """Points x, z, depth (m, 3) [m] and volumes (m,) [m3] of the water that the body displaces; m may be 0."""


class Fluid(Protocol):
    """Interface of water; the defaults suit water without the feature concerned. Kernels can call `elevation`. Between
    steps all fields are current, and particles are sorted by grid cell."""

    config: Any  # the kind's Config
    particles: Particles | None = None  # None in a closed form
    sound_speed: float = 0.0  # [m/s]; 0 where nothing is compressed
    pressure_share: float = 1.0  # part of the gradient of the pressure that acts as a force
    reference_speed: float  # [m/s] speed to which `compression` refers
    rest_density: float  # [kg/m3]
    spacing: float  # [m] between particles at rest; in a closed form between points that show its waves
    status: Status
    boundary: Boundary | None = None  # None where the laws of the water meet no body
    current: tuple[float, float] = (0.0, 0.0)  # [m/s] velocity of all the water along x and z
    surface_drop: float = 0.0  # [m] depth of the first surface below the level that a scene gives
    solvers: Mapping[str, Solver] = {}  # by name

    @property
    def of_particles(self) -> ParticleFluid | None:
        """This water if it is made of particles, else None."""
        return None

    @property
    def in_closed_form(self) -> ClosedForm | None:
        """This water if it is a closed form (a sum of waves, without particles), else None."""
        return None

    @property
    def plane_waves(self) -> Components | None:
        """Plane waves whose sum is this water (a closed form) or the sea around it (a patch); None without waves."""
        return None

    @property
    def can_be_disturbed(self) -> bool:
        """True if the surface may differ from the sum of `plane_waves`."""
        return False

    @property
    def patch_centre(self) -> np.ndarray:
        """Centre x, z (2,) in the world [m] of a patch of open sea, which follows its ships; (0, 0) without a patch."""
        return np.zeros(2)

    def in_rim(self, points: np.ndarray) -> np.ndarray:
        """Mask (m,): True for points x, z (m, 2) [m] in the world that lie in a patch's relaxation zone; else False."""
        return np.zeros(len(points), dtype=bool)

    @property
    def count(self) -> int:
        """Number of particles now, 0 in a closed form."""
        return 0 if self.particles is None else int(self.particles.count.now)

    @property
    def impulse(self) -> dict[str, np.ndarray]:
        """Impulse (3,) [N s] on the water since the start, by name of the force term; empty if not summed."""
        return {}

    @property
    def work(self) -> dict[str, float]:
        """Work [J] on the water since the start, by name of the force term; empty if not summed. "gravity" includes the
        body force; "diffusion" is compression energy by density diffusion, "breaking" (negative) loss in breakers."""
        return {}

    @property
    def adjustable(self) -> dict[str, Setting]:
        """Settings that `adjust` can change during a run, by name; none by default."""
        return {}

    def adjust(self, **values: float) -> None:
        """Set the values of settings named in `adjustable` during a run, without compiling a kernel anew."""
        return

    def add_ships(self, ships: Sequence[Displacing]) -> tuple[Fluid, ...]:
        """Let ships displace the water; return, for each ship, the water around her without the waves she makes."""
        return (self,) * len(ships)

    def advance(self, dt: float) -> None:
        """Advance the water by one step of dt [s]; raise Diverged where a neighbour list overflows."""

    def elevation(self, x: Any, z: Any) -> Any:
        """ti.func: height [m] of the surface above the still level at x, z [m]; of the bed where it is dry."""

    def elevations(self, points: np.ndarray) -> np.ndarray:
        """Heights (m,) [m] of the surface at points x, z (m, 2) [m]; for calls outside kernels."""

    def undisturbed_elevations(self, points: np.ndarray, elevation: np.ndarray) -> np.ndarray | None:
        """Heights (m,) [m] at `points` x, z (m, 2) [m] without ships' waves, or None if unknown; `elevation` (m,) [m]:
        heights with them."""
        return None

    def pressures(self, points: np.ndarray) -> np.ndarray:
        """Pressures (m,) [Pa] at points (m, 3) [m], walls and bed included; 0 where it is dry."""

    def velocities(self, points: np.ndarray) -> np.ndarray:
        """Velocities (m, 3) [m/s] at points (m, 3) [m]; 0 where it is dry."""

    def surface_velocities(self, points: np.ndarray) -> np.ndarray:
        """Velocities (m, 3) [m/s] of the surface at points x, z (m, 2) [m]."""
        return self.velocities(np.insert(points, 1, self.elevations(points), axis=1))

    def foam(self, points: np.ndarray) -> np.ndarray | None:
        """Share (m,) of the surface covered by foam at points x, z (m, 2) [m]; None if breaking is not modelled."""
        return None

    def limits(self) -> Limits:
        """Time scales [s] that bound the next time step: it must stay below a set fraction of each."""

    def internal_energy(self) -> float:
        """Energy of compression [J]; 0 where nothing is compressed."""
        return 0.0


class Arriving(NamedTuple):
    """Amplitude, phase and frequency (n,) of the plane waves at one place when the water's last step began."""

    amplitude: np.ndarray  # [m]
    angle: np.ndarray  # phase [rad]: amplitude cos(angle) is the elevation
    omega: np.ndarray  # [rad/s] in axes that move with the current
    heading: np.ndarray  # direction of travel [rad]: 0 along +z, a right angle along +x
    wavenumber: np.ndarray  # [rad/m]

    def encounter_frequencies(self, velocity: np.ndarray) -> np.ndarray:
        """Encounter frequencies (n,) [rad/s] at a velocity (3,) [m/s] through the water; negative: overtaken waves."""
        ahead = np.sin(self.heading) * velocity[0] + np.cos(self.heading) * velocity[2]
        return self.omega - self.wavenumber * ahead


class ClosedForm(Fluid, Protocol):
    """Interface of water without particles: plane waves, plus waves stored on grids (tiles), at any depth."""

    current: tuple[float, float]  # velocity of all the water along x and z [m/s]

    def arriving(self, x: float, z: float, afar: bool = False) -> Arriving:
        """Plane waves at x, z [m] when the last step began, as floating bodies meet them; heights times the ramp in
        time. Flat for a nonlinear sea, which kernels read from a grid; with `afar`, its waves by linear theory."""

    def rise(self, x: Any, z: Any) -> Any:
        """ti.func: elevation [m] at x, z [m] by the waves stored on grids (tiles) alone, when the last step began."""

    def moving(self, x: Any, z: Any, depth: Any) -> Any:
        """ti.func: velocity [m/s] and acceleration [m/s2] of the water by the current and the waves stored on grids
        (tiles), plane waves left out, at x, z and a Wheeler-stretched `depth` [m]."""

    def window(self, size: tuple[int, int], step: tuple[float, float], depths: tuple[float, ...]) -> Window:
        """Make a table (Window) of the plane waves on a lattice of `size` nodes, `step` [m] apart, at `depths` [m]."""


class ParticleFluid(Fluid, Protocol):
    """Interface of water made of particles."""

    particles: Particles
    around: PointSum
    grid: Grid
    walls: Stops
    contacts: list[Contact]  # hulls that push it

    def begin(self) -> None:
        """Sort the particles and update their fields, after positions and velocities were set from outside."""

    def add_contact(self, contact: Contact) -> None:
        """Add a ship's hull, which pushes the water from the first step on."""

    def totals(self) -> Totals:
        """Sums of density, position, velocity and more (Totals) over all particles now, and their bounding box."""

    def positions(self) -> np.ndarray:
        """Positions (n, 3) [m] of the particles in float64, at least as exact as `particles.position`."""


def with_particles(fluid: Fluid) -> ParticleFluid:
    """Cast water to its particle interface; the caller knows that it has particles."""
    water = fluid.of_particles
    assert water is not None, "this water is a closed form"
    return water
