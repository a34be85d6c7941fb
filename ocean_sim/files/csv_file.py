"""The parser of all CSV files, and atomic writing of tables.

Lines that begin with # are comments, some of them `key: value`; empty lines are skipped. The first line that is
left names the columns, and every further line is a row; a cell may stand in double quotes. An empty cell is NaN in a
column of numbers and '' in a column of words. Each reader states the content of its table:

- `read_columns`, of a table that a run wrote: a column in which any cell is a word is a column of words, all others are
  numbers. A last line that a killed run did not finish is skipped.
- `Table`, of a table that a person names, by the rules in CHECKS.
- `read_records`, every cell as text, row by row.
"""

import csv
import re
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ocean_sim.files import input_file
from ocean_sim.files.atomic_file import atomic_write
from ocean_sim.files.input_file import Checked, Rule

csv.field_size_limit(input_file.MAX_FILE_BYTES)  # a cell in quotes may be as long as a file

TIME_COLUMN = "time_s"
CELL_SEPARATORS = (";", "\t", ",", " ")  # of cells, as they are tried
DECIMAL_NUMBER = re.compile(r"[+-]?\d*([.,])\d+(?:[eE][+-]?\d+)?")

WHOLE_TABLE_RULE = Rule(
    "a table has a line with the names of its columns, each once, and under it rows with a cell for each name"
)
DIALECT_RULE = Rule(
    "cells are separated by commas, semicolons, tabs or spaces, and all numbers have a decimal point or all a decimal "
    "comma, which stands in quotes where commas separate cells"
)
NAMED_COLUMNS_RULE = Rule("columns are found by their exact names, units included, as heave_m")
FINITE_NUMBERS_RULE = Rule("a column that is used holds finite numbers; times are seconds or dates (ISO 8601)")
RISING_TIMES_RULE = Rule("times rise from row to row, each once")
TIMES_REACHED_RULE = Rule("times count from the beginning of the run, and reach into it")
DEGREES_RULE = Rule("columns that end in _deg are in degrees")

CHECKS = (
    Checked("Every table", (WHOLE_TABLE_RULE, DIALECT_RULE, NAMED_COLUMNS_RULE, FINITE_NUMBERS_RULE)),
    Checked("Every table over time", (RISING_TIMES_RULE,)),
    Checked("Every table that a scene names, by a warning", (TIMES_REACHED_RULE, DEGREES_RULE)),
)


class Lines(NamedTuple):
    """Parts of a CSV text: `head`, comments `key: value`; `heading`, the line of column names; `rows`, other lines."""

    head: dict[str, str]
    heading: str
    rows: list[str]


def split_lines(text: str) -> Lines:
    """Split a CSV text into comments, heading and rows; the heading is empty if the text has only comments."""
    comments = [line[1:].partition(":") for line in text.splitlines() if line.startswith("#")]
    heading, *rows = [line for _, line in lines_of_cells(text)] or [""]
    return Lines({key.strip(): value.strip() for key, _, value in comments}, heading, rows)


def lines_of_cells(text: str) -> list[tuple[int, str]]:
    """Heading and rows of a CSV text, each with the number of its line; neither blanks, comments nor a first `sep=`."""
    lines = [(n, line) for n, line in enumerate(text.splitlines(), 1) if line.strip() and line[0] != "#"]
    begins_with_sign = lines and lines[0][1].lower().startswith("sep=")  # as spreadsheets begin a file
    return lines[1:] if begins_with_sign else lines


def row_and_line(path: str | Path, k: int) -> str:
    """Text on row `k`, from 0, of a CSV file: its number, and that of its line in an editor."""
    return f"row {k + 1} (line {lines_of_cells(input_file.read_text(path))[k + 1][0]})"


