"""Figure 4-4: a ship cut in cubes, here longer than high, as the program cuts it: which are under water, which the
surface cuts, and what they carry: CSV and PNG.

python figures/fig4_4.py [--fast] [--out DIR]
"""

from pathlib import Path
from typing import Any

import numpy as np
from _options import options
from _paper import BLUE, INK, ORANGE, PALE, RED, paper, save_figure, save_table

from ocean_sim.ship.hull.hull import hull_of
from ocean_sim.ship.naval.hydrostatics import UPRIGHT, Hydrostatics

HULL, DENSITY, GRAVITY = "yacht", 1000.0, 9.81  # [kg/m3], [m/s2]
FEW, CELLS = 3.0, (1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0)  # cubes over the draught: of the picture, of the curve
DRY, CUT, WET = "#e8e2d5", ORANGE, "#5b97bd"


def cube_corners(still: Hydrostatics) -> np.ndarray:
    """Lowest corner (n, 3) of each cube [m], also of cubes that the hull fills only partly."""
    size = still.voxels.size
    lower = np.array(hull_of(HULL).shape.bounds()[0])
    return lower + np.floor((still.voxels.centre - lower) / size) * size


def draw_cubes(axes: Any, corner: np.ndarray, size: np.ndarray, colours: list[str]) -> None:
    """Draw cubes without the faces that two of them share."""
    from matplotlib.colors import to_rgb
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    key = np.round(corner / size).astype(int)
    there = set(map(tuple, key.tolist()))
    faces, shades = [], []
    for number, place, colour in zip(key, corner, colours):
        for axis in range(3):
            for way in (0, 1):
                neighbour = number.copy()
                neighbour[axis] += 2 * way - 1
                if tuple(neighbour.tolist()) in there:
                    continue
                one, other = [k for k in range(3) if k != axis]
                square = np.repeat(place[None], 4, axis=0)
                square[:, axis] += way * size[axis]
                square[[1, 2], one] += size[one]
                square[[2, 3], other] += size[other]
                faces.append(square[:, [2, 0, 1]])
                light = (0.80, 0.78)[way] if axis == 0 else (0.6, 1.0)[way] if axis == 1 else (0.7, 0.88)[way]
                shades.append((*(light * np.array(to_rgb(colour))), 1.0))
    axes.add_collection3d(Poly3DCollection(faces, facecolors=shades, edgecolors=(0.1, 0.15, 0.2, 0.55), lw=0.35))


