"""Place of a wind: its path across the basin (Algorithm 1), and its frame over a patch of open sea.

Particles have a position on the patch, which repeats itself, and ships one in the world. A wind sees both around the
middle of the patch, which follows the ships.
"""

from collections.abc import Callable
from math import inf
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from ocean_sim.basin import Basin
from ocean_sim.kernel_library import ti
from ocean_sim.model import Model
from ocean_sim.parts import Preflight, Problems
from ocean_sim.runtime import in_kernels
from ocean_sim.wind import DeviceRow
from ocean_sim.wind.shared.shapes import turned


class Placed(Model):
    """Key of a wind that has a place: the frame in which it stands or drifts."""

    frame: Literal["tile", "world"] | None = None
    """Over a patch of open sea: `tile`, it travels with the patch, so its places are seen from the ship and it comes in
    again at the border of the patch; `world`, it stands and drifts in the world, and the ship may leave it behind.
    null: tile."""

    def misframed(self, preflight: Preflight) -> Problems:
        """Fault of a `frame` that is given over a basin other than a patch of open sea; empty without fault."""
        if self.frame is None or preflight.tank.sea is not None:
            return []
        return [(("frame",), "a wind has a frame only over a patch of open sea; leave it out, or name a sea")]


@in_kernels
class Patch:
    """Coordinates of a wind over a patch of open sea. Over any other basin the wind's axes are those of the world."""

    def __init__(self, config: Placed, basin: Basin) -> None:
        periods = (basin.periods[0], basin.periods[2]) if basin.sea is not None else (0.0, 0.0)
        self.axes = tuple((axis, 2 * axis, float(period)) for axis, period in enumerate(periods) if period)
        self.stands = config.frame == "world"
        self.row = DeviceRow(2)

    def follow(self, middle: np.ndarray) -> None:
        """Set the middle x, z (2,) [m] of the patch in the world."""
        for axis, at in enumerate(middle.tolist()):
            self.row.set(axis, at)

    @property
    def origin(self) -> np.ndarray:
        """Origin (3,) of the wind's axes in the world [m]."""
        x, z = (0.0, 0.0) if self.stands else self.row.values
        return np.array([x, 0.0, z])

    @ti.func
    def seen(self, position):
        """Position [m], in the wind's axes, of a particle on the patch or a ship in the world at `position` [m]."""
        found = position
        for axis, k, period in ti.static(self.axes):
            middle = self.row.field[axis]
            far = position[k] - middle
            found[k] = far - period * ti.round(far / period)
            if ti.static(self.stands):
                found[k] += middle
        return found


class Passages:
    """Repeated passages of a drifting wind across the basin: its centre [m], turn [rad], strength and passage number.

    The first begins at its start. When the rear has left the basin, direction and strength are drawn anew, and the
    front comes in at the upwind border, on a line through the point of the first path nearest to the centre."""

    def __init__(
        self,
        start: ArrayLike,
        drift: ArrayLike,
        reach: float,
        basin: Basin,
        redraw: Callable[[int], tuple[float, float]] = lambda passage: (0.0, 1.0),
    ) -> None:
        """`start`: first centre [m]; `drift`: velocity [m/s]; `reach`: from centre to rear [m]; `redraw`: function from
        the number of a passage, from 1 for the second, to its turn [rad] and strength; by default 0 and 1."""
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
        """Present centre (3,) [m] of the wind, in its own axes (see `Patch`)."""
        return self.origin + self.velocity * self.elapsed

    def advance(self, dt: float) -> None:
        """Move the wind on by dt [s]; after the rear has left the basin, begin the next passage."""
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
        """Time [s] from the beginning of this passage until the rear leaves the basin; infinite without drift."""
        rear = self.origin - self.reach * self.direction
        return max(0.0, self._to_border(rear, self.direction) / self.speed) if self.speed else inf

    def _to_border(self, x: np.ndarray, direction: np.ndarray) -> float:
        """Distance [m] from x along a unit vector to the border of the basin; negative if x is already beyond it."""
        face = np.where(direction > 0.0, self.upper, self.lower)
        along = np.abs(direction) > 1e-9
        return float(((face - x)[along] / direction[along]).min())
