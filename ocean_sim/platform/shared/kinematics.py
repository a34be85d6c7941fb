"""A hexapod: two bodies joined by six legs. X forward, Y left, Z up; a pose is x, y, z [m] from neutral, roll, pitch,
yaw [rad], turned by Rz(yaw) Ry(pitch) Rx(roll)."""

from typing import Annotated

import numpy as np
from pydantic import Field, model_validator

from ocean_sim.conventions import GRAVITY
from ocean_sim.model import Model, Vector3, quantity

Joints = Annotated[tuple[Vector3, Vector3, Vector3, Vector3, Vector3, Vector3], Field(strict=False)]

NEWTON_STEPS = 30
LEG_TOLERANCE = 1e-13  # [m]
BISECTION_STEPS = 60


class Geometry(Model):
    """Joints and legs of a hexapod."""

    base: Joints = quantity("m")
    """The joints on the floor, leg by leg: x, y, z."""
    platform: Joints = quantity("m")
    """The joints on the platform, leg by leg, from the point whose pose is given."""
    shortest: float = quantity("m", gt=0.0)
    """Length of a leg that is all the way in."""
    longest: float = quantity("m", gt=0.0)
    """Length of a leg that is all the way out."""
    buffer: float = quantity("m", 0.0, ge=0.0)
    """Length kept free at both ends of the stroke."""
    leg_speed: float = quantity("m/s", 1.0, gt=0.0)
    """Highest speed of a leg."""
    leg_acceleration: float = quantity("m/s2", 10.0, gt=0.0)
    """Largest acceleration of a leg."""
    condition_limit: float = quantity("1", 10.0, gt=1.0)
    """Poses whose Jacobian is worse conditioned, with turns measured at the radius of the platform's joints, are
    refused as singular."""

    @model_validator(mode="after")
    @np.errstate(all="ignore")
    def _check_assembly(self) -> "Geometry":
        """Raise ValueError if no stroke is left, the legs do not reach, or the neutral pose is singular."""
        if self.longest - self.shortest <= 2.0 * self.buffer:
            stroke = f"{self.shortest:g} to {self.longest:g} m"
            raise ValueError(f"a stroke of {stroke} with a buffer of {self.buffer:g} m at both ends leaves no travel")
        hexapod = Hexapod(self)
        if not hexapod.neutral_height > 0.0:
            length = 0.5 * (self.shortest + self.longest)
            raise ValueError(f"it cannot be assembled: legs of {length:g} m, half way out, do not reach the platform")
        for k, length in enumerate(hexapod.neutral_legs, 1):
            if not hexapod.low < length < hexapod.high:
                ends = f"{hexapod.low:g} to {hexapod.high:g} m"
                raise ValueError(f"it cannot be assembled: in neutral leg {k} is {length:.4g} m long, outside {ends}")
        if not hexapod.radius > 0.0:
            raise ValueError("it cannot be held: all joints of its platform are at the point whose pose is given")
        condition = hexapod.condition(np.zeros((1, 6)))[0]
        if not condition < self.condition_limit:
            numbers = f"condition number {condition:.3g}, limit {self.condition_limit:g}"
            raise ValueError(f"it cannot be held: its neutral pose is singular ({numbers})")
        return self


