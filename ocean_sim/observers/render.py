"""Pictures and a film from the frames of a run, drawn off screen; the only file with PyVista and imageio.

Everything is drawn in a child process, `python -m ocean_sim.observers.render ORDER`: where OpenGL is missing VTK ends
its process without an exception, and a run that went well must end well.
"""

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import Field, field_validator

from ocean_sim.observers import _opengl, _sky, _water_shading
from ocean_sim.observers._camera import VIEW_ANGLE, Name, placed
from ocean_sim.observers._water_mesh import WaterMesh
from ocean_sim.parts import ObserverConfig, quantity

if TYPE_CHECKING:
    from ocean_sim.simulation import Simulation

Quality = Literal["draft", "final"]
NODES = {"draft": 40_000, "final": 160_000}  # of the drawn surface
HULL, DECK = np.array([206.0, 74.0, 52.0]), np.array([238.0, 226.0, 204.0])  # colours in full sun
FAR = 6.0  # lengths of a ship; in a longer basin the camera follows it
SHIPS = 1.5  # lengths of a ship that a camera which follows it sees each way
Progress = Callable[[int, int], None]  # pictures drawn, pictures in all
OpenGLMissing = _opengl.OpenGLMissing
probe = _opengl.probe


class RenderFailed(Exception):
    """No picture came out; the message says why."""


class Config(ObserverConfig):
    every: float = quantity("s", 0.033, gt=0.0)
    """Simulated time between pictures of the film, which runs in real time."""
    camera: Name = "third_person"
    """`third_person`, `top` or `side`."""
    size: tuple[int, int] = Field((960, 540), strict=False, json_schema_extra={"unit": "pixels"})
    """Width and height of the pictures, even numbers."""
    particles: bool = False
    """Draw the particles, coloured by speed, in place of the surface of the water."""
    quality: Quality = "draft"
    """`draft`: quick; `final`: finer mesh and smooth edges."""

    @field_validator("size")
    @classmethod
    def even(cls, size: tuple[int, int]) -> tuple[int, int]:
        if any(n % 2 or not 64 <= n <= 7680 for n in size):
            raise ValueError(f"a film needs an even width and height between 64 and 7680 pixels, not {list(size)}")
        return size

    def build(self, folder: Path, simulation: "Simulation") -> "Render":
        return Render(self, folder, simulation)


class Render:
    """Draws preview.png and film.mp4 when the run is over, from what `frames` kept."""

    every = 0.0

    def __init__(self, config: Config, folder: Path, simulation: "Simulation") -> None:
        self.config, self.folder, self.simulation = config, folder, simulation
        self.progress: Progress | None = None

    def observe(self, simulation: "Simulation") -> None:
        pass

    def close(self) -> None:
        if not frame_files(self.folder):
            return
        if self.simulation.reason == "interrupted":  # who stops a run does not want to wait for its film
            print(f"no pictures; `ocean-sim render {self.folder}` draws them", file=sys.stderr)
            return
        try:
            render_run(self.folder, **self.config.model_dump(), progress=self.progress)
        except (OpenGLMissing, RenderFailed) as problem:
            print(f"no pictures: {problem}", file=sys.stderr)


@dataclass(frozen=True)
class Order:
    """What to draw and where to put it."""

    folder: str
    out: str
    camera: Name
    size: tuple[int, int]
    particles: bool
    quality: Quality
    every: float
    film: bool


def render_run(
    folder: Path,
    *,
    camera: Name = "third_person",
    quality: Quality = "draft",
    size: tuple[int, int] = (960, 540),
    particles: bool = False,
    every: float = 0.033,
    film: bool = True,
    out: Path | None = None,
    progress: Progress | None = None,
) -> list[Path]:
    """Draw preview.png, and film.mp4 when asked, into `out`; raises OpenGLMissing or RenderFailed."""
    if not frame_files(folder):
        raise RenderFailed(f"{folder} has no frames to draw; run with the observer `frames`")
    window = _opengl.window()
    if window is None:
        raise OpenGLMissing
    out = out or folder
    out.mkdir(parents=True, exist_ok=True)
    order = Order(str(folder), str(out), camera, size, particles, quality, every, film)
    command = [sys.executable, "-m", "ocean_sim.observers.render", json.dumps(asdict(order))]
    with tempfile.TemporaryFile("w+") as complaints:
        child = subprocess.Popen(
            command, env=_opengl.environment(window), stdout=subprocess.PIPE, stderr=complaints, text=True
        )
        try:
            follow(child, progress)
        finally:
            child.kill()
            child.wait()
        complaints.seek(0)
        said = complaints.read().strip()
    if child.returncode < 0:
        _opengl.forget()
        raise RenderFailed(f"the drawing process died (signal {-child.returncode}); {OpenGLMissing()}")
    if child.returncode > 0:
        raise RenderFailed(said.splitlines()[-1] if said else "the drawing process ended without a word")
    return [out / name for name in ("preview.png", "film.mp4") if film or name == "preview.png"]