class Table(dict[str, np.ndarray]):
    """Columns (n,) by name of a CSV file that a user named, float64, NaN if a cell is no number. Raises Unreadable, a
    ValueError, if the file breaks a rule in CHECKS or has no row."""

    __eq__ = object.__eq__  # a scene that keeps its table is compared by what is written, not by arrays
    __hash__ = object.__hash__  # type: ignore[assignment]

    def __init__(self, path: str | Path, renamed: dict[str, str] | None = None) -> None:
        """`renamed`: new names of columns, by their names in the file; Unreadable if one is not there."""
        self.path = path
        self.head, names, self.rows = split_lines(input_file.read_text(path))
        if not self.rows:
            raise WHOLE_TABLE_RULE.broken(path, "it has no rows under a heading")
        self.separator = find_separator(names, self.rows[0])
        self.comma = False  # as the decimal sign
        self.names = [" ".join(name.split()) for name in self.cells(names)]  # with plain spaces
        self.require(*(renamed or ()))
        self.names = [(renamed or {}).get(name, name) for name in self.names]
        if self.separator != "," or any('"' in row for row in self.rows):
            self.comma = self.has_decimal_commas()
        super().__init__(build_columns(path, self.names, self.rows, self.cells, numeric_column))

    def cells(self, row: str) -> list[str]:
        """Cells of `row`, a line of the file, as text; decimal commas become points."""
        if self.separator == " ":
            row = " ".join(row.split())
        found = [cell.strip() for cell in split_cells(row, self.separator)]
        return [cell.replace(",", ".") if self.comma and DECIMAL_NUMBER.fullmatch(cell) else cell for cell in found]

    def column(self, name: str) -> list[str]:
        """Cells of a column as text."""
        return [cells[self.names.index(name)] for cells in map(self.cells, self.rows)]

    def has_decimal_commas(self) -> bool:
        """True if numbers have a decimal comma, False if a point; raises Unreadable if a file mixes them."""
        found: dict[str, str] = {}
        for k, row in enumerate(self.rows):
            numbers = filter(None, map(DECIMAL_NUMBER.fullmatch, self.cells(row)))
            found = {number[1]: number[0] for number in numbers} | found
            if len(found) == 2:
                comma, point = map(quoted_piece, (found[","], found["."]))
                raise DIALECT_RULE.broken(self.path, f"it has {comma} and, up to {row_and_line(self.path, k)}, {point}")
        return "," in found

    def finite(self, *wanted: str, since: int = 0) -> list[np.ndarray]:
        """The `wanted` columns (n,); raises Unreadable if one is missing, or not finite from row `since` on."""
        self.require(*wanted)
        wrong = np.argwhere(~np.isfinite([self[name][since:] for name in wanted]).T)
        if len(wrong):
            row, name = since + int(wrong[0, 0]), wanted[wrong[0, 1]]
            cell = self.column(name)[row]
            found = quoted_piece(cell) if cell else "empty"
            raise FINITE_NUMBERS_RULE.broken(self.path, f"{name} is {found} in {row_and_line(self.path, row)}")
        return [self[name] for name in wanted]

    def require(self, *wanted: str) -> None:
        """Raise Unreadable, naming all that are missing, unless the table has these columns."""
        if missing := [name for name in wanted if name not in self.names]:
            there = quoted_piece(", ".join(self.names), 80)
            lacks = f"it has no column {' and no column '.join(missing)}"
            raise NAMED_COLUMNS_RULE.broken(self.path, f"{lacks}, but {there}")

    def replace_columns(self, columns: dict[str, np.ndarray]) -> None:
        """Replace all columns by `columns`, (n,) by name, and the lines of text by their numbers."""
        self.clear()
        self.update(columns)
        self.names, self.separator, self.comma = [*columns], ",", False
        self.rows = [",".join(f"{value:.12g}" for value in row) for row in zip(*columns.values())]

    def resolution(self, name: str) -> float:
        """Rounding step of the numbers in a column, in its unit, by the digits written and by double precision."""
        most = max(float(np.abs(self[name]).max()), 1e-300)
        written = [cell.strip("+-").lower().partition("e")[0] for cell in self.column(name)]
        decimals = max(len(cell.partition(".")[2]) for cell in written)
        digits = max(len(cell.replace(".", "").lstrip("0")) for cell in written)
        return float(max(10.0**-decimals, 10.0 ** (np.ceil(np.log10(most)) - digits), 4.0 * np.spacing(most)))

    def series(self, *wanted: str, fewest: int = 1) -> list[np.ndarray]:
        """Times (n,) [s] and `wanted` columns (n,); raises Unreadable unless finite, times rise and n >= `fewest`."""
        time, *found = self.finite(TIME_COLUMN, *wanted)
        if len(time) < fewest:
            raise WHOLE_TABLE_RULE.broken(self.path, f"it has {len(time)} of at least {fewest} rows")
        back = np.flatnonzero(np.diff(time) <= 0.0)
        if len(back):
            k, cells = int(back[0]), self.column(TIME_COLUMN)
            anew = ": did a clock start anew, as at midnight or at the end of a GPS week?" if time[k] > time[-1] else ""
            where = row_and_line(self.path, k + 1)
            raise RISING_TIMES_RULE.broken(self.path, f"{cells[k + 1]} follows {cells[k]} in {where}{anew}")
        return [time, *found]

    def like_radians(self) -> list[str]:
        """Warnings on columns named *_deg that may be radians: all within 2 pi, and not all whole numbers."""
        angles = {name: values for name, values in self.items() if name.endswith("_deg")}
        found = [name for name, each in angles.items() if np.abs(each).max() <= 2.0 * np.pi and (each % 1.0).any()]
        where = input_file.display_path(self.path)
        return [f"{where}: is {name} in radians? {DEGREES_RULE.sentence}" for name in found]


