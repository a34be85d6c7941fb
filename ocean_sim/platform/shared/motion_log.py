"""Motion logs: what a ship did, row by row, as `motion.csv` has it; read, checked, and converted to other axes."""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ocean_sim import conventions
from ocean_sim.conventions import GRAVITY
from ocean_sim.files import csv_file, input_file
from ocean_sim.files.csv_file import described, twice

MOTIONS = ("sway_m", "heave_m", "surge_m", "pitch_rad", "yaw_rad", "roll_rad")
RATES = ("roll_rate_rad_s", "pitch_rate_rad_s", "yaw_rate_rad_s")
FORCES = ("specific_force_x_m_s2", "specific_force_y_m_s2", "specific_force_z_m_s2")
REQUIRED = ("time_s", *MOTIONS, *RATES, *FORCES)
UNITS = ("_rad_s", "_m_s2", "_rad", "_m", "_s")

# Components along the axes of each frame, from those along FLU (x forward, y left, z up).
AXES = {frame: conventions.FRAMES[frame] @ conventions.FRAMES["flu"].T for frame in ("flu", "ned", "ship")}
FRAMES = {**AXES, "world": AXES["ship"]}
AXES_IN_WORDS = {
    "flu": "x forward, y left, z up (ISO 8855, ROS)",
    "ned": "x forward, y to starboard, z down (SNAME, NED)",
    "ship": "x to port, y up, z to the bow",
}

SLOWEST = 10.0  # rows a second that a platform can be driven by
FASTEST = 50.0  # [m/s] that a ship may move from row to row
FASTEST_TURN = 20.0  # [rad/s]
MOST_FELT = 20.0  # [m/s2] in the half of all rows
UNEVEN = 0.01  # part of the time between rows by which it may differ
CHUNK = 2000  # rows at a time


class Ride(NamedTuple):
    """Rows of a motion log, along FLU body axes: x forward, y left, z up."""

    time: np.ndarray  # (n,) [s]
    seq: np.ndarray  # (n,) number of the row
    specific_force: np.ndarray  # (n, 3) [m/s2], gravity included: +g upward at rest
    rate: np.ndarray  # (n, 3) p, q, r [rad/s]
    attitude: np.ndarray  # (n, 3) roll, pitch, yaw [rad]: Rz(yaw) Ry(pitch) Rx(roll) turns body to world

    def chunks(self) -> Iterator["Ride"]:
        """The rows in their order, some at a time."""
        for k in range(0, len(self.time), CHUNK):
            yield Ride(*(column[k : k + CHUNK] for column in self))


class MotionLog(NamedTuple):
    """A motion log that has been read: its head, its lines and what a platform needs of them."""

    head: dict[str, str]
    frame: str  # ship, ned or flu
    names: list[str]
    lines: list[str]
    every: float  # time between rows [s]
    ride: Ride


def signs(frame: str) -> np.ndarray:
    """(3,) by which roll, pitch and yaw about the frame's own axes, in their FLU sense, have to be taken."""
    return np.array([1.0, -1.0, -1.0]) if frame == "ned" else np.ones(3)


def ride_of(table: dict[str, np.ndarray], frame: str) -> Ride:
    """What a platform needs of columns along the axes of this frame."""
    turn = signs(frame)
    force = np.column_stack([table[name] for name in FORCES]) @ FRAMES[frame]
    rate = np.column_stack([table[name] for name in RATES]) * turn
    attitude = np.column_stack([table[name] for name in ("roll_rad", "pitch_rad", "yaw_rad")]) * turn
    return Ride(table["time_s"], table.get("seq", np.arange(len(force))).astype(int), force, rate, attitude)


def read(path: str | Path) -> MotionLog:
    """A whole motion log. Raises ValueError with the reason where it cannot be read, or is none."""
    path = Path(path)
    head, names, lines = csv_file.lines(input_file.text(path))
    checked(path, names, lines)
    frame = head.get("frame", "ship")
    if frame not in FRAMES:
        raise ValueError(f"{path}: its head says frame {frame!r}; a frame is one of {', '.join(FRAMES)}")
    table = csv_file.finite(path, names, lines, [name for name in (*REQUIRED, "seq") if name in names])
    every = spacing(path, table)
    ride = ride_of(table, frame)
    believable(path, table, ride, frame)
    return MotionLog(head, "ship" if frame == "world" else frame, names, lines, every, ride)


