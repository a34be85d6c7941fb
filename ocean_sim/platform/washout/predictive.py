"""Predictive washout: the best motion of the legs over a horizon of the ride, found anew every period.

Model predictive cueing (Khusro et al. 2020, Vehicles 2, 625) by the programme of `leg_programme`, for the motion in a
finished log. A plan ends at rest, so the next one can always carry it on.
"""

from collections.abc import Iterator
from typing import Literal

import numpy as np

from ocean_sim.model import Model, Vector3, quantity
from ocean_sim.platform import Cue
from ocean_sim.platform.shared.kinematics import Geometry, Hexapod
from ocean_sim.platform.shared.leg_programme import KNOT_INTERVAL, REST_POINTS, LegPlan, motion_at
from ocean_sim.platform.shared.motion_log import Ride
from ocean_sim.platform.shared.washing import scaled_motion

PLAN_TOLERANCES = (1e-3, 1e-3)  # of passes of a plan, each about the solution of the one before
TIME_ROUNDING = 1e-6  # of a period


class Config(Model):
    """Predictive washout: the best motion of the legs, planned anew every period over what lies ahead in a log."""

    kind: Literal["predictive"] = "predictive"
    force_scale: Vector3 = quantity("1")
    """Scale of acceleration along x, y and z."""
    rotation_scale: Vector3 = quantity("1")
    """Scale of roll, pitch and yaw."""
    horizon: float = quantity("s", 30.0, ge=0.4, le=60.0)
    """Time over which the motion is planned."""
    period: float = quantity("s", 5.0, ge=KNOT_INTERVAL)
    """Time between plans."""

    def contradictions(self) -> Iterator[str]:
        knots = self.period / KNOT_INTERVAL
        if abs(knots - round(knots)) > TIME_ROUNDING:
            yield f"period: {self.period:g} s is not a multiple of {KNOT_INTERVAL:g} s, the time between knots"
        if self.period > self.horizon - 2 * REST_POINTS * KNOT_INTERVAL:
            yield f"period: {self.period:g} s leaves no room to stop within a horizon of {self.horizon:g} s"

    @property
    def look_ahead(self) -> float:
        return self.horizon

    def build(self, every: float, geometry: Geometry, travel: np.ndarray) -> "Predictive":
        return Predictive(self, geometry)


class Predictive:
    """Predictive washout of one ride: plans the motion of the legs over the horizon anew in each period."""

    plans_legs = True

    def __init__(self, config: Config, geometry: Geometry) -> None:
        self.config, self.plan = config, LegPlan(geometry, Hexapod(geometry), REST_POINTS)
        self.start, self.number = np.nan, -1  # time of the first row [s], number of the plan
        self.known = np.zeros((0, 7))  # rows of the last period: time [s], specific force [m/s2], rate [rad/s]

    def follow(self, ride: Ride, ahead: Ride | None = None) -> Cue:
        """Requested poses for the next rows of ship motion. `ahead`: rows that follow them, over the whole horizon.
        Raises Lacking, and Failed where there is no plan."""
        self.start = float(ride.time[0]) if np.isnan(self.start) else self.start
        config, scaled = self.config, [self.known]
        for part in (ride, ahead):
            if part is not None:
                asked = scaled_motion(part, config.force_scale, config.rotation_scale)
                scaled.append(np.column_stack([part.time, *asked]))
        rows = np.vstack(scaled)
        steps, knots = (round(time / KNOT_INTERVAL) for time in (config.period, config.horizon))
        numbers = np.floor((ride.time - self.start) / config.period + TIME_ROUNDING).astype(int)
        pose = np.empty((len(ride.time), 6))
        for number in np.unique(numbers):
            begin = self.start + number * config.period
            if number > self.number:
                if self.number >= 0:
                    self.plan.leave(motion_at(rows, begin + KNOT_INTERVAL * np.arange(-steps, 0)))
                self.plan.improve(motion_at(rows, begin + KNOT_INTERVAL * np.arange(knots)), PLAN_TOLERANCES)
                self.number = number
            here = numbers == number
            pose[here] = self.plan.poses(np.maximum(ride.time[here] - begin, 0.0) / KNOT_INTERVAL)
        past = rows[: len(self.known) + len(ride.time)]
        self.known = past[past[:, 0] >= past[-1, 0] - config.period - KNOT_INTERVAL]
        return Cue(pose, np.zeros(len(pose), dtype=int), *np.split(scaled[1][:, 1:], 2, axis=1))
