"""Run a scene into a folder, and read the files of a run on demand."""

import json
import sys
from collections.abc import Iterable
from functools import cached_property
from os import PathLike
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from ocean_sim.conventions import Refused, Unsuited, figures
from ocean_sim.files import csv_file, input_file, run_files
from ocean_sim.files.atomic_file import reserve_disk_space
from ocean_sim.files.run_files import MANIFEST_FILE, Claim, claim_folder
from ocean_sim.machine import stop_if_asked, stoppable
from ocean_sim.reading.scene import SceneConfig, load
from ocean_sim.simulation import Observer, Simulation
from ocean_sim.waves.exchange import WaveField

FIRST_FILE = "events.jsonl"  # of the files of a run: one that fails early leaves it alone
PROGRESS_PARTS = 10  # parts of a run, and of its pictures, after which a line is printed


class Result:
    """Reader of a run folder: its tables as arrays by column, its manifest, its events."""

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)

    def __repr__(self) -> str:
        return f"Result({str(self.folder)!r})"

    @cached_property
    def manifest(self) -> dict[str, Any]:
        """Content of manifest.json: the resolved scene, versions, backend, seed, hashes."""
        return input_file.read_json(self.folder / "manifest.json")

    @cached_property
    def events(self) -> list[dict[str, Any]]:
        """Events of the run in order, from events.jsonl, without a last line that a killed run did not finish."""
        path = self.folder / "events.jsonl"
        text = input_file.read_text(path) if path.exists() else ""
        return [json.loads(line) for line in text[: text.rfind("\n") + 1].splitlines()]

    def table(self, name: str) -> dict[str, np.ndarray]:
        """Columns of the file `<name>.csv` in the run folder by name, each an array over its rows."""
        return csv_file.read_columns(self.folder / f"{name}.csv")

    @cached_property
    def gauges(self) -> dict[str, np.ndarray]:
        """Columns of gauges.csv by name."""
        return self.table("gauges")

    @cached_property
    def motion(self) -> dict[str, np.ndarray]:
        """Columns of motion.csv, the motion log of the only ship, by name."""
        return self.table("motion")

    @cached_property
    def motions(self) -> dict[str, dict[str, np.ndarray]]:
        """Columns of the motion log of each of several ships, by her name; empty for a single ship."""
        return {name: self.table(f"motion_{name}") for name in self.manifest["scene"].get("ships", {})}

    @cached_property
    def accuracy(self) -> dict[str, np.ndarray]:
        """Columns of accuracy.csv by name."""
        return self.table("accuracy")

    @cached_property
    def timings(self) -> dict[str, np.ndarray]:
        """Columns of timings.csv by name."""
        return self.table("timings")


class ProgressLines(Observer):
    """Observer that prints time, speed over real time, time left at each tenth of a run; then pictures drawn so far."""

    def __init__(self, duration: float) -> None:
        self.duration, self.every = duration, duration / PROGRESS_PARTS
        self.first: tuple[float, float] | None = None  # simulated and wall time [s] when steps cost what they cost
        self.passed = self.drawn = 0  # tenths of the run, and of its pictures

    def observe(self, simulation: Simulation) -> None:
        time = simulation.time
        if simulation.steps == 0:
            for observer in simulation.observers:
                observer.show_progress(self.draw)
        tenth = int(PROGRESS_PARTS * time / self.duration + 1e-9)
        if tenth <= self.passed:
            return
        self.passed, now, speed = tenth, perf_counter(), ""
        if self.first is None:
            self.first = (time, now)
        else:
            factor = (time - self.first[0]) / (now - self.first[1])
            speed = f", {figures(factor, 2)} x real time, {max(0.0, self.duration - time) / factor:.0f} s left"
        self.say(f"t = {time:.2f} of {self.duration:g} s{speed}")

    def draw(self, done: int, total: int) -> None:
        """Print the number of drawn pictures after each tenth of them; nothing if `total` is 0, that is, unknown."""
        if total and PROGRESS_PARTS * done // total > self.drawn:
            self.drawn = PROGRESS_PARTS * done // total
            self.say(f"picture {done} of {total}")

    def say(self, line: str) -> None:
        print(line, file=sys.stderr, flush=True)


def run(
    scene: SceneConfig | str | Path | dict[str, Any],
    out: str | Path,
    observers: tuple[Observer, ...] = (),
    progress: bool = False,
    overwrite: bool = False,
) -> Result:
    """Simulate a scene and write its run folder, `out`.

    `observers`: beyond those that the scene names. `progress`: print simulated time, speed and time left after each
    tenth, and how many pictures are drawn, to standard error. `overwrite`: replace a run that is there already, of
    which the files that its manifest lists are deleted. Raises SceneError, Diverged, and Refused where the folder holds
    a run that is not to be replaced, or other things, or another process writes there.
    """
    if not isinstance(out, str | PathLike):
        raise Unsuited(f"run: out is the name of a folder, not {out!r:.60}")
    config = scene if isinstance(scene, SceneConfig) else load(scene)
    shown = (ProgressLines(config.duration),) if progress else ()
    with claim_run_folder(config.files(), Path(out), overwrite) as folder:
        return simulate(config, folder, (*observers, *shown))


def claim_run_folder(
    coming: Iterable[str], out: Path, overwrite: bool, named: str = "", cure: str = "give overwrite=True"
) -> Claim:
    """Lock a folder `out` for a run that will write the files `coming`; with `overwrite` an earlier run there is
    deleted. Raises Refused if the folder holds a run that may not be deleted, or other files. `named`: name of the
    folder in messages; `cure`: their advice on how to overwrite."""
    claim = claim_folder(out, FIRST_FILE, named=named)
    try:
        if (out / MANIFEST_FILE).exists():
            if not overwrite:
                raise Refused(f"{named or out}: there is a run here already; name another folder, or {cure}")
            run_files.delete_run(out, coming)
    except BaseException:
        claim.close()
        raise
    return claim


def simulate(config: SceneConfig, folder: Path, observers: tuple[Observer, ...]) -> Result:
    """Simulate a scene into a folder that the caller has claimed; returns the reader of its files."""
    with stoppable(), Simulation(config, folder) as simulation:
        simulation.observers.extend(observers)
        stop_if_asked()
        with reserve_disk_space(folder):
            simulation.run(config.duration)
    return Result(folder)


def wave_field(scene: SceneConfig | str | Path | dict[str, Any]) -> WaveField:
    """Waves of a scene, to evaluate at any place and time; raises SceneError, and Refused without plane waves."""
    with Simulation(scene if isinstance(scene, SceneConfig) else load(scene)) as simulation:
        sea = simulation.fluid.plane_waves
    if sea is None:
        raise Refused("the water of this scene is not a sum of plane waves, as linear_waves and spectral_sea are")
    return WaveField(sea)
