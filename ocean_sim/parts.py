"""Contract of the parts of a scene, such as water, wind and ships. A part fills a slot, a key of the scene, with one of
its kinds, and a kind is one file: "kind: gusts" under "wind:" is `ocean_sim/wind/gusts.py`, imported when it is named.

This module holds the base classes of a part's `Config`, with everything that a scene asks of it between reading and
building. The object that a Config builds has a protocol in the `__init__.py` of its slot.
"""

from __future__ import annotations

import re
from abc import abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from importlib import import_module
from importlib.resources import files
from math import hypot, inf, pi
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self, cast

from ocean_sim.conventions import GRAVITY
from ocean_sim.model import Faults, Model

if TYPE_CHECKING:
    from ocean_sim import waves
    from ocean_sim.basin import Basin, Solid
    from ocean_sim.basin.open_sea import Nonlinear, Rim
    from ocean_sim.fluid import Fluid, Lattice, Limits
    from ocean_sim.platform import Platform
    from ocean_sim.ship import Afloat, Look, Outline, Ship
    from ocean_sim.surface import Surface
    from ocean_sim.time_step import TimeStep
    from ocean_sim.wind import Target, Wind

SLOTS = ("sea", "wind", "fluid", "surface", "ship", "platform", "time_step")
ALONE = "ship"  # the name of a ship that has none: the only one, written under `ship`
SEVERAL = "ships"  # the key of a mapping of named ships
KEYS_BESIDE_SLOTS = {"rim": "sea"}  # keys that may also stand beside the part that they belong to
GRAVITY_TOLERANCE = 0.1  # [m/s2] by which gravity may differ from that under a platform
MEANT = {"sea": "linear_waves"}  # the kind of a part that names none
PACKAGE = Path(str(files("ocean_sim")))


@cache
def library(folder: str) -> Path:
    """Path of the data folder `scenes`, `configs` or `figures`: in the package, or beside it in a checkout."""
    inside = PACKAGE / folder
    return inside if inside.is_dir() else PACKAGE.parent / folder


@cache
def kinds(slot: str) -> tuple[str, ...]:
    """Names of the kinds that a scene may choose in this slot, as `gusts` for `wind`: the modules of its folder."""
    return tuple(sorted(p.stem for p in (PACKAGE / slot).glob("[!_]*.py")))


@cache
def named(slot: str) -> tuple[str, ...]:
    """Names of the presets of this slot, such as `wind`: the files of configs/<slot>/."""
    return tuple(sorted(p.stem for p in (library("configs") / slot).glob("*.yaml")))


def preset(slot: str, name: str) -> dict[str, Any]:
    """Content of the preset file configs/<slot>/<name>.yaml; raises ValueError if there is none."""
    from ocean_sim.files import yaml_file

    if name not in named(slot):
        raise ValueError(f"there is no {slot} {name!r}; there are {', '.join(named(slot))}")
    return yaml_file.read_mapping(library("configs") / slot / f"{name}.yaml").plain()


def key_of(ship: str) -> str:
    """Key of a ship in a scene by the ship's name: `ship` for the only one, `ships.<name>` for one of several."""
    return ALONE if ship == ALONE else f"{SEVERAL}.{ship}"


def slot_of(place: str) -> str:
    """Slot of a part from its key `place` in a scene: `ship` for the key `ships.<name>`, for others the key itself."""
    return ALONE if place.startswith(f"{SEVERAL}.") else place


def called(ship: str) -> str:
    """Words for a ship in messages: `the ship` if she is the only one, else her name in the scene."""
    return "the ship" if ship == ALONE else ship


class LedgerRow(NamedTuple):
    """Row of a scene's memory table: an item that a part of the scene has allocated or compiled, its bytes, and why."""

    part: str
    what: str
    bytes: int
    why: str


