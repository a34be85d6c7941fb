"""A part is one file: "kind: gusts" under "wind:" is `ocean_sim/wind/gusts.py`, imported only when a scene names it."""

from functools import cache
from importlib import import_module
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Any, ClassVar, NamedTuple

from pydantic import BaseModel, ConfigDict, Field

SLOTS = ("wind", "fluid", "surface", "ship", "platform", "time_step")
PACKAGE = Path(str(files("ocean_sim")))


@cache
def library(folder: str) -> Path:
    """Where `scenes`, `configs` or `figures` lie: in the package when installed, beside it in a checkout."""
    inside = PACKAGE / folder
    return inside if inside.is_dir() else PACKAGE.parent / folder


class PartConfig(BaseModel):
    """What a user may write for one part: frozen, strict about types, no unknown keys, no NaN and no infinity."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", strict=True, allow_inf_nan=False, use_attribute_docstrings=True
    )


class ObserverConfig(PartConfig):
    """What a user may write for one observer."""

    needs: ClassVar[tuple[str, ...]] = ()  # slots and other observers without which there is nothing to watch
    writes: ClassVar[bool] = True  # whether it needs a run folder; one that does not also watches a bare Simulation
    reads_surface: ClassVar[bool] = False
    leaves: ClassVar[str] = ""  # files, and what for, as the ledger tells it
    takes: ClassVar[tuple[float, float]] = (0.0, 0.0)  # [s] of processor time each `every`, and more for each particle

    def watching(self, name: str, particles: int, rate: float) -> "LedgerRow":
        """Its row of the ledger; it has no fields, for what it reads is the water's. `rate`: time between the rows of
        `motion`, which those watch that have no `every` of their own [s]. What it takes where there are no particles,
        nobody has measured."""
        base, each = self.takes
        every = getattr(self, "every", rate) if base else 0.0
        often = f"every {every:g} s" if every else ""
        return LedgerRow(name, self.leaves, 0, often, base + each * particles if particles else 0.0, every)


def quantity(unit: str, default: Any = ..., **bounds: Any) -> Any:
    """A field that has a unit, which messages and the schema show; bounds as in pydantic (`gt`, `ge`, `lt`, `le`)."""
    return Field(default, json_schema_extra={"unit": unit}, **bounds)


Vector2 = Annotated[tuple[float, float], Field(strict=False)]
Vector3 = Annotated[tuple[float, float, float], Field(strict=False)]


@cache
def kinds(slot: str) -> tuple[str, ...]:
    """The kinds a scene may name in this slot: its modules without a leading underscore."""
    return tuple(sorted(p.stem for p in (PACKAGE / slot).glob("[!_]*.py")))


@cache
def named(slot: str) -> tuple[str, ...]:
    """The ready-made parts of this slot: the files of configs/<slot>/."""
    return tuple(sorted(p.stem for p in (library("configs") / slot).glob("*.yaml")))


def config_of(slot: str, kind: str) -> type[PartConfig]:
    """The Config class of a kind; importing its module is what makes the kind exist."""
    return import_module(f"ocean_sim.{slot}.{kind}").Config


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
