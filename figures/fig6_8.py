"""Figure 6-8: ships under way: a catamaran by its manoeuvring model in still water, a yacht in a closed-form sea and
the same yacht on the surface of particles under a gust; tracks and motions, and pictures of the second voyage: CSV, PNG
and MP4.

fig6_8.mp4 is a clip of the second voyage, 6 s long. fig6_8_bare.png is the last of the pictures with nothing drawn that
the run does not know: no far sea, ripples, foam or scattered sky.

python figures/fig6_8.py [--fast] [--out DIR]
"""

from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from _kept import BARE, save_film, save_picture, take_pictures
from _options import options, progress
from _paper import BLUE, GREY, INK, ORANGE, PALE, RED, paper, save_figure, save_table

from ocean_sim.pictures.frame_files import frame_files
from ocean_sim.reading.scene import load
from ocean_sim.simulation import Simulation

QUIET = dict.fromkeys(("accuracy", "timings", "health", "frames", "render", "report", "motion"))
PICTURES, CLIP, RATE = 4, (6.0, 12.0), 15.0  # of the second voyage: stills, [s] of the clip, its pictures per second
EVERY = 0.1  # [s] between rows
OTTER = np.array([[0.54, 1.0], [0.54, -1.0], [-0.54, -1.0], [-0.54, 1.0]])  # its corners, x to port, z to the bow [m]


def voyages(fast: bool) -> dict[str, dict[str, Any]]:
    """Scenes of the three voyages by title; in each the rudder goes to port and then to starboard."""
    open_sea = {"length": 400.0, "width": 400.0, "depth": 20.0, "walls": "none"}
    spectrum = {"kind": "jonswap", "significant_wave_height": 0.8, "peak_period": 5.0, "heading_deg": 150.0, "seed": 7}
    return {
        "the Otter, manoeuvring, in still water": {
            "duration": 60.0,
            "basin": open_sea,
            "fluid": {"kind": "linear_waves", "height": 0.0, "period": 5.0},
            "ship": {"kind": "manoeuvring", "position": [0.0, -20.0], "controls": turns(6.0, 26.0, 46.0, 0.6, 0.1)},
        },
        "a yacht, hydrostatic, in waves of 0.8 m": {
            "duration": 15.0 if fast else 60.0,
            "basin": open_sea,
            "fluid": {"kind": "linear_waves", "spectrum": spectrum},
            "ship": ship([0.0, -100.0], 3.0, turns(8.0, 22.0, 44.0, 0.7, 0.35)),
        },
        "the yacht on particles under a wide gust": {
            "duration": 4.0 if fast else 9.0,
            "basin": {"length": 40.0, "width": 40.0, "depth": 7.5},
            "fluid": "thesis_6000",
            "wind": "wide",
            "surface": "cloth",
            "ship": ship([-4.0, -11.5], 2.0, turns(0.5, 5.0, 8.0, 0.5, 0.6)),
            "resolution": 2.0 if fast else 1.0,
        },
    }


def ship(position: list[float], speed: float, controls: list[dict[str, float]]) -> dict[str, Any]:
    """Scene keys of the yacht, a displacement hull of 30 t."""
    damping = {"heave": 0.15, "pitch": 0.15, "roll": 0.08, "surge": 400.0}
    return {
        "kind": "hydrostatic",
        "hull": "yacht",
        "cells_per_draught": 6.0,
        "damping": damping,
        "propeller": {"thrust": 14400.0, "position": [0.0, 0.4, -6.3]},
        "rudder": {"area": 0.8, "aspect_ratio": 1.5, "position": [0.0, 0.5, -6.8]},
        "position": position,
        "velocity": [0.0, 0.0, speed],
        "controls": controls,
    }


def turns(begin: float, other: float, end: float, throttle: float, rudder: float) -> list[dict[str, float]]:
    """Rows of a ship's `controls`: straight ahead, rudder to port, to starboard at `other`, amidships at `end` [s]."""
    rows, angle = [(0.0, 0.0)], 0.0
    for time, then in ((begin, rudder), (other, -rudder), (end, 0.0)):
        rows += [(time, angle), (time + 1.0, then)]
        angle = then
    return [{"time": time, "throttle": throttle, "rudder": angle} for time, angle in rows]


