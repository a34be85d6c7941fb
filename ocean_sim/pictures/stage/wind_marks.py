"""Marks of the wind in a picture: its volumes as tinted walls, or outlines on a map; arrows along it, and crosses where
it is only noise."""

import numpy as np

from ocean_sim.pictures.frame_files import Frame
from ocean_sim.pictures.stage.overlays import round_down
from ocean_sim.pictures.stage.plotter import Stage
from ocean_sim.pictures.stage.sky import painted_light
from ocean_sim.pictures.water import water_shading

VOLUME_COLOUR, ARROW_COLOUR = "#ffb347", np.array([0.95, 0.42, 0.04])  # of volumes; of arrows, linear RGB
VOLUME_OPACITY = 0.22  # opacity of a volume
# Least and greatest height of a volume over the water, over the basin's length
MIN_VOLUME_HEIGHT, MAX_VOLUME_HEIGHT = 0.10, 0.18
JOINED_ENDS = 1e-3  # [m] at most between ends of outlines that are one corner
VOLUME_DEPTH = 0.2  # of the basin's length: how far it goes on below, where waves hide it
MAX_ARROW, ARROW_HEIGHT = 0.13, 0.02  # of the basin's length: the longest arrow, and how far over the water they begin
ARROW_TITLES = {"m/s²": "acceleration by wind"}  # what an arrow shows, by its unit, where it is not the wind itself
# Length of an arrow below which there is a cross instead, and its size, over the basin's length
MIN_ARROW, CROSS_SIZE = 0.02, 0.05


class WindMarks:
    """Marks of the wind, drawn anew in each picture: walls of its volumes (regions of moving air), arrows, and crosses
    for arrows too short to draw, as where the wind is random alone."""

    def __init__(self, stage: Stage, lower: np.ndarray, upper: np.ndarray) -> None:
        self.stage, self.length = stage, float(max(upper[0] - lower[0], upper[2] - lower[2]))
        arrow = stage.pyvista.Arrow(tip_length=0.3, tip_radius=0.09, shaft_radius=0.032).triangulate()
        self.arrow = arrow.compute_normals(split_vertices=True)
        arms = [stage.pyvista.Cylinder(direction=axis, radius=0.05, height=1.0) for axis in np.eye(3)]
        cross = arms[0].merge(arms[1]).merge(arms[2]).extract_surface().triangulate()
        self.cross = cross.compute_normals(split_vertices=True)

    def show(self, frame: Frame, heights: np.ndarray) -> None:
        """Draw the wind of a frame; `heights` (n,) [m]: of the water under the arrows."""
        self.show_volumes(frame.wind_lines, float(frame.elevation.max()))
        tails = frame.wind_tails.astype(float)
        tails[:, 1] = np.maximum(tails[:, 1], heights) + ARROW_HEIGHT * self.length
        arrows = MAX_ARROW * self.length * frame.wind_arrows.astype(float)
        size = np.linalg.norm(arrows, axis=1)
        blowing = size > MIN_ARROW * self.length
        self.draw_copies("arrows", self.arrow, tails[blowing], arrows[blowing])
        noise = np.tile([CROSS_SIZE * self.length, 0.0, 0.0], (int((~blowing).sum()), 1))
        self.draw_copies("crosses", self.cross, tails[~blowing] + [0.0, noise[:1].sum(), 0.0], noise)

    def draw_copies(self, name: str, model: object, positions: np.ndarray, along: np.ndarray) -> None:
        """Draw copies of a model of length 1 along x, at `positions` (n, 3) [m], turned and scaled to `along` (n, 3)
        [m], as the object `name` in place of one before."""
        self.stage.plotter.remove_actor(name, render=False)
        if not len(positions):
            return
        places = self.stage.mesh(positions, np.zeros((0, 3), int), along=along)
        copies = places.glyph(orient="along", scale="along", geom=model)
        colours = water_shading.display_colours(painted_light(copies.point_normals, ARROW_COLOUR))
        shown = {"name": name, "reset_camera": False, "render": False}
        self.stage.add(copies.points, copies.regular_faces, colours, **shown)

    def show_volumes(self, lines: np.ndarray, crest: float) -> None:
        """Draw walls over outlines of wind volumes, `lines` (n, 2, 3) [m]; on a map, outlines at height `crest` [m]."""
        from scipy.spatial import ConvexHull

        plotter, pyvista = self.stage.plotter, self.stage.pyvista
        for name in ("volumes", "edges of volumes"):
            plotter.remove_actor(name, render=False)
        if not len(lines):
            return
        on_map = self.stage.camera.from_above
        low, high = MIN_VOLUME_HEIGHT * self.length, MAX_VOLUME_HEIGHT * self.length
        walls, edges = pyvista.PolyData(), pyvista.PolyData()
        joined = pyvista.line_segments_from_points(lines.reshape(-1, 3)).clean(tolerance=JOINED_ENDS, absolute=True)
        for volume in joined.split_bodies():
            plan = volume.points[:, [0, 2]]
            around = ConvexHull(plan).vertices
            top = crest if on_map else float(np.clip(volume.points[:, 1].max(), low, high))
            ring = pyvista.MultipleLines(np.insert(plan[[*around, around[0]]], 1, top, axis=1))
            edges += ring
            if not on_map:
                walls += ring.extrude((0.0, -VOLUME_DEPTH * self.length - top, 0.0), capping=False)
        shown = {"lighting": False, "reset_camera": False, "render": False, "color": VOLUME_COLOUR}
        if not on_map:
            plotter.add_mesh(walls, opacity=VOLUME_OPACITY, name="volumes", **shown)
        plotter.add_mesh(edges, line_width=3.0 * self.stage.samples, name="edges of volumes", **shown)


def arrow_legend(frame: Frame, length: float) -> tuple[float, str]:
    """Length [m] and text of the legend's arrow, which stands for a round value of the wind; length 0: no arrow.
    `length`: longer side of the basin [m]."""
    if not (np.linalg.norm(frame.wind_arrows, axis=1) > MIN_ARROW / MAX_ARROW).any():
        return 0.0, "wind: noise alone" if len(frame.wind_tails) else "no wind"
    if frame.wind_strongest <= 0.0:
        return 0.0, "wind"
    value, unit = round_down(frame.wind_strongest), frame.wind_unit
    return MAX_ARROW * length * value / frame.wind_strongest, f"{ARROW_TITLES.get(unit, 'wind')}, {value:g} {unit}"
