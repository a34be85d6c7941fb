"""`ocean-sim waves`: the records of a run's gauges, as waves."""

from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np
import typer

from ocean_sim.files import csv_file, run_files
from ocean_sim.files.atomic_file import new_figure, save_figure
from ocean_sim.pictures.frame_files import Frame, frame_files, open_frame
from ocean_sim.pictures.water.sea_state import run_scene
from ocean_sim.verbs.render import warn_unless_ended
from ocean_sim.verbs.shared import console
from ocean_sim.waves import record
from ocean_sim.waves.orbits import BREAKING_ACCELERATION, Grid, SurfaceRecord, surface_record, tracer_motion
from ocean_sim.wind.shared.air_load import LAW, stated_speed

WAVE_COLUMNS = {
    "H1/3": "hs_m",
    "4 sqrt m0": "hm0_m",
    "Hmax": "hmax_m",
    "Tz": "tz_s",
    "Tp": "tp_s",
    "Tm01": "tm01_s",
    "Tm02": "tm02_s",
    "waves": "waves",
}
ORBIT_COLUMNS = ["particle", "level_m", "along_m", "up_m", "ratio", "drift_m_s"]


def waves(
    run: Path = typer.Argument(help="A run folder, or its gauges.csv."),
    begin: float = typer.Option(0.0, help="Ignore the record before this time [s]."),
    detrend: bool = typer.Option(False, "--detrend", help="Subtract the straight line fitted to each record."),
    hysteresis: float = typer.Option(
        0.0, min=0.0, help="Count a wave only if it goes this far below and above zero [m]."
    ),
    out: Path | None = typer.Option(None, help="Where the plot and the spectra go; by default next to the record."),
) -> None:
    """Measure gauges; writes waves.csv, spectra.csv, waves.png, surface.csv (of frames), orbits.csv (of tracers)."""
    treatment = record.Treatment(detrend, hysteresis)
    if not isfinite(treatment.hysteresis):
        raise console.Refused(f"--hysteresis is a height in metres, not {treatment.hysteresis:g}")
    path = read_record(run)
    try:
        time, heights = record.gauge_elevations(path, begin)
    except ValueError as error:
        raise console.Refused(str(error)) from None
    found = {}
    for name, height in heights.items():
        try:
            found[name] = record.measure_record(time, height, treatment)
        except record.Unmeasurable as why:
            raise console.Refused(f"{path}: the record of gauge {name!r} {why}") from None
    warn_unless_ended(path.parent)
    folder = path.parent if out is None else out
    folder.mkdir(parents=True, exist_ok=True)
    files = [folder / "waves.csv", folder / "spectra.csv", folder / "waves.png"]
    numbers = {name: [getattr(sea, key) for key in WAVE_COLUMNS.values()] for name, sea in found.items()}
    rows = [[name, *("" if value is None else f"{value:.9g}" for value in own)] for name, own in numbers.items()]
    csv_file.write_table(files[0], ["gauge", *WAVE_COLUMNS.values()], rows, **treatment.notes())
    frequency, densities = record.record_spectra(time, heights, treatment)
    write_columns(files[1], {"frequency_Hz": frequency} | {f"{name}_m2_s": d for name, d in densities.items()})
    if not console.draw_if_able(draw_waves, files[2], time, heights, frequency, densities):
        files.pop()
    surface = read_surface(path.parent, begin)
    if surface is not None:
        files.append(folder / "surface.csv")
        columns = {"time_s": surface.time, "circulation_m2_s": surface.circulation, "white_cap_cover": surface.cover}
        write_columns(files[-1], {name: values for name, values in columns.items() if values is not None})
    run_files.add_to_manifest(path.parent, files)
    treated = {name: treatment_facts(treatment, time, height) for name, height in heights.items()}
    whole_run = ({} if surface is None else surface.means()) | pressure_gain(path)
    console.answer({name: sea.numbers() | treated[name] | whole_run for name, sea in found.items()})
    print_waves(found, path, treatment, time)
    steady = [height for name, height in heights.items() if found[name].waves >= record.MIN_IRREGULAR_WAVES]
    errors = [record.sampling_error(treatment.deviation(record.even_samples(time, h)[1])) for h in steady]
    for sentence in sampling_facts(errors):
        console.say(sentence)
    for name, done in treated.items():
        for warning in done.get("warnings", ()):
            console.say(f"{name}: {warning}")
        if treatment.detrended:
            console.say(f"{name}: less a trend of {done['trend_m_s']:.3g} m/s")
    if surface is not None:
        console.say(surface_sentence(surface))
    tracers = path.parent / "tracers.csv"
    if tracers.is_file():
        files += particle_orbits(tracers, folder, begin, next((sea.tp_s for sea in found.values() if sea.tp_s), None))
        run_files.add_to_manifest(path.parent, files)
    console.say("\n".join(str(file) for file in files))


