"""Classical washout: filters remove motions beyond the travel; tilt lets gravity stand in for lasting accelerations.

Reid and Nahon, UTIAS Report 296 (1985). Each high-pass of an acceleration and its integrations are one stable filter,
so no integrator can wind up.
"""

from collections.abc import Sequence
from math import inf
from typing import Literal

import numpy as np

from ocean_sim.model import NotNegative3, Positive3, quantity
from ocean_sim.platform.shared.kinematics import Geometry
from ocean_sim.platform.shared.washing import Filter, Washing, WashingConfig, second_order


class Config(WashingConfig):
    """Classical washout: filters remove motions beyond the travel, and tilt lets gravity stand in for lasting
    accelerations."""

    kind: Literal["classical"] = "classical"
    translation_frequency: Positive3 = quantity("rad/s")
    """Corner frequency of the second-order high-pass along x, y and z."""
    translation_damping: float = quantity("1", 1.0, gt=0.0)
    """Its damping ratio."""
    translation_return: NotNegative3 = quantity("rad/s")
    """Corner frequency of one more high-pass, which brings the platform back to neutral; 0 is none."""

    def build(self, every: float, geometry: Geometry, travel: np.ndarray) -> Washing:
        back, frequency, damping = self.translation_return, self.translation_frequency, self.translation_damping
        travels = [Travel(frequency[k], damping, back[k], every, tuple(travel[k])) for k in range(3)]
        return Washing(self, every, travels)


class Travel:
    """High-pass filter from acceleration to displacement [m] along one axis, for rows `every` [s]."""

    def __init__(
        self, frequency: float, damping: float, back: float, every: float, ends: Sequence[float] = (-inf, inf)
    ) -> None:
        """`frequency` [rad/s], `damping` ratio: of a second-order high-pass; `back`: corner [rad/s] of another,
        first-order one, or 0 for none; `every`: time between rows [s]; `ends`: lowest and highest displacement [m]."""
        poles, zeros = second_order(frequency, damping), []
        if back > 0.0:  # s^3 / ((s^2 + 2 zeta omega s + omega^2) (s + omega_b)), integrated twice
            poles, zeros = [*poles, complex(-back)], [0.0]
        self.filter = Filter(zeros, poles, 1.0, every)
        self.low, self.high = ends

    def displace(self, acceleration: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Displacements (n,) [m] for accelerations (n,) [m/s2], and (n,) True where an acceleration was set to 0:
        beyond an end of the travel, if directed further outward, so that the platform returns at once."""
        moved, cut, start = np.empty(len(acceleration)), np.zeros(len(acceleration), dtype=bool), 0
        while start < len(acceleration):
            state = self.filter.state
            moved[start:] = self.filter.apply(acceleration[start:])
            place, push = moved[start:], acceleration[start:]
            out = np.flatnonzero(((place > self.high) & (push > 0.0)) | ((place < self.low) & (push < 0.0)))
            if not len(out):
                break
            end = start + int(out[0])
            self.filter.state = state
            if end > start:
                self.filter.apply(acceleration[start:end])
            moved[end] = self.filter.apply(np.zeros(1))[0]
            cut[end] = True
            start = end + 1
        return moved, cut
