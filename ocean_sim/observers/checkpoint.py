"""Keeps everything that a run needs to continue: at simulated and wall-clock intervals, at the end, and when it is
stopped; `ocean-sim resume` reads it."""

import signal
import threading
from pathlib import Path
from time import perf_counter
from types import FrameType
from typing import Any, ClassVar

from ocean_sim import kernel_library
from ocean_sim.machine import installed_version, source_hashes
from ocean_sim.model import quantity
from ocean_sim.observers.shared.csv_rows import Multiples
from ocean_sim.simulation import Observer, PeriodicConfig, Simulation
from ocean_sim.state import checkpoint_file
from ocean_sim.state.fields import FieldContents
from ocean_sim.state.snapshot import Restorer, Snapshot

KEPT = 2  # files: the newest, and the one before in case the newest is damaged
STOPS = (signal.SIGINT, signal.SIGTERM)


class Config(PeriodicConfig):
    turn: ClassVar[int] = 5
    leaves: ClassVar[str] = "checkpoint_*.h5; a copy of all fields"
    every: float = quantity("s", 1.0, gt=0.0)
    """Simulated time between checkpoints."""
    wall_every: float | None = quantity("s", None, gt=0.0)
    """Wall-clock time after which one is due, too; null: none."""

    def build(self, folder: Path, simulation: Simulation) -> "Checkpoint":
        return Checkpoint(self, folder, simulation)


class Checkpoint(Observer):
    """checkpoint_<time>.h5, the newest two. Ctrl-C and SIGTERM let the step end, keep its state, then stop the run; a
    second one stops it at once. It takes the last turn, when the other observers have finished with the step."""

    left_out = ("contents", "written", "asked", "before")

    def __init__(self, config: Config, folder: Path, simulation: Simulation) -> None:
        self.config, self.folder, self.simulation = config, folder, simulation
        self.multiples = Multiples(config.every)
        self.names: list[str] = []  # of the files that are kept
        self.contents = FieldContents()
        self.written = perf_counter()  # when the last one was [s]
        self.asked = False  # whether the run has been asked to stop
        self.before: dict[int, Any] | None = None  # the handlers of signals before

    def observe(self, simulation: Simulation) -> None:
        if self.before is None:
            self.listen()
        due = bool(self.multiples.reached(simulation.time)) or simulation.time >= simulation.scene.duration
        late = self.config.wall_every is not None and perf_counter() - self.written >= self.config.wall_every
        if due or late or self.asked:
            self.keep()
        if self.asked:
            raise KeyboardInterrupt

    def keep(self) -> None:
        """Write the state that the simulation is in, and delete all files but the newest."""
        simulation = self.simulation
        name = checkpoint_file.checkpoint_name(simulation.time)
        self.names = [*(kept for kept in self.names if kept != name), name][-KEPT:]
        taken = Snapshot(roots(simulation), self.folder, self.contents)
        made, scene = maker(simulation), simulation.scene.resolved()
        checkpoint_file.write_checkpoint(
            checkpoint_file.Checkpoint(simulation.time, simulation.steps, scene, made, taken.tree, taken.arrays),
            self.folder,
        )
        for path in checkpoint_file.checkpoint_files(self.folder):
            if path.name not in self.names:
                path.unlink()
        self.written = perf_counter()

    def listen(self) -> None:
        """From now on, handle the signals that stop a run."""
        self.before = {}
        if threading.current_thread() is threading.main_thread():
            self.before = {number: signal.signal(number, self.stop) for number in STOPS}

    def stop(self, number: int, frame: FrameType | None) -> None:
        """What a signal does."""
        if self.asked or self.simulation.outcome != "running":
            raise KeyboardInterrupt
        self.asked = True

    def close(self) -> None:
        for number, handler in (self.before or {}).items():
            signal.signal(number, handler)


def roots(simulation: Simulation) -> dict[str, Any]:
    """Where the walk over a run begins: observers that the scene does not name are no part of it."""
    named = simulation.scene.observers
    return {"simulation": simulation, "observers": dict(zip(named, simulation.observers[: len(named)]))}


def maker(simulation: Simulation) -> dict[str, Any]:
    """What the bytes of a run depend on apart from its scene."""
    return versions() | {"backend": simulation.backend.arch, "sources": source_hashes()}


def versions() -> dict[str, str | None]:
    """Versions of the packages that compute."""
    return {name: installed_version(name) for name in ("ocean-sim", kernel_library.LIBRARY_NAME, "numpy", "scipy")}


def restore(simulation: Simulation, kept: checkpoint_file.Checkpoint, folder: Path, changed: str = "") -> None:
    """Put a simulation that was built of the same scene into the state of a checkpoint, its files in `folder`.

    `changed`: how this program differs from the one that made it, which every table then states where it goes on.
    Raises Mismatch; then nothing in the folder has changed, and the simulation is of no use.
    """
    named = dict(zip(simulation.scene.observers, simulation.observers))
    try:
        state = Restorer(roots(simulation), kept.tree, kept.arrays, folder)
    except BaseException:
        simulation.observers.clear()  # they may know the folder by now, and must not write to it
        raise
    state.cut()
    if changed:
        for table in (table for table, _ in state.files if table.name.endswith(".csv")):
            table.write(f"# from t = {simulation.time:.9g} s on by another program: {changed}\n")
    for observer in named.values():
        observer.resumed(changed)