def follow(child: "subprocess.Popen[str]", progress: Progress | None) -> None:
    """Reads "pictures 3 of 600" from the child until it ends."""
    assert child.stdout is not None
    for line in child.stdout:
        words = line.split()
        if progress is not None and words[:1] == ["pictures"]:
            progress(int(words[1]), int(words[3]))
    child.wait()


def frame_files(folder: Path) -> list[Path]:
    return sorted((folder / "frames").glob("frame_*.npz"))


class Frame:
    """One file of frames/, read when asked for."""

    def __init__(self, path: Path) -> None:
        with np.load(path) as file:
            self.time = float(file["time"])
            self.elevation = file["elevation"].astype(np.float64)
            self.position = file["position"] if "position" in file else None
            self.velocity = file["velocity"] if "velocity" in file else None
            self.ship = (file["ship_position"], file["ship_turn"]) if "ship_position" in file else None
            self.mesh = [file[name] for name in ("vertices", "triangles", "normals")] if "vertices" in file else None

    @property
    def folds(self) -> bool:
        """Whether the surface is more than a height above each point: some of its triangles do not face up."""
        if self.mesh is None:
            return False
        a, b, c = (self.mesh[0][self.mesh[1][:, k]] for k in range(3))
        return bool((np.cross(b - a, c - a)[:, 1] <= 0.0).any())


