"""A motion platform: the motion of a ship in, poses and leg lengths out; it feeds nothing back."""

from typing import Any, NamedTuple, Protocol

import numpy as np

from ocean_sim.model import Vector3
from ocean_sim.platform.shared.kinematics import Geometry
from ocean_sim.platform.shared.motion_log import Ride

LEG_NUMBERS = range(1, 7)
PLATFORM_COLUMNS = (
    *("time_s", "seq", "x_m", "y_m", "z_m", "roll_rad", "pitch_rad", "yaw_rad"),
    *(f"leg{k}_m" for k in LEG_NUMBERS),
    *(f"leg{k}_velocity_m_s" for k in LEG_NUMBERS),
    *(f"felt_force_{axis}_m_s2" for axis in "xyz"),
    *(f"felt_rate_{axis}_rad_s" for axis in "xyz"),
    "limited",
)

# Bits of `limited`.
STROKE_LIMIT, LEG_SPEED_LIMIT, LEG_ACCELERATION_LIMIT = 1, 2, 4
TILT_RATE_LIMIT, INPUT_LIMIT, SINGULARITY_LIMIT, LATE_PLAN = 8, 16, 32, 64
LIMIT_TEXTS = {
    STROKE_LIMIT: "scaled back near the end of a stroke, or from beyond it",
    LEG_SPEED_LIMIT: "held to the speed of a leg",
    LEG_ACCELERATION_LIMIT: "held to the acceleration of a leg",
    TILT_RATE_LIMIT: "tilt held to its rate",
    INPUT_LIMIT: "input clipped, or cut at the end of the travel",
    SINGULARITY_LIMIT: "scaled back from a singular pose",
    LATE_PLAN: "moved by the classical washout, as no plan was ready",
}


class Cue(NamedTuple):
    """Output of a washout: requested poses, and motion to be felt, in rows; FLU axes (x forward, y left, z up)."""

    pose: np.ndarray  # (n, 6) x, y, z [m] from neutral, roll, pitch, yaw [rad]: Rz(yaw) Ry(pitch) Rx(roll)
    limited: np.ndarray  # (n,) sum of the limits that acted
    force: np.ndarray  # (n, 3) scaled specific force to be felt, body axes [m/s2]
    rate: np.ndarray  # (n, 3) scaled rates to be felt, body axes [rad/s]


class Commands(NamedTuple):
    """Commands of a platform: poses, leg lengths, felt motion, in rows along FLU axes (x forward, y left, z up)."""

    time: np.ndarray  # (n,) [s]
    seq: np.ndarray  # (n,) number of the row
    pose: np.ndarray  # (n, 6) x, y, z [m] from neutral, roll, pitch, yaw [rad]
    legs: np.ndarray  # (n, 6) lengths [m]
    leg_velocity: np.ndarray  # (n, 6) [m/s]
    felt_force: np.ndarray  # (n, 3) specific force on the platform, body axes [m/s2]
    felt_rate: np.ndarray  # (n, 3) body axes [rad/s]
    limited: np.ndarray  # (n,) sum of the limits that acted
    cue: Cue  # the request of the washout

    def select(self, which: slice) -> "Commands":
        """Copy with the rows of a slice, in all columns."""
        cue = Cue(*(column[which] for column in self.cue))
        return Commands._make([*(column[which] for column in self[:-1]), cue])

    def rows(self) -> list[list[float | int]]:
        """Rows of platform.csv: one list of numbers for each time, in the order of PLATFORM_COLUMNS."""
        columns = (self.pose, self.legs, self.leg_velocity, self.felt_force, self.felt_rate)
        table = np.hstack(columns) + 0.0
        heads, ends = zip(self.time.tolist(), self.seq.tolist()), self.limited.tolist()
        return [[*head, *row, end] for head, row, end in zip(heads, table.tolist(), ends)]


class Planner(Protocol):
    """Interface of what plans for a washout: mostly another process, which may run a copy of the ship ahead."""

    def ask(self, number: int, until: float, every: float, question: tuple) -> None:
        """Begin plan `number`, unless one is under way: `foresee` of the washout, for rows `every` [s] until then."""

    def answer(self, number: int, dispensable: bool) -> Any:
        """Plan `number`, or None. Plan 0 is waited for, as is each plan of a run that is not held to real time.
        `dispensable`: the plan before still moves the platform."""


class Washout(Protocol):
    """Interface of a washout: a filter from ship motion to platform motion, fed with successive chunks of rows."""

    plans_legs: bool  # True if its poses keep the legs within their stroke

    def follow(self, ride: Ride, ahead: Ride | Planner | None = None) -> Cue:
        """Platform poses requested for the rows of ship motion that follow those of the last call; the filter keeps its
        state. `ahead`: the rows after them, up to `look_ahead` of the Config, or what plans."""


class WashoutConfig(Protocol):
    """Interface of the Config class of each module in platform/washout/; `kind` is the module's name."""

    @property
    def kind(self) -> str: ...

    @property
    def force_scale(self) -> Vector3:
        """Scale of acceleration along x, y and z."""

    @property
    def rotation_scale(self) -> Vector3:
        """Scale of roll, pitch and yaw."""

    @property
    def look_ahead(self) -> float | None:
        """Time [s] by which the washout must know the ship's motion in advance; 0 if it guesses that, None if it does
        not plan."""

    def build(self, every: float, geometry: Geometry, travel: np.ndarray) -> Washout:
        """Washout for rows `every` [s] and a platform; `travel` (3, 2): its lowest and highest x, y, z [m]."""


class Platform(Protocol):
    """Interface of a motion platform: a washout, and the machine (legs) that carries out the poses it requests."""

    washout: Any  # one that plans has `foresee(ride, question)`, whose value is the planner's answer

    @property
    def neutral_legs(self) -> np.ndarray:
        """Lengths (6,) of the legs in the neutral pose [m]."""

    def follow(self, ride: Ride, ahead: Ride | Planner | None = None) -> Commands:
        """Commands for the next rows of ship motion, after the last call's. `ahead`: as the washout takes it."""

    def return_home(self, past: np.ndarray, time: float, seq: int) -> Commands:
        """Commands from the last two poses, `past` (2, 6), to neutral; the last: at `time` [s], in row number `seq`."""
