"""Runs that figures draw pictures of: frames in a folder, and pictures of them."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ocean_sim.observers import render
from ocean_sim.scene import load
from ocean_sim.simulation import Simulation

BARE = {"far_sea": False, "ripples": False, "foam": False, "sky": False}
SEEN = dict.fromkeys(("accuracy", "timings", "health", "render", "report", "motion"))


def kept(scene: dict[str, Any], folder: Path) -> Path:
    """The folder of a run of this scene, which keeps frames and nothing else."""
    folder.mkdir(parents=True)
    with Simulation(load(SEEN | scene), folder) as simulation:
        simulation.run(until=scene["duration"])
    return folder


def shots(folder: Path, time: float, switched: Sequence[dict[str, Any]], **options: Any) -> np.ndarray:
    """(n, height, width, 3) pictures of a run at a time [s], one for each set of switches; grey ones where OpenGL is
    missing, which is told."""
    try:
        return render.variants(folder, time, switched, caption=False, **options)
    except render.OpenGLMissing as missing:
        print(missing, file=sys.stderr, flush=True)
        width, height = options["size"]
        return np.full((len(switched), height, width, 3), 200, np.uint8)


def film(folder: Path, path: Path, **options: Any) -> None:
    """A film of the run, left out where OpenGL is missing."""
    try:
        render.render_run(folder, out=folder / "film", preview=False, caption=False, **options)
        (folder / "film" / "film.mp4").replace(path)
    except render.OpenGLMissing as missing:
        print(missing, file=sys.stderr, flush=True)


def save(path: Path, picture: np.ndarray) -> None:
    """A picture (height, width, 3) as a PNG."""
    import imageio.v2 as imageio

    imageio.imwrite(path, picture, format="png", compress_level=9)


def grey(picture: np.ndarray) -> np.ndarray:
    """Luminance, 0 to 1, of 8-bit sRGB pixels (Rec. 709, gamma 2.2)."""
    return (picture / 255.0) ** 2.2 @ np.array([0.2126, 0.7152, 0.0722])