class Picture:
    """One plotter, built once; each frame only moves its points and colours."""

    def __init__(self, grid: Any, order: Order, first: Frame, fastest: float) -> None:
        import pyvista

        self.pyvista, self.order = pyvista, order
        self.plotter = pyvista.Plotter(off_screen=True, window_size=order.size, lighting="none")
        self.plotter.disable_anti_aliasing()  # PyVista's default multiplies the time of a picture
        self.plotter.render_window.SetMultiSamples(0)
        self.lower, self.upper = grid["lower"].copy(), grid["upper"].copy()
        self.upper[1] = max(0.12 * float(grid["depth"]), float(first.elevation.max()))
        flat = bool(self.lower[2] == self.upper[2])
        self.camera = placed("side" if flat else order.camera, self.lower, self.upper, order.size[0] / order.size[1])
        self.reach = float(np.linalg.norm(self.camera.eye - 0.5 * (self.lower + self.upper)))  # [m]
        self.backdrop()
        if order.particles or not bool(grid["has_surface"]):
            if first.position is None:
                raise RenderFailed("these frames hold no particles to draw; run with frames.particles: true")
            self.content: Water | Shell | Particles = Particles(self, first, float(grid["spacing"]), fastest)
        elif first.folds:
            self.content = Shell(self, float(grid["depth"]))
        else:
            self.content = Water(self, grid)
        self.ship = Ship(self, grid) if "ship_vertices" in grid else None
        self.caption = self.plotter.add_text("t", position=(14, 10), font_size=9, color="#eef3f6", shadow=True)
        self.aim()

    def aim(self) -> None:
        camera, plotter = self.camera, self.plotter
        plotter.camera.position, plotter.camera.focal_point = tuple(camera.eye), tuple(camera.eye + camera.forward)
        plotter.camera.up, plotter.camera.view_angle = tuple(camera.up), VIEW_ANGLE
        reach = self.reach
        plotter.camera.clipping_range = (0.01 * reach, 12.0 * reach)
        if camera.parallel_height is not None:
            plotter.enable_parallel_projection()
            plotter.camera.parallel_scale = camera.parallel_height

    def backdrop(self) -> None:
        """The sky around the eye; in parallel projection there is no horizon, and a plain gradient stands for it."""
        if self.camera.parallel_height is not None:
            low, high = _water_shading.display(_sky.around(np.array([[0.0, 0.02, -1.0], [0.0, 0.2, -0.98]]))) / 255.0
            self.plotter.set_background(low, top=high)
            return
        radius = 6.0 * self.reach
        dome = self.pyvista.Sphere(radius=1.0, theta_resolution=90, phi_resolution=361, direction=(0.0, 1.0, 0.0))
        directions = _sky.unit(np.asarray(dome.points, dtype=float))
        dome.points = (self.camera.eye + radius * directions).astype(np.float32)
        dome["colour"] = _water_shading.display(_sky.around(directions))
        self.dome = self.plotter.add_mesh(dome, scalars="colour", rgb=True, lighting=False, smooth_shading=False)
        self.first_eye = self.camera.eye
        if self.camera.forward[1] > -0.9:
            self.shadow()

    def shadow(self) -> None:
        """A soft shadow on the ground, so that the block of water stands on something."""
        size, middle = self.upper - self.lower, 0.5 * (self.lower + self.upper)
        plane = self.pyvista.Plane(
            center=(middle[0], self.lower[1] - 0.005 * size[1], middle[2]),  # below a dry bed
            direction=(0.0, 1.0, 0.0),
            i_size=2.4 * size[2],
            j_size=2.4 * size[0],
            i_resolution=80,
            j_resolution=80,
        )
        away = np.asarray(plane.points, dtype=float) + 0.5 * size[1] * _sky.SUN
        outside = np.maximum(0.0, np.maximum(self.lower - away, away - self.upper))[:, [0, 2]]
        reach = 0.10 * max(size[0], size[2])
        darkness = 0.5 * np.exp(-np.square(outside / reach).sum(axis=1))
        plane["colour"] = np.column_stack([np.full((plane.n_points, 3), (8, 20, 30)), 255 * darkness]).astype(np.uint8)
        self.plotter.add_mesh(plane, scalars="colour", rgba=True, lighting=False)

    def draw(self, frame: Frame) -> np.ndarray:
        if self.ship is not None and frame.ship is not None:
            self.ship.show(*frame.ship)
            if self.order.camera == "third_person":
                self.follow(frame.ship[0])
        self.content.show(frame)
        self.caption.input = f"t = {frame.time:.2f} s"
        self.plotter.render()
        return self.plotter.screenshot(None, return_img=True)

    def follow(self, position: np.ndarray) -> None:
        """Move with the ship, where the basin is many times as long as it."""
        assert self.ship is not None
        reach = SHIPS * self.ship.length * np.array([1.0, 0.0, 1.0])
        lower, upper = np.maximum(self.lower, position - reach), np.minimum(self.upper, position + reach)
        lower[1], upper[1] = self.lower[1], self.upper[1]
        if (self.upper - self.lower).max() > FAR * self.ship.length:
            lower[1] = max(lower[1], -self.ship.length)
            self.camera = placed("third_person", lower, upper, self.order.size[0] / self.order.size[1])
            self.dome.position = tuple(self.camera.eye - self.first_eye)
            if not isinstance(self.content, Particles):
                self.content.eye = self.camera.eye
            self.aim()

    def smooth(self, on: bool) -> None:
        """Whether edges are smoothed: slow, so only for final pictures and the preview."""
        if on:
            self.plotter.enable_anti_aliasing("ssaa")
        else:
            self.plotter.disable_anti_aliasing()

    def close(self) -> None:
        self.plotter.close()


