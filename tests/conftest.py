"""Fixtures for all tests: a started runtime, shared by the tests of a module, and kernel caches kept across runs. And
a table of the slow tests, kept up by

    OCEAN_SIM_SLOW=docs/slow_tests.csv pytest -n 0 -m slow [PATH ...]

with a row for each that is collected (with --collect-only alone, too): seconds of all its parameters, outcome and day
of the last run, nothing where none is known.
"""

import csv
import gc
import os
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest

from ocean_sim import runtime
from ocean_sim.__main__ import answered
from ocean_sim.reading.scene import load
from ocean_sim.simulation import Simulation
from ocean_sim.state.snapshot import Restorer, Snapshot

TABLE, COLUMNS = os.environ.get("OCEAN_SIM_SLOW"), ("test", "seconds", "outcome", "day")
_slow: dict[str, list[pytest.TestReport]] = {}


def pytest_collection_finish(session: pytest.Session) -> None:
    gc.freeze()  # what is collected stays to the end, and need not be looked through for garbage
    gc.set_threshold(20_000)  # as the command line does
    _slow.update({item.nodeid.split("[")[0]: [] for item in session.items if item.get_closest_marker("slow")})


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    if (name := report.nodeid.split("[")[0]) in _slow:
        _slow[name].append(report)


def pytest_sessionfinish() -> None:
    if TABLE is None or not _slow or "PYTEST_XDIST_WORKER" in os.environ:
        return
    path = Path(TABLE)
    known = {row["test"]: row for row in csv.DictReader(path.open())} if path.exists() else {}
    for name, reports in _slow.items():
        row = known.setdefault(name, dict.fromkeys(COLUMNS, "") | {"test": name})
        if reports:
            called = {report.outcome for report in reports if report.when == "call" or report.failed}
            outcome = next((one for one in ("failed", "passed") if one in called), "skipped")
            seconds = f"{sum(r.duration for r in reports):.1f}"
            row |= {"seconds": seconds, "outcome": outcome, "day": f"{datetime.now(UTC):%Y-%m-%d}"}
    with path.open("w", newline="") as file:
        table = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        table.writeheader()
        table.writerows(known[name] for name in sorted(known))


def quickly(first: Any, *others: Any) -> list[Any]:
    """Parameters of a test: the first in every run, the others with -m slow."""
    return [first, *(pytest.param(other, marks=pytest.mark.slow) for other in others)]


@pytest.fixture(scope="module")
def coarse():
    """A yacht on some hundred particles under a gust, started once for all tests; they leave it as they found it."""
    overrides = {"runtime.threads": 1, "fluid.spacing": 2.5, "runtime.precision": "f64", "accuracy": None}
    with Simulation(load("showcase", overrides)) as simulation:
        simulation.run(0.2)
        yield simulation


@pytest.fixture
def ask(capsys):
    """Answer of a command line: exit code, standard output, standard error."""

    def asked(*words: object) -> tuple[int, str, str]:
        code = answered([str(word) for word in words])
        said = capsys.readouterr()
        assert "Traceback" not in said.out + said.err
        return code, said.out, said.err

    return asked


class Start:
    """What a fluid or a simulation holds now, to be put back as a checkpoint does it: its kernels stay compiled."""

    def __init__(self, root: Any) -> None:
        self.root, self.held = root, Snapshot(root, Path())

    def put_back(self) -> None:
        arrays = {name: values.copy() for name, values in self.held.arrays.items()}
        Restorer(self.root, self.held.tree, arrays, Path())


@pytest.fixture(scope="module", autouse=True)
def taichi_of_a_module() -> None:
    """Taichi starts anew for each module: it finds compiled kernels again by the numbers of their fields, which would
    else depend on what the process has tested before."""
    runtime._started = None


@pytest.fixture(scope="module")
def taichi_cpu() -> runtime.Backend:
    """Taichi on one thread in f64: bitwise repeatable, and exact enough for closed forms."""
    return runtime.start(runtime.RuntimeConfig(precision="f64", threads=1))
