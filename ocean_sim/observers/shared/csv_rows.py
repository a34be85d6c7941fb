"""Rows of a run's CSV files, due at exact multiples of `every` whatever the time steps: sampled, written, passed on.

A CSV file begins with comment lines on frame, axes, rate and seed; its columns have units in their names.

Observers that receive the rows of another while a run goes on declare it by their base class, `TakesMotion` or
`TakesCommands`, and need not know one another. Observers close by turn and name; the source of rows must close first,
since it passes on its last rows as it closes.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ocean_sim.files.atomic_file import file_named_in_errors
from ocean_sim.files.yaml_file import read_mapping

if TYPE_CHECKING:
    from ocean_sim.platform import Commands
    from ocean_sim.simulation import Simulation

LEGEND_FILE = Path(__file__).with_name("legends.yaml")
TIME_TOLERANCE = 1.0e-9  # of `every`: a time so little short of a multiple has reached it


def heading(simulation: "Simulation", rate: str, **more: object) -> dict[str, object]:
    """Comment lines, by name, at the top of each CSV file of a run: axes, seed, `rate` (text on the rows' times, as
    "every 0.1 s, linear between steps"), and further lines `more`."""
    axes = "right-handed, x and z horizontal, y up, origin at the centre of the still surface"
    return {"frame": "world", "axes": axes, "rate": rate, "seed": simulation.scene.seed, **more}


def legend(name: str, **known: object) -> dict[str, object]:
    """Comment lines that explain the columns of a CSV file: section `name` of LEGEND_FILE, `known` values filled in."""
    return {key: text.format(**known) for key, text in read_mapping(LEGEND_FILE).plain()[name].items()}


@lru_cache(maxsize=1000)
def row_format(kinds: tuple[type, ...]) -> str:
    """Format string for a row of values of these types; real numbers get nine significant digits on every machine."""
    return ",".join("%.9g" if issubclass(kind, float | np.floating) else "%s" for kind in kinds)


class CsvFile:
    """CSV file that grows by rows. Each row is written at once, so that a killed run leaves no broken line."""

    def __init__(self, path: Path, heading: Mapping[str, object], columns: Sequence[str]) -> None:
        """Create the file with its comment lines, `heading` by name, and the line of column names."""
        self.columns = tuple(columns)
        self.file = path.open("w", encoding="utf-8", newline="\n")
        with file_named_in_errors(path):
            texts = {key: row_format((type(value),)) % (value,) for key, value in heading.items()}
            self.file.writelines(f"# {key}: {' '.join(text.split())}\n" for key, text in texts.items())
        self.row(self.columns)

    def row(self, values: Iterable[object]) -> str:
        """Write a row of values; returns its line of text."""
        cells = tuple(values)
        line = row_format(tuple(map(type, cells))) % cells
        with file_named_in_errors(self.file.name):
            self.file.write(line + "\n")
            self.file.flush()
        return line

    def close(self) -> None:
        self.file.close()


class Multiples:
    """Counter of the multiples of `every` [s] that simulated time passes, from the first call of `reached` on."""

    next: int | None

    def __init__(self, every: float) -> None:
        self.every = every
        self.next = None

    def reached(self, time: float) -> range:
        """Integers k for which k * every has been passed since the last call, up to and including `time` [s]."""
        if self.next is None:
            self.next = math.ceil(time / self.every - TIME_TOLERANCE)
        end = math.floor(time / self.every + TIME_TOLERANCE) + 1
        passed = range(self.next, end)
        self.next = max(self.next, end)
        return passed


class Sample(NamedTuple):
    """Row at a time [s]: `values` are interpolated linearly between two states, `held` (names, counts) of the first."""

    time: float
    values: np.ndarray
    held: tuple[float | str, ...]


class Sampled:
    """Sampler of a vector at multiples of `every` [s], for any time steps: `values` are interpolated linearly between
    the states before and after, `held` (names, counts) come from the state before. Second-order in the time step."""

    before: Sample | None

    def __init__(self, every: float, most: float = math.inf) -> None:
        """`most`: if one step passes more multiples than this, only the first and the last of them give rows."""
        self.every, self.most = every, most
        self.multiples = Multiples(every)
        self.before = None

    def rows(self, time: float, values: np.ndarray, held: tuple = ()) -> list[Sample]:
        """Store the state at `time` [s]: `values`, and `held` (names, counts; not interpolated). Return a sample for
        each multiple of `every` since the last call, or only the first and last of more than `most`."""
        now = Sample(time, np.asarray(values, dtype=np.float64), held)
        passed = self.multiples.reached(time)
        shown = passed if len(passed) <= self.most else (passed[0], passed[-1])
        rows = [interpolated(self.before or now, now, k * self.every) for k in shown]
        self.before = now
        return rows


def interpolated(before: Sample, after: Sample, time: float) -> Sample:
    """Sample at `time` [s] on the line between two samples. Its `held` (names, counts) is not interpolated: it is that
    of `before`, or of `after` once its time is reached."""
    if time >= after.time or after.time <= before.time:
        return Sample(time, after.values, after.held)
    part = max(0.0, (time - before.time) / (after.time - before.time))
    return Sample(time, before.values + part * (after.values - before.values), before.held)


class TakesMotion:
    """Base of an observer to which new rows of a ship's motion log are passed as they come, without loads."""

    at_once = False  # True: it gets each row as soon as it is known, not many together

    def take_motion(self, ship: str, rows: dict[str, np.ndarray], frame: str) -> None:
        """Receive new rows of this ship's motion log, an array for each column, in the axes of `frame`."""
        raise NotImplementedError


class TakesCommands:
    """Base of an observer to which new rows of platform.csv, the commands of a motion platform, are passed."""

    at_once = True
    paced = False  # True: its run keeps pace with real time, and waits for no plan of a washout

    def take_commands(self, rows: "Commands") -> None:
        """Receive new commands of the motion platform."""
        raise NotImplementedError
