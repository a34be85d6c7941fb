"""Signed distance from a hull, and the share of a smoothed hull, on a lattice around it; computed once from its cubes
and kept with them."""

import numpy as np

from ocean_sim.basin.solids.shape import SolidShape
from ocean_sim.basin.solids.voxels import voxels
from ocean_sim.files.cache_file import cached_arrays
from ocean_sim.kernel_library import ti, tm, to_numpy_type
from ocean_sim.runtime import in_kernels

USUAL_CUBES = 3e5  # cubes of a lattice; a long hull in fine water has coarser ones
MAX_LATTICE_NODES = 1e7  # around a hull far smaller than a spacing, whose cubes are as small as the hull
SMOOTHING_CUBES = 0.5  # [cubes] over which steps of cubes are smoothed


def lattice_shape(shape: SolidShape, side: float, reach: float) -> tuple[float, np.ndarray, np.ndarray]:
    """Side of a cube [m], sides (3,) [m] of cubes that fill the hull's box, and cubes (3,) beyond it for `reach`."""
    lower, upper = shape.bounds()
    side = max(side, float((upper - lower + 2.0 * reach).prod() / USUAL_CUBES) ** (1.0 / 3.0))
    size = (upper - lower) / np.maximum(1, np.ceil((upper - lower) / side - 1e-6))
    return side, size, np.ceil(reach / size).astype(int) + 1


def lattice_memory(shape: SolidShape, side: float, reach: float, word: int) -> tuple[int, int]:
    """Number of nodes of the lattice of `lattice_shape`, and their memory [bytes] with floats of `word` bytes."""
    _, size, margin = lattice_shape(shape, side, reach)
    lower, upper = shape.bounds()
    n = int((np.round((upper - lower) / size) + 2 * margin).prod())
    return n, 2 * word * n


def distance_lattice(
    shape: SolidShape, side: float, support: float, reach: float
) -> tuple[dict[str, np.ndarray], np.ndarray, np.ndarray]:
    """Lattice around a hull: `distance` [m] of nodes (i, j, k) from it, negative inside, and `share` of the hull,
    smoothed by Wendland's kernel (C2) of this support [m]; first node (3,) in the hull's axes, and steps (3,) [m]."""
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
        """`centre` of mass from the origin, `side` of cubes, `support` of the kernel, `reach` over the hull [m]."""
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
        """Outward normal, distance [m] (the reach beyond the lattice), -grad share [1/m] at a position [m]."""
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
