"""Predictive washout: the best motion of the legs over the time ahead, found anew every period.

Model predictive cueing (Khusro et al. 2020, Vehicles 2, 625) by the programme of `leg_programme`: it ends at rest, so
what is left of a plan can always be carried on. Where no plan is found in time, the platform passes over to a classical
washout within a horizon, and back again.
"""

from typing import Literal

import numpy as np
from pydantic import model_validator

from ocean_sim.model import Model, quantity
from ocean_sim.platform import LATE_LIMIT, Cue
from ocean_sim.platform.shared import leg_programme
from ocean_sim.platform.shared.kinematics import Geometry, Hexapod
from ocean_sim.platform.shared.leg_programme import END_POINTS, KNOT_INTERVAL, NEUTRAL_COST
from ocean_sim.platform.shared.limits import Workspace
from ocean_sim.platform.shared.motion_log import Ride
from ocean_sim.platform.shared.washing import rest_force, scaled_motion
from ocean_sim.platform.washout import classical

PLAN_TOLERANCE = 1e-3  # of a solution
TIME_ROUNDING = 1e-6  # of a period
# Time [s] in which the weight of an error ahead falls by a factor e; cost of a leg 1 m from neutral at a knot (who does
# not know what comes keeps room for it in both directions); and passes of a plan, each about the solution before.
PREVIEWS = {"hold": (0.25, 0.1, 1), "linear": (0.5, 0.1, 1), "ghost": (np.inf, NEUTRAL_COST, 2)}
REMEMBERED_TIME = 30.0  # [s] of motion that a linear prediction is fitted to
SAMPLE_INTERVAL, SAMPLE_COUNT = 0.1, 20  # [s], and number of former samples that it adds up
MIN_SAMPLES = 30  # that it is fitted to; with fewer the motion is held
SINGULAR_CUTOFF = 1e-2  # of the largest singular value: directions below it are noise


class Config(Model):
    """Predictive washout: the best motion of the legs over a horizon, found anew every period from a preview."""

    kind: Literal["predictive"] = "predictive"
    fallback: classical.Config
    """Its scales say what is to be felt; it leads where no plan is found in time."""
    horizon: float = quantity("s", 2.0, ge=0.4, le=60.0)
    """Time over which the motion is planned."""
    period: float = quantity("s", 0.08, ge=KNOT_INTERVAL)
    """Time between plans."""
    preview: Literal["hold", "linear", "ghost"] = "linear"
    """Motion ahead: `hold`, the last one goes on; `linear`, predicted from the last 30 s; `ghost`, that of the log."""
    time_limit: float | None = quantity("s", None, gt=0.0)
    """Longest time for a plan; null waits for it, and gives the same bytes each time."""

    @model_validator(mode="after")
    def _check_period(self) -> "Config":
        """Raise ValueError unless the period is a number of knots and leaves room in the horizon."""
        knots = self.period / KNOT_INTERVAL
        if abs(knots - round(knots)) > TIME_ROUNDING:
            raise ValueError(
                f"period: {self.period:g} s is not a multiple of {KNOT_INTERVAL:g} s, the time between knots"
            )
        if self.period > self.horizon - 2 * END_POINTS * KNOT_INTERVAL:
            raise ValueError(f"period: {self.period:g} s leaves no room to stop within a horizon of {self.horizon:g} s")
        return self

    @property
    def look_ahead(self) -> float:
        return self.horizon if self.preview == "ghost" else 0.0

    def build(self, every: float, geometry: Geometry, travel: np.ndarray) -> "Predictive":
        return Predictive(self, every, geometry, travel)


