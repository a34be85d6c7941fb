"""A scene run into a folder, and what the run left there, read when asked for."""

import json
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ocean_sim.conventions import Refused
from ocean_sim.files import csv_file
from ocean_sim.files.claim import Claim
from ocean_sim.files.whole_file import set_aside
from ocean_sim.machine import stoppable
from ocean_sim.reading.scene import SceneConfig, load
from ocean_sim.simulation import Observer, Simulation

if TYPE_CHECKING:
    from ocean_sim.waves.field import WaveField


class Result:
    """A run folder: its tables as arrays by column, its manifest, its events."""

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)

    def __repr__(self) -> str:
        return f"Result({str(self.folder)!r})"

    @cached_property
    def manifest(self) -> dict[str, Any]:
        """What was run: the resolved scene, versions, backend, seed, hashes."""
        return json.loads((self.folder / "manifest.json").read_text(encoding="utf-8"))

    @cached_property
    def events(self) -> list[dict[str, Any]]:
        """What happened on the way, one entry an event; without a last line that a killed run did not finish."""
        path = self.folder / "events.jsonl"
        text = path.read_text(encoding="utf-8") if path.is_file() else ""
        return [json.loads(line) for line in text[: text.rfind("\n") + 1].splitlines()]

    def table(self, name: str) -> dict[str, np.ndarray]:
        """The columns of `<name>.csv`, each an array of its rows."""
        return csv_file.columns(self.folder / f"{name}.csv")

    @cached_property
    def gauges(self) -> dict[str, np.ndarray]:
        return self.table("gauges")

    @cached_property
    def motion(self) -> dict[str, np.ndarray]:
        """The motion log of a ship that is alone."""
        return self.table("motion")

    @cached_property
    def motions(self) -> dict[str, dict[str, np.ndarray]]:
        """The motion logs of several ships, by name."""
        return {name: self.table(f"motion_{name}") for name in self.manifest["scene"].get("ships", {})}

    @cached_property
    def accuracy(self) -> dict[str, np.ndarray]:
        return self.table("accuracy")

    @cached_property
    def timings(self) -> dict[str, np.ndarray]:
        return self.table("timings")


def run(
    scene: SceneConfig | str | Path | dict[str, Any], out: str | Path, observers: tuple[Observer, ...] = ()
) -> Result:
    """Simulate a scene and write its run folder; `observers`: beyond those that the scene names."""
    config = scene if isinstance(scene, SceneConfig) else load(scene)
    with Claim(Path(out)) as folder:
        return simulated(config, folder, observers)


def simulated(config: SceneConfig, folder: Path, observers: tuple[Observer, ...]) -> Result:
    """The same into a folder that the caller has claimed."""
    with stoppable(), Simulation(config, folder) as simulation:
        simulation.observers.extend(observers)
        with set_aside(folder):
            simulation.run(config.duration)
    return Result(folder)


def wave_field(scene: str | Path | dict[str, Any], overrides: dict[str, Any] | None = None) -> "WaveField":
    """The waves of a scene, to be asked at any place and time, where its water is a closed form or a patch of an open
    sea; raises SceneError or Refused."""
    from ocean_sim.waves.field import WaveField

    with Simulation(load(scene, overrides)) as simulation:
        sea = simulation.fluid.plane_waves
    if sea is None:
        raise Refused("the water of this scene is no sum of plane waves; linear_waves and spectral_sea are")
    return WaveField(sea)
