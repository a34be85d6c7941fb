"""Motion logs, the rows of `motion.csv`: read, checked, and converted to other axes."""

import re
import shlex
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ocean_sim import conventions
from ocean_sim.conventions import GRAVITY
from ocean_sim.files import csv_file
from ocean_sim.files.csv_file import NAMED_COLUMNS_RULE, Table
from ocean_sim.files.input_file import Checked, Rule, display_path

TIME_COLUMN = csv_file.TIME_COLUMN
QUATERNION_COLUMNS = ("qw", "qx", "qy", "qz")
ANGLE_COLUMNS = ("roll_rad", "pitch_rad", "yaw_rad")
RATE_COLUMNS = ("roll_rate_rad_s", "pitch_rate_rad_s", "yaw_rate_rad_s")
FORCE_COLUMNS = ("specific_force_x_m_s2", "specific_force_y_m_s2", "specific_force_z_m_s2")
POSE_COLUMNS = ("sway_m", "heave_m", "surge_m", "pitch_rad", "yaw_rad", "roll_rad")
REQUIRED_COLUMNS = (TIME_COLUMN, *POSE_COLUMNS, *RATE_COLUMNS, *FORCE_COLUMNS)
UNIT_PATTERN = re.compile(r"_(rad_s|m_s2|rad|m|s)$")
COLUMN_KEYS = {UNIT_PATTERN.sub("", name).removeprefix("specific_"): name for name in REQUIRED_COLUMNS}  # of --columns
KEY_UNITS = {key: UNIT_PATTERN.findall(name)[0] for key, name in COLUMN_KEYS.items()}  # s, m, rad, rad_s or m_s2
MOTION_KEYS = ("surge", "sway", "heave", "roll", "pitch", "yaw")  # each a key of --columns
TIME_NAMES, YAW_NAMES = r"time|utc|stamp(?!f)|epoch|^t\b", "yaw|hdg|heading"
OTHER_NAMES = {"time": TIME_NAMES, **{key: key for key in MOTION_KEYS}, "yaw": YAW_NAMES}
OTHER_QUANTITY = re.compile(r"rate|vel|acc|speed", re.IGNORECASE)
UNITS_TABLE = csv_file.read_records((Path(__file__).parent / "units.csv").read_text(encoding="utf-8"))
UNITS = {row["word"]: (row["unit"], float(row["factor"])) for row in UNITS_TABLE}
# In brackets; or at the end, unless it is a letter that may stand for a motion.
NAMED_UNIT = re.compile(rf"(?:[(\[{{]\s*|[_\s/](?![dghs]$|in$))({'|'.join(map(re.escape, UNITS))})\s*(?:[)\]}},;]|$)")
Columns = tuple[Sequence[str], np.ndarray]  # names of (n, k) values

# Components along the axes of each frame, from those along FLU (x forward, y left, z up).
FRAME_AXES = {frame: conventions.FRAMES[frame] @ conventions.FRAMES["flu"].T for frame in ("flu", "ned", "ship")}
LOG_FRAMES = {**FRAME_AXES, "world": FRAME_AXES["ship"]}
AXES_IN_WORDS = {
    "flu": "x forward, y left, z up (ISO 8855, ROS)",
    "ned": "x forward, y to starboard, z down (SNAME, NED)",
    "ship": "x to port, y up, z to the bow",
}

MIN_ROW_RATE = 10.0  # rows a second that a platform can be driven by
MAX_SPEED = 50.0  # [m/s] that a ship may move from row to row
MAX_TURN_RATE = 20.0  # [rad/s]
MAX_MEDIAN_FORCE = 20.0  # [m/s2] in the half of all rows
INTERVAL_TOLERANCE = 0.01  # part of the time between rows by which it may differ
CHUNK_ROWS = 2000  # rows at a time