class Predictive:
    """Predictive washout of one ride."""

    plans_legs = True

    def __init__(self, config: Config, every: float, geometry: Geometry, travel: np.ndarray) -> None:
        """`every`: time between rows [s]; `travel`: as for `WashoutConfig.build`."""
        self.config, self.geometry, self.hexapod = config, geometry, Hexapod(geometry)
        self.fallback = config.fallback.build(every, geometry, travel)
        self.steps = round(config.period / KNOT_INTERVAL)  # knots from plan to plan
        self.workspace = Workspace(self.hexapod)
        knots = round(config.horizon / KNOT_INTERVAL)
        self.points = np.tile(self.hexapod.neutral_legs, (knots + 2, 1))  # (n + 2, 6) [m]
        self.motion = np.zeros((knots, 18))  # at the knots of the plan
        self.state = np.zeros((6, 2))  # of the organs at the first knot
        self.start, self.plan, self.late_share, self.is_late = np.nan, -1, 0.0, False
        self.known = np.zeros((0, 10))  # rows of late: time [s], specific force [m/s2], rate [rad/s], attitude [rad]

    def follow(self, ride: Ride, ahead: Ride | None = None) -> Cue:
        """Requested poses for the next rows of ship motion; `ahead`: rows after them, of a `ghost`."""
        safe, config = self.fallback.follow(ride), self.config
        self.start = float(ride.time[0]) if np.isnan(self.start) else self.start
        rows = np.vstack([self.known, *(self.asked_rows(part) for part in (ride, ahead) if part is not None)])
        plans = np.floor((ride.time - self.start) / config.period + TIME_ROUNDING).astype(int)
        within, scaled = self.workspace.scale_back(safe.pose)
        pose, limited = np.empty_like(safe.pose), np.zeros(len(ride.time), dtype=int)
        for plan in np.unique(plans):
            now = self.start + plan * config.period
            if plan > self.plan:
                self.replan(rows, now)
                self.plan = plan
            here = plans == plan
            at = np.maximum(ride.time[here] - now, 0.0) / KNOT_INTERVAL
            guess = self.motion[np.minimum(at.astype(int), len(self.motion) - 1), :6]
            planned = self.hexapod.pose(leg_programme.spline_values(self.points, at), guess)
            way = at * KNOT_INTERVAL / config.horizon * (1.0 if self.is_late else -1.0)
            late = np.clip(self.late_share + way, 0.0, 1.0)[:, None]
            pose[here] = planned + late * (within[here] - planned)
            limited[here] = np.where(late[:, 0] > 0.0, safe.limited[here] | scaled[here] | LATE_LIMIT, 0)
        past = rows[: len(self.known) + len(ride.time)]
        self.known = past[past[:, 0] >= past[-1, 0] - REMEMBERED_TIME]
        return safe._replace(pose=pose, limited=limited)

    def asked_rows(self, ride: Ride) -> np.ndarray:
        """Rows (n, 10) of a ride: time [s], and specific force [m/s2], rate [rad/s] and attitude [rad] to be felt."""
        scales = self.config.fallback
        return np.column_stack([ride.time, *scaled_motion(ride, scales), ride.attitude * scales.rotation_scale])

    def replan(self, rows: np.ndarray, now: float) -> None:
        """Plan the motion from a time `now` [s] on, by rows (n, 10) as in `known`, of which a ghost's lie ahead."""
        config, k, n = self.config, self.steps, len(self.motion)
        if self.plan >= 0:  # the organs felt the plan so far
            felt = leg_programme.felt_at(self.motion[:k])
            asked = leg_programme.motion_at(rows[:, :7], now + KNOT_INTERVAL * np.arange(-k, 0))
            self.state = leg_programme.sensed_error(felt - asked, KNOT_INTERVAL, self.state)[1]
            self.late_share = float(
                np.clip(self.late_share + config.period / config.horizon * (1.0 if self.is_late else -1.0), 0.0, 1.0)
            )
            self.points = np.vstack([self.points[k:], np.repeat(self.points[-1:], k, axis=0)])
            self.motion = np.vstack([self.motion[k:], np.repeat(self.motion[-1:], k, axis=0)])
        knots = now + KNOT_INTERVAL * np.arange(n)
        past = rows[rows[:, 0] <= now + TIME_ROUNDING]
        if config.preview == "ghost":
            asked = leg_programme.motion_at(rows[:, :7], knots)
        else:
            asked = foreseen(past, knots, config.preview)
        trust, neutral_cost, passes = PREVIEWS[config.preview]
        ask = leg_programme.Asked(asked, trust, neutral_cost)
        for _ in range(passes):
            guess = self.motion[:, :6]
            found = leg_programme.solve_programme(
                self.geometry, self.hexapod, ask, self.points, guess, self.state, PLAN_TOLERANCE, config.time_limit
            )
            self.is_late = found is None
            if found is not None:
                self.points = found
            self.motion = leg_programme.leg_track(self.hexapod, self.points, guess).motion


def foreseen(past: np.ndarray, times: np.ndarray, preview: str) -> np.ndarray:
    """Specific force [m/s2] and rate [rad/s] (k, 6) at even times (k,) [s] after rows (n, 10) of the `past`: free of
    gravity it is held or predicted, and gravity turns with the ship."""
    inertial = past[:, 1:4] - rest_force(past[:, 7:])
    motion = np.column_stack([past[:, 0], inertial, past[:, 4:7]])
    found = predicted(motion, times) if preview == "linear" else np.tile(motion[-1, 1:], (len(times), 1))
    turned = np.cumsum(found[:, 3:], axis=0) * (times[1] - times[0])
    return np.hstack([found[:, :3] + rest_force(past[-1, 7:] + turned - turned[0]), found[:, 3:]])


def predicted(past: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Motion (k, 6) at times (k,) [s] after rows (n, 7) of the `past`: each component is the sum of its SAMPLE_COUNT
    former samples that predicted the past best (linear prediction: Makhoul 1975, Proc. IEEE 63, 561)."""
    last, count = past[-1, 0], int((past[-1, 0] - past[0, 0]) / SAMPLE_INTERVAL) + 1
    if count < MIN_SAMPLES:
        return np.tile(past[-1, 1:], (len(times), 1))
    samples = leg_programme.motion_at(past, last + SAMPLE_INTERVAL * np.arange(1 - count, 1))
    ahead = int(np.ceil((times[-1] - last) / SAMPLE_INTERVAL))
    found = np.empty((ahead + 1, 6))
    for k, whole in enumerate(samples.T):
        middle, size = whole.mean(), np.abs(whole - whole.mean()).max()
        signal = (whole - middle).tolist()
        windows = np.lib.stride_tricks.sliding_window_view(np.array(signal), SAMPLE_COUNT)
        weights = np.linalg.lstsq(windows[:-1], np.array(signal[SAMPLE_COUNT:]), rcond=SINGULAR_CUTOFF)[0]
        for _ in range(ahead):
            signal.append(float(np.clip(weights @ signal[-SAMPLE_COUNT:], -size, size)))
        found[:, k] = middle + signal[count - 1 :]
    steps = last + SAMPLE_INTERVAL * np.arange(ahead + 1)
    return leg_programme.motion_at(np.column_stack([steps, found]), times)