def unreached_times_warning(what: str, times: np.ndarray, duration: float, instead: str) -> list[str]:
    """Warning, in a list of one, if no time (n,) [s] of table `what` lies within a run of this duration [s]; else an
    empty list. `instead`: text on the effect, in which {} stands for the row used, `first` or `last`."""
    first, last = float(times[0]), float(times[-1])
    if last < 0.0:
        return [f"{what} ends at {last:.12g} s, before the run begins: {instead.format('last')}; {TIMES_REACHED_RULE}"]
    late = f"begins at {first:.12g} s, when the run of {duration:g} s is over"
    return [f"{what} {late}: {instead.format('first')}; {TIMES_REACHED_RULE}"] if first >= duration else []


def find_separator(names: str, row: str) -> str:
    """Separator that splits the heading `names` and the first `row` into equally many cells; else one in `names`."""
    bare = [re.sub(r'"[^"]*"', '""', line) for line in (names, row)]
    for each in CELL_SEPARATORS:
        counts = [len(line.split(each.strip(" ") or None)) for line in bare]
        if counts[0] == counts[1] > 1:
            return each
    return next((each for each in ";\t," if each in bare[0]), ",")


def read_columns(path: str | Path) -> dict[str, np.ndarray]:
    """Columns (n,) by name of a CSV file that a run wrote: float64, or text if a cell is a word. Raises Unreadable."""
    text = input_file.read_text(path)
    _, heading, rows = split_lines(text[: text.rfind("\n") + 1])
    names = [name.strip() for name in split_cells(heading)] if heading else []
    return build_columns(path, names, rows, split_cells, number_or_word_column)


def read_columns_if_any(path: Path) -> dict[str, np.ndarray]:
    """Columns (n,) by name of a run's time series; empty if the file is missing, unreadable, or lacks rows or times."""
    with suppress(ValueError):  # no line of names: killed at once
        found = read_columns(path) if path.exists() else {}
        return found if len(found.get(TIME_COLUMN, ())) else {}
    return {}


def read_records(text: str) -> list[dict[str, str]]:
    """Rows of a CSV text, each as a dict of cell texts by column name."""
    _, heading, rows = split_lines(text)
    return [dict(zip(map(str.strip, split_cells(heading)), split_cells(row))) for row in rows]


