"""A hull as cubes, each with the share of it that lies inside the hull, and the signed distance from it on a lattice
around; computed once and cached on disk by content.

Cubes are as tall as asked for, and up to MAX_FLATNESS times as long and broad where a hull has plenty of them that way:
the water clips their height. Whole cubes fill the box around the hull.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import sqrt

import numpy as np

from ocean_sim.basin.solids.mesh import column_shares
from ocean_sim.basin.solids.shape import SolidShape
from ocean_sim.files.cache_file import cached_arrays
from ocean_sim.kernel_library import ti, tm, to_numpy_type
from ocean_sim.runtime import in_kernels

EDGE_SAMPLES = 4  # along each edge of a cube
SAMPLES_OF_MESH = (EDGE_SAMPLES, 8, 16)  # across and along a cube of a mesh: more where fewer miss it
MISSED_SHARE = 0.02  # of the volume of a mesh
MAX_CUBES = 4_000_000  # cubes
MAX_FLATNESS = 3.0  # the most that a cube is longer and broader than tall
SUFFICIENT_CUBES = np.array([14, 1e9, 24])  # across and along a hull, which leave no error that the height does not
COLUMN_OFFSET = 1.0e-4  # of a cube: columns do not run through the edges of a mesh that was drawn on a lattice
USUAL_CUBES = 3e5  # cubes of a lattice; a long hull in fine water has coarser ones
MAX_LATTICE_NODES = 1e7  # around a hull far smaller than a spacing, whose cubes are as small as the hull
SMOOTHING_CUBES = 0.5  # [cubes] over which steps of cubes are smoothed


@dataclass(frozen=True, eq=False)
class Voxels:
    """Cubes wholly or partly inside a hull, in the hull's axes: centre, share inside, and hull area of each."""

    lower: np.ndarray  # (3,) corner of the box that they fill [m]
    size: np.ndarray  # (3,) of each [m]
    centre: np.ndarray  # (n, 3) of the part of each that lies inside [m]
    share: np.ndarray  # (n,) inside the hull
    area: np.ndarray  # (n, 3) outward area of the hull in each [m2]

    @cached_property
    def cells(self) -> np.ndarray:
        """(n, 3) index of each cube along each axis."""
        return np.floor((self.centre - self.lower) / self.size).astype(int)

    @cached_property
    def volume(self) -> float:
        """Volume of the hull [m3]."""
        return float(self.share.sum() * self.size.prod())

    def centre_heights(self, up: np.ndarray) -> np.ndarray:
        """(n,) height of each cube's centre along a unit vector `up` [m]; not threaded, to be reproducible."""
        return up[0] * self.centre[:, 0] + up[1] * self.centre[:, 1] + up[2] * self.centre[:, 2]

    def height_spread(self, up: np.ndarray) -> float:
        """Height [m] of a level layer with the variance of heights that a cube has along a unit vector `up`."""
        return float(np.linalg.norm(self.size * up))

    def cut_offset(self, turn: Sequence[Sequence[float]], cut: float) -> tuple[float, float]:
        """First moment [m4] along the world's x and z of the wet parts of cubes cut by the water surface, about their
        centres; `turn`: rotation from hull to world; `cut`: volume of these cubes [m3]."""
        a, b, c = (square * up for square, up in zip(self.size_squared, turn[1]))
        x, square_of_spread, z = (row[0] * a + row[1] * b + row[2] * c for row in turn)
        share = -cut / (12.0 * sqrt(square_of_spread))
        return share * x, share * z

    @cached_property
    def size_squared(self) -> tuple[float, float, float]:
        """Squares of the sides of a cube along each axis [m2]."""
        x, y, z = (self.size**2).tolist()
        return x, y, z

    @cached_property
    def centroid(self) -> np.ndarray:
        """(3,) centroid of the hull [m]."""
        return (self.share[:, None] * self.centre).sum(axis=0) / self.share.sum()

    def inertia(self, mass: float, about: np.ndarray) -> np.ndarray:
        """(3, 3) inertia [kg m2] of a homogeneous hull of a mass [kg] about a point, by parallel axes (thesis 4.18)."""
        m = mass * self.share / self.share.sum()
        r = self.centre - about
        own = mass * np.diag(self.size**2) / 12.0  # spread of each cube
        moments = np.stack([(m * r[:, a])[:, None] * r for a in range(3)]).sum(axis=1) + own
        return np.trace(moments) * np.eye(3) - moments


