"""A yacht under each kind of ship, side by side: film, strip of pictures, and heave, roll and pitch as CSV.

A yacht of 10 m, two thirds of the ready-made one, lies oblique to the waves of a basin of 20 x 10 x 4 m: the same
particles 0.2 m apart and the same regular wave for each kind. The kind manoeuvring is a published model of another
craft, the Otter, and knows still water alone: its rows of the CSV are a turn in still water, and it has no picture.

python figures/yacht_kinds.py [--fast] [--out DIR]
"""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from _options import options, progress
from _paper import BLUE, GREEN, INK, ORANGE, PALE, RED, paper, save_figure, save_table

from ocean_sim.files.yaml_file import read_mapping
from ocean_sim.observers.render import variants
from ocean_sim.parts import library
from ocean_sim.reading.scene import load, observer_names
from ocean_sim.simulation import Simulation

KINDS = {"thesis": RED, "hydrostatic": ORANGE, "dynamic": BLUE, "pressure": GREEN}
SCALE, HEADING = 2.0 / 3.0, 60.0  # of the yacht; [deg], 30 off the way the waves go
LASTS, EVERY = 5.0, 0.05  # [s]
SPACING, FAST_SPACING, FAST_LASTS = 0.2, 0.4, 0.6  # [m], [s]
SIZE, SHOWN = (640, 334), 5  # pixels of a picture, of which four with labels make 1280 x 720; pictures in the strip
BASIN = {"length": 20.0, "width": 10.0, "depth": 4.0, "walls": {"x": "periodic"}}
WAVE = {"kind": "regular_wave", "height": 0.5, "period": 2.5474, "heading_deg": 90.0}  # 10 m long
LABEL = 26  # pixels


def yacht() -> dict[str, Any]:
    """Hull keys of the ready-made yacht, made smaller."""
    hull = read_mapping(library("configs") / "hull" / "yacht.yaml").plain()
    points = [[SCALE * x for x in point] for point in hull["shape"]["points"]]
    return {
        "shape": {"kind": "outline", "points": points},
        "mass": SCALE**3 * hull["mass"],
        "centre_of_mass": [SCALE * x for x in hull["centre_of_mass"]],
        "inertia": [SCALE**5 * x for x in hull["inertia"]],
    }


def scene(kind: str, spacing: float, lasts: float) -> dict[str, Any]:
    """Scene of the yacht in waves as a ship of this kind; `lasts`: its duration [s]."""
    return dict.fromkeys(name for name in observer_names() if name != "manifest") | {
        "title": f"a yacht of kind {kind}",
        "duration": lasts,
        "basin": BASIN,
        "fluid": {
            "kind": "delta_sph",
            "spacing": spacing,
            "compression": 0.02,
            "artificial_viscosity": 0.05,
            "initial": WAVE,
        },
        "surface": "cloth",
        "ship": {"kind": kind, "hull": yacht(), "heading_deg": HEADING},
        "frames": {"every": EVERY, "particles": False},
        "health": {},
    }


def otter_scene(lasts: float) -> dict[str, Any]:
    """Scene of the Otter turning in still water."""
    return dict.fromkeys(name for name in observer_names() if name != "manifest") | {
        "title": "the Otter in still water",
        "duration": lasts,
        "basin": BASIN | {"walls": "none"},
        "fluid": {"kind": "linear_waves", "period": 2.5474, "height": 0.0},
        "ship": {"kind": "manoeuvring", "controls": [{"time": 0.0, "throttle": 0.6, "rudder": 0.1}]},
    }


def run_motions(keys: dict[str, Any], lasts: float, folder: Path | None, report: Any) -> np.ndarray:
    """Run a scene: rows of time [s], heave from the start [m], roll and pitch [deg]; `report`: takes progress."""
    rows = []
    with Simulation(load(keys), folder) as simulation:
        ship: Any = simulation.ships["ship"]
        start = float(ship.body.position[1])
        for time in np.arange(0.0, lasts + 1e-9, EVERY):
            simulation.run(until=float(time))
            pitch, _, roll = np.degrees(ship.body.angles)
            rows.append((simulation.time, float(ship.body.position[1]) - start, float(roll), float(pitch)))
            report(time / lasts)
    return np.array(rows)


def add_label(picture: np.ndarray, label: np.ndarray) -> np.ndarray:
    """Picture with a label on top."""
    return np.concatenate([label, picture])