class Water:
    """The surface and the cut sides of the water, coloured at their nodes for the eye of the picture."""

    def __init__(self, picture: Picture, grid: Any) -> None:
        pyvista = picture.pyvista
        self.eye = picture.camera.eye
        self.scale = 0.02 * float(grid["depth"])  # [m] the least height that counts as a crest
        self.mesh = WaterMesh(grid["x"], grid["z"], grid["lower"], grid["upper"], NODES[picture.order.quality])
        points, _ = self.mesh.surface(np.zeros((len(grid["x"]), len(grid["z"]))))
        self.surface = pyvista.PolyData.from_regular_faces(points.astype(np.float32), self.mesh.surface_triangles)
        sides = self.mesh.sides(points)
        self.sides = pyvista.PolyData.from_regular_faces(sides.astype(np.float32), self.mesh.side_triangles)
        for part in (self.sides, self.surface):
            part["colour"] = np.zeros((part.n_points, 3), np.uint8)
            picture.plotter.add_mesh(part, scalars="colour", rgb=True, lighting=False)

    def show(self, frame: Frame) -> None:
        points, normals = self.mesh.surface(frame.elevation)
        height = np.clip(points[:, 1] / max(2.5 * float(frame.elevation.std()), self.scale), -1.0, 1.0)
        self.surface.points = points.astype(np.float32)
        self.surface["colour"] = _water_shading.display(_water_shading.surface(points, normals, height, self.eye))
        sides, depth = self.mesh.sides(points), self.mesh.side_depth
        self.sides.points = sides.astype(np.float32)
        self.sides["colour"] = _water_shading.display(
            _water_shading.side(sides, self.mesh.side_normals, depth, self.eye)
        )


class Shell:
    """A closed surface with drops and folds, smoothed; what faces down or sideways is seen as through glass."""

    def __init__(self, picture: Picture, depth: float) -> None:
        self.lower, self.upper = tuple(picture.lower), tuple(picture.upper)
        self.eye, self.depth, self.plotter, self.pyvista = picture.camera.eye, depth, picture.plotter, picture.pyvista

    def show(self, frame: Frame) -> None:
        from ocean_sim.observers._taubin import smoothed
        from ocean_sim.surface import Mesh

        assert frame.mesh is not None
        smooth = smoothed(Mesh(*frame.mesh), self.lower, self.upper)
        points, triangles, normals = smooth.vertices, smooth.triangles, smooth.normals
        shape = self.pyvista.PolyData.from_regular_faces(points, triangles)
        height = np.clip(points[:, 1] / max(2.5 * float(frame.elevation.std()), 0.02 * self.depth), -1.0, 1.0)
        top = _water_shading.surface(points, normals, height, self.eye)
        side = _water_shading.side(points, normals, np.clip(-points[:, 1] / self.depth, 0.0, 1.0), self.eye)
        up = np.clip(2.5 * normals[:, 1:2], 0.0, 1.0)
        shape["colour"] = _water_shading.display(up * top + (1.0 - up) * side)
        self.plotter.add_mesh(shape, scalars="colour", rgb=True, lighting=False, name="shell", reset_camera=False)


class Ship:
    """The hull, its sides as bright as the sun makes them."""

    def __init__(self, picture: Picture, grid: Any) -> None:
        self.vertices, triangles = grid["ship_vertices"].astype(float), grid["ship_triangles"].astype(int)
        self.length = float(np.ptp(self.vertices, axis=0).max())  # [m]
        a, b, c = (self.vertices[triangles[:, k]] for k in range(3))
        self.normals = _sky.unit(np.cross(b - a, c - a))
        deck = self.normals[:, 1:2] > 0.7
        self.paint = np.where(deck, DECK, HULL)
        self.shape = picture.pyvista.PolyData.from_regular_faces(self.vertices.astype(np.float32), triangles)
        self.shape.cell_data["colour"] = np.zeros((len(triangles), 3), np.uint8)
        picture.plotter.add_mesh(self.shape, scalars="colour", rgb=True, lighting=False)

    def show(self, position: np.ndarray, turn: np.ndarray) -> None:
        self.shape.points = (self.vertices @ turn.T + position).astype(np.float32)
        light = 0.45 + 0.55 * np.clip((self.normals @ turn.T) @ _sky.SUN, 0.0, 1.0)
        self.shape.cell_data["colour"] = (self.paint * light[:, None]).astype(np.uint8)


