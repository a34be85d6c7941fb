"""Every end of a run has an outcome: in its manifest, as its last event and in its report, and the files stay whole."""

import json
import os
import resource
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest

from ocean_sim.__main__ import run_command_line
from ocean_sim.reading.scene import load
from ocean_sim.result import Result
from ocean_sim.result import run as run_scene
from ocean_sim.simulation import Simulation
from tests.fuzz._small_sea import SMALL_SEA
from tests.processes import wait_for_end

SEA = SMALL_SEA | {"duration": 0.2, "frames": None}


class Fails:
    """An observer that fails once, while it watches or when it is closed."""

    every = 0.0

    def __init__(self, failure: BaseException, closing: bool = False) -> None:
        self.failure, self.closing = failure, closing

    def observe(self, simulation) -> None:
        if simulation.steps == 3 and not self.closing:
            raise self.failure

    def close(self) -> None:
        if self.closing:
            raise self.failure


def ends(folder: Path) -> tuple[str, str]:
    """Outcome and reason of a run, which manifest, events and report agree on."""
    manifest, last = json.loads((folder / "manifest.json").read_text()), Result(folder).events[-1]
    assert (last["event"], last.get("reason", "")) == (manifest["outcome"], manifest["reason"])
    assert f"{manifest['outcome']} at t = " in (folder / "report.html").read_text()
    assert not [path.name for path in folder.rglob(".*")]
    return manifest["outcome"], manifest["reason"]


@pytest.mark.parametrize("closing", [False, True])
@pytest.mark.parametrize(
    "failure, reason",
    [
        (ZeroDivisionError("division by zero"), "ZeroDivisionError: division by zero"),
        (OSError(28, "No space left on device", "gauges.csv"), "No space left on device: gauges.csv"),
        (MemoryError(), "out of memory"),
    ],
)
def test_whatever_fails_is_the_outcome(tmp_path, failure, reason, closing):
    with pytest.raises(type(failure)):
        run_scene(load(SEA), tmp_path / "run", (Fails(failure, closing),))
    outcome, said = ends(tmp_path / "run")
    assert outcome == "failed" and reason in said


def test_a_part_that_cannot_be_built_is_the_outcome(tmp_path, monkeypatch):
    """An observer that takes its turn after the manifest has said that the run is going on."""
    scene = load(SEA | {"checkpoint": {"every": 0.1}})
    failure = OSError(30, "Read-only file system", "somewhere")
    monkeypatch.setattr(type(scene.observers["checkpoint"]), "build", lambda *_: (_ for _ in ()).throw(failure))
    with pytest.raises(OSError, match="Read-only"):
        run_scene(scene, tmp_path / "run")
    assert ends(tmp_path / "run") == ("failed", "Read-only file system: somewhere")


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGXCPU])
def test_a_signal_is_an_outcome_without_checkpoints_too(number, tmp_path):
    before = signal.getsignal(number)

    class Killer(Fails):
        def observe(self, simulation) -> None:
            if simulation.steps == 3:
                signal.raise_signal(number)

    with pytest.raises(KeyboardInterrupt):
        run_scene(load(SEA), tmp_path / "run", (Killer(KeyboardInterrupt()),))
    assert ends(tmp_path / "run") == ("stopped", "interrupted") and signal.getsignal(number) is before


def test_a_run_under_nohup_outlives_its_terminal(tmp_path):
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:

        class Closes(Fails):
            def observe(self, simulation) -> None:
                signal.raise_signal(signal.SIGHUP)

        run_scene(load(SEA), tmp_path / "run", (Closes(None),))
        assert ends(tmp_path / "run")[0] == "done" and signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGHUP, before)


def test_a_file_that_may_grow_no_more_is_named(tmp_path, capsys):
    """The limit of a file's size stands for a full disk where nobody may mount one."""
    (tmp_path / "sea.yaml").write_text(json.dumps(SEA | {"duration": 40.0, "gauges": SEA["gauges"] | {"every": 0.002}}))
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (120_000, limits[1]))
    try:
        code = run_command_line(["run", str(tmp_path / "sea.yaml"), "--out", str(tmp_path / "run")])
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    said = f"File too large: {tmp_path / 'run' / 'gauges.csv'}"
    assert code == 1 and capsys.readouterr().err == f"{said}\n"
    assert ends(tmp_path / "run") == ("failed", said)


