"""Water that folds over, in a tank of glass: clear, with air where it is stirred.

Things behind clear water are seen bent and dimmed by the way of light through it. Two pictures come first: one of
everything but the water, one of the distances of its back faces. The shader takes the difference of both faces as the
thickness, absorbs and scatters along it (Beer and Lambert), and mirrors the sky. Water hidden by other water, as a pool
below a jet, is drawn first, behind the back faces of the nearer one.
"""

import sys
from typing import Any

import numpy as np

from ocean_sim.pictures.frame_files import Frame
from ocean_sim.pictures.stage import sky
from ocean_sim.pictures.stage.plotter import Content, Stage
from ocean_sim.pictures.water import water_glsl, water_shading
from ocean_sim.pictures.water.foam import read_cells
from ocean_sim.pictures.water.smoothed_mesh import points_on_sides, smooth_mesh
from ocean_sim.surface import Mesh

MAX_SMOOTHING = 0.4  # [spacings] by which a folded surface is smoothed
WATER_TRAITS = "nrm", "air", "was"  # normal; share of air; where its water was born
ABSORPTION = np.array([3.0, 0.85, 0.60])  # of light, in a way as long as the tank is deep
# Light that comes back from water so thick that nothing shines through
SCATTERED_LIGHT = np.array([0.016, 0.135, 0.170])
SHINE_VARIANCE = 0.004  # variance of slopes that widen the sun's highlight
RELIEF_FACTOR = 1.6  # by which slopes are steeper than they are in the light of a map
GRAIN_LENGTH = 0.5  # of foam: how many of its metres on a sea a spacing of the particles is in a tank
HEIGHT_SKEW = (0.7, 0.4)  # of the height at which water was born, in the two coordinates of its grain
# Colour of water full of bubbles; its light from all sides, and the sun's
FOAM_COLOUR, FOAM_LIGHTS = np.array([0.80, 0.83, 0.84]), (0.62, 0.38)


