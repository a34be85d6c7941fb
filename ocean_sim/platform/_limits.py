"""What keeps a hexapod inside its limits: poses are scaled back into the stroke, legs are held to what they can do."""

import numpy as np

from ocean_sim.platform import LEG_ACCELERATION, LEG_SPEED, SINGULAR, STROKE
from ocean_sim.platform._hexapod import FINE, Geometry, Hexapod

KNEE = 0.95  # part of the stroke that is used as it is; the rest is approached ever more slowly
SAME = 1e-9  # [m] of a leg
EXACT = 1e-12  # part of the stroke


def softened(usage: np.ndarray) -> np.ndarray:
    """(n,) part of the stroke to use for (n,) that is wanted: itself up to the knee, then towards 1, without a bend."""
    return np.where(usage > KNEE, KNEE + (1.0 - KNEE) * np.tanh((usage - KNEE) / (1.0 - KNEE)), usage)


class Workspace:
    """The poses that a hexapod may take: every leg within its stroke, no motion beyond what it could reach alone, and
    none that is singular."""

    def __init__(self, hexapod: Hexapod) -> None:
        self.hexapod = hexapod
        self.ends = hexapod.excursions()  # (6, 2) [m, rad]

    def usage(self, pose: np.ndarray) -> np.ndarray:
        """(n,) part of the way to the edge of the workspace, of a leg or of a motion; above 1 is outside."""
        alone = pose / np.where(pose > 0.0, self.ends[:, 1], self.ends[:, 0])
        return np.maximum(self.hexapod.usage(pose), alone.max(axis=1))

    def scaled_back(self, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(n, 6) poses inside, on the way from neutral to the poses wanted; and (n,) which limits that took."""
        limited = np.zeros(len(pose), dtype=int)
        kept = pose.copy()
        usage = self.usage(pose)
        far = usage > KNEE
        if far.any():
            kept[far] *= self.factor(pose[far], usage[far], softened(usage[far]))[:, None]
            limited[far] |= STROKE
        bad = self.hexapod.condition(kept) > self.hexapod.condition_limit
        if bad.any():
            kept[bad] *= self.held(kept[bad])[:, None]
            limited[bad] |= SINGULAR
        return kept, limited

    def factor(self, pose: np.ndarray, usage: np.ndarray, goal: np.ndarray) -> np.ndarray:
        """(n,) by which poses are multiplied to use as much as the goal: false position, after Illinois."""
        low, high = np.zeros(len(pose)), np.ones(len(pose))
        below, above = -goal, usage - goal
        guess = goal / usage
        for _ in range(FINE):
            miss = self.usage(guess[:, None] * pose) - goal
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


class Legs:
    """Six legs that follow lengths as fast as they can: speed and acceleration never exceed their limits.

    A leg that fell behind catches up at a speed from which it can still stop in time, then follows exactly again.
    """

    def __init__(self, geometry: Geometry, every: float, neutral: np.ndarray) -> None:
        self.speed, self.acceleration, self.every = geometry.leg_speed, geometry.leg_acceleration, every
        self.target, self.length, self.velocity = neutral, neutral, np.zeros(6)

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
