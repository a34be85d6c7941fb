"""Spray: particles with hardly a neighbour, above the water, as small white drops."""

from typing import TYPE_CHECKING

import numpy as np

from ocean_sim.observers._far_sea import OUT

if TYPE_CHECKING:
    from ocean_sim.observers._picture import Picture

NEIGHBOURHOOD, FEW = 1.6, 3  # [spacings], and the most neighbours that a lonely particle has in it
ABOVE = 0.6  # [spacings] over the water
DROP = 0.12  # [spacings] radius of a drop
MOST = 600  # drops in a picture


def lonely(position: np.ndarray, spacing: float) -> np.ndarray:
    """(n,) which particles (n, 3) have left the water, by how few others are near."""
    from scipy.spatial import cKDTree

    if not len(position):
        return np.zeros(0, bool)
    tree = cKDTree(position)
    near = tree.query_ball_point(position, NEIGHBOURHOOD * spacing, return_length=True)
    return near - 1 <= FEW


class Spray:
    """A fixed number of drops; those not needed wait below the sea."""

    def __init__(self, picture: "Picture", spacing: float) -> None:
        self.spacing = spacing
        self.places = np.tile(np.array([0.0, -OUT, 0.0], np.float32), (MOST, 1))
        self.cloud = picture.pyvista.PolyData(self.places)
        drops = picture.plotter.add_mesh(
            self.cloud, color="white", style="points_gaussian", render_points_as_spheres=True, lighting=False
        )
        drops.mapper.scale_factor = DROP * spacing
        self.drawn = drops.mapper.dataset

    def show(self, position: np.ndarray, heights: np.ndarray) -> None:
        """Particles (n, 3) and the heights (n,) of the water below them [m]."""
        flying = position[lonely(position, self.spacing) & (position[:, 1] > heights + ABOVE * self.spacing)][:MOST]
        places = self.places.copy()
        places[: len(flying)] = flying
        self.drawn.points = places
