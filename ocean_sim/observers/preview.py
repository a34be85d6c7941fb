"""A picture while the simulation goes on, drawn by GGUI in a window or without one.

The only file with ti.ui. Without a window, `show` would end the process, events are refused, and the panel settles in
its first pictures (corners come with the third), which are therefore thrown away.
"""

import sys
import warnings
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import Field, field_validator

from ocean_sim.files.atomic_file import atomic_write
from ocean_sim.kernel_library import ti
from ocean_sim.model import Faults, quantity
from ocean_sim.observers.shared.csv_rows import Multiples
from ocean_sim.parts import PeriodicConfig, SceneFacts
from ocean_sim.pictures.live.panel import HELM_KEYS, Panel
from ocean_sim.pictures.live.preview_scene import Patch, PreviewScene
from ocean_sim.pictures.live.scene_lines import scene_lines
from ocean_sim.pictures.live.vulkan import VulkanMissing, require
from ocean_sim.simulation import Observer, Simulation

PANEL_WIDTH, PANEL_HEIGHT, PANEL_EDGE = 292, 500, 10  # [pixels] of the panel at the left, and around it
SETTLING_PICTURES = 3  # thrown away
LINE_WIDTH = 2.0  # [pixels]
BALL_RADII = {"particles": 0.3, "both": 0.15}  # [spacings] by what is shown
SKY_TOP, SKY_BOTTOM = (0.25, 0.45, 0.70), (0.80, 0.87, 0.92)  # display RGB of the backdrop
FAR_OVER_NEAR = 20_000.0  # greatest over least distance that is drawn


class Config(PeriodicConfig):
    leaves: ClassVar[str] = "preview/*.png; pictures while it runs"
    every: float = quantity("s", 1.0 / 30.0, gt=0.0)
    """Simulated time between pictures."""
    size: tuple[int, int] = Field((1280, 720), strict=False, json_schema_extra={"unit": "pixels"})
    """Width and height of the pictures."""
    camera: Literal["third_person", "helm", "top", "side"] = "third_person"
    """`third_person`, `helm`, `top` or `side`."""
    content: Literal["surface", "particles", "both"] = "surface"
    """`surface`, `particles` or `both`."""
    panel: bool = True
    """True if the panel is in the picture."""
    ship: str | None = None
    """The name of the ship that keys steer and cameras follow at first; null: the first."""

    @field_validator("size")
    @classmethod
    def _has_room(cls, size: tuple[int, int]) -> tuple[int, int]:
        if not (960 <= size[0] <= 7680 and 640 <= size[1] <= 4320):
            raise ValueError(f"the panel needs a picture of 960 x 640 pixels, at most 7680 x 4320, not {list(size)}")
        return size

    def mismatches(self, preflight: SceneFacts) -> Faults:
        return preflight.unknown_ship(self.ship)

    def first_panel(self) -> Panel:
        """Panel (controls of the window) with the camera, content and ship that these keys choose."""
        return Panel(self.camera, self.content, self.ship or "", hidden=not self.panel)


class Preview(Observer, of=Config):
    """Writes numbered pictures into the folder preview/ of a run, drawn as in the window of `ocean-sim preview`."""

    left_out = ("screen", "panel")  # of its checkpoints: config gives both

    def __init__(self, config: Config, folder: Path, simulation: Simulation) -> None:
        self.every, self.multiples = config.every, Multiples(config.every)
        self.folder, self.drawn = folder / "preview", 0
        self.screen: Screen | None = None
        try:
            require(show=False)
            self.screen = Screen(config, show=False)
        except VulkanMissing as problem:
            print(f"no preview: {problem}", file=sys.stderr)
            return
        self.folder.mkdir(exist_ok=True)
        self.panel = config.first_panel()
        self.screen.watch(simulation, self.panel)

    def observe(self, simulation: Simulation) -> None:
        if self.screen is not None and self.multiples.reached(simulation.time):
            self.screen.draw(self.panel)
            write_png(self.folder / f"{self.drawn:05d}.png", self.screen.image())
            self.drawn += 1

    def close(self) -> None:
        if self.screen is not None:
            self.screen.close()
            self.screen = None


