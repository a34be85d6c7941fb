"""Motion logs: what a ship did, row by row, as `motion.csv` has it; read, checked, and converted to other axes."""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ocean_sim import conventions
from ocean_sim.conventions import GRAVITY
from ocean_sim.files import csv_file
from ocean_sim.files.csv_file import NAMED_COLUMNS_RULE, Table
from ocean_sim.files.input_file import Checked, Rule

TIME = csv_file.TIME_COLUMN
QUATERNION = ("qw", "qx", "qy", "qz")
ANGLES = ("roll_rad", "pitch_rad", "yaw_rad")
RATES = ("roll_rate_rad_s", "pitch_rate_rad_s", "yaw_rate_rad_s")
FORCES = ("specific_force_x_m_s2", "specific_force_y_m_s2", "specific_force_z_m_s2")
REQUIRED = (TIME, "sway_m", "heave_m", "surge_m", "pitch_rad", "yaw_rad", "roll_rad", *RATES, *FORCES)
UNIT = re.compile(r"_(rad_s|m_s2|rad|m|s)$")
Columns = tuple[Sequence[str], np.ndarray]  # names of (n, k) values

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

COMPARED_SECONDS = 0.5  # over which columns that say the same are compared: noise from row to row does not count
MIN_COMPARED_ROWS = 8  # fewer are alike by chance
# Correlations of a column with its opposite, at most with another column, and with itself.
OPPOSITE, UNLIKE, ALIKE = -0.8, 0.8, 0.9
MAX_FACTOR, MAX_FELT_FACTOR = 1.5, 3.0  # between columns that say the same; a ship also feels what short waves do
MIN_TURN, MIN_SPEED, MIN_CHANGE, MIN_FELT = 1e-3, 0.01, 0.01, 0.05  # [rad/s], [m/s], [m/s2]: less is not compared
SURE_TURN = 0.05  # [rad/s] beside which angles, or rates, that move by less than a tenth of it are wrong
MAX_TURNED_APART = 0.02  # [rad] between a quaternion and the angles, in half of all rows
UNIT_FACTORS = {180.0 / np.pi: "degrees", GRAVITY: "g", 1000.0: "mm", 100.0: "cm", 3.6: "km/h", 1.9438: "knots"}

