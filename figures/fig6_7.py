"""Figure 6-7: a yacht that falls into water of particles at speed and raises waves by its two-way contact with them:
four pictures, the height of the water in each, and the momentum of water, ship and both together: CSV and PNG.

Nothing drives or damps the yacht along its way, so that what it loses goes to the water, which passes it on to the
walls: without what these have taken the sum should stay what it was. fig6_7_bare.png is the last picture with nothing
drawn that the run does not know: no far sea, ripples, foam or scattered sky.

python figures/fig6_7.py [--fast] [--out DIR]
"""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from _kept import BARE, run_frames, save_picture, take_pictures
from _options import options, progress
from _paper import BLUE, GREEN, INK, ORANGE, PALE, RED, paper, save_figure, save_table

from ocean_sim.pictures.frame_files import Frame, FrameLog, frame_files

MASS, SPEED, DROP = 30_000.0, 6.0, 1.0  # of the yacht [kg], [m/s], [m] above where it floats
LASTS, EVERY = 3.2, 0.05  # [s]
PICTURES = 4
VIEW = {"camera": "fixed", "eye": (-27.0, 10.0, 13.0), "target": (0.0, -0.5, 1.5)}
PLAIN = {"ripples": False, "foam": False}  # so that every wave in the pictures is the run's
SHIP = {
    "kind": "hydrostatic",
    "hull": "yacht",
    "cells_per_draught": 6.0,
    "damping": {"heave": 0.15, "pitch": 0.15, "roll": 0.08},
    "velocity": [0.0, 0.0, SPEED],
    "contact": {"restitution": 0.0, "friction": 0.0},
}


def scene(spacing: float, lasts: float) -> dict[str, Any]:
    """Scene of the yacht, released 1 m over its floating height and 10 m before the middle of a basin."""
    water = {"kind": "mueller", "spacing": spacing, "compression": 0.008, "kinematic_viscosity": 0.5}
    return {
        "title": "figure 6-7",
        "seed": 7,
        "duration": lasts,
        "basin": {"length": 24.0, "width": 44.0, "depth": 5.0},
        "fluid": water,
        "surface": "cloth",
        "ship": SHIP | {"position": [0.0, 0.4 + DROP, -10.0]},
        "accuracy": {"every": EVERY},
        "motion": {"every": EVERY},
        "frames": {"every": EVERY, "particles": False},
    }


def column(path: Path, *names: str) -> np.ndarray:
    """Read the named columns of a CSV file of a run: an array (names, rows)."""
    head, *rows = [line.rstrip().split(",") for line in path.read_text().splitlines() if not line.startswith("#")]
    return np.array([[float(row[head.index(name)]) for row in rows] for name in names])


def momenta(run: Path) -> np.ndarray:
    """Momentum and impulses of a run, rows (n, 8) of time [s]; along the ship's way the momentum of water, ship and
    both, and the impulse of walls and ship on the water; upwards the momentum of ship and water [N s]."""
    names = "time_s", "momentum_z_kg_m_s", "impulse_walls_z_Ns", "impulse_ship_z_Ns", "momentum_y_kg_m_s"
    time, water, walls, given, up = column(run / "accuracy.csv", *names)
    ship_time, speed, heave = column(run / "motion.csv", "time_s", "surge_velocity_m_s", "heave_velocity_m_s")
    ship, rise = (MASS * np.interp(time, ship_time, v) for v in (speed, heave))
    return np.column_stack([time, water, ship, water + ship, walls, given, rise, up])