class Buffer:
    """Taichi field of vectors or whole numbers from which GGUI draws; it grows if more values are put into it."""

    def __init__(self, length: int = 3) -> None:
        """`length`: components of the vectors drawn (points, colours); 0: whole numbers (corners of triangles)."""
        self.length = length
        self.field: Any = None

    def put(self, values: np.ndarray) -> int:
        """Copy (n, length) or (n,) values into the field, padded with the last, as GGUI may draw all; return n."""
        n = len(values)
        if self.field is None or self.field.shape[0] < n:
            room = max(64, 2 ** int(np.ceil(np.log2(max(n, 1)))))
            self.field = ti.Vector.field(self.length, ti.f32, room) if self.length else ti.field(ti.i32, room)
            self.host = np.zeros((room, self.length) if self.length else room, np.float32 if self.length else np.int32)
        self.host[:n] = values
        self.host[n:] = values[-1] if n else 0
        self.field.from_numpy(self.host)
        return n


class Mesh:
    """Triangles in plain colours, in fields that GGUI reads. They are drawn with one identity transform: without any,
    GGUI's shader adds an uninitialised buffer times zero, and a NaN in it makes triangles vanish."""

    def __init__(self) -> None:
        self.transform = ti.Matrix.field(4, 4, ti.f32, 1)
        self.transform[0] = np.eye(4).tolist()
        self.vertices, self.normals, self.colours, self.corners = Buffer(), Buffer(), Buffer(), Buffer(0)

    def show(self, scene: Any, patch: Patch | None, wires: bool = False) -> None:
        """Add a `Patch` (coloured triangles), unless None, to a GGUI scene; `wires`: True to draw only their edges."""
        if patch is None:
            return
        self.normals.put(np.broadcast_to([0.0, 1.0, 0.0], patch.vertices.shape))  # plain colours need none, GGUI does
        self.colours.put(patch.colours)
        scene.mesh_instance(
            vertex_count=self.vertices.put(patch.vertices),
            vertices=self.vertices.field,
            index_count=self.corners.put(patch.triangles.ravel()),
            indices=self.corners.field,
            transforms=self.transform,
            normals=self.normals.field,
            per_vertex_color=self.colours.field,
            two_sided=True,
            show_wireframe=wires,
        )


