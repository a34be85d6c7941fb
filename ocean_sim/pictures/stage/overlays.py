"""Overlays of a picture: time, scale bars of lengths and heights, and the outline of the basin."""

from math import floor, log10

import numpy as np

from ocean_sim.pictures.stage.plotter import Stage
from ocean_sim.pictures.water import water_shading

INK_COLOUR, PAPER_COLOUR, LETTER_SIZE = (238, 243, 246), (8, 23, 33, 140), 16  # of words; of the ground; [pixels]
OUTLINE_COLOUR = "#ffb347"
OUTLINE_HEIGHT = 0.0015  # of the basin's length: how far the outline stands over the water, so that it is seen
HEIGHT_TITLE = "height of\nthe water"
BAR_TOP, BAR_HEIGHT, BAR_LEFT, BAR_WIDTH = 0.3, 0.4, 130, 18  # of a picture's height; [pixels] from its right edge
ARROW_COLOUR, ARROW_HEAD = (240, 190, 60), 18  # of the wind: colour; [pixels] of its head
MAX_BAR = 0.25  # of the width of a picture: the bar
BAR_MARGIN = 24  # [pixels] from a bar to the right edge of the picture


def metre_pixels(stage: Stage, target: np.ndarray) -> float:
    """Length in the picture [pixels] of a metre that lies across the view at the distance of `target` (3,) [m]."""
    camera, half = stage.camera, stage.camera.parallel_height
    if half is None:
        half = float((target - camera.eye) @ camera.forward) * float(np.tan(np.radians(camera.angle) / 2.0))
    return stage.size[1] / (2.0 * max(half, 1e-6))


class Overlay:
    """Words, scale bars and legends on a finished picture."""

    def __init__(self, picture: np.ndarray) -> None:
        """`picture`: (height, width, 3), 8-bit RGB, which stays as it is."""
        from matplotlib import get_data_path  # for its font: Pillow's own has no superscripts
        from PIL import Image, ImageDraw, ImageFont

        self.image = Image.fromarray(picture)
        self.ink = ImageDraw.Draw(self.image, "RGBA")
        self.font = ImageFont.truetype(f"{get_data_path()}/fonts/ttf/DejaVuSans.ttf", LETTER_SIZE)
        self.right, self.low = self.image.width - BAR_MARGIN, self.image.height

    def write(self, text: str, x: float, y: float, anchor: str = "ls") -> None:
        """Write text on a dark ground; `x`, `y`: from the upper left corner [pixels]; `anchor`: as Pillow has it."""
        left, top, right, low = self.ink.textbbox((x, y), text, self.font, anchor)
        self.ink.rectangle((left - 3, top - 3, right + 3, low + 3), PAPER_COLOUR)
        self.ink.text((x, y), text, INK_COLOUR, self.font, anchor)

    def scale_bar(self, each: float) -> None:
        """Draw a bar whose length is a round number of metres of `each` [pixels]."""
        metres = round_down(MAX_BAR * self.image.width / each)
        ends = self.right - round(metres * each) * (4 - np.arange(5)) // 4
        self.ink.rectangle((ends[0] - 2, self.low - 22, self.right + 1, self.low - 13), PAPER_COLOUR[:3])
        for k in range(4):
            self.ink.rectangle((ends[k], self.low - 20, ends[k + 1] - 1, self.low - 15), 3 * ((238, 110)[k % 2],))
        self.write(f"{metres:g} m", ends[0], self.low - 32)

    def name_zones(self, zones: np.ndarray, eye: np.ndarray, each: float) -> None:
        """Write over absorbing zones (n, 2, 3) [m] of a 2-D tank, seen from `eye` (3,) [m], `each` [pixels] a metre."""
        for low, top in zones:
            x, y = each * (0.5 * (low[0] + top[0]) - eye[0]), each * (top[1] - eye[1])
            self.write("absorbs waves", 0.5 * self.image.width + x, 0.5 * self.low - y - 14, "ms")

    def arrow_bar(self, length: float, text: str) -> None:
        """Write `text` about the wind's arrows and, above the scale bar, draw one of a length [pixels]; 0: none."""
        self.write(text, self.right, self.low - (94 if length else 72), "rs")
        if length:
            row, neck = self.low - 78, self.right - min(ARROW_HEAD, length)
            self.ink.rectangle((self.right - length - 3, row - 9, self.right + 2, row + 9), PAPER_COLOUR[:3])
            self.ink.line((self.right - length, row, neck, row), ARROW_COLOUR, 3)
            self.ink.polygon([(neck, row - 7), (neck, row + 7), (self.right, row)], ARROW_COLOUR)

    def height_bar(self, most: float) -> None:
        """Draw the colours of the water of a map for heights from -`most` to `most` [m]."""
        top, height, left = round(BAR_TOP * self.low), round(BAR_HEIGHT * self.low), self.image.width - BAR_LEFT
        up = np.tile([0.0, 1.0, 0.0], (height, 1))
        colours = water_shading.display_colours(water_shading.relief_light(up, np.linspace(1.0, -1.0, height)))
        self.ink.rectangle((left - 2, top - 2, left + BAR_WIDTH + 1, top + height + 1), PAPER_COLOUR[:3])
        for row, colour in enumerate(colours.tolist(), top):
            self.ink.line((left, row, left + BAR_WIDTH - 1, row), tuple(colour))
        for share, text in ((0.0, f"{most:+.3g} m"), (0.5, "0 m"), (1.0, f"{-most:+.3g} m")):
            tick = top + min(share * height, height - 1)
            self.ink.line((left + BAR_WIDTH, tick, left + BAR_WIDTH + 7, tick), INK_COLOUR)
            self.write(text, left + 34, tick, "lm")
        self.write(HEIGHT_TITLE, left + 34, top - 40, "ls")


def round_down(value: float) -> float:
    """Largest of 1, 2 and 5 times a power of ten that is not above a value."""
    power = 10.0 ** floor(log10(value))
    return next(m * power for m in (5.0, 2.0, 1.0) if m * power <= value * (1.0 + 1e-9))


class Outline:
    """Outline of the basin as a line on the water."""

    def __init__(self, stage: Stage, lower: np.ndarray, upper: np.ndarray, points: int = 400) -> None:
        way = np.linspace(0.0, 4.0, points)
        corner = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]], dtype=float)
        share = np.stack([np.interp(way, np.arange(5), corner[:, k]) for k in range(2)], axis=1)
        self.around = lower[[0, 2]] + share * (upper - lower)[[0, 2]]
        self.raised = OUTLINE_HEIGHT * float((upper - lower)[[0, 2]].max())  # [m]
        self.line = stage.pyvista.MultipleLines(np.insert(self.around, 1, 0.0, axis=1).astype(np.float32))
        width = 2.0 * stage.samples  # [pixels of the plotter]
        drawn = stage.plotter.add_mesh(self.line, color=OUTLINE_COLOUR, line_width=width, lighting=False, render=False)
        stage.over.append(drawn)

    def show(self, origin: np.ndarray, heights: np.ndarray) -> None:
        """Move the line to a basin at `origin` x, z [m], and to water `heights` (points,) [m] along it."""
        self.line.points = np.insert(self.around + origin, 1, heights + self.raised, axis=1).astype(np.float32)
