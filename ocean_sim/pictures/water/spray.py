"""Spray over a sea: white drops around particles that have left the water."""

import numpy as np

from ocean_sim.pictures.stage.plotter import Stage
from ocean_sim.pictures.water.far_sea import OUT
from ocean_sim.random_numbers import numpy_uniform

NEIGHBOURHOOD, FEW = 1.6, 3  # [spacings], and the most neighbours that a isolated particle has in it
ABOVE = 0.6  # [spacings] over the water
PUFF, DROP = 0.30, 0.009  # [spacings] radius of a puff and of a drop
DROPS, KINDS = 24, 64  # that fly in a puff; and of how many kinds puffs are
MOST = 1500  # puffs in a picture
OFFSETS = 0x5_0003  # stream of random numbers


def isolated(position: np.ndarray, spacing: float, high: np.ndarray) -> np.ndarray:
    """(m,) which of the high ones (m, 3) among particles (n, 3) have left the water, by how few others are near."""
    from scipy.spatial import cKDTree

    if not len(high):
        return np.zeros(0, bool)
    near = cKDTree(position).query_ball_point(high, NEIGHBOURHOOD * spacing, return_length=True)
    return near - 1 <= FEW


def normal(uniform: np.ndarray) -> np.ndarray:
    """(n, 3) normally distributed numbers of variance 1/4 from (n, 6) evenly distributed ones (Box & Muller 1958)."""
    radius, angle = np.sqrt(-2.0 * np.log(1.0 - uniform[:, :3])), 2.0 * np.pi * uniform[:, 3:]
    return 0.5 * radius * np.cos(angle)


class Spray:
    """A fixed number of puffs; those not needed wait below the sea."""

    def __init__(self, stage: Stage, spacing: float) -> None:
        self.spacing = spacing
        self.positions = np.tile(np.array([0.0, -OUT, 0.0], np.float32), (MOST * DROPS, 1))
        n = np.arange(KINDS * DROPS)
        offsets = PUFF * spacing * normal(np.stack([numpy_uniform(0, OFFSETS, n, k) for k in range(6)], axis=1))
        self.offsets = offsets.reshape(KINDS, DROPS, 3)
        self.cloud = stage.pyvista.PolyData(self.positions)
        drops = stage.plotter.add_mesh(
            self.cloud, color="white", style="points_gaussian", render_points_as_spheres=False, lighting=False
        )
        drops.mapper.scale_factor = DROP * spacing
        self.drawn = drops.mapper.dataset

    def show(self, position: np.ndarray, heights: np.ndarray) -> None:
        """Particles (n, 3) and the heights (n,) of the water below them [m]."""
        high = position[position[:, 1] > heights + ABOVE * self.spacing]
        centres = high[isolated(position, self.spacing, high)][:MOST]
        drops = (centres[:, None] + self.offsets[np.arange(len(centres)) % KINDS]).reshape(-1, 3)
        positions = self.positions.copy()
        positions[: len(drops)] = drops
        self.drawn.points = positions