class Screen:
    """GGUI window, on a screen or hidden, and everything drawn in it; raises VulkanMissing if GGUI has no Vulkan."""

    def __init__(self, config: Config, show: bool) -> None:
        """`show`: True for a window on the screen, False for a hidden one."""
        self.size, self.shown = config.size, show
        notes = Path("imgui.ini").absolute()  # GGUI keeps where its boxes stand in the working directory
        self.litter = None if notes.exists() else notes
        try:
            self.window = ti.ui.Window("Ocean Sim", config.size, vsync=show, show_window=show)
        except RuntimeError as problem:
            raise VulkanMissing from problem
        self.canvas, self.camera = self.window.get_canvas(), ti.ui.Camera()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # two scenes: plain colours, and lit balls
            self.plain, self.lit = ti.ui.Scene(), ti.ui.Scene()
        self.water, self.hull, self.sand = Mesh(), Mesh(), Mesh()
        self.backdrop, self.backdrop_colours = Buffer(2), Buffer()
        corners = np.array([[0, 0], [1, 0], [1, 1], [0, 0], [1, 1], [0, 1]])
        self.backdrop.put(corners)
        self.backdrop_colours.put(np.where(corners[:, 1:] > 0, SKY_TOP, SKY_BOTTOM))
        self.positions, self.tints, self.ends, self.hues = Buffer(), Buffer(), Buffer(), Buffer()
        self.settling = 0 if show else SETTLING_PICTURES
        self.cursor: tuple[float, float] | None = None

    def watch(self, simulation: Simulation, panel: Panel) -> None:
        """Draw this simulation from now on, and offer its cameras, contents and ships to the user in the panel."""
        self.simulation, self.scene = simulation, PreviewScene(simulation)
        panel.offer(self.scene.cameras, self.scene.contents, tuple(simulation.ships))

    def draw(self, panel: Panel, pace: float | None = None) -> None:
        """Draw the present state; `pace`: simulated over real time, for the panel, None if unknown."""
        for _ in range(self.settling):
            self.compose(panel, pace)
            self.window.get_image_buffer_as_numpy()
        self.settling = 0
        self.compose(panel, pace)

    def compose(self, panel: Panel, pace: float | None) -> None:
        """Pass all that a picture shows (sky, water, ships, particles, panel) to the window; `pace` as in `draw`."""
        eye = self.point_camera(panel)
        self.canvas.triangles(self.backdrop.field, per_vertex_color=self.backdrop_colours.field)
        self.plain.set_camera(self.camera)
        self.plain.ambient_light((1.0, 1.0, 1.0))
        solid = panel.content == "surface"
        if panel.content != "particles":
            self.water.show(self.plain, self.scene.water_patch(eye, solid), not solid)
        self.hull.show(self.plain, self.scene.ship_patch())
        self.sand.show(self.plain, self.scene.sand)
        ends, hues = scene_lines(self.simulation, self.scene.box[1][1])
        count = self.ends.put(ends.reshape(-1, 3))
        self.hues.put(np.repeat(hues, 2, axis=0))
        self.plain.lines(self.ends.field, LINE_WIDTH, per_vertex_color=self.hues.field, vertex_count=count)
        self.canvas.scene(self.plain)
        balls = None if solid else self.scene.particle_balls()
        if balls is not None and len(balls[0]):
            self.show_balls(*balls, BALL_RADII[panel.content] * self.scene.spacing, eye)
        if not panel.hidden:
            width, height = self.size
            place = (PANEL_EDGE / width, PANEL_EDGE / height, PANEL_WIDTH / width, PANEL_HEIGHT / height)
            with self.window.get_gui().sub_window("Ocean Sim", *place) as box:
                box.text(panel.text(self.simulation, None if balls is None else self.scene.fastest, pace))

    def point_camera(self, panel: Panel) -> np.ndarray:
        """Place the window's camera as the panel chooses; returns the position of the eye (3,) [m]."""
        width, height = self.size
        covered = 0.0 if panel.hidden else (PANEL_WIDTH + 2 * PANEL_EDGE) / width
        camera = self.scene.camera(panel, width / height, covered)
        assert camera.near is not None
        self.camera.position(*camera.eye)
        self.camera.lookat(*(camera.eye + camera.forward))
        self.camera.up(*camera.up)
        self.camera.fov(camera.angle)
        self.camera.z_near(camera.near)
        self.camera.z_far(FAR_OVER_NEAR * camera.near)
        return camera.eye

    def show_balls(self, positions: np.ndarray, colours: np.ndarray, radius: float, eye: np.ndarray) -> None:
        """Draw lit balls of a `radius` [m] at `positions` (n, 3) [m] for an eye (3,) [m], in `colours` (n, 3), RGB 0 to
        1; call it last, as its lights would change all before."""
        self.lit.set_camera(self.camera)
        self.lit.ambient_light((0.55, 0.55, 0.55))
        self.lit.point_light(pos=tuple(eye + [-200.0, 300.0, -100.0]), color=(0.6, 0.6, 0.6))
        count = self.positions.put(positions)
        self.tints.put(colours)
        self.lit.particles(self.positions.field, radius=radius, per_vertex_color=self.tints.field, index_count=count)
        self.canvas.scene(self.lit)

    def image(self) -> np.ndarray:
        """Picture (width, height, 3) in the window, 8-bit RGB; pixel [0, 0] is the lower left corner."""
        return (255.0 * self.window.get_image_buffer_as_numpy()[..., :3] + 0.5).astype(np.uint8)

    def listen(self, panel: Panel, seconds: float) -> None:
        """Apply the user's keys and mouse moves to the panel; `seconds`: wall time since the last call."""
        panel.closed = panel.closed or not self.window.running
        for event in self.window.get_events(ti.ui.PRESS):
            panel.press(event.key)
        panel.hold({key for key in HELM_KEYS if self.window.is_pressed(key)}, seconds)
        for key, factor in (("q", 0.5), ("e", 2.0)):
            if self.window.is_pressed(key):
                panel.zoom(factor**seconds)
        cursor = self.window.get_cursor_pos() if self.window.is_pressed(ti.ui.LMB, ti.ui.RMB) else None
        if cursor is not None and self.cursor is not None and (panel.hidden or cursor[0] > PANEL_WIDTH / self.size[0]):
            panel.orbit(cursor[0] - self.cursor[0], cursor[1] - self.cursor[1])
        self.cursor = cursor

    def show(self) -> None:
        if self.shown:
            self.window.show()

    def close(self) -> None:
        """Release the window; its scenes come first, since they use its graphics device."""
        self.plain = self.lit = self.canvas = self.camera = None
        self.window.destroy()
        self.window = None
        if self.litter is not None:
            self.litter.unlink(missing_ok=True)


def write_png(path: Path, image: np.ndarray) -> None:
    """Write `image` (width, height, 3), 8-bit RGB, from its lower left corner, as a PNG file, atomically."""
    with atomic_write(path) as draft:
        ti.tools.imwrite(np.ascontiguousarray(image), str(draft))
