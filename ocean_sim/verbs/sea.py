"""`ocean-sim sea`: the waves of a scene as files that other programs read, and the spectra of a file."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from ocean_sim import wave_field
from ocean_sim.conventions import Refused
from ocean_sim.files.atomic_file import new_figure, save_figure, write_file
from ocean_sim.reading.scene import load
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.options import MAX_NUMBER, Sets, complete_scene, number_list
from ocean_sim.waves import exchange
from ocean_sim.waves.directional import DirectionalSpectrum, Spreading
from ocean_sim.waves.spectrum_files import MAX_STEEPNESS, STEEP_RULE, TIME_FORM, read_spectra, read_spectrum

DRAWN_VARIANCE = 0.98  # share of the variance below the highest frequency of a picture


def sea(
    scene: Annotated[
        str,
        typer.Argument(
            metavar="SCENE|FILE",
            help="A scene, by its file or name, or a file of spectra (NDBC, CDIP, Spotter, SWAN, WAVEWATCH III, ERA5).",
            autocompletion=complete_scene,
        ),
    ],
    sets: Sets = None,
    swd: Path | None = typer.Option(None, help="A spectral-wave-data file (.swd) to write."),
    openfast: Path | None = typer.Option(None, help="An elevation file of OpenFAST (.Elev, WaveMod 5) to write."),
    at: str = typer.Option("0,0", help="X,Z [m], the point of that elevation."),
    every: float = typer.Option(0.1, min=0.001, help="Time between its rows [s]."),
    until: float | None = typer.Option(None, min=0.001, help="Its end [s]; by default that of the scene."),
    time: str | None = typer.Option(None, help="Date and time in a file of spectra (UTC), which else lists all."),
    point: int = typer.Option(1, min=1, help="Number of the point in such a file."),
    spreading: Spreading = typer.Option("mem", help="How moments of a buoy become directions."),
    out: Path | None = typer.Option(None, help="Where its picture goes; by default next to the file."),
) -> None:
    """Write the waves of a scene as files, or describe and draw the spectrum in a file."""
    suffix = Path(scene).suffix
    if suffix not in (".yaml", ".yml") and (suffix or Path(scene).is_file()):
        if sets or swd or openfast:
            raise Refused(f"{scene}: is no scene; --set, --swd and --openfast are for scenes")
        describe_file(Path(scene), time, point, spreading, out)
        return
    if time is not None or out is not None:
        raise Refused("--time and --out are for a file of spectra, not for a scene")
    if swd is None and openfast is None:
        raise Refused("name a file to write: --swd FILE, --openfast FILE")
    place = number_list("--at", at, "0,0") or [0.0, 0.0]
    config = load(scene, console.set_values(sets))
    field = wave_field(config)
    waves, files = field.sea, []
    title = " ".join((config.title or scene).split())  # one line of a file
    if swd is not None:
        write_file(swd, exchange.to_swd(waves, title))
        files.append(swd)
    if openfast is not None:
        if not (until or config.duration) <= MAX_NUMBER * every:
            raise Refused(f"--until {until}: of --every {every:g} s at most {MAX_NUMBER:g} rows are written")
        times = np.arange(0.0, (until or config.duration) + 0.5 * every, every)
        heights = np.concatenate([field.elevation(np.array([place]), t) for t in times.tolist()])
        what = f"{title}, x = {place[0]:g} m, z = {place[1]:g} m"
        write_file(openfast, exchange.to_openfast(times, heights, what))
        files.append(openfast)
    count, height = len(waves.amplitude), waves.significant_height
    console.answer({"waves": count, "significant_height_m": height, "depth_m": waves.depth, "files": files})
    console.say(f"{title}: {count} plane waves, significant height {height:.3g} m")
    for file in files:
        console.say(str(file))


def describe_file(path: Path, time: str | None, point: int, spreading: Spreading, out: Path | None) -> None:
    """Describe the spectrum of a point at a time in a file and draw it into folder `out`, or list its times."""
    records, rows, files = read_spectra(path) if time is None else [], list[dict[str, Any]](), list[Path]()
    if len(records) > 1:
        title = f"{path}: take one of these as --time"
        steep = sum(each.steepness > MAX_STEEPNESS for _, points in records for each in filter(None, points))
        remarks = [f"{steep} of these cannot be: {STEEP_RULE}"] * bool(steep)
        for when, points in records:
            first = next(filter(None, points), None)
            state = {"hm0_m": first and first.significant_height, "tp_s": first and first.peak_period}
            rows.append({"time": f"{when:{TIME_FORM}}", "points": len(points) - points.count(None)} | state)
    else:
        when, spectrum = read_spectrum(path, time, point)
        table = spectrum.spread(spreading)
        parts, remarks = table.partitions(), [table.remark] * bool(table.remark)
        title = f"{path.name}{f' at {when:{TIME_FORM}}' if when else ''}, point {point}"
        rows = [{"part": "whole"} | table.state()._asdict()]
        rows += [{"part": f"partition {k}"} | part.state()._asdict() for k, part in enumerate(parts, 1)]
        picture = (path.parent if out is None else out) / f"{path.stem}_spectrum.png"
        files += [picture] if console.draw_if_able(draw_spectrum, picture, title, table, parts) else []
    console.answer({"rows": rows, "files": files, "remarks": remarks})
    cells = [
        [f"{cell:.3g}" if isinstance(cell, float) else console.cell(cell, "-") for cell in row.values()] for row in rows
    ]
    console.table(title, [*rows[0]], cells)
    console.say("\n".join(map(str, [*remarks, *files])))


def draw_spectrum(path: Path, title: str, table: DirectionalSpectrum, parts: Sequence[DirectionalSpectrum]) -> None:
    """Draw density [m2/(Hz deg)] over frequency [Hz] and direction of origin, and number the wave systems, `parts`."""
    from matplotlib.colors import PowerNorm

    figure = new_figure(6.5, 6.0)
    axes = figure.add_subplot(projection="polar", theta_offset=0.5 * np.pi, theta_direction=-1)
    sides = np.radians(table.direction[0]) + table.step * (np.arange(len(table.direction) + 1) - 0.5)
    shades = axes.pcolormesh(sides, table.edges, np.radians(table.density), cmap="Blues", norm=PowerNorm(0.5))
    for k, part in enumerate(parts, 1):
        i, j = np.unravel_index(part.density.argmax(), part.density.shape)
        label = {"boxstyle": "circle", "facecolor": "white", "alpha": 0.8}
        axes.text(np.radians(part.direction[j]), part.frequency[i], f"{k}", bbox=label, ha="center", va="center")
    grown = np.cumsum(table.variance)
    axes.set_ylim(0.0, table.edges[1 + np.searchsorted(grown, DRAWN_VARIANCE * grown[-1])])
    axes.set_xticks(np.radians(np.arange(0.0, 360.0, 45.0)), ["N", "NE", "E", "SE", "S", "SW", "W", "NW"])
    axes.grid(alpha=0.3)
    axes.set(rlabel_position=np.degrees(np.angle(-table.moment.sum())))  # away from the waves
    axes.set_title(f"{title}\nwhere the waves come from, over frequency [Hz]", fontsize="medium")
    figure.colorbar(shades, label="density [m2/(Hz deg)]", shrink=0.8)
    save_figure(figure, path)
