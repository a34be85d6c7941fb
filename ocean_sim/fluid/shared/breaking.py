"""Waves that break."""

import numpy as np

from ocean_sim.fluid.shared.tile import Tile


class Breaking:
    """Nothing yet."""

    def __init__(self, tile: Tile, ahead: np.ndarray, period: float) -> None:
        self.tile = tile

    def calm(self, sea, dt: float) -> None:
        pass
