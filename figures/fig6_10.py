"""Figure 6-10: the platform in pitch, roll and yaw, each over one swing, and what its legs do meanwhile: CSV and PNG.

The thesis shows photographs of its hydraulic platform and prints no size of it; this is `hexapod_a`.

python figures/fig6_10.py [--fast] [--out DIR]
"""

from pathlib import Path

import numpy as np
from _options import options
from _paper import BLUE, GREEN, GREY, INK, ORANGE, PALE, PURPLE, RED, SKY, paper, save_figure, save_table

from ocean_sim.platform.hexapod import Config
from ocean_sim.platform.shared.kinematics import Hexapod
from ocean_sim.verbs.shared.platform_pictures import draw_stand

GEOMETRY = "hexapod_a"
MOTIONS = {"pitch": 4, "roll": 3, "yaw": 5}  # their place in a pose
SWING, PERIOD, STEPS = np.radians(12.0), 6.0, 120  # [rad], [s], rows of a swing
SHOWN = np.arange(0, STEPS, STEPS // 4)  # rows that are drawn
CLOSE = 0.06  # [m] legs that share one label
LEGS = (BLUE, ORANGE, GREEN, RED, SKY, PURPLE)


def swing_poses(motion: int) -> tuple[np.ndarray, np.ndarray]:
    """Times (n,) [s] and poses (n, 6) of one period of a swing in one motion."""
    time = np.linspace(0.0, PERIOD, STEPS + 1)
    pose = np.zeros((len(time), 6))
    pose[:, motion] = SWING * np.cos(2.0 * np.pi * time / PERIOD)
    return time, pose


def group_legs(lengths: np.ndarray) -> list[list[int]]:
    """Group legs whose lengths nearly agree, to share a label."""
    found: list[list[int]] = []
    for k in np.argsort(lengths, kind="stable").tolist():
        if found and lengths[k] - lengths[found[-1][-1]] < CLOSE:
            found[-1].append(k)
        else:
            found.append([k])
    return [sorted(group) for group in found]


def draw_figure(hexapod: Hexapod, ends: tuple[float, float], rides: dict[str, tuple], path: Path) -> None:
    """Draw a strip of poses for each motion, and the lengths of the legs over time next to it."""
    figure = paper(14.0, 8.6)
    apart = 2.5 * float(np.abs(hexapod.base).max())
    for row, (name, (time, pose, legs)) in enumerate(rides.items()):
        strip = figure.add_subplot(3, 5, (5 * row + 1, 5 * row + 3))
        for k, at in enumerate(SHOWN):
            draw_stand(strip, hexapod, pose[at], k * apart)
            angle = round(float(np.degrees(pose[at, MOTIONS[name]])))
            caption = f"{angle:+d}°, {time[at]:.1f} s" if angle else f"0°, {time[at]:.1f} s"
            strip.text(k * apart, 1.42 * hexapod.neutral_height, caption, ha="center", fontsize=9, color=INK)
        strip.set_title(name, loc="left", fontsize=12, pad=20)
        curve = figure.add_subplot(3, 5, (5 * row + 4, 5 * row + 5))
        for k, colour in enumerate(LEGS):
            curve.plot(time, legs[:, k], color=colour, lw=1.8, ls=("-", "--")[k % 2], label=f"{k + 1}")
        for end in ends:
            curve.axhline(end, color=GREY, lw=1.0, ls=":")
        curve.text(PERIOD, ends[1], "longest", color=GREY, fontsize=8, ha="right", va="bottom")
        curve.text(PERIOD, ends[0], "shortest", color=GREY, fontsize=8, ha="right", va="bottom")
        curve.set(ylabel="leg [m]", xlim=(0, PERIOD), ylim=(ends[0] - 0.1, ends[1] + 0.15))
        curve.grid(color=PALE, lw=0.7)
        for same in group_legs(legs[-1]):
            numbers = ", ".join(str(k + 1) for k in same)
            curve.text(PERIOD + 0.06, legs[-1, same].mean(), numbers, fontsize=8, va="center", color=INK)
        if row == 0:
            curve.set_title("legs 1 to 6", loc="left")
            curve.legend(ncols=6, loc="lower center", bbox_to_anchor=(0.6, 1.0), columnspacing=1.0, handlelength=1.6)
    curve.set_xlabel("time [s]")
    save_figure(figure, path)


def main() -> None:
    out = options(__doc__).out
    machine = Config(geometry=GEOMETRY).build(PERIOD / STEPS)
    hexapod, rows, rides = machine.hexapod, [], {}
    for name, motion in MOTIONS.items():
        time, pose = swing_poses(motion)
        legs = hexapod.legs(pose)
        speed = np.einsum("nij,nj->ni", hexapod.jacobian(pose), swing_velocity(time, motion))
        back = np.abs(hexapod.pose(legs, pose * 0.9) - pose).max(axis=1)
        rides[name] = time, pose, legs
        for k in range(len(time)):
            rows.append((name, float(time[k]), float(np.degrees(pose[k, motion])), *legs[k], *speed[k], float(back[k])))
    head = [f"{GEOMETRY}: swings of {np.degrees(SWING):g} degrees in {PERIOD:g} s, the other five motions neutral"]
    head += ["error: pose found from the legs less the pose that they were found from, the worst of its six numbers"]
    columns = ["motion", "time_s", "angle_deg", *(f"leg{k}_m" for k in range(1, 7))]
    columns += [*(f"leg{k}_m_s" for k in range(1, 7)), "error"]
    save_table(out / "fig6_10.csv", head, columns, [(*row[:-1], f"{max(row[-1], 1e-15):.0e}") for row in rows])
    draw_figure(hexapod, (hexapod.low, hexapod.high), rides, out / "fig6_10.png")


def swing_velocity(time: np.ndarray, motion: int) -> np.ndarray:
    """Velocity [m/s] and angular velocity [rad/s] (n, 6) of a swing in one motion, in the axes of the floor."""
    rate = np.zeros((len(time), 6))
    rate[:, motion] = -SWING * 2.0 * np.pi / PERIOD * np.sin(2.0 * np.pi * time / PERIOD)
    return rate


if __name__ == "__main__":
    main()
