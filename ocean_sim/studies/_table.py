"""The table of a study as a CSV file."""

import csv
import json
import os
from pathlib import Path
from typing import Any


def columns(rows: list[dict[str, Any]]) -> list[str]:
    """Every key of the rows, in the order in which they first stand."""
    return list(dict.fromkeys(key for row in rows for key in row))


def write(path: Path, rows: list[dict[str, Any]]) -> None:
    """All rows, in whole or not at all; what is absent is empty, what is no number or word is JSON."""
    beside = path.with_name(f".{path.name}.tmp")
    with beside.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, columns(rows), lineterminator="\n")
        writer.writeheader()
        writer.writerows({key: cell(value) for key, value in row.items()} for row in rows)
    os.replace(beside, path)


def cell(value: Any) -> Any:
    """A value as it stands in the file."""
    return json.dumps(value) if isinstance(value, dict | list | tuple | bool) else value
