"""Algorithm 1: what blows across the basin comes in again at its upwind border, redrawn. Few, so NumPy."""

from collections.abc import Callable
from math import inf

import numpy as np
from numpy.typing import ArrayLike

from ocean_sim.basin import Basin
from ocean_sim.wind.shared.shapes import turned


def never(passage: int) -> tuple[float, float]:
    """No redraw: the same direction and strength in every passage."""
    return 0.0, 1.0


class Passages:
    """Centre [m], turn [rad] and strength of something that drifts; `number` counts its passages from 0.

    It begins where it was put. When its rear has left the basin, direction and strength are drawn anew, and its front
    comes in at the upwind border, on the line through the point where its first path came nearest to the centre.
    """

    def __init__(
        self,
        start: ArrayLike,
        drift: ArrayLike,
        reach: float,
        basin: Basin,
        redraw: Callable[[int], tuple[float, float]] = never,
    ) -> None:
        self.drift, self.reach, self.redraw = np.array(drift, dtype=float), reach, redraw
        self.lower, self.upper = np.array(basin.lower), np.array(basin.upper)
        if basin.dimension == 2:  # a slice of a sea without sides
            self.lower[2], self.upper[2] = -inf, inf
        self.speed = float(np.linalg.norm(self.drift))  # [m/s]
        self.number, self.turn, self.strength = 0, 0.0, 1.0
        self.origin = np.array(start, dtype=float)
        self.velocity = self.drift
        ahead = self.direction
        self.nearest = self.origin - ahead * (self.origin @ ahead)
        self.elapsed = 0.0
        self.lasts = self._duration()

    @property
    def direction(self) -> np.ndarray:
        """Unit vector along the drift; zero at rest."""
        return self.velocity / self.speed if self.speed else np.zeros(3)

    @property
    def centre(self) -> np.ndarray:
        return self.origin + self.velocity * self.elapsed

    def advance(self, dt: float) -> None:
        """Move on by dt [s]; at the border, begin the next passage."""
        self.elapsed += dt
        if self.elapsed >= self.lasts:
            self.elapsed -= self.lasts
            self.number += 1
            self.turn, self.strength = self.redraw(self.number)
            self.velocity = turned(self.drift, self.turn)
            ahead = self.direction
            back = max(0.0, self._to_border(self.nearest, -ahead) + self.reach)
            self.origin = self.nearest - back * ahead
            self.lasts = self._duration()

    def _duration(self) -> float:
        """Time until the rear leaves the basin [s]."""
        rear = self.origin - self.reach * self.direction
        return max(0.0, self._to_border(rear, self.direction) / self.speed) if self.speed else inf

    def _to_border(self, x: np.ndarray, direction: np.ndarray) -> float:
        """Distance from x along a unit vector to where it leaves the basin [m]; negative where it already has."""
        face = np.where(direction > 0.0, self.upper, self.lower)
        along = np.abs(direction) > 1e-9
        return float(((face - x)[along] / direction[along]).min())
