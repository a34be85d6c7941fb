"""What a page and its server say to each other, version 1.

Down go packets, binary, little-endian::

    4 bytes   b"OSP1"
    uint32    length n of the header
    n bytes   the header: JSON in UTF-8, padded by spaces to a multiple of four bytes
    rest      arrays one after the other, each padded to a multiple of four bytes

The header's `kind` is `still` (what never changes in a simulation: the basin, the ships as triangles, the sea around
it), `frame` (one moment), `sky`, or `replay` (all frames of a run). Its `arrays` lists `name`, `dtype` (float16,
float32, int16, int8, uint16, uint8, uint32) and `shape` of each array; one with `low` and `high` [m] holds whole
numbers that stand for -32767 at `low` to 32767 at `high`. A packet may be deflated as a whole (zlib, RFC 1950). In a
`replay` an array has its moments along its first axis; with `delta` it holds their differences modulo 65536, the high
bytes of all before the low ones.

A frame has `time` [s], `seq`, `origin` (x and z of the middle of the heights [m]) and these arrays, where there is
something to show: `height` (nx, nz) [m], `foam` (nx, nz) share of white 0 to 255, `poses` (ships, 7) position of the
centre of mass [m] and quaternion w, x, y, z, `particles` (n, 3) in the box, by identity, `speed` (n,) 0 to 255 for 0 to
`fastest` [m/s], `platform` (12,) pose [m, rad] and leg lengths [m], `lines` (m, 2, 3) [m] and `hues` (m, 3) of wind and
basin, sent where they have changed, and `scalars` (k,), named in the still.

Also down goes text: JSON objects with `type`: `hello`, `panel` (what may be set and how it stands), `problems`,
`scene`, `scenes`, `keys`, `said` (a sentence), and to whoever asked `waves`: `id`, `verb`, `time` [s] and `values`, or
an `error`. Up goes only text, the JSON objects of `Command`. A server that gets
anything else closes the connection, and says why in the reason of the close.
"""

import json
from collections.abc import Mapping
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, TypeAdapter, ValidationError

from ocean_sim.conventions import Refused
from ocean_sim.model import Model

