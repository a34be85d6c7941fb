"""Spray: particles with hardly a neighbour, above the water, each as a puff of small white drops."""

import numpy as np

from ocean_sim.pictures.far_sea import OUT
from ocean_sim.pictures.stage import Stage
from ocean_sim.random_numbers import numpy_uniform

NEIGHBOURHOOD, FEW = 1.6, 3  # [spacings], and the most neighbours that a isolated particle has in it
ABOVE = 0.6  # [spacings] over the water
DROP = 0.009  # [spacings] radius of a drop
PUFF, DROPS = 0.30, 24  # [spacings] radius of a puff, in which so many drops fly
MOST = 300  # puffs in a picture
OFFSETS = 0x5_0003  # stream of random numbers


def isolated(position: np.ndarray, spacing: float) -> np.ndarray:
    """(n,) which particles (n, 3) have left the water, by how few others are near."""
    from scipy.spatial import cKDTree

    if not len(position):
        return np.zeros(0, bool)
    tree = cKDTree(position)
    near = tree.query_ball_point(position, NEIGHBOURHOOD * spacing, return_length=True)
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
        n = np.arange(DROPS)
        self.offsets = PUFF * spacing * normal(np.stack([numpy_uniform(0, OFFSETS, n, k) for k in range(6)], axis=1))
        self.cloud = stage.pyvista.PolyData(self.positions)
        drops = stage.plotter.add_mesh(
            self.cloud, color="white", style="points_gaussian", render_points_as_spheres=False, lighting=False
        )
        drops.mapper.scale_factor = DROP * spacing
        self.drawn = drops.mapper.dataset

    def show(self, position: np.ndarray, heights: np.ndarray) -> None:
        """Particles (n, 3) and the heights (n,) of the water below them [m]."""
        flying = position[isolated(position, self.spacing) & (position[:, 1] > heights + ABOVE * self.spacing)][:MOST]
        positions = self.positions.copy()
        positions[: len(flying) * DROPS] = (flying[:, None] + self.offsets).reshape(-1, 3)
        self.drawn.points = positions
