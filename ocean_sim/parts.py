"""A part is one file: "kind: gusts" under "wind:" is `ocean_sim/wind/gusts.py`, imported only when a scene names it.

This is the whole contract of its `Config`: what a scene asks of a part between reading and building it. What is
built of it has a protocol in the `__init__.py` of its slot.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache, cached_property
from importlib import import_module
from importlib.resources import files
from math import hypot
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Protocol, Self, cast

from ocean_sim.model import Model

if TYPE_CHECKING:
    from ocean_sim import basin as basin_module
    from ocean_sim.basin import Basin, Solid
    from ocean_sim.fluid import Fluid, Lattice, Limits
    from ocean_sim.platform import Platform
    from ocean_sim.runtime import RuntimeConfig
    from ocean_sim.ship import Look, Ship
    from ocean_sim.surface import Surface
    from ocean_sim.time_step import TimeStep
    from ocean_sim.wind import Wind

SLOTS = ("wind", "fluid", "surface", "ship", "platform", "time_step")
PACKAGE = Path(str(files("ocean_sim")))

Key = tuple[str | int, ...]
Problems = list[tuple[Key, str]]  # where below the part's own key, and a sentence


@cache
def library(folder: str) -> Path:
    """Where `scenes`, `configs` or `figures` lie: in the package when installed, next to it in a checkout."""
    inside = PACKAGE / folder
    return inside if inside.is_dir() else PACKAGE.parent / folder


@cache
def kinds(slot: str) -> tuple[str, ...]:
    """The kinds a scene may name in this slot: the modules of its folder."""
    return tuple(sorted(p.stem for p in (PACKAGE / slot).glob("[!_]*.py")))


@cache
def named(slot: str) -> tuple[str, ...]:
    """The ready-made parts of this slot: the files of configs/<slot>/."""
    return tuple(sorted(p.stem for p in (library("configs") / slot).glob("*.yaml")))


class LedgerRow(NamedTuple):
    """One thing that a scene makes the program allocate or compile, and why, and what it adds to a step."""

    part: str
    what: str
    bytes: int
    why: str
    seconds: float = 0.0
    """Processor time of one update on one thread [s]; measured on x86-64 in f32, for an estimate."""
    every: float = 0.0
    """Simulated time between updates [s]; 0: each step has one."""

    def a_step(self, dt: float) -> float:
        """Processor time [s] of a step of dt [s], on the average."""
        return self.seconds * (min(1.0, dt / self.every) if self.every else 1.0)


class PartConfig(Model):
    """What a user may write for one part, and what a scene asks of it before it is built.

    Every question comes with the one `Preflight` of the scene. `ledger` and, in each slot's own base class below,
    `build` have no default: a kind without them cannot be instantiated.
    """

    def problems(self, preflight: Preflight) -> Problems:
        """What is wrong with these keys in this basin, whatever the other parts are: they may be wrong themselves."""
        return []

    def mismatches(self, preflight: Preflight) -> Problems:
        """What is wrong with these keys next to the other parts; asked where no part has a problem of its own."""
        return []

    def warnings(self, preflight: Preflight) -> list[str]:
        """What a reader of the results should know."""
        return []

    @abstractmethod
    def ledger(self, preflight: Preflight) -> list[LedgerRow]:
        """What it will allocate or compile, and take of a step."""


class KindConfig(PartConfig):
    """Keys of a part that is one of several kinds."""

    example: ClassVar[dict[str, Any]] = {}
    """The keys that have no default, with values that suit any basin a few metres in size."""
    compared: ClassVar[bool] = False
    """Whether studies compare it with others of its slot."""
    fineness: ClassVar[int] = 0
    """Its rank where the kinds of its slot are ordered from the coarsest to the finest."""
    unheeded: ClassVar[tuple[str, ...]] = ()
    """Keys that change no number of a run."""

    kind: str


class WindConfig(KindConfig):
    """Keys of any wind."""

    @property
    @abstractmethod
    def stylised(self) -> bool:
        """Whether it is a stylised force field, not a physical stress."""

    @property
    def needs_area(self) -> bool:
        """Whether the water has to find the exposed area of its particles."""
        return False

    @property
    def needs_bend(self) -> bool:
        """Whether the water has to find how its surface bends, too."""
        return False

    @property
    def still(self) -> bool:
        """Whether there is no wind."""
        return False

    @abstractmethod
    def build(self, basin: Basin, seed: int) -> Wind: ...


class FluidConfig(KindConfig):
    """Keys of any water."""

    rest_density: float

    made_of_particles: ClassVar[bool] = False
    """Whether it is made of particles, which start on a `lattice`; else it is a closed form."""
    conserves_momentum: ClassVar[bool] = False
    """Whether what its particles exchange keeps momentum and angular momentum to rounding."""
    bears_shear: ClassVar[float] = 0.0
    """Shear that its particles bear without flowing, once they have lost their rows, over the pressure; as measured in
    the validation case wind_setup."""
    bears: ClassVar[bool] = True
    """Whether it has a pressure, which bears what floats on it."""
    carries_bodies: ClassVar[bool] = False
    """Whether it answers to a body within a step, so that a ship of kind `pressure` may float on it."""

    def lattice(self, basin: Basin) -> Lattice | None:
        """The lattice that its particles start on; None for water in closed form."""
        return None

    def ratio(self, basin: Basin) -> float:
        """Support radius over spacing; 0 where there are no particles."""
        return 0.0

    @property
    def support_asked(self) -> float | None:
        """Support radius over spacing that the user asks for, or the fixed one of the scheme."""
        return None

    def sound_speed(self, basin: Basin) -> float:
        """c [m/s]; 0 where nothing is compressed."""
        return 0.0

    @property
    def viscosity_asked(self) -> float:
        """Kinematic viscosity that the user asks for [m2/s]."""
        return 0.0

    @property
    def compression_asked(self) -> float:
        """Compression that the user asks for or allows; 0 where none is given."""
        return 0.0

    def speed(self, basin: Basin) -> float:
        """Reference speed [m/s]; by default that of a free fall over the depth."""
        return (hypot(*basin.gravity) * basin.depth) ** 0.5

    @property
    def steady_force(self) -> tuple[float, float, float]:
        """A constant acceleration in addition to gravity [m/s2]."""
        return (0.0, 0.0, 0.0)

    @property
    def driven(self) -> bool:
        """Whether new water or a force of its own may give it energy."""
        return False

    def viscosity_added(
        self, preflight: Preflight, length: float, height: float = 0.0, standing: bool = False
    ) -> float:
        """Viscosity [m2/s] that the scheme adds to waves of a length and height [m], as it was measured; 0 where it was
        not."""
        return 0.0

    def statements(self, preflight: Preflight) -> list[str]:
        """What the water does that a reader of its results should know."""
        return []

    @abstractmethod
    def still_limits(self, preflight: Preflight) -> Limits:
        """Limits of the time step in still water, before anything is allocated."""

    @abstractmethod
    def build(self, basin: Basin, seed: int, *, accounts: bool, wind: Wind) -> Fluid:
        """`accounts`: whether it sums the impulse and work of each term; `wind`: as the water feels it."""


class SurfaceConfig(KindConfig):
    """Keys of any surface. It follows particles."""

    when_read: ClassVar[bool] = False
    """Whether it is built only when something reads it, not in each step."""

    def completed(self, preflight: Preflight) -> Self:
        """A copy in which what the user left open follows from the water."""
        return self

    @abstractmethod
    def build(self, basin: Basin, fluid: Fluid) -> Surface:
        """Of a completed config."""


class ShipConfig(KindConfig):
    """Keys of any ship."""

    needs_surface: ClassVar[bool] = True
    """Whether, over particles, it asks a surface how high the water stands."""
    carried_as_body: ClassVar[bool] = False
    """Whether only water that `carries_bodies` carries it."""

    points: dict[str, tuple[float, float, float]] = {}

    def solids(self, preflight: Preflight) -> tuple[Solid, ...]:
        """What the water is built around."""
        return ()

    def look(self, preflight: Preflight) -> Look | None:
        """What a picture needs besides its triangles; None where it has no shape."""
        return None

    @abstractmethod
    def build(self, basin: Basin, fluid: Fluid) -> Ship: ...


class PlatformConfig(KindConfig):
    """Keys of any motion platform."""

    @abstractmethod
    def build(self, every: float) -> Platform:
        """`every`: time between the rows of motion that it will follow [s]."""


class TimeStepConfig(KindConfig):
    """Keys of any rule for the time step."""

    @abstractmethod
    def advice(self, limit: str, shortest: float) -> str:
        """What to try after a run has diverged; `limit` held the step in this water and was `shortest` [s] at least."""

    def ledger(self, preflight: Preflight) -> list[LedgerRow]:
        return []

    @abstractmethod
    def build(self) -> TimeStep: ...


@dataclass(frozen=True)
class Preflight:
    """What is known of a scene before anything is built, derived once and handed to every part that is asked.

    A part that could not be read is missing from it; asking for it raises KeyError.
    """

    parts: Mapping[str, PartConfig]  # by slot, or name of an observer
    tank: Basin  # with nothing afloat in it
    word: int  # bytes of a number
    duration: float  # [s]

    @cached_property
    def fluid(self) -> FluidConfig:
        return cast(FluidConfig, self.parts["fluid"])

    @cached_property
    def wind(self) -> WindConfig:
        return cast(WindConfig, self.parts["wind"])

    @cached_property
    def surface(self) -> SurfaceConfig | None:
        """The surface, completed."""
        surface = cast(SurfaceConfig | None, self.parts.get("surface"))
        return surface.completed(self) if surface is not None else None

    @cached_property
    def ship(self) -> ShipConfig | None:
        return cast(ShipConfig | None, self.parts.get("ship"))

    @cached_property
    def time_step(self) -> TimeStepConfig:
        return cast(TimeStepConfig, self.parts["time_step"])

    @cached_property
    def untouched(self) -> Lattice | None:
        """The lattice of the water before anything afloat makes room for itself; None without particles."""
        return self.fluid.lattice(self.tank)

    @cached_property
    def lattice(self) -> Lattice | None:
        """The lattice that the particles start on; None without particles."""
        return self.fluid.lattice(self.basin) if self.solids else self.untouched

    @cached_property
    def particles(self) -> int:
        """How many particles there are at most."""
        return self.lattice.n if self.lattice is not None else 0

    @cached_property
    def spacing(self) -> float | None:
        """Distance between particles at rest [m]; None without particles."""
        return self.untouched.spacing if self.untouched is not None else None

    @cached_property
    def support(self) -> float:
        """How far around a point particles count [m]; 0 without particles."""
        return float(self.fluid.ratio(self.tank) * self.spacing) if self.spacing is not None else 0.0

    @cached_property
    def solids(self) -> tuple[Solid, ...]:
        """What floats in the water and makes room for itself."""
        return self.ship.solids(self) if self.ship is not None else ()

    @cached_property
    def basin(self) -> Basin:
        """The basin with what floats in it, around which the water is built."""
        return replace(self.tank, afloat=self.solids) if self.solids else self.tank


class Scene(Protocol):
    """A checked scene, as the parts built from it and their observers know it."""

    @property
    def title(self) -> str: ...
    @property
    def seed(self) -> int: ...
    @property
    def duration(self) -> float: ...
    @property
    def basin(self) -> basin_module.Config: ...
    @property
    def fluid(self) -> FluidConfig: ...
    @property
    def wind(self) -> WindConfig: ...
    @property
    def surface(self) -> SurfaceConfig | None: ...
    @property
    def ship(self) -> ShipConfig | None: ...
    @property
    def platform(self) -> PlatformConfig | None: ...
    @property
    def time_step(self) -> TimeStepConfig: ...
    @property
    def runtime(self) -> RuntimeConfig: ...
    @property
    def observers(self) -> Mapping[str, PartConfig]: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def preflight(self) -> Preflight: ...
    def warnings(self) -> list[str]: ...
    def ledger(self) -> list[LedgerRow]: ...
    def resolved(self) -> dict[str, Any]: ...


def config_of(slot: str, kind: str) -> type[KindConfig]:
    """The Config class of a kind; importing its module is what makes the kind exist."""
    return import_module(f"ocean_sim.{slot}.{kind}").Config


@cache
def from_coarse(slot: str) -> tuple[str, ...]:
    """The kinds of a slot from the coarsest to the finest; it imports them all."""
    return tuple(sorted(kinds(slot), key=lambda kind: config_of(slot, kind).fineness))


@cache
def compared(slot: str) -> tuple[str, ...]:
    """The kinds of a slot that studies compare, from the coarsest to the finest; it imports all kinds."""
    return tuple(kind for kind in from_coarse(slot) if config_of(slot, kind).compared)


def water_schemes() -> tuple[tuple[str, type[FluidConfig]], ...]:
    """Every kind of water and its Config."""
    return tuple((kind, cast(type[FluidConfig], config_of("fluid", kind))) for kind in kinds("fluid"))
