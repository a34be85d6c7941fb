"""Units, axes and signs used everywhere in ocean_sim.

SI units and radians. World axes are right-handed: X and Z horizontal, Y up, still water at y = 0, origin at the
centre of the still surface. A ship at rest heads along +Z, so +X is to port. Rotations are positive by the right
hand: pitch about X lowers the bow, yaw about Y turns it to port, roll about Z lifts the port side.
Headings of waves and wind say where they go to: 0 along +Z, 90 degrees along +X.

One word for one thing, in names, messages and docs: docs/program_words.md.in lists them.
"""

from collections.abc import Sequence
from math import inf, isfinite
from typing import Any, ClassVar, Literal, NamedTuple

import numpy as np

GRAVITY = 9.81  # [m/s^2]
WATER_DENSITY = 1000.0  # rest density [kg/m^3]
LEAST_DENSITY = 1e-3  # [kg/m^3] of a fluid: masses far below are nothing in single precision
LEAST_STEP = 1e-9  # [s] of a simulation: shorter ones are nothing beside its time
AIR_DENSITY = 1.225  # [kg/m^3], ICAO standard atmosphere at sea level


class Motions(NamedTuple):
    """The six motions of a ship, in the order they are logged: sway, heave, surge [m], pitch, yaw, roll [rad]."""

    sway: float  # along X
    heave: float  # along Y
    surge: float  # along Z
    pitch: float  # about X
    yaw: float  # about Y
    roll: float  # about Z


class Setting(NamedTuple):
    """Present value, unit and range of a number that can be changed during a run without recompiling kernels."""

    now: float
    unit: str
    ends: tuple[float, float] | None = None  # of its slider; None: 0 and four times the value, or 1


Frame = Literal["ship", "ned", "flu"]
AxisName = Literal["x", "y", "z", "-x", "-y", "-z"]  # of a file, with its sign

# Rows: the axes of a frame in ours (X to port, Y up, Z to the bow). All are right-handed, so what turns maps alike.
FRAMES = {
    "ship": np.eye(3),
    "ned": np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]),  # SNAME: x bow, y starboard, z down
    "flu": np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),  # ISO 8855, ROS: x bow, y port, z up
}


def to_frame(frame: Frame, vectors: np.ndarray) -> np.ndarray:
    """Convert vectors (..., 3), also rates or vector parts of quaternions, from this program's axes to `frame`."""
    return np.asarray(vectors) @ FRAMES[frame].T


def from_frame(frame: Frame, vectors: np.ndarray) -> np.ndarray:
    """Convert vectors (..., 3), also rates or vector parts of quaternions, from `frame` to this program's axes."""
    return np.asarray(vectors) @ FRAMES[frame]


def figures(value: float, count: int = 4) -> str:
    """Format a number with `count` significant figures, without exponent unless very small or large; never -0."""
    short = f"{value:.{count}g}"
    if abs(value) >= 1e15 or 0.0 < abs(value) < 1e-2:
        return short
    shown = f"{float(short) + 0.0:f}"
    return shown.rstrip("0").rstrip(".")


class Failed(Exception):
    """Base of all exceptions whose message, one sentence, is shown to the user: an attempt has failed."""

    exit_code: ClassVar[int] = 1  # of the command line
    problems: Sequence[Any] = ()  # locations in a scene that it is about, with a message each

    @property
    def sentence(self) -> str:
        return str(self)


class Refused(Failed):
    """Error in the user's input: a scene, an option, a file or an argument."""

    exit_code = 2


class Unsuited(Refused, ValueError):
    """Error: an argument of a Python function has an impossible value; also a ValueError."""


def number(name: str, value: Any, unit: str, least: float = -inf) -> float:
    """Convert an argument to float; raises Unsuited, citing `name` and `unit`, unless finite and at least `least`."""
    value = value.item() if isinstance(value, np.ndarray) and value.ndim == 0 else value
    numeric = isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)
    if not numeric or not isfinite(value) or value < least:
        bound = f" of at least {least:g}" if least > -inf else ""
        raise Unsuited(f"{name}: {value!r:.60} is not a finite number{bound} [{unit}]")
    return float(value)


def whole_number(name: str, value: Any) -> int:
    """Convert an argument to int; raises Unsuited, citing `name`, unless it is a whole number of at least 1."""
    if number(name, value, "1", 1.0) % 1.0:
        raise Unsuited(f"{name}: {value!r:.60} is not a whole number")
    return int(value)


def row_array(name: str, values: Any, columns: str) -> np.ndarray:
    """Convert `values` to an array (n, k), k the number of names in `columns` such as "x, z"; else raises Unsuited."""
    try:
        found = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise Unsuited(f"{name}: expected numbers {columns} in rows, got {values!r:.60}") from None
    count = len(columns.split(","))
    if found.ndim != 2 or found.shape[1] != count:
        raise Unsuited(f"{name}: expected an array of shape (n, {count}), {columns}; this one is {found.shape}")
    return found


class Lacking(Failed):
    """Error: this machine lacks a package, a driver or a device that was asked for; the message says how to get it."""

    exit_code = 3


def in_words(failure: BaseException) -> str:
    """Message for the user, one sentence, on the cause of any exception; for an OSError it names the file."""
    if isinstance(failure, Failed):
        return failure.sentence
    if isinstance(failure, OSError):
        return f"{failure.strerror or failure}{f': {failure.filename}' if failure.filename else ''}"
    if isinstance(failure, MemoryError):
        return "out of memory; try a larger resolution, or fewer particles"
    return f"this should not happen ({type(failure).__name__}: {failure}); --debug shows where it did"


class Diverged(Failed):
    """Error: a simulation has become unphysical; the message names the quantity, place and time, and a remedy."""

    @property
    def sentence(self) -> str:
        return f"diverged: {self}"
