"""Packing of particles around solid bodies, so that an even pressure pushes none (Colagrossi et al. 2012, Comput. Phys.
Commun. 183)."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ocean_sim.files.cache_file import cached_arrays

FIT_REACH = 4.0  # [spacings] from a body within which particles move for it
FIT_ITERATIONS = 100  # at most
ROW_TOLERANCE = 0.05  # [spacings] distances that differ by less are those of a row
KEPT_APART = 0.02  # of the kernel: push of pairs closer than a spacing, which some kernels let meet
GOLDEN_RATIO = 0.6180339887498949  # spreads what is taken from a row evenly along it
EVERYWHERE = np.full(3, -np.inf), np.full(3, np.inf)


class Kernel(Protocol):
    """Interface of a smoothing kernel W for packing particles: that of the water's pressure."""

    def value(self, t: np.ndarray) -> np.ndarray:
        """Kernel W at t (n,) = 1 - r / support, without its constant factor."""

    def gradient(self, t: np.ndarray) -> np.ndarray:
        """Factor g (n,), at t (n,) = 1 - r / support, in the gradient -g x / support^2 of W without its constant
        factor, at a distance vector x of length r."""


class Wendland:
    """Wendland's kernel (C2), which keeps particles apart."""

    def value(self, t: np.ndarray) -> np.ndarray:
        return t**4 * (5.0 - 4.0 * t)

    def gradient(self, t: np.ndarray) -> np.ndarray:
        return 20.0 * t**3


@dataclass(frozen=True)
class Lattice:
    """Lattice of the initial particles, and the kernel by which they are packed around bodies."""

    spacing: float  # [m]
    volume: float  # of a particle [m3], in 2-D its area [m2]
    kernel: Kernel
    support: float  # of the kernel [spacings]


def deepest_first(distance: np.ndarray, spacing: float) -> np.ndarray:
    """Indices of points at `distance` (n,) [m] from a body (negative inside), deepest first; those equally deep, to a
    small part of the particles' `spacing` [m], are spread out."""
    rows = np.round(distance / (ROW_TOLERANCE * spacing))
    return np.lexsort((np.arange(len(distance)) * GOLDEN_RATIO % 1.0, rows))


def fit_particles(
    points: np.ndarray,
    water: np.ndarray,
    gone: np.ndarray,
    samples: tuple[np.ndarray, np.ndarray],
    lattice: Lattice,
    dimension: int,
    box: tuple[np.ndarray, np.ndarray] = EVERYWHERE,
    iterations: int = FIT_ITERATIONS,
) -> dict[str, np.ndarray]:
    """Move particles near a body, in at most `iterations`, to the smallest kernel sum over pairs. `points` (n, 3) [m]:
    particles (`water` True), then a lattice beyond; `gone`: True where the body displaces them; `samples`: positions
    (m, 3) [m], volumes (m,) [m3] of its sample points; `box`: corners (3,) [m], points outside stay. Returns indices in
    `points` of particles to remove (`gone`) and moved (`near`), and new positions [m] (`moved`)."""
    at, weight, spacing = samples[0], samples[1] / lattice.volume, lattice.spacing
    near = near_to(points, at, FIT_REACH * spacing) & ((points >= box[0]) & (points <= box[1])).all(axis=1)
    free = near & ~gone
    rest = near_to(points, at, (FIT_REACH + lattice.support + 1.0) * spacing) & ~near & ~gone
    if (free & water).any():
        fixed, weights = np.concatenate([points[rest], at]), np.concatenate([np.ones(rest.sum()), weight])
        points[free] = even_out(points[free], fixed, weights, lattice, dimension, box, iterations)
    moved = np.flatnonzero(free & water)
    return {"gone": np.flatnonzero(gone & water), "near": moved, "moved": points[moved]}


def cached_room(
    positions: np.ndarray, content: bytes, made: Callable[[], dict[str, np.ndarray]], *asked: type
) -> tuple[np.ndarray, np.ndarray]:
    """(n,) True for particles to remove, and (n, 3) new positions [m]: `positions` with the arrays of `fit_particles`,
    computed by `made`, or cached for the same input bytes `content` and source files of `made` and classes `asked`."""
    found = cached_arrays("rooms", content, made, *asked)
    gone, moved = np.zeros(len(positions), dtype=bool), positions.copy()
    gone[found["gone"]], moved[found["near"]] = True, found["moved"]
    return gone, moved


def near_to(points: np.ndarray, others: np.ndarray, reach: float) -> np.ndarray:
    """(n,) True for `points` (n, 3) [m] nearer than `reach` [m] to any of `others` (m, 3) [m]."""
    from scipy.spatial import cKDTree

    return np.asarray(cKDTree(others).query(points, distance_upper_bound=reach)[0] < reach)


def even_out(
    free: np.ndarray,
    fixed: np.ndarray,
    weights: np.ndarray,
    lattice: Lattice,
    dimension: int,
    box: tuple[np.ndarray, np.ndarray],
    iterations: int,
) -> np.ndarray:
    """(n, 3) positions [m] to which points `free` move, inside `box`, for the smallest sum of the kernel over pairs;
    `fixed` points (m, 3) [m], which count with `weights` (m,), stay. At most `iterations` of L-BFGS-B; if
    `dimension` is 2, points move in x and y alone."""
    from scipy.optimize import minimize
    from scipy.spatial import cKDTree

    n, tree, spacing, support, kernel = len(free), cKDTree(fixed), lattice.spacing, lattice.support, lattice.kernel
    unit, apart_kernel = float(kernel.value(np.ones(1))[0]), Wendland()

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
            away = np.linalg.norm(apart, axis=1)
            t, close = np.maximum(1.0 - away / support, 0.0), np.maximum(1.0 - away, 0.0)
            total += float((weight * (kernel.value(t) / unit + KEPT_APART * apart_kernel.value(close))).sum())
            pull = kernel.gradient(t) / (unit * support**2) + KEPT_APART * apart_kernel.gradient(close)
            rise = -(weight * pull)[:, None] * apart
            for k in range(dimension):
                slope[:, k] += np.bincount(i, rise[:, k], n)
                if back:
                    slope[:, k] -= np.bincount(j, rise[:, k], n)
        return total, slope.ravel()

    start = (free[:, :dimension] / spacing).ravel()
    low, up = (np.tile(corner[:dimension] / spacing, n) for corner in box)
    bounds = np.stack([np.maximum(start - 1.0, low), np.minimum(start + 1.0, up)], axis=1)
    found = minimize(summed, start, bounds=bounds, jac=True, method="L-BFGS-B", options={"maxiter": iterations})
    moved = free.copy()
    moved[:, :dimension] = spacing * found.x.reshape(n, dimension)
    return moved
