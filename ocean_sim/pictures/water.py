"""The surface of the water in a picture."""

from typing import Any

import numpy as np

from ocean_sim.pictures import water_shading
from ocean_sim.pictures.frame_files import Frame
from ocean_sim.pictures.stage import Stage
from ocean_sim.pictures.water_mesh import WaterMesh

EDGE = "#eef3f6"
THIN = 0.4  # of the light of a cut side that comes out of the folds of water in a tank
CLEAR = 0.45  # of a depth that a tank's water is dark by
NODES = {"draft": 40_000, "final": 160_000}  # of the drawn surface


class Water:
    """The surface and the cut sides of the water, coloured at their nodes for the eye of the picture."""

    def __init__(self, stage: Stage, grid: Any, nodes: int) -> None:
        """`nodes`: about how many the drawn surface has."""
        pyvista, self.stage = stage.pyvista, stage
        self.scale = 0.02 * float(grid["depth"])  # [m] the least height that counts as a crest
        self.mesh = WaterMesh(grid["x"], grid["z"], grid["lower"], grid["upper"], nodes)
        points, _ = self.mesh.surface(np.zeros((len(grid["x"]), len(grid["z"]))))
        self.surface = pyvista.PolyData.from_regular_faces(points.astype(np.float32), self.mesh.surface_triangles)
        sides = self.mesh.sides(points)
        self.sides = pyvista.PolyData.from_regular_faces(sides.astype(np.float32), self.mesh.side_triangles)
        for part in (self.sides, self.surface):
            part["colour"] = np.zeros((part.n_points, 3), np.uint8)
            stage.plotter.add_mesh(part, scalars="colour", rgb=True, lighting=False)

    def show(self, frame: Frame) -> None:
        eye = self.stage.camera.eye
        points, normals = self.mesh.surface(frame.elevation)
        points += frame.place
        height = np.clip(points[:, 1] / max(2.5 * float(frame.elevation.std()), self.scale), -1.0, 1.0)
        self.surface.points = points.astype(np.float32)
        camera = self.stage.camera
        if camera.parallel_height is not None or camera.forward[1] < -0.97:
            self.surface["colour"] = water_shading.display(water_shading.relief(normals, height))
        else:
            self.surface["colour"] = water_shading.display(water_shading.surface(points, normals, height, eye))
        sides, depth = self.mesh.sides(points), self.mesh.side_depth
        self.sides.points = sides.astype(np.float32)
        self.sides["colour"] = water_shading.display(water_shading.side(sides, self.mesh.side_normals, depth, eye))


class Shell:
    """A closed surface with drops and folds, smoothed; what faces down or sideways is seen as through glass."""

    def __init__(self, stage: Stage, lower: np.ndarray, upper: np.ndarray, depth: float) -> None:
        """In a tank from `lower` to `upper` [m], of this depth [m]."""
        self.stage, self.lower, self.upper, self.depth = stage, tuple(lower), tuple(upper), depth
        self.plotter, self.pyvista = stage.plotter, stage.pyvista
        box = self.pyvista.Box(np.stack([self.lower, self.upper], axis=1).ravel()).extract_feature_edges(30.0)
        self.plotter.add_mesh(box, color=EDGE, opacity=0.5, line_width=1.5, lighting=False)  # the tank, of glass

    def show(self, frame: Frame) -> None:
        from ocean_sim.pictures.smoothed_mesh import smoothed
        from ocean_sim.surface import Mesh

        assert frame.mesh is not None
        eye = self.stage.camera.eye
        smooth = smoothed(Mesh(*frame.mesh), self.lower, self.upper)
        points, triangles, normals = smooth.vertices, smooth.triangles, smooth.normals
        shape = self.pyvista.PolyData.from_regular_faces(points, triangles)
        height = np.clip(points[:, 1] / max(2.5 * float(frame.elevation.std()), 0.02 * self.depth), -1.0, 1.0)
        top = water_shading.surface(points, normals, height, eye) + THIN * water_shading.GLASS
        side = water_shading.side(points, normals, CLEAR * np.clip(-points[:, 1] / self.depth, 0.0, 1.0), eye)
        up = np.clip(2.5 * normals[:, 1:2], 0.0, 1.0)
        shape["colour"] = water_shading.display(up * top + (1.0 - up) * side)
        self.plotter.add_mesh(shape, scalars="colour", rgb=True, lighting=False, name="shell", reset_camera=False)
