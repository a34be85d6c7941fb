"""Limits of a hexapod: poses are scaled back into the stroke, legs are held to what they can do. Between a network and
a platform poses that it cannot have come to are refused, and whatever is asked of its legs, they keep their limits."""

from collections.abc import Callable

import numpy as np

from ocean_sim.platform import LEG_ACCELERATION, LEG_SPEED, SINGULAR, STROKE
from ocean_sim.platform.shared.kinematics import FINE, Geometry, Hexapod, rates_to_turn

KNEE = 0.75  # part of the stroke that is used as it is; the rest is approached ever more slowly
SAME = 1e-9  # [m] of a leg
MORE = 1.05  # times what was asked for, that may be felt
LATE = 0.5  # of an acceleration: what is counted on in slowing down before the end of a stroke
BRAKE = 1.5  # times what a platform catches up with: what it is braked with where it could not stop in time
OF_LEGS = 2.0  # times the acceleration of a platform: more than any leg has
ALONG = (0.5, 1.0)  # of the way to a stop, where legs are looked at
HALVED = 8  # times that a part of a change is halved
TURNS = np.repeat([0.0, 1.0], 3)
NORM = 32
EXACT = 1e-10  # part of the stroke
EVERY = 0.01  # [s] between two commands to the legs
LOOSE = 1e-3  # [m] and [m/s] of a leg: what is lost on the way through numbers
LEG_MARGIN = 1.02  # times the limits of the legs, beyond which a pose is refused
AWAY = 1.0  # [s] without a call, after which the clock of the legs starts again


def softened(usage: np.ndarray, knee: np.ndarray | float = KNEE) -> np.ndarray:
    """(n,) part of the stroke to use for (n,) that is wanted: itself up to the knee, then towards 1, without a bend."""
    room = np.maximum(1.0 - knee, EXACT)
    return np.where(usage > knee, knee + room * np.tanh((usage - knee) / room), usage)


