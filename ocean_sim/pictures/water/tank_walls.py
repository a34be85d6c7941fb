"""Bed and walls of a tank with lines on them, in soft light; walls between the eye and the tank are left out."""

import sys
from typing import Any

import numpy as np

from ocean_sim.pictures.stage import sky
from ocean_sim.pictures.stage.plotter import Stage
from ocean_sim.pictures.water import water_glsl
from ocean_sim.pictures.water.water_surface import round_up
from ocean_sim.surface import Mesh, sheet

EDGE_LOOK = {"color": "#eef3f6", "opacity": 0.5}  # of the edges of a tank
# Of bed and walls of an absorbing zone; share of its height by which the tint lies over the bed
ZONE_TINT, TINT_LIFT = {"color": "#e8b23c", "opacity": 0.35}, 0.02
PANEL_OFFSET = 0.004  # of a tank's height by which bed and walls are drawn outside the water
# Colour of bed and walls: on dark ground clear water would not tell how thick it is
PANEL_COLOUR = np.array([0.68, 0.74, 0.76])
# Lines on it: [tank's depths] apart, breadth over that, and their light over its
LINE_INTERVAL, LINE_BREADTH, LINE_LIGHT = 0.2, 0.03, 0.86
# Light that a panel lacks where another meets it, a third of it so many heights away
NOOK_SHADE, NOOK_REACH = 0.25, 0.12
# Lines on the ground, and how far they hide it at the block
GROUND_LINE_COLOUR, GROUND_LINE_OPACITY = np.array([0.031, 0.078, 0.118]), 0.16
# Lines along the longer side of a block; of that side, how far around they fade away
GROUND_LINES, GROUND_REACH = 12.0, 1.5
SHADOW_DARKNESS, SHADOW_SOFTNESS = 0.5, 0.10  # of a block's shadow on the ground; how soft, of its longer side
GROUND_DEPTH = 0.02  # of a block's height: how far the ground lies below it
AMBIENT_LIGHT, SUN_LIGHT = 0.84, 0.26  # of light: from all sides, and the sun's on a panel that faces it


def add_shaded(stage: Stage, mesh: Any, program: str, low: np.ndarray, up: np.ndarray, apart: float) -> Any:
    """Add and return the actor of a PyVista mesh with point normals `nrm`, drawn by a shader `program` around the block
    from `low` to `up` [m], with lines `apart` [m]."""
    body = water_glsl.shader(program, sys.modules[__name__], sky)
    shaded = water_glsl.Shaded(mesh, body, "", {}, ("nrm",))
    shaded.set(exposure=1.0, boxLow=low, boxHigh=up, apart=apart)
    stage.plotter.add_actor(shaded.actor, reset_camera=False, render=False)
    return shaded.actor


def ground_sheet(low: np.ndarray, up: np.ndarray) -> tuple[Mesh, float]:
    """Sheet around and below a block from `low` to `up` [m], and the distance of the lines on it, round [m]."""
    longer = max(up[0] - low[0], up[2] - low[2])
    reach = GROUND_REACH * longer
    x, z = (np.array([low[k] - reach, up[k] + reach]) for k in (0, 2))
    below = low[1] - GROUND_DEPTH * (up[1] - low[1])  # a dry bed
    return sheet(x, z, np.full((2, 2), below)), round_up(longer / GROUND_LINES)


def add_ground(stage: Stage, low: np.ndarray, up: np.ndarray) -> None:
    """Add the soft shadow of a block from `low` to `up` [m], and lines round it."""
    ground, apart = ground_sheet(low, up)
    plane = stage.mesh(ground.vertices, ground.triangles, nrm=ground.normals)
    add_shaded(stage, plane, "tank_ground", low, up, apart).ForceTranslucentOn()


def add_edges(stage: Stage, low: np.ndarray, top: np.ndarray, zones: np.ndarray) -> None:
    """Add the edges of a tank from `low` to `top` [m], and tint the inside of absorbing zones (n, 2, 3) [m]."""
    box = stage.pyvista.Box(np.stack([low, top], axis=1).ravel()).extract_feature_edges(30.0)
    stage.over.append(stage.plotter.add_mesh(box, line_width=1.5 * stage.samples, lighting=False, **EDGE_LOOK))
    for zone in zones:
        zone = zone + np.outer([TINT_LIFT, 0.0], [0.0, zone[1, 1] - zone[0, 1], 0.0])  # over a flat bed of sand
        stage.plotter.add_mesh(stage.pyvista.Box(zone.T.ravel()), culling="front", lighting=False, **ZONE_TINT)


def tank_panels(stage: Stage, low: np.ndarray, top: np.ndarray) -> Any:
    """Bed and four walls, facing inwards, of a tank from `low` to `top` [m]: a PyVista mesh with point normals."""
    box = stage.pyvista.Box(np.stack([low, top], axis=1).ravel(), quads=False)
    panels = box.compute_normals(split_vertices=True, flip_normals=True)
    there = panels.cell_data["Normals"][:, 1] > -0.5  # not the lid
    return stage.mesh(panels.points, panels.regular_faces[there], nrm=panels.point_data["Normals"])


def add_panels(stage: Stage, low: np.ndarray, top: np.ndarray, depth: float) -> None:
    """Add bed and walls of a tank from `low` to `top` [m], with lines at a round distance that suits the depth [m]."""
    outside = PANEL_OFFSET * (top[1] - low[1])
    low, top = low - outside, top + outside * np.array([1.0, 0.0, 1.0])
    panels = tank_panels(stage, low, top)
    add_shaded(stage, panels, "tank_panel", low, top, round_up(LINE_INTERVAL * depth)).GetProperty().BackfaceCullingOn()
