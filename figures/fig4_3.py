"""Figure 4-3: the six motions of a ship and the axes they belong to, drawn by turning and moving a hull: CSV and PNG.

The text of section 4.3 gives roll about y and yaw about z, which contradicts its own Y up and surge along z; here
pitch is about x, yaw about y, roll about z, each by the right hand.

python figures/fig4_3.py [--fast] [--out DIR]
"""

from pathlib import Path
from typing import Any

import numpy as np
from _options import options
from _paper import BLUE, GREEN, INK, ORANGE, RED, paper, save_figure, save_table

from ocean_sim.conventions import Motions, to_frame
from ocean_sim.ship.body.rigid_body import euler_quaternion, rotation_matrix
from ocean_sim.ship.hull.hull import hull_of
from ocean_sim.ship.hull.shapes import drawn_mesh as drawn_hull

HULL, SHIFT, TURN = "yacht", 2.0, 15.0  # [m], [deg]
COLOURS = (RED, GREEN, BLUE)  # of x, y, z
TIPS = {"bow": (0.0, 3.2, 7.5), "port side": (2.3, 3.2, 0.0), "keel": (0.0, 0.0, 0.0)}  # [m] from the hull's origin
LIGHT = np.array([0.55, 0.75, 0.4]) / np.linalg.norm([0.55, 0.75, 0.4])
ELEVATION, AZIMUTH = np.radians([24.0, 38.0])  # from where they are seen
EYE = np.array(
    [np.cos(ELEVATION) * np.cos(AZIMUTH), np.cos(ELEVATION) * np.sin(AZIMUTH), np.sin(ELEVATION)]
)  # as matplotlib draws axes
EFFECTS = ("to port", "up", "ahead", "bow down", "bow to port", "port side up")


