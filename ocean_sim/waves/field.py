"""A sea of plane waves to be asked by other programs: elevation, normal, velocity, and a periodic field of a square.

The verbs are those of the wave fields of robot simulators: height and normal at points, the velocity of the water, and
a square of n x n heights that fits to itself on all sides, to be laid on any plane.
"""

import numpy as np

from ocean_sim import waves
from ocean_sim.conventions import number, row_array, whole_number

MIN_SQUARE_SIDE = 1e-6  # side of a square [m]


class WaveField:
    """Plane waves; x and z horizontal, y up, the still water at y = 0 [m]."""

    def __init__(self, sea: waves.Components) -> None:
        self.sea = sea

    def elevation(self, points: np.ndarray, time: float) -> np.ndarray:
        """(n,) heights of the water [m] at points x, z (n, 2) [m]."""
        return waves.elevation(self.sea, row_array("points", points, "x, z"), number("time", time, "s"))

    def normal(self, points: np.ndarray, time: float) -> np.ndarray:
        """(n, 3) upward unit normals of the surface at points x, z (n, 2) [m]."""
        at, time = row_array("points", points, "x, z"), number("time", time, "s")
        slope = np.zeros((len(at), 2))
        for some, angle in self.sea.angles(at, time):
            steepness = self.sea.amplitude[some, None] * self.sea.wavevector[some]
            slope -= np.stack([waves.summed(steepness[:, axis], np.sin(angle)) for axis in (0, 1)], axis=1)
        slope *= self.sea.grown(time)
        found = np.stack([-slope[:, 0], np.ones(len(at)), -slope[:, 1]], axis=1)
        return found / np.linalg.norm(found, axis=1, keepdims=True)

    def velocity(self, points: np.ndarray, time: float) -> np.ndarray:
        """(n, 3) velocities of the water [m/s] at points x, y, z (n, 3) [m], of columns stretched from bed to surface
        (Wheeler 1970); above the water that of its surface."""
        return waves.velocity(self.sea, row_array("points", points, "x, y, z"), number("time", time, "s"))

    def periodic(self, side: float) -> "WaveField":
        """The waves with wavelengths that fit into a square of this side [m], so that it fits to itself."""
        unit = 2.0 * np.pi / number("side", side, "m", MIN_SQUARE_SIDE)
        fitting = np.round(self.sea.wavevector / unit)
        still = ~fitting.any(axis=1)  # waves longer than the square become as long as it is
        axis = np.abs(self.sea.wavevector[still]).argmax(axis=1)
        fitting[np.flatnonzero(still), axis] = np.sign(self.sea.wavevector[still, axis])
        return WaveField(waves.merged(self.sea, fitting * unit))

    def field(self, cells: int, side: float, time: float) -> np.ndarray:
        """(cells, cells) heights [m] over x and z of a square that repeats itself, its first corner at the origin."""
        at = np.arange(whole_number("cells", cells)) * (number("side", side, "m", MIN_SQUARE_SIDE) / cells)
        x, z = np.meshgrid(at, at, indexing="ij")
        heights = self.periodic(side).elevation(np.stack([x.ravel(), z.ravel()], axis=1), time)
        return heights.reshape(cells, cells)
