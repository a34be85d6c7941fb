"""Messages between a page and its server, version 1.

The server sends packets, binary, little-endian::

    4 bytes   b"OSP1"
    uint32    length n of the header
    n bytes   the header: JSON in UTF-8, padded by spaces to a multiple of four bytes
    rest      arrays one after the other, each padded to a multiple of four bytes

The header's `kind` is `still` (the static part of a simulation: basin, ships as triangles, surrounding sea), `frame`
(one moment), `sky`, or `replay` (all frames of a run). Its `arrays` lists `name`, `dtype` (float16, float32, int16,
int8, uint16, uint8, uint32) and `shape` of each array; one with `low` and `high` [m] holds whole numbers that stand for
-32767 at `low` to 32767 at `high`. A packet may be deflated as a whole (zlib, RFC 1950). In a `replay` an array has its
moments along its first axis; with `delta` it holds their differences modulo 65536, all high bytes before the low ones.

A frame has `time` [s], `seq`, `origin` (x and z of the middle of the heights [m]) and those of these arrays that the
scene calls for: `height` (nx, nz) [m], `foam` (nx, nz) share of white 0 to 255, `poses` (ships, 7) position of the
centre of mass [m] and quaternion w, x, y, z, `particles` (n, 3) in the box, by id, `speed` (n,) 0 to 255 for 0 to
`fastest` [m/s], `platform` (12,) pose [m, rad] and leg lengths [m], `drops` (m, 6) [m, m/s] from the origin, in a
replay, `scalars` (k,), see `still`; at intervals `lines` (m, 2, 3) [m] and `hues` (m, 3) of wind and basin, and `trail`
(m, 1 + 7 ships): time [s] and poses of up to 40 s before. A page that opens late finds the frames of the last minute,
one after the other, at the address /past.

The server also sends text: JSON objects with `type`: `hello`, `panel` (settings and their values), `problems`, `scene`,
`scenes`, `keys`, `said` (a sentence), and to the page that asked `waves`: `id`, `verb`, `time` [s] and `values`, or an
`error`. A page sends only text, the JSON objects of `Command`. On any other message the server closes the connection,
with a reason.
"""

import json
from collections.abc import Mapping
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, TypeAdapter, ValidationError

from ocean_sim.conventions import Refused
from ocean_sim.model import Model