def draw_figure(
    pictures: list[np.ndarray], frames: list[Frame], sides: tuple, rows: np.ndarray, found: str, path: Path
) -> None:
    """Draw the film strip, below it heights of the water, and below these the momentum over time."""
    figure = paper(16.0, 8.0)
    grid = figure.add_gridspec(3, PICTURES, height_ratios=(1.1, 0.95, 1.1))
    high = max(float(np.percentile(np.abs(frame.elevation), 99.5)) for frame in frames)
    for k, (picture, frame) in enumerate(zip(pictures, frames)):
        top = figure.add_subplot(grid[0, k])
        top.imshow(picture)
        top.set_axis_off()
        top.set_title(f"{frame.time:.1f} s")
        chart = figure.add_subplot(grid[1, k])
        shown = chart.imshow(frame.elevation, extent=sides, origin="lower", cmap="RdBu_r", vmin=-high, vmax=high)
        place, turn = frame.ships["ship"]
        ends = place + np.array([[0.0, 0.0, -7.2], [0.0, 0.0, 7.5]]) @ turn.T
        chart.plot(ends[:, 2], ends[:, 0], color=INK, lw=4.0, alpha=0.5, solid_capstyle="butt")
        chart.set_xlabel("z [m]")
        if k == 0:
            chart.set_ylabel("x [m]")
    figure.colorbar(shown, ax=chart, label="height of the water [m]")
    axes = figure.add_subplot(grid[2, :])
    time, water, ship, both, walls = rows[:, :5].T / [[1.0], [1e3], [1e3], [1e3], [1e3]]
    axes.plot(time, ship, color=ORANGE, lw=2.0, label="ship")
    axes.plot(time, water, color=BLUE, lw=2.0, label="water")
    axes.plot(time, both, color=GREEN, lw=2.0, label="both")
    axes.plot(time, both - walls, color=INK, lw=1.6, ls="--", label="both, less what the walls gave")
    axes.plot(time, rows[:, 5] / 1e3, color=RED, lw=1.4, ls=":", label="what the hull has given to the water")
    axes.set(xlabel="time [s]", ylabel="momentum along the way [kN s]", xlim=(0.0, time[-1]))
    axes.grid(color=PALE, lw=0.7)
    axes.legend(loc="upper left", ncols=3)
    save_figure(figure, path, found)


def main() -> None:
    asked = options(__doc__, "coarser particles, shorter, small pictures")
    lasts, size = (2.0, (320, 180)) if asked.fast else (LASTS, (960, 540))
    with TemporaryDirectory() as place:
        progress(0.0, "a yacht in water of particles")
        run = run_frames(scene(1.6 if asked.fast else 0.8, lasts), Path(place, "run"))
        progress(0.5, "pictures of it")
        rows = momenta(run)
        log = FrameLog(frame_files(run))
        with np.load(run / "frames" / "grid.npz") as ground:
            low, up = ground["lower"], ground["upper"]
        frames = [Frame(log.nearest(moment)) for moment in np.linspace(0.0, lasts, PICTURES + 1)[1:]]
        view = VIEW | {"size": size, "quality": "draft" if asked.fast else "final"}
        moments = [PLAIN | {"stills": (frame.time,)} for frame in frames]
        *pictures, bare = take_pictures(run, frames[-1].time, [*moments, BARE], **view)
    save_picture(asked.out / "fig6_7_bare.png", bare)
    left = rows[:, 3] - rows[:, 4] - rows[0, 3]
    head = [f"yacht of {MASS:g} kg at {SPEED:g} m/s, dropped by {DROP:g} m; momentum along z, upwards along y"]
    both, walls = rows[-1, 3] - rows[0, 3], rows[-1, 4]
    found = f"Until {rows[-1, 0]:.1f} s both together change by {both / 1e3:+.1f} kN s, of which the walls gave "
    found += f"{walls / 1e3:+.1f}; less what these gave, by at most {100 * np.abs(left / rows[0, 3]).max():.2f} %."
    head += [found]
    columns = ["time_s", "water_kg_m_s", "ship_kg_m_s", "both_kg_m_s", "given_by_walls_Ns", "given_by_ship_Ns"]
    columns += ["ship_up_kg_m_s", "water_up_kg_m_s"]
    save_table(asked.out / "fig6_7.csv", head, columns, rows.tolist())
    draw_figure(pictures, frames, (low[2], up[2], low[0], up[0]), rows, found, asked.out / "fig6_7.png")
    progress(1.0, "done")


if __name__ == "__main__":
    main()
