"""A mesh smoothed by a low-pass filter for pictures: waves along it shorter than some dozen of its edges are removed,
as the terraces that layers of particles leave on slopes; longer ones stay (Taubin, Zhang & Golub 1996, ECCV '96:
Chebyshev polynomials of the graph's Laplacian)."""

from typing import Any

import numpy as np

from ocean_sim.surface import Mesh

# Angle acos(1 - k) of the eigenvalue k where a wave is halved; and how sharply the filter falls
PASS_BAND, FILTER_DEGREE = 0.30, 32
SIDE_TOLERANCE = 1.0e-4  # of the box: what is nearer to one of its sides lies on it
SPREAD_STEPS = 16  # edges from its rim to which what lies flat on a side goes with the rim


def smooth_mesh(mesh: Mesh, lower: tuple[float, ...], upper: tuple[float, ...], most: float) -> Mesh:
    """Smoothed copy of a mesh. No vertex moves more than `most` [m], so that drops and thin sheets stay; then all
    vertices move out or in by the thin layer that restores the volume.

    A surface that meets a side of the box from `lower` to `upper` [m] continues behind it as its mirror image, so that
    its rim slides along the side and is as smooth as the rest. Triangles flat on a side have vertices and normals of
    their own, for a sharp edge between both. Measure volumes on the original mesh."""
    n, corners = len(mesh.vertices), mesh.triangles
    if n == 0:
        return mesh
    x = mesh.vertices.astype(float)
    sides = points_on_sides(x, lower, upper)
    on = np.any(sides, axis=0)
    lies = np.all(sides[:, corners], axis=2)  # (2, m, 3) whether a triangle lies on the lower, on the upper side
    flat = lies.any(axis=(0, 2))
    curved = corners[~flat]
    adjacent = neighbour_weights(curved, on)
    degree = np.asarray(adjacent.sum(axis=1))[:, None]
    inner = degree == 0.0  # of a side
    held, degree = on | inner, np.maximum(degree, 1.0)
    x = level_rim(x, adjacent, held)
    weights = low_pass_weights(PASS_BAND, FILTER_DEGREE)
    before, now = x, np.where(held, x, adjacent @ x / degree)
    found = weights[0] * before + weights[1] * now
    for weight in weights[2:]:
        before, now = now, 2.0 * np.where(held, now, adjacent @ now / degree) - before
        found += weight * now
    way = found - x
    way *= np.minimum(1.0, most / np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1.0e-30))
    before, after = (vertex_areas(Mesh(each, corners, mesh.normals)) for each in (x, x + way))
    swept = (way * (before + after)).sum() / 6.0  # [m3]; a layer of this volume is taken off again
    out = np.where(held, 0.0, vertex_areas(Mesh(x + way, curved, mesh.normals)))
    areas = np.linalg.norm(out, axis=1, keepdims=True)
    x += way - out / np.maximum(areas, 1.0e-30) * swept * 3.0 / max(float(areas.sum()), 1.0e-30)
    if flat.any():
        beside = neighbour_weights(corners[flat], np.zeros_like(on))
        x = mesh.vertices + spread_ways(x - mesh.vertices, beside, on | ~inner)
    normals = np.where(on, 0.0, vertex_areas(Mesh(x, curved, mesh.normals)))
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.where(lengths > 0.0, normals / np.maximum(lengths, 1.0e-30), mesh.normals)
    smooth = Mesh(x.astype(mesh.vertices.dtype), corners, normals.astype(mesh.normals.dtype))
    return split_edges(smooth, flat, lies[1].astype(int) - lies[0]) if flat.any() else smooth


def neighbour_weights(corners: np.ndarray, on: np.ndarray) -> Any:
    """Sparse weights (n, n) of the neighbours of each vertex in triangles `corners` (m, 3): 1, and double for each side
    of the box on which the vertex lies (`on` (n, 3)) but not the neighbour, whose mirror image counts too."""
    from scipy.sparse import coo_array

    n = len(on)
    i, j = np.concatenate([corners[:, [a, b]].T for a, b in ((0, 1), (1, 0), (1, 2), (2, 1), (0, 2), (2, 0))], axis=1)
    found = coo_array((np.ones(len(i)), (i, j)), shape=(n, n)).tocsr().tocoo()
    weights = np.prod(np.where(on[found.row] & ~on[found.col], 2.0, 1.0), axis=1)
    return coo_array((weights, (found.row, found.col)), shape=(n, n)).tocsr()


def level_rim(x: np.ndarray, adjacent: Any, held: np.ndarray) -> np.ndarray:
    """Vertices (n, 3) [m] in which those on a side of the box take the mean of `adjacent` ones off it, unless `held`
    (n, 3): marching cubes end half a cell inside the side, and would leave them in steps."""
    beyond = adjacent > 1.0
    many = np.asarray(beyond.sum(axis=1))[:, None]
    return np.where(held | (many == 0), x, beyond @ x / np.maximum(many, 1))


def spread_ways(way: np.ndarray, adjacent: Any, held: np.ndarray) -> np.ndarray:
    """Displacements `way` (n, 3) [m], smoothed over SPREAD_STEPS edges to `adjacent` vertices except where `held` (n,
    3), so that the inside of a flat side follows its rim and no triangle folds over."""
    degree = np.maximum(np.asarray(adjacent.sum(axis=1)), 1.0)[:, None]
    for _ in range(SPREAD_STEPS):
        way = np.where(held, way, adjacent @ way / degree)
    return way


def split_edges(mesh: Mesh, flat: np.ndarray, facing: np.ndarray) -> Mesh:
    """Copy of a mesh whose `flat` triangles (m,) get vertices of their own, with normals `facing` (m, 3) along axes."""
    kinds, number = np.unique(facing[flat], axis=0, return_inverse=True)
    n, corners = len(mesh.vertices), mesh.triangles.copy()
    own, found = np.unique(number.reshape(-1, 1) * n + corners[flat], return_inverse=True)
    corners[flat] = n + found.reshape(-1, 3)
    normals = (kinds / np.linalg.norm(kinds, axis=1, keepdims=True))[own // n].astype(mesh.normals.dtype)
    vertices = np.concatenate([mesh.vertices, mesh.vertices[own % n]])
    return Mesh(vertices, corners, np.concatenate([mesh.normals, normals]))


def points_on_sides(x: np.ndarray, lower: tuple[float, ...], upper: tuple[float, ...]) -> np.ndarray:
    """Masks (2, n, 3): True for points (n, 3) on the lower and on the upper side of a box, along each axis."""
    low, up = np.array(lower), np.array(upper)
    return np.stack([x <= low + SIDE_TOLERANCE * (up - low), x >= up - SIDE_TOLERANCE * (up - low)])


def vertex_areas(mesh: Mesh) -> np.ndarray:
    """Outward area vectors (n, 3) [m2] at the vertices: sums over the triangles around each."""
    areas, across = np.zeros(mesh.vertices.shape), mesh.vector_areas
    for k in range(3):
        np.add.at(areas, mesh.triangles[:, k], across)
    return areas


def low_pass_weights(edge: float, degree: int) -> np.ndarray:
    """Weights (degree + 1,) of Chebyshev polynomials T_n(cos t) of a low-pass filter, which passes 1 at t = 0, a half
    at `edge`, and 0 beyond. They are the Fourier series of a step under von Hann's window."""
    n = np.arange(1, degree + 1)
    window = 0.5 + 0.5 * np.cos(np.pi * n / (degree + 1.0))
    weights = np.concatenate([[edge / np.pi], 2.0 * np.sin(n * edge) / (np.pi * n) * window])
    return weights / weights.sum()
