"""A motion platform: the motion of a ship in, poses and leg lengths out; it feeds nothing back."""

from typing import NamedTuple, Protocol

import numpy as np

from ocean_sim.platform.shared.motion_log import Ride

LEGS = range(1, 7)
COLUMNS = (
    *("time_s", "seq", "x_m", "y_m", "z_m", "roll_rad", "pitch_rad", "yaw_rad"),
    *(f"leg{k}_m" for k in LEGS),
    *(f"leg{k}_velocity_m_s" for k in LEGS),
    *(f"felt_force_{axis}_m_s2" for axis in "xyz"),
    *(f"felt_rate_{axis}_rad_s" for axis in "xyz"),
    "limited",
)

# What `limited` is the sum of.
STROKE, LEG_SPEED, LEG_ACCELERATION, TILT_RATE, INPUT, SINGULAR = 1, 2, 4, 8, 16, 32
LIMITS = {
    STROKE: "scaled back near the end of a stroke, or from beyond it",
    LEG_SPEED: "held to the speed of a leg",
    LEG_ACCELERATION: "held to the acceleration of a leg",
    TILT_RATE: "tilt held to its rate",
    INPUT: "input clipped, or cut at the end of the travel",
    SINGULAR: "scaled back from a singular pose",
}


class Cue(NamedTuple):
    """What a washout asks of a platform, row by row, along FLU: x forward, y left, z up."""

    pose: np.ndarray  # (n, 6) x, y, z [m] from neutral, roll, pitch, yaw [rad]: Rz(yaw) Ry(pitch) Rx(roll)
    limited: np.ndarray  # (n,) sum of what held it back
    force: np.ndarray  # (n, 3) the scaled specific force that it tries to make felt, body axes [m/s2]
    rate: np.ndarray  # (n, 3) the scaled rates that it tries to make felt, body axes [rad/s]


class Commands(NamedTuple):
    """What a platform does, row by row, along FLU: x forward, y left, z up."""

    time: np.ndarray  # (n,) [s]
    seq: np.ndarray  # (n,) number of the row
    pose: np.ndarray  # (n, 6) x, y, z [m] from neutral, roll, pitch, yaw [rad]
    legs: np.ndarray  # (n, 6) lengths [m]
    leg_velocity: np.ndarray  # (n, 6) [m/s]
    felt_force: np.ndarray  # (n, 3) specific force on the platform, body axes [m/s2]
    felt_rate: np.ndarray  # (n, 3) body axes [rad/s]
    limited: np.ndarray  # (n,) sum of what held it back
    cue: Cue  # what the washout wanted

    def some(self, which: slice) -> "Commands":
        """Some of the rows."""
        cue = Cue(*(column[which] for column in self.cue))
        return Commands._make([*(column[which] for column in self[:-1]), cue])

    def rows(self) -> list[list[float | int]]:
        """The rows of platform.csv."""
        columns = (self.pose, self.legs, self.leg_velocity, self.felt_force, self.felt_rate)
        table = np.hstack(columns) + 0.0
        heads, ends = zip(self.time.tolist(), self.seq.tolist()), self.limited.tolist()
        return [[*head, *row, end] for head, row, end in zip(heads, table.tolist(), ends)]


class Washout(Protocol):
    """From what a ship does to what a platform can: rows come in the order of time, as many at once as there are."""

    def follow(self, ride: Ride) -> Cue: ...


class WashoutConfig(Protocol):
    """The Config of a washout: a module of platform/washout/ has one, with its kind's name as `kind`."""

    @property
    def kind(self) -> str: ...

    def build(self, every: float, travel: np.ndarray) -> Washout:
        """`every`: time between rows [s]; `travel` (3, 2): lowest and highest x, y, z that can be reached [m]."""


class Platform(Protocol):
    """A washout and the machine under it."""

    @property
    def neutral_legs(self) -> np.ndarray:
        """(6,) lengths of the legs in neutral [m]."""

    def follow(self, ride: Ride) -> Commands: ...

    def settled(self, past: np.ndarray, time: float, seq: int) -> Commands:
        """The way back to neutral from the (2, 6) poses of the last two rows, the last of this time [s] and number."""
