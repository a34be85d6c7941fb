"""What `ocean-sim waves` leaves next to the record: tables and a plot."""

import csv
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np

from ocean_sim.files.whole_file import whole
from ocean_sim.waves.orbits import Motion
from ocean_sim.waves.record import CUT_OFF, Sea

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
ORBIT = ["particle", "level_m", "along_m", "up_m", "ratio", "drift_m_s"]


def cell(value: float | None) -> str:
    """A number of the table; one that could not be measured is a dash."""
    return "-" if value is None else f"{value:d}" if isinstance(value, int) else f"{value:.4g}"


def write_rows(path: Path, heads: Iterable[str], rows: Iterable[Sequence[str]], **notes: str) -> None:
    """A table, in whole or not at all, under comment lines with notes."""
    with whole(path) as draft, draft.open("w", encoding="utf-8", newline="") as file:
        file.writelines(f"# {key}: {note}\n" for key, note in notes.items())
        csv.writer(file, lineterminator="\n").writerows([list(heads), *rows])


def write_table(path: Path, found: dict[str, Sea], notes: Mapping[str, str]) -> None:
    """A row a gauge, under comment lines with notes."""
    numbers = {name: [getattr(sea, key) for key in COLUMNS.values()] for name, sea in found.items()}
    rows = [[name, *("" if value is None else f"{value:.9g}" for value in own)] for name, own in numbers.items()]
    write_rows(path, ["gauge", *COLUMNS.values()], rows, **notes)


def write_columns(path: Path, columns: dict[str, np.ndarray]) -> None:
    """Arrays (n,) under their names."""
    write_rows(path, columns, ([f"{value:.9g}" for value in row] for row in zip(*columns.values())))


def draw(
    path: Path,
    time: np.ndarray,
    heights: dict[str, np.ndarray],
    frequency: np.ndarray,
    densities: dict[str, np.ndarray],
) -> None:
    """Records above, spectra below."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 7.0), layout="constrained")
    FigureCanvasAgg(figure)
    above, below = figure.subplots(2, 1)
    for name, height in heights.items():
        above.plot(time, height, linewidth=0.9, label=name)
        below.plot(frequency, densities[name], linewidth=1.1, label=name)
    above.set_xlabel("time [s]")
    above.set_ylabel("elevation [m]")
    below.set_xlabel("frequency [Hz]")
    below.set_ylabel("spectral density [m2 s]")
    highest = max((float(frequency[np.argmax(density)]) for density in densities.values()), default=0.0)
    if highest > 0.0:  # beyond it the moments of a spectrum end, too
        below.set_xlim(0.0, min(CUT_OFF * highest, float(frequency[-1])))
    for axes in (above, below):
        axes.grid(alpha=0.3)
        axes.legend(fontsize="x-small")
    with whole(path) as draft:
        figure.savefig(draft, dpi=100)


def orbit_rows(names: Sequence[int], found: Motion) -> list[list[str]]:
    """A row a particle, the highest first."""
    return [
        [f"{name}", *(f"{value:.6g}" for value in (level, o.along_m, o.up_m, o.ratio, o.drift_m_s))]
        for name, level, o in sorted(zip(names, found.level_m, found.orbits), key=lambda row: -row[1])
    ]