class PartConfig(Model):
    """Settings of one part of a scene, such as `fluid`, and the methods by which a scene examines it before it is
    built.

    Each of these methods gets the one `SceneFacts` of the scene. `ledger` and, in each slot's own base class below,
    `build` have no default: a kind without them cannot be instantiated."""

    def problems(self, preflight: SceneFacts) -> Faults:
        """Mistakes (key, sentence) in these settings by themselves; other parts may be wrong, and must not be read."""
        return ()

    def mismatches(self, preflight: SceneFacts) -> Faults:
        """Mistakes (key, sentence) of these settings together with other parts; called if no part has `problems`."""
        return ()

    def warnings(self, preflight: SceneFacts) -> Iterable[str]:
        """Warnings for the readers of the results of this scene, a sentence each; none by default."""
        return ()

    @abstractmethod
    def ledger(self, preflight: SceneFacts) -> Iterable[LedgerRow]:
        """Rows of the memory ledger, one for each thing that this part will allocate or compile."""


class KindConfig(PartConfig):
    """Base of the settings of a slot with several implementations (kinds); the scene's key `kind` chooses one."""

    example: ClassVar[dict[str, Any]] = {}
    """The keys that have no default, with values that suit any basin a few metres in size."""
    compared: ClassVar[bool] = False
    """True if studies compare it with others of its slot."""
    fineness: ClassVar[int] = 0
    """Its rank where the kinds of its slot are ordered from the coarsest to the finest."""
    unheeded: ClassVar[tuple[str, ...]] = ()
    """Keys that change no number of a run."""

    kind: str


class SeaConfig(KindConfig):
    """Base of the settings of an open sea, of which the particles of a scene are a patch with periodic sides."""

    if TYPE_CHECKING:  # keys of each kind
        rim: Rim
        feed: float | None
        ramp: float | None

    @property
    @abstractmethod
    def significant_height(self) -> float:
        """Significant wave height [m]; 0 in calm water."""

    @property
    def nonlinear(self) -> Nonlinear | None:
        """Settings of a nonlinear sea; None for a linear sea, which is the sum of its plane waves."""
        return None

    @abstractmethod
    def plane_waves(self, basin: waves.Tank) -> waves.Components | None:
        """Plane waves of the sea by linear theory, before they are fitted to the patch; None in calm water."""

    def problems(self, preflight: SceneFacts) -> Faults:
        """Mistakes (key, sentence) that forbid a patch of sea in this basin, such as sides that are not periodic."""
        tank, across = preflight.tank, preflight.tank.dimension == 3
        periods = [tank.periods[axis] for axis in ((0, 2) if across else (0,))]
        if not all(periods):
            yield ("kind",), "a patch of open sea has periodic sides; set basin.walls: periodic"
        for name in ("wavemaker", "motion", "lid", "obstacles"):
            if getattr(tank.config, name):
                yield ("kind",), f"a patch of open sea has no {name}; leave basin.{name} out"
        if self.rim.width is not None and all(periods) and self.rim.width > (most := 0.5 * min(periods)):
            yield ("rim", "width"), f"leaves no water free; at most {most:g} m, half of the patch"
        if not across and self.rim.velocity[1]:
            yield ("rim", "velocity"), "in 2-D it is only along x; give [speed, 0.0]"

    def ledger(self, preflight: SceneFacts) -> list[LedgerRow]:
        return []


class WindConfig(KindConfig):
    """Base of the settings of all kinds of wind."""

    still: ClassVar[bool] = False
    """True if there is no wind."""

    @property
    def acts_on(self) -> Sequence[Target]:
        """Targets, "fluid" and "ship", on which the wind acts; others are in still air."""
        return ("fluid", "ship")

    @property
    def needs_area(self) -> bool:
        """True if the wind's force on a particle needs its area of free surface; else no areas are computed."""
        return "fluid" in self.acts_on

    @property
    def needs_bend(self) -> bool:
        """True if the wind's force on a particle also needs the local change of the surface's slope; else 0 is used."""
        return False

    @property
    def is_random(self) -> bool:
        """True if the wind draws random numbers from the seed of the scene."""
        return False

    @property
    def strongest(self) -> float:
        """Highest wind speed [m/s], 10 m above the water, that these keys state; 0 if they state none."""
        return 0.0

    def warnings(self, preflight: SceneFacts) -> Iterable[str]:
        """Warn by the ships' names if the wind does not act on them. A kind with a key `targets` gives none."""
        if "ship" not in self.acts_on and preflight.ships:
            ships = " and ".join(map(called, preflight.ships))
            yield f"wind: {self.kind} does not act on ships; it leaves {ships} in still air"

    @abstractmethod
    def build(self, basin: Basin, seed: int) -> Wind:
        """Build the wind over a basin; `seed`: seed of its random numbers."""


