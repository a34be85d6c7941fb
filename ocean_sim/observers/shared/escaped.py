"""Which particles a side of the basin should have held and did not."""

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.fluid import Totals

ROUNDING = 1.0e-6  # of the basin's largest coordinate: a few roundings of a float32


def kept(totals: Totals, basin: Basin) -> bool:
    """Whether all particles are where `beyond` finds none: quickly known, where there are no obstacles."""
    low, up = basin.stops()
    return not basin.obstacles and bool((totals.lower >= low).all() and (totals.upper <= up).all())


def beyond(position: np.ndarray, basin: Basin, time: float) -> np.ndarray:
    """How far each particle is at a time [s] beyond the walls, floor and lid that there are, or in an obstacle, (n,)
    [m]; 0 in the water and at open sides."""
    low, up = (np.array(stop) for stop in basin.stops())
    distance = np.linalg.norm(position - np.clip(position, low, up), axis=1)
    for least, most in basin.obstacles_at(time):
        distance = np.maximum(distance, np.minimum(position - least, np.array(most) - position).min(axis=1))
    return np.where(distance > ROUNDING * np.abs([basin.lower, basin.upper]).max(), distance, 0.0)
