"""The paper that figures are drawn on, and the table next to each."""

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path
from textwrap import wrap
from typing import Any

from _options import Said

from ocean_sim.palette import BLUE as BLUE
from ocean_sim.palette import GREEN as GREEN
from ocean_sim.palette import ORANGE as ORANGE
from ocean_sim.palette import PURPLE as PURPLE
from ocean_sim.palette import RED as RED
from ocean_sim.palette import SKY as SKY

INK, GREY, PALE = "#16242c", "#7a8790", "#dde5ea"
DPI = 150
NARROW, LETTERS = 4.0, 16.0  # [inch] at most, of a panel without a caption; letters of one in an inch
HASTY = "--fast: coarse"


def paper(width: float, height: float) -> Any:
    """A matplotlib figure of this size [inch], without a display, whose parts keep apart."""
    from matplotlib import rcParams
    from matplotlib.figure import Figure

    rcParams.update({"axes.spines.top": False, "axes.spines.right": False, "axes.titlelocation": "left"})
    rcParams.update({"axes.titlesize": 11, "axes.labelsize": 10, "legend.fontsize": 9, "legend.frameon": False})
    return Figure(figsize=(width, height), layout="constrained")


def keep(figure: Any, path: Path, found: str = "") -> None:
    """The figure as a PNG with its number and caption, the same bytes each time; a hasty one says so. `found`: numbers
    that the caption ends with, as the table has them."""
    width = figure.get_figwidth()
    if width > NARROW:
        words = wrap(". ".join(part for part in (Said.caption, found) if part), int(width * LETTERS))
        figure.supxlabel("\n".join(words), x=0.01, ha="left", fontsize=8.0, color=GREY)
    if Said.fast:
        figure.text(
            0.5, 0.5, HASTY, rotation=24.0, ha="center", va="center", fontsize=4.0 * width, color=INK, alpha=0.10
        )
    figure.savefig(path, dpi=DPI, metadata={"Software": None})


def table(path: Path, head: Sequence[str], columns: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
    """A CSV file: comment lines, columns with their units, rows; numbers to seven digits."""
    with path.open("w", newline="", encoding="utf-8") as file:
        file.writelines(f"# {line}\n" for line in head)
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows([written(value) for value in row] for row in rows)


def written(value: Any) -> Any:
    """A number as it is written; negative zero is zero."""
    if hasattr(value, "item"):
        value = value.item()
    return f"{value + 0.0:.7g}" if isinstance(value, float) else value