def write_table(path: Path, names: Iterable[str], rows: Iterable[Iterable[object]], **notes: str) -> None:
    """Write a CSV file atomically: `notes` as comment lines, column names, rows; None becomes an empty cell."""
    with atomic_write(path) as draft, draft.open("w", encoding="utf-8", newline="") as file:
        file.writelines(f"# {key}: {note}\n" for key, note in notes.items())
        csv.writer(file, lineterminator="\n").writerows([list(names), *rows])


def build_columns(
    path: str | Path, names: list[str], rows: list[str], cells_of: Callable, column_of: Callable
) -> dict[str, np.ndarray]:
    """Columns (n,) by name, from lines of text; fast if all cells are numbers. Else `cells_of(row)` splits a row into
    cells, and `column_of(name, cells)` converts a column. Raises Unreadable, with `path` in the message."""
    if names and not np.isnan([*map(parse_number, names)]).any():
        raise WHOLE_TABLE_RULE.broken(path, f"its first line is numbers, {quoted_piece(','.join(names))}, no names")
    if (name := first_duplicate(names)) is not None:
        raise WHOLE_TABLE_RULE.broken(path, f"it has two columns {quoted_piece(name)}")
    with suppress(ValueError):  # some cell is not a number, or some row is not whole
        table = np.loadtxt(rows, delimiter=",", comments=None, ndmin=2) if rows else np.zeros((0, len(names)))
        if table.shape[1] == len(names):
            return dict(zip(names, table.T))
    split = [cells_of(row) for row in rows]
    for k, row in enumerate(split):
        if len(row) != len(names):
            found = f"{row_and_line(path, k)} has {len(row)} cells under {len(names)} names, {quoted_piece(rows[k])}"
            found += ", the last one empty: is a separator at its end too many?" * (row[-1] == "")
            found += f": is {quoted_piece(names[0])} a line above the names, to delete?" * (len(names) == 1)
            raise (DIALECT_RULE if len(row) > len(names) else WHOLE_TABLE_RULE).broken(path, found)
    return {name: column_of(name, found) for name, found in zip(names, zip(*split))}


def number_or_word_column(_: str, found: Sequence[str]) -> np.ndarray:
    """Column (n,) of cells `found` as float64, NaN if empty, or as text if any is a word; for `build_columns`."""
    with suppress(ValueError):
        return np.array([float(cell.strip() or "nan") for cell in found])
    return np.array(found)


def numeric_column(name: str, found: Sequence[str]) -> np.ndarray:
    """Column `name` (n,) of cells `found` as float64, NaN if no number; dates of `time_s` become s since the first."""
    if name == TIME_COLUMN:
        times = np.array([parse_date(cell) if "T" in cell or ":" in cell else np.nan for cell in found])
        if 2 * np.isfinite(times).sum() > len(times):
            return np.round(times - times[np.isfinite(times)][0], 6)
    return np.array([parse_number(cell) for cell in found])


def parse_date(cell: str) -> float:
    """Time [s] of a date (ISO 8601), since 1970, or of a clock, as 09:12:03.2, since midnight; NaN if it is neither."""
    with suppress(ValueError):
        date = datetime.fromisoformat(f"1970-01-01T{cell}" if cell[2:3] == ":" == cell[5:6] else cell)
        return (date if date.tzinfo else date.replace(tzinfo=UTC)).timestamp()
    return float("nan")


def parse_number(cell: str) -> float:
    """The number in a cell, or NaN."""
    with suppress(ValueError):
        return float(cell)
    return float("nan")


def split_cells(line: str, separator: str = ",") -> list[str]:
    """Cells of a line as text; double quotes around a cell are removed."""
    return next(csv.reader([line], delimiter=separator)) if '"' in line else line.split(separator)


def first_duplicate(names: list[str]) -> str | None:
    return next((name for k, name in enumerate(names) if name in names[:k]), None)


def quoted_piece(text: str, most: int = 40) -> str:
    """Text in quotation marks for messages, cut to `most` characters."""
    return repr(text if len(text) <= most else f"{text[: most - 3]}...")
