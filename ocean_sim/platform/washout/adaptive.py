"""Adaptive washout: the share of an acceleration that the platform follows falls where travel runs short, and recovers.

After Parrish, Dieudonne, Bowles & Martin (1975, J. Aircraft 12, 44), as in Reid and Nahon, UTIAS Report 296 (1985):
along each axis the platform's position s follows s'' = p a - 2 zeta omega s' - omega^2 s for a scaled acceleration a,
and the share p keeps a cost low, (a - s'')^2 + W_s s^2 + W_v s'^2 + W_p (p - 1)^2. They descend its gradient. Here p
minimises the recent mean of the cost in closed form, as s is proportional to a share that changes slowly. Waves are not
distorted: small motions pass nearly whole, and large ones are scaled down evenly instead of being stopped.
"""

from typing import Literal

import numpy as np

from ocean_sim.model import NotNegative3, Positive3, quantity
from ocean_sim.platform.shared.kinematics import Geometry
from ocean_sim.platform.shared.washing import Washing, WashingConfig


class Config(WashingConfig):
    """Adaptive washout: the share of an acceleration that the platform travels falls where its travel runs short."""

    kind: Literal["adaptive"] = "adaptive"
    return_frequency: Positive3 = quantity("rad/s")
    """Corner frequency of the return to neutral along x, y and z."""
    return_damping: float = quantity("1", 0.7, gt=0.0)
    """Its damping ratio."""
    position_weight: NotNegative3 = quantity("1/s4")
    """Cost of a displacement along x, y and z."""
    velocity_weight: NotNegative3 = quantity("1/s2")
    """Cost of a velocity along x, y and z."""
    share_weight: float = quantity("m2/s4", 0.1, gt=0.0)
    """Cost of a share that is not 1: accelerations whose square is well below it pass in full."""
    memory: float = quantity("s", 10.0, gt=0.0)
    """Time over which the cost is averaged; it must be longer than the waves, or it distorts them."""

    def build(self, every: float, geometry: Geometry, travel: np.ndarray) -> Washing:
        return Washing(self, every, [AdaptiveTravel(self, axis, every) for axis in range(3)])


class AdaptiveTravel:
    """Adaptive filter from acceleration to displacement along one axis (0: x, 1: y, 2: z), for rows `every` [s]."""

    def __init__(self, config: Config, axis: int, every: float) -> None:
        self.every, omega = every, config.return_frequency[axis]
        self.drag, self.pull = 2.0 * config.return_damping * omega, omega**2
        self.position_weight, self.velocity_weight = config.position_weight[axis], config.velocity_weight[axis]
        self.share_weight, self.forgotten = config.share_weight, every / config.memory
        self.share = 1.0
        self.place, self.speed = 0.0, 0.0  # [m], [m/s]
        self.whole_place, self.whole_speed = 0.0, 0.0  # of a platform that travelled all of it
        self.wanted, self.dear = 0.0, 0.0  # means of late: of a s'', and of s''^2 + W_s s^2 + W_v v^2 with share 1

    def displace(self, acceleration: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        dt, moved = self.every, []
        for a in acceleration.tolist():
            whole = a - self.drag * self.whole_speed - self.pull * self.whole_place
            self.whole_speed += whole * dt
            self.whole_place += self.whole_speed * dt
            cost = whole**2 + self.position_weight * self.whole_place**2 + self.velocity_weight * self.whole_speed**2
            self.wanted += (a * whole - self.wanted) * self.forgotten
            self.dear += (cost - self.dear) * self.forgotten
            best = (self.share_weight + self.wanted) / (self.share_weight + self.dear)
            self.share = min(1.0, max(0.0, best))
            self.speed += (self.share * a - self.drag * self.speed - self.pull * self.place) * dt
            self.place += self.speed * dt
            moved.append(self.place)
        return np.array(moved), np.zeros(len(moved), dtype=bool)
