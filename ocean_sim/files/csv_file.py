"""CSV files: the only module that parses them.

Lines that begin with # are comments, some of them `key: value`; empty lines are skipped. The first line that is
left names the columns, and every further line is a row; a cell may stand in double quotes. An empty cell is NaN in a
column of numbers and '' in a column of words. The reader of a table states what it should hold:

- `columns`, of a table that a run wrote: a column in which any cell is a word is a column of words, all others are
  numbers. A last line that a killed run did not finish is left out.
- `numbers`, of a table that a person names: numbers alone; a word is NaN, and every row has to be whole.
- `finite`, some columns by name, of which every cell has to be a finite number without quotes: the first that is
  not is an error.
- `records`, every cell as text, row by row.
"""

import csv
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ocean_sim.files import input_file


class Lines(NamedTuple):
    """A CSV file as text: the keys of its comments, the names of its columns, and its rows."""

    head: dict[str, str]
    names: list[str]
    rows: list[str]


def lines(text: str) -> Lines:
    """The parts of the text of a CSV file; without names where there are only comments."""
    written = [line for line in text.splitlines() if line.strip()]
    comments = [line[1:].partition(":") for line in written if line[0] == "#"]
    names, *rows = [line for line in written if line[0] != "#"] or [""]
    head = {key.strip(): value.strip() for key, _, value in comments}
    return Lines(head, [name.strip() for name in cells(names)] if names else [], rows)


def columns(path: str | Path) -> dict[str, np.ndarray]:
    """Each column, (n,), of a table that a run wrote, as float64 or as words, by its name; none where there are no
    names. Raises Unreadable, a ValueError."""
    text = input_file.text(path)
    _, names, rows = lines(text[: text.rfind("\n") + 1])
    return {name: column(found) for name, found in by_column(path, names, rows).items()}


def numbers(path: str | Path) -> dict[str, np.ndarray]:
    """Each column, (n,), of a table that a person names, by its name; what is not a number is NaN. Raises Unreadable, a
    ValueError, also where there is no row."""
    _, names, rows = lines(input_file.text(path))
    if not rows:
        raise input_file.Unreadable(path, "it has no rows under a heading")
    found = by_column(path, names, rows)
    return {name: values if isinstance(values, np.ndarray) else lenient(values) for name, values in found.items()}


def finite(path: str | Path, names: list[str], rows: list[str], wanted: Sequence[str]) -> dict[str, np.ndarray]:
    """Some columns, (n,), by their names; raises ValueError with the first row in which one is not a finite number."""
    indices = [names.index(name) for name in wanted]
    try:
        table = parsed(rows, indices)
    except ValueError:
        row = unparsed(rows, indices) or 0
        found = dict(zip(names, rows[row].split(",")))
        name = next((name for name in wanted if unparsed([f"{found[name]},"], [0]) == 0), wanted[0])
        raise ValueError(f"{path}: {name} is {described(found[name])} in row {row + 1}") from None
    wrong = np.argwhere(~np.isfinite(table))
    if len(wrong):
        row, k = wrong[0]
        raise ValueError(f"{path}: {wanted[k]} is {table[row, k]} in row {row + 1}")
    return dict(zip(wanted, table.T))


def records(text: str) -> list[dict[str, str]]:
    """The rows of the text of a CSV file, each cell as text by the name of its column."""
    _, names, rows = lines(text)
    return [dict(zip(names, cells(row))) for row in rows]


def by_column(path: str | Path, names: list[str], rows: list[str]) -> dict[str, np.ndarray | list[str]]:
    """Each column by its name: (n,) numbers, all at once where every cell is one, or else its n cells as text."""
    if (name := twice(names)) is not None:
        raise input_file.Unreadable(path, f"it has two columns {described(name)}")
    try:
        table = parsed(rows) if rows else np.zeros((0, len(names)))
        if table.shape[1] == len(names):
            return dict(zip(names, table.T))
    except ValueError:  # some cell is not a number, or some row is not whole
        pass
    split = [cells(row) for row in rows]
    uneven = next((k for k, row in enumerate(split) if len(row) != len(names)), None)
    if uneven is not None:
        count = f"it has {len(names)} names and a row of {len(split[uneven])}"
        raise input_file.Unreadable(path, f"{count}, {described(rows[uneven])}")
    return {name: list(found) for name, found in zip(names, zip(*split))}


def column(found: np.ndarray | list[str]) -> np.ndarray:
    """(n,) numbers, or words where any of the cells is one."""
    if isinstance(found, np.ndarray):
        return found
    try:
        return np.array([number(cell) for cell in found])
    except ValueError:
        return np.array(found)


def lenient(found: list[str]) -> np.ndarray:
    """(n,) numbers, NaN where a cell is not one."""
    values = np.full(len(found), np.nan)
    for k, cell in enumerate(found):
        with suppress(ValueError):
            values[k] = number(cell)
    return values


def number(cell: str) -> float:
    """NaN where the cell is empty; raises ValueError where it is a word."""
    return float(cell) if cell.strip() else float("nan")


def cells(line: str) -> list[str]:
    """The cells of a row."""
    return next(csv.reader([line])) if '"' in line else line.split(",")


def parsed(rows: list[str], indices: list[int] | None = None) -> np.ndarray:
    """(n, columns) the numbers of each row, of some columns or of all; raises ValueError."""
    return np.loadtxt(rows, delimiter=",", usecols=indices, comments=None, ndmin=2)


def unparsed(rows: list[str], indices: list[int]) -> int | None:
    """Number of the first row that has no numbers in these columns: the half that holds it, and again."""
    try:
        parsed(rows, indices)
    except ValueError:
        if len(rows) == 1:
            return 0
        half = len(rows) // 2
        first = unparsed(rows[:half], indices)
        return first if first is not None else half + (unparsed(rows[half:], indices) or 0)
    return None


def twice(names: list[str]) -> str | None:
    """The first name that occurs twice."""
    return next((name for k, name in enumerate(names) if name in names[:k]), None)


def described(text: str) -> str:
    """A piece of a file, cut short: for messages."""
    return repr(text if len(text) <= 40 else f"{text[:37]}...")