def read_surface(folder: Path, begin: float) -> SurfaceRecord | None:
    """Circulation and white-cap cover in a run's frames from `begin` [s] on; None if no frames can be read."""
    if not (folder / "frames" / "grid.npz").is_file():
        return None
    try:
        with open_frame(folder / "frames" / "grid.npz") as file:
            x, z, lower, upper = (file[name] for name in ("x", "z", "lower", "upper"))
            grid = Grid(x, z, lower, upper, float(file["depth"]), float(file["spacing"]))
        return surface_record(grid, map(Frame, frame_files(folder)), begin)  # one at a time: frames are large
    except ValueError:
        console.say(f"{folder / 'frames'}: cannot be read, so circulation and white caps are left out")
        return None


def surface_sentence(surface: SurfaceRecord) -> str:
    """Sentences on means over frames: white-cap cover, and circulation of the water about the basin's middle."""
    cover = f"white caps on {100.0 * surface.cover.mean():.3g} % of the surface on average, "
    cover += f"{100.0 * surface.cover.max():.3g} % at most: where it falls faster than {BREAKING_ACCELERATION:g} g "
    cover += f"by waves of {surface.shortest:.3g} m and longer, four points of the frames"
    turn = surface.circulation
    if turn is None:
        return cover
    mean = f"circulation about the vertical {turn.mean():.3g} m2/s on average, standard deviation {turn.std():.2g}"
    return f"{mean}, on a circle of {surface.radius:.3g} m about the middle\n{cover}"


