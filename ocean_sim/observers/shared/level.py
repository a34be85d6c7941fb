"""How high water stands for what there is of it, in waves and on slopes, too."""

import numpy as np

from ocean_sim.basin import Basin

COLUMN = 3.0  # spacings, about


def level_ratio(position: np.ndarray, spacing: float, basin: Basin) -> float:
    """Height of the centre of mass of particles (n, 3) [m] over the bed, over what it would be if the water of each
    column, three spacings wide, lay on the bed and were as dense as at rest; a column holds a layer at least. NaN where
    a position is not a number."""
    if not np.isfinite(position).all():
        return float("nan")
    axes = [0, 2][: basin.dimension - 1]
    lower, size = np.array(basin.lower), np.subtract(basin.upper, basin.lower)[axes]
    counts = np.maximum(1.0, np.round(size / (COLUMN * spacing)))
    side = size / counts
    place = np.floor((position[:, axes] - lower[axes]) / side).astype(np.int64)
    place -= place.min(axis=0)
    column = place @ [1, *(place.max(axis=0) + 1)[:-1]]
    held = np.unique(column, return_counts=True)[1]
    tall = np.maximum(held * spacing**basin.dimension / side.prod(), spacing)  # of each column's water at rest [m]
    return float((position[:, 1] - lower[1]).sum() / (held * tall / 2.0).sum())
