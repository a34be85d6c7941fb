"""The table of a study as a CSV file."""

import csv
import json
from pathlib import Path
from typing import Any

from ocean_sim.files import csv_file, input_file
from ocean_sim.files.whole_file import whole


def columns(rows: list[dict[str, Any]]) -> list[str]:
    """Every key of the rows, in the order in which they first stand."""
    return list(dict.fromkeys(key for row in rows for key in row))


def write(path: Path, rows: list[dict[str, Any]]) -> None:
    """All rows, in whole or not at all; what is absent is empty, what is neither a number nor a word is JSON."""
    with whole(path) as draft, draft.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, columns(rows), lineterminator="\n")
        writer.writeheader()
        writer.writerows({key: cell(value) for key, value in row.items()} for row in rows)


def read(path: Path) -> list[dict[str, Any]]:
    """The rows of such a file; what is empty is None."""
    return [{key: value(text) for key, text in row.items()} for row in csv_file.records(input_file.text(path))]


def value(text: str) -> Any:
    """What stands in a cell: a number, JSON or words."""
    try:
        return json.loads(text) if text else None
    except ValueError:
        return text


def cell(value: Any) -> Any:
    """A value as it stands in the file."""
    return json.dumps(value) if isinstance(value, dict | list | tuple | bool) else value
