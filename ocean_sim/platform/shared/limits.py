"""Limits of a hexapod: poses are scaled back into the stroke, legs are held to their speed and acceleration."""

import numpy as np

from ocean_sim.platform import LEG_ACCELERATION_LIMIT, LEG_SPEED_LIMIT, SINGULARITY_LIMIT, STROKE_LIMIT
from ocean_sim.platform.shared.kinematics import BISECTION_STEPS, Geometry, Hexapod, rates_to_turn

KNEE_USAGE = 0.75  # part of the stroke that is used as it is; the rest is approached ever more slowly
LEG_MATCH = 1e-9  # [m] between legs that count as equal
FELT_MARGIN = 1.05  # highest felt acceleration, over the requested one
BRAKE_RESERVE = 0.5  # planned share of the acceleration in slowing down before the end of a stroke
BRAKE_FACTOR = 1.5  # braking that could not be planned, over the acceleration of catching up
LEG_ACCELERATION_RATIO = 2.0  # acceleration of a platform over that of any leg, at most
STOP_WAY_SHARES = (0.5, 1.0)  # of the way to a stop, at which legs are checked
VELOCITY_BISECTIONS = 8
TURN_MASK = np.repeat([0.0, 1.0], 3)
USAGE_NORM = 32
USAGE_TOLERANCE = 1e-10  # part of the stroke


def soften_usage(usage: np.ndarray, knee: np.ndarray | float = KNEE_USAGE) -> np.ndarray:
    """Fractions (n,) of the stroke: the wanted `usage` (n,) up to `knee`, above it compressed (tanh) to less than 1."""
    room = np.maximum(1.0 - knee, USAGE_TOLERANCE)
    return np.where(usage > knee, knee + room * np.tanh((usage - knee) / room), usage)