def particle_orbits(path: Path, folder: Path, begin: float, period: float | None) -> list[Path]:
    """Print the orbits of tracers in the file `path` from `begin` [s] on, under waves of a period [s], and write
    orbits.csv. Return a list of that path, or print why there are none and return an empty list."""
    if period is None:
        console.say(f"{path}: no orbits, as no gauge's record resolves a peak period")
        return []
    try:
        names, found = tracer_motion(path, begin, period)
    except (OSError, ValueError, IndexError) as error:
        console.say(f"{path}: no orbits: {error}")
        return []
    rows = [
        [f"{name}", *(f"{value:.6g}" for value in (level, o.along_m, o.up_m, o.ratio, o.drift_m_s))]
        for name, level, o in sorted(zip(names, found.level_m, found.orbits), key=lambda row: -row[1])
    ]
    csv_file.write_table(folder / "orbits.csv", ORBIT_COLUMNS, rows)
    title = f"{path}: orbits under waves of {period:.4g} s (half length and height, and drift)"
    console.table(title, ORBIT_COLUMNS, rows[:: max(1, len(rows) // 10)])
    if found.decay_per_m is not None:
        console.say(f"orbits shrink with depth as exp({found.decay_per_m:.4g} y)")
    return [folder / "orbits.csv"]


def read_record(run: Path) -> Path:
    """Find the gauge records of a run, gauges.csv; returns their path, or raises Refused if there are none."""
    path = run / "gauges.csv" if run.is_dir() else run
    if not run.exists():
        raise console.Refused(f"{run}: there is no such run folder")
    if not path.exists():
        remedy = "name gauges in its scene, as in gauges: {elevation: {centre: [0.0, 0.0]}}"
        raise console.Refused(f"{run}: this run has no gauges.csv; {remedy}")
    return path


def treatment_facts(treatment: record.Treatment, time: np.ndarray, height: np.ndarray) -> dict[str, Any]:
    """Facts by name on treatment of a record (n,) [m] at `time` (n,) [s]: trend [m/s], hysteresis [m], warnings."""
    even = record.even_samples(time, height)
    warnings = [*filter(None, (record.missing_samples(time), record.slow_part(*even, treatment)))]
    found: dict[str, Any] = {"trend_m_s": record.linear_trend(*even)} if treatment.detrended else {}
    found |= {"hysteresis_m": treatment.hysteresis} if treatment.hysteresis else {}
    return found | ({"warnings": warnings} if warnings else {})


def wind_config(path: Path) -> dict[str, Any] | None:
    """The wind section of a run's scene as a dict, found by the path of its gauge record; None if unknown."""
    wind = run_scene(path.parent).get("wind")
    return wind if isinstance(wind, dict) and "kind" in wind else None


def pressure_gain(path: Path) -> dict[str, float]:
    """Factors on a `stress` wind and, if set, its pressure, by column name; else empty. `path`: of the gauge record."""
    wind = wind_config(path) or {}
    if wind.get("kind") != "stress":
        return {}
    own = wind.get("pressure_gain")
    return {"wind_gain": wind["gain"]} | ({} if own is None else {"wind_pressure_gain": own})


def wind_text(path: Path) -> str | None:
    """Description in words of the wind of a run, found by the path of its gauge record; None if unknown."""
    wind = wind_config(path)
    if wind is None:
        return None
    if wind["kind"] == "stress":
        own = wind.get("pressure_gain")
        gain = f"{wind['gain']:g}" + ("" if own is None else f", its pressure on waves times {own:g}")
        if wind.get("tau") is not None:
            return f"wind: a physical stress of {wind['tau']:g} Pa, times a gain of {gain}"
        speed = f"{stated_speed(wind['u10'], None):g} m/s" if wind["schedule"] is None else "by a schedule"
        return f"wind: a physical stress, U10 {speed}, law {wind['drag_law'] or LAW}, times a gain of {gain}"
    return "no wind" if wind["kind"] == "still" else f"wind: {wind['kind']}, a stylised force field"


def print_waves(found: dict[str, record.Sea], path: Path, treatment: record.Treatment, time: np.ndarray) -> None:
    keys = WAVE_COLUMNS.values()
    rows = [[name, *(console.cell(getattr(sea, key), "-") for key in keys)] for name, sea in found.items()]
    heads = [f"{head} [{key.split('_')[-1]}]" if "_" in key else head for head, key in WAVE_COLUMNS.items()]
    console.table(f"{path}: {len(time)} samples from {time[0]:.12g} to {time[-1]:.12g} s", ["gauge", *heads], rows)
    for name, sea in found.items():
        for sentence in record_shortcomings(sea, treatment):
            console.say(f"{name}: {sentence}")
    beyond = f" of waves that go {treatment.hysteresis:g} m below and above" if treatment.hysteresis else ""
    counted = f"H1/3, Tz and Hmax between zero up-crossings{beyond}"
    console.say(f"moments up to {record.CUT_OFF_PEAKS:g} peak frequencies; {counted}")
    if (wind := wind_text(path)) is not None:
        console.say(wind)


def sampling_facts(errors: list[float]) -> list[str]:
    """Sentence, in a list, on the standard errors (shares) of significant wave heights; empty for regular waves."""
    irregular = sorted(error for error in errors if error < record.REGULAR_ERROR)
    if not irregular:
        return []
    share = " to ".join(dict.fromkeys(f"{100.0 * error:.2g}" for error in (irregular[0], irregular[-1])))
    return [f"4 sqrt m0 of irregular waves has a standard error of {share} % in a record of this length"]


def record_shortcomings(sea: record.Sea, treatment: record.Treatment) -> list[str]:
    """Sentences on those statistics for which a record is too short."""
    if not sea.waves:
        if sea.hm0_m and treatment.hysteresis:
            return [f"the record holds no wave that goes {treatment.hysteresis:g} m below and above zero"]
        why = "constant" if sea.hm0_m == 0.0 else "shorter than a wave: it does not cross its mean upwards twice"
        return [f"the record is {why}, so no wave is counted"]
    found = []
    if sea.waves < record.MIN_IRREGULAR_WAVES:
        count = "1 wave" if sea.waves == 1 else f"{sea.waves} waves"
        least = record.MIN_IRREGULAR_WAVES
        found.append(f"the record holds {count}; statistics of irregular waves need at least {least}")
    if sea.tp_s is None:
        why = f"the record is shorter than {record.RECORD_PERIODS:g} periods of its spectral peak"
        found.append(f"{why}, so Tp, Tm01 and Tm02 cannot be resolved")
    return found


def write_columns(path: Path, columns: dict[str, np.ndarray]) -> None:
    csv_file.write_table(path, columns, ([f"{value:.9g}" for value in row] for row in zip(*columns.values())))


def draw_waves(
    path: Path,
    time: np.ndarray,
    heights: dict[str, np.ndarray],
    frequency: np.ndarray,
    densities: dict[str, np.ndarray],
) -> None:
    """Draw the elevation records [m] over time [s], and below them their spectra [m2 s] over frequency [Hz], as PNG."""
    figure = new_figure(9.0, 7.0)
    above, below = figure.subplots(2, 1)
    for name, height in heights.items():
        above.plot(time, height, linewidth=0.9, label=name)
        below.plot(frequency, densities[name], linewidth=1.1, label=name)
    above.set(xlabel="time [s]", ylabel="elevation [m]")
    below.set(xlabel="frequency [Hz]", ylabel="spectral density [m2 s]")
    highest = max((float(frequency[np.argmax(density)]) for density in densities.values()), default=0.0)
    if highest > 0.0:  # beyond it the moments of a spectrum end, too
        below.set_xlim(0.0, min(record.CUT_OFF_PEAKS * highest, float(frequency[-1])))
    for axes in (above, below):
        axes.grid(alpha=0.3)
        axes.legend(fontsize="x-small")
    save_figure(figure, path)