class FluidConfig(KindConfig):
    """Base of the settings of all kinds of water, whether of particles or in closed form."""

    rest_density: float

    made_of_particles: ClassVar[bool] = False
    """True if it is made of particles, which start on a `lattice`; else it is a closed form."""
    counts_in_doubles: ClassVar[bool] = True
    """True if its steps add up in float64, which not every graphics card has."""
    conserves_momentum: ClassVar[bool] = False
    """True if the exchange between its particles keeps momentum and angular momentum to rounding."""
    bears_shear: ClassVar[float] = 0.0
    """Shear that its particles bear without flowing, once they have lost their rows, over the pressure at the bed;
    measured in basins like that of the validation case wind_setup, 20 s long."""
    joins_a_sea: ClassVar[bool] = False
    """True if its particles may be a patch of open sea."""
    bears: ClassVar[bool] = True
    """True if it has a pressure, which bears floating bodies."""
    misread: ClassVar[str] = ""
    """The fault of pressures that gauges read in it; empty where they are to be relied on."""
    carries_bodies: ClassVar[bool] = False
    """True if it answers to a body within a step, so that a ship of kind `pressure` may float on it."""

    def lattice(self, basin: Basin) -> Lattice | None:
        """Lattice on which the particles start in this basin; None for water in closed form."""
        return None

    def most_particles(self, preflight: SceneFacts) -> int:
        """Approximate greatest number of particles that neighbour lists can index; 0 for water without particles."""
        return 0

    def ratio(self, basin: Basin) -> float:
        """Ratio of the smoothing kernel's support radius to the particle spacing; 0 for water without particles."""
        return 0.0

    @property
    def support_asked(self) -> float | None:
        """Support radius over particle spacing that the user asks for, or that the scheme fixes; None by default."""
        return None

    def sound_speed(self, basin: Basin) -> float:
        """Speed of sound c [m/s]; 0 for water that is not compressed."""
        return 0.0

    @property
    def viscosity_asked(self) -> float:
        """Kinematic viscosity [m2/s] that the user asks for; 0 if none."""
        return 0.0

    @property
    def compression_asked(self) -> float:
        """Compression (relative rise of the density) that the user asks for or allows; 0 if none is given."""
        return 0.0

    def settling(self, preflight: SceneFacts) -> float:
        """Distance [m] by which the surface sinks before the first step, under the weight of the water."""
        return 0.0

    def speed(self, basin: Basin) -> float:
        """Reference speed [m/s] of the water; by default sqrt(gravity x depth), the speed of long waves."""
        return (hypot(*basin.gravity) * basin.depth) ** 0.5

    @property
    def steady_force(self) -> tuple[float, float, float]:
        """Constant acceleration (x, y, z) [m/s2] of the water in addition to gravity: a body force."""
        return (0.0, 0.0, 0.0)

    @property
    def driven(self) -> bool:
        """True if inflow or a body force may add energy to the water."""
        return False

    def viscosity_added(
        self, preflight: SceneFacts, length: float, height: float = 0.0, standing: bool = False
    ) -> float:
        """Numerical viscosity [m2/s] that the scheme adds, as measured, for waves of a length and height [m];
        `standing`: for standing instead of travelling waves."""
        return 0.0

    def statements(self, preflight: SceneFacts) -> Iterable[str]:
        """Sentences about this water that a reader of its results should know; none by default."""
        return ()

    def notes(self, preflight: SceneFacts) -> Iterable[str]:
        """Sentences on effects that the model of the water leaves out in this scene; they ask for no change."""
        return ()

    def point_spacing(self, preflight: SceneFacts) -> float:
        """Distance [m] between the points at which frames store the height of the water, unless the scene sets it."""
        return preflight.spacing or preflight.tank.depth

    def window_bytes(self, preflight: SceneFacts, size: tuple[int, int], levels: int) -> int:
        """Memory [bytes] of plane-wave sums on a grid: `size` (along, across) nodes at `levels` depths; default 0."""
        return 0

    @abstractmethod
    def still_limits(self, preflight: SceneFacts) -> Limits:
        """Limits of the time step for water at rest, known before any memory is allocated."""

    @abstractmethod
    def build(self, basin: Basin, seed: int, *, accounts: bool, wind: Wind) -> Fluid:
        """Build the water. `seed`: the scene's; `accounts`: sum impulse and work of each force; `wind`: acts on it."""

    def sums_impulses(self, read: bool) -> bool:
        """True if the water sums impulse and work of each force; `read`: True if the observer `accuracy` needs them."""
        return read


