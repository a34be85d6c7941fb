"""Rows of a run. CSV files: comment lines that say frame, axes, rate and seed, then columns with units in their names.

What one observer hands to another while a run goes on: rows in memory, as the files show them. Who takes rows says so
by its base class, so observers need not know one another. Who hands on closes before who takes: the last rows are
handed on as it closes, and observers close by turn and name.
"""

from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from ocean_sim.files.whole_file import naming

if TYPE_CHECKING:
    from ocean_sim.platform import Commands
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


class TakesMotion:
    """An observer that is handed new rows of a ship's motion log, each once, in the order of time: its columns
    before the forces."""

    at_once = False  # whether each row is handed on as soon as it is known, not many together

    def take_motion(self, ship: str, rows: dict[str, np.ndarray], frame: str) -> None:
        raise NotImplementedError


class TakesCommands:
    """An observer that is handed the rows of platform.csv, each once, in the order of time."""

    def take_commands(self, rows: "Commands") -> None:
        raise NotImplementedError


Taker = TypeVar("Taker", TakesMotion, TakesCommands)


def takers(simulation: "Simulation", kind: type[Taker]) -> list[Taker]:
    """The observers of a run that take such rows."""
    return [observer for observer in simulation.observers if isinstance(observer, kind)]
