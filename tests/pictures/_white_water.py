"""White water, followed with the water that carries it."""

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import map_coordinates

from ocean_sim.pictures.water import foam

WHITE = 0.3  # share from which water counts as white


def followed(
    kept: Sequence[np.ndarray], ways: Sequence[np.ndarray], first: int, after: int, origins: np.ndarray | None = None
) -> np.ndarray:
    """Whether what is white in a frame is so some frames later where the water has carried it, unless beyond the sides.

    `kept`: white water of each frame; `ways` (nx, nz, 2): by which water goes to the next [cells of the waves];
    `origins` (n, 2): where the grid of each begins [cells], by default where the first does.
    """
    origins = np.zeros((len(kept), 2)) if origins is None else origins
    at = (np.argwhere(kept[first] > WHITE) + 0.5) / foam.FLECKS_PER_CELL - 0.5 + origins[first]
    for n in range(first, first + after):
        here = (at - origins[n]).T
        at = at + np.stack([map_coordinates(ways[n][..., k], here, order=1, mode="nearest") for k in (0, 1)], axis=1)
    found = foam.FLECKS_PER_CELL * (at - origins[first + after] + 0.5) - 0.5
    inside = ((found > 0.0) & (found < np.array(kept[first + after].shape) - 1.0)).all(axis=1)
    return map_coordinates(kept[first + after], found[inside].T, order=1) > WHITE
