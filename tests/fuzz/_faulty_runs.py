"""Runs in forked children, in each of which the nth write, fsync or rename goes wrong, in the style of SQLite's tests.
Started by test_faults.py with the shim of _faults.c loaded, as FOLDER MODE STRIDE; prints a JSON report."""

import ctypes
import json
import os
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

from _small_sea import SMALL_SEA

COUNT, FAIL, FULL, KILL = range(4)
SCENE = SMALL_SEA | {
    "duration": 0.12,
    "gauges": SMALL_SEA["gauges"] | {"every": 0.04},
    "checkpoint": {"every": 0.04},
    "frames": {"every": 0.06},
    "accuracy": {"every": 0.06},
    "time_step": {"kind": "fixed", "dt": 0.02},
    "timings": None,
}
OWN = ("manifest.json", "report.html")  # which say when it was stopped


def child(what) -> int:
    """The exit code of a function in a forked child, or minus the signal that ended it."""
    process = os.fork()
    if process == 0:
        sink = os.open(os.devnull, os.O_WRONLY)
        os.dup2(sink, 1)
        os.dup2(sink, 2)
        code = 70
        try:
            code = what()
        finally:
            os._exit(code)
    return os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])


def contents(folder: Path) -> dict[str, bytes]:
    files = [path for path in folder.rglob("*") if path.is_file() and path.suffix != ".h5" and path.name not in OWN]
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def main(folder: Path, mode: int, stride: int) -> None:
    import ocean_sim.observers.checkpoint
    import ocean_sim.verbs.resume
    import ocean_sim.verbs.run  # noqa: F401  what a run imports, once for all children
    from ocean_sim.__main__ import run_command_line
    from ocean_sim.state import checkpoint_file

    shim = ctypes.CDLL(None)
    scene, run, before = folder / "scene.yaml", folder / "run", folder / "before"
    scene.write_text(json.dumps(SCENE))

    def simulate(how: int, nth: int, out: Path, *more: str) -> int:
        shim.arm(str(run).encode(), how, nth)
        code = run_command_line(["run", str(scene), "--out", str(out), *more])
        if how == COUNT:
            (folder / "calls").write_text(str(shim.calls()))
        return code

    assert child(lambda: simulate(COUNT, mode, run)) == 0
    calls, whole = int((folder / "calls").read_text()), contents(run)
    shutil.move(run, before)
    report = {"calls": calls, "struck": 0, "told": 0, "resumed": 0, "begun again": 0}

    def judge(nth: int) -> Iterator[str]:
        """What is wrong after the nth call has gone wrong."""
        shutil.rmtree(run, ignore_errors=True)
        code = child(lambda: simulate(mode, nth, run))
        report["struck"] += code != 0
        manifest = json.loads((run / "manifest.json").read_text()) if (run / "manifest.json").exists() else None
        if code == 0:
            if contents(run) != whole:
                yield "it left with 0, and other bytes"
            return
        if mode == KILL and code != -9:
            yield f"exit code {code} in place of a killing"
        if mode != KILL and code != 1:
            yield f"exit code {code}"
        if mode != KILL and manifest is not None:
            told = manifest["outcome"] == "failed" and str(run) in manifest["reason"]
            report["told"] += told
            if manifest["outcome"] == "done" and (mode == FAIL or contents(run) != whole):
                yield "its manifest says done"  # on a disk that stays full it may, where the report alone is missing
        for path in run.glob("checkpoint_*.h5"):
            try:
                checkpoint_file.read_checkpoint(path)
            except checkpoint_file.UnreadableCheckpoint as error:
                yield f"{path.name}: {error}"
        if any(contents(before)[name] != data for name, data in whole.items()):
            yield "an earlier run is no longer what it was"
        again = child(lambda: run_command_line(["resume", str(run)])) if manifest is not None else 2
        report["resumed"] += again == 0
        if again == 2:
            report["begun again"] += 1
            again = child(lambda: simulate(COUNT, 0, run, "--overwrite"))
        if again != 0:
            yield f"resume left with {again}"
        elif contents(run) != whole:
            differ = [name for name in {*whole, *contents(run)} if contents(run).get(name) != whole.get(name)]
            yield f"after resume {differ} differ"

    wrong = [f"{nth} of {calls}: {sentence}" for nth in range(1, calls + 1, stride) for sentence in judge(nth)]
    print(json.dumps(report | {"wrong": wrong}))


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]))
