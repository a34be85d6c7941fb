"""Room that solid bodies keep free of particles, and samples of their inside near the water."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np

from ocean_sim.basin.motion import Gate
from ocean_sim.basin.solids.mesh import ClosedMesh, inside_stretches
from ocean_sim.basin.solids.packing import Lattice, cached_room, deepest_first, fit_particles
from ocean_sim.basin.solids.shape import Boxes, PlacedMesh, SolidShape
from ocean_sim.basin.solids.voxels import MAX_CUBES, Distance, Voxels, distance_lattice, lattice_memory, voxels

CUBES_A_SPACING = 3.0  # cubes to a spacing of the particles, where a body keeps water out
FOOT_ROUNDING = 1e-6  # of twice the height of a mesh by which its foot may lie above a dry bed
UNBOUNDED_BOX = [(np.full(3, -np.inf), np.full(3, np.inf))]  # a box without bounds


@dataclass(frozen=True, eq=False)
class ShapedSolid:
    """Solid body given by a shape and its pose at time 0; in 2-D a section of the shape."""

    shape: SolidShape
    centre: np.ndarray  # (3,) of the body from the shape's origin [m]
    origin: np.ndarray  # (3,) where the centre is [m]
    turn: np.ndarray  # (3, 3) rotation, body to world
    flat: bool
    is_sampled: bool = True  # by the laws of the water

    @property
    def dimension(self) -> int:
        """2 for a section in a 2-D basin, else 3."""
        return 2 if self.flat else 3

    @cached_property
    def extent(self) -> np.ndarray:
        corners = np.array(list(product(*np.transpose(self.shape.bounds()))))
        placed = (corners - self.centre) @ self.turn.T + self.origin
        return np.stack([placed.min(axis=0), placed.max(axis=0)])

    def make_room(
        self, positions: np.ndarray, beyond: np.ndarray, boxes: Boxes, lattice: Lattice
    ) -> tuple[np.ndarray, np.ndarray]:
        """Make room for the body among particles at `positions` (n, 3) [m] that fill `boxes`; points `beyond` (m, 3)
        [m] continue their lattice outside. Returns (n,) True for particles to remove, new positions (n, 3) [m]."""
        poses = [self.centre, self.origin, self.turn, *(corner for box in boxes for corner in box)]
        numbers = repr([lattice, self.is_sampled, self.flat, *(array.tolist() for array in poses)]).encode()
        content = self.shape.content() + numbers + positions.tobytes() + beyond.tobytes()

        def made() -> dict[str, np.ndarray]:
            return self.room_arrays(positions, beyond, boxes, lattice)

        return cached_room(positions, content, made, type(self), type(self.shape))

    def room_arrays(
        self, positions: np.ndarray, beyond: np.ndarray, boxes: Boxes, lattice: Lattice
    ) -> dict[str, np.ndarray]:
        """Indices of particles at `positions` (n, 3) [m] in `boxes` that this body displaces (`gone`) and that move
        around it (`near`), and positions [m] of these (`moved`) at which an even pressure pushes none (particle
        packing, Colagrossi et al. 2012). Points `beyond` (m, 3) [m] continue the lattice outside `boxes`."""
        points, spacing = np.concatenate([positions, beyond]), lattice.spacing
        water = np.arange(len(points)) < len(positions)
        # To a thousandth of a spacing, since minimisation would make rounding of a pose a hundred times as large.
        origin = np.round(self.origin / spacing, 3) * spacing
        _, order = self.deepest_first((points - origin) @ self.turn + self.centre, spacing)
        wet, whole = (self.displaced_volume(spacing, within) / lattice.volume for within in (boxes, UNBOUNDED_BOX))
        gone = np.zeros(len(points), dtype=bool)
        for there, count in ((water, wet), (~water, whole - wet)):
            gone[order[there[order]][: round(count)]] = True
        at, volumes, _ = self.samples(spacing, lattice.support * spacing)
        return fit_particles(points, water, gone, (at @ self.turn.T + origin, volumes), lattice, self.dimension)

    def deepest_first(self, own: np.ndarray, spacing: float) -> tuple[np.ndarray, np.ndarray]:
        """(n,) distances [m] from the body of points `own` (n, 3) [m] in its axes; their indices, deepest first."""
        distance = self.distances(own, spacing)
        return distance, deepest_first(distance, spacing)

    def lattice(self, spacing: float) -> tuple[dict[str, np.ndarray], np.ndarray, np.ndarray]:
        """Lattice around the body, to two spacings [m] beyond it: for each node `distance` [m], signed, and `share` of
        the body, smoothed; first node (3,) in the body's axes, and steps (3,) [m]."""
        return distance_lattice(self.shape, spacing / CUBES_A_SPACING, spacing, 2.0 * spacing)

    def distances(self, own: np.ndarray, spacing: float) -> np.ndarray:
        """(n,) distances from the body [m], negative inside, of points `own` (n, 3) in its axes; 2 spacings at most."""
        values, first, step = self.lattice(spacing)
        if self.flat:
            own[:, 2] = first[2] + 0.5 * step[2] * (values["distance"].shape[2] - 1)
        return lattice_values(values["distance"], (own - first) / step, 2.0 * spacing)

    def displaced_volume(self, spacing: float, boxes: Boxes) -> float:
        """Volume of the body inside `boxes` [m3], in 2-D its area [m2], by cubes finer than a `spacing` [m]."""
        least = (float(np.subtract(*self.shape.bounds()[::-1]).prod()) / MAX_CUBES) ** (1.0 / 3.0)
        cubes = voxels(self.shape, max(spacing / CUBES_A_SPACING, 1.01 * least), 1.0)
        positions, tall = (cubes.centre - self.centre) @ self.turn.T + self.origin, cubes.height_spread(self.turn[1])
        found, across, met = 0.0, [0] if self.flat else [0, 2], self.body_cubes(cubes)
        for low, up in boxes:
            inside = ((positions >= low) & (positions < up))[:, across].all(axis=1) & (positions[:, 1] > low[1]) & met
            found += float((cubes.share * inside * np.clip((up[1] - positions[:, 1]) / tall + 0.5, 0.0, 1.0)).sum())
        return found * float(cubes.size[: self.dimension].prod())

    def body_cubes(self, cubes: Voxels) -> np.ndarray:
        """(n,) True for cubes of the body that are in the basin: all in 3-D; in 2-D one layer, the section."""
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
        values, first, step = self.lattice(spacing)
        at, slopes = (position[sampled] + self.centre - first) / step, np.gradient(values["distance"], *step)
        across = np.diag([1.0, 1.0, 0.0 if self.flat else 1.0])
        return position[sampled], volume[sampled], face_normals(slopes, at, across)


