"""Points of the basin at which the water is sampled."""

from collections.abc import Sequence
from math import ceil

import numpy as np

from ocean_sim.basin import Basin


def in_space(vector: Sequence[float]) -> np.ndarray:
    """Point or direction as (3,) vector; z is 0 for one of a 2-D basin."""
    return np.array((*vector, 0.0)[:3])


def count(low: float, high: float, spacing: float) -> int:
    """Number of equal cells from `low` to `high` [m], each at most `spacing` [m] wide; at least two."""
    return max(2, ceil((high - low) / spacing - 1.0e-6))


def middles(low: float, high: float, spacing: float) -> np.ndarray:
    """Middles (n,) [m] of the equal cells, at most `spacing` [m] wide, between `low` and `high` [m] (see `count`)."""
    return middles_of(low, high, count(low, high, spacing))


def middles_of(low: float, high: float, n: int) -> np.ndarray:
    """Middles (n,) of n equal cells from `low` to `high`."""
    return low + (np.arange(n) + 0.5) * (high - low) / n


def grid(basin: Basin, spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """Positions x (n,), z (m,) [m] of a horizontal grid of points in the middles of cells of at most `spacing` [m]."""
    x = middles(basin.lower[0], basin.upper[0], spacing)
    z = middles(basin.lower[2], basin.upper[2], spacing) if basin.dimension == 3 else np.zeros(1)
    return x, z


def grid_size(basin: Basin, spacing: float) -> int:
    """Number of points of `grid` at this `spacing` [m], without making them."""
    along = count(basin.lower[0], basin.upper[0], spacing)
    return along * (count(basin.lower[2], basin.upper[2], spacing) if basin.dimension == 3 else 1)


def grid_points(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Points x, z (m, 2) of the grid with coordinates `x` and `z`: every x with every z, z running fastest."""
    return np.stack(np.meshgrid(x, z, indexing="ij"), axis=-1).reshape(-1, 2)
