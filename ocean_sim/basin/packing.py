"""Packing of particles around solid bodies, so that an even pressure pushes none (Colagrossi et al. 2012, Comput. Phys.
Commun. 183)."""

import numpy as np

FIT_REACH = 4.0  # [spacings] from a body within which particles move for it
FIT_ITERATIONS = 200  # at most


def fit_particles(
    points: np.ndarray,
    water: np.ndarray,
    gone: np.ndarray,
    body: np.ndarray,
    spacing: float,
    dimension: int,
    support: float,
    held: np.ndarray | None = None,
) -> dict[str, np.ndarray]:
    """Make room for a body among `points` (n, 3) [m]: indices of particles `gone` and `near` it, and positions [m] of
    the latter, `moved` to minimise a kernel's sum over particles and samples.

    `water`: (n,) True for particles, False for points that only continue their lattice; `gone`: (n,) True for points
    that the body displaces; `body` (m, 4): positions of its samples [m], and their weights in particles; `support` of
    the kernel [spacings]; `held`: (n,) True for points that stay, or None.
    """
    near = near_to(points, body[:, :3], FIT_REACH * spacing)
    if held is not None:
        near &= ~held
    free, rest = near & ~gone, near_to(points, body[:, :3], (FIT_REACH + support + 1.0) * spacing) & ~near
    if (free & water).any():
        fixed = np.concatenate([np.insert(points[rest & ~gone], 3, 1.0, axis=1), body])
        points[free] = even_out(points[free], fixed, spacing, dimension, support)
    moved = np.flatnonzero(free & water)
    return {"gone": np.flatnonzero(gone & water), "near": moved, "moved": points[moved]}


def near_to(points: np.ndarray, others: np.ndarray, reach: float) -> np.ndarray:
    """(n,) True for `points` (n, 3) [m] nearer than `reach` [m] to any of `others` (m, 3) [m]."""
    from scipy.spatial import cKDTree

    return np.asarray(cKDTree(others).query(points, distance_upper_bound=reach)[0] < reach)


def even_out(free: np.ndarray, fixed: np.ndarray, spacing: float, dimension: int, support: float) -> np.ndarray:
    """(n, 3) positions near `free` for the smallest sum of Wendland's kernel (C2) over all pairs; `fixed` (m, 4):
    positions of points that stay, and their weights in points; `spacing` [m]: the unit of the
    kernel's `support`."""
    from scipy.optimize import minimize
    from scipy.spatial import cKDTree

    n, tree = len(free), cKDTree(fixed[:, :3])

    def summed(flat: np.ndarray) -> tuple[float, np.ndarray]:
        """Kernel sum over all pairs, and its gradient by the coordinates `flat` (n * dimension,) [spacings]."""
        points = free.copy()
        points[:, :dimension] = spacing * flat.reshape(n, dimension)
        moving = cKDTree(points)
        pairs = moving.query_pairs(support * spacing, output_type="ndarray")
        met = moving.sparse_distance_matrix(tree, support * spacing, output_type="ndarray")
        total, slope = 0.0, np.zeros((n, dimension))
        for i, j, others, weight, back in (
            (pairs[:, 0], pairs[:, 1], points, 1.0, True),
            (met["i"], met["j"], fixed[:, :3], fixed[met["j"], 3], False),
        ):
            apart = (points[i] - others[j])[:, :dimension] / spacing
            q = np.minimum(np.linalg.norm(apart, axis=1) / support, 1.0)
            total += float((weight * (1.0 - q) ** 4 * (1.0 + 4.0 * q)).sum())
            rise = (-20.0 / support**2 * weight * (1.0 - q) ** 3)[:, None] * apart
            for k in range(dimension):
                slope[:, k] += np.bincount(i, rise[:, k], n)
                if back:
                    slope[:, k] -= np.bincount(j, rise[:, k], n)
        return total, slope.ravel()

    start = (free[:, :dimension] / spacing).ravel()
    found = minimize(summed, start, jac=True, method="L-BFGS-B", options={"maxiter": FIT_ITERATIONS})
    moved = free.copy()
    moved[:, :dimension] = spacing * found.x.reshape(n, dimension)
    return moved
