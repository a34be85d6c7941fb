"""Timing, strength and heading of a wind: start, stop, ramp, and rows over time in the scene or in a CSV file."""

from collections.abc import Iterator
from functools import cached_property
from typing import NamedTuple

import numpy as np
from pydantic import Field

from ocean_sim.files import csv_file
from ocean_sim.files.input_file import Checked, FileName, Rule, display_path
from ocean_sim.model import Faults, Model, quantity

SPEEDS = Rule("a speed is not negative; turn the heading")
CHECKS = (Checked("A wind over time, `wind.schedule.file`: a table over time", (SPEEDS,)),)


class Timed(Model):
    """Keys of a wind that begins, ends and grows over a ramp."""

    start: float = quantity("s", 0.0, ge=0.0)
    """Time at which it begins to blow."""
    stop: float | None = quantity("s", None, ge=0.0)
    """Time at which it has stopped blowing; null: never."""
    duration: float | None = quantity("s", None, gt=0.0)
    """Time for which it blows, in place of `stop`."""
    ramp: float = quantity("s", 0.0, ge=0.0)
    """Time in which it rises after `start`, and in which it falls before `stop`."""

    def contradictions(self) -> Iterator[str]:
        if self.stop is not None and self.duration is not None:
            yield "give either stop [s] or duration [s], not both"
        if self.stop is not None and self.stop <= self.start:
            yield f"stop must be later than start ({self.start:g} s), got {self.stop:g}"

    @property
    def end(self) -> float | None:
        """Time at which the wind has stopped [s]; None if it never does."""
        return self.stop if self.duration is None else self.start + self.duration

    @cached_property
    def always(self) -> bool:
        """True if the wind blows at full strength from time 0 on and for ever."""
        return self.start == 0.0 and self.end is None and self.ramp == 0.0

    def blowing(self, time: float, dt: float = 0.0) -> float:
        """Share of full strength, 0 to 1, in a step of dt [s] that begins at a time [s]; on the ramp 3 s^2 - 2 s^3, s
        being 0 to 1. If the wind blows in a part of the step only, that part is a factor: the impulse is right."""
        begin, end = max(time, self.start), min(time + dt, np.inf if self.end is None else self.end)
        if end < begin or (end == begin and dt > 0.0) or time == self.end:
            return 0.0
        middle = 0.5 * (begin + end)
        left = np.inf if self.end is None else self.end - middle
        part = min(1.0, min(middle - self.start, left) / self.ramp) if self.ramp else 1.0
        share = (end - begin) / dt if end - begin < (1.0 - 1e-9) * dt else 1.0
        return float(part * part * (3.0 - 2.0 * part) * share)


class Row(Model):
    """One row of a schedule: time, speed and heading."""

    time: float = quantity("s", ge=0.0)
    """Time of this row."""
    speed: float = quantity("m/s", ge=0.0)
    """Speed of the wind."""
    heading_deg: float = quantity("deg")
    """Direction that it blows to: 0 along +z, 90 along +x."""


class File(Model):
    """Schedule given as a CSV file."""

    file: FileName
    """CSV with columns `time_s`, `speed_m_s` and `heading_deg`."""


class Schedule(NamedTuple):
    """Speed and heading of a wind over time: linear between rows, constant before the first and after the last."""

    time: np.ndarray  # (n,) [s], rising
    speed: np.ndarray  # (n,) [m/s]
    heading: np.ndarray  # (n,) [deg], each the shorter way from the one before

    def at(self, time: float) -> tuple[float, float]:
        """Speed [m/s] and heading [deg] interpolated at a time [s]."""
        return float(np.interp(time, self.time, self.speed)), float(np.interp(time, self.time, self.heading))


class Scheduled(Timed):
    """Keys of a wind whose speed and direction may follow a schedule."""

    schedule: list[Row] | File | None = Field(None, union_mode="left_to_right")
    """Rows of time, speed and heading_deg, or {file: ...csv}; in place of a constant speed and heading."""

    @cached_property
    def table(self) -> csv_file.Table | None:
        """Table in the schedule's CSV file; None if no file is given. Raises Unreadable for a faulty one."""
        return csv_file.Table(self.schedule.file) if isinstance(self.schedule, File) else None

    @cached_property
    def course(self) -> Schedule | None:
        """Speed and heading over time from rows or file; None without a schedule. Raises ValueError for faulty rows."""
        if self.schedule is None:
            return None
        if self.table is not None:
            time, speed, heading = self.table.series("speed_m_s", "heading_deg")
            if (speed < 0.0).any():
                raise ValueError(f"speed is {speed.min():g} m/s in row {int(speed.argmin()) + 1}; {SPEEDS}")
        else:
            assert not isinstance(self.schedule, File)
            if not self.schedule:
                raise ValueError("needs at least one row")
            time, speed, heading = np.array([[r.time, r.speed, r.heading_deg] for r in self.schedule], dtype=float).T
            if not (steps := np.diff(time) > 0.0).all():
                row = int(np.argmin(steps))
                order = f"{time[row + 1]:g} s follows {time[row]:g} s in row {row + 2}"
                raise ValueError(f"rows must be in the order of time, each time once; {order}")
        return Schedule(time, speed, np.unwrap(heading, period=360.0))

    def end_warnings(self, duration: float) -> list[str]:
        """Warn if the rows of the schedule end before a run of this duration [s], or its headings look like radians."""
        if self.course is None:
            return []
        last = float(self.course.time[-1])
        found = csv_file.unreached_times_warning("the schedule", self.course.time, duration, "only its {} row blows")
        if not found and isinstance(self.schedule, File) and last < duration:
            name = display_path(self.schedule.file)
            found = [f"{name} ends at {last:.9g} s; its last row blows on until {duration:g} s"]
        return found + (self.table.like_radians() if self.table is not None else [])

    def schedule_faults(self) -> Faults:
        """Yield a fault (key, sentence) if the schedule cannot be read or its rows are out of order."""
        try:
            self.course  # noqa: B018
        except ValueError as error:
            yield ("schedule",), str(error)
