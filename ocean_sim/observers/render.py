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
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from pydantic import Field, field_validator

from ocean_sim.observers import _opengl
from ocean_sim.observers._camera import Name
from ocean_sim.observers._kept_frames import Frame, frame_files, schedule, survey, time_of
from ocean_sim.observers._order import Order, Quality, RenderFailed
from ocean_sim.observers._picture import Picture
from ocean_sim.parts import ObserverConfig, quantity

if TYPE_CHECKING:
    from ocean_sim.simulation import Simulation

Progress = Callable[[int, int], None]  # pictures drawn, pictures in all
OpenGLMissing = _opengl.OpenGLMissing
probe = _opengl.probe


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
    """`draft`: quick; `final`: finer mesh, smooth edges and the ship mirrored in the water."""
    far_sea: bool = True
    """Draw the sea around the basin out to the horizon; without it, a block of water with cut sides. A basin that
    moves, has a wavemaker, a lid or obstacles, or runs dry somewhere is a tank: it stays a block, and so does a surface
    that folds."""
    ripples: bool = True
    """Draw waves finer than the particles, of the wind's strength and heading."""
    foam: bool = True
    """Draw white water on crests that converge, along the hull, and spray."""
    sky: bool = True
    """Draw a scattered sky with clouds; without it, a clear gradient."""

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


def render_run(
    folder: Path,
    *,
    camera: Name = "third_person",
    quality: Quality = "draft",
    size: tuple[int, int] = (960, 540),
    particles: bool = False,
    every: float = 0.033,
    far_sea: bool = True,
    ripples: bool = True,
    foam: bool = True,
    sky: bool = True,
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
    order = Order(str(folder), str(out), camera, size, particles, quality, every, film, far_sea, ripples, foam, sky)
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
