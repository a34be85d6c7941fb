"""Test of whether VTK can draw without a screen. It kills a process that has no OpenGL, so a child process tries."""

import os
import shutil
import subprocess
import sys
from collections.abc import Mapping
from contextlib import suppress
from functools import cache
from importlib.metadata import version
from tempfile import TemporaryDirectory

import numpy as np

from ocean_sim.conventions import Lacking
from ocean_sim.files.cache_file import cached_arrays
from ocean_sim.machine import cache_directory, missing_extra

WINDOW_CLASSES = ("vtkEGLRenderWindow", "vtkOSOpenGLRenderWindow")  # EGL draws faster here, OSMesa is the other way
INSTALL_COMMAND = "apt-get install --no-install-recommends libegl1 libgl1-mesa-dri"
NOTE_FOLDER = "opengl"  # of the cache, where a success is noted
PROBE_SECONDS = 120.0  # [s]
PROBE_PROGRAM = """
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(16, 16))
plotter.add_mesh(pyvista.Cube())
plotter.screenshot(None, return_img=True)
print("drawn by " + plotter.render_window.GetClassName())
plotter.close()
"""


class OpenGLMissing(Lacking):
    """This machine cannot draw off screen; the message names the packages to install."""

    def __init__(self) -> None:
        missing = f"this machine has no OpenGL to draw pictures with; install it with `{INSTALL_COMMAND}`"
        super().__init__(missing_extra("pictures") or missing)


def drawing_environment(window: str) -> dict[str, str]:
    """Environment variables for a child process that draws off screen with this class of VTK window."""
    inherited = {key: value for key, value in os.environ.items() if key not in ("DISPLAY", "WAYLAND_DISPLAY")}
    return inherited | {"VTK_DEFAULT_OPENGL_WINDOW": window, "OPENBLAS_NUM_THREADS": "1"}  # products are small


@cache
def window() -> str | None:
    """Name of the VTK window class that can draw off screen here, or None. Success is remembered in the cache."""
    if missing_extra("pictures"):
        return None
    with suppress(OpenGLMissing):
        versions = repr((sys.executable, version("vtk"), version("pyvista"))).encode()
        return str(cached_arrays(NOTE_FOLDER, versions, drawing_window)["window"])
    return None


def drawing_window() -> dict[str, np.ndarray]:
    """Find the first of WINDOW_CLASSES that can draw; returns its name as an array, or raises OpenGLMissing."""
    found = next((name for name in WINDOW_CLASSES if draws(name)), None)
    if found is None:
        raise OpenGLMissing
    return {"window": np.array(found)}


def probe() -> str | None:
    """Sentence that says which packages to install for pictures; None if pictures can be drawn."""
    return None if window() else str(OpenGLMissing())


def forget() -> None:
    """Delete the cached name of a VTK window class, so that the next run tests again; called after a crash."""
    shutil.rmtree(cache_directory() / NOTE_FOLDER, ignore_errors=True)
    window.cache_clear()


def draws(name: str) -> bool:
    """True if a child process can draw with this class of VTK window and ends without a crash."""
    return child_prints(f"drawn by {name}", PROBE_PROGRAM, drawing_environment(name))


def child_prints(words: str, program: str, environment: Mapping[str, str] | None = None) -> bool:
    """True if a child process running a Python `program` prints `words` and exits with 0 within PROBE_SECONDS.
    `environment`: its variables by name; None: those of this process."""
    command = [sys.executable, "-c", program]
    try:
        with TemporaryDirectory() as away:  # where it works, as GGUI leaves a file there
            child = subprocess.run(
                command, env=environment, cwd=away, capture_output=True, text=True, timeout=PROBE_SECONDS, check=False
            )
    except (OSError, subprocess.TimeoutExpired):
        return False
    return child.returncode == 0 and words in child.stdout
