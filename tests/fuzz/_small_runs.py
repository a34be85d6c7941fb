"""A few steps of a scene with all its observers, and what is not a number in what they wrote."""

from pathlib import Path

import numpy as np

from ocean_sim.conventions import Diverged
from ocean_sim.reading.scene import SceneConfig
from ocean_sim.result import Result
from ocean_sim.simulation import Simulation

STEPS = 50


class Enough(Exception):
    """So many steps were taken."""


class Counted:
    """Ends a run after STEPS steps."""

    every = 0.0

    def observe(self, simulation: Simulation) -> None:
        if simulation.steps >= STEPS:
            raise Enough

    def close(self) -> None:
        pass


def ran(config: SceneConfig, folder: Path) -> str:
    """How a run ended: `done`, or the reason why it stopped."""
    folder.mkdir(parents=True, exist_ok=True)
    with Simulation(config, folder) as simulation:
        simulation.observers.append(Counted())
        try:
            simulation.run(config.duration)
        except Enough:
            pass
        except Diverged as stopped:
            assert simulation.outcome == "stopped" and "t = " in str(stopped), stopped
            return str(stopped)
    return "done"


def not_numbers(folder: Path) -> list[str]:
    """Columns and arrays of a run folder that hold what is not a finite number."""
    found = []
    for path in sorted(folder.glob("*.csv")):
        for name, column in Result(folder).table(path.stem).items():
            if column.dtype.kind == "f" and not np.isfinite(column).all():
                found.append(f"{path.name}: {name}")
    for path in sorted((folder / "frames").glob("*.npz")):
        with np.load(path) as arrays:
            found += [
                f"{path.name}: {name}"
                for name in arrays.files
                if arrays[name].dtype.kind == "f" and not np.isfinite(arrays[name]).all()
            ]
    return found
