"""Bed and walls of a tank with lines on them, in soft light; walls between the eye and the tank are left out."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ocean_sim.pictures.stage import sky
from ocean_sim.pictures.stage.plotter import Stage
from ocean_sim.pictures.water.water_surface import round_up

EDGE_COLOUR = "#eef3f6"
ZONE_TINT = {"color": "#e8b23c", "opacity": 0.35}  # of bed and walls of an absorbing zone
PANEL_OFFSET = 0.004  # of a tank's height by which bed and walls are drawn outside the water
# Colour of bed and walls: on dark ground clear water would not tell how thick it is
PANEL_COLOUR = np.array([0.68, 0.74, 0.76])
# Lines on it: [tank's depths] apart, breadth over that, and their light over its
LINE_INTERVAL, LINE_BREADTH, LINE_LIGHT = 0.2, 0.03, 0.86
PANEL_CELLS = 24  # along each side of a panel
# Light that a panel lacks where another meets it, a third of it so many heights away
NOOK_SHADE, NOOK_REACH = 0.25, 0.12
# Lines on the ground, and how far they hide it at the block
GROUND_LINE_COLOUR, GROUND_LINE_OPACITY = (8, 20, 30), 0.16
# Lines along the longer side of a block; of that side, how far around they fade away
GROUND_LINES, GROUND_REACH = 12.0, 1.5
AMBIENT_LIGHT, SUN_LIGHT = 0.84, 0.26  # of light: from all sides, and the sun's on a panel that faces it


class Panel(NamedTuple):
    """Bed or wall of a tank: a rectangle normal to an axis, facing inwards."""

    axis: int
    at: float  # [m]
    inwards: float  # 1 or -1, along the axis


def tank_panels(low: np.ndarray, up: np.ndarray) -> list[Panel]:
    """Bed and four walls of a tank between its corners `low` and `up` (3,) [m]."""
    walls = [Panel(axis, end[axis], side) for axis in (0, 2) for end, side in ((low, 1.0), (up, -1.0))]
    return [Panel(1, low[1], 1.0), *walls]


def panel_sheet(panel: Panel, u: np.ndarray, v: np.ndarray, out: float) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) [m] of a panel at all pairs of `u`, `v` [m] along its other two axes, moved outwards by `out` [m],
    and quadrilaterals (m, 4) between them that face inwards."""
    points = np.full((len(u) * len(v), 3), panel.at - panel.inwards * out)
    along = np.meshgrid(u, v, indexing="ij")
    for n, places in enumerate(along, 1):
        points[:, (panel.axis + n) % 3] = places.ravel()
    i, k = (number.ravel() for number in np.meshgrid(range(len(u) - 1), range(len(v) - 1), indexing="ij"))
    first = i * len(v) + k
    faces = np.stack([first, first + len(v), first + len(v) + 1, first + 1], axis=1)
    return points, faces if panel.inwards > 0.0 else faces[:, ::-1]


def panel_light(points: np.ndarray, panel: Panel, all_of_them: list[Panel], height: float) -> np.ndarray:
    """Brightness (n,) of a panel at points (n, 3) [m], darker near the other panels; `height`: of the tank [m]."""
    sunny = max(panel.inwards * float(sky.SUN_DIRECTION[panel.axis]), 0.0)
    bright = np.full(len(points), AMBIENT_LIGHT + SUN_LIGHT * sunny)
    for other in all_of_them:
        if other.axis != panel.axis:
            bright *= 1.0 - NOOK_SHADE * np.exp(-np.abs(points[:, other.axis] - other.at) / (NOOK_REACH * height))
    return bright


def line_sides(low: float, up: float, step: float) -> Iterator[np.ndarray]:
    """Yield both edges (2,) [m] of each line to draw at a multiple of `step` [m] on an axis from `low` to `up` [m].
    Lines are LINE_BREADTH steps wide."""
    for at in step * np.arange(np.ceil(low / step), np.floor(up / step) + 1.0):
        yield np.clip(at + 0.5 * LINE_BREADTH * step * np.array([-1.0, 1.0]), low, up)


