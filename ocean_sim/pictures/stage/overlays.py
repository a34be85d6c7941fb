"""Overlays of a picture: time, scale bars of lengths and heights, and the outline of the basin."""

from math import floor, log10
from typing import Any

import numpy as np

from ocean_sim.pictures.stage.plotter import Stage
from ocean_sim.pictures.water import water_shading

INK_COLOUR, PAPER_COLOUR = "#eef3f6", (0.03, 0.09, 0.13)
PAPER_PIXEL = np.multiply(PAPER_COLOUR, 255.0).astype(np.uint8)
OUTLINE_COLOUR = "#ffb347"
OUTLINE_HEIGHT = 0.0015  # of the basin's length: how far the outline stands over the water, so that it is seen
HEIGHT_TITLE = "height of\nthe water"
BAR_TOP, BAR_HEIGHT, BAR_LEFT, BAR_WIDTH = 0.3, 0.4, 130, 18  # of a picture's height; [pixels] from its right edge
ARROW_COLOUR, ARROW_HEAD = (240, 190, 60), 18  # of the wind: colour; [pixels] of its head
MAX_BAR = 0.25  # of the width of a picture: the bar


def add_words(stage: Stage, text: str, position: tuple[int, int]) -> Any:
    """Add text on a dark ground; `position`: x, y from the lower left corner [pixels]. Returns its actor."""
    x, y = (stage.samples * n for n in position)
    made = stage.plotter.add_text(text, position=(x, y), font_size=9 * stage.samples, color=INK_COLOUR)
    made.prop.SetBackgroundColor(*PAPER_COLOUR)
    made.prop.SetBackgroundOpacity(0.55)
    stage.over.append(made)
    return made


def metre_pixels(stage: Stage, target: np.ndarray) -> float:
    """Length in the picture [pixels] of a metre that lies across the view at the distance of `target` (3,) [m]."""
    camera, half = stage.camera, stage.camera.parallel_height
    if half is None:
        half = float((target - camera.eye) @ camera.forward) * float(np.tan(np.radians(camera.angle) / 2.0))
    return stage.size[1] / (2.0 * max(half, 1e-6))


class ScaleBar:
    """Scale bar whose length is a round number of metres at the distance of a target."""

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        self.words = add_words(stage, " ", (0, 0))
        self.length = 0  # [pixels]

    def show(self, target: np.ndarray) -> None:
        """Set length and label of the bar for the distance of a target (3,) [m]."""
        width, each = self.stage.size[0], metre_pixels(self.stage, target)
        metres = round_down(MAX_BAR * width / each)
        self.length = int(round(metres * each))
        self.words.input = f"{metres:g} m"
        self.words.SetPosition(*(self.stage.samples * n for n in (width - self.length - 24, 30)))

    def draw(self, image: np.ndarray) -> None:
        """Draw the bar into a picture (height, width, 3), 8-bit RGB."""
        right, low = self.stage.size[0] - 24, self.stage.size[1] - 14
        image[low - 8 : low + 2, right - self.length - 2 : right + 2] = PAPER_PIXEL
        for k in range(4):
            left = right - self.length + k * self.length // 4
            image[low - 6 : low, left : left + self.length // 4] = 238 if k % 2 == 0 else 110


class ArrowBar:
    """Legend of the wind arrows, above the scale bar: an arrow of known length, and a text."""

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        self.words = add_words(stage, " ", (0, 0))
        self.words.prop.SetJustificationToRight()
        self.length = 0  # [pixels]

    def show(self, target: np.ndarray, length: float, text: str) -> None:
        """Set the text and the arrow's length [m] at the distance of `target` (3,) [m]; length 0: no arrow."""
        self.length = int(round(length * metre_pixels(self.stage, target)))
        self.words.input = text
        right = self.stage.size[0] - 24
        self.words.SetPosition(*(self.stage.samples * n for n in (right, 92 if self.length else 70)))

    def draw(self, image: np.ndarray) -> None:
        if not self.length:
            return
        right, row = self.stage.size[0] - 24, self.stage.size[1] - 78
        head = min(ARROW_HEAD, self.length)
        image[row - 9 : row + 10, right - self.length - 3 : right + 3] = PAPER_PIXEL
        image[row - 1 : row + 2, right - self.length : right - head + 1] = ARROW_COLOUR
        for k in range(head):
            half = (head - k) * 7 // head
            image[row - half : row + half + 1, right - head + k] = ARROW_COLOUR


def round_down(value: float) -> float:
    """Largest of 1, 2 and 5 times a power of ten that is not above a value."""
    power = 10.0 ** floor(log10(value))
    return next(m * power for m in (5.0, 2.0, 1.0) if m * power <= value * (1.0 + 1e-9))


class HeightBar:
    """Colour bar of the water heights on a map."""

    def __init__(self, stage: Stage) -> None:
        self.size = stage.size
        self.top, self.height = round(BAR_TOP * stage.size[1]), round(BAR_HEIGHT * stage.size[1])  # [pixels]
        self.words = [add_words(stage, " ", (stage.size[0] - BAR_LEFT + 34, self.tick(k) - 10)) for k in range(3)]
        add_words(stage, HEIGHT_TITLE, (stage.size[0] - BAR_LEFT + 34, self.tick(2) + 18))

    def tick(self, k: int) -> int:
        """Height [pixels] over the lower edge of the picture of tick k: 0 the lowest, 1 the middle, 2 the highest."""
        return self.size[1] - self.top - self.height + k * self.height // 2

    def show(self, most: float) -> None:
        """Set the labels of the bar for heights from -`most` to `most` [m]."""
        for k, text in enumerate(self.words):
            text.input = f"{(k - 1) * most:+.3g} m" if k != 1 else "0 m"

    def draw(self, image: np.ndarray) -> None:
        left, ink = self.size[0] - BAR_LEFT, 238
        up = np.tile([0.0, 1.0, 0.0], (self.height, 1))
        colours = water_shading.display_colours(water_shading.relief_light(up, np.linspace(1.0, -1.0, self.height)))
        image[self.top - 2 : self.top + self.height + 2, left - 2 : left + BAR_WIDTH + 2] = PAPER_PIXEL
        image[self.top : self.top + self.height, left : left + BAR_WIDTH] = colours[:, None]
        for k in range(3):
            row = min(self.size[1] - self.tick(k), self.top + self.height - 1)
            image[row, left + BAR_WIDTH : left + BAR_WIDTH + 8] = ink


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
