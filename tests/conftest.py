"""Fixtures for all tests: a started runtime, shared by the tests of a module, and kernel caches kept across runs. And
two tables. That of the slow tests is kept up by

    OCEAN_SIM_SLOW=docs/slow_tests.csv pytest -n 0 -m slow [PATH ...]

with a row for each that is collected (with --collect-only alone, too): seconds of all its parameters, outcome and day
of the last run, nothing where none is known. That of modules is kept up, with an empty cache of kernels, by

    OCEAN_SIM_COSTS=docs/test_costs.csv ./sandbox test --all

with the processor time that each took. By it tests are in the gate or `long`: those of modules above GATE_SECONDS are,
but for tests with the mark `anchor`.
"""

import csv
import gc
import os
import resource
import signal
from collections import defaultdict
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest

from ocean_sim import runtime
from ocean_sim.__main__ import run_command_line
from ocean_sim.kernel_library import ti
from ocean_sim.pictures.live import vulkan
from ocean_sim.reading.scene import load
from ocean_sim.simulation import Simulation
from ocean_sim.state.snapshot import Restorer, Snapshot

TABLE, COLUMNS = os.environ.get("OCEAN_SIM_SLOW"), ("test", "seconds", "outcome", "day")
_slow: dict[str, list[pytest.TestReport]] = {}


COST_TABLE = Path(__file__).parent.parent / "docs" / "test_costs.csv"
RECORDED_COSTS = os.environ.get("OCEAN_SIM_COSTS")
BEGAN = pytest.StashKey[float]()
GATE_SECONDS = 10.0  # of processor time that a module of the gate may take with an empty cache
_costs: dict[str, float] = defaultdict(float)

os.environ.setdefault(runtime.OPTIMISE_VARIABLE, "0")  # kernels compile sooner; `./sandbox test --all` sets "1"

# A shell that starts tests in the background, or `nohup`, has them and their children ignore these signals.
for _signal, _usual in ((signal.SIGINT, signal.default_int_handler), (signal.SIGHUP, signal.SIG_DFL)):
    if signal.getsignal(_signal) is signal.SIG_IGN:
        signal.signal(_signal, _usual)


def module_costs() -> dict[str, float]:
    """Processor time of each test module with an empty cache of kernels [s]."""
    if not COST_TABLE.exists():
        return {}
    with COST_TABLE.open() as file:
        return {row["module"]: float(row["processor_s"]) for row in csv.DictReader(file)}


def processor_seconds() -> float:
    """Processor time of this process and of its children that have ended [s]."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the tests of expensive modules `long`, before pytest selects by marks."""
    costs = module_costs()
    for item in items:
        if costs.get(item.nodeid.split("::")[0], 0.0) > GATE_SECONDS and not item.get_closest_marker("anchor"):
            item.add_marker("long")


def pytest_collection_finish(session: pytest.Session) -> None:
    gc.freeze()  # what is collected stays to the end, and need not be looked through for garbage
    gc.set_threshold(20_000)  # as the command line does
    _slow.update({item.nodeid.split("[")[0]: [] for item in session.items if item.get_closest_marker("slow")})


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    item.stash[BEGAN] = processor_seconds()
    return (yield)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Iterator[None]:
    report = yield
    if call.when == "teardown":
        report.user_properties.append(("processor_s", processor_seconds() - item.stash[BEGAN]))
    return report


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    if (name := report.nodeid.split("[")[0]) in _slow:
        _slow[name].append(report)
    _costs[report.nodeid.split("::")[0]] += dict(report.user_properties).get("processor_s", 0.0)


def pytest_sessionfinish() -> None:
    if runtime._started is not None:
        ti.reset()  # writes what this process has compiled to the cache; its end alone does not
    if "PYTEST_XDIST_WORKER" in os.environ:
        return
    if TABLE is not None and _slow:
        _write_slow_table(Path(TABLE))
    if RECORDED_COSTS is not None:
        rows = [(module, f"{seconds:.1f}") for module, seconds in sorted(_costs.items())]
        with Path(RECORDED_COSTS).open("w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([("module", "processor_s"), *rows])


def _write_slow_table(path: Path) -> None:
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
        code = run_command_line([str(word) for word in words])
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


@pytest.fixture(scope="session")
def vulkan_there():
    """Skips where there is no Vulkan; a process is started to see, so only where a test asks."""
    if not vulkan.draws(show=False):
        pytest.skip("no Vulkan on this machine")


@pytest.fixture(scope="module", autouse=True)
def taichi_of_a_module(request: pytest.FixtureRequest) -> Iterator[None]:
    """Taichi starts anew for each module: it finds compiled kernels again by the numbers of their fields, which would
    else depend on what the process has tested before. Modules with the mark `optimised` compile as users do."""
    runtime._started = None
    with pytest.MonkeyPatch.context() as patch:
        if request.node.get_closest_marker("optimised"):
            patch.setenv(runtime.OPTIMISE_VARIABLE, "1")
        yield


@pytest.fixture(scope="module")
def taichi_as_released() -> Iterator[None]:
    """Kernels read by Taichi itself, without replacements inside it; for modules that compare with closed forms."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("OCEAN_SIM_QUICK_START", "0")
        yield


@pytest.fixture(scope="module")
def taichi_cpu() -> runtime.Backend:
    """Taichi on one thread in f64: bitwise repeatable, and exact enough for closed forms."""
    return runtime.start(runtime.RuntimeConfig(precision="f64", threads=1))
