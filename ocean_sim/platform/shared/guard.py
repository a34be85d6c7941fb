"""What stands between a network and a platform: poses that it cannot have come to are refused, and whatever is asked of
its legs, they keep their limits."""

from collections.abc import Callable

import numpy as np

from ocean_sim.platform.shared.kinematics import Geometry, Hexapod
from ocean_sim.platform.shared.limits import Legs

EVERY = 0.01  # [s] between two commands to the legs
LOOSE = 1e-3  # [m] and [m/s] of a leg: what is lost on the way through numbers
MORE = 1.02  # times the limits of the legs
AWAY = 1.0  # [s] without a call, after which the clock of the legs starts again


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
            if moved > MORE * geometry.leg_speed * interval + LOOSE:
                return False
            if interval > 0.0:
                velocity = (legs - self.legs) / interval
                if self.velocity is not None:
                    turned = np.abs(velocity - self.velocity).max() - LOOSE / interval
                    if turned > MORE * geometry.leg_acceleration * 0.5 * (interval + self.interval) + LOOSE:
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
