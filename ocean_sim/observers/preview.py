"""A picture while the simulation goes on, drawn by GGUI in a window or without one.

The only file with ti.ui.

Where there is no window, `show` would end the process, events are refused, and the panel settles in its first
pictures (sliders come with the second, corners with the third); so those are drawn and thrown away.
"""

import sys
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from pydantic import Field, field_validator

from ocean_sim.files.whole_file import whole
from ocean_sim.kernel_library import ti
from ocean_sim.model import quantity
from ocean_sim.observers.shared.csv_rows import Multiples
from ocean_sim.parts import Preflight, Problems
from ocean_sim.pictures.buffers import Buffer, Mesh
from ocean_sim.pictures.controls import controls
from ocean_sim.pictures.curves import KEPT, NAMES, Curves
from ocean_sim.pictures.pad import Pad
from ocean_sim.pictures.panel import HELM, Panel, after, sliders_of
from ocean_sim.pictures.preview_eye import Eye, Orbit, View, seen
from ocean_sim.pictures.preview_scene import SPEEDS, Balls, PreviewScene, backdrop
from ocean_sim.pictures.vulkan import ScreenMissing, VulkanMissing, require
from ocean_sim.simulation import Observer, PeriodicConfig

if TYPE_CHECKING:
    from ocean_sim.simulation import Simulation

__all__ = ["Config", "Panel", "Preview", "Screen", "ScreenMissing", "VulkanMissing", "require"]

PANEL = 292  # [pixels] width of the panel at the left
EDGE, CHART, LABEL = 10, 76, 52  # [pixels] around everything, height of a curve, height of the words over it
CURVE_COLOURS = {"H_s": (0.45, 0.80, 1.0), "roll": (1.0, 0.75, 0.30), "picture": (0.85, 0.85, 0.85)}
WARMING = 3  # pictures that are thrown away
SHADE = (0.07, 0.09, 0.11)


class Config(PeriodicConfig):
    leaves: ClassVar[str] = "preview/*.png; pictures while it runs"
    reads_surface: ClassVar[bool] = True
    every: float = quantity("s", 1.0 / 30.0, gt=0.0)
    """Simulated time between pictures."""
    size: tuple[int, int] = Field((1280, 720), strict=False, json_schema_extra={"unit": "pixels"})
    """Width and height of the pictures."""
    camera: Literal["third_person", "helm", "top", "side"] = "third_person"
    """`third_person`, `helm`, `top` or `side`."""
    content: Literal["surface", "particles", "both"] = "surface"
    """`surface`, `particles` or `both`."""
    panel: bool = True
    """Whether the panel and the curves are in the picture."""
    ship: str | None = None
    """The name of the ship that keys steer and cameras follow at first; null: the first."""

    @field_validator("size")
    @classmethod
    def _room(cls, size: tuple[int, int]) -> tuple[int, int]:
        if not (960 <= size[0] <= 7680 and 640 <= size[1] <= 4320):
            raise ValueError(f"the panel needs a picture of 960 x 640 pixels, at most 7680 x 4320, not {list(size)}")
        return size

    def mismatches(self, preflight: Preflight) -> Problems:
        return [] if self.ship is None else preflight.unknown_ship(self.ship)

    def build(self, folder: Path, simulation: "Simulation") -> "Preview":
        return Preview(self, folder, simulation)


class Preview(Observer):
    """Numbered pictures in the folder preview/ of a run, from the same drawing as the window's."""

    left_out = ("screen",)  # what a checkpoint of it does not hold

    def __init__(self, config: Config, folder: Path, simulation: "Simulation") -> None:
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
        self.panel = Panel([], simulation.scene.wind.kind)
        self.screen.watch(simulation, self.panel, config)

    def observe(self, simulation: "Simulation") -> None:
        if self.screen is not None and self.multiples.reached(simulation.time):
            self.screen.draw(self.panel, None)
            write(self.folder / f"{self.drawn:05d}.png", self.screen.image())
            self.drawn += 1

    def close(self) -> None:
        if self.screen is not None:
            self.screen.close()
            self.screen = None