class Particles:
    """Every particle as a small ball, coloured by its speed."""

    def __init__(self, picture: Picture, first: Frame, spacing: float, fastest: float) -> None:
        assert first.position is not None
        cloud = picture.pyvista.PolyData(first.position.astype(np.float32))
        cloud["speed [m/s]"] = np.zeros(len(first.position), np.float32)
        picture.plotter.add_light(picture.pyvista.Light(position=tuple(1e3 * _sky.SUN), light_type="scene light"))
        picture.plotter.add_light(picture.pyvista.Light(light_type="headlight", intensity=0.5))
        balls = picture.plotter.add_mesh(
            cloud,
            scalars="speed [m/s]",
            clim=(0.0, fastest),
            cmap="YlGnBu_r",
            style="points_gaussian",
            render_points_as_spheres=True,
            ambient=0.4,
            scalar_bar_args={
                "position_x": 0.70,
                "position_y": 0.90,
                "width": 0.27,
                "height": 0.07,
                "n_labels": 2,
                "fmt": "%.2g",
                "label_font_size": 14,
                "title_font_size": 15,
                "color": "#10222c",
            },
        )
        balls.mapper.scale_factor = 0.5 * spacing  # [m] radius
        self.cloud, self.fastest = balls.mapper.dataset, fastest
        self.colours = balls.mapper.lookup_table.values  # (256, 4), 8-bit
        self.drawn = balls.mapper.array_name  # PyVista turns the scalars of such balls into colours once, when added

    def show(self, frame: Frame) -> None:
        assert frame.position is not None and frame.velocity is not None
        self.cloud.points = frame.position
        share = np.linalg.norm(frame.velocity, axis=1) / self.fastest
        self.cloud[self.drawn] = self.colours[np.clip(255.0 * share, 0.0, 255.0).astype(int)]


def schedule(times: np.ndarray, every: float) -> list[int]:
    """Which frame is nearest to each multiple of `every`."""
    moments = np.arange(times[0], times[-1] + 0.5 * every, every)
    return [int(np.abs(times - moment).argmin()) for moment in moments]


def draw(order: Order) -> Iterator[tuple[int, int]]:
    """Draw what is ordered; yields how many pictures are drawn of how many."""
    files = frame_files(Path(order.folder))
    with np.load(Path(order.folder) / "frames" / "grid.npz") as file:
        grid = dict(file)
    lively, fastest = survey(files[:: max(1, len(files) // 60)])
    picture = Picture(grid, order, lively, fastest)
    out = Path(order.out)
    picture.smooth(True)
    write(out / "preview.png", lambda path: save_png(path, picture.draw(lively)))
    picture.smooth(order.quality == "final")
    if order.film:
        chosen = schedule(np.array([time_of(path) for path in files]), order.every)
        yield from film(out / "film.mp4", picture, [files[k] for k in chosen], 1.0 / order.every)
    picture.close()


def survey(files: list[Path]) -> tuple[Frame, float]:
    """The frame with the highest waves of the second half of a run, and the speed of its fast particles [m/s]."""
    height, speed = [], [0.1]
    for frame in map(Frame, files):  # one at a time: a frame of a large run is large
        height.append(float(frame.elevation.std()))
        if frame.velocity is not None:
            speed.append(float(np.percentile(np.linalg.norm(frame.velocity, axis=1), 99)))
    half = len(files) // 2
    return Frame(files[half + int(np.argmax(height[half:]))]), max(speed)


def time_of(path: Path) -> float:
    with np.load(path) as file:
        return float(file["time"])


def film(path: Path, picture: Picture, files: list[Path], rate: float) -> Iterator[tuple[int, int]]:
    """H.264 that any player shows, in real time."""
    import imageio.v2 as imageio

    beside = path.with_name(f".{path.name}.tmp.mp4")
    writer = imageio.get_writer(
        beside,
        fps=rate,
        codec="libx264",
        quality=8,
        macro_block_size=2,
        pixelformat="yuv420p",
        ffmpeg_params=["-preset", "veryfast", "-movflags", "+faststart"],
    )
    shown, image = None, None
    with writer:
        for k, file in enumerate(files):
            if file != shown:
                shown, image = file, picture.draw(Frame(file))
            writer.append_data(image)
            yield k + 1, len(files)
    os.replace(beside, path)


def save_png(path: Path, image: np.ndarray) -> None:
    import imageio.v2 as imageio

    imageio.imwrite(path, image, format="png", compress_level=6)


def write(path: Path, save: Callable[[Path], None]) -> None:
    """A file that appears whole."""
    beside = path.with_name(f".{path.stem}.tmp{path.suffix}")
    save(beside)
    os.replace(beside, path)


def main() -> None:
    order = json.loads(sys.argv[1])
    order["size"] = tuple(order["size"])
    try:
        for drawn, of in draw(Order(**order)):
            print(f"pictures {drawn} of {of}", flush=True)
    except (RenderFailed, OSError, ValueError) as problem:
        sys.exit(str(problem))


if __name__ == "__main__":
    main()
