"""Packing of particles around solid bodies, so that an even pressure pushes none (Colagrossi et al. 2012, Comput. Phys.
Commun. 183)."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

FIT_REACH = 4.0  # [spacings] from a body within which particles move for it
FIT_ITERATIONS = 100  # at most


class Kernel(Protocol):
    """Interface of the kernel by which particles are packed: that of the water's pressure."""

    def value(self, t: np.ndarray) -> np.ndarray:
        """Shape of the kernel at t (n,) = 1 - r/support."""

    def gradient(self, t: np.ndarray) -> np.ndarray:
        """Shape of its gradient, grad W over -x/support^2."""


@dataclass(frozen=True)
class Lattice:
    """Lattice of particles that makes room for bodies, and the kernels by which they are packed, one after the other:
    one that keeps them apart, and that of the water's pressure."""

    spacing: float  # [m]
    volume: float  # of a particle [m3], in 2-D its area [m2]
    kernels: tuple[tuple[Kernel, float], ...]  # and the support of each [spacings]


def fit_particles(
    points: np.ndarray,
    water: np.ndarray,
    gone: np.ndarray,
    samples: tuple[np.ndarray, np.ndarray],
    lattice: Lattice,
    dimension: int,
    held: np.ndarray | None = None,
) -> dict[str, np.ndarray]:
    """Make room for a body among `points` (n, 3) [m]: indices of particles `gone` and `near` it, and positions [m] of
    the latter, `moved` to minimise each kernel's sum over particles and samples.

    `water`: (n,) True for particles, False for points that only continue their lattice; `gone`: (n,) True for points
    that the body displaces; `samples`: positions (m, 3) [m] and volumes (m,) [m3] of those of the body; `held`: (n,)
    True for points that stay, or None.
    """
    at, weight, spacing = samples[0], samples[1] / lattice.volume, lattice.spacing
    near = near_to(points, at, FIT_REACH * spacing)
    if held is not None:
        near &= ~held
    widest = max(support for _, support in lattice.kernels)
    free, rest = near & ~gone, near_to(points, at, (FIT_REACH + widest + 1.0) * spacing) & ~near & ~gone
    if (free & water).any():
        fixed, weights = np.concatenate([points[rest], at]), np.concatenate([np.ones(rest.sum()), weight])
        for kernel, support in lattice.kernels:
            points[free] = even_out(points[free], fixed, weights, kernel, support, spacing, dimension)
    moved = np.flatnonzero(free & water)
    return {"gone": np.flatnonzero(gone & water), "near": moved, "moved": points[moved]}


def near_to(points: np.ndarray, others: np.ndarray, reach: float) -> np.ndarray:
    """(n,) True for `points` (n, 3) [m] nearer than `reach` [m] to any of `others` (m, 3) [m]."""
    from scipy.spatial import cKDTree

    return np.asarray(cKDTree(others).query(points, distance_upper_bound=reach)[0] < reach)


def even_out(
    free: np.ndarray,
    fixed: np.ndarray,
    weights: np.ndarray,
    kernel: Kernel,
    support: float,
    spacing: float,
    dimension: int,
) -> np.ndarray:
    """(n, 3) positions near `free` (n, 3) [m] for the smallest sum of a kernel over all pairs; `fixed` (m, 3):
    positions [m] of points that stay, with `weights` (m,) in particles; `support` of the kernel [spacings]."""
    from scipy.optimize import minimize
    from scipy.spatial import cKDTree

    n, tree = len(free), cKDTree(fixed)

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
            (met["i"], met["j"], fixed, weights[met["j"]], False),
        ):
            apart = (points[i] - others[j])[:, :dimension] / spacing
            t = np.maximum(1.0 - np.linalg.norm(apart, axis=1) / support, 0.0)
            total += float((weight * kernel.value(t)).sum())
            rise = (-1.0 / support**2 * weight * kernel.gradient(t))[:, None] * apart
            for k in range(dimension):
                slope[:, k] += np.bincount(i, rise[:, k], n)
                if back:
                    slope[:, k] -= np.bincount(j, rise[:, k], n)
        unit = kernel.value(np.ones(1))[0]
        return total / unit, slope.ravel() / unit

    start = (free[:, :dimension] / spacing).ravel()
    found = minimize(summed, start, jac=True, method="L-BFGS-B", options={"maxiter": FIT_ITERATIONS})
    moved = free.copy()
    moved[:, :dimension] = spacing * found.x.reshape(n, dimension)
    return moved
