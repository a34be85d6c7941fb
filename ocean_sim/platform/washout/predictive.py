"""Predictive washout: the best motion of the legs over a horizon of the ride, found anew every period.

Model predictive cueing (Khusro et al. 2020, Vehicles 2, 625) by the programme of `leg_programme`, for the motion in a
finished log, of a ghost (the ship run ahead with the helm as it is), or guessed from what was. A plan ends at rest, so
the next one can always carry it on. Without a log each period is planned during the one before; a late plan leaves that
in force, and where it would stop, the classical washout takes over.
"""

from collections.abc import Iterator
from typing import Any, Literal

import numpy as np
from pydantic import model_validator

from ocean_sim.model import Model, Vector3, quantity
from ocean_sim.parts import preset
from ocean_sim.platform import LATE_PLAN, Cue, Planner, Washout
from ocean_sim.platform.shared.foresight import FITTED_TIME, held_motion, predicted_motion
from ocean_sim.platform.shared.kinematics import Geometry, Hexapod
from ocean_sim.platform.shared.leg_programme import KNOT_INTERVAL, STOP_SHARE, LegPlan, load_solver, motion_at
from ocean_sim.platform.shared.motion_log import Ride
from ocean_sim.platform.shared.washing import scaled_motion
from ocean_sim.platform.washout import classical

FIRST_PASSES = 3  # of the first plan; a later one takes one pass, about the plan before
SAFE_WASHOUT = "ship"  # of configs/washout/, in place of a late plan
TIME_ROUNDING = 1e-6  # of a period
GUESSES = {"hold": held_motion, "linear": predicted_motion}  # by `preview`
GUESS_DEFAULTS = {"horizon": 3.0, "period": 0.12}  # [s] in place of the defaults where the motion ahead is a guess


class Config(Model):
    """Predictive washout: the best motion of the legs, planned anew every period over what lies ahead."""

    kind: Literal["predictive"] = "predictive"
    force_scale: Vector3 = quantity("1")
    """Scale of acceleration along x, y and z."""
    rotation_scale: Vector3 = quantity("1")
    """Scale of roll, pitch and yaw."""
    preview: Literal["ghost", "linear", "hold"] = "ghost"
    """Motion ahead. `ghost`: that of a finished log, or of the ship run ahead; `linear`: guessed by a linear law fitted
    to the motion so far; `hold`: the last one, which dies away."""
    horizon: float = quantity("s", 40.0, ge=0.4, le=60.0)
    """Time over which the motion is planned; by default 3 s for a guess."""
    period: float = quantity("s", 5.0, ge=KNOT_INTERVAL)
    """Time between plans; by default 0.12 s for a guess."""

    @model_validator(mode="before")
    @classmethod
    def _defaults(cls, given: Any) -> Any:
        """The keys as `given`, with the defaults of a guess if `preview` is one."""
        return GUESS_DEFAULTS | given if isinstance(given, dict) and given.get("preview") in GUESSES else given

    def contradictions(self) -> Iterator[str]:
        knots = self.period / KNOT_INTERVAL
        if abs(knots - round(knots)) > TIME_ROUNDING:
            yield f"period: {self.period:g} s is not a multiple of {KNOT_INTERVAL:g} s, the time between knots"
        if self.period > (1.0 - STOP_SHARE) * self.horizon:
            yield f"period: {self.period:g} s leaves no room to stop within a horizon of {self.horizon:g} s"

    @property
    def look_ahead(self) -> float:
        return 0.0 if self.preview in GUESSES else self.horizon

    def build(self, every: float, geometry: Geometry, travel: np.ndarray) -> "Predictive":
        scales = {"force_scale": self.force_scale, "rotation_scale": self.rotation_scale}
        safe = classical.Config(**preset("washout", SAFE_WASHOUT) | scales)
        return Predictive(self, geometry, safe.build(every, geometry, travel))


