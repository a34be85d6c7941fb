"""The obstacles of a basin in a picture: boxes of concrete, a wavemaker; and its bed, of sand, if that has a shape."""

from typing import TYPE_CHECKING

import numpy as np

from ocean_sim.pictures.frame_files import Frame
from ocean_sim.pictures.stage.plotter import Stage
from ocean_sim.pictures.stage.sky import painted_light
from ocean_sim.pictures.water import water_shading

if TYPE_CHECKING:
    from ocean_sim.basin.ground import Ground

CONCRETE_COLOUR = np.array([0.42, 0.40, 0.37])  # linear RGB
PLATE_COLOUR = np.array([0.62, 0.20, 0.05])  # linear RGB, of a wavemaker
SAND_COLOUR = np.array([0.60, 0.44, 0.24])  # linear RGB
NO_BOXES = np.zeros((0, 2, 3))
INSET_SHARE = 2.0e-3  # of the basin: a face that lies in a side of the basin is not drawn in the same plane


def sand_mesh(ground: "Ground", breadth: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Sand bed to draw, wider than the basin: vertices (n, 3) [m], triangles (m, 3), 8-bit RGB (n, 3). `breadth`:
    across the drawn bed of a 2-D basin [m]."""
    corners, normals = ground.body_mesh(breadth)
    middle = ground.extent.mean(axis=0) * [1.0, 0.0, 1.0]
    vertices = middle + (corners.reshape(-1, 3) - middle) * [1.0 + INSET_SHARE, 1.0, 1.0 + INSET_SHARE]
    colours = np.repeat(water_shading.display_colours(painted_light(normals, SAND_COLOUR)), 3, axis=0)
    return vertices, np.arange(len(vertices)).reshape(-1, 3), colours


class Obstacles:
    """Obstacles of a basin in a picture. Those that never move are drawn once, the others anew in every picture."""

    def __init__(self, stage: Stage, grid: dict[str, np.ndarray], lower: np.ndarray, upper: np.ndarray) -> None:
        """`grid`: arrays that a run saves once, with fixed obstacles; `lower`, `upper`: corners of the walls [m]."""
        inset = INSET_SHARE * (upper - lower)
        self.stage, self.lower = stage, lower + inset
        self.upper = np.array([upper[0] - inset[0], np.inf, upper[2] - inset[2]])  # it may stand out of the water
        self.plates = grid.get("plates", NO_BOXES)
        self.add("obstacles", grid.get("obstacles", NO_BOXES), grid.get("meshes", np.zeros((0, 3, 3))))

    def show(self, frame: Frame) -> None:
        self.add("gates", frame.gates, frame.moving_meshes)
        self.add("plates", self.plates + frame.plate_way, frame.moving_meshes[:0], PLATE_COLOUR)

    def add(self, name: str, boxes: np.ndarray, triangles: np.ndarray, paint: np.ndarray = CONCRETE_COLOUR) -> None:
        """Draw, or replace, the object `name`: boxes (n, 2, 3), triangles (m, 3, 3) [m], in linear RGB `paint` (3,)."""
        plotter, pyvista = self.stage.plotter, self.stage.pyvista
        plotter.remove_actor(name, render=False)
        ends = [np.stack([np.maximum(low, self.lower), np.minimum(up, self.upper)], axis=1) for low, up in boxes]
        shapes = [pyvista.Box(each.ravel()) for each in ends]
        if len(triangles):
            points = np.clip(triangles, self.lower, self.upper).reshape(-1, 3)
            shapes.append(pyvista.PolyData.from_regular_faces(points, np.arange(len(points)).reshape(-1, 3)))
        if shapes:
            shape = pyvista.merge(shapes, merge_points=False)
            light = painted_light(shape.face_normals, paint)
            shape.cell_data["colour"] = water_shading.display_colours(light)
            shown = {"smooth_shading": False, "name": name, "reset_camera": False, "render": False}
            plotter.add_mesh(shape, scalars="colour", rgb=True, lighting=False, **shown)
