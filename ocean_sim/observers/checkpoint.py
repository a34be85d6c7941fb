"""Checkpoints, from which `ocean-sim resume` continues a run: at intervals, at the end, and when the run is stopped."""

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
from ocean_sim.parts import PeriodicConfig
from ocean_sim.simulation import Observer, Simulation
from ocean_sim.state import checkpoint_file
from ocean_sim.state.fields import FieldContents
from ocean_sim.state.snapshot import Restorer, Snapshot

KEPT_FILES = 2  # the newest, and the one before in case the newest is damaged
STOP_SIGNALS = (signal.SIGINT, signal.SIGTERM)


class Config(PeriodicConfig):
    turn: ClassVar[int] = 5
    leaves: ClassVar[str] = "checkpoint_*.h5; a copy of all fields"
    every: float = quantity("s", 1.0, gt=0.0)
    """Simulated time between checkpoints."""
    wall_every: float | None = quantity("s", None, gt=0.0)
    """Wall-clock time between checkpoints, too; null: none."""


class Checkpoint(Observer, of=Config):
    """Writes checkpoint_<time>.h5 at intervals and when Ctrl-C or SIGTERM ends the run; keeps the newest two."""

    left_out = ("contents", "last_write", "stop_requested", "handlers")

    def __init__(self, config: Config, folder: Path, simulation: Simulation) -> None:
        self.config, self.folder, self.simulation = config, folder, simulation
        self.multiples = Multiples(config.every)
        self.names: list[str] = []  # of the files that are kept
        self.contents = FieldContents()
        self.last_write = perf_counter()  # wall time of the last file [s]
        self.stop_requested = False
        self.handlers: dict[int, Any] | None = None  # of signals, before this run

    def observe(self, simulation: Simulation) -> None:
        if self.handlers is None:
            main = threading.current_thread() is threading.main_thread()  # no other thread may install them
            self.handlers = {each: signal.signal(each, self.handle_signal) for each in STOP_SIGNALS} if main else {}
        due = bool(self.multiples.reached(simulation.time)) or simulation.time >= simulation.scene.duration
        late = self.config.wall_every is not None and perf_counter() - self.last_write >= self.config.wall_every
        if due or late or self.stop_requested:
            self.write_state()
        if self.stop_requested:
            raise KeyboardInterrupt

    def write_state(self) -> None:
        """Write a checkpoint of the present state, and delete all checkpoints but the newest KEPT_FILES."""
        simulation = self.simulation
        name = checkpoint_file.checkpoint_name(simulation.time)
        self.names = [*(kept for kept in self.names if kept != name), name][-KEPT_FILES:]
        taken = Snapshot(roots(simulation), self.folder, self.contents)
        made = versions() | {"backend": simulation.backend.arch, "sources": source_hashes()}
        moment = simulation.time, simulation.steps, simulation.scene.resolved()
        checkpoint = checkpoint_file.Checkpoint(*moment, made, taken.tree, taken.arrays)
        checkpoint_file.write_checkpoint(checkpoint, self.folder)
        for path in checkpoint_file.checkpoint_files(self.folder):
            if path.name not in self.names:
                path.unlink()
        self.last_write = perf_counter()

    def handle_signal(self, number: int, frame: FrameType | None) -> None:
        """Handler of STOP_SIGNALS: stop the run after the step on the first signal, at once on the second."""
        if self.stop_requested or self.simulation.outcome != "running":
            raise KeyboardInterrupt
        self.stop_requested = True

    def close(self) -> None:
        """Restore the signal handlers that were there before the run."""
        for number, handler in (self.handlers or {}).items():
            signal.signal(number, handler)


def roots(simulation: Simulation) -> dict[str, Any]:
    """Objects, by name, that hold all the state of a checkpoint: the simulation, and observers named in the scene."""
    named = simulation.scene.observers
    return {"simulation": simulation, "observers": dict(zip(named, simulation.observers[: len(named)]))}


def versions() -> dict[str, str | None]:
    """Installed versions of this program and its numerical packages, by name; None for a missing one."""
    return {name: installed_version(name) for name in ("ocean-sim", kernel_library.LIBRARY_NAME, "numpy", "scipy")}


def restore(simulation: Simulation, kept: checkpoint_file.Checkpoint, folder: Path, changed: str = "") -> None:
    """Set a newly built simulation to the state in `kept`, a checkpoint of the same scene, and cut the run's files in
    `folder` back to it. `changed`: how the program differs from the one that made the checkpoint, noted in all CSV
    files. Raises Mismatch; the folder is then unchanged, but the simulation cannot be used."""
    try:
        state = Restorer(roots(simulation), kept.tree, kept.arrays, folder)
        state.cut()
        for table in (table for table, _ in state.files if changed and table.name.endswith(".csv")):
            table.write(f"# from t = {simulation.time:.9g} s on by another program: {changed}\n")
        for _, observer in zip(simulation.scene.observers, simulation.observers):
            observer.resumed(changed)
    except BaseException:
        simulation.observers.clear()  # they may know the folder by now, and must not write to it
        raise
