"""Pictures of a motion platform: its motion over time, legs and workspace, and drawings of the hexapod."""

from pathlib import Path
from typing import Any

import numpy as np

from ocean_sim.conventions import GRAVITY
from ocean_sim.files.atomic_file import atomic_write, new_figure, save_figure
from ocean_sim.platform import Commands
from ocean_sim.platform.hexapod import Config, HexapodPlatform
from ocean_sim.platform.shared.kinematics import Hexapod

MAX_CURVE_SECONDS = 120.0  # [s] of a curve over time
MAX_PATH_POINTS = 20000  # points of a path
AXIS_LABELS = ("x [m]", "y [m]", "z [m]", "roll [deg]", "pitch [deg]", "yaw [deg]")
FORCE_LABELS = ("specific force on the platform, x [m/s²]", "y", "z, less g")
RATE_LABELS = ("angular rate of the platform, x [deg/s]", "y", "z")
PUSH_LABELS = tuple(f"felt specific force, {axis} [m/s²]" for axis in ("forward", "to port", "up, less g"))
TURN_LABELS = tuple(f"felt rate of {turn} [deg/s]" for turn in ("roll", "pitch", "yaw"))
FILM_SECONDS, FRAME_RATE = 10.0, 20  # of a film
WORKSPACE_PAIRS = ((0, 2), (1, 2), (0, 1), (3, 4), (3, 5), (4, 5))  # motions of which a workspace is drawn
WORKSPACE_POINTS = 121  # points along one of them
PLATE_THICKNESS = 0.025  # of the drawn platform, as a part of its height