def label(text: str, colour: str) -> np.ndarray:
    """Draw text on a bar as wide as a picture: 8-bit RGB array."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(SIZE[0] / 100.0, LABEL / 100.0), dpi=100)
    figure.text(0.02, 0.5, text, color=colour, fontsize=11, va="center", weight="bold")
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[:LABEL, : SIZE[0], :3].copy()


def film(pictures: dict[str, np.ndarray], path: Path) -> None:
    """Write a film of all pictures, two by two, in real time."""
    import imageio.v2 as imageio

    bars = {kind: label(kind, KINDS[kind]) for kind in pictures}
    writer: Any
    with imageio.get_writer(path, fps=round(1.0 / EVERY), macro_block_size=2) as writer:
        for k in range(min(len(rows) for rows in pictures.values())):
            tiles = [add_label(pictures[kind][k], bars[kind]) for kind in KINDS]
            rows = [np.concatenate(tiles[i : i + 2], axis=1) for i in range(0, len(tiles), 2)]
            writer.append_data(np.concatenate(rows))


def strip(pictures: dict[str, np.ndarray], times: np.ndarray, rides: dict[str, np.ndarray], path: Path) -> None:
    """Draw a row of pictures for each kind, and the motions of all kinds below."""
    figure = paper(15.0, 10.4)
    grid = figure.add_gridspec(len(KINDS) + 1, 3 * SHOWN, height_ratios=[1.0] * len(KINDS) + [1.25])
    shown = np.unique(np.linspace(0, len(times) - 1, SHOWN).astype(int))
    for row, kind in enumerate(pictures):
        for column, k in enumerate(shown):
            panel = figure.add_subplot(grid[row, 3 * column : 3 * column + 3])
            panel.imshow(pictures[kind][k])
            panel.set_axis_off()
            panel.set_title(f"{kind}, {times[k]:.1f} s" if column == 0 else f"{times[k]:.1f} s", color=INK, fontsize=10)
    for column, name in enumerate(("heave [m]", "roll [deg]", "pitch [deg]")):
        panel = figure.add_subplot(grid[-1, SHOWN * column : SHOWN * (column + 1)])
        for kind, colour in KINDS.items():
            panel.plot(rides[kind][:, 0], rides[kind][:, 1 + column], color=colour, lw=1.8, label=kind)
        panel.set(xlabel="time [s]", title=name)
        panel.grid(color=PALE, lw=0.7)
        if column == 0:
            panel.legend(ncols=2)
    save_figure(figure, path)


def main() -> None:
    asked = options(__doc__, "coarse water, half a second")
    spacing, lasts = (FAST_SPACING, FAST_LASTS) if asked.fast else (SPACING, LASTS)
    times, share = np.arange(0.0, lasts + 1e-9, EVERY * (4 if asked.fast else 1)), 1.0 / (len(KINDS) + 0.1)
    rides, pictures = {}, {}
    for number, kind in enumerate(KINDS):
        report = lambda part, number=number, kind=kind: progress(share * (number + 0.6 * part), f"{kind}: the run")
        with TemporaryDirectory() as folder:
            rides[kind] = run_motions(scene(kind, spacing, lasts), lasts, Path(folder), report)
            progress(share * (number + 0.6), f"{kind}: pictures")
            moments = [{"stills": (time,)} for time in times.tolist()]
            pictures[kind] = variants(Path(folder), 0.0, moments, size=SIZE, camera="third_person", caption=True)
    rides["manoeuvring"] = run_motions(otter_scene(lasts), lasts, None, lambda part: None)
    head = [f"a yacht of 10 m on particles {spacing:g} m apart, a regular wave of {WAVE['height']:g} m and 10 m length"]
    head += ["pitch: bow down, roll: starboard down; manoeuvring: the Otter, 2 m, turning in still water"]
    rows = [(kind, *(float(x) for x in row)) for kind, ride in rides.items() for row in ride]
    save_table(asked.out / "yacht_kinds.csv", head, ["kind", "time_s", "heave_m", "roll_deg", "pitch_deg"], rows)
    strip(pictures, times, rides, asked.out / "yacht_kinds.png")
    film(pictures, asked.out / "yacht_kinds.mp4")
    progress(1.0, "done")


if __name__ == "__main__":
    main()
