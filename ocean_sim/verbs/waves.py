"""`ocean-sim waves`: the records of a run's gauges, as waves."""

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np

from ocean_sim.files import csv_file
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.over_time import OverTime, Unreadable, over_time
from ocean_sim.waves.orbits import motion, read_tracers, towards
from ocean_sim.waves.record import CUT_OFF, Sea, Unmeasurable, evenly, measured, welch

SUFFIX = "_m"  # of an elevation gauge
COLUMNS = {
    "H1/3": "hs_m",
    "4 sqrt m0": "hm0_m",
    "Hmax": "hmax_m",
    "Tz": "tz_s",
    "Tp": "tp_s",
    "Tm01": "tm01_s",
    "Tm02": "tm02_s",
    "waves": "waves",
}


def waves(run: Path, begin: float, out: Path | None, as_json: bool) -> None:
    """Measures every elevation gauge; leaves waves.csv, spectra.csv, waves.png, of frames surface.csv, and of tracers
    orbits.csv."""
    path = record(run)
    time, heights = gauges(path, begin)
    try:
        found = {name: measured_as(name, time, height) for name, height in heights.items()}
    except Unmeasurable as why:
        raise console.Refused(f"{path}: {why}") from None
    folder = path.parent if out is None else out
    folder.mkdir(parents=True, exist_ok=True)
    files = [folder / "waves.csv", folder / "spectra.csv", folder / "waves.png"]
    write_table(files[0], found)
    spectra = {name: spectrum(time, height) for name, height in heights.items()}
    write_spectra(files[1], spectra)
    draw(files[2], time, heights, spectra)
    water = whole(path.parent, begin, quiet=as_json)
    if water is not None:
        files.append(folder / "surface.csv")
        water.write(files[-1])
    if as_json:
        whole_run = ({} if water is None else water.told()) | gain(path)
        console.answer({name: sea.told() | whole_run for name, sea in found.items()})
        return
    show(found, path, len(time), time)
    if water is not None:
        console.say(water.sentence())
    files += tagged(path.parent / "tracers.csv", folder, begin, next((s.tp_s for s in found.values() if s.tp_s), None))
    console.say("\n".join(str(file) for file in files))


def whole(folder: Path, begin: float, quiet: bool) -> OverTime | None:
    """Circulation and white-cap cover over time; None, and a sentence, where frames say nothing of them."""
    try:
        return over_time(folder, begin)
    except Unreadable as why:
        if not quiet:
            console.say(str(why))
        return None