def checked(path: Path, names: list[str], lines: list[str]) -> None:
    """Refuse a file without two whole rows of what a platform needs, each column once."""
    if len(lines) < 2:
        raise ValueError(f"{path} has {len(lines)} rows; a platform needs at least two")
    if (name := twice(names)) is not None:
        raise ValueError(f"{path} has two columns {described(name)}")
    missing = [name for name in REQUIRED if name not in names]
    if missing:
        unit = next(unit for unit in UNITS if missing[0].endswith(unit))
        words = [name for name in names if name.isidentifier() and name not in REQUIRED]
        other = [name for name in words if name.startswith(missing[0].removesuffix(unit) + "_")]
        found = f", but {other[0]}: it has another unit" if other else ""
        raise ValueError(f"{path} has no column {missing[0]}{found}")
    uneven = next((k for k, line in enumerate(lines) if line.count(",") != len(names) - 1), None)
    if uneven is not None:
        count = lines[uneven].count(",") + 1
        raise ValueError(f"{path}: row {uneven + 1} has {count} cells under {len(names)} names")


def spacing(path: Path, table: dict[str, np.ndarray]) -> float:
    """Time between rows [s], which has to be the same everywhere."""
    time, steps = table["time_s"], np.diff(table["time_s"])
    every = float(np.median(steps))
    if every <= 0.0 or (steps <= 0.0).any():
        k = int(np.argmin(steps)) + 1
        raise ValueError(f"{path}: its rows are not in the order of time: {time[k]:g} s after {time[k - 1]:g} s")
    off = np.abs(steps - every) > UNEVEN * every + 2e-9 * np.abs(time[1:])
    seq_steps = np.diff(table["seq"]) if "seq" in table else np.ones(len(steps))
    if off.any() or (seq_steps != 1).any():
        k = int(np.argmax(off | (seq_steps != 1)))
        where = f"between {time[k]:g} s and {time[k + 1]:g} s"
        raise ValueError(f"{path}: rows are missing or out of order {where}; they should be {every:g} s apart")
    if every > 1.0 / SLOWEST:
        raise ValueError(f"{path} has a row every {every:g} s; a platform needs at least {SLOWEST:g} a second")
    return as_logged(float(time[-1] - time[0]) / len(steps))


def as_logged(every: float) -> float:
    """A time between rows [s] with the digits that a log keeps of it, whose times have nine: so a platform does in a
    run what it does on the run's log."""
    return float(f"{every:.8g}")


def believable(path: Path, table: dict[str, np.ndarray], ride: Ride, frame: str) -> None:
    """Refuse what no ship can do: jumps, other units, gravity along another axis."""
    time = ride.time
    position = np.column_stack([table[name] for name in MOTIONS[:3]])
    jump = np.linalg.norm(np.diff(position, axis=0), axis=1)
    if (jump > FASTEST * np.diff(time)).any():
        k = int(np.argmax(jump))
        raise ValueError(f"{path}: the ship jumps by {jump[k]:.3g} m between {time[k]:g} s and {time[k + 1]:g} s")
    if np.abs(ride.rate).max() > FASTEST_TURN or np.abs(ride.attitude).max() > 1000.0:
        raise ValueError(f"{path}: it turns at {np.abs(ride.rate).max():.3g} rad/s; are its angles in degrees?")
    turn = np.median(np.linalg.norm(turns(ride.attitude), axis=1) / np.diff(time))
    rate = np.median(np.linalg.norm(euler_rates(ride), axis=1))
    if min(turn, rate) > 1e-4 and not 0.05 < turn / rate < 20.0:
        raise ValueError(f"{path}: its angles turn at {turn:.3g} rad/s, its rates are {rate:.3g}; is one in degrees?")
    leap = leaps(ride.attitude)
    if (leap > FASTEST_TURN * np.diff(time)).any():
        k = int(np.argmax(leap))
        raise ValueError(
            f"{path}: the ship turns by {np.degrees(leap[k]):.3g} degrees between {time[k]:g} s and {time[k + 1]:g} s"
        )
    upward = turned(ride.attitude, ride.specific_force)[:, 2]
    felt, up = float(np.median(np.linalg.norm(ride.specific_force, axis=1))), float(upward.mean())
    if 0.5 < felt < 2.0:
        raise ValueError(f"{path}: its specific force is about {felt:.2g} m/s2, at rest {GRAVITY} m/s2; is it in g?")
    if felt > MOST_FELT:
        raise ValueError(
            f"{path}: its specific force is about {felt:.3g} m/s2, at rest {GRAVITY}; is it in another unit?"
        )
    if felt > 5.0 and up < 0.5 * felt:
        means = f"frame {frame}, {AXES_IN_WORDS['ship' if frame == 'world' else frame]}"
        raise ValueError(f"{path}: gravity does not point down ({up:.3g} m/s2 upward); is it really in {means}?")