def sail_scene(scene: dict[str, Any], done: Any, folder: Path | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Run a scene. Return rows (n, 11) of time [s], sway, heave, surge [m], pitch, yaw, roll [deg], speed ahead [m/s],
    throttle, rudder [deg], height of the water at the ship [m]; and the outline of the deck, x to port, z to the bow
    [m]. `done`: called with the progress; `folder`: for frames, if any."""
    rows = []
    shown = {} if folder is None else {"frames": {"every": 1.0 / RATE, "spacing": 5.0}}
    with Simulation(load({"title": "figure 6-8", **scene, **QUIET, **shown}), folder) as simulation:
        vessel = simulation.ships["ship"]
        hull = vessel.drawn()
        outline = OTTER if hull is None else deck(hull[0])
        for moment in np.arange(0.0, scene["duration"] + 0.5 * EVERY, EVERY):
            if moment > simulation.time:
                simulation.run(until=float(moment))
            body = vessel.body
            throttle, rudder = vessel.orders
            height = (simulation.surface or simulation.fluid).elevations(body.position[None, [0, 2]])[0]
            ahead = float(body.matrix[:, 2] @ body.velocity)
            angles = np.degrees(body.angles)
            rows.append([simulation.time, *body.position, *angles, ahead, throttle, np.degrees(rudder), float(height)])
            done(moment / scene["duration"])
    table = np.array(rows)
    table[:, 5] = np.degrees(np.unwrap(np.radians(table[:, 5])))
    return table, outline


def deck(vertices: np.ndarray) -> np.ndarray:
    """Convex outline of a hull as seen from above."""
    from scipy.spatial import ConvexHull

    flat = vertices[:, [0, 2]]
    return flat[ConvexHull(flat).vertices]


def draw_figure(found: dict[str, tuple], moments: np.ndarray, pictures: np.ndarray, path: Path) -> None:
    """Draw pictures of the second voyage, and for each ship its track from above (port to the left) and motions."""
    whole = paper(14.5, 12.8)
    strip, figure = whole.subfigures(2, 1, height_ratios=(2.6, 10.0))
    for axis, moment, picture in zip(strip.subplots(1, len(pictures)), moments, pictures):
        axis.imshow(picture)
        axis.set_axis_off()
        axis.set_title(f"the yacht in waves, {moment:.0f} s", fontsize=10)
    axes = figure.subplots(4, 3, height_ratios=(2.4, 1.0, 1.0, 1.0))
    for column, (title, (rows, outline)) in enumerate(found.items()):
        time, place, angles = rows[:, 0], rows[:, [1, 3]], rows[:, 4:7]
        track, strips = axes[0, column], axes[1:, column]
        track.plot(*place.T, color=BLUE, lw=1.5)
        span = max(float(np.ptp(place, axis=0).max()), 4.0)
        large = max(1.0, 0.06 * span / float(np.ptp(outline[:, 1])))  # a small boat is drawn larger
        way = float(np.linalg.norm(np.diff(place, axis=0), axis=1).sum())
        count = int(np.clip(1.0 + way / (1.2 * large * float(np.ptp(outline[:, 1]))), 2, 7))
        for k in np.linspace(0, len(time) - 1, count).round().astype(int):
            yaw = np.radians(angles[k, 1])
            turn = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
            shape = place[k] + large * outline @ turn.T
            track.fill(*shape.T, facecolor=ORANGE, edgecolor=INK, lw=0.8, alpha=0.75, zorder=3)
            label_at = place[k] - (0.035 * span + large * float(np.ptp(outline[:, 0]))) * turn[:, 0]
            track.text(*label_at, f"{round(time[k], 1):g} s", fontsize=8, ha="center", va="center", color=INK, zorder=4)
        if large > 1.0:
            track.text(
                0.98, 0.02, f"boat drawn {large:.1f} times as large", transform=track.transAxes, ha="right", fontsize=8
            )
        centre = 0.5 * (place.min(axis=0) + place.max(axis=0))
        half = 0.5 * span + 0.75 * large * float(np.ptp(outline[:, 1]))
        track.set(xlim=(centre[0] + half, centre[0] - half), ylim=(centre[1] - half, centre[1] + half), aspect="equal")
        track.set(xlabel="x, to port at the start [m]", ylabel="z [m]")
        track.set_title(title, fontsize=11)
        track.grid(color=PALE, lw=0.7)
        strips[0].plot(time, rows[:, 7], color=BLUE, lw=1.6, label="speed ahead [m/s]")
        strips[0].plot(time, rows[:, 8], color=GREY, lw=1.4, ls="--", label="throttle")
        strips[1].plot(time, angles[:, 1], color=BLUE, lw=1.6, label="yaw, to port [°]")
        strips[1].plot(time, rows[:, 9], color=RED, lw=1.4, ls="--", label="rudder [°]")
        strips[2].plot(time, angles[:, 2], color=BLUE, lw=1.4, label="roll, port up [°]")
        strips[2].plot(time, angles[:, 0], color=ORANGE, lw=1.4, ls="--", label="pitch, bow down [°]")
        for strip in strips:
            low, high = strip.get_ylim()
            strip.set(xlim=(0, time[-1]), ylim=(low, high + 0.35 * (high - low)))
            strip.grid(color=PALE, lw=0.7)
            strip.legend(loc="upper right", ncols=2)
        strips[-1].set_xlabel("time [s]")
    save_figure(whole, path)


def main() -> None:
    asked = options(__doc__, "shorter, on coarse particles")
    scenes = voyages(asked.fast)
    found, rows = {}, []
    with TemporaryDirectory() as place:
        for k, (title, scene) in enumerate(scenes.items()):
            folder = Path(place) if k == 1 else None
            tell = partial(progress_of, k, title=title, voyages=len(scenes))
            found[title] = sail_scene(scene, tell, folder)
        moments, pictures, bare = render_voyage(Path(place), list(scenes.values())[1]["duration"], asked)
    save_picture(asked.out / "fig6_8_bare.png", bare)
    for title in scenes:
        rows += [(title, *row) for row in found[title][0].tolist()]
    head = ["x to port, y up, z to the bow at the start; angles: intrinsic yaw (Y), pitch (X), roll (Z)"]
    columns = ["voyage", "time_s", "sway_m", "heave_m", "surge_m", "pitch_deg", "yaw_deg", "roll_deg"]
    columns += ["speed_ahead_m_s", "throttle", "rudder_deg", "water_m"]
    save_table(asked.out / "fig6_8.csv", head, columns, rows)
    draw_figure(found, moments, pictures, asked.out / "fig6_8.png")


def render_voyage(run: Path, lasts: float, asked: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Render pictures of a run, and write its clip: times [s], pictures (n, height, width, 3), the last one bare."""
    size, quality = ((320, 180), "draft") if asked.fast else ((960, 540), "final")
    view: dict[str, Any] = {"camera": "follow", "size": size}
    moments = np.linspace(0.2, 1.0, PICTURES) * (lasts - 1.0)
    orders = [{"stills": (float(moment),)} for moment in moments]
    *pictures, bare = take_pictures(run, float(moments[-1]), [*orders, BARE | orders[-1]], quality=quality, **view)
    for file in frame_files(run):
        with np.load(file) as frame:
            outside = not CLIP[0] <= float(frame["time"]) <= CLIP[0] + (0.5 if asked.fast else np.ptp(CLIP))
        if outside:
            file.unlink()
    view["size"] = size if asked.fast else (1280, 720)
    save_film(run, asked.out / "fig6_8.mp4", every=1.0 / RATE, **view)
    return moments, np.array(pictures), bare


def progress_of(voyage: int, share: float, title: str, voyages: int) -> None:
    """Report progress at every tenth of a voyage."""
    if abs(10.0 * share - round(10.0 * share)) < 0.02:
        progress((voyage + share) / voyages, title)


if __name__ == "__main__":
    main()
