"""A hull as the water's own laws meet it: what it keeps free of water, and samples of what lies within their reach."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ocean_sim.ship.shared.distance import around
from ocean_sim.ship.shared.rigid_body import RigidBody
from ocean_sim.ship.shared.shapes import HullShape
from ocean_sim.ship.shared.voxels import cells, voxels

FINE = 3.0  # cubes to a spacing of the particles, where a mesh keeps water out
APART = 0.5  # [spacings] from the hull to the nearest particle of the start
ALIKE = 0.05  # [spacings] distances that differ by less are those of a row
GOLDEN = 0.6180339887498949  # spreads what is taken from a row evenly along it


@dataclass(frozen=True, eq=False)
class Solid:
    """A hull where it begins; in a slice the section amidships."""

    shape: HullShape
    centre: np.ndarray  # (3,) centre of mass from the hull's origin [m]
    body: RigidBody
    flat: bool
    felt: bool = True  # whether the water's laws meet samples of it
    reach: float = 0.0  # of what it does else to the water [m]

    @property
    def origin(self) -> np.ndarray:
        """(3,) of the centre of mass at the beginning [m]."""
        return self.body.position

    @cached_property
    def turn(self) -> np.ndarray:
        """(3, 3) at the beginning, body to world."""
        return self.body.matrix

    def inside(self, points: np.ndarray, spacing: float) -> np.ndarray:
        """(n,) which of (n, 3) positions [m] the hull keeps free at the beginning."""
        own = (points - self.origin) @ self.turn + self.centre
        if not self.shape.is_mesh:
            return self.shape.inside(own)
        cubes = voxels(self.shape, spacing / FINE, 1.0)
        lower, upper = self.shape.bounds()
        counts = np.round((upper - lower) / cubes.size).astype(int)
        full = np.zeros(counts, dtype=bool)
        full[tuple(cells(cubes, lower).T)] = cubes.share > 0.5
        position = np.floor((own - lower) / cubes.size).astype(int)
        there = ((position >= 0) & (position < counts)).all(axis=1)
        there[there] = full[tuple(position[there].T)]
        return there

    def carved(
        self, positions: np.ndarray, spacing: float, boxes: list[tuple[np.ndarray, np.ndarray]]
    ) -> tuple[np.ndarray, np.ndarray]:
        """(n,) which of (n, 3) positions of a lattice that fills boxes [m] make room, as many as the hull displaces,
        the deepest first; and (n, 3) where the others go: half a spacing off the hull, along its normal [m]."""
        from scipy.ndimage import map_coordinates

        values, first, step = around(self.shape, spacing / FINE, spacing, 2.0 * spacing)
        at = ((positions - self.origin) @ self.turn + self.centre - first) / step
        distance = np.full(len(positions), 2.0 * spacing)
        near = ((at >= 0.0) & (at <= np.array(values["distance"].shape) - 1.0)).all(axis=1)
        distance[near] = map_coordinates(values["distance"], at[near].T, order=1)
        row = np.round(distance / (ALIKE * spacing))
        order = np.lexsort((np.arange(len(positions)) * GOLDEN % 1.0, row))
        gone = np.zeros(len(positions), dtype=bool)
        gone[order[: round(self.displaced(spacing, boxes) / spacing**3)]] = True
        close = np.flatnonzero(~gone & (distance < APART * spacing))
        slope = [map_coordinates(g, at[close].T, order=1) for g in np.gradient(values["distance"], *step)]
        normal = np.stack(slope, axis=1) @ self.turn.T
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
        moved = positions.copy()
        moved[close] += (APART * spacing - distance[close])[:, None] * normal
        return gone, moved

    def displaced(self, spacing: float, boxes: list[tuple[np.ndarray, np.ndarray]]) -> float:
        """Volume of the hull inside boxes [m3]."""
        cubes = voxels(self.shape, spacing / FINE, 1.0)
        positions, tall = (cubes.centre - self.centre) @ self.turn.T + self.origin, cubes.spread(self.turn[1])
        found = 0.0
        for low, up in boxes:
            within = ((positions > low) & (positions < up))[:, [0, 2]].all(axis=1) & (positions[:, 1] > low[1])
            found += float((cubes.share * within * np.clip((up[1] - positions[:, 1]) / tall + 0.5, 0.0, 1.0)).sum())
        return found * float(cubes.size.prod())

    def samples(self, spacing: float, support: float) -> tuple[np.ndarray, np.ndarray]:
        """(n, 3) positions from the centre of mass, body axes [m], and (n,) volumes [m3], in a slice areas [m2]."""
        from scipy.ndimage import distance_transform_edt

        cubes = voxels(self.shape, spacing, 1.0)
        lower, upper = self.shape.bounds()
        where, position, volume = cells(cubes, lower), cubes.centre - self.centre, cubes.share * cubes.size.prod()
        if self.flat:
            middle = where[:, 2] == np.round((upper - lower) / cubes.size).astype(int)[2] // 2
            where, position, volume = where[middle], position[middle] * [1.0, 1.0, 0.0], volume[middle] / cubes.size[2]
        full = np.zeros(where.max(axis=0) + 3, dtype=bool)
        full[tuple(where.T + 1)] = True
        if self.flat:
            full = np.repeat(full.any(axis=2, keepdims=True), full.shape[2], axis=2)
        deep = distance_transform_edt(full, sampling=cubes.size)[tuple(where.T + 1)]
        sampled = deep < support + cubes.size.max()
        return position[sampled], volume[sampled]