class SurfaceConfig(KindConfig):
    """Base of the settings of a surface, a mesh that follows the particles of the water."""

    def completed(self, preflight: SceneFacts) -> Self:
        """Copy in which keys that the user left open have values derived from the water."""
        return self

    @abstractmethod
    def build(self, basin: Basin, fluid: Fluid) -> Surface:
        """Build the surface over the water `fluid`; `completed` must have filled in the keys that a user left open."""


class ShipConfig(KindConfig):
    """Base of the settings of all kinds of ship."""

    needs_surface: ClassVar[bool] = True
    """True if, over particles, it asks a surface for the height of the water."""
    carried_as_body: ClassVar[bool] = False
    """True if only water that `carries_bodies` carries it."""

    points: dict[str, tuple[float, float, float]] = {}

    @property
    def feels_wind(self) -> bool:
        """True if a wind that acts on ships acts on this one."""
        return False

    @property
    def drift_law(self) -> tuple[str, float, float]:
        """Name, in words, of the law for the mean force of waves on the ship (drift), empty if none, and the shortest
        and longest period [s] of the waves that it knows."""
        return "", 0.0, inf

    def solid(self, preflight: SceneFacts) -> Solid | None:
        """Solid body of the ship, around which the particles start; None if water passes through her."""
        return None

    def look(self, preflight: SceneFacts) -> Look | None:
        """Data that a picture of the ship needs besides its triangles; None if the ship has no shape."""
        return None

    def floats(self, preflight: SceneFacts) -> Afloat | None:
        """Displacement, draught and stability of the ship afloat in still water; None if no hull determines them."""
        return None

    def outline(self, preflight: SceneFacts) -> Outline | None:
        """Plan-view outline and height range of the ship at the start; None if she has no shape."""
        return None

    @abstractmethod
    def build(self, name: str, basin: Basin, fluid: Fluid) -> Ship:
        """Build the ship of this name, which floats in the water of a basin."""


class PlatformConfig(KindConfig):
    """Base of the settings of a motion platform."""

    ship: str | None = None
    """The name of the ship that it rides in; null: the first by name."""

    @property
    def look_ahead(self) -> float | None:
        """Time [s] by which the platform must know the ship's motion in advance: 0 if it guesses that, None if it does
        not plan."""
        return None

    def ridden(self, ships: Sequence[str]) -> str:
        """Name of the ship, one of `ships`, whose motion the platform reproduces."""
        return ships[0] if self.ship is None else self.ship

    def mismatches(self, preflight: SceneFacts) -> Faults:
        yield from preflight.unknown_ship(self.ship)
        x, y, z = preflight.tank.gravity
        if hypot(x, y + GRAVITY, z) > GRAVITY_TOLERANCE:
            there = f"a platform stands on Earth, and gravity of this scene is [{x:g}, {y:g}, {z:g}] m/s2"
            yield (), f"{there}: it would take the difference for a motion; leave the platform out"

    @abstractmethod
    def build(self, every: float) -> Platform:
        """Build the platform. `every`: time [s] between the rows of the motion log that it will follow."""


class TimeStepConfig(KindConfig):
    """Base of the settings of a rule that chooses the time step."""

    @abstractmethod
    def advice(self, limit: str, shortest: float) -> str:
        """Advice to the user after a run has diverged; `limit`: name of the limit that set the step `shortest` [s]."""

    def ledger(self, preflight: SceneFacts) -> list[LedgerRow]:
        return []

    @abstractmethod
    def build(self) -> TimeStep: ...