def voxels(shape: SolidShape, side: float, flat: float = MAX_FLATNESS) -> Voxels:
    """Cubes of a shape, `side` [m] tall and up to `flat` times as long; raises ValueError if they are too many."""
    lower, upper = shape.bounds()
    sides = np.clip((upper - lower) / SUFFICIENT_CUBES, side, flat * side)
    counts = np.maximum(1, np.ceil((upper - lower) / sides - 1e-6).astype(int))
    if counts.prod() > MAX_CUBES:
        begin = f"a hull of {' x '.join(f'{x:.3g}' for x in upper - lower)} m in cubes of {side:.3g} m needs"
        raise ValueError(f"{begin} {counts.prod():.3g} of them (at most {MAX_CUBES:g}); take fewer cells_per_draught")
    content = shape.content() + f"{counts.tolist()}".encode()
    size = (upper - lower) / counts

    def made() -> dict[str, np.ndarray]:
        mesh = shape.closed_mesh()
        for samples in SAMPLES_OF_MESH:
            arrays = sample_cubes(shape, counts, lower, upper, samples)
            if mesh is None or abs(arrays["share"].sum() * size.prod() / mesh.volume - 1.0) <= MISSED_SHARE:
                break
        return arrays

    arrays = cached_arrays("hulls", content, made, type(shape))
    return Voxels(lower, size, arrays["centre"], arrays["share"], arrays["area"])


def sample_cubes(
    shape: SolidShape, counts: np.ndarray, lower: np.ndarray, upper: np.ndarray, samples: int
) -> dict[str, np.ndarray]:
    """Arrays `share`, `centre` [m] and outward `area` [m2], for Voxels, of those of `counts` (3,) cubes from `lower` to
    `upper` [m] that are not empty; `samples`: sampled columns along each horizontal side of a cube."""
    size = (upper - lower) / counts
    per_cube = (samples, EDGE_SAMPLES, samples)
    axes = [lower[a] + size[a] * (np.arange(counts[a] * per_cube[a]) + 0.5) / per_cube[a] for a in range(3)]
    share, centre = np.zeros(counts), np.zeros((*counts, 3))
    mesh = shape.closed_mesh()
    for k in range(counts[2]):
        z = axes[2][k * samples : (k + 1) * samples]
        if mesh is None:
            inside = shape.fill_lattice(axes[0], axes[1], z).astype(float)
        else:
            edges = lower[1] + size[1] * np.arange(counts[1] * EDGE_SAMPLES + 1) / EDGE_SAMPLES
            x, across = axes[0] + COLUMN_OFFSET * size[0], z + 0.7 * COLUMN_OFFSET * size[2]
            inside = column_shares(mesh.triangles, x, across, edges)
        blocks = inside.reshape(counts[0], samples, counts[1], EDGE_SAMPLES, 1, samples)
        share[:, :, k] = blocks.mean(axis=(1, 3, 4, 5))
        for a, position in enumerate(np.ix_(axes[0], axes[1], z)):
            centre[:, :, k, a] = (inside * position).reshape(blocks.shape).mean(axis=(1, 3, 4, 5))
    full = share > 1e-9
    steps = [np.diff(share, axis=a, prepend=0.0, append=0.0).swapaxes(0, a) for a in range(3)]
    bare = [np.maximum(-step[1:], 0.0) - np.maximum(step[:-1], 0.0) for step in steps]  # ahead less behind
    area = size.prod() / size * np.stack([each.swapaxes(0, a) for a, each in enumerate(bare)], axis=-1)
    return {"share": share[full], "centre": centre[full] / share[full][:, None], "area": area[full]}


def lattice_shape(shape: SolidShape, side: float, reach: float) -> tuple[float, np.ndarray, np.ndarray]:
    """Lattice of cubes that covers a shape and `reach` [m] beyond: greatest side [m] (`side`, or more lest cubes be too
    many); (3,) sides [m], which divide the shape's box evenly; (3,) numbers of cubes beyond each end of that box."""
    lower, upper = shape.bounds()
    side = max(side, float((upper - lower + 2.0 * reach).prod() / USUAL_CUBES) ** (1.0 / 3.0))
    size = (upper - lower) / np.maximum(1, np.ceil((upper - lower) / side - 1e-6))
    return side, size, np.ceil(reach / size).astype(int) + 1


def lattice_memory(shape: SolidShape, side: float, reach: float, word: int) -> tuple[int, int]:
    """Number of nodes, and their memory [bytes] with floats of `word` bytes, of a lattice of cubes of `side` [m] that
    covers a shape and `reach` [m] beyond (`lattice_shape`)."""
    _, size, margin = lattice_shape(shape, side, reach)
    lower, upper = shape.bounds()
    n = int((np.round((upper - lower) / size) + 2 * margin).prod())
    return n, 2 * word * n