class Workspace:
    """The poses that a hexapod may take: every leg within its stroke, no angle beyond what it could reach alone, and
    none that is singular."""

    def __init__(self, hexapod: Hexapod) -> None:
        self.hexapod = hexapod
        self.ends = hexapod.excursions()  # (6, 2) [m, rad]

    def usage(self, pose: np.ndarray) -> np.ndarray:
        """(n,) part of the stroke that is used, up to 6 % more than that of the leg nearest to its end: a norm, which
        does not bend where another leg becomes the nearest."""
        strokes = self.hexapod.strokes(pose)
        most = strokes.max(axis=1)
        return most * ((strokes / np.maximum(most, EXACT)[:, None]) ** NORM).sum(axis=1) ** (1.0 / NORM)

    def scaled_back(self, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(n, 6) poses inside, near the poses wanted; and (n,) which limits that took.

        Angles are scaled back as if there were no displacement, then the displacement by what they leave: people notice
        at once a deck that is tilted wrongly, but not one that travels less.
        """
        far = pose / np.where(pose > 0.0, self.ends[:, 1], self.ends[:, 0])
        angles = pose * TURNS * np.where(far > KNEE, softened(far) / np.maximum(far, KNEE), 1.0)
        shift = pose * (1.0 - TURNS)
        turned = self.factor(np.zeros_like(pose), angles, np.full(len(pose), KNEE))
        angles = angles * turned[:, None]
        moved = self.factor(angles, shift, np.maximum(KNEE, self.usage(angles)))
        kept = angles + shift * moved[:, None]
        limited = np.where((far[:, 3:] > KNEE).any(axis=1) | (turned < 1.0) | (moved < 1.0), STROKE, 0)
        bad = self.hexapod.condition(kept) > self.hexapod.condition_limit
        if bad.any():
            kept[bad] *= self.held(kept[bad])[:, None]
            limited[bad] |= SINGULAR
        return kept, limited

    def factor(self, fixed: np.ndarray, moving: np.ndarray, knee: np.ndarray) -> np.ndarray:
        """(n,) by which `moving`, added to `fixed`, is multiplied to use the softened part of the stroke."""
        usage, factor = self.usage(fixed + moving), np.ones(len(fixed))
        far = usage > knee
        if far.any():
            goal = softened(usage[far], knee[far])
            factor[far] = self.using(goal, fixed[far], moving[far], usage[far])
        return factor

    def using(self, goal: np.ndarray, fixed: np.ndarray, moving: np.ndarray, usage: np.ndarray) -> np.ndarray:
        """(n,) factors with which so much of the stroke is used: false position, after Illinois."""
        low, high = np.zeros(len(goal)), np.ones(len(goal))
        below, above = np.minimum(self.usage(fixed) - goal, -EXACT), usage - goal + EXACT
        guess = (low * above - high * below) / (above - below)
        for _ in range(FINE):
            miss = self.usage(fixed + guess[:, None] * moving) - goal
            off = np.abs(miss) > EXACT
            if not off.any():
                break
            over = miss > 0.0
            high, low = np.where(over, guess, high), np.where(over, low, guess)
            below, above = np.where(over, 0.5 * below, miss), np.where(over, miss, 0.5 * above)
            guess = np.where(off, (low * above - high * below) / (above - below), guess)
        return guess

    def held(self, pose: np.ndarray) -> np.ndarray:
        """(n,) by which poses are multiplied to be no worse conditioned than allowed: the first way out, halved."""
        low, high = np.zeros(len(pose)), np.ones(len(pose))
        out = np.zeros(len(pose), dtype=bool)
        for part in np.linspace(0.0, 1.0, 17)[1:]:
            fits = (self.hexapod.condition(part * pose) <= self.hexapod.condition_limit) & ~out
            low[fits], high[~fits & ~out] = part, part
            out |= ~fits
        for _ in range(FINE):
            middle = 0.5 * (low + high)
            fits = self.hexapod.condition(middle[:, None] * pose) <= self.hexapod.condition_limit
            low, high = np.where(fits, middle, low), np.where(fits, high, middle)
        return low


class Governor:
    """Poses that a machine can follow without a jerk: as long as its legs can and no more is felt than was asked for,
    they are followed exactly; else all motions are held back together, never one leg by itself, which would tilt and
    shake the platform.

    A platform that fell behind catches up with at most an acceleration that is given, of its reference point and of
    its joints as they turn. It never moves so that it could not be stopped, evenly and on a straight way, with BRAKE
    times that before a leg is at its end: what is asked for is held back before, so that nothing else has to be felt
    at the end of a stroke. Then one velocity can always be had, that of braking, and the one given is as near to what
    is wanted as can be stopped from (a reference governor: Garone, Di Cairano & Kolmanovsky 2017, Automatica 75).
    """

    def __init__(self, geometry: Geometry, hexapod: Hexapod, every: float, catch_up: float) -> None:
        """`every`: time between rows [s]; `catch_up` [m/s2]."""
        self.hexapod, self.every, self.catch_up = hexapod, every, catch_up
        self.speed, self.acceleration = geometry.leg_speed, geometry.leg_acceleration
        self.brake = min(BRAKE * catch_up, geometry.leg_acceleration / OF_LEGS)  # [m/s2]
        self.target = self.pose = np.zeros(6)  # the last one wanted, and the last one given
        self.velocity = np.zeros(6)  # [m/s], [rad/s]
        self.asked = np.zeros((2, 6))  # the last two poses that were asked for, whether they fit or not

    def follow(self, wanted: np.ndarray, asked: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(n, 6) poses for the (n, 6) wanted, which are those asked for (n, 6) as far as they fit; and (n,) which
        limits that took."""
        n, dt = len(wanted), self.every
        known, free = np.vstack([self.target, wanted]), np.vstack([self.asked, asked])
        self.asked = free[-2:]
        felt = self.sizes(np.diff(free, n=2, axis=0)) / dt**2
        steps = np.diff(known, axis=0) / dt
        moved = np.diff(self.hexapod.legs(known), axis=0) / dt
        turn = np.abs(np.diff(moved, axis=0, prepend=moved[:1])).max(axis=1, initial=0.0)
        slow = (np.abs(moved) <= self.speed).all(axis=1) & self.stops(wanted, steps)
        reach = slow & (turn <= self.acceleration * dt)
        allowed = np.maximum(self.catch_up, MORE * felt) * dt
        reach &= self.sizes(np.diff(steps, axis=0, prepend=steps[:1])) <= allowed
        given, limited = wanted.copy(), np.zeros(n, dtype=int)
        stumbles, k = np.flatnonzero(~reach).tolist(), 0
        while k < n:
            if slow[k] and self.follows(steps[k], allowed[k]):
                end = next((s for s in stumbles if s > k), n)
                self.pose, self.velocity = wanted[end - 1], steps[end - 1]
                k = end
            else:
                limited[k] = self.chase(steps[k])
                given[k] = self.pose
                k += 1
            self.target = wanted[k - 1]
        return given, limited

    def sizes(self, motion: np.ndarray) -> np.ndarray:
        """(n,) of changes of the pose (n, 6) [m]: of the reference point, or of the joints as they turn, where that is
        more."""
        along, around = np.linalg.norm(motion[:, :3], axis=1), np.linalg.norm(motion[:, 3:], axis=1)
        return np.maximum(along, self.hexapod.radius * around)

    def size(self, motion: np.ndarray) -> float:
        """Of one change (6,) [m]."""
        return float(self.sizes(motion[None])[0])

    def follows(self, step: np.ndarray, allowed: float) -> bool:
        """Whether the platform is where it should be, and its change to this velocity no more than allowed."""
        if self.size(self.pose - self.target) > SAME:
            return False
        change = step - self.velocity
        hard = float(np.abs(self.of_legs(change)).max()) > self.acceleration * self.every * (1.0 + 1e-9)
        return self.size(change) <= allowed * (1.0 + 1e-9) and not hard

    def of_legs(self, motion: np.ndarray) -> np.ndarray:
        """(6,) speeds of the legs [m/s] of a motion (6,) in the pose where it is."""
        pose = self.pose[None]
        turning = rates_to_turn(pose[:, 3:])[0] @ motion[3:]
        return self.hexapod.jacobian(pose)[0] @ np.concatenate([motion[:3], turning])

    def chase(self, step: np.ndarray) -> int:
        """One row of a platform that cannot follow, and which limits held it."""
        dt, a = self.every, self.catch_up
        behind = self.target - self.pose
        far = self.size(behind)
        aim = step + behind * (min(1.0 / dt, float(self.stopping(a, np.array(far))) / far) if far > 0.0 else 0.0)
        legs, of_aim = self.hexapod.legs(self.pose[None])[0], self.of_legs(aim)
        room = self.stopping(LATE * a, self.left(legs, of_aim))
        share = float((np.minimum(self.speed, room) / np.maximum(np.abs(of_aim), EXACT)).min())
        change = aim * min(1.0, share) - self.velocity
        hard = max(self.size(change) / a, float(np.abs(self.of_legs(change)).max()) / self.acceleration) / dt
        self.velocity = self.stoppable(self.velocity + change / max(1.0, hard))
        self.pose = self.pose + self.velocity * dt
        return (LEG_SPEED if share < 1.0 else 0) | (LEG_ACCELERATION if hard > 1.0 or share >= 1.0 else 0)

    def stoppable(self, velocity: np.ndarray) -> np.ndarray:
        """(6,) a velocity, as far as the platform can stop from it; what is left of it is braked."""
        braked = self.velocity * max(0.0, 1.0 - self.brake * self.every / max(self.size(self.velocity), EXACT))
        fits, part, step = 0.0, 1.0, 0.5
        for _ in range(HALVED):
            tried = braked + part * (velocity - braked)
            if self.stops((self.pose + tried * self.every)[None], tried[None])[0]:
                fits = part
            if fits == 1.0:
                break
            part, step = fits + step, 0.5 * step
        return braked + fits * (velocity - braked)

    def stops(self, pose: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """(n,) whether a platform in (n, 6) poses with (n, 6) velocities [m/s], [rad/s] can be stopped with all legs
        within their strokes."""
        way = velocity * (0.5 * self.sizes(velocity) / self.brake)[:, None]
        legs = np.hstack([self.hexapod.legs(pose + part * way) for part in ALONG])
        within = (legs >= self.hexapod.low) & (legs <= self.hexapod.high)
        return np.asarray(within.all(axis=1))

    def stopping(self, acceleration: float, left: np.ndarray) -> np.ndarray:
        """Speed [m/s] from which something stops in whole rows on its way that is left [m]."""
        lost = 0.5 * acceleration * self.every
        return np.sqrt(lost**2 + 2.0 * acceleration * np.maximum(left, 0.0)) - lost

    def left(self, legs: np.ndarray, speed: np.ndarray) -> np.ndarray:
        """(6,) what is left of the stroke of each leg [m] in the direction of its speed."""
        return np.where(speed > 0.0, self.hexapod.high - legs, legs - self.hexapod.low)


class Legs:
    """Six legs that follow lengths as fast as they can: speed and acceleration never exceed their limits.

    A leg that fell behind catches up at a speed from which it can still stop in time, then follows exactly again.
    """

    def __init__(
        self, geometry: Geometry, every: float, length: np.ndarray, velocity: np.ndarray | None = None
    ) -> None:
        """`every`: time between rows [s]; (6,) length [m] and velocity [m/s] at first, by default at rest."""
        self.speed, self.acceleration, self.every = geometry.leg_speed, geometry.leg_acceleration, every
        self.target, self.length = length, length
        self.velocity = np.zeros(6) if velocity is None else velocity

    def follow(self, targets: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(n, 6) lengths and (n, 6) speeds for the (n, 6) lengths wanted, and (n,) which limits that took."""
        n, dt = len(targets), self.every
        wanted = np.diff(targets, axis=0, prepend=self.target[None]) / dt
        turn = np.abs(np.diff(wanted, axis=0, prepend=wanted[:1])).max(axis=1, initial=0.0)
        reach = (np.abs(wanted).max(axis=1) <= self.speed) & (turn <= self.acceleration * dt)
        length, velocity, limited = targets.copy(), wanted.copy(), np.zeros(n, dtype=int)
        stumbles, k = np.flatnonzero(~reach).tolist(), 0
        while k < n:
            if self.follows(wanted[k]):  # then exactly, until the next stumble
                end = next((s for s in stumbles if s > k), n)
                self.length, self.velocity = targets[end - 1], wanted[end - 1]
                k = end
            else:
                limited[k] = self.chase(targets[k], wanted[k])
                length[k], velocity[k] = self.length, self.velocity
                k += 1
            self.target = targets[k - 1]
        return length, velocity, limited

    def follows(self, wanted: np.ndarray) -> bool:
        """Whether the legs are where they should be and can take this speed."""
        there = float(np.abs(self.length - self.target).max()) < SAME
        fast = float(np.abs(wanted).max()) > self.speed
        hard = float(np.abs(wanted - self.velocity).max()) > self.acceleration * self.every * (1.0 + 1e-9)
        return there and not fast and not hard

    def chase(self, target: np.ndarray, wanted: np.ndarray) -> int:
        """One row of a leg that cannot follow, and which limits held it."""
        dt, a = self.every, self.acceleration
        behind = self.target - self.length
        brake = np.sqrt((0.5 * a * dt) ** 2 + 2.0 * a * np.abs(behind)) - 0.5 * a * dt  # stops in whole rows
        aim = wanted + np.sign(behind) * np.minimum(np.abs(behind) / dt, brake)
        speed = np.clip(aim, -self.speed, self.speed)
        new = np.clip(speed, self.velocity - a * dt, self.velocity + a * dt)
        held = (LEG_SPEED if (speed != aim).any() else 0) | (LEG_ACCELERATION if (new != speed).any() else 0)
        self.length, self.velocity = self.length + new * dt, new
        return held or LEG_ACCELERATION


class Judge:
    """Whether the poses of a stream are such as its platform can take, one after the other."""

    def __init__(self, geometry: Geometry, hexapod: Hexapod, hold: float) -> None:
        """`hold`: how much later than sent a packet may come [s], compared with the one before."""
        self.geometry, self.hexapod, self.hold = geometry, hexapod, hold
        self.legs = hexapod.neutral_legs  # (6,) [m] of the last pose, and
        self.velocity: np.ndarray | None = None  # (6,) [m/s]
        self.time, self.came = 0.0, -np.inf  # of it, by its own clock and by ours [s]
        self.interval = 0.0  # between it and the one before [s]

    @np.errstate(all="ignore")
    def passes(self, pose: np.ndarray, time: float, now: float, anew: bool) -> bool:
        """Of a (6,) pose of a time [s] that came at `now` [s]; `anew`: after a silence, whatever was before."""
        legs, velocity, geometry = self.hexapod.legs(pose[None])[0], None, self.geometry
        if not ((legs > self.hexapod.low - LOOSE) & (legs < self.hexapod.high + LOOSE)).all():
            return False
        interval = time - self.time
        if not anew:
            if not 0.0 <= interval <= now - self.came + self.hold:
                return False
            moved = np.abs(legs - self.legs).max()
            if moved > LEG_MARGIN * geometry.leg_speed * interval + LOOSE:
                return False
            if interval > 0.0:
                velocity = (legs - self.legs) / interval
                if self.velocity is not None:
                    turned = np.abs(velocity - self.velocity).max() - LOOSE / interval
                    if turned > LEG_MARGIN * geometry.leg_acceleration * 0.5 * (interval + self.interval) + LOOSE:
                        return False
                self.interval = interval
        self.legs, self.velocity, self.time, self.came = legs, velocity, time, now
        return True


class Drive:
    """Six legs that follow a pose over time, row by row, and never exceed stroke, speed or acceleration."""

    def __init__(self, geometry: Geometry, hexapod: Hexapod) -> None:
        self.hexapod, self.legs = hexapod, Legs(geometry, EVERY, hexapod.neutral_legs)
        self.now = -np.inf  # [s] of the last row

    def advance(self, pose: Callable[[float], np.ndarray], now: float) -> tuple[np.ndarray, np.ndarray]:
        """(n, 6) lengths [m] and (n, 6) speeds [m/s] of the rows that are due until `now` [s]."""
        if now - self.now > AWAY:
            self.now = now - EVERY
        count = int((now - self.now) / EVERY + 1e-6)
        if count == 0:
            return np.zeros((0, 6)), np.zeros((0, 6))
        times = self.now + EVERY * np.arange(1, count + 1)
        wanted = self.hexapod.legs(np.array([pose(time) for time in times]))
        lengths, speeds, _ = self.legs.follow(np.clip(wanted, self.hexapod.low, self.hexapod.high))
        self.now = float(times[-1])
        return lengths, speeds
