"""A mesh smoothed for pictures as a signal is: waves along it that are shorter than some dozen of its edges, as the
terraces that layers of particles leave on slopes, are taken out, longer ones are left as they are (Taubin, Zhang &
Golub 1996, ECCV '96: low-pass filters of Chebyshev polynomials of the graph's Laplacian)."""

import numpy as np

from ocean_sim.surface import Mesh

PASS_BAND, DEGREE = 0.30, 32  # acos(1 - k) of the eigenvalue k where a wave is halved; and how sharply the filter falls
NEAR = 1.0e-4  # of the box: what is nearer to one of its sides lies on it


def smoothed(mesh: Mesh, lower: tuple[float, ...], upper: tuple[float, ...], most: float) -> Mesh:
    """The same triangles with vertices that lie smoothly, none more than `most` [m] from where it was, so that drops
    and thin sheets are left; then all of it by the thin layer that keeps its volume.

    Vertices on the sides of the box from `lower` to `upper` [m] stay on them, and what is flat there does not pull at
    its rim. Measure the mesh as it was.
    """
    from scipy.sparse import coo_matrix

    n, corners = len(mesh.vertices), mesh.triangles
    if n == 0:
        return mesh
    low, up, x = np.array(lower), np.array(upper), mesh.vertices.astype(float)
    sides = np.stack([x <= low + NEAR * (up - low), x >= up - NEAR * (up - low)])
    flat = np.any(np.all(sides[:, corners], axis=2), axis=(0, 2))  # triangles that lie on a side
    curved = corners[~flat]
    i, j = np.concatenate([curved[:, [a, b]].T for a, b in ((0, 1), (1, 0), (1, 2), (2, 1), (0, 2), (2, 0))], axis=1)
    adjacent = coo_matrix((np.ones(len(i)), (i, j)), shape=(n, n)).tocsr()
    adjacent.data[:] = 1.0
    degree = adjacent.getnnz(axis=1)[:, None]
    free, degree = ~sides.any(axis=0) & (degree > 0), np.maximum(degree, 1)
    weights = low_pass(PASS_BAND, DEGREE)
    before, now = x, np.where(free, adjacent @ x / degree, x)
    found = weights[0] * before + weights[1] * now
    for weight in weights[2:]:
        before, now = now, 2.0 * np.where(free, adjacent @ now / degree, now) - before
        found += weight * now
    way = found - x
    way *= np.minimum(1.0, most / np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1.0e-30))
    before, after = (gathered(Mesh(each, corners, mesh.normals)) for each in (x, x + way))
    swept = (way * (before + after)).sum() / 6.0  # [m3]; a layer of this volume is taken off again
    areas = np.linalg.norm(after * free, axis=1, keepdims=True)
    x = x + way - free * after / np.maximum(areas, 1.0e-30) * swept * 3.0 / max(float(areas.sum()), 1.0e-30)
    normals = gathered(Mesh(x, corners, mesh.normals))
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.where(lengths > 0.0, normals / np.maximum(lengths, 1.0e-30), mesh.normals)
    return Mesh(x.astype(mesh.vertices.dtype), corners, normals.astype(mesh.normals.dtype))


def gathered(mesh: Mesh) -> np.ndarray:
    """(n, 3) vector areas [m2] of the triangles around each vertex, outwards."""
    areas, across = np.zeros(mesh.vertices.shape), mesh.vector_areas
    for k in range(3):
        np.add.at(areas, mesh.triangles[:, k], across)
    return areas


def low_pass(edge: float, degree: int) -> np.ndarray:
    """(degree + 1,) weights of the Chebyshev polynomials T_n(cos t) whose sum is 1 at t = 0, a half at `edge` and
    nothing beyond: the Fourier series of a step under von Hann's window."""
    n = np.arange(1, degree + 1)
    window = 0.5 + 0.5 * np.cos(np.pi * n / (degree + 1.0))
    weights = np.concatenate([[edge / np.pi], 2.0 * np.sin(n * edge) / (np.pi * n) * window])
    return weights / weights.sum()