def draw_pictures(
    folder: Path, done: Commands, best: Commands | None, config: Config, machine: HexapodPlatform, film: bool
) -> None:
    """Draw pictures of the commands `done` into a folder: motion.png, legs.png and workspace.png, best.png if
    there are those of the `best` ride within the limits, and film.gif if `film` is true."""
    span = liveliest_span(done, machine, MAX_CURVE_SECONDS)
    shown = done.select(span)
    curves = [(draw_motion(shown), "motion.png"), (draw_legs(shown, config.geometry), "legs.png")]
    if best is not None:
        curves.append((draw_best(shown, best.select(span), machine.hexapod), "best.png"))
    for picture, name in curves:
        if len(shown.time) < len(done.time):
            picture.suptitle(f"the liveliest {MAX_CURVE_SECONDS:g} s of {np.ptp(done.time):.4g} s", fontsize=10)
        save_figure(picture, folder / name)
    path = done.select(slice(None, None, max(1, len(done.time) // MAX_PATH_POINTS)))
    save_figure(draw_workspace(path, machine), folder / "workspace.png")
    if film:
        write_film(folder / "film.gif", done, machine)


def liveliest_span(done: Commands, machine: HexapodPlatform, seconds: float) -> slice:
    """Slice of a ride's rows, `seconds` [s] long, in which the legs move most."""
    moved = np.concatenate([[0.0], np.cumsum(np.abs(done.leg_velocity).sum(axis=1))])
    rows = min(len(done.time), round(seconds / machine.every))
    first = int(np.argmax(moved[rows:] - moved[: len(moved) - rows]))
    return slice(first, first + rows)


def panel_grid(rows: int, columns: int, size: tuple[float, float], **more: Any) -> tuple[Any, np.ndarray]:
    """Matplotlib figure of `size` [inch], and its axes as an array (rows, columns); `more`: for `plt.subplots`."""
    picture = new_figure(*size, layout="tight")
    return picture, picture.subplots(rows, columns, squeeze=False, **more)


def in_degrees(pose: np.ndarray) -> np.ndarray:
    """Copy of poses (n, 6) [m, rad] with their three angles in degrees."""
    return np.hstack([pose[:, :3], np.degrees(pose[:, 3:])])


def draw_motion(done: Commands) -> Any:
    """Figure of pose, specific force and rates over time; dashed: the scaled motion of the ship; shaded: at a limit."""
    picture, axes = panel_grid(4, 1, (10, 11.5), sharex=True)
    pose, resting = in_degrees(done.pose), [0.0, 0.0, GRAVITY]
    for axis, columns in ((axes[0, 0], range(3)), (axes[1, 0], range(3, 6))):
        for k in columns:
            axis.plot(done.time, pose[:, k], label=AXIS_LABELS[k], lw=1.2)
    for axis, felt, wanted, names in (
        (axes[2, 0], done.felt_force - resting, done.cue.force - resting, FORCE_LABELS),
        (axes[3, 0], np.degrees(done.felt_rate), np.degrees(done.cue.rate), RATE_LABELS),
    ):
        for k, name in enumerate(names):
            (line,) = axis.plot(done.time, felt[:, k], label=name, lw=1.2)
            axis.plot(done.time, wanted[:, k], ls="--", lw=0.8, color=line.get_color())
    for axis, title in zip(axes[:, 0], ("shaded: limited", "", *2 * ("dashed: scaled motion of the ship",))):
        low, high = axis.get_ylim()
        axis.fill_between(done.time, low, high, where=done.limited > 0, color="#d1601f", alpha=0.15, lw=0)
        axis.set_ylim(low, high)
        label_axes(axis, title, 3)
    axes[3, 0].set_xlabel("time [s]")
    return picture


def draw_best(done: Commands, best: Commands, hexapod: Hexapod) -> Any:
    """Figure comparing two rides: specific force and rates that the rider feels and should feel, and stroke used."""
    picture, axes = panel_grid(4, 2, (13, 11), sharex=True)
    shown = (("with the washout", done, "#d1601f"), ("best ride", best, "#0b6e8a"))
    for k in range(6):
        axis, of_turn = axes[k % 3, k // 3], k >= 3
        scale, offset = (180.0 / np.pi, 0.0) if of_turn else (1.0, [0.0, 0.0, GRAVITY][k])
        for name, ride, colour in shown:
            felt = ride.felt_rate[:, k - 3] if of_turn else ride.felt_force[:, k]
            axis.plot(ride.time, scale * (felt - offset), lw=1.4, color=colour, label=name)
        wanted = done.cue.rate[:, k - 3] if of_turn else done.cue.force[:, k]
        axis.plot(done.time, scale * (wanted - offset), "k--", lw=0.9, label="asked for")
        axis.set_title((TURN_LABELS if of_turn else PUSH_LABELS)[k % 3], fontsize=9, loc="right")
    for _, ride, colour in shown:
        axes[3, 0].plot(ride.time, 100.0 * hexapod.usage(ride.pose), lw=1.4, color=colour)
        axes[3, 1].plot(ride.time, ride.pose[:, 2], lw=1.4, color=colour)
    axes[3, 0].set_title("stroke used, of the leg that uses most [%]", fontsize=9, loc="right")
    axes[3, 1].set_title("heave of the platform [m]", fontsize=9, loc="right")
    axes[0, 0].legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2, ncol=3, fontsize=8, frameon=False)
    for axis in axes.flat:
        axis.grid(alpha=0.3)
    for axis in axes[3]:
        axis.set_xlabel("time [s]")
    return picture


def label_axes(axis: Any, title: str, columns: int) -> None:
    """Add to Matplotlib axes a grid, a title, and above, where it hides no curve, a legend in so many columns."""
    axis.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2, ncol=columns, fontsize=8, frameon=False)
    axis.set_title(title, fontsize=9, loc="right")
    axis.grid(alpha=0.3)


def draw_legs(done: Commands, geometry: Any) -> Any:
    """Figure of leg lengths [m] and speeds [m/s] in commands `done` over time, with limits from the `geometry`."""
    picture, axes = panel_grid(2, 1, (10, 6.5), sharex=True)
    ends = (geometry.shortest + geometry.buffer, geometry.longest - geometry.buffer)
    speeds = (-geometry.leg_speed, geometry.leg_speed)
    for axis, values, limits, label, title in (
        (axes[0, 0], done.legs, ends, "length [m]", "dotted: ends of the stroke, less its buffer"),
        (axes[1, 0], done.leg_velocity, speeds, "speed [m/s]", "dotted: fastest"),
    ):
        for k in range(6):
            axis.plot(done.time, values[:, k], lw=1.0, label=f"leg {k + 1}")
        for limit in limits:
            axis.axhline(limit, color="k", ls=":", lw=1.0)
        axis.set_ylabel(label)
        label_axes(axis, title, 6)
    axes[1, 0].set_xlabel("time [s]")
    return picture


def draw_workspace(done: Commands, machine: HexapodPlatform) -> Any:
    """Figure of the poses within reach, for pairs of motions with the other four neutral, and the path of the ride."""
    picture, axes = panel_grid(2, 3, (14, 8.5))
    pose = in_degrees(done.pose)
    for axis, (one, other) in zip(axes.flat, WORKSPACE_PAIRS):
        across, up, usage = stroke_usage_grid(machine, one, other)
        shades = axis.contourf(across, up, usage, [0.0, 0.25, 0.5, 0.75, 1.0], cmap="Blues_r", alpha=0.6)
        axis.contour(across, up, usage, [1.0], colors="k", linewidths=1.0)
        axis.plot(pose[:, one], pose[:, other], color="#d1601f", lw=0.8)
        inside = usage <= 1.0
        axis.set_xlim(1.05 * across[inside].min(), 1.05 * across[inside].max())
        axis.set_ylim(1.05 * up[inside].min(), 1.05 * up[inside].max())
        axis.set(xlabel=AXIS_LABELS[one], ylabel=AXIS_LABELS[other])
        axis.grid(alpha=0.2)
    for axis in axes[:, 2]:
        picture.colorbar(shades, ax=axis, label="part of the stroke")
    picture.suptitle("stroke used when the other four motions are neutral; line: this ride", fontsize=10)
    return picture


def stroke_usage_grid(machine: HexapodPlatform, one: int, other: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Grids of one shape: values of two motions, pose columns `one` and `other` [m, deg], and the share of the legs'
    stroke that each pose uses (above 1: out of reach; 2 also for near-singular poses)."""
    size = np.ones(2)
    ends = in_degrees(machine.workspace.ends.T).T
    while True:
        grid = [np.linspace(0.0, 1.0, WORKSPACE_POINTS) * np.ptp(ends[k]) + ends[k, 0] for k in (one, other)]
        across, up = np.meshgrid(*(wide * values for wide, values in zip(size, grid)))
        poses = np.zeros((across.size, 6))
        for k, values in ((one, across), (other, up)):
            poses[:, k] = values.ravel() if k < 3 else np.radians(values.ravel())
        usage = machine.hexapod.usage(poses)
        usage[machine.hexapod.condition(poses) > machine.hexapod.condition_limit] = 2.0
        usage = usage.reshape(across.shape)
        cut = np.array([usage[:, [0, -1]].min() <= 1.0, usage[[0, -1]].min() <= 1.0])
        if not cut.any() or size.max() > 4.0:
            return across, up, usage
        size = np.where(cut, 1.15 * size, size)


def project_points(points: np.ndarray) -> np.ndarray:
    """Picture coordinates (n, 2) of points (n, 3), seen from starboard, a little ahead and above; forward is right."""
    turn, rise = np.radians(35.0), np.radians(15.0)
    along = points[:, 0] * np.cos(turn) - points[:, 1] * np.sin(turn)
    away = points[:, 0] * np.sin(turn) + points[:, 1] * np.cos(turn)
    return np.column_stack([along, points[:, 2] * np.cos(rise) + away * np.sin(rise)])


def draw_stand(axis: Any, hexapod: Hexapod, pose: np.ndarray, offset: float = 0.0) -> None:
    """Draw the hexapod in a pose (6,) [m, rad], shifted by `offset` [m], and its neutral platform dotted, on `axis`."""
    resting, moved = hexapod.leg_vectors(np.array([np.zeros(6), pose]))[0]
    cylinders = moved * (0.8 * hexapod.low / np.linalg.norm(moved, axis=1))[:, None]  # 0.8 of the shortest leg long
    below = moved - [0.0, 0.0, PLATE_THICKNESS * hexapod.neutral_height]
    rings = (0.0 * moved, resting, moved, below, cylinders)
    base, rest, top, under, ends = (project_points(hexapod.base + ring) + [offset, 0.0] for ring in rings)
    axis.fill(*base.T, color="#c9d3d9", lw=1.5, ec="#4a5a66")
    axis.fill(*rest.T, fill=False, lw=0.8, ls=":", ec="#4a5a66")
    for foot, end, head in zip(base, ends, top):
        axis.plot(*np.array([foot, head]).T, color="#b8892b", lw=1.6, solid_capstyle="round")
        axis.plot(*np.array([foot, end]).T, color="#6b7780", lw=4.0, solid_capstyle="round")
    for order, (points, colour) in enumerate(((under, "#16242c"), (top, "#0b6e8a")), 3):  # above the legs
        axis.fill(*points.T, fc=colour, lw=1.0, ec="#16242c", zorder=order)
    axis.plot(*np.array([top.mean(axis=0), top[[0, 5]].mean(axis=0)]).T, color="#ff9a4d", lw=2.5, zorder=5)
    axis.set_aspect("equal")
    axis.set_axis_off()


def write_film(path: Path, done: Commands, machine: HexapodPlatform) -> None:
    """Write a GIF film of the hexapod in the ride's seconds of most motion, at true speed."""
    from matplotlib.animation import PillowWriter

    picture, axes = panel_grid(1, 1, (5, 5))
    axis, writer = axes[0, 0], PillowWriter(fps=FRAME_RATE)
    reach, height = 1.25 * float(np.abs(machine.hexapod.base).max()), machine.hexapod.neutral_height
    with atomic_write(path) as draft, writer.saving(picture, str(draft), 80):
        for k in film_rows(done, machine):
            axis.clear()
            draw_stand(axis, machine.hexapod, done.pose[k])
            axis.set(xlim=(-reach, reach), ylim=(-0.5 * height, 1.5 * height), title=f"{done.time[k]:.1f} s")
            x, y, z, roll, pitch, yaw = in_degrees(done.pose[[k]])[0]
            place = f"x {x:+.2f} y {y:+.2f} z {z:+.2f} m\nroll {roll:+5.1f} pitch {pitch:+5.1f} yaw {yaw:+5.1f}°"
            axis.text(0.5, 0.0, place, transform=axis.transAxes, ha="center", family="monospace")
            writer.grab_frame()


def film_rows(done: Commands, machine: HexapodPlatform) -> np.ndarray:
    """Indices of the rows that a film shows, one for each picture, within the seconds of most motion."""
    span = liveliest_span(done, machine, FILM_SECONDS)
    frames = max(1, round((span.stop - span.start) * machine.every * FRAME_RATE))
    rows = span.start + np.round(np.arange(frames) / FRAME_RATE / machine.every).astype(int)
    return np.minimum(rows, span.stop - 1)
