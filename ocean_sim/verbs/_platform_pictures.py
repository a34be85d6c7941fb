"""Pictures of a motion platform: what it did in time, its legs, its workspace, and itself, drawn from its joints."""

from pathlib import Path
from typing import Any

import numpy as np

from ocean_sim.platform import Commands
from ocean_sim.platform._hexapod import Hexapod
from ocean_sim.platform.hexapod import Config, Moving

MOST = 4000  # points of a curve
AXES = ("x [m]", "y [m]", "z [m]", "roll [deg]", "pitch [deg]", "yaw [deg]")
STRIPS = (("pitch", 4), ("roll", 3), ("yaw", 5))
SWING = np.radians(12.0)
FRAMES, FRAME_RATE = 100, 10  # of a film


def draw(folder: Path, done: Commands, config: Config, machine: Moving, film: bool) -> None:
    """Every picture of a ride."""
    stride = max(1, len(done.time) // MOST)
    some = done.some(slice(None, None, stride))
    save(motion(some), folder / "motion.png")
    save(legs(some, config.geometry), folder / "legs.png")
    save(workspace(some, machine), folder / "workspace.png")
    save(strips(machine.hexapod), folder / "strips.png")
    if film:
        filmed(folder / "film.gif", done, machine)


def figure(rows: int, columns: int, size: tuple[float, float], **more: Any) -> tuple[Any, np.ndarray]:
    """A figure without a display, and its axes (rows, columns)."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    picture = Figure(figsize=size, layout="tight")
    FigureCanvasAgg(picture)
    return picture, picture.subplots(rows, columns, squeeze=False, **more)


def save(picture: Any, path: Path) -> None:
    picture.savefig(path, dpi=100)


def told(pose: np.ndarray) -> np.ndarray:
    """(n, 6) poses with angles in degrees."""
    return np.hstack([pose[:, :3], np.degrees(pose[:, 3:])])


def motion(done: Commands) -> Any:
    """Poses, what is felt against what is wanted, and where the platform was limited."""
    picture, axes = figure(4, 1, (10, 11), sharex=True)
    pose = told(done.pose)
    for axis, columns in ((axes[0, 0], range(3)), (axes[1, 0], range(3, 6))):
        for k in columns:
            axis.plot(done.time, pose[:, k], label=AXES[k], lw=1.2)
    for axis, felt, wanted, name, unit in (
        (axes[2, 0], done.felt_force, done.cue.force, "force", "m/s²"),
        (axes[3, 0], done.felt_rate, done.cue.rate, "rate", "rad/s"),
    ):
        for k, letter in enumerate("xyz"):
            (line,) = axis.plot(done.time, felt[:, k], label=f"felt {name} {letter} [{unit}]", lw=1.2)
            axis.plot(done.time, wanted[:, k], ls="--", lw=0.8, color=line.get_color())
        axis.set_title("dashed: scaled motion of the ship", fontsize=9, loc="right")
    for axis in axes[:, 0]:
        low, high = axis.get_ylim()
        axis.fill_between(done.time, low, high, where=done.limited > 0, color="#d1601f", alpha=0.15, lw=0)
        axis.set_ylim(low, high)
        axis.legend(loc="upper left", ncol=3, fontsize=8)
        axis.grid(alpha=0.3)
    axes[0, 0].set_title("shaded: limited", fontsize=9, loc="right")
    axes[3, 0].set_xlabel("time [s]")
    return picture


def legs(done: Commands, geometry: Any) -> Any:
    """Leg lengths and speeds between their limits."""
    picture, axes = figure(2, 1, (10, 6.5), sharex=True)
    ends = (geometry.shortest + geometry.buffer, geometry.longest - geometry.buffer)
    for axis, values, limits, label in (
        (axes[0, 0], done.legs, ends, "length [m]"),
        (axes[1, 0], done.leg_velocity, (-geometry.leg_speed, geometry.leg_speed), "speed [m/s]"),
    ):
        for k in range(6):
            axis.plot(done.time, values[:, k], lw=1.0, label=f"leg {k + 1}")
        for limit in limits:
            axis.axhline(limit, color="k", ls=":", lw=1.0)
        axis.set_ylabel(label)
        axis.grid(alpha=0.3)
    axes[0, 0].legend(loc="upper left", ncol=6, fontsize=8)
    axes[1, 0].set_xlabel("time [s]")
    return picture


def workspace(done: Commands, machine: Moving) -> Any:
    """What two motions can reach while the other four are neutral, and where the ride went."""
    picture, axes = figure(2, 2, (10, 9))
    ends, pose = told(machine.workspace.ends.T).T, told(done.pose)
    for axis, (one, other) in zip(axes.flat, ((0, 2), (1, 2), (0, 1), (3, 4))):
        grid = [np.linspace(1.1 * ends[k, 0], 1.1 * ends[k, 1], 121) for k in (one, other)]
        across, up = np.meshgrid(*grid)
        poses = np.zeros((across.size, 6))
        for k, values in ((one, across), (other, up)):
            poses[:, k] = values.ravel() if k < 3 else np.radians(values.ravel())
        usage = machine.hexapod.usage(poses)
        usage[machine.hexapod.condition(poses) > machine.hexapod.condition_limit] = 2.0
        usage = usage.reshape(across.shape)
        axis.contourf(across, up, usage, [0.0, 0.25, 0.5, 0.75, 1.0], cmap="Blues_r", alpha=0.6)
        axis.contour(across, up, usage, [1.0], colors="k", linewidths=1.0)
        axis.plot(pose[:, one], pose[:, other], color="#d1601f", lw=0.8)
        axis.set_xlabel(AXES[one])
        axis.set_ylabel(AXES[other])
    picture.suptitle("stroke used when the other four motions are neutral; line: this ride", fontsize=10)
    return picture


def strips(hexapod: Hexapod) -> Any:
    """Figure 6-10: pitch, roll and yaw, each over one swing."""
    picture, axes = figure(3, 1, (12, 9))
    apart = 2.8 * float(np.abs(hexapod.base).max())
    for axis, (name, motion) in zip(axes[:, 0], STRIPS):
        for k, phase in enumerate(np.cos(np.linspace(0.0, 2.0 * np.pi, 5))):
            pose = np.zeros(6)
            pose[motion] = SWING * phase
            stand(axis, hexapod, pose, k * apart)
            axis.text(k * apart, 1.25 * hexapod.neutral_height, f"{round(np.degrees(pose[motion])):+d}°", ha="center")
        axis.set_title(name, loc="left")
    return picture


def seen(points: np.ndarray) -> np.ndarray:
    """(n, 2) where (n, 3) points are on a picture taken from starboard ahead, a little above."""
    turn, rise = np.radians(35.0), np.radians(15.0)
    along = points[:, 0] * np.cos(turn) - points[:, 1] * np.sin(turn)
    away = points[:, 0] * np.sin(turn) + points[:, 1] * np.cos(turn)
    return np.column_stack([along, points[:, 2] * np.cos(rise) + away * np.sin(rise)])


def stand(axis: Any, hexapod: Hexapod, pose: np.ndarray, offset: float = 0.0) -> None:
    """The hexapod in a pose: base, legs, platform, and which way is forward."""
    leg, _ = hexapod.arms(pose[None])
    base, top = (seen(points) + [offset, 0.0] for points in (hexapod.base, hexapod.base + leg[0]))
    axis.fill(*base.T, color="#c9d3d9", lw=1.5, ec="#4a5a66")
    for foot, head in zip(base, top):
        axis.plot(*np.array([foot, head]).T, color="#b8892b", lw=2.5, solid_capstyle="round")
    axis.fill(*top.T, color="#0b6e8a", alpha=0.75, lw=1.5, ec="#16242c")
    axis.plot(*np.array([top.mean(axis=0), top[[0, 5]].mean(axis=0)]).T, color="#d1601f", lw=2.0)
    axis.set_aspect("equal")
    axis.set_axis_off()


def filmed(path: Path, done: Commands, machine: Moving) -> None:
    """The first seconds of a ride, in real time."""
    from matplotlib.animation import PillowWriter

    picture, axes = figure(1, 1, (5, 5))
    axis, writer = axes[0, 0], PillowWriter(fps=FRAME_RATE)
    reach, height = 1.5 * float(np.abs(machine.hexapod.base).max()), machine.hexapod.neutral_height
    with writer.saving(picture, str(path), 80):
        for k in np.searchsorted(done.time, done.time[0] + np.arange(FRAMES) / FRAME_RATE):
            if k == len(done.time):
                break
            axis.clear()
            stand(axis, machine.hexapod, done.pose[k])
            axis.set(xlim=(-reach, reach), ylim=(-0.5 * height, 1.7 * height), title=f"{done.time[k]:.1f} s")
            writer.grab_frame()
