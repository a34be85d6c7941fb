"""A ship in a picture."""

from typing import Any

import numpy as np

from ocean_sim.pictures import water_shading
from ocean_sim.pictures.light import lit
from ocean_sim.pictures.order import RenderFailed
from ocean_sim.pictures.ship_model import Model, modelled
from ocean_sim.pictures.stage import Stage


def kept_model(grid: Any, key: str) -> Model:
    """The model of a ship that frames keep under a key; raises RenderFailed."""
    if f"{key}_look" not in grid:
        raise RenderFailed("these frames are of an older version, which kept no ship to draw; run the scene again")
    return modelled(
        grid[f"{key}_vertices"],
        grid[f"{key}_triangles"],
        float(grid[f"{key}_submerged"]),
        str(grid[f"{key}_look"]),
        grid[f"{key}_helm"],
    )


class DrawnShip:
    """A model in the light of sun and sky, moved from frame to frame."""

    def __init__(self, stage: Stage, model: Model) -> None:
        mesh = model.mesh
        self.corners, self.normals = mesh.corners.reshape(-1, 3), mesh.normals.reshape(-1, 3)
        self.paint, self.gloss = np.repeat(mesh.colour, 3, axis=0), np.repeat(mesh.gloss, 3)[:, None]
        triangles = np.arange(len(self.corners)).reshape(-1, 3)
        self.shape = stage.pyvista.PolyData.from_regular_faces(self.corners.astype(np.float32), triangles)
        self.shape["colour"] = np.zeros((len(self.corners), 3), np.uint8)
        stage.plotter.add_mesh(self.shape, scalars="colour", rgb=True, lighting=False, smooth_shading=False)

    def show(self, position: np.ndarray, turn: np.ndarray) -> None:
        """At a position of its centre of mass [m], turned by a matrix from body to world axes."""
        self.shape.points = (self.corners @ turn.T + position).astype(np.float32)
        self.shape["colour"] = water_shading.display(lit(self.normals @ turn.T, self.paint, self.gloss))