class ObserverConfig(PartConfig):
    """Base of the settings of an observer; one with an interval of its own derives from `PeriodicConfig`."""

    needs: ClassVar[tuple[str, ...]] = ()
    """Slots and other observers without which there is nothing to observe."""
    turn: ClassVar[int] = 0
    """Observers take turns in this order, those with the same number by name."""
    writes: ClassVar[bool] = True
    """True if it needs a run folder; the others also observe a Simulation without one."""
    leaves: ClassVar[str] = ""
    """The files it leaves, as the ledger states them: by name, in which * stands for digits and dots."""
    observer: ClassVar[Callable[..., Any]]
    """Class of the observer, which names this Config in `of`; a Config without one has a `build` of its own."""

    @classmethod
    def name(cls) -> str:
        """Key of the observer in a scene: the name of its module."""
        return cls.__module__.rpartition(".")[2]

    def files_of(self, preflight: SceneFacts) -> tuple[str, ...]:
        """Names of the files that the observer leaves in this scene."""
        return tuple(re.findall(r"[\w/*]+\.\w+", self.leaves))

    def interval(self, preflight: SceneFacts) -> float:
        """Simulated time [s] between observations: by default that of the motion log, or 0 (each step) without one."""
        motion = preflight.parts.get("motion")
        return motion.every if isinstance(motion, PeriodicConfig) else 0.0

    def ledger(self, preflight: SceneFacts) -> list[LedgerRow]:
        """One row of the memory ledger that names the files of the observer and counts no memory."""
        return [LedgerRow(self.name(), self.leaves, 0, "")]

    def picture_time(self, preflight: SceneFacts) -> float:
        """Estimated wall time [s] to draw the observer's pictures of a run, on idle cores without a graphics card."""
        return 0.0

    def bytes_a_particle(self, preflight: SceneFacts) -> int:
        """Memory [bytes] per particle in this observer's rows of the memory ledger."""
        return 0

    def build(self, folder: Path, simulation: Any) -> Any:
        """Build the observer. `folder`: the run folder, which is of no use to observers that write no files."""
        return self.observer(self, folder, simulation)


class PeriodicConfig(ObserverConfig):
    """Base of the settings of an observer that observes at an interval of its own, `every` [s]."""

    every: float

    def interval(self, preflight: SceneFacts) -> float:
        return self.every

    def ledger(self, preflight: SceneFacts) -> list[LedgerRow]:
        why = f"every {self.every:g} s" if self.every else ""
        return [row._replace(why=why) for row in super().ledger(preflight)]


@dataclass(frozen=True)
class SceneFacts:
    """Facts of a scene before anything is built, derived once and given to the config of every part. `parts` lacks a
    part whose keys could not be read; a property that needs it raises KeyError."""

    parts: Mapping[str, PartConfig]  # by slot, or name of an observer
    tank: Basin  # with nothing afloat in it
    word: int  # bytes of a number
    duration: float  # [s]
    arch: str = "cpu"  # the backend asked for

    @cached_property
    def fluid(self) -> FluidConfig:
        return cast(FluidConfig, self.parts["fluid"])

    @cached_property
    def sea(self) -> SeaConfig | None:
        """Settings of the open sea; None without one."""
        return cast(SeaConfig | None, self.parts.get("sea"))

    @cached_property
    def wind(self) -> WindConfig:
        return cast(WindConfig, self.parts["wind"])

    @cached_property
    def surface(self) -> SurfaceConfig | None:
        """Settings of the surface, completed where the user left them open; None without a surface."""
        surface = cast(SurfaceConfig | None, self.parts.get("surface"))
        return surface.completed(self) if surface is not None else None

    @cached_property
    def ships(self) -> dict[str, ShipConfig]:
        """Settings of each ship, by the name of the ship."""
        written = {key: part for key, part in self.parts.items() if isinstance(part, ShipConfig)}
        return {key.removeprefix(f"{SEVERAL}."): part for key, part in written.items()}

    def unknown_ship(self, name: str | None) -> Faults:
        """Mistake (key, sentence) of a part whose key `ship` is `name`, if this scene has no such ship; else empty."""
        if name is not None and name not in self.ships:
            there = f"there are {', '.join(self.ships)}" if self.ships else "there is none"
            yield ("ship",), f"this scene has no ship {name!r}; {there}"

    @cached_property
    def time_step(self) -> TimeStepConfig:
        return cast(TimeStepConfig, self.parts["time_step"])

    @cached_property
    def untouched(self) -> Lattice | None:
        """Lattice on which the particles would start if no body floated in the water; None without particles."""
        return self.fluid.lattice(self.tank)

    @cached_property
    def lattice(self) -> Lattice | None:
        """Lattice on which the particles start, around floating bodies; None without particles."""
        return self.fluid.lattice(self.basin) if self.solids else self.untouched

    @cached_property
    def particles(self) -> int:
        """Greatest number of particles during the run; 0 without particles."""
        return self.lattice.n if self.lattice is not None else 0

    @cached_property
    def spacing(self) -> float | None:
        """Distance between particles at rest [m]; None without particles."""
        return self.untouched.spacing if self.untouched is not None else None

    @property
    def sums_impulses(self) -> bool:
        return self.fluid.sums_impulses("accuracy" in self.parts)

    @property
    def repeats(self) -> tuple[float, float, float]:
        """Period lengths [m] of the domain along x, y, z; 0 for an axis that is not periodic, or without particles."""
        return self.tank.periods if self.fluid.made_of_particles else (0.0, 0.0, 0.0)

    @cached_property
    def support(self) -> float:
        """Support radius [m] of the smoothing kernel; 0 without particles."""
        return float(self.fluid.ratio(self.tank) * self.spacing) if self.spacing is not None else 0.0

    @cached_property
    def solids(self) -> dict[str, Solid]:
        """Solid bodies of the ships that displace particles at the start, by the name of the ship."""
        return {name: solid for name, ship in self.ships.items() if (solid := ship.solid(self)) is not None}

    @cached_property
    def basin(self) -> Basin:
        """The whole basin, with the floating bodies whose place the particles leave free at the start."""
        return replace(self.tank, afloat=self.solids) if self.solids else self.tank


