"""Water of a basin in a picture, as a block with cut sides."""

from math import floor, log10
from typing import Any

import numpy as np

from ocean_sim.pictures.frame_files import Frame
from ocean_sim.pictures.stage.plotter import Content, Stage
from ocean_sim.pictures.water.water_mesh import WaterMesh
from ocean_sim.pictures.water.water_shading import display_colours, relief_light, side_light, surface_light

SURFACE_NODES = {"draft": 40_000, "final": 160_000}  # of the drawn surface


class Water(Content):
    """Water of a basin in a picture: surface and cut sides, coloured at their nodes for the eye."""

    def __init__(self, stage: Stage, grid: Any, nodes: int) -> None:
        """`grid`: arrays in the run's grid.npz (basin, x and z of heights); `nodes`: about how many the surface has."""
        self.stage = stage
        self.scale = 0.02 * float(grid["depth"])  # [m] the least height that counts as a crest
        self.most = self.scale  # [m] height from which crests have one colour
        self.mesh = WaterMesh(grid["x"], grid["z"], grid["lower"], grid["upper"], nodes)
        points, _ = self.mesh.surface(np.zeros((len(grid["x"]), len(grid["z"]))))
        sides = self.mesh.sides(points)
        self.sides = stage.add(sides, self.mesh.side_triangles, np.zeros(sides.shape, np.uint8))
        self.surface = stage.add(points, self.mesh.surface_triangles, np.zeros(points.shape, np.uint8))

    def show(self, frame: Frame) -> None:
        camera, eye = self.stage.camera, self.stage.camera.eye
        points, normals = self.mesh.surface(frame.elevation)
        points += frame.place
        self.most = round_up(max(2.5 * float(frame.elevation.std()), self.scale))
        height = np.clip(points[:, 1] / self.most, -1.0, 1.0)
        self.surface.points = points.astype(np.float32)
        on_map = camera.parallel_height is not None or camera.from_above
        light = relief_light(normals, height) if on_map else surface_light(points, normals, height, eye)
        self.surface["colour"] = display_colours(light)
        sides, depth = self.mesh.sides(points), self.mesh.side_depth
        self.sides.points = sides.astype(np.float32)
        self.sides["colour"] = display_colours(side_light(sides, self.mesh.side_normals, depth, eye))


def round_up(value: float) -> float:
    """Smallest of 1, 1.5, 2, 3, 4, 5, 6 and 8 times a power of ten that is not below a value."""
    power = 10.0 ** floor(log10(value))
    steps = 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0
    return next(m * power for m in steps if m * power >= value * (1.0 - 1e-9))
