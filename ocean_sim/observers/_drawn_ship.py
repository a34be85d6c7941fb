"""A ship in a picture."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ocean_sim.observers import _sky

if TYPE_CHECKING:
    from ocean_sim.observers._picture import Picture

HULL, DECK = np.array([206.0, 74.0, 52.0]), np.array([238.0, 226.0, 204.0])  # colours in full sun


class Ship:
    """The hull, its sides as bright as the sun makes them."""

    def __init__(self, picture: "Picture", grid: Any) -> None:
        self.vertices, triangles = grid["ship_vertices"].astype(float), grid["ship_triangles"].astype(int)
        self.length = float(np.ptp(self.vertices, axis=0).max())  # [m]
        a, b, c = (self.vertices[triangles[:, k]] for k in range(3))
        self.normals = _sky.unit(np.cross(b - a, c - a))
        deck = self.normals[:, 1:2] > 0.7
        self.paint = np.where(deck, DECK, HULL)
        self.shape = picture.pyvista.PolyData.from_regular_faces(self.vertices.astype(np.float32), triangles)
        self.shape.cell_data["colour"] = np.zeros((len(triangles), 3), np.uint8)
        picture.plotter.add_mesh(self.shape, scalars="colour", rgb=True, lighting=False)

    def show(self, position: np.ndarray, turn: np.ndarray) -> None:
        self.shape.points = (self.vertices @ turn.T + position).astype(np.float32)
        light = 0.45 + 0.55 * np.clip((self.normals @ turn.T) @ _sky.SUN, 0.0, 1.0)
        self.shape.cell_data["colour"] = (self.paint * light[:, None]).astype(np.uint8)
