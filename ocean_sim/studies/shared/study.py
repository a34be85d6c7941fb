"""A study: many runs, each in a process of its own, and a table with rows of each, kept as a CSV file.

Runs are executed on the cores of this machine or on the workers of a Dask cluster.

An order is plain data: a `task`, which is the name of a module with `answer(order, folder)`, and what that needs. Its
run has a folder named by the hash of the order and of the package, and leaves its answer there; an order that has an
answer is not run again. A process that dies leaves no answer: it is a failure with a reason, and the next call tries it
again. No process of a run outlives the worker that waits for it, however that ends.
"""

import hashlib
import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from threading import Event
from time import perf_counter
from typing import Any

from ocean_sim.conventions import Lacking, Refused
from ocean_sim.files import csv_file, input_file
from ocean_sim.files.atomic_file import write_facts
from ocean_sim.files.run_files import Claim
from ocean_sim.machine import exit_with_parent, installed_version, parent_pipe, program_hash, stoppable
from ocean_sim.parts import PACKAGE
from ocean_sim.result import Result

ORDER_FILE, ANSWER_FILE = "order.json", "answer.json"
ADDRESS_PATTERN = 16 * "[0-9a-f]"  # names of the folders of runs, as a pattern
MACHINE_KEY = "machine"  # what stands under this key of an order changes only timings in its answer
MAX_CONNECT_SECONDS = 20.0  # to reach a scheduler [s]

_running: set[subprocess.Popen] = set()
_over = Event()  # the caller has stopped: start nothing