COMPARED_SECONDS = 0.5  # span of compared changes: noise from row to row does not count
MIN_COMPARED_ROWS = 8  # fewer are alike by chance
# Correlations of a column with its opposite, at most with another column, and with itself.
OPPOSITE_CORRELATION, UNLIKE_CORRELATION, ALIKE_CORRELATION = -0.8, 0.8, 0.9
MAX_FACTOR, MAX_FELT_FACTOR = 1.5, 3.0  # between columns that say the same; a ship also feels what short waves do
MIN_TURN, MIN_SPEED, MIN_CHANGE, MIN_FELT = 1e-3, 0.01, 0.01, 0.05  # [rad/s], [m/s], [m/s2]: less is not compared
SURE_TURN = 0.05  # [rad/s] beside which angles, or rates, that move by less than a tenth of it are wrong
MAX_TURNED_APART = 0.02  # [rad] between a quaternion and the angles, in half of all rows
UNIT_FACTORS = {180.0 / np.pi: "degrees", GRAVITY: "g", 1000.0: "mm", 100.0: "cm", 3.6: "km/h", 1.9438: "knots"}

AXES_RULE = Rule(f"its head says its axes, `# frame:` one of {', '.join(LOG_FRAMES)}, and gravity points down in them")
EVEN_RULE = Rule(f"rows are evenly spaced, {MIN_ROW_RATE:g} a second or more (2 with `--columns`), without a gap")
POSSIBLE_RULE = Rule(f"a ship moves below {MAX_SPEED:g} m/s, turns below {MAX_TURN_RATE:g} rad/s and feels about 1 g")
AGREEMENT_RULE = Rule(
    "columns that say the same agree: angles, rates and quaternion, positions, velocities and accelerations, "
    "and specific force with all of them and gravity"
)
UNITS_RULE = Rule("a column's name may state a unit of its quantity, `--units` is for angles whose names state none")
LOG_RULES = (AXES_RULE, EVEN_RULE, POSSIBLE_RULE, AGREEMENT_RULE, UNITS_RULE)
CHECKS = (Checked("A motion log, `ocean-sim platform LOG`: a table over time", LOG_RULES),)


class Ride(NamedTuple):
    """Ship motion from rows of a motion log, along FLU body axes: x forward, y left, z up."""

    time: np.ndarray  # (n,) [s]
    seq: np.ndarray  # (n,) number of the row
    specific_force: np.ndarray  # (n, 3) [m/s2], gravity included: +g upward at rest
    rate: np.ndarray  # (n, 3) p, q, r [rad/s]
    attitude: np.ndarray  # (n, 3) roll, pitch, yaw [rad]: Rz(yaw) Ry(pitch) Rx(roll) turns body to world

    def rows(self, first: int, last: int) -> "Ride":
        """Copy of the ship motion in rows `first` to `last`, the latter excluded."""
        return Ride(*(column[first:last] for column in self))

    def chunks(self, ahead: int = 0) -> Iterator[tuple["Ride", "Ride"]]:
        """Yield consecutive pieces (Rides of at most CHUNK_ROWS rows), each with up to `ahead` rows after it."""
        for k in range(0, len(self.time), CHUNK_ROWS):
            yield self.rows(k, k + CHUNK_ROWS), self.rows(k + CHUNK_ROWS, k + CHUNK_ROWS + ahead)


