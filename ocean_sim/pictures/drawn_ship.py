"""A ship in a picture."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ocean_sim.pictures import sky, water_shading
from ocean_sim.pictures.order import RenderFailed
from ocean_sim.pictures.ship_model import Model, modelled

if TYPE_CHECKING:
    from ocean_sim.pictures.picture import Picture

SUNSHINE = np.array([0.80, 0.74, 0.64])  # on a face that looks into the sun, linear RGB
FROM_ABOVE = np.array([0.40, 0.46, 0.54])  # light of the sky on a level face
FROM_BELOW = np.array([0.12, 0.16, 0.18])  # light that the water throws back
MIRRORED = np.array([0.30, 0.42, 0.56])  # of the sky, in panes


def kept_model(grid: Any) -> Model:
    """The model of a ship that frames keep; raises RenderFailed."""
    if "ship_look" not in grid:
        raise RenderFailed("these frames are of an older version, which kept no ship to draw; run the scene again")
    return modelled(
        grid["ship_vertices"],
        grid["ship_triangles"],
        float(grid["ship_submerged"]),
        str(grid["ship_look"]),
        grid["ship_helm"],
    )


class Ship:
    """A model in the light of sun and sky, moved from frame to frame."""

    def __init__(self, picture: "Picture", model: Model) -> None:
        mesh = model.mesh
        self.corners, self.normals = mesh.corners.reshape(-1, 3), mesh.normals.reshape(-1, 3)
        self.paint, self.gloss = np.repeat(mesh.colour, 3, axis=0), np.repeat(mesh.gloss, 3)[:, None]
        triangles = np.arange(len(self.corners)).reshape(-1, 3)
        self.shape = picture.pyvista.PolyData.from_regular_faces(self.corners.astype(np.float32), triangles)
        self.shape["colour"] = np.zeros((len(self.corners), 3), np.uint8)
        picture.plotter.add_mesh(self.shape, scalars="colour", rgb=True, lighting=False, smooth_shading=False)

    def show(self, position: np.ndarray, turn: np.ndarray) -> None:
        """At a position of its centre of mass [m], turned by a matrix from body to world axes."""
        self.shape.points = (self.corners @ turn.T + position).astype(np.float32)
        self.shape["colour"] = water_shading.display(lit(self.normals @ turn.T, self.paint, self.gloss))


def lit(normals: np.ndarray, paint: np.ndarray, gloss: np.ndarray) -> np.ndarray:
    """Linear RGB (n, 3) of paint in sun and sky; panes show the sky above instead."""
    sun = np.clip(normals @ sky.SUN, 0.0, 1.0)[:, None]
    above = 0.5 + 0.5 * normals[:, 1:2]
    ambient = FROM_BELOW + (FROM_ABOVE - FROM_BELOW) * above
    facing = 0.35 + 0.65 * np.clip(1.0 - np.abs(normals @ sky.SUN), 0.0, 1.0)[:, None]
    return paint * (SUNSHINE * sun + ambient) + 0.12 * gloss * MIRRORED * facing