def run_address(order: dict[str, Any]) -> str:
    """Folder name of an order (job description): hash of its content, except MACHINE_KEY, and of the package."""
    content = {key: value for key, value in order.items() if key != MACHINE_KEY}
    text = json.dumps([installed_version("ocean-sim") or "", program_hash(), content], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def run_answers(
    orders: list[dict[str, Any]], out: Path, workers: int, scheduler: str | None = None, limit: float | None = None
) -> Iterator[tuple[int, dict[str, Any]]]:
    """Yield (index in the list, answer) of each order (job description), as soon as its run has given an answer (dict
    of results). Answers of earlier calls, kept in the folder `out`, come first.

    `scheduler`: address of a Dask cluster; without one, `workers` processes of this machine. `limit`: wall time [s]
    after which a run is ended and fails. Equal orders are run once. Raises Lacking."""
    indices: dict[str, list[int]] = {}
    for k, order in enumerate(orders):
        indices.setdefault(run_address(order), []).append(k)
    waiting = {}
    for name, same in indices.items():
        kept = input_file.read_json_object(out / name / ANSWER_FILE)
        if not kept:
            waiting[name] = orders[same[0]]
        else:
            yield from ((k, kept) for k in same)
    if not waiting:
        return
    _over.clear()
    with _make_executor(workers, scheduler) as pool:
        paths = {name: str((out / name).resolve()) for name in waiting}
        futures = {pool.submit(perform_run, order, paths[name], limit): name for name, order in waiting.items()}
        try:
            for future in as_completed(futures):
                error = future.exception()
                answer = future.result() if error is None else failure_row(f"{type(error).__name__}: {error}")
                yield from ((k, answer) for k in indices[futures[future]])
        finally:  # the caller may have stopped iterating
            _over.set()
            for future in futures:
                future.cancel()
            for child in list(_running):
                child.terminate()


def perform_run(order: dict[str, Any], folder: str, limit: float | None = None) -> dict[str, Any]:
    """Carry out an order (job description), or find its answer (dict of results) in its folder; the child process that
    runs it may take `limit` [s] of wall time."""
    run = Path(folder)
    kept = input_file.read_json_object(run / ANSWER_FILE)
    if kept:
        return kept
    if _over.is_set():
        return failure_row("the study was stopped before")
    run.mkdir(parents=True, exist_ok=True)
    write_facts(run / ORDER_FILE, order)
    began = perf_counter()
    path = os.pathsep.join([str(PACKAGE.parent), *filter(None, [os.environ.get("PYTHONPATH")])])
    with parent_pipe() as theirs:
        child = subprocess.Popen(
            [sys.executable, "-m", __name__, folder],
            env=os.environ | {"PYTHONPATH": path},  # the package that the parent has
            stdin=theirs,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        _running.add(child)
        try:
            _, errors = child.communicate(timeout=limit)
            reason = _death_reason(child.returncode, errors)
        except subprocess.TimeoutExpired:
            child.kill()
            child.communicate()
            reason = f"it was ended at its limit of {limit:g} s of wall time"
        finally:
            _running.discard(child)
    return input_file.read_json_object(run / ANSWER_FILE) or failure_row(reason, perf_counter() - began)


def failure_row(reason: str, wall: float | None = None) -> dict[str, Any]:
    """Answer (dict of results) for a run that gave none: the outcome `failed`, the reason, and wall time [s]."""
    return {"outcome": "failed", "reason": reason, "wall_s": wall}


@contextmanager
def _make_executor(workers: int, scheduler: str | None) -> Iterator[Executor]:
    """Context manager of an executor of jobs: `workers` threads that wait for child processes, or Dask `scheduler`."""
    if scheduler is None:
        with ThreadPoolExecutor(workers) as pool:
            yield pool
        return
    try:
        from distributed import Client
    except ImportError:
        raise Lacking("--scheduler needs the package `distributed`: pip install distributed") from None
    try:
        client = Client(scheduler, timeout=MAX_CONNECT_SECONDS)
    except (OSError, ValueError) as error:
        raise Lacking(f"no Dask scheduler answers at {scheduler}: {error}") from None
    with client:
        yield client.get_executor(pure=False)


def _death_reason(code: int, errors: str) -> str:
    """Reason why a process gave no answer, from its exit code and standard error."""
    if code < 0:
        hint = ", as happens where memory runs out" if -code == signal.SIGKILL else ""
        return f"its process was ended by {signal.Signals(-code).name}{hint}"
    lines = [line for line in errors.splitlines() if line.strip()]
    return lines[-1].strip() if lines else f"its process left with exit code {code}"


def _run_child(folder: Path) -> None:
    """Run the order (job description) in a folder, in this child process; write its answer, or a refusal to stderr."""
    exit_with_parent()
    with stoppable(), Claim(folder):
        order = input_file.read_json(folder / ORDER_FILE)
        try:
            write_facts(folder / ANSWER_FILE, import_module(order["task"]).answer(order, folder))
        except Refused as why:
            sys.exit(str(why))


@dataclass(frozen=True)
class Point:
    """One run of a study; `order` describes it as plain data for the process that carries it out."""

    order: dict[str, Any]

    def rows(self, answer: dict[str, Any], run: Result) -> list[dict[str, Any]]:
        """Rows in the study's table for this run, from its `answer` (dict of results) and its folder, which may be
        empty; by default one row, with the folder under the key `run`."""
        return [answer | {"run": run}]


@dataclass
class Study:
    """Runs (points) of a study and the table rows of finished ones; each run has a subfolder of `folder`."""

    points: Sequence[Point]
    folder: Path
    workers: int
    table: Path | None = None  # a file that is whole after every run
    scheduler: str | None = None  # address of a Dask cluster elsewhere
    limit: float | None = None  # wall time [s] after which a run is ended
    found: dict[int, list[dict[str, Any]]] = field(default_factory=dict)  # rows by number of the point

    def run(self) -> Iterator[int]:
        """Carry out all points that have no answer yet; yield the number of finished points after each."""
        orders = [point.order for point in self.points]
        for k, answer in run_answers(orders, self.folder, self.workers, self.scheduler, self.limit):
            self.found[k] = self.points[k].rows(answer, Result(self.folder / run_address(orders[k])))
            if self.table is not None:
                write_table(self.table, self.rows)
            yield len(self.found)

    @property
    def rows(self) -> list[dict[str, Any]]:
        return [row for k in sorted(self.found) for row in self.found[k]]


def write_table(path: Path, rows: list[dict[str, Any]]) -> None:
    """Write rows as a CSV file, a column per key. None is an empty cell; lists, dicts and booleans are JSON."""
    columns = list(dict.fromkeys(key for row in rows for key in row))
    in_json = lambda value: json.dumps(value) if isinstance(value, dict | list | tuple | bool) else value
    csv_file.write_table(path, columns, ([in_json(row.get(name)) for name in columns] for row in rows))


def read_table(path: Path) -> list[dict[str, Any]]:
    """Rows of a CSV file that `write_table` has written; an empty cell is None."""
    rows = csv_file.read_records(input_file.read_text(path))
    return [{key: parse_cell(text) for key, text in row.items()} for row in rows]


def parse_cell(text: str) -> Any:
    """Value of a CSV cell: None if empty, else parsed as JSON, or the text itself if it is not JSON."""
    try:
        return json.loads(text) if text else None
    except ValueError:
        return text


if __name__ == "__main__":
    _run_child(Path(sys.argv[1]))