AXES_NAMED = Rule(f"its head says its axes, `# frame:` one of {', '.join(FRAMES)}, and gravity points down in them")
EVEN = Rule(f"rows are evenly spaced, to the digits of their times, {SLOWEST:g} a second or more, without a gap")
POSSIBLE = Rule(
    f"a ship moves at less than {FASTEST:g} m/s, turns at less than {FASTEST_TURN:g} rad/s and feels about 1 g"
)
AGREEING = Rule(
    "columns that say the same agree: angles, rates and quaternion, positions, velocities and accelerations, "
    "and specific force with all of them and gravity"
)
CHECKS = (Checked("A motion log, `ocean-sim platform LOG`: a table over time", (AXES_NAMED, EVEN, POSSIBLE, AGREEING)),)


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
    """A motion log that has been read: its table and what a platform needs of it."""

    table: Table
    frame: str  # ship, ned or flu
    every: float  # time between rows [s]
    ride: Ride

    @property
    def compared_rows(self) -> int:
        """Number of rows over which columns are compared: of COMPARED_SECONDS, or less in a short log."""
        return max(1, min(round(COMPARED_SECONDS / self.every), len(self.ride.time) // 4))

    def changes(self, values: np.ndarray) -> np.ndarray:
        """(m - n, 3) mean rate of change of (m, 3) values over the n rows that are compared."""
        n = self.compared_rows
        return (values[n:] - values[:-n]) / (n * self.every)

    def means(self, values: np.ndarray) -> np.ndarray:
        """(m - n, 3) mean of (m, 3) values over the n rows that are compared, by the trapezoidal rule."""
        n, between = self.compared_rows, 0.5 * (values[1:] + values[:-1])
        whole = np.concatenate([0.0 * values[:1], np.cumsum(between, axis=0)])
        return (whole[n:] - whole[:-n]) / n


def signs(frame: str) -> np.ndarray:
    """(3,) by which roll, pitch and yaw about the frame's own axes, in their FLU sense, have to be taken."""
    return np.array([1.0, -1.0, -1.0]) if frame == "ned" else np.ones(3)


def ride_of(table: dict[str, np.ndarray], frame: str) -> Ride:
    """What a platform needs of columns along the axes of this frame."""
    force, rate, attitude = (np.column_stack([table[name] for name in names]) for names in (FORCES, RATES, ANGLES))
    seq = table.get("seq", np.arange(len(force))).astype(int)
    return Ride(table[TIME], seq, force @ FRAMES[frame], rate * signs(frame), attitude * signs(frame))


def read(path: str | Path) -> MotionLog:
    """A whole motion log. Raises Unreadable, a ValueError, where it cannot be read, or is none."""
    table = csv_file.Table(path)
    missing = next((name for name in REQUIRED if name not in table), None)
    if missing is not None:
        words = [name for name in table if name.isidentifier() and name not in REQUIRED]
        other = next((name for name in words if name.startswith(UNIT.sub("_", missing))), None)
        raise NAMED_COLUMNS_RULE.broken(
            path, f"it has no column {missing}{f', but {other}: it has another unit' if other else ''}"
        )
    frame = table.head.get("frame", "ship")
    if frame not in FRAMES:
        raise AXES_NAMED.broken(path, f"its head says frame {frame!r}")
    table.series(*(name for name in (*REQUIRED, "seq") if name in table), fewest=2)
    log = MotionLog(table, "ship" if frame == "world" else frame, spacing(table), ride_of(table, frame))
    believable(log)
    agreeing(log)
    return log


def spacing(table: Table) -> float:
    """Time between rows [s], which has to be the same everywhere."""
    time, steps = table[TIME], np.diff(table[TIME])
    every = float(np.median(steps))
    off = np.abs(steps - every) > UNEVEN * every + table.resolution(TIME)
    off |= np.diff(table.get("seq", np.arange(len(time)))) != 1
    if off.any():
        k = int(np.argmax(off))
        where = f"between {time[k]:.12g} s and {time[k + 1]:.12g} s, rows {k + 1} and {k + 2}"
        raise EVEN.broken(table.path, f"rows are missing or out of order {where}; they should be {every:g} s apart")
    if every > 1.0 / SLOWEST:
        raise EVEN.broken(table.path, f"it has a row every {every:g} s")
    return as_logged(float(time[-1] - time[0]) / len(steps))


def as_logged(every: float) -> float:
    """A time between rows [s] with the digits that a log keeps of it, whose times have nine: so a platform does in a
    run what it does on the run's log."""
    return float(f"{every:.8g}")


def believable(log: MotionLog) -> None:
    """Refuse what no ship can do: jumps, other units, angles and rates that disagree, gravity along another axis."""
    ride, time, path, pose = log.ride, log.ride.time, log.table.path, rotation(log.ride)
    jump = np.linalg.norm(np.diff(position(log), axis=0), axis=1)
    leap = np.degrees((pose[:-1].inv() * pose[1:]).magnitude())
    for size, most, words in (
        (jump, FASTEST, "jumps by {:.3g} m between {}"),
        (leap, np.degrees(FASTEST_TURN), "turns by {:.3g} degrees between {}; are its angles in degrees?"),
    ):
        if (size > most * np.diff(time)).any():
            k = int(np.argmax(size))
            where = f"{time[k]:.12g} s and {time[k + 1]:.12g} s, row {k + 2}"
            raise POSSIBLE.broken(path, f"the ship {words.format(size[k], where)}")
    if np.abs(ride.rate).max() > FASTEST_TURN or np.abs(ride.attitude).max() > 1000.0:
        raise POSSIBLE.broken(path, f"it turns at {np.abs(ride.rate).max():.3g} rad/s; are its angles in degrees?")
    turn, rate = log.changes(np.unwrap(ride.attitude, axis=0)), log.means(euler_rates(ride))
    compare(path, (ANGLES, turn), (RATES, rate), MIN_TURN)
    sizes = np.stack([turn.std(axis=0), rate.std(axis=0)])
    for k in np.flatnonzero(sizes.max(axis=0) > np.maximum(SURE_TURN, 10.0 * sizes.min(axis=0))).tolist():
        found = f"{ANGLES[k]} turns by {sizes[0, k]:.3g} rad/s, {RATES[k]} says {sizes[1, k]:.3g} (standard deviations)"
        raise AGREEING.broken(path, found)
    felt = float(np.median(np.linalg.norm(ride.specific_force, axis=1)))
    up = float(turned(ride.attitude, ride.specific_force)[:, 2].mean())
    if 0.5 < felt < 2.0 or felt > MOST_FELT:
        unit = "g" if felt < 2.0 else "another unit"
        found = f"its specific force is about {felt:.3g} m/s2, at rest {GRAVITY}; is it in {unit}?"
        raise POSSIBLE.broken(path, found)
    if felt > 5.0 and up < 0.5 * felt:
        means = f"frame {log.table.head.get('frame', 'ship')}, {AXES_IN_WORDS[log.frame]}"
        found = f"gravity does not point down ({up:.3g} m/s2 upward); is it really in {means}?"
        raise AXES_NAMED.broken(path, found)


def agreeing(log: MotionLog) -> None:
    """Refuse positions and what follows from them that disagree, by how they change within COMPARED_SECONDS."""
    table, pose, axes = log.table, rotation(log.ride), FRAMES[log.frame]
    for unit, derived, least in (("m", "velocity_m_s", MIN_SPEED), ("velocity_m_s", "acceleration_m_s2", MIN_CHANGE)):
        pairs = [(f"{name}_{unit}", f"{name}_{derived}") for name in ("sway", "heave", "surge")]
        pairs = [pair for pair in pairs if table.keys() >= {*pair}]
        if pairs:
            names, others = zip(*pairs)
            whole, parts = (np.column_stack(table.finite(*columns)) for columns in (names, others))
            compare(table.path, (names, log.changes(whole)), (others, log.means(parts)), least)
    says, gravity = log.changes(log.changes(position(log))), pose.inv().apply([0.0, 0.0, GRAVITY])
    n = (len(pose) - len(says)) // 2
    follows = pose[n : len(pose) - n].inv().apply(says) + log.means(log.means(gravity))
    felt = FORCES, log.means(log.means(log.ride.specific_force)) @ axes.T
    compare(table.path, felt, (("positions, angles and gravity",) * 3, follows @ axes.T), MIN_FELT, MAX_FELT_FACTOR)
    if all(name in table for name in QUATERNION):
        w, *vector = table.finite(*QUATERNION)
        quaternion = np.column_stack([np.column_stack(vector) @ axes, w])
        off = np.abs(np.linalg.norm(quaternion, axis=1) - 1.0).max()
        apart = np.median(2.0 * np.arccos(np.minimum(np.abs((quaternion * pose.as_quat()).sum(axis=1)), 1.0)))
        if max(off, apart) > MAX_TURNED_APART:
            found = (
                f"its quaternion, qw first, is up to {off:.3g} from unit length and in half of the rows {apart:.3g} rad"
            )
            raise AGREEING.broken(table.path, f"{found} from its angles: is its order another, or its sense?")


def compare(path: str | Path, own: Columns, other: Columns, least: float, most: float = MAX_FACTOR) -> None:
    """Refuse columns (n, k) that disagree with others (n, k): another sign, axis or unit; where either moves less than
    `least`, nothing is known."""
    (names, says), (others, follows) = own, other
    if len(says) < MIN_COMPARED_ROWS:
        return
    says, follows = says - says.mean(axis=0), follows - follows.mean(axis=0)
    sizes = np.stack([says.std(axis=0), follows.std(axis=0)])
    known = (sizes > least).all(axis=0)
    like = says.T @ follows / len(says) / np.maximum(np.outer(*sizes), 1e-300) * np.outer(known, known)
    for i in np.flatnonzero(known).tolist():
        match, k, ratio = like[i, i], int(np.abs(like[i]).argmax()), sizes[0, i] / sizes[1, i]
        factor = np.copysign(ratio, match)
        found = f"{names[i]} changes by {factor:.3g} times what {others[i]} make of it (correlation {match:.2f})"
        if match < OPPOSITE:
            raise AGREEING.broken(path, f"{found}: is one of the other sign?")
        if abs(like[i, k]) > ALIKE and match < UNLIKE:
            raise AGREEING.broken(path, f"{found}, but as {others[k]} ({like[i, k]:.2f}): are axes exchanged?")
        if match > ALIKE and not 1.0 / most < ratio < most:
            apart = max(ratio, 1.0 / ratio)
            unit = next((unit for factor, unit in UNIT_FACTORS.items() if 0.9 < apart / factor < 1.1), "another unit")
            raise AGREEING.broken(path, f"{found}: is one in {unit}?")


def position(log: MotionLog) -> np.ndarray:
    """(n, 3) surge, sway and heave [m] in their FLU sense."""
    return np.column_stack([log.table[name] for name in ("surge_m", "sway_m", "heave_m")]) * signs(log.frame)


def rotation(ride: Ride) -> Any:
    """SciPy's rotations (n,) of body axes to those of the world."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_euler("ZYX", ride.attitude[:, ::-1])


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
    """The rows of a log in the axes of another frame, each of which is plus or minus one of the log's own; columns that
    have no axes stay as they are written."""
    names, turn = log.table.names, AXES[frame] @ AXES[log.frame].T
    sources = {name: (name, False) for name in names}  # of each column, and whether they change their sign
    for triple in vectors(names):
        for name, row in zip(triple, turn):
            k = int(np.argmax(np.abs(row)))
            sources[name] = triple[k], bool(row[k] < 0.0)
    if (turn < 0.0).any():
        sources |= {name: (name, True) for name in sideways(names)}
    for cells in map(log.table.cells, log.table.rows):
        own = dict(zip(names, cells))
        yield [negated(own[source]) if negative else own[source] for source, negative in sources.values()]


def negated(cell: str) -> str:
    """A number with the other sign, its digits as they are; 0 has none."""
    cell = cell.strip().removeprefix("+")
    if cell.startswith("-"):
        return cell[1:]
    return f"-{cell}" if float(cell) else cell


def convertible(log: MotionLog) -> None:
    """Refuse a log that cannot be converted to other axes: a vector lacks a component, or a cell is not a number."""
    wanted = [name for triple in vectors(log.table.names) for name in triple] + sideways(log.table.names)
    log.table.finite(*wanted)


def sideways(names: list[str]) -> list[str]:
    """The columns that change their sign between NED and the other frames."""
    return [name for name in names if name.split("_")[0] in ("sway", "heave", "pitch", "yaw")]


def vectors(names: list[str]) -> list[list[str]]:
    """The components along x, y and z of each vector; the quaternion's last three are one."""
    found = [["qx", "qy", "qz"]] if "qx" in names else []
    return found + [[name.replace("_x_", f"_{axis}_") for axis in "xyz"] for name in names if "_x_" in name]