def forces_in_waves(preflight: SceneFacts, regular: bool, current: bool) -> list[str]:
    """Sentences, one per ship, on the forces that act on her in waves: mean and slow drift, wind, current. `regular`:
    True for waves of one frequency; `current`: True if there is a current."""
    found, blows = list[str](), not preflight.wind.still and "ship" in preflight.wind.acts_on
    for name, ship in preflight.ships.items():
        law = "particles" if preflight.fluid.made_of_particles else ship.drift_law[0]
        acting = {"mean": law, "slow": law and not regular}, {"wind": blows and ship.feels_wind, "current": current}
        drift, others = (", ".join(word if acts else f"no {word}" for word, acts in each.items()) for each in acting)
        why = f"by {law}" if law else "first-order waves, drag and her motion alone move her on"
        found.append(f"on {called(name)} act in these waves: {drift} drift ({why}), {others}")
    return found


def beyond_drift_tables(preflight: SceneFacts, sea: waves.Components) -> Iterator[str]:
    """Yield a warning for each ship if much of the energy of the `sea` is in waves that her table of drift lacks."""
    energy, period = sea.amplitude**2, 2.0 * pi / sea.omega
    for name, ship in preflight.ships.items():
        _, least, most = ship.drift_law
        beyond = float(energy @ ((period < 0.99 * least) | (period > 1.01 * most)) / energy.sum())
        if beyond > 0.05:
            table = f"the table of drift of {called(name)}, of {least:.3g} to {most:.3g} s"
            yield f"{100.0 * beyond:.0f} % of the waves' energy lies beyond {table}: there its nearest row counts"


def config_of(slot: str, kind: str) -> type[KindConfig]:
    """Config class of a kind (as `gusts`) of a slot (key of a scene, as `wind`); imports the module of the kind."""
    return import_module(f"ocean_sim.{slot}.{kind}").Config


@cache
def from_coarse(slot: str) -> tuple[str, ...]:
    """Kinds of a slot (as `mueller` of `fluid`) by `fineness`, the coarsest model first; imports them all."""
    return tuple(sorted(kinds(slot), key=lambda kind: config_of(slot, kind).fineness))


@cache
def compared(slot: str) -> tuple[str, ...]:
    """Kinds of a slot (as `delta_sph` of `fluid`) that studies compare, the coarsest model first; imports all kinds."""
    return tuple(kind for kind in from_coarse(slot) if config_of(slot, kind).compared)


def water_schemes() -> tuple[tuple[str, type[FluidConfig]], ...]:
    """Name and Config class of every kind of water, particles or not."""
    return tuple((kind, cast(type[FluidConfig], config_of("fluid", kind))) for kind in kinds("fluid"))
