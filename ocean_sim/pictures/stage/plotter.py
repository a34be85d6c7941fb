"""Stage of a picture: the plotter, and the camera that looks at it now."""

from types import ModuleType
from typing import Any

from ocean_sim.pictures.frame_files import Frame
from ocean_sim.pictures.stage.camera import Camera
from ocean_sim.pictures.stage.render_order import RenderFailed
from ocean_sim.pictures.water import water_glsl


class Stage:
    """Handed to everything in a picture, which adds itself to the plotter."""

    def __init__(self, size: tuple[int, int], camera: Camera, samples: int) -> None:
        """`size`: width and height [pixels]; `samples`: along each side of a pixel."""
        import pyvista

        self.pyvista: ModuleType = pyvista
        self.size, self.camera, self.samples = size, camera, samples
        self.over: list[Any] = []  # actors that lie on the water, of which it shows none within it
        self.plotter = self.empty((samples * size[0], samples * size[1]))
        self.said = water_glsl.collect_messages()

    def empty(self, size: tuple[int, int]) -> Any:
        """A plotter without light, off screen."""
        plotter = self.pyvista.Plotter(off_screen=True, window_size=size, lighting="none")
        plotter.disable_anti_aliasing()  # PyVista's default multiplies the time of a picture
        plotter.render_window.SetMultiSamples(0)
        return plotter

    def render(self) -> None:
        """Draw; raises RenderFailed where OpenGL refuses a program."""
        self.plotter.render()
        why = water_glsl.refusal(self.said)
        if why is not None:
            raise RenderFailed(f"OpenGL refuses a program of this picture: {why}; please report it with this line")


class Content:
    """Main subject of a picture: a sea, a tank, particles."""

    def show(self, frame: Frame) -> None:
        """Draw it as it is in a frame."""
        raise NotImplementedError

    def close(self) -> None:
        """Release its own resources."""
