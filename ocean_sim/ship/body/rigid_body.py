"""One rigid body in f64, after chapter 4.1 of the thesis: quaternion algebra, (4.11) to (4.25), and one step.

Angular momentum in world axes is the state, so it is kept to rounding without a torque, and the pose turns by (4.25)
at the midpoint: second-order in the step, at the cost of the thesis's forward Euler.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ocean_sim.ship.body import small_linalg


@dataclass(frozen=True)
class RigidBody:
    """State of a rigid body; in world axes unless stated otherwise."""

    mass: float  # [kg]
    inertia_body: np.ndarray  # (3, 3) about the centre of mass, body axes [kg m2]
    position: np.ndarray  # (3,) centre of mass [m]
    orientation: np.ndarray  # (4,) unit quaternion (w, x, y, z), body to world
    velocity: np.ndarray  # (3,) of the centre of mass [m/s]
    angular_momentum: np.ndarray  # (3,) about the centre of mass [kg m2/s]

    @cached_property
    def rows(self) -> small_linalg.Rows:
        """Rows of the (3, 3) rotation matrix, body to world, as Python floats."""
        return small_linalg.rotation_matrix(self.orientation.tolist())

    @cached_property
    def own_spin(self) -> small_linalg.Three:
        """Angular velocity in body axes [rad/s], as three Python floats."""
        momentum = small_linalg.transpose_times(self.rows, self.angular_momentum.tolist())
        return small_linalg.solve_3x3(self.inertia_body.tolist(), momentum)

    @cached_property
    def spin(self) -> small_linalg.Three:
        """Angular velocity in world axes [rad/s], as three Python floats."""
        return small_linalg.matrix_times(self.rows, self.own_spin)

    @cached_property
    def own_velocity(self) -> small_linalg.Three:
        """Velocity of the centre of mass in body axes [m/s], as three Python floats."""
        return small_linalg.transpose_times(self.rows, self.velocity.tolist())

    @cached_property
    def matrix(self) -> np.ndarray:
        """(3, 3) rotation matrix, body to world."""
        return np.array(self.rows)

    @cached_property
    def angular_velocity(self) -> np.ndarray:
        """(3,) angular velocity in world axes [rad/s]."""
        return np.array(self.spin)

    @cached_property
    def rates(self) -> np.ndarray:
        """(3,) angular velocity in body axes: pitch, yaw and roll rate [rad/s]."""
        return np.array(self.own_spin)

    @cached_property
    def angles(self) -> np.ndarray:
        """(3,) pitch, yaw, roll [rad]: intrinsic yaw about Y, then pitch about X, then roll about Z."""
        return euler_angles(self.orientation)

    def kinetic_energy(self) -> float:
        """Kinetic energy of translation and rotation [J]."""
        turning = self.angular_velocity @ self.angular_momentum
        return 0.5 * float(self.mass * self.velocity @ self.velocity + turning)

    def point(self, arm: np.ndarray) -> np.ndarray:
        """World position [m] of a point whose position from the centre of mass is `arm`, body axes [m]."""
        return self.position + self.matrix @ arm

    def point_velocity(self, arm: np.ndarray) -> np.ndarray:
        """World velocity [m/s] of a point at `arm` from the centre of mass, body axes [m] (thesis 4.15)."""
        return self.velocity + cross(self.angular_velocity, self.matrix @ arm)


def to_world(load: np.ndarray, body: RigidBody) -> np.ndarray:
    """Force and torque `load` (2, 3) in the body axes of `body`, turned to world axes."""
    return np.array([small_linalg.matrix_times(body.rows, part) for part in load.tolist()])


def for_arrays(law: Callable[..., Any]) -> Callable[..., np.ndarray]:
    """Make `law`, a function of `small_linalg`, take and return arrays: one vector (k,), or n vectors as (k, n)."""
    return lambda *vectors: np.array(law(*(v.tolist() if v.ndim == 1 else list(v) for v in vectors)))


cross = for_arrays(small_linalg.cross)
quaternion_product = for_arrays(small_linalg.quaternion_product)
rotation_matrix = for_arrays(small_linalg.rotation_matrix)
unit_quaternion = for_arrays(small_linalg.unit_quaternion)
turn_quaternion = for_arrays(small_linalg.turn_quaternion)


def quaternion(axis: np.ndarray, angle: float) -> np.ndarray:
    """Quaternion (w, x, y, z) of a turn by `angle` [rad] about the unit vector `axis` (3,) (thesis 4.6)."""
    return np.concatenate([[np.cos(angle / 2.0)], np.sin(angle / 2.0) * np.asarray(axis)])


def quaternion_inverse(q: np.ndarray) -> np.ndarray:
    """Inverse of a unit quaternion `q` (4,), w, x, y, z, or of n as (4, n) (thesis 4.8)."""
    return np.array([q[0], *-q[1:]])


def rotate_vector(q: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """(3,) `vector` turned by a unit quaternion `q` (w, x, y, z) (thesis 4.9)."""
    return quaternion_product(quaternion_product(q, np.concatenate([[0.0], vector])), quaternion_inverse(q))[1:]


def axis_rotation(axis: int, angle: float) -> np.ndarray:
    """(3, 3) rotation matrix of a turn by `angle` [rad] about `axis` 0, 1 or 2: x, y or z (thesis 4.3)."""
    return rotation_matrix(quaternion(np.eye(3)[axis], angle))


def euler_quaternion(pitch: float, yaw: float, roll: float) -> np.ndarray:
    """Quaternion (w, x, y, z) of intrinsic yaw about Y, then pitch about X, then roll about Z [rad]."""
    turns = [quaternion(np.eye(3)[axis], angle) for axis, angle in ((1, yaw), (0, pitch), (2, roll))]
    return quaternion_product(quaternion_product(turns[0], turns[1]), turns[2])


def euler_angles(q: np.ndarray) -> np.ndarray:
    """(3,) pitch, yaw, roll [rad] of a quaternion `q` (4,), or (3, n) of (4, n); the inverse of `euler_quaternion`."""
    r = rotation_matrix(q)
    pitch = np.arcsin(np.minimum(np.maximum(-r[1, 2], -1.0), 1.0))
    return np.array([pitch, np.arctan2(r[0, 2], r[2, 2]), np.arctan2(r[1, 0], r[1, 1])])


def with_spin(body: RigidBody, omega: np.ndarray) -> RigidBody:
    """Copy of `body` with the angular velocity `omega`, world axes [rad/s], and its angular momentum (thesis 4.19)."""
    turn = body.matrix
    return replace(body, angular_momentum=turn @ body.inertia_body @ turn.T @ omega)


def advance_body(body: RigidBody, force: np.ndarray, torque: np.ndarray, dt: float) -> RigidBody:
    """Body dt [s] later under a force [N] and a torque about its centre of mass [N m] (thesis 4.22 to 4.25). The new
    velocity moves it, so an oscillator neither gains nor loses energy; its rotation is that at the midpoint."""
    inertia, start = body.inertia_body.tolist(), body.orientation.tolist()
    momentum = small_linalg.plus(body.angular_momentum.tolist(), small_linalg.times(dt, torque.tolist()))
    now = small_linalg.spin_of(body.rows, momentum, inertia)
    halfway = small_linalg.quaternion_product(small_linalg.turn_quaternion(small_linalg.times(dt / 2.0, now)), start)
    omega = small_linalg.spin_of(small_linalg.rotation_matrix(halfway), momentum, inertia)
    turn = small_linalg.turn_quaternion(small_linalg.times(dt, omega))
    turned = small_linalg.unit_quaternion(small_linalg.quaternion_product(turn, start))
    velocity = body.velocity + force / body.mass * dt
    position = body.position + velocity * dt
    return RigidBody(body.mass, body.inertia_body, position, np.array(turned), velocity, np.array(momentum))


def thesis_advance(body: RigidBody, force: np.ndarray, torque: np.ndarray, dt: float) -> RigidBody:
    """Body dt [s] later under `force` [N] and `torque` [N m] (3,), world axes, by (4.22), (4.23), (4.25) of the thesis
    as printed: forward Euler, with the velocities at the start of the step. Algorithm 7 prints v = a dt, x = v dt; here
    they are increments, as in (4.22) and (4.23)."""
    r, omega = body.matrix, body.angular_velocity
    inertia = r @ body.inertia_body @ r.T
    faster = omega + np.linalg.solve(inertia, torque - cross(omega, inertia @ omega)) * dt
    orientation = unit_quaternion(quaternion_product(turn_quaternion(omega * dt), body.orientation))
    turned = rotation_matrix(orientation)
    return replace(
        body,
        velocity=body.velocity + force / body.mass * dt,
        position=body.position + body.velocity * dt,
        orientation=orientation,
        angular_momentum=turned @ body.inertia_body @ turned.T @ faster,
    )


def hold_motions(body: RigidBody, free: np.ndarray) -> RigidBody:
    """Copy of a body in which velocities are 0 but in its `free` motions, (6,) booleans in the order of `Motions`. Sway
    and surge are along the ship's heading, heave is vertical, and turns are about the body's axes."""
    if False not in free.tolist():
        return body
    r, heading = body.matrix, axis_rotation(1, body.angles[1])
    rates = np.where(free[3:], body.rates, 0.0)
    return replace(
        body,
        velocity=heading @ np.where(free[:3], heading.T @ body.velocity, 0.0),
        angular_momentum=r @ body.inertia_body @ rates,
    )


def guide_step(before: RigidBody, after: RigidBody, free: np.ndarray, dt: float) -> RigidBody:
    """Copy of `after`, the body dt [s] after `before`, as if on guides: its velocity is 0, and its pose that of
    `before`, in motions that are not `free`, (6,) booleans in the order of `Motions`."""
    if False not in free.tolist():
        return after
    heading, rates = axis_rotation(1, before.angles[1]), np.where(free[3:], after.rates, 0.0)
    ways = after.velocity, after.position - before.position
    velocity, moved = (heading @ np.where(free[:3], heading.T @ way, 0.0) for way in ways)
    turned = unit_quaternion(quaternion_product(before.orientation, turn_quaternion(rates * dt)))
    if (held := ~free[3:]).sum() == 1:  # two turns together, as roll and pitch, also turn about the third axis
        now, then = euler_angles(turned), before.angles
        held &= np.abs(np.sin(0.5 * (now - then))) < 0.5  # else pitch went through a right angle, where angles jump
        turned = euler_quaternion(*np.where(held, then, now))
    body = replace(after, velocity=velocity, position=before.position + moved, orientation=turned)
    return with_spin(body, body.matrix @ rates)