@pytest.fixture
def small_disk(tmp_path):
    """A disk of its own with 2 MB."""
    disk = tmp_path / "disk"
    disk.mkdir()
    words = ["mount", "-t", "tmpfs", "-o", "size=2m", "tmpfs", str(disk)]
    if os.getuid() != 0 or subprocess.run(words, capture_output=True, check=False).returncode:
        pytest.skip("only root may mount a disk")
    yield disk
    subprocess.run(["umount", "-l", str(disk)], check=True)


def test_a_disk_that_runs_full_is_told_on_that_disk(small_disk, capsys):
    """A real one, to its last byte: room for the last words was set aside, and every row but the last is whole."""
    often = {"duration": 400.0, "gauges": SEA["gauges"] | {"every": 0.002}}
    (small_disk / "sea.yaml").write_text(json.dumps(SEA | often))
    code = run_command_line(["run", str(small_disk / "sea.yaml"), "--out", str(small_disk / "run")])
    err = capsys.readouterr().err
    assert code == 1 and err.startswith("No space left on device: ") and err.count("\n") == 1
    outcome, reason = ends(small_disk / "run")
    assert outcome == "failed" and reason == err.strip() and Path(reason.partition(": ")[2]).is_file()
    gauges = Result(small_disk / "run").gauges
    assert len(gauges["here_m"]) == len(gauges["time_s"]) > 1000


def test_no_child_outlives_a_killed_parent(tmp_path):
    """As the child that draws: its standard input is a pipe of its parent."""
    child = "import time; from ocean_sim.machine import exit_with_parent; exit_with_parent(); print(); time.sleep(60)"
    parent = f"""import subprocess, sys, time
from ocean_sim.machine import parent_pipe
with parent_pipe() as theirs:
    child = subprocess.Popen([sys.executable, "-c", {child!r}], stdin=theirs, stdout=subprocess.PIPE)
    child.stdout.readline()
    print(child.pid, flush=True)
    time.sleep(60)
"""
    with subprocess.Popen([sys.executable, "-c", parent], stdout=subprocess.PIPE, text=True) as begun:
        drawing = int(begun.stdout.readline())
        begun.kill()
    wait_for_end(drawing)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="puts processes on one core")
def test_a_session_that_yields_leaves_a_busy_core_to_another():
    """Of two on one core, it has less than half the processor time of the other; two that do not yield share it."""
    busy = """import os, sys, time
from ocean_sim.machine import yield_to_others
os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
if sys.argv[1] != "0":
    yield_to_others(int(sys.argv[1]))
print(flush=True)
sys.stdin.readline()
begun, end = time.process_time(), time.monotonic() + 2.0
while time.monotonic() < end:
    pass
print(time.process_time() - begun)
"""
    took = {}
    for by in (10, 0):
        how = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True, "start_new_session": True}
        both = [subprocess.Popen([sys.executable, "-c", busy, str(n)], **how) for n in (0, by)]
        for child in both:
            child.stdout.readline()
        for child in both:
            child.stdin.write("\n")
            child.stdin.flush()
        took[by] = [float(child.communicate()[0]) for child in both]
    assert took[10][1] < 0.5 * took[10][0] and took[0][1] > 0.5 * took[0][0]


def test_an_interrupt_that_is_lost_while_kernels_are_read_ends_the_run_before_its_first_step(tmp_path, monkeypatch):
    class Deaf(Simulation):
        def build(self, *of) -> None:
            with suppress(KeyboardInterrupt):
                signal.raise_signal(signal.SIGINT)
            super().build(*of)

    before = signal.getsignal(signal.SIGINT)
    monkeypatch.setattr("ocean_sim.result.Simulation", Deaf)
    with pytest.raises(KeyboardInterrupt):
        run_scene(load(SEA), tmp_path / "run")
    assert ends(tmp_path / "run") == ("stopped", "interrupted") and signal.getsignal(signal.SIGINT) is before
    monkeypatch.undo()
    run_scene(load(SEA), tmp_path / "next")
    assert ends(tmp_path / "next")[0] == "done"


def test_ctrl_c_while_the_program_is_read_is_a_word_and_exit_code_1():
    """At the first of its imports that takes long, NumPy's."""
    program = """import runpy, sys
class Interrupts:
    def find_spec(self, name, *_):
        if name == "numpy":
            raise KeyboardInterrupt
sys.meta_path.insert(0, Interrupts())
runpy.run_module("ocean_sim", run_name="__main__", alter_sys=True)"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (1, "", "stopped\n")
