"""Track of a rigid body that is observed step by step: its velocity at each moment, and its place between two moments.
A column of an array is a moment. Each number is computed by itself, so the result does not depend on the number of
moments at a time."""

from typing import NamedTuple

import numpy as np

from ocean_sim.ship.body.rigid_body import cross, euler_angles, quaternion_inverse, quaternion_product, rotation_matrix

UNKNOWN_VELOCITY = np.full(7, np.nan)  # the velocity of a moment before which nothing was seen


class Track(NamedTuple):
    """Positions [m] and quaternions (7, n) of a body at times (n,) [s], and their time derivatives (7, n)."""

    time: np.ndarray
    place: np.ndarray
    velocity: np.ndarray

    def moments(self, number: np.ndarray) -> "Track":
        """Copy of this track with only the moments whose indices are `number` (m,)."""
        return Track(self.time[number], self.place[:, number], self.velocity[:, number])


class Attitude(NamedTuple):
    """Orientation and angular velocity of a body at n moments."""

    orientation: np.ndarray  # (4, n) unit quaternion, body to world
    matrix: np.ndarray  # (3, 3, n) body to world
    spin: np.ndarray  # (3, n) angular velocity, world axes [rad/s]

    @property
    def angles(self) -> np.ndarray:
        """(3, n) pitch, yaw, roll [rad]: intrinsic yaw about Y, then pitch about X, then roll about Z."""
        return euler_angles(self.orientation)

    def to_body(self, vector: np.ndarray) -> np.ndarray:
        """(3, n) vectors turned from world axes to body axes."""
        return self.matrix[0] * vector[0] + self.matrix[1] * vector[1] + self.matrix[2] * vector[2]

    def point_acceleration(self, arm: np.ndarray, acceleration: np.ndarray, turning: np.ndarray) -> np.ndarray:
        """(3, n) acceleration [m/s2] of the point at `arm` [m], body axes, of a body whose centre has an `acceleration`
        [m/s2] and which has an angular acceleration `turning` [rad/s2]."""
        away = self.matrix[:, 0] * arm[0] + self.matrix[:, 1] * arm[1] + self.matrix[:, 2] * arm[2]
        return acceleration + cross(turning, away) + cross(self.spin, cross(self.spin, away))


def continuous_signs(orientation: np.ndarray) -> np.ndarray:
    """Quaternions `orientation` (4, n), w, x, y, z, each multiplied by 1 or -1 so that it lies nearer to the last."""
    away = (orientation[:, 1:] * orientation[:, :-1]).sum(axis=0) < 0.0
    return orientation * np.cumprod(np.append(1.0, np.where(away, -1.0, 1.0))) if away.any() else orientation


def pure_quaternion(vector: np.ndarray) -> np.ndarray:
    """(4, n) quaternions with scalar part 0 and the vectors (3, n)."""
    return np.concatenate([np.zeros_like(vector[:1]), vector])


def first_derivative(velocity: np.ndarray, spin: np.ndarray, orientation: np.ndarray) -> np.ndarray:
    """(7, n) time derivatives of position and quaternion `orientation` (4, n) (w, x, y, z), from velocity [m/s] and
    angular velocity `spin` [rad/s], (3, n) in world axes."""
    return np.concatenate([velocity, 0.5 * quaternion_product(pure_quaternion(spin), orientation)])


def second_derivative(
    acceleration: np.ndarray, turning: np.ndarray, spin: np.ndarray, orientation: np.ndarray
) -> np.ndarray:
    """(7, n) second derivatives of position and quaternion `orientation` (4, n); `turning` (3, n): rate of `spin`."""
    x, y, z = spin
    turned = quaternion_product(pure_quaternion(turning), orientation) - 0.5 * (x * x + y * y + z * z) * orientation
    return np.concatenate([acceleration, 0.5 * turned])


def join_moments(time: np.ndarray, place: np.ndarray, bends: np.ndarray, first: np.ndarray) -> Track:
    """Track through positions and quaternions `place` (7, n) at times (n,) [s]. Velocities are means over each step,
    corrected by second derivatives `bends` (7, n), linear in it; `first`: (7,) velocity at first, unknown if NaN."""
    step = time[1:] - time[:-1]
    mean = (place[:, 1:] - place[:, :-1]) / step
    if np.isnan(first).any():
        first = mean[:, 0] - step[0] * (2.0 * bends[:, 0] + bends[:, 1]) / 6.0
    velocity = np.empty(place.shape)
    velocity[:, 0], velocity[:, 1:] = first, mean + step * (bends[:, :-1] + 2.0 * bends[:, 1:]) / 6.0
    return Track(time, place, velocity)


class Between:
    """Interpolation of a track at n given times, each between two neighbouring moments."""

    def __init__(self, track: Track, time: np.ndarray, number: np.ndarray) -> None:
        """Locate each time (n,) [s] in its step; `number` (n,): index of the moment that ends the step."""
        self.time, self.after, self.before = time, number, np.maximum(number - 1, 0)
        self.ends = track.moments(self.before), track.moments(self.after)
        start, end = (moment.time for moment in self.ends)
        self.over = (time >= end) | (end <= start)  # where the moment after says all
        self.step = np.where(self.over, 1.0, end - start)
        self.part = np.maximum(0.0, (time - start) / self.step)  # of the step that is over

    def interpolated_track(self) -> Track:
        """Track at these times by cubic Hermite interpolation, third-order, with continuous position and velocity."""
        (before, after), s, step = self.ends, self.part, self.step
        moved = after.place - before.place
        start, end = step * before.velocity - moved, step * after.velocity - moved
        place = before.place + s * moved + s * (1.0 - s) * ((1.0 - s) * start - s * end)
        velocity = (moved + (1.0 - s) * (1.0 - 3.0 * s) * start - s * (2.0 - 3.0 * s) * end) / step
        return Track(self.time, np.where(self.over, after.place, place), np.where(self.over, after.velocity, velocity))

    def interpolated_values(self, known: np.ndarray) -> np.ndarray:
        """(n, m) values at these n times, linear between the values `known` (k, m) at the track's k moments."""
        earlier, later = known[self.before], known[self.after]
        return np.where(self.over[:, None], later, earlier + self.part[:, None] * (later - earlier))


def attitude_of(track: Track) -> Attitude:
    """Attitude of the body at the moments of a track, whose quaternions may have any length."""
    w, x, y, z = q = track.place[3:]
    square = w * w + x * x + y * y + z * z
    unit = q / np.sqrt(square)
    rates = 2.0 / square * quaternion_product(track.velocity[3:], quaternion_inverse(q))[1:]
    return Attitude(unit, rotation_matrix(unit), rates)
