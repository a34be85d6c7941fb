"""A person's own motion log: columns of any name, angles in degrees, missing motions derived from those that are there.

Positions that no column holds count as 0, rates follow from the angles, and the specific force from positions, angles
and gravity. Derivatives are those of polynomials of degree 4 over SMOOTHING_SECONDS (Savitzky & Golay 1964, Anal.
Chem. 36, 1627), so that the rounding of a log does not become acceleration.
"""

from math import ceil
from pathlib import Path

import numpy as np

from ocean_sim.files.csv_file import NAMED_COLUMNS_RULE, Table, parse_number
from ocean_sim.platform.shared import motion_log
from ocean_sim.platform.shared.kinematics import felt_motion
from ocean_sim.platform.shared.motion_log import ANGLE_COLUMNS, COLUMN_KEYS, POSE_COLUMNS, TIME_COLUMN, UNITS_RULE

SMOOTHING_SECONDS = 0.5  # [s]
POLYNOMIAL_DEGREE = 4
MAX_TILT = np.pi / 2.0  # [rad] of roll or pitch, beyond which angles count as degrees
MAX_ROW_TIME, SPLINE_ROW_RATE = 0.5, 20.0  # [s] between rows that splines can bridge; rows a second that these give
MAX_GAP_ROWS = 3.0  # times between rows that a gap may be long where uneven rows are interpolated


def read_own_log(path: str | Path, columns: dict[str, str], units: str | None, axes: str) -> motion_log.NotedLog:
    """Motion log at `path`, and sentences on it. `columns`: names in the file by key of COLUMN_KEYS; `units`: deg or
    rad of angles whose names state no unit; `axes`: frame if its head has none. Raises Unreadable."""
    table = Table(path, {own: COLUMN_KEYS[key] for key, own in columns.items()})
    table.head.setdefault("frame", axes)
    known = {name: table[name] for name in motion_log.REQUIRED_COLUMNS if name in table}
    if not known.keys() & {*POSE_COLUMNS}:
        raise NAMED_COLUMNS_RULE.broken(path, f"it has no column for any of {', '.join(POSE_COLUMNS)}")
    table.series(*known, fewest=2)
    table.head["start"] = table.column(TIME_COLUMN)[0]
    for key, factor in unit_factors(path, columns, units).items():
        name = COLUMN_KEYS[key]
        if name != TIME_COLUMN or np.isfinite(parse_number(table.head["start"])):  # no date
            known[name] = factor * known[name]
        if name in ANGLE_COLUMNS:
            known[name] = np.unwrap(known[name])
            if key != "yaw" and (most := np.abs(known[name]).max()) > MAX_TILT:
                found = f"{name} reaches {most:.3g} rad; is {columns[key]} in degrees (--units deg, or in its name)?"
                raise motion_log.POSSIBLE_RULE.broken(path, found)
    said = even_times(table, known)
    absent = [name for name in POSE_COLUMNS if name not in known]
    known = dict.fromkeys(absent, 0.0 * known[TIME_COLUMN]) | known
    said += [f"taken as 0: {', '.join(absent)}"] if absent else []
    if "yaw_rad" not in absent and not {"surge_m", "sway_m"} <= {*absent}:
        turned = (known["surge_m"] + 1j * known["sway_m"]) * np.exp(1j * known["yaw_rad"])
        known |= {"surge_m": turned.real, "sway_m": turned.imag}
        said.append("surge and sway taken along and across her heading")
    said += derive_motion(known, motion_log.frame_of(table))
    table.replace_columns({name: known[name] for name in motion_log.REQUIRED_COLUMNS})
    return motion_log.checked_log(table, agree=not said), said


