"""The place of a wind over a patch of open sea: it travels with the patch, or stands in the world.

Particles are known by where they are on the patch, which repeats itself; ships by where they are in the world. Both are
seen here around the middle of the patch, which follows the ships.
"""

from typing import Literal

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.kernel_library import ti
from ocean_sim.model import Model
from ocean_sim.parts import Preflight, Problems
from ocean_sim.runtime import in_kernels
from ocean_sim.wind.shared.clock import DeviceRow


class Placed(Model):
    """A wind that has a place."""

    frame: Literal["tile", "world"] | None = None
    """Over a patch of open sea: `tile`, it travels with the patch, so its places are seen from the ship and it comes in
    again at the border of the patch; `world`, it stands and drifts in the world, and the ship may leave it behind.
    null: tile."""

    def misframed(self, preflight: Preflight) -> Problems:
        """A problem where a frame is given and there is no patch."""
        if self.frame is None or preflight.tank.sea is not None:
            return []
        return [(("frame",), "a wind has a frame only over a patch of open sea; leave it out, or name a sea")]


@in_kernels
class Patch:
    """The patch under a wind. Over any other basin a place is the same for the wind and the world."""

    def __init__(self, config: Placed, basin: Basin) -> None:
        periods = (basin.periods[0], basin.periods[2]) if basin.sea is not None else (0.0, 0.0)
        self.axes = tuple((axis, 2 * axis, float(period)) for axis, period in enumerate(periods) if period)
        self.stands = config.frame == "world"
        self.row = DeviceRow(2)

    def follow(self, middle: np.ndarray) -> None:
        """Note that its middle is at x, z (2,) in the world [m] from now on."""
        for axis, at in enumerate(middle.tolist()):
            self.row.set(axis, at)

    @property
    def origin(self) -> np.ndarray:
        """(3,) origin of the wind in the world [m]."""
        x, z = (0.0, 0.0) if self.stands else self.row.values
        return np.array([x, 0.0, z])

    @ti.func
    def seen(self, position):
        """Place of a position [m] in the axes of the wind [m]."""
        found = position
        for axis, k, period in ti.static(self.axes):
            middle = self.row.field[axis]
            far = position[k] - middle
            found[k] = far - period * ti.round(far / period)
            if ti.static(self.stands):
                found[k] += middle
        return found
