"""The surface of the water in a picture."""

from math import floor, log10
from typing import Any

import numpy as np

from ocean_sim.pictures import sky, tank_glsl, water_glsl, water_shading
from ocean_sim.pictures.frame_files import Frame
from ocean_sim.pictures.spray import COARSE, Spray, stirred
from ocean_sim.pictures.stage import Stage
from ocean_sim.pictures.water_mesh import WaterMesh

EDGE = "#eef3f6"
RIM = {"color": EDGE, "opacity": 0.6, "lighting": False, "reset_camera": False, "render": False}
NEARER = 0.002  # of the way to the eye by which the rim lies before the water
EXPOSURE = 1.15  # of water in a tank, as of what is drawn with plain colours
BELOW = 0.004  # of a tank's height by which its bed is drawn below the water
MOST = 0.4  # [spacings] by which a folded surface is smoothed
LONG = 16.0  # [spacings] of a line where the water meets a side: shorter ones, around holes in a film, are not drawn
BED = (0.62, 0.66, 0.67)  # of a tank: on dark ground clear water would not tell how thick it is
NODES = {"draft": 40_000, "final": 160_000}  # of the drawn surface


class Water:
    """The surface and the cut sides of the water, coloured at their nodes for the eye of the picture."""

    def __init__(self, stage: Stage, grid: Any, nodes: int) -> None:
        """`nodes`: about how many the drawn surface has."""
        pyvista, self.stage = stage.pyvista, stage
        self.scale = 0.02 * float(grid["depth"])  # [m] the least height that counts as a crest
        self.most = self.scale  # [m] height from which crests have one colour
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
        self.most = round_above(max(2.5 * float(frame.elevation.std()), self.scale))
        height = np.clip(points[:, 1] / self.most, -1.0, 1.0)
        self.surface.points = points.astype(np.float32)
        camera = self.stage.camera
        if camera.parallel_height is not None or camera.from_above:
            self.surface["colour"] = water_shading.display(water_shading.relief(normals, height))
        else:
            self.surface["colour"] = water_shading.display(water_shading.surface(points, normals, height, eye))
        sides, depth = self.mesh.sides(points), self.mesh.side_depth
        self.sides.points = sides.astype(np.float32)
        self.sides["colour"] = water_shading.display(water_shading.side(sides, self.mesh.side_normals, depth, eye))


def round_above(value: float) -> float:
    """The least number of one digit, or of a half more below 2, times a power of ten that is not below a value."""
    power = 10.0 ** floor(log10(value))
    steps = 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0
    return next(m * power for m in steps if m * power >= value * (1.0 - 1e-9))


class Shell:
    """A closed surface with drops and folds, smoothed, and as clear as water: see `tank_glsl`."""

    def __init__(self, stage: Stage, grid: Any, upper: np.ndarray, white: bool) -> None:
        """In the tank that frames keep, drawn up to `upper` [m]; `white`: with spray and bubbles."""
        depth = self.depth = float(grid["depth"])
        self.stage, self.lower, self.upper, self.spacing = (
            stage,
            tuple(grid["lower"]),
            tuple(upper),
            float(grid["spacing"]),
        )
        pyvista = stage.pyvista
        box = pyvista.Box(np.stack([self.lower, self.upper], axis=1).ravel()).extract_feature_edges(30.0)
        stage.plotter.add_mesh(
            box, color=EDGE, opacity=0.5, line_width=1.5 * stage.samples, lighting=False
        )  # the tank, of glass
        middle, size = 0.5 * (grid["lower"] + grid["upper"]), grid["upper"] - grid["lower"]
        at = (middle[0], self.lower[1] - BELOW * size[1], middle[2])
        bed = pyvista.Plane(center=at, direction=(0.0, 1.0, 0.0), i_size=size[2], j_size=size[0])
        stage.plotter.add_mesh(bed, color=BED, lighting=False)
        over = sky.clear()
        self.behind, self.far = (water_glsl.texture(np.zeros((2, 2, n), np.uint8)) for n in (3, 4))
        textures = {"sky": water_glsl.texture(over.image, smaller=True, repeat=True)}
        seen = textures | {"scene": self.behind, "back": self.far}
        functions = water_glsl.WATER_FUNCTIONS
        plain = water_glsl.plain(0) | water_glsl.switched(water_shading.Terms()) | water_glsl.lit_by(over)
        self.water = water_glsl.Shaded(pyvista.PolyData(), tank_glsl.WATER, functions, seen, ("nrm",))
        self.backs = water_glsl.Shaded(self.water.mesh, tank_glsl.DISTANCE, functions, textures, ("nrm",))
        self.backs.actor.GetProperty().FrontfaceCullingOn()
        for part in (self.water, self.backs):
            shown = {"exposure": EXPOSURE, "depth": depth, "reach": 1.0, "onMap": float(stage.camera.from_above)}
            part.set(**plain | shown | {"view": np.eye(4)})
        stage.plotter.add_actor(self.water.actor, reset_camera=False, render=False)
        self.spray = Spray(stage, self.spacing, COARSE) if white else None
        self.measure = stage.empty(stage.size)  # the picture of distances
        self.measure.set_background("black")
        self.measure.add_actor(self.backs.actor, reset_camera=False, render=False)

    def show(self, frame: Frame) -> None:
        from ocean_sim.pictures.smoothed_mesh import long, rim, smoothed
        from ocean_sim.surface import Mesh

        assert frame.mesh is not None
        smooth = smoothed(Mesh(*frame.mesh), self.lower, self.upper, MOST * self.spacing)
        shape = self.stage.pyvista.PolyData.from_regular_faces(smooth.vertices, smooth.triangles)
        shape.point_data["nrm"] = smooth.normals.astype(np.float32)
        self.water.mesh.DeepCopy(shape)
        self.stage.plotter.remove_actor("rim", render=False)
        if (
            self.spray is not None
            and frame.position is not None
            and frame.velocity is not None
            and frame.id is not None
        ):
            air = stirred(frame.position, frame.velocity, self.depth)
            self.spray.place(frame.position[air > 0.0], frame.id[air > 0.0], air[air > 0.0])
        eye, plotter = self.stage.camera.eye, self.stage.plotter
        reach = 1.01 * float(np.linalg.norm(smooth.vertices - eye, axis=1).max())
        camera = plotter.camera
        found = camera.GetCompositeProjectionTransformMatrix(self.stage.size[0] / self.stage.size[1], -1.0, 1.0)
        view = np.array([[found.GetElement(i, j) for j in range(4)] for i in range(4)])
        for part in (self.water, self.backs):
            part.set(eyeW=eye, reach=reach, view=view)
        self.measure.camera.DeepCopy(camera)
        self.measure.render()
        water_glsl.fill(
            self.far.GetInput(), self.measure.screenshot(None, return_img=True, transparent_background=True)[::-1]
        )
        self.water.actor.VisibilityOff()
        plotter.render()
        water_glsl.fill(self.behind.GetInput(), plotter.screenshot(None, return_img=True)[::-1])
        self.water.actor.VisibilityOn()
        ends = smooth.vertices[long(rim(smooth, self.lower, self.upper), smooth.vertices, LONG * self.spacing)]
        if len(ends := ends[ends[..., 1].min(axis=1) > self.lower[1] + 0.5 * self.spacing]):
            seen = (ends + NEARER * (eye - ends)).reshape(-1, 3).astype(np.float32)
            lines = self.stage.pyvista.line_segments_from_points(seen)
            plotter.add_mesh(lines, name="rim", line_width=1.5 * self.stage.samples, **RIM)

    def close(self) -> None:
        self.measure.close()
