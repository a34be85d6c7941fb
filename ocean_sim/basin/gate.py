"""How an obstacle moves, and when it has left: a gate is pulled up, a plate is drawn along, a diaphragm bursts."""

from collections.abc import Callable
from functools import cached_property
from typing import NamedTuple

import numpy as np
from pydantic import model_validator

from ocean_sim.basin.tank_motion import FEWEST_ROWS, splined
from ocean_sim.files import csv_file
from ocean_sim.files.input_file import Checked, FileName, display_path
from ocean_sim.model import Model, Vector3, quantity

MOMENTS = 400  # at which the way of an obstacle is looked at
AXES = ("x_m", "y_m", "z_m")  # columns of a table of ways
CHECKS = (Checked("Path of an obstacle, `basin.obstacles[].motion.file`: a table over time of four rows or more", ()),)


class Moved(NamedTuple):
    """How an obstacle has moved at one time, (3,) each."""

    way: np.ndarray  # from where it was at first [m]
    velocity: np.ndarray  # [m/s]
    acceleration: np.ndarray  # [m/s2]


STILL = Moved(np.zeros(3), np.zeros(3), np.zeros(3))


class Gate(Model):
    """How an obstacle moves: from `start` on with `velocity` and `acceleration`, or as measured, in a `file`."""

    velocity: Vector3 = quantity("m/s", (0.0, 0.0, 0.0))
    """Its velocity at `start`."""
    acceleration: Vector3 = quantity("m/s2", (0.0, 0.0, 0.0))
    """Its acceleration from `start` on; that of a gate that a heavy weight pulls up is at most [0, 9.81, 0]."""
    file: FileName | None = None
    """CSV file of its path, in place of both: `time_s` after `start`, and `x_m`, `y_m` or `z_m` or several of them,
    smooth between the rows (a cubic spline). It stands still before and after them."""
    start: float = quantity("s", 0.0, ge=0.0)
    """When it starts to move."""
    end: float | None = quantity("s", None, gt=0.0)
    """When it has left: from then on it is neither in the water nor in pictures. null: it stays."""

    @model_validator(mode="after")
    def _moves_in_one_way(self) -> "Gate":
        if self.file is not None and (any(self.velocity) or any(self.acceleration)):
            raise ValueError("give either the file of its way, or velocity and acceleration")
        if self.end is not None and self.end <= self.start and self.moves:
            raise ValueError(f"it leaves at {self.end:g} s, before it starts to move at {self.start:g} s")
        return self

    @property
    def moves(self) -> bool:
        """Whether it ever moves before it leaves."""
        return self.file is not None or any(self.velocity) or any(self.acceleration)

    def rows(self) -> tuple[np.ndarray, np.ndarray]:
        """(n,) times [s] and (n, 3) ways [m] in its file; raises Unreadable."""
        assert self.file is not None
        table = csv_file.Table(self.file)
        axes = [axis for axis in AXES if axis in table] or list(AXES)
        times, *ways = table.series(*axes, fewest=FEWEST_ROWS)
        along = dict(zip(axes, ways, strict=True))
        return times, np.stack([along.get(axis, np.zeros(len(times))) for axis in AXES], axis=1)

    def warnings(self, duration: float) -> list[str]:
        """Rows of its file that a run of `duration` [s] does not reach."""
        if self.file is None:
            return []
        return csv_file.unreached_times_warning(
            display_path(self.file), self.rows()[0] + self.start, duration, "the obstacle never moves"
        )

    @cached_property
    def laws(self) -> list[Callable[[float], tuple[float, float, float]]]:
        """Way, velocity and acceleration along each axis in the time after `start` [s], as its file has them."""
        times, ways = self.rows()
        return [splined(times, way) for way in ways.T]

    def at(self, time: float) -> Moved | None:
        """How it has moved at a time [s]; None once it has left."""
        if self.end is not None and time >= self.end:
            return None
        t = time - self.start
        if self.file is not None:
            way, velocity, acceleration = np.array([law(t) for law in self.laws]).T
            return Moved(way, velocity, acceleration)
        if t < 0.0:
            return STILL
        v, a = np.array(self.velocity), np.array(self.acceleration)
        return Moved(v * t + 0.5 * a * t * t, v + a * t, a)

    def moments(self, until: float) -> np.ndarray:
        """Times [s] at which it is there, close to each other, from the first to the last before `until` [s]."""
        last = until if self.end is None else min(until, self.end)
        return np.linspace(0.0, last, MOMENTS, endpoint=False)

    def fastest(self, until: float) -> float:
        """Its highest speed before `until` [s] [m/s]."""
        seen = (self.at(float(time)) for time in self.moments(until))
        return max(float(np.linalg.norm(moved.velocity)) for moved in seen if moved is not None)