class Predictive:
    """Predictive washout of one ride: plans the motion of the legs over the horizon anew in each period."""

    def __init__(self, config: Config, geometry: Geometry, safe: Washout) -> None:
        """`safe`: the washout in place of a late plan. Raises Lacking without the solver."""
        load_solver()
        self.config, self.geometry, self.plan = config, geometry, LegPlan(geometry, Hexapod(geometry), stops=True)
        self.at_once: Planner | None = None
        self.safe, self.late, self.plans_legs = safe, False, True  # the latter of all rows of the last call
        self.start, self.number = np.nan, -1  # time of the first row [s], number of the period
        self.planned = 0  # number of the plan
        self.known = np.zeros((0, 10))  # rows of the last period, or of FITTED_TIME, as `asked_rows` gives them

    def follow(self, ride: Ride, ahead: Ride | Planner | None = None) -> Cue:
        """Requested poses for the next rows of ship motion. `ahead`: rows that follow them, over the whole horizon, or
        another process that plans. Raises Failed where a log has no plan."""
        self.start = float(ride.time[0]) if np.isnan(self.start) else self.start
        now, period = self.asked_rows(ride), self.config.period
        past = np.vstack([self.known, now])
        known = np.vstack([past, self.asked_rows(ahead)]) if isinstance(ahead, Ride) else past
        planner = None if isinstance(ahead, Ride) else ahead
        if planner is None and self.config.preview in GUESSES:
            planner = self.at_once = self.at_once or PlansAtOnce(Predictive(self.config, self.geometry, self.safe))
        numbers = np.floor((ride.time - self.start) / period + TIME_ROUNDING).astype(int)
        pose, late = np.empty((len(now), 6)), np.zeros(len(now), dtype=bool)
        for number in np.unique(numbers).tolist():
            if number > self.number:
                if planner is None:
                    self.replan(number, known)
                else:
                    self.late = not self.take_plan(number, past, planner)
                self.number = number
            here = numbers == number
            since = ride.time[here] - self.start - number * period
            pose[here], late[here] = self.plan.poses(np.maximum(since, 0.0) / KNOT_INTERVAL), self.late
        kept = FITTED_TIME if self.config.preview in GUESSES else period
        self.known = past[past[:, 0] >= past[-1, 0] - kept - KNOT_INTERVAL]
        self.plans_legs, limited = not late.any(), np.zeros(len(pose), dtype=int)
        if planner is not None:
            safe = self.safe.follow(ride)
            pose, limited = np.where(late[:, None], safe.pose, pose), np.where(late, safe.limited | LATE_PLAN, 0)
        return Cue(pose, limited, now[:, 1:4], now[:, 4:7])

    def asked_rows(self, ride: Ride) -> np.ndarray:
        """Rows (n, 10) of a ride: time [s], specific force [m/s2], rate [rad/s] and attitude [rad] asked for."""
        asked = scaled_motion(ride, self.config.force_scale, self.config.rotation_scale)
        return np.column_stack([ride.time, *asked, ride.attitude * self.config.rotation_scale])

    def at_knots(self, rows: np.ndarray, number: int, seconds: float) -> np.ndarray:
        """Motion (k, 6) in `rows` at the knots of plan `number`, over the first `seconds` of it."""
        begin = self.start + number * self.config.period
        return motion_at(rows[:, :7], begin + KNOT_INTERVAL * np.arange(round(seconds / KNOT_INTERVAL)))

    def replan(self, number: int, rows: np.ndarray) -> None:
        """Replace the plan, the one before `number`, by that of this number, for motion `rows`. Raises Failed."""
        if number:
            self.plan.leave(self.at_knots(rows, number - 1, self.config.period))
        self.plan.improve(self.at_knots(rows, number, self.config.horizon), 1 if number else FIRST_PASSES)

    def take_plan(self, number: int, rows: np.ndarray, planner: Planner) -> bool:
        """Take over plan `number`, or else go on with the one before, and ask for the next; `rows`: motion so far.
        False if there is no plan that would not stop in this period."""
        period, horizon = self.config.period, self.config.horizon
        rows = rows[: np.searchsorted(rows[:, 0], self.start + (number - TIME_ROUNDING) * period) + 1]

        def ask(number: int) -> None:
            plan = self.plan.points, self.plan.motion, self.plan.state
            until = self.start + number * period + horizon
            planner.ask(number, until, KNOT_INTERVAL, (self.start, number, rows, *plan))

        if number:
            self.plan.leave(self.at_knots(rows, number - 1, period))
        else:
            ask(number)
        reaches = (number + 1 - self.planned) * period <= (1.0 - STOP_SHARE) * horizon
        found = planner.answer(number, reaches)
        if found is not None:
            (self.plan.points, self.plan.motion), self.planned = found, number
        ask(number + 1)
        return found is not None or reaches

    def foresee(self, ride: Ride | None, question: tuple) -> tuple[np.ndarray, np.ndarray]:
        """Control points and motion of the plan that `take_plan` asks for, by the ride of a ghost, or None for a guess.
        Raises Failed."""
        self.start, number, rows, self.plan.points, self.plan.motion, self.plan.state = question
        if ride is None:
            later = self.guess(rows, self.start + number * self.config.period + self.config.horizon)
        else:
            later = self.asked_rows(ride)
            later = later[later[:, 0] > rows[-1, 0]]
        self.replan(number, np.vstack([rows, later]))
        return self.plan.points, self.plan.motion

    def guess(self, rows: np.ndarray, until: float) -> np.ndarray:
        """Rows (k, 10) after `rows`, at knots until a time [s], as `preview` guesses them; without attitude."""
        knots = np.arange(1, round((until - rows[-1, 0]) / KNOT_INTERVAL) + 1)
        motion = GUESSES[self.config.preview](rows, len(knots))
        return np.hstack([rows[-1, 0] + KNOT_INTERVAL * knots[:, None], motion, np.zeros((len(knots), 3))])


class PlansAtOnce:
    """Planner in this process, for a finished log whose motion ahead is guessed."""

    def __init__(self, washout: Predictive) -> None:
        """`washout`: a copy that only plans."""
        self.washout, self.question = washout, ()

    def ask(self, number: int, until: float, every: float, question: tuple) -> None:
        self.question = question

    def answer(self, number: int, dispensable: bool) -> Any:
        return self.washout.foresee(None, self.question)
