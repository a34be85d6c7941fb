"""Water that folds, in a tank of glass: clear, with the splashes that its particles are too wide for."""

from typing import Any

import numpy as np

from ocean_sim.pictures import sky, tank_glsl, vessel, water_glsl, water_shading
from ocean_sim.pictures import splash as splashing
from ocean_sim.pictures.frame_files import Frame
from ocean_sim.pictures.smoothed_mesh import sides_at, smoothed
from ocean_sim.pictures.stage import Content, Stage
from ocean_sim.surface import Mesh

EXPOSURE = 1.15  # of water in a tank, as of what is drawn with plain colours
MOST = 0.4  # [spacings] by which a folded surface is smoothed
BEHIND_GLASS = np.array([0.0, 0.0, 0.0])  # air that is seen of it, holes, wrinkles: glass is smooth
TRAITS = "nrm", "air", "was"  # normal; air, how torn, how rough; where its water was born


class Shell(Content):
    """A closed surface with drops and folds, smoothed, and as clear as water: see `tank_glsl`."""

    def __init__(self, stage: Stage, grid: Any, upper: np.ndarray, first: Frame, white: bool) -> None:
        """In the tank that frames keep, drawn up to `upper` [m]; `first`: frame of the run; `white`: with splashes."""
        depth = self.depth = float(grid["depth"])
        self.stage, self.first, self.white = stage, first, white
        self.lower, self.upper, self.spacing = tuple(grid["lower"]), tuple(upper), float(grid["spacing"])
        self.sides = grid["lower"][[0, 2]], grid["upper"][[0, 2]]
        self.boxes = grid.get("obstacles", np.zeros((0, 2, 3)))
        vessel.build(stage, grid["lower"], upper, depth)
        over = sky.clear()
        ball = stage.pyvista.Icosphere(radius=1.0, nsub=1)
        directions = np.asarray(ball.points, dtype=float)
        self.ball = Mesh(directions, ball.regular_faces, directions)
        self.behind = water_glsl.texture(np.zeros((2, 2, 3), np.uint8))
        self.far, self.farther = (water_glsl.texture(np.zeros((2, 2, 4), np.uint8)) for _ in range(2))
        textures = water_glsl.textures_of(over)
        seen = textures | {"scene": self.behind, "back": self.farther, "before": self.far}
        functions = water_glsl.WATER_FUNCTIONS + tank_glsl.SEEN + tank_glsl.GRAINS
        plain = water_glsl.plain(0) | water_glsl.switched(water_shading.Terms()) | water_glsl.lit_by(over)
        self.water = water_glsl.Shaded(stage.pyvista.PolyData(), tank_glsl.WATER, functions, seen, TRAITS)
        measured = {
            name: water_glsl.texture_of(of.GetInput(), of.GetMipmap())
            for name, of in (textures | {"before": self.far}).items()
        }  # of a window of its own
        self.backs = water_glsl.Shaded(self.water.mesh, tank_glsl.DISTANCE, functions, measured, TRAITS)
        self.backs.actor.GetProperty().FrontfaceCullingOn()
        half, parallel = stage.camera.parallel_height, stage.camera.parallel_height is not None
        pixel = 2.0 * (half or float(np.tan(np.radians(stage.camera.angle) / 2.0))) / (stage.samples * stage.size[1])
        for part in (self.water, self.backs):
            shown: dict[str, Any] = {
                "exposure": EXPOSURE,
                "depth": depth,
                "reach": 1.0,
                "onMap": float(stage.camera.from_above),
            }
            shown |= {"spacing": self.spacing, "pixel": pixel, "behindOthers": 0.0, "parallel": float(parallel)}
            shown |= {"ahead": stage.camera.forward}
            shown |= {"boxLow": np.array(self.lower), "boxHigh": np.array(self.upper)}
            part.set(**plain | shown | {"view": np.eye(4), "screen": np.ones(3)})
        stage.plotter.add_actor(self.water.actor, reset_camera=False, render=False)
        self.measure = stage.empty(stage.plotter.window_size)  # the picture of distances
        self.measure.set_background("black")
        self.measure.add_actor(self.backs.actor, reset_camera=False, render=False)

    def surface(self, frame: Frame) -> tuple[Mesh, np.ndarray, np.ndarray]:
        """The mesh, and for its vertices state and birthplace (see TRAITS)."""
        assert frame.mesh is not None
        skin = smoothed(Mesh(*frame.mesh), self.lower, self.upper, MOST * self.spacing)
        particles, start = (frame.position, frame.velocity, frame.id), (self.first.position, self.first.id)
        if not self.white or any(each is None for each in (*particles, *start)) or not len(skin.vertices):
            return skin, np.zeros_like(skin.vertices), skin.vertices
        position, velocity, number = (np.asarray(each) for each in particles)
        position, velocity = position.astype(float), velocity.astype(float)
        floor = splashing.floors(position, self.lower[1], self.boxes)
        low, cell = self.sides[0], (self.sides[1] - self.sides[0]) / frame.elevation.shape
        up = np.maximum(
            splashing.flying(position, floor, self.spacing),
            splashing.risen(position, frame.elevation, low, cell, self.spacing),
        )
        birth = splashing.born(position, number, np.asarray(start[0], float), np.asarray(start[1]))
        up *= splashing.set_off(position, number, birth, np.asarray(start[1]), self.spacing)
        beside = np.abs(position[:, None, [0, 2]] - np.stack(self.sides)) < self.spacing
        found = splashing.splash(position, velocity, up, beside.sum(axis=(1, 2)), self.spacing, self.depth)
        known = np.column_stack([found.air, found.torn, found.rough, birth])
        traits = splashing.at_vertices(skin.vertices, position, known, self.spacing)
        on = sides_at(skin.vertices, self.lower, self.upper).any(axis=(0, 2))
        traits[on, :3] *= BEHIND_GLASS
        middles, radii = splashing.drops(position, velocity, number, found.torn, self.spacing)
        inside = np.all((middles > self.lower) & (middles < self.upper), axis=1)
        balls = splashing.spheres(middles[inside], radii[inside], self.ball)
        n = len(skin.vertices)
        whole = Mesh(
            np.concatenate([skin.vertices, balls.vertices]),
            np.concatenate([skin.triangles, balls.triangles + n]),
            np.concatenate([skin.normals, balls.normals]),
        )
        calm = np.zeros_like(balls.vertices)
        return whole, np.concatenate([traits[:, :3], calm]), np.concatenate([traits[:, 3:], balls.vertices])

    def show(self, frame: Frame) -> None:
        mesh, state, birth = self.surface(frame)
        shape = self.stage.pyvista.PolyData.from_regular_faces(mesh.vertices.astype(np.float32), mesh.triangles)
        for name, value in zip(TRAITS, (mesh.normals, state, birth), strict=True):
            shape.point_data[name] = value.astype(np.float32)
        self.water.mesh.DeepCopy(shape)
        eye, plotter = self.stage.camera.eye, self.stage.plotter
        reach = 1.01 * float(np.linalg.norm(mesh.vertices - eye, axis=1).max())
        camera = plotter.camera
        found = camera.GetCompositeProjectionTransformMatrix(self.stage.size[0] / self.stage.size[1], -1.0, 1.0)
        view = np.array([[found.GetElement(i, j) for j in range(4)] for i in range(4)])
        screen = np.array([*plotter.window_size, 1.0])
        for part in (self.water, self.backs):
            part.set(eyeW=eye, ahead=self.stage.camera.forward, reach=reach, view=view, screen=screen, behindOthers=0.0)
        self.measure.camera.DeepCopy(camera)
        nearest = self.distances()
        water_glsl.fill(self.far.GetInput(), nearest)
        self.backs.set(behindOthers=1.0)
        water_glsl.fill(self.farther.GetInput(), self.distances())
        self.water.actor.VisibilityOff()
        self.see()
        self.water.actor.VisibilityOn()
        self.water.set(behindOthers=1.0)
        self.see()
        self.water.set(behindOthers=0.0)
        water_glsl.fill(self.farther.GetInput(), nearest)

    def distances(self) -> np.ndarray:
        """(height, width, 4) of the back faces, from the lowest row on."""
        self.measure.render()
        return self.measure.screenshot(None, return_img=True, transparent_background=True)[::-1]

    def see(self) -> None:
        """What is drawn now is what water drawn from now on is seen before."""
        for mark in self.stage.over:
            mark.VisibilityOff()
        self.stage.plotter.render()
        for mark in self.stage.over:
            mark.VisibilityOn()
        water_glsl.fill(self.behind.GetInput(), self.stage.plotter.screenshot(None, return_img=True)[::-1])

    def close(self) -> None:
        self.measure.close()
