"""Time of a program of others under the Python of another environment, where nothing of ours is installed.

This file is also the program that runs there: it hands a peer's `main` the order, and a `Watch` that takes the time.
"""

import json
import os
import runpy
import subprocess
import sys
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from time import perf_counter, process_time
from typing import Any, NoReturn, Protocol

MAX_RUN_SECONDS, MAX_IMPORT_SECONDS = 300.0, 60.0  # wall time of a dam break, and of an import [s]


class Peer(Protocol):
    """Interface of a module that runs a dam break in another program by `main(order, watch)`; imports nothing of
    ours."""

    PEER: str
    """Its name."""
    PACKAGE: str
    """Package that is imported."""
    INSTALLED: str
    """Requirements that pip installs for it."""
    ENVIRONMENT: dict[str, str]
    """Variables without which it does not run."""
    __file__: str | None


def measure_peer(peer: Peer, python: Path, order: dict[str, Any]) -> dict[str, Any]:
    """Measure a dam break of a peer under a Python. Return `particles`, `walls` (particles of which walls consist),
    `steps`, `wall` and `cpu` time (of all threads) and `simulated` time [s].

    `order`, the requested run: `method`; `lattice`, particles along x, y, z; `spacing` [m]; `support` [spacings], for a
    peer that has a choice; `begin`, simulated time at which measuring begins [s]; `seconds` of wall time and simulated
    time `end` [s], both to be reached; `viscosity` [m2/s]; `threads`; `folder` for its files. Raises OSError or
    ValueError if it cannot run there.
    """
    return run_under(peer, python, [str(peer.__file__), json.dumps(order)], order["threads"], MAX_RUN_SECONDS)


def version_in(peer: Peer, python: Path) -> str | None:
    """Version of a peer that a Python has and can import, or None; raises OSError or ValueError."""
    return run_under(peer, python, [peer.PACKAGE], 1, MAX_IMPORT_SECONDS)


def run_under(peer: Peer, python: Path, arguments: list[str], threads: int, patience: float) -> Any:
    """Run this file under another Python, threads bound to cores as ours are, and return the JSON value that it prints;
    raises ValueError. `patience`: time limit [s]."""
    environment = os.environ | peer.ENVIRONMENT
    environment |= {"OMP_NUM_THREADS": str(threads), "OMP_WAIT_POLICY": "passive", "OMP_PROC_BIND": "true"}
    command = [str(python), "-I", __file__, *arguments]
    try:
        done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=patience, check=False)
    except subprocess.TimeoutExpired:
        raise ValueError(f"it was not done after {patience:g} s") from None
    if done.returncode or not done.stdout.strip():
        raise ValueError((done.stderr.strip().splitlines() or [f"it ended with {done.returncode}"])[-1])
    return json.loads(done.stdout.splitlines()[-1])


class Watch:
    """Timer of a run, which calls `look` between steps; prints the measurement and ends the process after enough
    time."""

    def __init__(self, order: dict[str, Any]) -> None:
        self.order = order
        self.began: dict[str, float] = {}
        self.steps = 0
        self.answer = os.dup(1)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # for programs print as they go

    def look(self, time: float, particles: int, walls: int) -> None:
        """Count a step that ended at a simulated time [s]; ends the process once the run is long enough."""
        now = {"wall": perf_counter(), "cpu": process_time(), "simulated": time}
        if not self.began:
            if time >= self.order["begin"]:
                self.began = now
            return
        self.steps += 1
        spent = {name: now[name] - self.began[name] for name in now}
        if spent["wall"] >= self.order["seconds"] and time >= self.order["end"]:
            found = {"particles": particles, "walls": walls, "steps": self.steps, **spent}
            os.write(self.answer, json.dumps(found).encode())
            os._exit(0)


def run_peer(file: str, order: str) -> NoReturn:
    """Run a peer's dam break, the script `file`, in this process, which the watch ends; `order`: as JSON."""
    told = json.loads(order)
    runpy.run_path(file)["main"](told, Watch(told))
    sys.exit("its run ended before it was measured")


def installed(package: str) -> str | None:
    """Version of an installed package, after importing it, or None."""
    try:
        found = version(package)
    except PackageNotFoundError:
        return None
    import_module(package)
    return found


if __name__ == "__main__":
    if len(sys.argv) > 2:
        run_peer(*sys.argv[1:])
    print(json.dumps(installed(sys.argv[1])))