def distance_lattice(
    shape: SolidShape, side: float, support: float, reach: float
) -> tuple[dict[str, np.ndarray], np.ndarray, np.ndarray]:
    """Lattice around a hull: `distance` [m] from it of each node, negative inside, and `share`, 1 in the hull and 0
    outside, smoothed by Wendland's kernel (C2) of this support [m]; then first node (3,) in the hull's axes, and steps
    (3,) [m]. `side`: of the cubes; `reach`: of the lattice beyond the hull [m]."""
    lower, upper = shape.bounds()
    side, size, margin = lattice_shape(shape, side, reach)
    cubes = voxels(shape, side, 1.0)

    def made() -> dict[str, np.ndarray]:
        from scipy.ndimage import distance_transform_edt, gaussian_filter
        from scipy.signal import fftconvolve

        counts = np.round((upper - lower) / size).astype(int)
        full = np.zeros(counts + 2 * margin, dtype=bool)
        where = cubes.cells[cubes.share > 0.5]
        full[tuple((where + margin).T)] = True
        # A face lies half way between the middles of a full cube and of an empty one.
        half = 0.5 * size.mean()
        outside = distance_transform_edt(~full, sampling=size) - half
        inside = distance_transform_edt(full, sampling=size) - half
        distance = gaussian_filter(np.where(full, -inside, outside), SMOOTHING_CUBES, mode="nearest")
        solid = np.zeros(full.shape)
        solid[tuple((cubes.cells + margin).T)] = cubes.share
        along = (np.arange(-margin[k], margin[k] + 1) * size[k] for k in range(3))
        q = np.minimum(np.sqrt(sum(np.square(x) for x in np.meshgrid(*along, indexing="ij"))) / support, 1.0)
        kernel = (1.0 - q) ** 4 * (1.0 + 4.0 * q)
        share = fftconvolve(solid, kernel / kernel.sum(), mode="same")
        return {"distance": distance, "share": share}

    content = shape.content() + f"{size.tolist()} {margin.tolist()} {support}".encode()
    return cached_arrays("distances", content, made, type(shape)), lower + (0.5 - margin) * size, size


@in_kernels
class Distance:
    """Signed distance from a hull and its outward normal, for kernels, in body axes from the centre of mass."""

    def __init__(self, shape: SolidShape, centre: np.ndarray, side: float, support: float, reach: float) -> None:
        """`centre` of mass from the origin; `side` of cubes, `support` of the kernel, `reach` beyond the hull [m]."""
        values, first, step = distance_lattice(shape, side, support, reach)
        size = values["share"].shape
        self.lower = first - centre  # [m]
        self.upper = self.lower + (np.array(size) - 1) * step
        self.first, self.per_step, self.last = tm.vec3(self.lower), tm.vec3(1.0 / step), tm.ivec3(size) - 2
        self.nodes = ti.Vector.field(2, float, shape=size)  # distance [m] and share
        both = np.stack([values["distance"], values["share"]], axis=-1)
        self.nodes.from_numpy(both.astype(to_numpy_type(self.nodes.dtype)))
        self.far = float(reach)

    @ti.func
    def at(self, position):
        """Outward normal, signed distance [m] (`reach` off the lattice), and minus the gradient [1/m] of the share of
        the hull, 1 in it and 0 outside, smoothed by the kernel, at a position [m]."""
        a = (position - self.first) * self.per_step
        c = tm.clamp(int(ti.floor(a)), 0, self.last)
        normal, distance, thinning = tm.vec3(0.0), self.far, tm.vec3(0.0)
        if (a >= 0.0).all() and (a <= self.last + 1).all():
            f = a - c
            shares, distance = (1.0 - f, f), 0.0
            for i, j, k in ti.static(ti.ndrange(2, 2, 2)):
                x, y, z = shares[i].x, shares[j].y, shares[k].z
                here = self.nodes[c.x + i, c.y + j, c.z + k]
                rise = tm.vec3((2 * i - 1) * y * z, (2 * j - 1) * x * z, (2 * k - 1) * x * y)
                distance += x * y * z * here[0]
                normal += here[0] * rise
                thinning -= here[1] * rise
            normal *= self.per_step
            normal /= tm.max(normal.norm(), 1e-6)
            thinning *= self.per_step
        return normal, distance, thinning
