"""A hull as the water's own laws meet it: what it keeps free of water, and samples of what lies within their reach."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ocean_sim.files.cache_file import kept
from ocean_sim.ship.shared.distance import around
from ocean_sim.ship.shared.rigid_body import RigidBody
from ocean_sim.ship.shared.shapes import HullShape
from ocean_sim.ship.shared.voxels import voxels

FINE = 3.0  # cubes to a spacing of the particles, where a mesh keeps water out
APART = 0.5  # [spacings] from the hull to the nearest particle of the start
ALIKE = 0.05  # [spacings] distances that differ by less are those of a row
PACKINGS, PUSH = 100, 0.5  # how often crowded particles are pushed apart, and the share of their overlap each time
GOLDEN = 0.6180339887498949  # spreads what is taken from a row evenly along it


@dataclass(frozen=True, eq=False)
class Solid:
    """A hull where it begins; in 2-D the section amidships."""

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
        full[tuple(cubes.cells.T)] = cubes.share > 0.5
        position = np.floor((own - lower) / cubes.size).astype(int)
        there = ((position >= 0) & (position < counts)).all(axis=1)
        there[there] = full[tuple(position[there].T)]
        return there

    def carved(
        self, positions: np.ndarray, spacing: float, boxes: list[tuple[np.ndarray, np.ndarray]]
    ) -> tuple[np.ndarray, np.ndarray]:
        """(n,) which of (n, 3) positions of a lattice that fills boxes [m] make room, as many as the hull displaces,
        the deepest first; and (n, 3) where the others go: half a spacing off the hull and away from each other [m].
        Kept in the user's cache: of all that is known before a run this takes longest."""
        numbers = [self.centre, self.origin, self.turn, *(corner for box in boxes for corner in box)]
        rules = (FINE, APART, ALIKE, PACKINGS, PUSH, GOLDEN)
        content = self.shape.content() + repr([spacing, rules, *(array.tolist() for array in numbers)]).encode()
        found = kept("carved", content + positions.tobytes(), lambda: self.making_room(positions, spacing, boxes))
        gone, moved = np.zeros(len(positions), dtype=bool), positions.copy()
        gone[found["gone"]], moved[found["near"]] = True, found["moved"]
        return gone, moved

    def making_room(
        self, positions: np.ndarray, spacing: float, boxes: list[tuple[np.ndarray, np.ndarray]]
    ) -> dict[str, np.ndarray]:
        """The same of those alone that make room: the numbers of those `gone`, and of those `near`, which are
        `moved`."""
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
        slopes = np.gradient(values["distance"], *step)

        def off(points: np.ndarray) -> np.ndarray:
            """(m, 3) points half a spacing off the hull, where they were nearer."""
            at = ((points - self.origin) @ self.turn + self.centre - first) / step
            away = map_coordinates(values["distance"], at.T, order=1, cval=2.0 * spacing)
            return points + np.maximum(APART * spacing - away, 0.0)[:, None] * normals(slopes, at, self.turn.T)

        free = np.flatnonzero(~gone & (distance < 2.0 * spacing))
        moved = packed(positions[free], positions[~gone & (distance >= 2.0 * spacing)], spacing, off)
        return {"gone": np.flatnonzero(gone), "near": free, "moved": moved}

    def displaced(self, spacing: float, boxes: list[tuple[np.ndarray, np.ndarray]]) -> float:
        """Volume of the hull inside boxes [m3]."""
        cubes = voxels(self.shape, spacing / FINE, 1.0)
        positions, tall = (cubes.centre - self.centre) @ self.turn.T + self.origin, cubes.spread(self.turn[1])
        found = 0.0
        for low, up in boxes:
            within = ((positions >= low) & (positions < up))[:, [0, 2]].all(axis=1) & (positions[:, 1] > low[1])
            found += float((cubes.share * within * np.clip((up[1] - positions[:, 1]) / tall + 0.5, 0.0, 1.0)).sum())
        return found * float(cubes.size.prod())

    def samples(self, spacing: float, support: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(n, 3) positions from the centre of mass, body axes [m], (n,) volumes [m3], in 2-D areas [m2], and (n, 3)
        outward normals of the nearest face."""
        from scipy.ndimage import distance_transform_edt

        cubes = voxels(self.shape, spacing, 1.0)
        lower, upper = self.shape.bounds()
        where, position, volume = cubes.cells, cubes.centre - self.centre, cubes.share * cubes.size.prod()
        if self.flat:
            middle = where[:, 2] == np.round((upper - lower) / cubes.size).astype(int)[2] // 2
            where, position, volume = where[middle], position[middle] * [1.0, 1.0, 0.0], volume[middle] / cubes.size[2]
        full = np.zeros(where.max(axis=0) + 3, dtype=bool)
        full[tuple(where.T + 1)] = True
        if self.flat:
            full = np.repeat(full.any(axis=2, keepdims=True), full.shape[2], axis=2)
        deep = distance_transform_edt(full, sampling=cubes.size)[tuple(where.T + 1)]
        sampled = deep < support + cubes.size.max()
        values, first, step = around(self.shape, spacing / FINE, spacing, 2.0 * spacing)
        at, slopes = (position[sampled] + self.centre - first) / step, np.gradient(values["distance"], *step)
        across = np.diag([1.0, 1.0, 0.0 if self.flat else 1.0])
        return position[sampled], volume[sampled], normals(slopes, at, across)


def normals(slopes: Sequence[np.ndarray], at: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """(n, 3) outward normals of the nearest face, by the `slopes` of the distance along x, y and z on its lattice, at
    (n, 3) positions there [nodes]; then turned by a (3, 3) matrix from the right."""
    from scipy.ndimage import map_coordinates

    found = np.stack([map_coordinates(slope, at.T, order=1, mode="nearest") for slope in slopes], axis=1) @ turn
    return np.asarray(found / np.maximum(np.linalg.norm(found, axis=1, keepdims=True), 1e-12))


def packed(free: np.ndarray, others: np.ndarray, spacing: float, off: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """(m, 3) positions of the particles near a hull at which they neither touch it nor crowd each other or the `others`
    (k, 3), which stay: those nearer than a spacing push each other half of the way apart, over and over (a particle
    packing as in Colagrossi et al. 2012, Comput. Phys. Commun. 183). Crowded ones would burst into the hull at once.
    They do not rise above the highest nor sink below the lowest of the water around them.
    """
    from scipy.spatial import cKDTree

    if len(free) == 0:
        return free
    lowest, highest = (bound(np.concatenate([free, others]), axis=0) for bound in (np.min, np.max))
    near = others[cKDTree(free).query(others)[0] < 3.0 * spacing] if len(others) else others
    whole, m = np.concatenate([off(free), near]), len(free)
    for _ in range(PACKINGS):
        pairs = cKDTree(whole).query_pairs(spacing * (1.0 - 1e-9), output_type="ndarray")
        pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
        i, j = pairs[pairs.min(axis=1) < m].T
        apart = whole[i] - whole[j]
        way = np.linalg.norm(apart, axis=1, keepdims=True)
        push = 0.5 * PUSH * (spacing - way) * apart / np.maximum(way, 1e-9 * spacing)
        moved = np.zeros_like(whole)
        np.add.at(moved, i, push)
        np.add.at(moved, j, -push)
        whole[:m] = np.clip(off(whole[:m] + moved[:m]), lowest, highest)
    return whole[:m]
