"""Particles in a picture, as small balls coloured by speed."""

import sys

import numpy as np

from ocean_sim.pictures.frame_files import Frame
from ocean_sim.pictures.stage.plotter import Content, Stage
from ocean_sim.pictures.water import water_glsl

RIM_LIGHT = 0.75  # light of the rim of a ball over that of its middle


class Particles(Content):
    """Every particle as a small ball, coloured by its speed."""

    def __init__(self, stage: Stage, first: Frame, spacing: float, fastest: float) -> None:
        """`first`: first frame; `spacing`: of particles [m]; `fastest`: speed [m/s] of the brightest colour."""
        assert first.position is not None
        cloud = stage.pyvista.PolyData(first.position.astype(np.float32))
        cloud["speed [m/s]"] = np.zeros(len(first.position), np.float32)
        wide = 9 / 16 * stage.size[0] / stage.size[1]  # the bar is as high in pictures of a long slice
        place = {"position_x": 0.70, "position_y": 1.0 - 0.1 * wide, "width": 0.27, "height": 0.07 * wide}
        letters = {"label_font_size": 14 * stage.samples, "title_font_size": 15 * stage.samples}
        balls = stage.plotter.add_mesh(
            cloud,
            scalars="speed [m/s]",
            clim=(0.0, fastest),
            cmap="YlGnBu_r",
            style="points_gaussian",
            render_points_as_spheres=True,
            lighting=False,  # colours are those of the bar
            scalar_bar_args=place | {"n_labels": 2, "fmt": "%.2g", "color": "#10222c"} | letters,
        )
        balls.mapper.SetSplatShaderCode(water_glsl.shader("ball", sys.modules[__name__]))  # VTK's own end in black
        balls.mapper.scale_factor = 0.5 * spacing  # [m] radius
        self.cloud, self.fastest = balls.mapper.dataset, fastest
        self.colours = balls.mapper.lookup_table.values  # (256, 4), 8-bit
        self.drawn = balls.mapper.array_name  # PyVista turns the scalars of such balls into colours once, when added

    def show(self, frame: Frame) -> None:
        assert frame.position is not None and frame.velocity is not None
        self.cloud.points = frame.position
        share = np.linalg.norm(frame.velocity, axis=1) / self.fastest
        self.cloud[self.drawn] = self.colours[np.clip(255.0 * share, 0.0, 255.0).astype(int)]
