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
    def over_a_lattice(self) -> tuple[np.ndarray, np.ndarray]:
        """Heights above flat water [m], rising, and shares there, (positions between the particles, heights)."""
        reach = self.thickness / self.spacing
        n = ceil(reach) + 1
        height = np.linspace(-n, n, HEIGHTS)
        offset = (np.arange(OFFSETS) + 0.5) / OFFSETS - 0.5
        across = np.arange(-n, n + 1)
        if self.dimension == 2:
            across_squared = np.square(offset[:, None] - across)
        else:
            x = np.square(offset[:, None] - across)
            across_squared = (x[:, None, :, None] + x[None, :, None, :]).reshape(OFFSETS**2, -1)
        below = np.square(height[:, None] + 0.5 + np.arange(2 * n + 1))
        w = np.maximum(reach**2 - across_squared[:, None, :, None] - below[None, :, None, :], 0.0)
        return height * self.spacing, self.constant * self.spacing**6 * np.sum(w**3, axis=(2, 3))

    def heights(self, share: float) -> np.ndarray:
        """Where water on a lattice has this share, seen from above [m], at every position between the particles."""
        height, shares = self.over_a_lattice
        k = HEIGHTS - 1 - np.argmax(shares[:, ::-1] >= share, axis=1)
        k = np.minimum(k, HEIGHTS - 2)
        inside, outside = (np.take_along_axis(shares, column[:, None], axis=1)[:, 0] for column in (k, k + 1))
        return height[k] + (height[1] - height[0]) * (inside - share) / np.maximum(inside - outside, 1.0e-12)

    @cached_property
    def at_surface(self) -> float:
        """The share that lies, on an average over all positions, exactly at the surface of flat water on a lattice."""
        low, high = 0.05, 0.95
        for _ in range(40):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.heights(middle).mean() > 0.0 else (low, middle)
        return 0.5 * (low + high)

    @cached_property
    def steepness(self) -> float:
        """How fast the share falls through a flat surface [1/m]."""
        height, shares = self.over_a_lattice
        return float(-np.gradient(shares.mean(axis=0), height).min())