def move_hull(motion: int, points: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """Points (n, 3) of the hull [m], relative to its centre of mass, after one of the six motions."""
    turn, shift = np.zeros(3), np.zeros(3)
    if motion < 3:
        shift[motion] = SHIFT
    else:
        turn[motion - 3] = np.radians(TURN)
    return (points - centre) @ rotation_matrix(euler_quaternion(*turn)).T + shift


def to_plot(points: np.ndarray) -> np.ndarray:
    """Points in matplotlib's order of axes (third axis up), still right-handed."""
    return points[..., [2, 0, 1]]


def draw_hull(axes: Any, points: np.ndarray, triangles: np.ndarray, colour: str, alpha: float) -> None:
    """Draw a hull, lit from ahead on the port side."""
    from matplotlib.colors import to_rgb
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    corners = points[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    front = to_plot(normal) @ EYE > 0.0  # what looks away would show through where it is sorted wrongly
    corners, normal = corners[front], normal[front]
    shade = 0.55 + 0.45 * np.clip(normal @ LIGHT, 0.0, 1.0)[:, None]
    colours = np.hstack([shade * np.array(to_rgb(colour)), np.full((len(shade), 1), alpha)])
    axes.add_collection3d(
        Poly3DCollection(to_plot(corners), facecolors=colours, edgecolors=colours if alpha == 1.0 else "none", lw=0.4)
    )


def set_view(axes: Any, half: float, zoom: float) -> None:
    axes.set(xlim=(-half, half), ylim=(-half, half), zlim=(-half, half))
    axes.set_box_aspect((1, 1, 1), zoom=zoom)
    axes.set_proj_type("ortho")
    axes.view_init(elev=np.degrees(ELEVATION), azim=np.degrees(AZIMUTH))
    axes.set_axis_off()


def draw_axis(axes: Any, axis: int, reach: float) -> None:
    """Draw a coordinate axis from the centre of mass."""
    end = np.zeros(3)
    end[axis] = reach
    axes.quiver(0.0, 0.0, 0.0, *to_plot(end), color=COLOURS[axis], lw=2.2, arrow_length_ratio=1.0 / reach, zorder=20)


def draw_rotation(axes: Any, axis: int, radius: float, at: float) -> None:
    """Draw a round arrow about an axis, by the right-hand rule."""
    angle = np.radians(np.linspace(20.0, 320.0, 61))
    ring = np.zeros((len(angle), 3))
    ring[:, (axis + 1) % 3], ring[:, (axis + 2) % 3] = radius * np.cos(angle), radius * np.sin(angle)
    ring[:, axis] = at
    axes.plot(*to_plot(ring).T, color=COLOURS[axis], lw=2.0, zorder=20)
    tip = to_plot(ring[[-3, -1]])
    axes.quiver(
        *tip[0],
        *(tip[1] - tip[0]) * 4.0,
        color=COLOURS[axis],
        lw=2.0,
        arrow_length_ratio=0.9,
        zorder=20,
        pivot="middle",
    )


def draw_motions(points: np.ndarray, triangles: np.ndarray, centre: np.ndarray, path: Path) -> None:
    """Draw the axes on the hull at rest, and each motion in front of the hull at rest."""
    figure = paper(14.0, 6.4)
    grid = figure.add_gridspec(2, 5, width_ratios=(1.0, 1.0, 1.0, 1.0, 1.0))
    axes = figure.add_subplot(grid[:, :2], projection="3d", computed_zorder=False)
    draw_hull(axes, points - centre, triangles, "#c9d3d9", 1.0)
    for k, (reach, letter) in enumerate(zip((6.5, 6.0, 11.0), "XYZ")):
        draw_axis(axes, k, reach)
        draw_rotation(axes, k, 1.1, 0.82 * reach)
        tip = np.array([(reach + 1.9, 0.0, 0.0), (0.0, reach + 0.9, 0.0), (0.0, -2.4, reach)][k])
        text = f"{letter}: {Motions._fields[k]},\n{Motions._fields[k + 3]}"
        axes.text(*to_plot(tip), text, color=COLOURS[k], fontsize=12, ha="center", va="center", zorder=30)
    set_view(axes, 8.0, 1.5)
    for k, name in enumerate(Motions._fields):
        panel = figure.add_subplot(grid[k // 3, 2 + k % 3], projection="3d", computed_zorder=False)
        draw_hull(panel, points - centre, triangles, "#c9d3d9", 0.35)
        draw_hull(panel, move_hull(k, points, centre), triangles, ORANGE, 1.0)
        draw_axis(panel, k % 3, (5.5, 6.0, 10.5)[k % 3])
        by = f"+{SHIFT:g} m along" if k < 3 else f"+{TURN:g}° about"
        panel.set_title(f"{name}: {by} {'XYZ'[k % 3]}\n{EFFECTS[k]}", fontsize=10, loc="center", color=INK, y=0.98)
        set_view(panel, 6.6, 1.42)
    save_figure(figure, path)


def main() -> None:
    out = options(__doc__).out
    hull = hull_of(HULL)
    centre = np.array(hull.centre_of_mass)
    points, triangles = drawn_hull(hull.shape)
    tips = np.array(list(TIPS.values()))
    rows = []
    for k, name in enumerate(Motions._fields):
        gone = move_hull(k, tips, centre) - (tips - centre)
        ned = to_frame("ned", np.eye(3)[k % 3])
        for place, vector in zip(TIPS, gone.tolist()):
            size, unit = (SHIFT, "m") if k < 3 else (TURN, "deg")
            rows.append((name, "xyz"[k % 3], size, unit, place, *vector, *(ned.tolist())))
    head = [
        f"how places of the {HULL} go [m] when one motion is positive; ned: its axis in north, east, down of the ship"
    ]
    columns = ["motion", "axis", "by", "unit", "place", "x_m", "y_m", "z_m", "ned_x", "ned_y", "ned_z"]
    save_table(out / "fig4_3.csv", head, columns, rows)
    draw_motions(points, triangles, centre, out / "fig4_3.png")


if __name__ == "__main__":
    main()