def tagged(path: Path, folder: Path, begin: float, period: float | None) -> list[Path]:
    """The orbits of tagged particles under waves of a period [s], shown, and left in orbits.csv; none, no file."""
    if not path.is_file() or period is None:
        return []
    try:
        names, time, places, speeds = read_tracers(path)
        kept = time >= begin
        found = motion(time[kept], places[:, kept], period, towards(places[:, kept], speeds[:, kept]))
    except (OSError, ValueError, IndexError) as error:
        console.say(f"{path}: says nothing of orbits: {error}")
        return []
    heads = ["particle", "level_m", "along_m", "up_m", "ratio", "drift_m_s"]
    rows = [
        [f"{name}", *(f"{value:.6g}" for value in (level, o.along_m, o.up_m, o.ratio, o.drift_m_s))]
        for name, level, o in sorted(zip(names, found.level_m, found.orbits), key=lambda row: -row[1])
    ]
    with (folder / "orbits.csv").open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerows([heads, *rows])
    some = rows[:: max(1, len(rows) // 10)]
    console.table(f"{path}: orbits under waves of {period:.4g} s (half length and height, and drift)", heads, some)
    if found.decay_per_m is not None:
        console.say(f"orbits fall off with depth by exp({found.decay_per_m:.4g} y)")
    return [folder / "orbits.csv"]


def record(run: Path) -> Path:
    """The file with the records of a run."""
    path = run / "gauges.csv" if run.is_dir() else run
    if not run.exists():
        raise console.Refused(f"{run}: there is no such run folder")
    if not path.is_file():
        said = "this run has no gauges.csv; name gauges in its scene, as in gauges: {elevation: {centre: [0.0, 0.0]}}"
        raise console.Refused(f"{run}: {said}")
    return path


def gauges(path: Path, begin: float) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Times (n,) [s] from `begin` on, and the heights (n,) [m] of each elevation gauge."""
    try:
        table = csv_file.numbers(path)
    except ValueError as error:
        raise console.Refused(str(error)) from None
    if "time_s" not in table:
        raise console.Refused(f"{path}: has no column time_s")
    heights = {name.removesuffix(SUFFIX): column for name, column in table.items() if name.endswith(SUFFIX)}
    if not heights:
        raise console.Refused(f"{path}: has no elevation gauge (a column <name>_m); pressures are no waves")
    kept = table["time_s"] >= begin
    if not kept.any():
        raise console.Refused(f"{path}: ends at {table['time_s'][-1]:g} s, before --begin {begin:g}")
    return table["time_s"][kept], {name: column[kept] for name, column in heights.items()}


def measured_as(name: str, time: np.ndarray, height: np.ndarray) -> Sea:
    """The waves of a gauge; raises Unmeasurable with its name."""
    try:
        return measured(time, height)
    except Unmeasurable as why:
        raise Unmeasurable(f"the record of gauge {name!r} {why}") from None


def spectrum(time: np.ndarray, height: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Welch's estimate: frequencies [Hz] and densities [m2 s]."""
    interval, values = evenly(time, height)
    return welch(interval, values - values.mean())


def blown(path: Path) -> dict[str, Any] | None:
    """The wind of the scene, by the manifest beside the record."""
    try:
        wind = json.loads((path.parent / "manifest.json").read_text(encoding="utf-8"))["scene"]["wind"]
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return wind if isinstance(wind, dict) and "kind" in wind else None


def gain(path: Path) -> dict[str, float]:
    """How many times a real wind it was, where it was a physical stress."""
    wind = blown(path) or {}
    return {"wind_gain": wind["gain"]} if wind.get("kind") == "stress" else {}


def wind_of(path: Path) -> str | None:
    """What blew over these waves, with its gain."""
    wind = blown(path)
    if wind is None:
        return None
    if wind["kind"] == "stress":
        speed = "by a schedule" if wind["schedule"] is not None else f"{wind['u10']:g} m/s"
        return f"wind: a physical stress, U10 {speed}, law {wind['drag_law']}, times a gain of {wind['gain']:g}"
    return "no wind" if wind["kind"] == "still" else f"wind: {wind['kind']}, a stylised force field"


def show(found: dict[str, Sea], path: Path, samples: int, time: np.ndarray) -> None:
    """The table for people."""
    rows = [[name, *(cell(getattr(sea, key)) for key in COLUMNS.values())] for name, sea in found.items()]
    heads = [f"{head} [{key.split('_')[-1]}]" if "_" in key else head for head, key in COLUMNS.items()]
    console.table(f"{path}: {samples} samples from {time[0]:g} to {time[-1]:g} s", ["gauge", *heads], rows)
    for name, sea in found.items():
        if not sea.waves:
            why = "constant" if sea.hm0_m == 0.0 else "shorter than a wave: it does not cross its mean upwards twice"
            console.say(f"{name}: the record is {why}, so no wave is counted")
    console.say(f"moments up to {CUT_OFF:g} peak frequencies; H1/3, Tz and Hmax between zero up-crossings")
    if (wind := wind_of(path)) is not None:
        console.say(wind)


def cell(value: float | None) -> str:
    """A number of the table; one that could not be measured is a dash."""
    return "-" if value is None else f"{value:d}" if isinstance(value, int) else f"{value:.4g}"


def write_table(path: Path, found: dict[str, Sea]) -> None:
    """A row a gauge."""
    with path.open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["gauge", *COLUMNS.values()])
        for name, sea in found.items():
            values = [sea.told()[key] for key in COLUMNS.values()]
            rows.writerow([name, *("" if value is None else f"{value:.9g}" for value in values)])


def write_spectra(path: Path, spectra: dict[str, tuple[np.ndarray, np.ndarray]]) -> None:
    """A column a gauge."""
    frequency = next(iter(spectra.values()))[0]
    with path.open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["frequency_Hz", *(f"{name}_m2_s" for name in spectra)])
        for row in zip(frequency, *(density for _, density in spectra.values())):
            rows.writerow([f"{value:.9g}" for value in row])


def draw(path: Path, time: np.ndarray, heights: dict[str, np.ndarray], spectra: dict) -> None:
    """Records above, spectra below."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 7.0), layout="constrained")
    FigureCanvasAgg(figure)
    above, below = figure.subplots(2, 1)
    for name, height in heights.items():
        above.plot(time, height, linewidth=0.9, label=name)
        below.plot(*spectra[name], linewidth=1.1, label=name)
    above.set_xlabel("time [s]")
    above.set_ylabel("elevation [m]")
    below.set_xlabel("frequency [Hz]")
    below.set_ylabel("spectral density [m2 s]")
    for axes in (above, below):
        axes.grid(alpha=0.3)
        axes.legend(fontsize="x-small")
    figure.savefig(path, dpi=100)