def turns(attitude: np.ndarray) -> np.ndarray:
    """(n - 1, 3) differences from row to row [rad], the short way around."""
    return (np.diff(attitude, axis=0) + np.pi) % (2.0 * np.pi) - np.pi


def leaps(attitude: np.ndarray) -> np.ndarray:
    """(n - 1,) angle from row to row [rad], about whichever axis."""
    from scipy.spatial.transform import Rotation

    pose = Rotation.from_euler("ZYX", attitude[:, ::-1])
    return (pose[:-1].inv() * pose[1:]).magnitude()


def turned(attitude: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """(n, 3) Ry(pitch) Rx(roll) of (n, 3): body axes to those that are level and head as the ship does."""
    (sr, sp, _), (cr, cp, _) = np.sin(attitude).T, np.cos(attitude).T
    x, y, z = vector.T
    along = sr * y + cr * z
    return np.column_stack([cp * x + sp * along, cr * y - sr * z, cp * along - sp * x])


def euler_rates(ride: Ride) -> np.ndarray:
    """(n, 3) rates of roll, pitch and yaw [rad/s] from body rates; near a pitch of 90 degrees they are held finite."""
    (sr, sp, _), (cr, cp, _) = np.sin(ride.attitude).T, np.cos(ride.attitude).T
    p, q, r = ride.rate.T
    about_z = (sr * q + cr * r) / np.where(np.abs(cp) < 1e-3, 1e-3, cp)
    return np.column_stack([p + sp * about_z, cr * q - sr * r, about_z])


def converted(log: MotionLog, frame: str) -> Iterator[list[str]]:
    """The rows of a log in the axes of another frame; columns that have no axes stay as they are written."""
    found = origins(log.names, AXES[frame] @ AXES[log.frame].T)
    for line in log.lines:
        cells = line.split(",")
        yield [negated(cells[k]) if turned else cells[k] for k, turned in found]


def origins(names: list[str], turn: np.ndarray) -> list[tuple[int, bool]]:
    """Of each column the one whose cells it gets, and whether they change their sign: an axis of any frame is plus or
    minus one of another's."""
    found = [(k, False) for k in range(len(names))]
    for triple in vectors(names):
        own = [names.index(name) for name in triple]
        for column, row in zip(own, turn):
            k = int(np.argmax(np.abs(row)))
            found[column] = own[k], bool(row[k] < 0.0)
    if (turn < 0.0).any():
        for k in map(names.index, sideways(names)):
            found[k] = k, True
    return found


def negated(cell: str) -> str:
    """A number with the other sign, its digits as they are; 0 has none."""
    cell = cell.strip().removeprefix("+")
    if cell.startswith("-"):
        return cell[1:]
    return f"-{cell}" if float(cell) else cell


def convertible(path: Path, log: MotionLog) -> None:
    """Refuse a log that cannot be converted to other axes: a vector lacks a component, or a cell is not a number."""
    wanted = [name for triple in vectors(log.names) for name in triple] + sideways(log.names)
    missing = next((name for name in wanted if name not in log.names), None)
    if missing is not None:
        raise ValueError(f"{path} has no column {missing}; without it a vector cannot be converted to other axes")
    csv_file.finite(path, log.names, log.lines, wanted)


def sideways(names: list[str]) -> list[str]:
    """The columns that change their sign between NED and the other frames."""
    return [name for name in names if name.split("_")[0] in ("sway", "heave", "pitch", "yaw")]


def vectors(names: list[str]) -> list[list[str]]:
    """The components along x, y and z of each vector; the quaternion's last three are one."""
    found = [["qx", "qy", "qz"]] if "qx" in names else []
    return found + [[name.replace("_x_", f"_{axis}_") for axis in "xyz"] for name in names if "_x_" in name]
