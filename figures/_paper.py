"""The paper that figures are drawn on, and the table next to each."""

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path
from textwrap import wrap
from typing import Any

import numpy as np
from _options import Said

from ocean_sim.files.atomic_file import new_figure
from ocean_sim.palette import BLUE as BLUE
from ocean_sim.palette import GREEN as GREEN
from ocean_sim.palette import ORANGE as ORANGE
from ocean_sim.palette import PURPLE as PURPLE
from ocean_sim.palette import RED as RED
from ocean_sim.palette import SKY as SKY

INK, SOFT, GREY, PALE = "#16242c", "#44525c", "#5f6d76", "#dde5ea"  # of words, captions, lines, grids
DPI = 150
LETTERS, SMALL = 16.0, 4.0  # of a caption in an inch; [inch] at most, of a picture whose letters are smaller
SUN, AMBIENT = np.array([-0.70, 0.64, -0.32]), 0.35  # towards the sun, x, y up and z; light of the sky, over all of it
HASTY, WHOLE = "--fast: coarse", "--fast leaves nothing out here"


def paper(width: float, height: float) -> Any:
    """A matplotlib figure of this size [inch] without a display, in the common style; its panels do not overlap."""
    from matplotlib import rcParams
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    rcParams.update({"axes.spines.top": False, "axes.spines.right": False, "axes.titlelocation": "left"})
    rcParams.update({"axes.titlesize": 11, "axes.labelsize": 10, "legend.fontsize": 9, "legend.frameon": False})
    apart = ConstrainedLayoutEngine(h_pad=0.09)  # [inch], so that no caption touches a label
    return new_figure(width, height, apart)


def save_figure(figure: Any, path: Path, found: str = "") -> None:
    """Write a figure as PNG, byte for byte the same each time, with number and caption; `--fast` is marked. `found`:
    end of the caption, such as numbers of the table. A small figure, one of several, has `found` alone as caption."""
    width = figure.get_figwidth()
    small = 0.6 if width <= SMALL else 1.0
    said = () if width <= SMALL else (Said.caption,)
    words = ". ".join(part for part in (*said, found, WHOLE if Said.fast and Said.whole else "") if part)
    lines = wrap(words, int(width * LETTERS / small))
    figure.supxlabel("\n".join(lines), x=0.01, ha="left", fontsize=8.0 * small, color=SOFT)
    if Said.fast and not Said.whole:
        figure.text(0.995, 0.995, HASTY, ha="right", va="top", fontsize=8.0 * small, color=SOFT)
    figure.savefig(path, dpi=DPI, metadata={"Software": None})


def set_plan(axes: Any, **words: Any) -> None:
    """Set up axes for a plan x, z seen from above, as `render --camera top` shows it: x to the right and z down. Axes
    in space whose third direction is up are then right-handed, too. `words`: further properties of the axes."""
    axes.set(xlabel="x [m]", ylabel="z [m]", **words)
    axes.yaxis.set_inverted(True)


def light_colours(points: np.ndarray, triangles: np.ndarray, colours: np.ndarray) -> np.ndarray:
    """Colours (m, 3) of the triangles of a surface under a low sun, with points (n, 3) of x, y up, z; level triangles
    keep their colour."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-12)[:, None]
    normals *= np.where(normals[:, 1:2] < 0.0, -1.0, 1.0)
    light = np.clip(normals @ SUN, 0.0, None) / SUN[1]
    return np.clip(colours * (AMBIENT + (1.0 - AMBIENT) * light)[:, None], 0.0, 1.0)


def save_table(path: Path, head: Sequence[str], columns: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
    """Write a CSV file: comment lines `head`, column names with units, and rows, numbers to seven digits."""
    with path.open("w", newline="", encoding="utf-8") as file:
        file.writelines(f"# {line}\n" for line in head)
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows([csv_value(value) for value in row] for row in rows)


def csv_value(value: Any) -> Any:
    """Value as the CSV file has it: floats to seven digits, negative zero as zero."""
    if hasattr(value, "item"):
        value = value.item()
    return f"{value + 0.0:.7g}" if isinstance(value, float) else value
