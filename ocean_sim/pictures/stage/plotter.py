"""Stage of a picture: the VTK plotter, and the camera that looks at it now."""

from types import ModuleType
from typing import Any

import numpy as np

from ocean_sim.pictures.frame_files import Frame
from ocean_sim.pictures.stage.camera import Camera
from ocean_sim.pictures.stage.render_order import RenderFailed
from ocean_sim.pictures.water import water_glsl

# Contrast over the brightest around, and of brightness, from which an edge is smoothed; blur of a single pixel
EDGE_CONTRASTS, SINGLE_PIXEL_BLUR = (0.25, 32.0 / 255.0), 0.6


class Stage:
    """VTK plotter and camera of a picture, to which the objects in the picture add themselves."""

    def __init__(self, size: tuple[int, int], camera: Camera, samples: int) -> None:
        """`size`: width and height of the picture [pixels]; `samples`: samples along each side of a pixel."""
        import pyvista

        self.pyvista: ModuleType = pyvista
        self.size, self.camera, self.samples = size, camera, samples
        self.over: list[Any] = []  # actors on the water, of which it shows none within it
        self.plotters: list[Any] = []
        self.plotter = self.new_plotter((samples * size[0], samples * size[1]))
        if samples == 1:
            smooth_edges(self.plotter)
        self.said = water_glsl.collect_messages()

    def new_plotter(self, size: tuple[int, int]) -> Any:
        """New off-screen plotter with a window of this size [pixels], without lights."""
        plotter = self.pyvista.Plotter(off_screen=True, window_size=size, lighting="none")
        plotter.disable_anti_aliasing()  # PyVista's default multiplies the time of a picture
        plotter.render_window.SetMultiSamples(0)
        self.plotters.append(plotter)
        return plotter

    def mesh(self, points: np.ndarray, faces: np.ndarray, **vectors: np.ndarray) -> Any:
        """PyVista mesh of faces (m, 3) or (m, 4) between points (n, 3) [m]; `vectors`: by name, (n, 3) at points."""
        made = self.pyvista.PolyData.from_regular_faces(points.astype(np.float32), faces)
        for name, values in vectors.items():
            made.point_data[name] = values.astype(np.float32)
        return made

    def add(self, points: np.ndarray, faces: np.ndarray, colours: np.ndarray, **shown: Any) -> Any:
        """Add and return a mesh of faces (m, 3) or (m, 4) between points (n, 3) [m] with 8-bit RGB `colours` (n, 3);
        `shown`: PyVista options."""
        mesh = self.mesh(points, faces)
        mesh["colour"] = colours
        self.plotter.add_mesh(mesh, scalars="colour", rgb=True, lighting=False, **shown)
        return mesh

    def render(self) -> None:
        """Render the picture; raises RenderFailed if OpenGL refuses a shader program."""
        self.plotter.render()
        why = water_glsl.refusal(self.said)
        if why is not None:
            raise RenderFailed(f"OpenGL refuses a program of this picture: {why}; please report it with this line")

    def close(self) -> None:
        for plotter in self.plotters[::-1]:
            plotter.close()


def smooth_edges(plotter: Any) -> None:
    """Smooth jagged edges in a plotter's pictures by FXAA (Lottes 2009, NVIDIA white paper)."""
    plotter.renderer.SetUseFXAA(True)  # PyVista takes many samples of each pixel instead, where EGL draws
    options = plotter.renderer.GetFXAAOptions()
    options.SetRelativeContrastThreshold(EDGE_CONTRASTS[0])
    options.SetHardContrastThreshold(EDGE_CONTRASTS[1])
    options.SetSubpixelBlendLimit(SINGLE_PIXEL_BLUR)
    options.SetSubpixelContrastThreshold(0.0)


class Content:
    """Main subject of a picture: interface of the sea, a tank's water, and particles."""

    def show(self, frame: Frame) -> None:
        """Change the subject to its state in a frame."""
        raise NotImplementedError
