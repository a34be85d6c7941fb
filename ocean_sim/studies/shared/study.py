"""Study: many runs, each of which gives lines of one table, kept as a CSV file."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ocean_sim.files import csv_file, input_file
from ocean_sim.result import Result
from ocean_sim.studies.shared import runs


@dataclass(frozen=True)
class Point:
    """One run of a study: its order (job description as plain data), for the process that executes it."""

    order: dict[str, Any]

    def rows(self, answer: dict[str, Any], run: Result) -> list[dict[str, Any]]:
        """Rows of the study's table from the answer of this run and its result folder, which may be empty; by default
        one, with the folder under the key `run`."""
        return [answer | {"run": run}]


@dataclass
class Study:
    """Runs (points) of a study, and the table rows of those that are done; each run has a folder below `folder`."""

    points: Sequence[Point]
    folder: Path
    workers: int
    table: Path | None = None  # a file that is whole after every run
    scheduler: str | None = None  # address of a Dask cluster elsewhere
    limit: float | None = None  # wall time [s] after which a run is ended
    found: dict[int, list[dict[str, Any]]] = field(default_factory=dict)  # rows by number of the point

    def run(self) -> Iterator[int]:
        """Run all points that have no answer yet; yield the number of finished points after each."""
        orders = [point.order for point in self.points]
        for k, answer in runs.run_answers(orders, self.folder, self.workers, self.scheduler, self.limit):
            self.found[k] = self.points[k].rows(answer, Result(self.folder / runs.run_address(orders[k])))
            if self.table is not None:
                write_table(self.table, self.rows)
            yield len(self.found)

    @property
    def rows(self) -> list[dict[str, Any]]:
        return [row for k in sorted(self.found) for row in self.found[k]]


def write_table(path: Path, rows: list[dict[str, Any]]) -> None:
    """Write rows as a CSV file with their keys as columns; None is left empty, lists, mappings, booleans are JSON."""
    columns = list(dict.fromkeys(key for row in rows for key in row))
    in_json = lambda value: json.dumps(value) if isinstance(value, dict | list | tuple | bool) else value
    csv_file.write_table(path, columns, ([in_json(row.get(name)) for name in columns] for row in rows))


def read_table(path: Path) -> list[dict[str, Any]]:
    """Rows of a CSV file that `write_table` has written; an empty cell is None."""
    return [
        {key: parse_cell(text) for key, text in row.items()}
        for row in csv_file.read_records(input_file.read_text(path))
    ]


def parse_cell(text: str) -> Any:
    """Value of a CSV cell: None if empty, else parsed as JSON, or the text itself if it is not JSON."""
    try:
        return json.loads(text) if text else None
    except ValueError:
        return text
