"""Rows of a run: due at exact multiples of `every` whatever the time steps were, written to CSV files, handed on.

A CSV file begins with comment lines that say frame, axes, rate and seed; its columns have units in their names.

What one observer hands to another while a run goes on: rows in memory, as the files show them. Who takes rows says so
by its base class, so observers need not know one another. Who hands on closes before who takes: the last rows are
handed on as it closes, and observers close by turn and name.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, TypeVar

import numpy as np

from ocean_sim.files.atomic_file import file_named_in_errors

if TYPE_CHECKING:
    from ocean_sim.platform import Commands
    from ocean_sim.simulation import Simulation

REAL = (float, np.floating)
ROUNDING = 1.0e-9  # a time that is short of a multiple by this part of `every` has reached it


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
        with file_named_in_errors(path):
            self.file.writelines(f"# {key}: {' '.join(text(value).split())}\n" for key, value in heading.items())
        self.row(self.columns)

    def row(self, values: Iterable[object]) -> str:
        """Write a row; the line that shows it."""
        cells = tuple(values)
        line = pattern(tuple(map(type, cells))) % cells
        with file_named_in_errors(self.file.name):
            self.file.write(line + "\n")
            self.file.flush()
        return line

    def close(self) -> None:
        self.file.close()


class Multiples:
    """The multiples of `every` [s] that simulated time reaches, each counted once, from the first time seen on."""

    next: int | None

    def __init__(self, every: float) -> None:
        self.every = every
        self.next = None

    def reached(self, time: float) -> range:
        """Numbers k of the multiples k * every that were passed since the last call."""
        if self.next is None:
            self.next = math.ceil(time / self.every - ROUNDING)
        end = math.floor(time / self.every + ROUNDING) + 1
        passed = range(self.next, end)
        self.next = max(self.next, end)
        return passed


class Sample(NamedTuple):
    """One row: `values` lie on the line between two states, `held` are those of the state before."""

    time: float
    values: np.ndarray
    held: tuple[float | str, ...]


class Sampled:
    """A vector that is known after some steps and sampled at multiples of `every`.

    A run calls its observers with the last state before and the first state after each multiple; a straight line
    between the two is second-order in the time step. Names and counts have no in-between: they are held from the
    state before.
    """

    before: Sample | None

    def __init__(self, every: float, most: float = math.inf) -> None:
        """`most`: multiples that one step may pass; of more, the first and the last have rows."""
        self.every, self.most = every, most
        self.multiples = Multiples(every)
        self.before = None

    def rows(self, time: float, values: np.ndarray, held: tuple = ()) -> list[Sample]:
        """The samples that the state at `time` completes."""
        now = Sample(time, np.asarray(values, dtype=np.float64), held)
        passed = self.multiples.reached(time)
        shown = passed if len(passed) <= self.most else (passed[0], passed[-1])
        rows = [between(self.before or now, now, k * self.every) for k in shown]
        self.before = now
        return rows


def between(before: Sample, after: Sample, time: float) -> Sample:
    """The state at `time` on the straight line from `before` to `after`."""
    if time >= after.time or after.time <= before.time:
        return Sample(time, after.values, after.held)
    part = max(0.0, (time - before.time) / (after.time - before.time))
    return Sample(time, before.values + part * (after.values - before.values), before.held)


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