class Shell(Content):
    """Closed surface of the water in a glass tank, drawn smooth and clear."""

    def __init__(self, stage: Stage, grid: Any, upper: np.ndarray, white: bool) -> None:
        """`grid`: arrays that frames keep once; `upper`: top corner of the tank [m]; `white`: True to draw foam."""
        depth = self.depth = float(grid["depth"])
        self.stage, self.white, self.sides = stage, white, (grid["lower"][[0, 2]], grid["upper"][[0, 2]])
        self.lower, self.upper, self.spacing = tuple(grid["lower"]), tuple(upper), float(grid["spacing"])
        over = sky.clear_sky_image()
        self.behind = water_glsl.make_texture(np.zeros((2, 2, 3), np.uint8))
        self.far, self.farther = (water_glsl.make_texture(np.zeros((2, 2, 4), np.uint8)) for _ in range(2))
        textures = water_glsl.sky_textures(over)
        seen = textures | {"scene": self.behind, "back": self.farther, "before": self.far}
        own = sys.modules[__name__]
        functions = water_glsl.WATER_FUNCTIONS + water_glsl.shader("tank_functions", own)
        program = water_glsl.shader("tank", own, sky, water_shading)
        plain = water_glsl.neutral_uniforms(0) | water_glsl.sky_uniforms(over)
        self.water = water_glsl.Shaded(stage.pyvista.PolyData(), program, functions, seen, WATER_TRAITS)
        measured = water_glsl.own_textures(textures | {"before": self.far})
        distances = water_glsl.shader("tank_distance")
        self.backs = water_glsl.Shaded(self.water.mesh, distances, functions, measured, WATER_TRAITS)
        self.backs.actor.GetProperty().FrontfaceCullingOn()
        half, parallel = stage.camera.parallel_height, stage.camera.parallel_height is not None
        pixel = 2.0 * (half or float(np.tan(np.radians(stage.camera.angle) / 2.0))) / (stage.samples * stage.size[1])
        for part in (self.water, self.backs):
            shown = {"exposure": water_shading.TANK_EXPOSURE, "depth": depth, "onMap": float(stage.camera.from_above)}
            shown |= {"spacing": self.spacing, "pixel": pixel, "behindOthers": 0.0, "parallel": float(parallel)}
            space = {"ahead": stage.camera.forward, "boxLow": np.array(self.lower), "boxHigh": np.array(self.upper)}
            part.set(**plain | shown | space | {"view": np.eye(4), "screen": np.ones(3), "reach": 1.0})
        stage.plotter.add_actor(self.water.actor, reset_camera=False, render=False)
        self.measure = stage.empty(stage.plotter.window_size)  # the picture of distances
        self.measure.set_background("black")
        self.measure.add_actor(self.backs.actor, reset_camera=False, render=False)

    def surface(self, frame: Frame) -> tuple[Mesh, np.ndarray, np.ndarray]:
        """Surface mesh of a frame, and at its vertices the share of air (n, 3), in the first column, and the places
        (n, 3) [m] at which their water was in the first frame (see WATER_TRAITS)."""
        assert frame.mesh is not None
        skin = smooth_mesh(Mesh(*frame.mesh), self.lower, self.upper, MAX_SMOOTHING * self.spacing)
        if not self.white or frame.left is None or frame.carried is None or not len(skin.vertices):
            return skin, np.zeros_like(skin.vertices), skin.vertices
        at = ((skin.vertices[:, [0, 2]] - self.sides[0]) / (self.sides[1] - self.sides[0])).T
        free = ~points_on_sides(skin.vertices, self.lower, self.upper).any(axis=(0, 2))  # glass shows no air
        air = np.outer(read_cells(frame.left, at) * free, [1.0, 0.0, 0.0])
        return skin, air, skin.vertices - np.insert(read_cells(frame.carried, at), 1, 0.0, axis=1)

    def show(self, frame: Frame) -> None:
        """Update the surface to a frame, and render the pictures of distances and background that its shader needs."""
        mesh, state, birth = self.surface(frame)
        traits = dict(zip(WATER_TRAITS, (mesh.normals, state, birth), strict=True))
        self.water.mesh.DeepCopy(self.stage.mesh(mesh.vertices, mesh.triangles, **traits))
        eye, plotter = self.stage.camera.eye, self.stage.plotter
        reach = 1.01 * float(np.linalg.norm(mesh.vertices - eye, axis=1).max())
        camera = plotter.camera
        view = water_glsl.projection(camera, self.stage.size[0] / self.stage.size[1])
        screen = np.array([*plotter.window_size, 1.0])
        for part in (self.water, self.backs):
            part.set(eyeW=eye, ahead=self.stage.camera.forward, reach=reach, view=view, screen=screen, behindOthers=0.0)
        self.measure.camera.DeepCopy(camera)
        nearest = self.distances()
        water_glsl.fill_image(self.far.GetInput(), nearest)
        self.backs.set(behindOthers=1.0)
        water_glsl.fill_image(self.farther.GetInput(), self.distances())
        self.water.actor.VisibilityOff()
        self.see()
        self.water.actor.VisibilityOn()
        self.water.set(behindOthers=1.0)
        self.see()
        self.water.set(behindOthers=0.0)
        water_glsl.fill_image(self.farther.GetInput(), nearest)

    def distances(self) -> np.ndarray:
        """Distances of the water's back faces as an image (height, width, 4), lowest row first."""
        self.measure.render()
        return self.measure.screenshot(None, return_img=True, transparent_background=True)[::-1]

    def see(self) -> None:
        """Render the present picture, and use it as the background seen through the water."""
        for mark in self.stage.over:
            mark.VisibilityOff()
        self.stage.plotter.render()
        for mark in self.stage.over:
            mark.VisibilityOn()
        water_glsl.fill_image(self.behind.GetInput(), self.stage.plotter.screenshot(None, return_img=True)[::-1])

    def close(self) -> None:
        """Close the plotter in which distances through the water are drawn."""
        self.measure.close()