class Workspace:
    """Set of allowed poses of a hexapod: legs within the stroke, angles each within its own range, not singular."""

    def __init__(self, hexapod: Hexapod) -> None:
        self.hexapod = hexapod
        self.ends = hexapod.excursions()  # (6, 2) [m, rad]

    def usage(self, pose: np.ndarray) -> np.ndarray:
        """Fraction (n,) of the stroke that poses (n, 6) use: a smooth maximum over the legs, their 32-norm, which
        exceeds that of the most extended leg by up to 6 %."""
        strokes = self.hexapod.strokes(pose)
        most = strokes.max(axis=1)
        whole = ((strokes / np.maximum(most, USAGE_TOLERANCE)[:, None]) ** USAGE_NORM).sum(axis=1)
        return most * whole ** (1.0 / USAGE_NORM)

    def scale_back(self, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Poses (n, 6) in the workspace, scaled back from wanted ones, and bits (n,), as STROKE_LIMIT, of limits met.

        Angles are scaled back first, as if there were no displacement; then the displacement, to fit the rest of the
        stroke. People notice at once a deck that is tilted wrongly, but not one that travels less."""
        far = pose / np.where(pose > 0.0, self.ends[:, 1], self.ends[:, 0])
        angles = pose * TURN_MASK * np.where(far > KNEE_USAGE, soften_usage(far) / np.maximum(far, KNEE_USAGE), 1.0)
        shift = pose * (1.0 - TURN_MASK)
        turned = self.scale_factor(np.zeros_like(pose), angles, np.full(len(pose), KNEE_USAGE))
        angles = angles * turned[:, None]
        moved = self.scale_factor(angles, shift, np.maximum(KNEE_USAGE, self.usage(angles)))
        kept = angles + shift * moved[:, None]
        limited = np.where((far[:, 3:] > KNEE_USAGE).any(axis=1) | (turned < 1.0) | (moved < 1.0), STROKE_LIMIT, 0)
        bad = self.hexapod.condition(kept) > self.hexapod.condition_limit
        if bad.any():
            kept[bad] *= self.condition_factor(kept[bad])[:, None]
            limited[bad] |= SINGULARITY_LIMIT
        return kept, limited

    def scale_factor(self, fixed: np.ndarray, moving: np.ndarray, knee: np.ndarray) -> np.ndarray:
        """Factors f (n,) for poses `fixed` + f `moving` (n, 6): 1 where these use at most the fraction `knee` (n,) of
        the stroke, else lower, for the fraction that `soften_usage` makes of the wanted one."""
        usage, factor = self.usage(fixed + moving), np.ones(len(fixed))
        far = usage > knee
        if far.any():
            goal = soften_usage(usage[far], knee[far])
            factor[far] = self.usage_factor(goal, fixed[far], moving[far], usage[far])
        return factor

    def usage_factor(self, goal: np.ndarray, fixed: np.ndarray, moving: np.ndarray, usage: np.ndarray) -> np.ndarray:
        """Factors (n,) f by which poses `fixed` + f `moving` (n, 6) use the fraction `goal` (n,) of the stroke. By
        false position (Illinois) from f = 1, where they use `usage` (n,)."""
        low, high = np.zeros(len(goal)), np.ones(len(goal))
        below, above = np.minimum(self.usage(fixed) - goal, -USAGE_TOLERANCE), usage - goal + USAGE_TOLERANCE
        guess = (low * above - high * below) / (above - below)
        for _ in range(BISECTION_STEPS):
            miss = self.usage(fixed + guess[:, None] * moving) - goal
            off = np.abs(miss) > USAGE_TOLERANCE
            if not off.any():
                break
            over = miss > 0.0
            high, low = np.where(over, guess, high), np.where(over, low, guess)
            below, above = np.where(over, 0.5 * below, miss), np.where(over, miss, 0.5 * above)
            guess = np.where(off, (low * above - high * below) / (above - below), guess)
        return guess

    def condition_factor(self, pose: np.ndarray) -> np.ndarray:
        """Factors (n,) on poses (n, 6), just below the smallest at which the leg Jacobian is ill-conditioned."""
        low, high = np.zeros(len(pose)), np.ones(len(pose))
        out = np.zeros(len(pose), dtype=bool)
        for part in np.linspace(0.0, 1.0, 17)[1:]:
            fits = (self.hexapod.condition(part * pose) <= self.hexapod.condition_limit) & ~out
            low[fits], high[~fits & ~out] = part, part
            out |= ~fits
        for _ in range(BISECTION_STEPS):
            middle = 0.5 * (low + high)
            fits = self.hexapod.condition(middle[:, None] * pose) <= self.hexapod.condition_limit
            low, high = np.where(fits, middle, low), np.where(fits, high, middle)
        return low


class Governor:
    """Limiter that turns wanted poses into poses that a machine can follow without a jerk.

    Wanted poses are followed exactly within limits of the legs and of the felt acceleration; else all motions are held
    back together, never one leg by itself, which would tilt and shake the platform.

    A platform that fell behind catches up with at most the acceleration `catch_up`, of its reference point and of its
    joints as they turn. Its velocity always allows a stop along a straight path, braking with BRAKE_FACTOR times that,
    before a leg reaches its end. Braking is thus always possible, and the commanded velocity is the one nearest to the
    wanted one that still allows a stop (reference governor: Garone, Di Cairano & Kolmanovsky 2017, Automatica 75).
    """

    def __init__(self, geometry: Geometry, hexapod: Hexapod, every: float, catch_up: float) -> None:
        """`every`: time [s] between rows (commands); `catch_up`: acceleration [m/s2] of a platform that fell behind."""
        self.hexapod, self.every, self.catch_up = hexapod, every, catch_up
        self.speed, self.acceleration = geometry.leg_speed, geometry.leg_acceleration
        self.brake = min(BRAKE_FACTOR * catch_up, geometry.leg_acceleration / LEG_ACCELERATION_RATIO)  # [m/s2]
        self.target = self.pose = np.zeros(6)  # the last wanted and the last given pose
        self.velocity = np.zeros(6)  # [m/s], [rad/s]
        self.asked = np.zeros((2, 6))  # the last two requested poses

    def follow(self, wanted: np.ndarray, asked: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Poses (n, 6) that the machine can follow, and bits (n,), as LEG_SPEED_LIMIT, of limits that acted. `wanted`
        (n, 6): poses in the workspace; `asked` (n, 6): the washout's own, whose accelerations are always allowed."""
        n, dt = len(wanted), self.every
        known, free = np.vstack([self.target, wanted]), np.vstack([self.asked, asked])
        self.asked = free[-2:]
        felt = self.motion_sizes(np.diff(free, n=2, axis=0)) / dt**2
        steps = np.diff(known, axis=0) / dt
        moved = np.diff(self.hexapod.legs(known), axis=0) / dt
        turn = np.abs(np.diff(moved, axis=0, prepend=moved[:1])).max(axis=1, initial=0.0)
        slow = (np.abs(moved) <= self.speed).all(axis=1) & self.can_stop(wanted, steps)
        reach = slow & (turn <= self.acceleration * dt)
        allowed = np.maximum(self.catch_up, FELT_MARGIN * felt) * dt
        reach &= self.motion_sizes(np.diff(steps, axis=0, prepend=steps[:1])) <= allowed
        given, limited = wanted.copy(), np.zeros(n, dtype=int)
        stumbles, k = np.flatnonzero(~reach).tolist(), 0
        while k < n:
            if slow[k] and self.can_follow(steps[k], allowed[k]):
                end = next((s for s in stumbles if s > k), n)
                self.pose, self.velocity = wanted[end - 1], steps[end - 1]
                k = end
            else:
                limited[k] = self.chase_step(steps[k])
                given[k] = self.pose
                k += 1
            self.target = wanted[k - 1]
        return given, limited

    def begin(self, past: np.ndarray, target: np.ndarray) -> None:
        """Take over a platform after poses `past` (2, 6), which from now on is to go to `target` (6,)."""
        self.pose, self.velocity = past[1], (past[1] - past[0]) / self.every
        self.target, self.asked = target, np.stack([target, target])

    @property
    def is_there(self) -> bool:
        """True if the last pose given is the one that was wanted."""
        return self.motion_size(self.pose - self.target) <= LEG_MATCH

    def motion_sizes(self, motion: np.ndarray) -> np.ndarray:
        """Sizes (n,) of pose changes `motion` (n, 6) [m], or of their rates: shift of the reference point or, if
        larger, of joints in the turn."""
        along, around = np.linalg.norm(motion[:, :3], axis=1), np.linalg.norm(motion[:, 3:], axis=1)
        return np.maximum(along, self.hexapod.radius * around)

    def motion_size(self, motion: np.ndarray) -> float:
        return float(self.motion_sizes(motion[None])[0])

    def can_follow(self, step: np.ndarray, allowed: float) -> bool:
        """True if the platform is at its target, and its legs can change to the pose velocity `step` (6,) [m/s, rad/s]
        in one time step (row), with a change of at most `allowed` [m/s]."""
        if not self.is_there:
            return False
        change = step - self.velocity
        hard = float(np.abs(self.leg_speeds(change)).max()) > self.acceleration * self.every * (1.0 + 1e-9)
        return self.motion_size(change) <= allowed * (1.0 + 1e-9) and not hard

    def leg_speeds(self, motion: np.ndarray) -> np.ndarray:
        """Leg speeds (6,) [m/s] in the present pose at pose velocity `motion` (6,), of x, y, z, roll, pitch, yaw."""
        pose = self.pose[None]
        turning = rates_to_turn(pose[:, 3:])[0] @ motion[3:]
        return self.hexapod.jacobian(pose)[0] @ np.concatenate([motion[:3], turning])

    def chase_step(self, step: np.ndarray) -> int:
        """Move a lagging platform through one time step (row) towards its target, which moves at a velocity `step` (6,)
        [m/s, rad/s]; return the bits, as LEG_SPEED_LIMIT, of limits that acted."""
        dt, a = self.every, self.catch_up
        behind = self.target - self.pose
        far = self.motion_size(behind)
        aim = step + behind * (min(1.0 / dt, float(self.stopping_speed(a, np.array(far))) / far) if far > 0.0 else 0.0)
        legs, of_aim = self.hexapod.legs(self.pose[None])[0], self.leg_speeds(aim)
        stroke_left = np.where(of_aim > 0.0, self.hexapod.high - legs, legs - self.hexapod.low)  # up to the end ahead
        room = self.stopping_speed(BRAKE_RESERVE * a, stroke_left)
        share = float((np.minimum(self.speed, room) / np.maximum(np.abs(of_aim), USAGE_TOLERANCE)).min())
        change = aim * min(1.0, share) - self.velocity
        hard = max(self.motion_size(change) / a, float(np.abs(self.leg_speeds(change)).max()) / self.acceleration) / dt
        self.velocity = self.stoppable_velocity(self.velocity + change / max(1.0, hard))
        self.pose = self.pose + self.velocity * dt
        return (LEG_SPEED_LIMIT if share < 1.0 else 0) | (LEG_ACCELERATION_LIMIT if hard > 1.0 or share >= 1.0 else 0)

    def stoppable_velocity(self, velocity: np.ndarray) -> np.ndarray:
        """Pose velocity (6,) [m/s, rad/s] for the next time step (row) from which a stop within the strokes is
        possible: as near to `velocity` as that allows, else that of braking as hard as `brake`."""
        size = max(self.motion_size(self.velocity), USAGE_TOLERANCE)
        braked = self.velocity * max(0.0, 1.0 - self.brake * self.every / size)
        fits, part, step = 0.0, 1.0, 0.5
        for _ in range(VELOCITY_BISECTIONS):
            tried = braked + part * (velocity - braked)
            if self.can_stop((self.pose + tried * self.every)[None], tried[None])[0]:
                fits = part
            if fits == 1.0:
                break
            part, step = fits + step, 0.5 * step
        return braked + fits * (velocity - braked)

    def can_stop(self, pose: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """True (n,) if the platform in poses (n, 6) can stop from velocities (n, 6) [m/s, rad/s] within all strokes."""
        way = velocity * (0.5 * self.motion_sizes(velocity) / self.brake)[:, None]
        legs = np.hstack([self.hexapod.legs(pose + part * way) for part in STOP_WAY_SHARES])
        within = (legs >= self.hexapod.low) & (legs <= self.hexapod.high)
        return np.asarray(within.all(axis=1))

    def stopping_speed(self, acceleration: float, left: np.ndarray) -> np.ndarray:
        """Highest speed [m/s] from which braking at `acceleration` [m/s2] in steps `every` ends within `left` [m]."""
        lost = 0.5 * acceleration * self.every
        return np.sqrt(lost**2 + 2.0 * acceleration * np.maximum(left, 0.0)) - lost


class Legs:
    """Six legs that follow wanted lengths as fast as their limits of speed and acceleration allow.

    A leg that fell behind catches up at a speed from which it can still stop in time, then follows exactly again.
    """

    def __init__(
        self, geometry: Geometry, every: float, length: np.ndarray, velocity: np.ndarray | None = None
    ) -> None:
        """`every`: time of a row (command) [s]; `length` (6,) [m], `velocity` (6,) [m/s], default 0: at the start."""
        self.speed, self.acceleration, self.every = geometry.leg_speed, geometry.leg_acceleration, every
        self.target, self.length = length, length
        self.velocity = np.zeros(6) if velocity is None else velocity

    def follow(self, targets: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Lengths (n, 6) [m], speeds (n, 6) [m/s], bits (n,) of limits (LIMIT_TEXTS) met; `targets`: wanted lengths."""
        n, dt = len(targets), self.every
        wanted = np.diff(targets, axis=0, prepend=self.target[None]) / dt
        turn = np.abs(np.diff(wanted, axis=0, prepend=wanted[:1])).max(axis=1, initial=0.0)
        reach = (np.abs(wanted).max(axis=1) <= self.speed) & (turn <= self.acceleration * dt)
        length, velocity, limited = targets.copy(), wanted.copy(), np.zeros(n, dtype=int)
        stumbles, k = np.flatnonzero(~reach).tolist(), 0
        while k < n:
            if self.can_follow(wanted[k]):  # then exactly, until the next stumble
                end = next((s for s in stumbles if s > k), n)
                self.length, self.velocity = targets[end - 1], wanted[end - 1]
                k = end
            else:
                limited[k] = self.chase_step(targets[k], wanted[k])
                length[k], velocity[k] = self.length, self.velocity
                k += 1
            self.target = targets[k - 1]
        return length, velocity, limited

    def can_follow(self, wanted: np.ndarray) -> bool:
        """True if the legs are at their targets and can change to speeds `wanted` (6,) [m/s] in one time step (row)."""
        there = float(np.abs(self.length - self.target).max()) < LEG_MATCH
        fast = float(np.abs(wanted).max()) > self.speed
        hard = float(np.abs(wanted - self.velocity).max()) > self.acceleration * self.every * (1.0 + 1e-9)
        return there and not fast and not hard

    def chase_step(self, target: np.ndarray, wanted: np.ndarray) -> int:
        """Move lagging legs through one time step (row) towards lengths `target` (6,) [m], which change at speeds
        `wanted` (6,) [m/s]; return the bits, as LEG_SPEED_LIMIT, of limits that acted."""
        dt, a = self.every, self.acceleration
        behind = self.target - self.length
        brake = np.sqrt((0.5 * a * dt) ** 2 + 2.0 * a * np.abs(behind)) - 0.5 * a * dt  # stops in whole rows
        aim = wanted + np.sign(behind) * np.minimum(np.abs(behind) / dt, brake)
        speed = np.clip(aim, -self.speed, self.speed)
        new = np.clip(speed, self.velocity - a * dt, self.velocity + a * dt)
        held = int(LEG_SPEED_LIMIT * (speed != aim).any() | LEG_ACCELERATION_LIMIT * (new != speed).any())
        self.length, self.velocity = self.length + new * dt, new
        return held or LEG_ACCELERATION_LIMIT