class Hexapod:
    """Kinematics of a hexapod; its neutral pose is level, with the mean leg length in the middle of the stroke."""

    def __init__(self, geometry: Geometry) -> None:
        self.base = np.array(geometry.base)  # (6, 3) [m]
        self.joints = np.array(geometry.platform)  # (6, 3) [m]
        self.low, self.high = geometry.shortest + geometry.buffer, geometry.longest - geometry.buffer  # [m]
        self.radius = float(np.linalg.norm(self.joints, axis=1).mean())  # [m]
        self.condition_limit = geometry.condition_limit
        self.neutral_height = self.level_height(0.5 * (self.low + self.high))
        self.neutral_legs = self.legs(np.zeros((1, 6)))[0]

    def level_height(self, length: float) -> float:
        """Height [m] of the level platform above the base at which its legs have the mean `length` [m], or NaN."""
        offset = self.joints - self.base
        reach = np.linalg.norm(offset[:, :2], axis=1)

        def mean_length(z: float) -> float:
            return float(np.hypot(reach, offset[:, 2] + z).mean())

        low, high = -float(offset[:, 2].min()), length + float(np.abs(offset[:, 2]).max()) + 1.0
        if not mean_length(low) < length:
            return float("nan")
        for _ in range(BISECTION_STEPS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if mean_length(middle) <= length else (low, middle)
        return low

    def leg_vectors(self, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Vectors (n, 6, 3) [m], floor axes, at poses (n, 6): legs from base to platform, joints from its origin."""
        arm = self.joints @ np.swapaxes(rotation_matrices(pose[:, 3:]), 1, 2)
        leg = pose[:, None, :3] + [0.0, 0.0, self.neutral_height] + arm - self.base
        return leg, arm

    def legs(self, pose: np.ndarray) -> np.ndarray:
        """Leg lengths (n, 6) [m] of poses (n, 6): inverse kinematics, |t + R p - b|."""
        return np.sqrt((self.leg_vectors(pose)[0] ** 2).sum(axis=2))

    def jacobian(self, pose: np.ndarray) -> np.ndarray:
        """Jacobians (n, 6, 6) at poses (n, 6), from velocity and turn rate (floor axes) to leg speeds: (u, R p x u)."""
        leg, arm = self.leg_vectors(pose)
        along = leg / np.sqrt((leg**2).sum(axis=2))[:, :, None]
        return np.concatenate([along, np.cross(arm, along)], axis=2)

    def pose_jacobian(self, pose: np.ndarray) -> np.ndarray:
        """Derivatives (n, 6, 6) of leg lengths by the components of poses (n, 6)."""
        jacobian = self.jacobian(pose)
        jacobian[:, :, 3:] = jacobian[:, :, 3:] @ rates_to_turn(pose[:, 3:])
        return jacobian

    def condition(self, pose: np.ndarray) -> np.ndarray:
        """Condition numbers (n,) of the Jacobian at poses (n, 6), its turns times the mean radius of the joints."""
        values = np.linalg.svd(self.jacobian(pose) / np.repeat([1.0, self.radius], 3), compute_uv=False)
        return values[:, 0] / np.maximum(values[:, -1], 1e-300)

    def pose(self, legs: np.ndarray, guess: np.ndarray | None = None) -> np.ndarray:
        """Poses (n, 6) for leg lengths (n, 6) [m], by Newton's method from `guess` or neutral; NaN where it fails."""
        pose = np.zeros((len(legs), 6)) if guess is None else guess.copy()
        for _ in range(NEWTON_STEPS):
            miss = legs - self.legs(pose)
            far = np.abs(miss).max(axis=1) > LEG_TOLERANCE
            if not far.any():
                break
            with np.errstate(all="ignore"):
                step = np.linalg.solve(self.pose_jacobian(pose[far]), miss[far][:, :, None])[:, :, 0]
            pose[far] += np.clip(step, -0.5, 0.5)
        pose[np.abs(legs - self.legs(pose)).max(axis=1) > 1e3 * LEG_TOLERANCE] = np.nan
        return pose

    def usage(self, pose: np.ndarray) -> np.ndarray:
        """Largest fraction (n,) of the stroke, from neutral, that a leg uses in poses (n, 6); above 1 is outside."""
        return self.strokes(pose).max(axis=1)

    def strokes(self, pose: np.ndarray) -> np.ndarray:
        """Fraction (n, 6) of the stroke, from neutral outward or inward, that each leg uses in poses (n, 6)."""
        legs, neutral = self.legs(pose), self.neutral_legs
        return (legs - neutral) / np.where(legs > neutral, self.high - neutral, self.low - neutral)

    def is_allowed(self, pose: np.ndarray) -> np.ndarray:
        """True (n,) for poses (n, 6) in which all legs are within the stroke and the Jacobian is not singular."""
        within = self.usage(pose) <= 1.0
        within[within] = self.condition(pose[within]) <= self.condition_limit
        return within

    def excursions(self) -> np.ndarray:
        """Lowest and highest allowed value (6, 2) of each pose component [m, rad], the others being neutral."""
        ways = np.concatenate([-np.eye(6), np.eye(6)])  # to their lowest and highest
        most = np.where(ways[:, :3].any(axis=1), self.high, 1.5)
        steps = np.linspace(0.0, 2.0 * most, 400)
        inside = self.is_allowed((steps[:, :, None] * ways).reshape(-1, 6)).reshape(steps.shape)
        last = inside.argmin(axis=0) - 1
        low, high = np.take_along_axis(steps, np.stack([last, last + 1]), axis=0)
        for _ in range(BISECTION_STEPS):
            middle = 0.5 * (low + high)
            holds = self.is_allowed(middle[:, None] * ways)
            low, high = np.where(holds, middle, low), np.where(holds, high, middle)
        return np.stack([-low[:6], low[6:]], axis=1)


def rotation_matrices(angles: np.ndarray) -> np.ndarray:
    """Rotation matrices (n, 3, 3) Rz(yaw) Ry(pitch) Rx(roll) for angles (n, 3): roll, pitch, yaw [rad]."""
    (a, b, c), (ca, cb, cc) = np.sin(angles).T, np.cos(angles).T
    rows = [
        [cc * cb, cc * b * a - c * ca, cc * b * ca + c * a],
        [c * cb, c * b * a + cc * ca, c * b * ca - cc * a],
        [-b, cb * a, cb * ca],
    ]
    return np.array(rows).transpose(2, 0, 1)


def rates_to_turn(angles: np.ndarray) -> np.ndarray:
    """Matrices (n, 3, 3) at `angles` (n, 3) [rad]: from rates of roll, pitch, yaw to angular velocity, floor axes."""
    (_, b, c), (_, cb, cc) = np.sin(angles).T, np.cos(angles).T
    zero, one = np.zeros_like(b), np.ones_like(b)
    return np.array([[cc * cb, -c, zero], [c * cb, cc, zero], [-b, zero, one]]).transpose(2, 0, 1)


def felt_motion(pose: np.ndarray, acceleration: np.ndarray, rates: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Specific force (n, 3) [m/s2] and angular rate (n, 3) [rad/s] on the platform, in platform axes, for poses (n, 6),
    accelerations (n, 3) [m/s2] in floor axes, and `rates` of roll, pitch, yaw (n, 3) [rad/s]."""
    turn = rotation_matrices(pose[:, 3:])
    spin = (rates_to_turn(pose[:, 3:]) @ rates[:, :, None])[:, :, 0]
    return np.einsum("nji,nj->ni", turn, acceleration + [0.0, 0.0, GRAVITY]), np.einsum("nji,nj->ni", turn, spin)


def smooth_step(s: np.ndarray) -> np.ndarray:
    """Smooth step 10 s^3 - 15 s^4 + 6 s^5, from 0 at s = 0 to 1 at s = 1, with zero slope and curvature there."""
    return s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