@dataclass(frozen=True, eq=False)
class MeshSolid(ShapedSolid):
    """A mesh in the water of a basin, as it stands at time 0; in 2-D a prism on its section."""

    shape: PlacedMesh
    gate: Gate | None = None  # how it moves, where that is given

    @property
    def mesh(self) -> ClosedMesh:
        """The mesh in the axes of the basin [m]."""
        return self.shape.mesh

    def problem(self, spacing: float) -> str:
        """Fault of a mesh too thin or too large for particles a `spacing` [m] apart; empty if there is none."""
        thin, many = self.mesh.mean_thickness / spacing, float(np.prod(self.mesh.size / spacing))
        if thin >= 1.0 / CUBES_A_SPACING and many <= MAX_CUBES:
            return ""
        size = f"the mesh is {thin:.2g} spacings thick, its box {many:.3g} particles large (is its `unit` right?)"
        return f"{size}; a body has {1.0 / CUBES_A_SPACING:.2g} spacings at least and {MAX_CUBES:.3g} particles at most"

    def net(self, spacing: float) -> Distance:
        """Field of the signed distance from the mesh, off which kernels bounce particles a `spacing` [m] apart."""
        return Distance(self.shape, self.centre, spacing / CUBES_A_SPACING, spacing, 2.0 * spacing)

    def net_bytes(self, spacing: float, word: int) -> int:
        """Memory [bytes] of `net` at a particle `spacing` [m], with floats of `word` bytes."""
        return lattice_memory(self.shape, spacing / CUBES_A_SPACING, 2.0 * spacing, word)[1]

    def tops_below(self, points: np.ndarray) -> np.ndarray:
        """(n,) top [m] of the body on the vertical line through each point (n, 3) [m]: of the highest segment of this
        line inside the body that begins below the point; -inf without one."""
        (x, i), (z, k) = (np.unique(points[:, axis], return_inverse=True) for axis in (0, 2))
        line, foot, top = inside_stretches(self.mesh.triangles, x, z)
        low, up = (bound[1] for bound in self.mesh.bounds)
        # Lines and heights in one rising number; heights in the body take at most a half of it.
        begins, here = (0.5 * (np.minimum(y, up) - low) / (up - low) for y in (foot, points[:, 1]))
        own = i * len(z) + k
        at = np.searchsorted(line + begins - FOOT_ROUNDING, own + here, "right") - 1
        return np.where(np.append(line, -1)[at] == own, np.append(top, -np.inf)[at], -np.inf)


def face_normals(slopes: Sequence[np.ndarray], at: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """(n, 3) outward unit normals at positions `at` (n, 3), in lattice steps, by the `slopes` of the distance along
    each axis of the lattice; `turn`: (3, 3) matrix applied to them."""
    from scipy.ndimage import map_coordinates

    found = np.stack([map_coordinates(slope, at.T, order=1, mode="nearest") for slope in slopes], axis=1) @ turn
    return np.asarray(found / np.maximum(np.linalg.norm(found, axis=1, keepdims=True), 1e-12))


def lattice_values(values: np.ndarray, at: np.ndarray, outside: float) -> np.ndarray:
    """(n,) values at `at` (n, 3), in lattice steps, interpolated linearly; `outside` beyond the lattice."""
    from scipy.ndimage import map_coordinates

    return np.asarray(map_coordinates(values, at.T, order=1, cval=outside))