VERSION = 1
MAGIC = b"OSP1"
FULL = 32767  # the largest whole number of a position in a box
LONGEST = 256 * 1024  # bytes of a message from a page: a scene fits
MOST_POINTS = 4096  # of one question
FARTHEST = 1e9  # [m] of a point
Coordinate = Annotated[float, Field(ge=-FARTHEST, le=FARTHEST)]
Point = Annotated[tuple[Coordinate, ...], Field(strict=False, min_length=2, max_length=3)]
Word = Annotated[str, Field(max_length=200)]
Text = Annotated[str, Field(max_length=LONGEST)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$")]


class BadMessage(Refused):
    """What came from a page is no message of this protocol."""


class Act(Model):
    """A button: `take` and `leave` are about the helm, which one page has at a time; whoever presses another button, or
    sends any other command that changes the simulation, takes it where it is free."""

    do: Literal["pause", "play", "step", "reset", "record", "stop", "take", "leave", "scene", "scenes", "keys"]


class Speed(Model):
    """How fast simulated time may go, times real time; 0: as fast as possible."""

    do: Literal["speed"]
    value: float = Field(ge=0.0, le=100.0)


class Slide(Model):
    """A slider of the panel, by its label: the running simulation goes on with the value."""

    do: Literal["slide"]
    key: Word
    value: float


class Steer(Model):
    """Throttle, -1 to 1, and rudder [rad, positive turns to port] of a ship, which a person orders from now on."""

    do: Literal["steer"]
    ship: Word
    throttle: float = Field(ge=-1.0, le=1.0)
    rudder: float = Field(ge=-1.6, le=1.6)


class Route(Model):
    """Waypoints x, z [m] that a pilot sails a ship along, at a speed [m/s]; none: the rudder goes amidships."""

    do: Literal["route"]
    ship: Word
    points: Annotated[list[Annotated[tuple[float, float], Field(strict=False)]], Field(max_length=100)]
    speed: float = Field(3.0, gt=0.0, le=50.0)


class Wind(Model):
    """Another preset of wind: the scene starts anew."""

    do: Literal["wind"]
    name: Word


class Change(Model):
    """A key of the scene and its value as YAML, as `--set` has it: the scene starts anew."""

    do: Literal["change"]
    key: Word
    value: Word


class Check(Model):
    """Is this text a scene? Answered by `problems`."""

    do: Literal["check"]
    text: Text


class Apply(Model):
    """Play the scene that this text is."""

    do: Literal["apply"]
    text: Text


class Open(Model):
    """Play a packaged scene."""

    do: Literal["open"]
    name: Word


class Save(Model):
    """Write the scene as it is played into a file of this name."""

    do: Literal["save"]
    name: Name


class Waves(Model):
    """What the water does at points, answered by `waves` with the same `id`: elevation [m] and normal at x, z, velocity
    [m/s] at x, y, z, or a `field` of `cells` x `cells` heights [m] over a square of a `side` that repeats itself."""

    do: Literal["waves"]
    verb: Literal["elevation", "normal", "velocity", "field"]
    id: int = Field(0, ge=0, le=2**31)
    points: Annotated[list[Point], Field(max_length=MOST_POINTS)] = []
    time: float | None = Field(None, ge=0.0)
    """[s]; null: now."""
    cells: int = Field(32, ge=2, le=128)
    side: float = Field(100.0, gt=0.0, le=1e5)
    """[m]"""


Command = Act | Speed | Slide | Steer | Route | Wind | Change | Check | Apply | Open | Save | Waves
LOOKS = ("take", "leave", "scene", "scenes", "keys", "check", "waves")  # what changes no simulation
_COMMANDS: TypeAdapter[Command] = TypeAdapter(Annotated[Command, Field(discriminator="do")])


def command(text: str) -> Command:
    """The command in a message; raises BadMessage."""
    try:
        return _COMMANDS.validate_json(text)
    except (ValidationError, RecursionError) as error:
        if isinstance(error, RecursionError):
            raise BadMessage("this is not a command: nested too deeply") from None
        first = error.errors()[0]
        where = "".join(f"{part}: " for part in first["loc"][1:])  # the first is what it does
        raise BadMessage(f"this is not a command: {where}{first['msg']}") from None


def packet(kind: str, arrays: Mapping[str, np.ndarray], boxes: Mapping[str, Any] | None = None, **header: Any) -> bytes:
    """Arrays and what is said of them as bytes; `boxes`: more about an array, by its name."""
    rows, data = [], []
    for name, array in arrays.items():
        whole = np.ascontiguousarray(array)
        if whole.dtype.byteorder == ">":
            whole = whole.astype(whole.dtype.newbyteorder("<"))
        rows.append({"name": name, "dtype": whole.dtype.name, "shape": whole.shape, **(boxes or {}).get(name, {})})
        data += [whole.tobytes(), b"\0" * (-whole.nbytes % 4)]
    head = json.dumps({"kind": kind, **header, "arrays": rows}, allow_nan=False, separators=(",", ":")).encode()
    head += b" " * (-len(head) % 4)
    return b"".join([MAGIC, len(head).to_bytes(4, "little"), head, *data])


def scaled(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Middle of a box [m], and whole numbers a metre along each of its sides."""
    return 0.5 * (high + low), FULL / np.maximum(0.5 * (high - low), 1e-9)


def boxed(positions: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Positions (..., 3) [m] as whole numbers in a box; what lies outside is put onto its side."""
    middle, scale = (array.astype(positions.dtype) for array in scaled(low, high))
    share = np.clip((positions - middle) * scale, -FULL, FULL)
    return np.nan_to_num(np.rint(share)).astype(np.int16)


def differences(values: np.ndarray) -> np.ndarray:
    """int16 (moments, n) as differences from moment to moment, (2, moments, n) uint8: high bytes, then low ones."""
    turned = values.astype(np.uint16)
    step = np.diff(turned, axis=0, prepend=np.zeros_like(turned[:1]))
    return np.stack([(step >> 8).astype(np.uint8), (step & 255).astype(np.uint8)])
