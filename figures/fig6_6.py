"""Figure 6-6: the sea from the helm of a yacht that sails through waves of 1.5 m, and what the helmsman feels: CSV, PNG
and MP4.

The eye is at the helm and goes with the ship. fig6_6.mp4 is a clip of that view, 5 s long. fig6_6_bare.png is the same
view with nothing drawn that the run does not know: no far sea, ripples, foam or scattered sky.

python figures/fig6_6.py [--fast] [--out DIR]
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from _kept import BARE, run_frames, save_film, save_picture, take_pictures
from _options import options, progress
from _paper import BLUE, GREEN, INK, ORANGE, PALE, RED, paper, save_figure, save_table
from fig6_5 import SCENE

from ocean_sim.pictures.frame_files import FrameLog, frame_files

EVERY = 1.0 / 30.0  # [s] between frames of the clip
BEGIN, SHOWN = 6.0, 8.0  # [s] when the clip begins, and the time of the picture
LASTS = 5.0  # [s] of the clip
SAIL = {"kind": "yacht", "position": [10.0, -30.0], "velocity": [0.0, 0.0, 4.0]}
ORDERS = [{"time": 0.0, "throttle": 0.8}]


def voyage(seconds: float) -> dict:
    """Scene of the yacht of figure 6-5, under way for so many seconds."""
    frames = {"every": EVERY, "spacing": 4.0}
    ship, step = SAIL | {"controls": ORDERS}, {"kind": "fixed", "dt": 0.5 * EVERY}
    return SCENE | {"title": "figure 6-6", "duration": seconds, "frames": frames, "ship": ship, "time_step": step}


def helm(log: FrameLog) -> np.ndarray:
    """Motions in every frame: rows of time [s], heave [m], pitch, yaw, roll [deg], speed [m/s]."""
    track = log.tracks["ship"]
    turn = track.turn
    pitch, yaw, roll = (
        np.degrees(angle)
        for angle in (
            -np.arcsin(turn[:, 1, 2]),
            np.arctan2(turn[:, 0, 2], turn[:, 2, 2]),
            np.arctan2(turn[:, 1, 0], turn[:, 1, 1]),
        )
    )
    speed = np.linalg.norm(np.gradient(track.position[:, [0, 2]], track.time, axis=0), axis=1)
    return np.column_stack([track.time, track.position[:, 1], pitch, yaw, roll, speed])


def draw_figure(picture: np.ndarray, rows: np.ndarray, shown: float, path: Path) -> None:
    """Draw the picture, and the motions below it."""
    figure = paper(10.0, 8.4)
    top, below, heave = figure.subplots(3, 1, height_ratios=(5.6, 1.2, 1.0))
    top.imshow(picture)
    top.set_axis_off()
    top.set_title(f"from the helm of a yacht of 15 m, waves of 1.5 m, {shown:.1f} s")
    for column, name, colour, dashes in (
        (2, "pitch, bow down", ORANGE, "-"),
        (4, "roll, port up", BLUE, "--"),
        (3, "yaw, to port", GREEN, "-."),
    ):
        below.plot(rows[:, 0], rows[:, column], dashes, color=colour, lw=1.5, label=name)
    below.set_ylabel("turned [°]")
    heave.plot(rows[:, 0], rows[:, 1] - rows[0, 1], color=RED, lw=1.5, label="heave from the start [m]")
    heave.plot(rows[:, 0], rows[:, 5], color=INK, lw=1.2, ls="--", label="speed [m/s]")
    heave.set_xlabel("time [s]")
    for axes in (below, heave):
        axes.axvline(shown, color=INK, lw=0.8, ls=":")
        low, high = axes.get_ylim()
        axes.set(xlim=(rows[0, 0], rows[-1, 0]), ylim=(low, high + 0.4 * (high - low)))  # room for the names
        axes.grid(color=PALE, lw=0.7)
        axes.legend(loc="upper left", ncols=3)
    save_figure(figure, path)


def main() -> None:
    asked = options(__doc__, "small pictures and a clip of half a second")
    begin, shown, lasts = (4.5, 5.0, 0.5) if asked.fast else (BEGIN, SHOWN, LASTS)
    size = (320, 180) if asked.fast else (1280, 720)
    with TemporaryDirectory() as place:
        progress(0.0, "a yacht under way")
        run = run_frames(voyage(begin + lasts), Path(place, "run"))
        progress(0.3, "the view from its helm")
        quality = "draft" if asked.fast else "final"
        view = {"camera": "first_person", "size": size, "quality": quality}
        picture, bare = take_pictures(run, shown, [{}, BARE], **view)
        log = FrameLog(frame_files(run))
        rows = helm(log)
        for file, time in zip(log.files, log.times):
            if time < begin - 0.5 * EVERY:
                file.unlink()  # the clip begins later
        progress(0.4, "a clip of it")
        save_film(run, asked.out / "fig6_6.mp4", camera="first_person", size=size, every=EVERY, quality="draft")
    save_picture(asked.out / "fig6_6_bare.png", bare)
    head = ["angles: intrinsic yaw (Y), pitch (X), roll (Z); heave of the centre of mass"]
    columns = ["time_s", "heave_m", "pitch_deg", "yaw_deg", "roll_deg", "speed_m_s"]
    save_table(asked.out / "fig6_6.csv", head, columns, rows.tolist())
    draw_figure(picture, rows, shown, asked.out / "fig6_6.png")
    progress(1.0, "done")


if __name__ == "__main__":
    main()
