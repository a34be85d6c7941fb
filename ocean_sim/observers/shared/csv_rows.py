"""CSV files that a run writes: comment lines that say frame, axes, rate and seed, then columns with units in their
names."""

from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ocean_sim.files.whole_file import naming

if TYPE_CHECKING:
    from ocean_sim.simulation import Simulation


REAL = (float, np.floating)


def heading(simulation: "Simulation", rate: str, **more: object) -> dict[str, object]:
    """The comment lines that every CSV of a run begins with."""
    return {
        "frame": "world",
        "axes": "right-handed, x and z horizontal, y up, origin at the centre of the still surface",
        "rate": rate,
        "seed": simulation.scene.seed,
        **more,
    }


def text(value: object) -> str:
    """A number with nine significant digits, the same on every machine; anything else as it is."""
    return format(value, ".9g") if isinstance(value, REAL) else str(value)


@lru_cache(maxsize=1000)
def pattern(kinds: tuple[type, ...]) -> str:
    """What shows a row of values of these types as `text` shows each of them."""
    return ",".join("%.9g" if issubclass(kind, REAL) else "%s" for kind in kinds)


class CsvFile:
    """A growing table on disk: each row reaches the file whole, so a killed run leaves whole lines."""

    def __init__(self, path: Path, heading: Mapping[str, object], columns: Sequence[str]) -> None:
        self.columns = tuple(columns)
        self.file = path.open("w", encoding="utf-8", newline="\n")
        with naming(path):
            self.file.writelines(f"# {key}: {' '.join(text(value).split())}\n" for key, value in heading.items())
        self.row(self.columns)

    def row(self, values: Iterable[object]) -> str:
        """Write a row; the line that shows it."""
        cells = tuple(values)
        line = pattern(tuple(map(type, cells))) % cells
        with naming(self.file.name):
            self.file.write(line + "\n")
            self.file.flush()
        return line

    def close(self) -> None:
        self.file.close()