class Screen:
    """A GGUI window, on a screen or hidden, and everything that is drawn in it.

    Raises VulkanMissing where GGUI has no Vulkan.
    """

    def __init__(self, config: Config, show: bool) -> None:
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
        self.water, self.hull = Mesh(), Mesh()
        self.behind, self.behind_colours = Buffer(2), Buffer(3)
        self.positions, self.tints = Buffer(3), Buffer(3)
        self.ends, self.hues = Buffer(3), Buffer(3)
        self.curves = {name: Buffer(2) for name in NAMES}
        self.shades, self.bar, self.bar_colours = Buffer(2), Buffer(2), Buffer(3)
        self.fresh = 0 if show else WARMING
        self.pad = Pad()
        self.pressed: set[str] = set()
        self.cursor: tuple[float, float] | None = None

    def watch(self, simulation: "Simulation", panel: Panel, config: Config | None = None) -> None:
        """Show another simulation from now on; the panel gets its sliders, cameras and contents."""
        self.simulation, self.scene, panel.curves = simulation, PreviewScene(simulation), Curves()
        panel.cameras, panel.contents, panel.person = self.scene.cameras, self.scene.contents, None
        panel.ships = tuple(simulation.ships)
        if config is not None:
            panel.camera, panel.content, panel.ship = config.camera, config.content, config.ship or ""
            panel.hidden = not config.panel
        panel.ship = panel.ship if panel.ship in panel.ships else next(iter(panel.ships), "")
        panel.camera = panel.camera if panel.camera in panel.cameras else panel.cameras[0]
        panel.content = panel.content if panel.content in panel.contents else after("", panel.contents or ("surface",))
        panel.bind(sliders_of(simulation))

    def draw(self, panel: Panel, milliseconds: float | None, pace: float | None = None) -> None:
        """Make a picture of the simulation as it is; `milliseconds` the last one took, `pace` times real time it
        runs."""
        heights = self.scene.heights()
        roll = float(self.simulation.ships[panel.ship].body.angles[2]) if panel.ship else None
        panel.curves.add(self.simulation.time, heights, roll, milliseconds)
        for _ in range(self.fresh):
            self.compose(panel, heights, pace)
            self.window.get_image_buffer_as_numpy()
        self.fresh = 0
        self.compose(panel, heights, pace)

    def compose(self, panel: Panel, heights: np.ndarray, pace: float | None) -> None:
        """Hand the window everything that is in the picture."""
        eye = self.eye(panel)
        self.plain.set_camera(self.camera)
        self.plain.ambient_light((1.0, 1.0, 1.0))
        corners, colours = backdrop(eye, self.size[0] / self.size[1])
        self.behind.put(corners)
        self.behind_colours.put(colours)
        self.canvas.triangles(self.behind.field, per_vertex_color=self.behind_colours.field)
        water = (
            self.scene.water(heights, eye.position, panel.content == "surface")
            if panel.content != "particles"
            else None
        )
        if water is not None:
            self.water.put(water)
            self.water.show(self.plain, wires=panel.content == "both")
        hull = self.scene.afloat()
        if hull is not None:
            self.hull.put(hull)
            self.hull.show(self.plain)
        ends, hues = self.scene.lines()
        if len(ends):
            count = self.ends.put(ends.reshape(-1, 3))
            self.hues.put(np.repeat(hues, 2, axis=0))
            self.plain.lines(self.ends.field, 2.0, per_vertex_color=self.hues.field, vertex_count=count)
        self.canvas.scene(self.plain)
        balls = self.scene.particles(panel.content == "both") if panel.content != "surface" else None
        if balls is not None and len(balls.positions):
            self.balls(balls, eye)
        if not panel.hidden:
            self.charts(panel.curves)
            self.words(panel, pace)
        if balls is not None:
            self.legend(self.window.get_gui(), balls)

    def eye(self, panel: Panel) -> Eye:
        width, height = self.size
        left, bottom = (PANEL + 2 * EDGE) / width, (CHART + LABEL + 2 * EDGE) / height
        left, bottom = (EDGE / width, EDGE / height) if panel.hidden else (left, bottom)
        above = 3 * EDGE if panel.content == "surface" else 4 * EDGE + LABEL  # the legend of the particles
        free = (left, bottom, 1.0 - left - EDGE / width, 1.0 - bottom - above / height)
        orbit = Orbit(panel.azimuth, panel.height, panel.distance)
        view = View(self.scene.box, free, width / height)
        ship = self.simulation.ships.get(panel.ship)
        eye = seen(panel.camera, orbit, view, ship, self.scene.lengths.get(panel.ship, 0.0))
        self.camera.position(*eye.position)
        self.camera.lookat(*eye.target)
        self.camera.up(*eye.up)
        self.camera.fov(eye.angle)
        self.camera.z_near(eye.near)
        self.camera.z_far(eye.far)
        return eye

    def balls(self, balls: Balls, eye: Eye) -> None:
        """The particles; their lights are set after the plain scene was handed over, which would take them, too."""
        self.lit.set_camera(self.camera)
        self.lit.ambient_light((0.55, 0.55, 0.55))
        self.lit.point_light(pos=tuple(eye.position + [-200.0, 300.0, -100.0]), color=(0.6, 0.6, 0.6))
        count = self.positions.put(balls.positions)
        self.tints.put(balls.colours)
        self.lit.particles(
            self.positions.field, radius=balls.radius, per_vertex_color=self.tints.field, index_count=count
        )
        self.canvas.scene(self.lit)

    def charts(self, curves: Curves) -> None:
        """The curves at the bottom, each in a box of its own."""
        shades = [self.chart(k) for k in range(len(NAMES))]
        corners = np.array(
            [[(x, y), (x + w, y), (x + w, y + h), (x, y), (x + w, y + h), (x, y + h)] for x, y, w, h in shades]
        )
        self.shades.put(corners.reshape(-1, 2))
        self.canvas.triangles(self.shades.field, color=SHADE)
        for k, name in enumerate(NAMES):
            lines = curves.lines(name, self.chart(k))
            if len(lines):
                self.curves[name].put(padded(lines))
                self.canvas.lines(self.curves[name].field, width=0.0022, color=CURVE_COLOURS[name])

    def chart(self, k: int) -> tuple[float, float, float, float]:
        """x, y, width and height of curve k, as shares of the picture, y upwards."""
        width, height = self.size
        each = (width - PANEL - (len(NAMES) + 2) * EDGE) / len(NAMES)
        return (PANEL + 2 * EDGE + k * (each + EDGE)) / width, EDGE / height, each / width, CHART / height

    def words(self, panel: Panel, pace: float | None) -> None:
        """The panel and the words over the curves; what is moved or pressed there is taken at once."""
        gui, (width, height) = self.window.get_gui(), self.size
        names = {"H_s": "significant wave height", "roll": "roll, starboard down", "picture": "time per picture"}
        for k, name in enumerate(NAMES):
            x, y, w, h = self.chart(k)
            with gui.sub_window(names[name], x, 1.0 - y - h - LABEL / height, w, LABEL / height) as box:
                box.text(panel.curves.reading(name))
        with gui.sub_window("Ocean Sim", EDGE / width, EDGE / height, PANEL / width, 1.0 - 2 * EDGE / height) as box:
            controls(box, panel, self.simulation, pace)

    def legend(self, gui: Any, balls: Balls) -> None:
        """What the colours of the particles mean."""
        width, height = self.size
        w, h, x = 260 / width, 14 / height, 1.0 - (260 + EDGE) / width
        y = 1.0 - (EDGE + LABEL) / height - h
        at = np.linspace(0.0, 1.0, len(SPEEDS))
        quads, colours = [], []
        for k in range(len(SPEEDS) - 1):
            a, b = x + w * at[k], x + w * at[k + 1]
            quads += [(a, y), (b, y), (b, y + h), (a, y), (b, y + h), (a, y + h)]
            colours += [SPEEDS[j] for j in (k, k + 1, k + 1, k, k + 1, k)]
        self.bar.put(np.array(quads))
        self.bar_colours.put(np.array(colours))
        self.canvas.triangles(self.bar.field, per_vertex_color=self.bar_colours.field)
        with gui.sub_window("speed of particles", x, EDGE / height, w, LABEL / height) as box:
            some = f", 1 of {balls.every} drawn" if balls.every > 1 else ""
            box.text(f"0 to {balls.fastest:.2g} m/s{some}")

    def image(self) -> np.ndarray:
        """(width, height, 3) the picture as it is in the window, 8-bit, from its left lower corner."""
        buffer = self.window.get_image_buffer_as_numpy()
        buffer *= 255.0
        buffer += 0.5
        return buffer.astype(np.uint8)[..., :3]

    def listen(self, panel: Panel, seconds: float) -> None:
        """Take what keyboard, mouse and pad did in the last so many seconds."""
        panel.closed = panel.closed or not self.window.running
        for event in self.window.get_events(ti.ui.PRESS):
            panel.press(event.key)
        panel.hold({key for key in HELM if self.window.is_pressed(key)}, seconds)
        self.pad.look()
        panel.steer(*self.pad.held, seconds)
        if self.pad.amidships:
            panel.do("rudder amidships")
        for key, factor in (("q", 0.5), ("e", 2.0)):
            if self.window.is_pressed(key):
                panel.nearer(factor**seconds)
        cursor = self.window.get_cursor_pos() if self.window.is_pressed(ti.ui.LMB, ti.ui.RMB) else None
        if cursor is not None and self.cursor is not None and (panel.hidden or cursor[0] > PANEL / self.size[0]):
            panel.orbit(cursor[0] - self.cursor[0], cursor[1] - self.cursor[1])
        self.cursor = cursor

    def show(self) -> None:
        """Put the picture on the screen; without one this must not be called, so it does nothing."""
        if self.shown:
            self.window.show()

    def close(self) -> None:
        """Release the window, the scenes first: they live on its graphics device."""
        self.pad.close()
        self.plain = self.lit = self.canvas = self.camera = None
        self.window.destroy()
        self.window = None
        if self.litter is not None:
            self.litter.unlink(missing_ok=True)


def write(path: Path, image: np.ndarray) -> None:
    """A picture as a PNG file, there whole or not at all."""
    with whole(path) as draft:
        ti.tools.imwrite(np.ascontiguousarray(image), str(draft))


def padded(lines: np.ndarray) -> np.ndarray:
    """(n, 2, 2) -> (m, 2) ends, as many as a full curve has: the last end again."""
    ends = lines.reshape(-1, 2)
    return np.concatenate([ends, np.tile(ends[-1], (2 * KEPT - len(ends), 1))])
