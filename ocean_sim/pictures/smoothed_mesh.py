"""A mesh smoothed for pictures, without the shrinking of a plain average (Taubin 1995, SIGGRAPH '95)."""

import numpy as np

from ocean_sim.surface import Mesh

INWARD, PASS_BAND = 0.5, 0.012  # lambda, and k_PB = 1 / lambda + 1 / mu
NEAR = 1.0e-4  # of the box: what is nearer to one of its sides lies on it


def smoothed(mesh: Mesh, lower: tuple[float, ...], upper: tuple[float, ...], passes: int = 60) -> Mesh:
    """Every pass moves the vertices towards their neighbours' mean and back out again, a little further.

    Vertices on the sides of the box from `lower` to `upper` [m] stay on them. Measure the mesh as it was.
    """
    from scipy.sparse import coo_matrix

    n, corners = len(mesh.vertices), mesh.triangles
    if n == 0:
        return mesh
    i, j = (np.concatenate([corners[:, [a, b]], corners[:, [b, a]]]).T for a, b in ((0, 1), (1, 2)))
    i, j = np.concatenate([i, j, corners[:, [0, 2]].T, corners[:, [2, 0]].T], axis=1)
    adjacent = coo_matrix((np.ones(len(i)), (i, j)), shape=(n, n)).tocsr()
    adjacent.data[:] = 1.0
    degree = np.maximum(adjacent.getnnz(axis=1), 1)[:, None]
    low, up, x = np.array(lower), np.array(upper), mesh.vertices.astype(float)
    free = (x > low + NEAR * (up - low)) & (x < up - NEAR * (up - low))
    outward = 1.0 / (PASS_BAND - 1.0 / INWARD)
    for _ in range(passes):
        for weight in (INWARD, outward):
            x = x + weight * free * (adjacent @ x / degree - x)
    moved = Mesh(x, corners, mesh.normals)
    normals, across = np.zeros_like(x), moved.vector_areas
    for k in range(3):
        np.add.at(normals, corners[:, k], across)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.where(lengths > 0.0, normals / np.maximum(lengths, 1.0e-30), mesh.normals)
    return Mesh(x.astype(mesh.vertices.dtype), corners, normals.astype(mesh.normals.dtype))
