"""A hull as the water's own laws meet it: what it keeps free of water, and samples of what lies within their reach."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ocean_sim.ship._rigid_body import RigidBody
from ocean_sim.ship._voxels import Voxels, voxels

FINE = 3.0  # cubes to a spacing of the particles, where a mesh says what it keeps free


@dataclass(frozen=True, eq=False)
class Solid:
    """A hull where it begins; in a slice the section amidships."""

    shape: Any
    centre: np.ndarray  # (3,) centre of mass from the hull's origin [m]
    body: RigidBody
    flat: bool
    felt: bool = True  # whether the water's laws meet samples of it

    @property
    def origin(self) -> np.ndarray:
        """(3,) of the centre of mass at the beginning [m]."""
        return self.body.position

    @cached_property
    def turn(self) -> np.ndarray:
        """(3, 3) at the beginning, body to world."""
        return self.body.matrix

    def inside(self, points: np.ndarray, spacing: float) -> np.ndarray:
        """(n,) which of (n, 3) places [m] the hull keeps free at the beginning."""
        own = (points - self.origin) @ self.turn + self.centre
        if not hasattr(self.shape, "closed"):
            return self.shape.inside(own)
        cubes = voxels(self.shape, spacing / FINE, 1.0)
        lower, upper = self.shape.bounds()
        counts = np.round((upper - lower) / cubes.size).astype(int)
        full = np.zeros(counts, dtype=bool)
        full[tuple(cells(cubes, lower).T)] = cubes.share > 0.5
        place = np.floor((own - lower) / cubes.size).astype(int)
        there = ((place >= 0) & (place < counts)).all(axis=1)
        there[there] = full[tuple(place[there].T)]
        return there

    def samples(self, spacing: float, support: float) -> tuple[np.ndarray, np.ndarray]:
        """(n, 3) places from the centre of mass, body axes [m], and (n,) volumes [m3], in a slice areas [m2]."""
        from scipy.ndimage import distance_transform_edt

        cubes = voxels(self.shape, spacing, 1.0)
        lower, upper = self.shape.bounds()
        where, place, volume = cells(cubes, lower), cubes.centre - self.centre, cubes.share * cubes.size.prod()
        if self.flat:
            middle = where[:, 2] == np.round((upper - lower) / cubes.size).astype(int)[2] // 2
            where, place, volume = where[middle], place[middle] * [1.0, 1.0, 0.0], volume[middle] / cubes.size[2]
        full = np.zeros(where.max(axis=0) + 3, dtype=bool)
        full[tuple(where.T + 1)] = True
        if self.flat:
            full = np.repeat(full.any(axis=2, keepdims=True), full.shape[2], axis=2)
        deep = distance_transform_edt(full, sampling=cubes.size)[tuple(where.T + 1)]
        felt = deep < support + cubes.size.max()
        return place[felt], volume[felt]


def cells(cubes: Voxels, lower: np.ndarray) -> np.ndarray:
    """(n, 3) which cube along each axis each is."""
    return np.floor((cubes.centre - lower) / cubes.size).astype(int)