def join_sheets(sheets: list[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Join sheets, each of points (n, 3) [m] and quadrilaterals (m, 4), into one."""
    begins = np.cumsum([0] + [len(points) for points, _ in sheets])
    faces = [quads + begin for (_, quads), begin in zip(sheets, begins[:-1], strict=True)]
    return np.concatenate([points for points, _ in sheets]).astype(np.float32), np.concatenate(faces)


def add_ground_lines(stage: Stage, low: np.ndarray, up: np.ndarray, height: float) -> None:
    """Add lines a round number of metres apart on the ground, at a height [m], around a block from `low` to `up`."""
    longer, level = max(up[0] - low[0], up[2] - low[2]), Panel(1, height, 1.0)
    reach, step = GROUND_REACH * longer, round_up(longer / GROUND_LINES)
    first, last = low - reach, up + reach
    x, z = (np.linspace(first[k], last[k], round(2 * GROUND_REACH + 1) * PANEL_CELLS) for k in (0, 2))
    sheets = [panel_sheet(level, z, pair, 0.0) for pair in line_sides(first[0], last[0], step)]
    sheets += [panel_sheet(level, pair, x, 0.0) for pair in line_sides(first[2], last[2], step)]
    points, faces = join_sheets(sheets)
    away = np.maximum(0.0, np.maximum(low - points, points - up))[:, [0, 2]]
    left = GROUND_LINE_OPACITY * np.square(np.maximum(1.0 - np.hypot(*away.T) / reach, 0.0))
    colours = np.column_stack([np.full((len(points), 3), GROUND_LINE_COLOUR), 255.0 * left]).astype(np.uint8)
    stage.add(points, faces, colours)


def add_edges(stage: Stage, low: np.ndarray, top: np.ndarray, zones: np.ndarray) -> None:
    """Add the edges of a tank from `low` to `top` [m], and tint the inside of absorbing zones (n, 2, 3) [m]."""
    box = stage.pyvista.Box(np.stack([low, top], axis=1).ravel()).extract_feature_edges(30.0)
    stage.plotter.add_mesh(box, color=EDGE_COLOUR, opacity=0.5, line_width=1.5 * stage.samples, lighting=False)
    for zone in zones:
        stage.plotter.add_mesh(stage.pyvista.Box(zone.T.ravel()), culling="front", lighting=False, **ZONE_TINT)


def add_panels(stage: Stage, low: np.ndarray, top: np.ndarray, depth: float) -> None:
    """Add bed and walls of a tank from `low` to `top` [m], with lines at a round distance that suits the depth [m]."""
    below, step = PANEL_OFFSET * (top[1] - low[1]), round_up(LINE_INTERVAL * depth)
    whole = tank_panels(low, top)
    sheets: list[tuple[np.ndarray, np.ndarray]] = []
    bright: list[np.ndarray] = []

    def add(panel: Panel, u: np.ndarray, v: np.ndarray, out: float, share: float) -> None:
        sheets.append(panel_sheet(panel, u, v, out))
        bright.append(share * panel_light(sheets[-1][0], panel, whole, top[1] - low[1]))

    for panel in whole:
        a, b = ((panel.axis + n) % 3 for n in (1, 2))
        even = [np.linspace(low[k], top[k], PANEL_CELLS + 1) for k in range(3)]
        add(panel, even[a], even[b], below, 1.0)
        for pair in line_sides(low[a], top[a], step):
            add(panel, pair, even[b], 0.5 * below, LINE_LIGHT)
        for pair in line_sides(low[b], top[b], step):
            add(panel, even[a], pair, 0.5 * below, LINE_LIGHT)
    colour = np.clip(255.0 * np.concatenate(bright)[:, None] * PANEL_COLOUR, 0.0, 255.0)
    stage.add(*join_sheets(sheets), colour.astype(np.uint8), culling="back")
