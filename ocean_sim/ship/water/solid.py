"""A hull as a solid body among particles: the space that it keeps free of water, and samples of its inside near the
water."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np

from ocean_sim.basin.packing import Lattice, Wendland, deepest_first, fit_particles
from ocean_sim.files.cache_file import cached_arrays
from ocean_sim.ship.body.rigid_body import RigidBody
from ocean_sim.ship.hull.distance import distance_lattice
from ocean_sim.ship.hull.shapes import HullShape
from ocean_sim.ship.hull.voxels import Voxels, voxels

CUBES_A_SPACING = 3.0  # cubes to a spacing of the particles, where a mesh keeps water out
START_GAP = 0.5  # [spacings] from the hull to the nearest particle of the start
FIT_SUPPORT = 2.0  # [spacings] of the kernel by which particles are fitted to a hull that the water's laws meet
Boxes = list[tuple[np.ndarray, np.ndarray]]  # lower and upper corner of each [m]
UNBOUNDED_BOX = [(np.full(3, -np.inf), np.full(3, np.inf))]  # a box without bounds
PACKING_SWEEPS = 100  # over crowded particles that are pushed apart
PACKING_PUSH = 0.5  # share of their overlap in each sweep


@dataclass(frozen=True, eq=False)
class Solid:
    """A hull at its pose at the beginning of a run, as a solid body; in 2-D the section amidships."""

    shape: HullShape
    centre: np.ndarray  # (3,) centre of mass from the hull's origin [m]
    body: RigidBody
    flat: bool
    is_sampled: bool = True  # by the laws of the water
    reach: float = 0.0  # of what it does else to the water [m]

    @property
    def origin(self) -> np.ndarray:
        return self.body.position

    @cached_property
    def turn(self) -> np.ndarray:
        """(3, 3) rotation at the beginning, body to world."""
        return self.body.matrix

    @property
    def dimension(self) -> int:
        """2 for the section amidships, in a 2-D basin, else 3."""
        return 2 if self.flat else 3

    @cached_property
    def extent(self) -> np.ndarray:
        corners = np.array(list(product(*np.transpose(self.shape.bounds()))))
        placed = (corners - self.centre) @ self.turn.T + self.origin
        return np.stack([placed.min(axis=0), placed.max(axis=0)])

    def make_room(
        self, positions: np.ndarray, beyond: np.ndarray, boxes: Boxes, lattice: Lattice
    ) -> tuple[np.ndarray, np.ndarray]:
        """Make room for the hull in a lattice of particles at rest, as `basin.Solid` says: as many go as it displaces,
        the deepest first, and those around move. Kept in the user's cache, as nothing else in preparing a run takes
        longer."""
        poses = [self.centre, self.origin, self.turn, *(corner for box in boxes for corner in box)]
        numbers = repr([lattice, self.is_sampled, self.flat, *(array.tolist() for array in poses)]).encode()
        content = self.shape.content() + numbers + positions.tobytes() + beyond.tobytes()

        def made() -> dict[str, np.ndarray]:
            if self.is_sampled:
                return self.fit_room(positions, beyond, boxes, lattice)
            return self.carve_room(positions, boxes, lattice.spacing)

        found = cached_arrays("rooms", content, made)
        gone, moved = np.zeros(len(positions), dtype=bool), positions.copy()
        gone[found["gone"]], moved[found["near"]] = True, found["moved"]
        return gone, moved

    def carve_room(self, positions: np.ndarray, boxes: Boxes, spacing: float) -> dict[str, np.ndarray]:
        """Room for a hull without samples: indices of particles `gone` and of those `near` the hull, and positions [m]
        of the latter, `moved` half a spacing off the hull and away from each other. Water fills `boxes`."""
        values, first, step = distance_lattice(self.shape, spacing / CUBES_A_SPACING, spacing, 2.0 * spacing)
        distance, order = self.deepest_first((positions - self.origin) @ self.turn + self.centre, spacing)
        gone = np.zeros(len(positions), dtype=bool)
        gone[order[: round(self.displaced_volume(spacing, boxes) / spacing**3)]] = True
        slopes = np.gradient(values["distance"], *step)

        def off(points: np.ndarray) -> np.ndarray:
            """(m, 3) points, those nearer to the hull than half a spacing moved to that distance."""
            at = ((points - self.origin) @ self.turn + self.centre - first) / step
            away = lattice_values(values["distance"], at, 2.0 * spacing)
            return points + np.maximum(START_GAP * spacing - away, 0.0)[:, None] * face_normals(slopes, at, self.turn.T)

        free = np.flatnonzero(~gone & (distance < 2.0 * spacing))
        moved = pack_particles(positions[free], positions[~gone & (distance >= 2.0 * spacing)], spacing, off)
        return {"gone": np.flatnonzero(gone), "near": free, "moved": moved}

    def fit_room(
        self, positions: np.ndarray, beyond: np.ndarray, boxes: Boxes, lattice: Lattice
    ) -> dict[str, np.ndarray]:
        """Room for a sampled hull (arguments of `make_room`): indices of particles `gone` and `near`, and positions [m]
        of the latter, `moved` to minimise a kernel's sum over particles and samples of the hull, so that an even
        pressure pushes none (particle packing, Colagrossi et al. 2012)."""
        points, spacing = np.concatenate([positions, beyond]), lattice.spacing
        water = np.arange(len(points)) < len(positions)
        # To a thousandth of a spacing, since minimisation would make rounding of a pose a hundred times as large.
        origin = np.round(self.origin / spacing, 3) * spacing
        _, order = self.deepest_first((points - origin) @ self.turn + self.centre, spacing)
        wet, whole = (self.displaced_volume(spacing, within) / lattice.volume for within in (boxes, UNBOUNDED_BOX))
        gone = np.zeros(len(points), dtype=bool)
        for there, count in ((water, wet), (~water, whole - wet)):
            gone[order[there[order]][: round(count)]] = True
        at, volumes, _ = self.samples(spacing, FIT_SUPPORT * spacing)
        packed = replace(lattice, kernel=Wendland(), support=FIT_SUPPORT)
        return fit_particles(points, water, gone, (at @ self.turn.T + origin, volumes), packed, self.dimension)

    def deepest_first(self, own: np.ndarray, spacing: float) -> tuple[np.ndarray, np.ndarray]:
        """(n,) distances from the hull [m] of points `own` (n, 3) in its axes, and the order of the points, the deepest
        in the hull first, spread evenly along rows of the same depth."""
        values, first, step = distance_lattice(self.shape, spacing / CUBES_A_SPACING, spacing, 2.0 * spacing)
        if self.flat:
            own[:, 2] = first[2] + 0.5 * step[2] * (values["distance"].shape[2] - 1)
        distance = lattice_values(values["distance"], (own - first) / step, 2.0 * spacing)
        return distance, deepest_first(distance, spacing)

    def displaced_volume(self, spacing: float, boxes: Boxes) -> float:
        """Volume of the hull inside `boxes` [m3], in 2-D its area [m2], by cubes finer than a `spacing` [m]."""
        cubes = voxels(self.shape, spacing / CUBES_A_SPACING, 1.0)
        positions, tall = (cubes.centre - self.centre) @ self.turn.T + self.origin, cubes.height_spread(self.turn[1])
        found, across, met = 0.0, [0] if self.flat else [0, 2], self.body_cubes(cubes)
        for low, up in boxes:
            inside = ((positions >= low) & (positions < up))[:, across].all(axis=1) & (positions[:, 1] > low[1]) & met
            found += float((cubes.share * inside * np.clip((up[1] - positions[:, 1]) / tall + 0.5, 0.0, 1.0)).sum())
        return found * float(cubes.size[: self.dimension].prod())

    def body_cubes(self, cubes: Voxels) -> np.ndarray:
        """(n,) True for cubes that belong to the body in the water: all of them, in 2-D those amidships."""
        if not self.flat:
            return np.ones(len(cubes.share), dtype=bool)
        lower, upper = self.shape.bounds()
        return np.asarray(cubes.cells[:, 2] == np.round((upper - lower) / cubes.size).astype(int)[2] // 2)

    def samples(self, spacing: float, support: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        from scipy.ndimage import distance_transform_edt

        cubes = voxels(self.shape, spacing, 1.0)
        met = self.body_cubes(cubes)
        where, position = cubes.cells[met], (cubes.centre - self.centre)[met]
        volume = cubes.share[met] * cubes.size[: self.dimension].prod()
        if self.flat:
            position[:, 2] = 0.0
        full = np.zeros(where.max(axis=0) + 3, dtype=bool)
        full[tuple(where.T + 1)] = True
        if self.flat:
            full = np.repeat(full.any(axis=2, keepdims=True), full.shape[2], axis=2)
        deep = distance_transform_edt(full, sampling=cubes.size)[tuple(where.T + 1)]
        sampled = deep < support + cubes.size.max()
        values, first, step = distance_lattice(self.shape, spacing / CUBES_A_SPACING, spacing, 2.0 * spacing)
        at, slopes = (position[sampled] + self.centre - first) / step, np.gradient(values["distance"], *step)
        across = np.diag([1.0, 1.0, 0.0 if self.flat else 1.0])
        return position[sampled], volume[sampled], face_normals(slopes, at, across)


def face_normals(slopes: Sequence[np.ndarray], at: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """(n, 3) outward unit normals of the nearest face at positions `at` (n, 3) [nodes] of a lattice, by the distance's
    `slopes` along x, y and z at its nodes; turned by the (3, 3) matrix `turn` from the right."""
    from scipy.ndimage import map_coordinates

    found = np.stack([map_coordinates(slope, at.T, order=1, mode="nearest") for slope in slopes], axis=1) @ turn
    return np.asarray(found / np.maximum(np.linalg.norm(found, axis=1, keepdims=True), 1e-12))


def pack_particles(
    free: np.ndarray, others: np.ndarray, spacing: float, off: Callable[[np.ndarray], np.ndarray]
) -> np.ndarray:
    """(m, 3) positions of the `free` particles near a hull, moved so that they neither touch it nor crowd each other or
    the `others` (k, 3), which stay; `off` moves points off the hull. Those nearer than a spacing push each other half
    of the way apart, again and again (particle packing, Colagrossi et al. 2012, Comput. Phys. Commun. 183), within the
    heights of the water around; crowded ones would burst into the hull at once."""
    from scipy.spatial import cKDTree

    if len(free) == 0:
        return free
    lowest, highest = (bound(np.concatenate([free, others]), axis=0) for bound in (np.min, np.max))
    near = others[cKDTree(free).query(others)[0] < 3.0 * spacing] if len(others) else others
    whole, m = np.concatenate([off(free), near]), len(free)
    for _ in range(PACKING_SWEEPS):
        pairs = cKDTree(whole).query_pairs(spacing * (1.0 - 1e-9), output_type="ndarray")
        pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
        i, j = pairs[pairs.min(axis=1) < m].T
        apart = whole[i] - whole[j]
        way = np.linalg.norm(apart, axis=1, keepdims=True)
        push = 0.5 * PACKING_PUSH * (spacing - way) * apart / np.maximum(way, 1e-9 * spacing)
        moved = np.zeros_like(whole)
        np.add.at(moved, i, push)
        np.add.at(moved, j, -push)
        whole[:m] = np.clip(off(whole[:m] + moved[:m]), lowest, highest)
    return whole[:m]


def lattice_values(values: np.ndarray, at: np.ndarray, outside: float) -> np.ndarray:
    """(n,) values of a lattice at (n, 3) positions [nodes], linear between nodes; `outside` beyond the lattice."""
    from scipy.ndimage import map_coordinates

    return np.asarray(map_coordinates(values, at.T, order=1, cval=outside))