class MotionLog(NamedTuple):
    """Motion log that has been read and checked: its table, and its `Ride` (ship motion along FLU axes)."""

    table: Table
    frame: str  # ship, ned or flu
    every: float  # time between rows [s]
    ride: Ride

    @property
    def compared_rows(self) -> int:
        """Number n of rows over which changes of columns are checked against their rates: COMPARED_SECONDS, or less."""
        return max(1, min(round(COMPARED_SECONDS / self.every), len(self.ride.time) // 4))

    def mean_rates(self, values: np.ndarray) -> np.ndarray:
        """Mean rates of change (m - n, 3) [1/s] of `values` (m, 3) over any n = `compared_rows` successive rows."""
        n = self.compared_rows
        return (values[n:] - values[:-n]) / (n * self.every)

    def mean_values(self, values: np.ndarray) -> np.ndarray:
        """Means (m - n, 3) of `values` (m, 3) over any n = `compared_rows` successive rows, by the trapezoidal rule."""
        n, between = self.compared_rows, 0.5 * (values[1:] + values[:-1])
        whole = np.concatenate([0.0 * values[:1], np.cumsum(between, axis=0)])
        return (whole[n:] - whole[:-n]) / n


NotedLog = tuple[MotionLog, list[str]]  # with sentences on what was assumed or derived


def frame_signs(frame: str) -> np.ndarray:
    """Signs (3,) that convert roll, pitch, yaw, or surge, sway, heave, between FLU and a frame: 1, -1, -1 for `ned`."""
    return np.array([1.0, -1.0, -1.0]) if frame == "ned" else np.ones(3)


def ride_of(table: dict[str, np.ndarray], frame: str) -> Ride:
    """`Ride` (ship motion along FLU axes) from a motion log's `table`, columns (n,) by name, along axes of `frame`."""
    groups = FORCE_COLUMNS, RATE_COLUMNS, ANGLE_COLUMNS
    force, rate, attitude = (np.column_stack([table[name] for name in names]) for names in groups)
    signs = frame_signs(frame)
    seq = table.get("seq", np.arange(len(force))).astype(int)
    return Ride(table[TIME_COLUMN], seq, force @ LOG_FRAMES[frame], rate * signs, attitude * signs)


def read_log(path: str | Path) -> MotionLog:
    """Read and check a whole motion log. Raises Unreadable, a ValueError, if a rule of LOG_RULES is broken."""
    table = csv_file.Table(path)
    missing = [name for name in REQUIRED_COLUMNS if name not in table]
    if missing:
        words = [name for name in table if name.isidentifier() and name not in REQUIRED_COLUMNS]
        other = next((name for name in words if name.startswith(UNIT_PATTERN.sub("_", missing[0]))), "")
        how = f"; {suggested_command(table)}" if len(missing) > 1 else other and f", but {other}: it has another unit"
        more = f" and {len(missing) - 3} more" if len(missing) > 3 else ""
        raise NAMED_COLUMNS_RULE.broken(path, f"it has no column {', '.join(missing[:3])}{more}{how}")
    return checked_log(table)


def named_unit(name: str) -> tuple[str, float, str]:
    """Unit in the name of a column: that of this program, how many of it one is, and its word; or `"", 1, ""`."""
    found = NAMED_UNIT.search(name.lower())
    return (*UNITS[found[1]], found[1]) if found else ("", 1.0, "")


def suggested_command(table: Table) -> str:
    """Clause with the command that reads a log of other software; columns guessed from names, units and values."""
    units = {name: named_unit(name)[0] for name in table if name.isprintable() and not OTHER_QUANTITY.search(name)}
    fits = {key: [name for name in units if units[name] in ("", KEY_UNITS[key])] for key in OTHER_NAMES}
    alike = {key: next(filter(re.compile(how, re.I).search, fits[key]), "") for key, how in OTHER_NAMES.items()}
    rest = [name for name in units if name not in alike.values()]
    timed = (name for name in rest if name in fits["time"] and (units[name] or like_times(table, name)))
    time = alike["time"] = alike["time"] or next(timed, "...")
    free = [key for key in MOTION_KEYS if not alike[key]]
    rest = [name for name in rest if name != time and np.isfinite(table[name]).any()]
    left = [name for name in rest if any(name in fits[key] for key in free)]
    if len(free) == len(MOTION_KEYS) and not left:
        return f"none of its columns is one of {', '.join(free)}, in its unit"
    if time in table and np.isnan(csv_file.numeric_column(TIME_COLUMN, cells := table.column(time))[0]):
        units_row = "; write units into the names, as Heave (m)" * (cells[0].strip("()[]") in UNITS)
        return f"its {time} begins with {cells[0]!r}, no number or date like 2026-05-17T09:12:00Z (ISO 8601){units_row}"
    silent = [name for name in map(alike.get, MOTION_KEYS[3:]) if name and not units[name]]
    degrees = any(re.search("deg|\xb0", each.lower()) or (np.abs(table[each]) > 2.0 * np.pi).any() for each in silent)
    columns = ",".join(f"{key}={name}" for key, name in alike.items() if name)
    command = shlex.join(["ocean-sim", "platform", display_path(table.path), "--columns", columns])
    unsure = not all(units[name] for name in [*silent, *left]) and not degrees
    also = " --units deg`, with " if degrees else "`, with " + "`--units deg` if angles are in degrees, " * unsure
    more = f", and {', '.join(left[:4])} as one of {', '.join(free)}" if left else ""
    return f"name yours: `{command}{also}`--axes ned` if down is positive{more} (docs/guide/own_log.md)"


def like_times(table: Table, name: str) -> bool:
    """True if a column may hold times: dates, or numbers that rise evenly and do not count rows."""
    steps = np.diff(csv_file.numeric_column(TIME_COLUMN, table.column(name)))
    return len(steps) > 0 and 0.0 < steps.max() < 2.0 * steps.min() and bool((steps != 1.0).any())


def frame_of(table: Table) -> str:
    """Frame (a key of LOG_FRAMES) that the head of a log states, by default `ship`; raises Unreadable."""
    frame = table.head.get("frame", "ship")
    if frame not in LOG_FRAMES:
        raise AXES_RULE.broken(table.path, f"its head says frame {frame!r}")
    return frame


def checked_log(table: Table, agree: bool = True) -> MotionLog:
    """Motion log in a table, after checks; `agree`: True to compare columns with each other, too. Raises Unreadable."""
    frame = frame_of(table)
    table.series(*(name for name in (*REQUIRED_COLUMNS, "seq") if name in table), fewest=2)
    log = MotionLog(table, "ship" if frame == "world" else frame, row_interval(table), ride_of(table, frame))
    check_plausible(log)
    if agree:
        check_agreement(log)
    return log


def row_interval(table: Table) -> float:
    """Time between rows [s]; raises Unreadable if it varies or is too long, or if rows are missing."""
    time, steps = table[TIME_COLUMN], np.diff(table[TIME_COLUMN])
    every = round_interval(float(np.median(steps)))
    off = np.abs(steps - every) > INTERVAL_TOLERANCE * every + table.resolution(TIME_COLUMN)
    off |= np.diff(table.get("seq", np.arange(len(time)))) != 1
    if off.any():
        k = int(np.argmax(off))
        where = f"between {time[k]:.12g} s and {time[k + 1]:.12g} s, rows {k + 1} and {k + 2}"
        found = f"rows are missing or out of order {where}; they should be {every:g} s apart"
        raise EVEN_RULE.broken(table.path, found)
    if every > 1.0 / MIN_ROW_RATE:
        raise EVEN_RULE.broken(table.path, f"it has a row every {every:g} s")
    return round_interval(float(time[-1] - time[0]) / len(steps))


def round_interval(every: float) -> float:
    """Round a time between rows [s] to the digits of a log's times, so that a run and its log move a platform alike."""
    return float(f"{every:.8g}")


def check_plausible(log: MotionLog) -> None:
    """Raise Unreadable for motion impossible for a ship: jumps, wrong units, angles against rates, wrong gravity."""
    ride, time, path, pose = log.ride, log.ride.time, log.table.path, rotations(log.ride.attitude)
    jump = np.linalg.norm(np.diff(log_positions(log), axis=0), axis=1)
    leap = np.degrees((pose[:-1].inv() * pose[1:]).magnitude())
    for size, most, words in (
        (jump, MAX_SPEED, "jumps by {:.3g} m between {}"),
        (leap, np.degrees(MAX_TURN_RATE), "turns by {:.3g} degrees between {}; are its angles in degrees?"),
    ):
        if (size > most * np.diff(time)).any():
            k = int(np.argmax(size))
            where = f"{time[k]:.12g} s and {time[k + 1]:.12g} s, row {k + 2}"
            raise POSSIBLE_RULE.broken(path, f"the ship {words.format(size[k], where)}")
    if np.abs(ride.rate).max() > MAX_TURN_RATE or np.abs(ride.attitude).max() > 1000.0:
        raise POSSIBLE_RULE.broken(path, f"it turns at {np.abs(ride.rate).max():.3g} rad/s; are its angles in degrees?")
    turn, rate = log.mean_rates(np.unwrap(ride.attitude, axis=0)), log.mean_values(euler_rates(ride))
    compare_columns(path, (ANGLE_COLUMNS, turn), (RATE_COLUMNS, rate), MIN_TURN)
    sizes = np.stack([turn.std(axis=0), rate.std(axis=0)])
    for k in np.flatnonzero(sizes.max(axis=0) > np.maximum(SURE_TURN, 10.0 * sizes.min(axis=0))).tolist():
        found = f"{ANGLE_COLUMNS[k]} turns by {sizes[0, k]:.3g} rad/s, {RATE_COLUMNS[k]} says {sizes[1, k]:.3g}"
        raise AGREEMENT_RULE.broken(path, f"{found} (standard deviations)")
    felt = float(np.median(np.linalg.norm(ride.specific_force, axis=1)))
    up = float(turn_to_level(ride.attitude, ride.specific_force)[:, 2].mean())
    if 0.5 < felt < 2.0 or felt > MAX_MEDIAN_FORCE:
        unit = "g" if felt < 2.0 else "another unit"
        found = f"its specific force is about {felt:.3g} m/s2, at rest {GRAVITY}; is it in {unit}?"
        raise POSSIBLE_RULE.broken(path, found)
    if felt > 5.0 and up < 0.5 * felt:
        means = f"frame {log.table.head.get('frame', 'ship')}, {AXES_IN_WORDS[log.frame]}"
        found = f"gravity does not point down ({up:.3g} m/s2 upward); is it really in {means}?"
        raise AXES_RULE.broken(path, found)


def check_agreement(log: MotionLog) -> None:
    """Raise Unreadable if positions, velocities, accelerations, specific force and quaternion contradict each other."""
    table, pose, axes = log.table, rotations(log.ride.attitude), LOG_FRAMES[log.frame]
    for unit, derived, least in (("m", "velocity_m_s", MIN_SPEED), ("velocity_m_s", "acceleration_m_s2", MIN_CHANGE)):
        pairs = [(f"{name}_{unit}", f"{name}_{derived}") for name in ("sway", "heave", "surge")]
        pairs = [pair for pair in pairs if table.keys() >= {*pair}]
        if pairs:
            names, others = zip(*pairs)
            whole, parts = (np.column_stack(table.finite(*columns)) for columns in (names, others))
            compare_columns(table.path, (names, log.mean_rates(whole)), (others, log.mean_values(parts)), least)
    says, gravity = log.mean_rates(log.mean_rates(log_positions(log))), pose.inv().apply([0.0, 0.0, GRAVITY])
    n = (len(pose) - len(says)) // 2
    follows = pose[n : len(pose) - n].inv().apply(says) + log.mean_values(log.mean_values(gravity))
    felt = FORCE_COLUMNS, log.mean_values(log.mean_values(log.ride.specific_force)) @ axes.T
    other = ("positions, angles and gravity",) * 3, follows @ axes.T
    compare_columns(table.path, felt, other, MIN_FELT, MAX_FELT_FACTOR)
    if all(name in table for name in QUATERNION_COLUMNS):
        w, *vector = table.finite(*QUATERNION_COLUMNS)
        quaternion = np.column_stack([np.column_stack(vector) @ axes, w])
        off = np.abs(np.linalg.norm(quaternion, axis=1) - 1.0).max()
        apart = np.median(2.0 * np.arccos(np.minimum(np.abs((quaternion * pose.as_quat()).sum(axis=1)), 1.0)))
        if max(off, apart) > MAX_TURNED_APART:
            off_by = f"up to {off:.3g} from unit length and in half of the rows {apart:.3g} rad"
            found = f"its quaternion, qw first, is {off_by}"
            raise AGREEMENT_RULE.broken(table.path, f"{found} from its angles: is its order another, or its sense?")


def compare_columns(path: str | Path, own: Columns, other: Columns, least: float, most: float = MAX_FACTOR) -> None:
    """Raise Unreadable if columns `own` (n, k) and `other` (n, k), both with names, that should be alike differ in
    sign, axis or unit: by a factor above `most`. Columns with a standard deviation below `least` are skipped."""
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
        if match < OPPOSITE_CORRELATION:
            raise AGREEMENT_RULE.broken(path, f"{found}: is one of the other sign?")
        if abs(like[i, k]) > ALIKE_CORRELATION and match < UNLIKE_CORRELATION:
            raise AGREEMENT_RULE.broken(path, f"{found}, but as {others[k]} ({like[i, k]:.2f}): are axes exchanged?")
        if match > ALIKE_CORRELATION and not 1.0 / most < ratio < most:
            apart = max(ratio, 1.0 / ratio)
            unit = next((unit for factor, unit in UNIT_FACTORS.items() if 0.9 < apart / factor < 1.1), "another unit")
            raise AGREEMENT_RULE.broken(path, f"{found}: is one in {unit}?")


def log_positions(log: MotionLog) -> np.ndarray:
    """Surge, sway and heave (n, 3) [m] of the ship, positive forward, left and up."""
    return np.column_stack([log.table[name] for name in ("surge_m", "sway_m", "heave_m")]) * frame_signs(log.frame)


def rotations(attitude: np.ndarray) -> Any:
    """SciPy rotations (n,) from body axes to world axes by `attitude` (n, 3): roll, pitch, yaw [rad]."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_euler("ZYX", attitude[:, ::-1])


def turn_to_level(attitude: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Rotate vectors (n, 3) from body axes to level axes of equal heading: Ry(pitch) Rx(roll) of `attitude` (n, 3)."""
    (sr, sp, _), (cr, cp, _) = np.sin(attitude).T, np.cos(attitude).T
    x, y, z = vector.T
    along = sr * y + cr * z
    return np.column_stack([cp * x + sp * along, cr * y - sr * z, cp * along - sp * x])


def euler_rates(ride: Ride) -> np.ndarray:
    """Rates (n, 3) of roll, pitch and yaw [rad/s] from body rates, kept finite near a pitch of 90 degrees."""
    (sr, sp, _), (cr, cp, _) = np.sin(ride.attitude).T, np.cos(ride.attitude).T
    p, q, r = ride.rate.T
    about_z = (sr * q + cr * r) / np.where(np.abs(cp) < 1e-3, 1e-3, cp)
    return np.column_stack([p + sp * about_z, cr * q - sr * r, about_z])


def convert_rows(log: MotionLog, frame: str) -> Iterator[list[str]]:
    """Yield rows of a log as cell texts, with vectors along the axes of another frame and other cells unchanged."""
    names, turn = log.table.names, FRAME_AXES[frame] @ FRAME_AXES[log.frame].T
    sources = {name: (name, False) for name in names}  # of each column, and whether they change their sign
    for triple in vector_columns(names):
        for name, row in zip(triple, turn):
            k = int(np.argmax(np.abs(row)))
            sources[name] = triple[k], bool(row[k] < 0.0)
    if (turn < 0.0).any():
        sources |= {name: (name, True) for name in sign_changing_columns(names)}
    for cells in map(log.table.cells, log.table.rows):
        own = dict(zip(names, cells))
        yield [negate_cell(own[source]) if negative else own[source] for source, negative in sources.values()]


def negate_cell(cell: str) -> str:
    """Number in a CSV cell with the opposite sign and the same digits; 0 gets no sign."""
    cell = cell.strip().removeprefix("+")
    if cell.startswith("-"):
        return cell[1:]
    return f"-{cell}" if float(cell) else cell


def check_convertible(log: MotionLog) -> None:
    """Raise Unreadable if a vector to convert to other axes lacks a component, or one of its cells is not a number."""
    vectors = [name for triple in vector_columns(log.table.names) for name in triple]
    log.table.finite(*vectors, *sign_changing_columns(log.table.names))


def sign_changing_columns(names: list[str]) -> list[str]:
    """Names of those columns (sway, heave, pitch, yaw) whose sign differs between NED and the other frames."""
    return [name for name in names if name.split("_")[0] in ("sway", "heave", "pitch", "yaw")]


def vector_columns(names: list[str]) -> list[list[str]]:
    """Triples of column names along x, y, z, one for each vector; the vector part of the quaternion is one of them."""
    found = [["qx", "qy", "qz"]] if "qx" in names else []
    return found + [[name.replace("_x_", f"_{axis}_") for axis in "xyz"] for name in names if "_x_" in name]