PROTOCOL_VERSION = 1
PACKET_MAGIC = b"OSP1"
FULL_SCALE = 32767  # largest whole number of a position in a box
MAX_MESSAGE_BYTES = 256 * 1024  # from a page: a scene fits
MAX_POINTS = 4096  # of one question
MAX_COORDINATE = 1e9  # [m]
Coordinate = Annotated[float, Field(ge=-MAX_COORDINATE, le=MAX_COORDINATE)]
Point = Annotated[tuple[Coordinate, ...], Field(strict=False, min_length=2, max_length=3)]
Word = Annotated[str, Field(max_length=200)]
Text = Annotated[str, Field(max_length=MAX_MESSAGE_BYTES)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$")]


class BadMessage(Refused):
    """A message from a page does not follow this protocol; the server then closes the connection."""


class Act(Model):
    """Command of a button of the page. `take` and `leave` concern the helm, which one page has at a time. Other
    commands that change the simulation take the helm if it is free."""

    do: Literal["pause", "play", "step", "reset", "record", "stop", "take", "leave", "scene", "scenes", "keys"]


class Speed(Model):
    """Command to limit the speed of play: simulated time over real time; 0: as fast as possible."""

    do: Literal["speed"]
    value: float = Field(ge=0.0, le=100.0)


class Slide(Model):
    """Command to move the slider labelled `key` to a value, while the simulation runs on."""

    do: Literal["slide"]
    key: Word
    value: float


class Steer(Model):
    """Command to steer a ship by hand from now on: throttle, -1 to 1, and rudder [rad], positive to port."""

    do: Literal["steer"]
    ship: Word
    throttle: float = Field(ge=-1.0, le=1.0)
    rudder: float = Field(ge=-1.6, le=1.6)


class Route(Model):
    """Command to steer a ship by autopilot along waypoints x, z [m] at a speed [m/s]; no points: rudder amidships."""

    do: Literal["route"]
    ship: Word
    points: Annotated[list[Annotated[tuple[float, float], Field(strict=False)]], Field(max_length=100)]
    speed: float = Field(3.0, gt=0.0, le=50.0)


class Choose(Model):
    """Command to restart the scene with another wind preset, or to play a packaged scene, chosen by name."""

    do: Literal["wind", "open"]
    name: Word


class Change(Model):
    """Command to set a key of the scene to a value written in YAML, as `--set` does, and restart the scene."""

    do: Literal["change"]
    key: Word
    value: Word


class Write(Model):
    """Scene text from the page's editor: a request to check it, answered by `problems`, or a command to play it."""

    do: Literal["check", "apply"]
    text: Text


class Save(Model):
    """Command to save the scene being played as a new file of this name."""

    do: Literal["save"]
    name: Name


class Waves(Model):
    """Query of the water, answered by `waves` with the same `id`: elevation [m] or normal at points x, z, velocity
    [m/s] at points x, y, z, or a `field` of `cells` x `cells` heights [m] over a periodic square of a `side`."""

    do: Literal["waves"]
    verb: Literal["elevation", "normal", "velocity", "field"]
    id: int = Field(0, ge=0, le=2**31)
    points: Annotated[list[Point], Field(max_length=MAX_POINTS)] = []
    time: float | None = Field(None, ge=0.0)
    """[s]; null: now."""
    cells: int = Field(32, ge=2, le=128)
    side: float = Field(100.0, gt=0.0, le=1e5)
    """[m]"""


Command = Act | Speed | Slide | Steer | Route | Choose | Change | Write | Save | Waves
QUERY_NAMES = ("take", "leave", "scene", "scenes", "keys", "check", "waves")  # commands that change no simulation
_COMMAND_ADAPTER: TypeAdapter[Command] = TypeAdapter(Annotated[Command, Field(discriminator="do")])


def parse_command(text: str) -> Command:
    """Command in a text message of a page; raises BadMessage if it matches the format of no command."""
    try:
        return _COMMAND_ADAPTER.validate_json(text)
    except (ValidationError, RecursionError) as error:
        if isinstance(error, RecursionError):
            raise BadMessage("this is not a command: nested too deeply") from None
        first = error.errors()[0]
        where = "".join(f"{part}: " for part in first["loc"][1:])  # the first is what it does
        raise BadMessage(f"this is not a command: {where}{first['msg']}") from None


def packet(kind: str, arrays: Mapping[str, np.ndarray], boxes: Mapping[str, Any] | None = None, **header: Any) -> bytes:
    """Binary packet of a kind (as `frame`). `boxes`: entries on an array beside its name (`low`); `header`: others."""
    rows, data = [], []
    for name, array in arrays.items():
        whole = np.ascontiguousarray(array)
        if whole.dtype.byteorder == ">":
            whole = whole.astype(whole.dtype.newbyteorder("<"))
        rows.append({"name": name, "dtype": whole.dtype.name, "shape": whole.shape, **(boxes or {}).get(name, {})})
        data += [whole.tobytes(), b"\0" * (-whole.nbytes % 4)]
    head = json.dumps({"kind": kind, **header, "arrays": rows}, allow_nan=False, separators=(",", ":")).encode()
    head += b" " * (-len(head) % 4)
    return b"".join([PACKET_MAGIC, len(head).to_bytes(4, "little"), head, *data])


def box_scale(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Middle (3,) [m] of a box from `low` to `high` [m], and steps per metre (3,) of 16-bit integers that span it."""
    return 0.5 * (high + low), FULL_SCALE / np.maximum(0.5 * (high - low), 1e-9)


def box_positions(positions: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Positions (..., 3) [m] as 16-bit integers: -32767 at the corner `low` of a box to 32767 at `high`, clipped."""
    middle, scale = (array.astype(positions.dtype) for array in box_scale(low, high))
    share = np.clip((positions - middle) * scale, -FULL_SCALE, FULL_SCALE)
    return np.nan_to_num(np.rint(share)).astype(np.int16)


def moment_differences(values: np.ndarray) -> np.ndarray:
    """Differences (2, moments, n) between successive rows of integers (moments, n), as uint8: high bytes, low bytes."""
    turned = values.astype(np.uint16)
    step = np.diff(turned, axis=0, prepend=np.zeros_like(turned[:1]))
    return np.stack([(step >> 8).astype(np.uint8), (step & 255).astype(np.uint8)])