def draw_figure(still: Hydrostatics, share: np.ndarray, curve: list[tuple], path: Path) -> None:
    """Draw the cubes, coloured by their state in the water; a section; and displacement over number of cubes."""
    from matplotlib.patches import Patch, Rectangle

    figure = paper(14.0, 6.6)
    grid = figure.add_gridspec(2, 2, width_ratios=(1.5, 1.0))
    axes = figure.add_subplot(grid[:, 0], projection="3d")
    corner, size = cube_corners(still), still.voxels.size
    colours = [WET if s >= 1.0 else DRY if s <= 0.0 else CUT for s in share]
    draw_cubes(axes, corner, size, colours)
    axes.set_box_aspect((15.0, 4.6, 3.2), zoom=1.05)
    axes.set(
        xlim=(-7.5, 7.5),
        ylim=(-2.3, 2.3),
        zlim=(0.0, 3.2),
        xlabel="z, to the bow [m]",
        ylabel="x, to port [m]",
        zlabel="y [m]",
    )
    axes.set_yticks([-2, 0, 2])
    axes.set_zticks([0, 1, 2, 3])
    axes.xaxis.labelpad, axes.yaxis.labelpad = 16, 6
    axes.view_init(elev=20.0, azim=-48.0)
    axes.set_proj_type("ortho")
    axes.set_title(f"{HULL}: {len(share)} cubes of {size[0]:.2f} x {size[1]:.2f} x {size[2]:.2f} m", y=1.0)
    parts = ((WET, "under water"), (CUT, "cut by the surface"), (DRY, "above it"))
    handles = [Patch(facecolor=c, edgecolor=INK, lw=0.5, label=t) for c, t in parts]
    axes.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, 0.9), ncols=3)
    section = figure.add_subplot(grid[0, 1])
    middle = np.argmin(np.abs(np.unique(np.round(corner[:, 2], 6)) + 0.5 * size[2]))
    z = np.unique(np.round(corner[:, 2], 6))[middle]
    for k in np.flatnonzero(np.abs(corner[:, 2] - z) < 1e-3):
        (x, y, _), wet = corner[k], float(np.clip(share[k], 0.0, 1.0))
        filled, at = f"{100 * still.voxels.share[k]:.0f}", (x + size[0] / 2, y + size[1] / 2)
        section.add_patch(Rectangle((x, y), *size[:2], facecolor=DRY, edgecolor=INK, lw=0.6, alpha=1.0))
        section.add_patch(Rectangle((x, y), size[0], wet * size[1], facecolor=CUT if wet < 1 else WET, lw=0))
        section.add_patch(Rectangle((x, y), *size[:2], facecolor="none", edgecolor=INK, lw=0.6))
        section.text(*at, filled, ha="center", va="center", fontsize=7, color=INK)
    level = still.draught + still.keel
    section.axhline(level, color=BLUE, lw=1.5)
    section.text(2.5, level + 0.05, "still water", color=BLUE, fontsize=9, va="bottom")
    section.set(xlim=(-2.8, 4.2), ylim=(-0.15, 3.4), aspect="equal", xlabel="x, to port [m]", ylabel="y [m]")
    section.set_title("amidships; numbers: % of a cube inside the hull")
    errors = figure.add_subplot(grid[1, 1])
    cells, wanted, plain = (np.array(column) for column in zip(*[(row[0], row[3], row[4]) for row in curve]))
    errors.loglog(cells, 100 * np.maximum(np.abs(plain - 1.0), 1e-6), "s--", color=RED, label="whole cubes, wet or dry")
    errors.loglog(cells, 100 * np.maximum(np.abs(wanted - 1.0), 1e-6), "o-", color=BLUE, label="with shares, as here")
    errors.set(
        xlabel="cubes over the draught", ylabel="error of the lift [%]", title="lift over weight at the finest draught"
    )
    errors.set_xticks(CELLS, [f"{c:g}" for c in CELLS])
    errors.minorticks_off()
    errors.grid(color=PALE, lw=0.7)
    errors.legend(loc="best")
    save_figure(figure, path)


def main() -> None:
    out = options(__doc__).out
    hull = hull_of(HULL)
    finest = hull.in_still_water(24.0, DENSITY, GRAVITY)
    level = finest.water_level(UPRIGHT)
    still = hull.in_still_water(FEW, DENSITY, GRAVITY)
    share = still.wet_shares(UPRIGHT, still.water_level(UPRIGHT))
    carried = DENSITY * GRAVITY * still.wet_volumes(UPRIGHT, still.water_level(UPRIGHT))
    curve = []
    for cells in CELLS:
        each = hull.in_still_water(cells, DENSITY, GRAVITY)
        lift = DENSITY * float(each.wet_volumes(UPRIGHT, level).sum()) / each.matter.mass
        centre = cube_heights(hull, each)
        whole = each.voxels.size.prod() * (each.voxels.share >= 0.5) * (centre < level)
        plain = DENSITY * float(whole.sum()) / each.matter.mass
        curve.append((cells, len(each.voxels.share), each.draught, lift, plain))
    size = ", ".join(f"{side:.6g}" for side in still.voxels.size)
    head = [f"the {HULL} in cubes of {size} m (x, y, z), afloat in still water"]
    head += [f"they carry {carried.sum():.6g} N, the ship weighs {still.matter.mass * GRAVITY:.6g} N"]
    columns = ["x_m", "y_m", "z_m", "inside", "under_water", "buoyancy_N"]
    rows = np.column_stack([still.voxels.centre, still.voxels.share, np.clip(share, 0.0, 1.0), carried])
    save_table(out / "fig4_4.csv", head, columns, rows.tolist())
    head = [f"lift over weight at a draught of {finest.draught:.6g} m, that of 24 cubes over the draught"]
    columns = ["cells_per_draught", "cubes", "draught_m", "lift_over_weight", "whole_cubes_lift_over_weight"]
    save_table(out / "fig4_4_cells.csv", head, columns, curve)
    draw_figure(still, share, curve, out / "fig4_4.png")


def cube_heights(hull: Any, still: Hydrostatics) -> np.ndarray:
    """Heights (n,) of the centres of all cubes [m], also of cubes that the hull fills only partly."""
    lower, size = hull.shape.bounds()[0][1], still.voxels.size[1]
    return lower + (np.floor((still.voxels.centre[:, 1] - lower) / size) + 0.5) * size


if __name__ == "__main__":
    main()
