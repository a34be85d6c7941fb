"""Predictive washout: the best motion of the legs over a horizon of the ride, found anew every period.

Model predictive cueing (Khusro et al. 2020, Vehicles 2, 625) by the programme of `leg_programme`, for the motion in a
finished log, or of a ghost: the ship run ahead with the helm as it is. A plan ends at rest, so the next one can always
carry it on. The ghost plans each period during the one before; if it is late, the classical washout takes over.
"""

from collections.abc import Iterator
from typing import Literal

import numpy as np

from ocean_sim.model import Model, Vector3, quantity
from ocean_sim.parts import preset
from ocean_sim.platform import LATE_PLAN, Cue, Ghost, Washout
from ocean_sim.platform.shared.kinematics import Geometry, Hexapod
from ocean_sim.platform.shared.leg_programme import KNOT_INTERVAL, STOP_SHARE, LegPlan, load_solver, motion_at
from ocean_sim.platform.shared.motion_log import Ride
from ocean_sim.platform.shared.washing import scaled_motion
from ocean_sim.platform.washout import classical

FIRST_PASSES = 3  # of the first plan; a later one takes one pass, about the plan before
SAFE_WASHOUT = "ship"  # of configs/washout/, in place of a late plan
TIME_ROUNDING = 1e-6  # of a period


class Config(Model):
    """Predictive washout: the best motion of the legs, planned anew every period over what lies ahead in a log."""

    kind: Literal["predictive"] = "predictive"
    force_scale: Vector3 = quantity("1")
    """Scale of acceleration along x, y and z."""
    rotation_scale: Vector3 = quantity("1")
    """Scale of roll, pitch and yaw."""
    horizon: float = quantity("s", 40.0, ge=0.4, le=60.0)
    """Time over which the motion is planned."""
    period: float = quantity("s", 5.0, ge=KNOT_INTERVAL)
    """Time between plans."""

    def contradictions(self) -> Iterator[str]:
        knots = self.period / KNOT_INTERVAL
        if abs(knots - round(knots)) > TIME_ROUNDING:
            yield f"period: {self.period:g} s is not a multiple of {KNOT_INTERVAL:g} s, the time between knots"
        if self.period > (1.0 - STOP_SHARE) * self.horizon:
            yield f"period: {self.period:g} s leaves no room to stop within a horizon of {self.horizon:g} s"

    @property
    def look_ahead(self) -> float:
        return self.horizon

    def build(self, every: float, geometry: Geometry, travel: np.ndarray) -> "Predictive":
        scales = {"force_scale": self.force_scale, "rotation_scale": self.rotation_scale}
        safe = classical.Config(**preset("washout", SAFE_WASHOUT) | scales)
        return Predictive(self, geometry, safe.build(every, geometry, travel))


class Predictive:
    """Predictive washout of one ride: plans the motion of the legs over the horizon anew in each period."""

    def __init__(self, config: Config, geometry: Geometry, safe: Washout) -> None:
        """`safe`: the washout in place of a late plan. Raises Lacking without the solver."""
        load_solver()
        self.config, self.plan = config, LegPlan(geometry, Hexapod(geometry), stops=True)
        self.safe, self.late, self.plans_legs = safe, False, True  # the latter of all rows of the last call
        self.start, self.number = np.nan, -1  # time of the first row [s], number of the plan
        self.known = np.zeros((0, 7))  # rows of the last period: time [s], specific force [m/s2], rate [rad/s]

    def follow(self, ride: Ride, ahead: Ride | Ghost | None = None) -> Cue:
        """Requested poses for the next rows of ship motion. `ahead`: rows that follow them, over the whole horizon, or
        a ghost. Raises Failed where a log has no plan."""
        self.start = float(ride.time[0]) if np.isnan(self.start) else self.start
        now, period = self.asked_rows(ride), self.config.period
        past = np.vstack([self.known, now])
        known = np.vstack([past, self.asked_rows(ahead)]) if isinstance(ahead, Ride) else past
        ghost = None if isinstance(ahead, Ride) else ahead
        numbers = np.floor((ride.time - self.start) / period + TIME_ROUNDING).astype(int)
        pose, late = np.empty((len(now), 6)), np.zeros(len(now), dtype=bool)
        for number in np.unique(numbers).tolist():
            if number > self.number:
                self.late = not (self.replan(number, known) if ghost is None else self.take_plan(number, past, ghost))
                self.number = number
            here = numbers == number
            since = ride.time[here] - self.start - number * period
            pose[here], late[here] = self.plan.poses(np.maximum(since, 0.0) / KNOT_INTERVAL), self.late
        self.known = past[past[:, 0] >= past[-1, 0] - period - KNOT_INTERVAL]
        self.plans_legs, limited = not late.any(), np.zeros(len(pose), dtype=int)
        if ghost is not None:
            safe = self.safe.follow(ride)
            pose, limited = np.where(late[:, None], safe.pose, pose), np.where(late, safe.limited | LATE_PLAN, 0)
        return Cue(pose, limited, *np.split(now[:, 1:], 2, axis=1))

    def asked_rows(self, ride: Ride) -> np.ndarray:
        """Rows (n, 7) of a ride: time [s], specific force [m/s2] and rate [rad/s] asked for."""
        asked = scaled_motion(ride, self.config.force_scale, self.config.rotation_scale)
        return np.column_stack([ride.time, *asked])

    def at_knots(self, rows: np.ndarray, number: int, seconds: float) -> np.ndarray:
        """Motion (k, 6) in `rows` (n, 7) at the knots of plan `number`, over the first `seconds` of it."""
        begin = self.start + number * self.config.period
        return motion_at(rows, begin + KNOT_INTERVAL * np.arange(round(seconds / KNOT_INTERVAL)))

    def replan(self, number: int, rows: np.ndarray) -> bool:
        """Replace the plan, the one before `number`, by that of this number, for motion `rows`; True, or Failed."""
        if number:
            self.plan.leave(self.at_knots(rows, number - 1, self.config.period))
        self.plan.improve(self.at_knots(rows, number, self.config.horizon), 1 if number else FIRST_PASSES)
        return True

    def take_plan(self, number: int, rows: np.ndarray, ghost: Ghost) -> bool:
        """Take over plan `number` from a ghost, or else go on with the one before, and ask for the next; `rows`: motion
        so far. False if there is no new plan."""

        def ask(number: int) -> None:
            until = self.start + number * self.config.period + self.config.horizon
            plan = self.plan.points, self.plan.motion, self.plan.state
            ghost.ask(number, until, KNOT_INTERVAL, (self.start, number, rows, *plan))

        if number:
            self.plan.leave(self.at_knots(rows, number - 1, self.config.period))
        else:
            ask(number)
        found = ghost.answer(number)
        if found is not None:
            self.plan.points, self.plan.motion = found
        ask(number + 1)
        return found is not None

    def foresee(self, ride: Ride, question: tuple) -> tuple[np.ndarray, np.ndarray]:
        """Control points and motion of the plan that `take_plan` asks for, by the ride of a ghost; raises Failed."""
        self.start, number, rows, self.plan.points, self.plan.motion, self.plan.state = question
        later = self.asked_rows(ride)
        self.replan(number, np.vstack([rows, later[later[:, 0] > rows[-1, 0]]]))
        return self.plan.points, self.plan.motion
