"""Adaptive washout: the share of an acceleration that is travelled falls where the travel runs short, and recovers.

Parrish, Dieudonne, Bowles & Martin (1975, J. Aircraft 12, 44), as in Reid and Nahon, UTIAS Report 296 (1985): along
each axis the platform follows p a - 2 zeta omega v - omega^2 s of a scaled acceleration a, and the share p goes down the
slope of a cost, half of (a - s'')^2 + W_s s^2 + W_v v^2 + W_p (p - 1)^2. So small motions pass nearly whole, at a corner
lower than a fixed filter could afford, and large ones are scaled down evenly in place of being stopped by their limits.
"""

from typing import Literal

import numpy as np

from ocean_sim.model import quantity
from ocean_sim.platform.shared.washing import NotNegative3, Positive3, Washing, WashingConfig

LEAST = 0.02  # the smallest share


class Config(WashingConfig):
    kind: Literal["adaptive"] = "adaptive"
    return_frequency: Positive3 = quantity("rad/s")
    """Corner of the return to neutral along x, y and z."""
    return_damping: float = quantity("1", 0.7, gt=0.0)
    """Its damping ratio."""
    position_weight: NotNegative3 = quantity("1/s4")
    """Cost of a displacement along x, y and z."""
    velocity_weight: NotNegative3 = quantity("1/s2")
    """Cost of a velocity along x, y and z."""
    share_weight: float = quantity("m2/s4", 0.1, ge=0.0)
    """Cost of a share that is not 1."""
    adaptation: float = quantity("s3/m2", 0.2, ge=0.0)
    """How quickly the shares go down the slope of the cost."""

    def build(self, every: float, travel: np.ndarray) -> Washing:
        """`every`: time between rows [s]; `travel` (3, 2): lowest and highest x, y, z that can be reached [m]."""
        return Washing(self, every, [AdaptiveTravel(self, axis, every) for axis in range(3)])


class AdaptiveTravel:
    """From acceleration to displacement along one axis."""

    def __init__(self, config: Config, axis: int, every: float) -> None:
        self.every, omega = every, config.return_frequency[axis]
        self.drag, self.pull = 2.0 * config.return_damping * omega, omega**2
        self.position_weight, self.velocity_weight = config.position_weight[axis], config.velocity_weight[axis]
        self.share_weight, self.adaptation = config.share_weight, config.adaptation
        self.share = 1.0
        self.place, self.speed = 0.0, 0.0  # [m], [m/s]
        self.place_slope, self.speed_slope = 0.0, 0.0  # how they change with the share

    def of(self, acceleration: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(n,) displacement [m] for (n,) scaled accelerations [m/s2]; none of them is cut."""
        dt, moved = self.every, []
        for a in acceleration.tolist():
            rate = self.share * a - self.drag * self.speed - self.pull * self.place
            rate_slope = a - self.drag * self.speed_slope - self.pull * self.place_slope
            self.speed += rate * dt
            self.speed_slope += rate_slope * dt
            self.place += self.speed * dt
            self.place_slope += self.speed_slope * dt
            slope = self.share_weight * (self.share - 1.0) - (a - rate) * rate_slope
            slope += self.position_weight * self.place * self.place_slope
            slope += self.velocity_weight * self.speed * self.speed_slope
            self.share = min(1.0, max(LEAST, self.share - self.adaptation * slope * dt))
            moved.append(self.place)
        return np.array(moved), np.zeros(len(moved), dtype=bool)