def unit_factors(path: str | Path, columns: dict[str, str], units: str | None) -> dict[str, float]:
    """Factors to this program's units by key, by units in the names of `columns`, or by `units` for angles and rates
    without one (None: rad). Raises Unreadable if a unit is of another quantity, or `units` contradicts it."""
    stated = {key: motion_log.named_unit(own) for key, own in columns.items()}
    turns = {key: bool(stated[key][0]) for key in columns if motion_log.KEY_UNITS[key].startswith("rad")}
    angle = motion_log.UNITS[units or "rad"][1]
    for key, (unit, factor, word) in stated.items():
        if unit and (unit != motion_log.KEY_UNITS[key] or (units and key in turns and factor != angle)):
            raise UNITS_RULE.broken(path, f"{key} has the column {columns[key]}, which is in {word}")
        if any(turns.values()) and not turns.get(key, True) and not units:
            raise UNITS_RULE.broken(path, f"{columns[key]} states no unit, others do: is it in degrees (--units deg)?")
    return {key: factor if turns.get(key, True) else angle for key, (_, factor, _) in stated.items()}


def even_times(table: Table, known: dict[str, np.ndarray]) -> list[str]:
    """Shift times to begin at 0, interpolate all columns of `known` by cubic splines where rows are a little uneven, or
    too few a second; returns sentences that say so. Epoch times in units of 1e-3, 1e-6 or 1e-9 s become seconds."""
    time = known[TIME_COLUMN]
    thousands = max(0, round((np.log10(max(time[0], 1.0)) - 9.25) / 3.0))  # 1e9 s after 1970 was in 2001
    table[TIME_COLUMN] = known[TIME_COLUMN] = time = np.round((time - time[0]) / 1000.0**thousands, 6)
    table.series(fewest=2)
    steps = np.diff(time)
    every = motion_log.round_interval(float(time[-1]) / len(steps))
    off, slow = float(np.abs(steps - every).max()), 1.0 / motion_log.MIN_ROW_RATE < every <= MAX_ROW_TIME
    if (off <= motion_log.INTERVAL_TOLERANCE * every and not slow) or steps.max() > MAX_GAP_ROWS * every:
        return []
    from scipy.interpolate import CubicSpline

    parts = ceil(every * SPLINE_ROW_RATE) if slow else 1
    even = every / parts * np.arange((len(time) - 1) * parts + 1)
    known |= {name: CubicSpline(time, column)(even) for name, column in known.items()} | {TIME_COLUMN: even}
    reason = f"rows come every {every:.4g} s" if slow else f"steps of time differ by up to {off:.3g} s"
    return [f"{reason}: interpolated to rows every {every / parts:.6g} s"]


def derive_motion(known: dict[str, np.ndarray], frame: str) -> list[str]:
    """Add rates and specific force to columns `known` (along axes `frame`) where one is missing, and say which."""
    signs, names, said = motion_log.frame_signs(frame), ("surge_m", "sway_m", "heave_m"), []
    every = float(known[TIME_COLUMN][-1]) / (len(known[TIME_COLUMN]) - 1)
    pose = np.column_stack([known[name] for name in (*names, *ANGLE_COLUMNS)]) * np.tile(signs, 2)
    force, rate = felt_motion(pose, derivative(pose[:, :3], every, 2), derivative(pose[:, 3:], every, 1))
    if any(name not in known for name in motion_log.RATE_COLUMNS):
        known |= dict(zip(motion_log.RATE_COLUMNS, (rate * signs).T))
        said.append("rates derived from angles")
    if any(name not in known for name in motion_log.FORCE_COLUMNS):
        known |= dict(zip(motion_log.FORCE_COLUMNS, (force @ motion_log.LOG_FRAMES[frame].T).T))
        said.append("specific force derived from positions, angles and gravity")
    return said


def derivative(values: np.ndarray, every: float, order: int) -> np.ndarray:
    """Derivative (n, k) of order `order` of `values` (n, k), rows `every` [s], smoothed over SMOOTHING_SECONDS."""
    from scipy.signal import savgol_filter

    window = min(max(POLYNOMIAL_DEGREE + 1, round(SMOOTHING_SECONDS / every) | 1), (len(values) - 1) // 2 * 2 + 1)
    return savgol_filter(values, window, min(POLYNOMIAL_DEGREE, window - 1), order, every, axis=0)
