"""How a sheet meets the particles under it: their smoothed share around a node, and what it is at a flat surface.

A node has water around it where the share of water within the sheet's thickness, smoothed with the poly6 kernel, is
above that of a flat surface. A lone drop does not reach that share, so spray does not lift the sheet.
"""

from functools import cached_property
from math import ceil, pi

import numpy as np

from ocean_sim.kernel_library import ti
from ocean_sim.runtime import in_kernels

OFFSETS = 12  # positions of a node between the particles of a lattice, along an axis
HEIGHTS = 241


@in_kernels
class Contact:
    """The share of water within `thickness` [m] of a point, and its slope upwards [1/m]."""

    sums = 2

    def __init__(self, dimension: int, thickness: float, spacing: float) -> None:
        """`spacing` of the particles [m]."""
        self.dimension, self.thickness, self.spacing = dimension, thickness, spacing
        constant = {2: 4.0 / (pi * thickness**8), 3: 315.0 / (64.0 * pi * thickness**9)}[dimension]
        self.constant = constant * spacing**dimension

    @ti.func
    def term(self, own, j, d, mirror):
        w = self.thickness * self.thickness - d.dot(d)
        w = ti.select(w > 0.0, w, 0.0)
        return ti.static(self.constant) * w * w * ti.Vector([w, 6.0 * d.y])

    @cached_property
    def over_a_lattice(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Heights above flat water [m], rising, shares there, (positions between the particles, heights), and the
        weight of each position: of those that mirror each other only one is there."""
        reach = self.thickness / self.spacing
        n = ceil(reach) + 1
        height = np.linspace(-n, n, HEIGHTS)
        offset = (np.arange(OFFSETS // 2) + 0.5) / OFFSETS
        x = np.square(offset[:, None] - np.arange(-n, n + 1))
        across_squared, weight = x, np.ones(len(x))
        if self.dimension == 3:
            i, k = np.triu_indices(len(x))
            across_squared = (x[i][:, :, None] + x[k][:, None, :]).reshape(len(i), -1)
            weight = np.where(i == k, 1.0, 2.0)
        below = np.square(height[:, None] + 0.5 + np.arange(2 * n + 1))

        def summed(across: np.ndarray) -> np.ndarray:  # all together are more than caches hold
            w = np.maximum(reach**2 - across[:, None] - below[:, None, :], 0.0)
            return np.asarray(np.sum(w * w * w, axis=(1, 2)))

        shares = self.constant * self.spacing**6 * np.array([summed(across) for across in across_squared])
        return height * self.spacing, shares, weight / weight.sum()

    def height(self, share: float) -> float:
        """Where water on a lattice has this share, seen from above [m], on an average over all positions between the
        particles."""
        height, shares, weight = self.over_a_lattice
        k = HEIGHTS - 1 - np.argmax(shares[:, ::-1] >= share, axis=1)
        k = np.minimum(k, HEIGHTS - 2)
        inside, outside = (np.take_along_axis(shares, column[:, None], axis=1)[:, 0] for column in (k, k + 1))
        above = height[k] + (height[1] - height[0]) * (inside - share) / np.maximum(inside - outside, 1.0e-12)
        return float(weight @ above)

    @cached_property
    def at_surface(self) -> float:
        """The share that lies, on an average over all positions, exactly at the surface of flat water on a lattice."""
        low, high = 0.05, 0.95
        for _ in range(40):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.height(middle) > 0.0 else (low, middle)
        return 0.5 * (low + high)

    @cached_property
    def steepness(self) -> float:
        """How fast the share falls through a flat surface [1/m]."""
        height, shares, weight = self.over_a_lattice
        return float(-np.gradient(weight @ shares, height).min())
