"""Runs that figures draw pictures of: frames in a folder, and pictures of them."""

import sys
from collections.abc import Sequence
from pathlib import Path
from textwrap import wrap
from typing import Any

import numpy as np
from _options import Said

from ocean_sim.observers import render
from ocean_sim.pictures.stage.camera import camera_looking
from ocean_sim.reading.scene import load
from ocean_sim.simulation import Simulation
from ocean_sim.waves import Components, elevation

BARE = {"far_sea": False, "ripples": False, "foam": False, "sky": False}
BARED = "Here without far sea, ripples, foam and clouds"
SEEN = dict.fromkeys(("accuracy", "timings", "health", "render", "report", "motion"))


def run_frames(scene: dict[str, Any], folder: Path) -> Path:
    """Run a scene that writes nothing but frames, into a new folder; return the folder."""
    folder.mkdir(parents=True)
    with Simulation(load(SEEN | scene), folder) as simulation:
        simulation.run(until=scene["duration"])
    return folder


def write_still_sea(sea: Components, side: float, folder: Path) -> Path:
    """Write a run's folder without a run: one frame, at 0 s, of closed-form waves over a square of this side [m]."""
    (folder / "frames").mkdir(parents=True)
    nodes = (np.arange(64) + 0.5) / 64 * side - side / 2
    points = np.stack(np.meshgrid(nodes, nodes, indexing="ij"), axis=-1).reshape(-1, 2)
    half = np.array([side / 2, 0.0, side / 2])
    np.savez(
        folder / "frames" / "grid.npz",
        x=nodes,
        z=nodes,
        lower=-half - [0.0, sea.depth, 0.0],
        upper=half,
        depth=sea.depth,
        spacing=side / 64,
        every=1.0,
        has_surface=True,
        sea_amplitude=sea.amplitude,
        sea_wavevector=sea.wavevector,
        sea_phase=sea.phase,
    )
    np.savez(folder / "frames" / "frame_00000.npz", time=0.0, elevation=elevation(sea, points).reshape(64, 64))
    return folder


def take_pictures(folder: Path, time: float, switched: Sequence[dict[str, Any]], **options: Any) -> np.ndarray:
    """Pictures (n, height, width, 3) of a run at a time [s], one for each of `switched` (options that differ);
    `options`: common to all. Without OpenGL they are grey, and a line says so."""
    try:
        return render.variants(folder, time, switched, caption=False, **options)
    except render.OpenGLMissing as missing:
        print(missing, file=sys.stderr, flush=True)
        width, height = options["size"]
        return np.full((len(switched), height, width, 3), 200, np.uint8)


def view_rays(view: dict[str, Any], aspect: float, rows: int) -> tuple[np.ndarray, np.ndarray]:
    """Eye (3,) [m] of a `fixed` camera, and directions (n, 3) through the middles of an even grid of pixels of its
    picture, of so many rows; `aspect`: width over height."""
    camera = camera_looking(np.array(view["eye"]), np.array(view["target"]))
    v, u = ((np.arange(n) + 0.5) / n * 2.0 - 1.0 for n in (rows, round(rows * aspect)))
    return camera.eye, camera.rays(aspect * u, v)


def save_film(folder: Path, path: Path, **options: Any) -> None:
    """Write a film of a run's frames to `path`; without OpenGL only a line on standard error."""
    try:
        render.render_run(folder, out=folder / "film", preview=False, caption=False, **options)
        (folder / "film" / "film.mp4").replace(path)
    except render.OpenGLMissing as missing:
        print(missing, file=sys.stderr, flush=True)


def save_picture(path: Path, picture: np.ndarray) -> None:
    """Write a picture (height, width, 3), drawn without the things that BARE leaves out, as PNG with a caption below
    it: number and title of the figure, a note on BARE, and a mark if `--fast` made it."""
    import imageio.v2 as imageio
    from PIL import Image, ImageDraw, ImageFont

    width = picture.shape[1]
    size = max(13, width // 90)  # smaller letters run together
    words = wrap(f"{'--fast, coarse. ' if Said.fast else ''}{Said.caption}. {BARED}", int(1.9 * width / size))
    strip = Image.new("RGB", (width, (len(words) + 1) * (size + 4)), "white")
    ImageDraw.Draw(strip).multiline_text((8, 4), "\n".join(words), fill="#44525c", font=ImageFont.load_default(size))
    picture = np.concatenate([picture, np.asarray(strip)])
    imageio.imwrite(path, picture, format="png", compress_level=9)


def grey(picture: np.ndarray) -> np.ndarray:
    """Luminance, 0 to 1, of 8-bit sRGB pixels (Rec. 709, gamma 2.2)."""
    return (picture / 255.0) ** 2.2 @ np.array([0.2126, 0.7152, 0.0722])
