"""Commands of a motion platform: washout and leg lengths, one row for each row of the motion log."""

from pathlib import Path
from typing import ClassVar

import numpy as np

from ocean_sim.observers.shared.csv_rows import CsvFile, TakesCommands, TakesMotion, legend
from ocean_sim.parts import ObserverConfig
from ocean_sim.platform import LIMIT_TEXTS, PLATFORM_COLUMNS
from ocean_sim.platform.shared.motion_log import AXES_IN_WORDS, ride_of, round_interval
from ocean_sim.simulation import Observer, Simulation

PLATFORM_FRAME = "flu"


class Config(ObserverConfig):
    """No keys: its rate is that of `motion`."""

    leaves: ClassVar[str] = "platform.csv; washout and hexapod"
    needs: ClassVar[tuple[str, ...]] = ("platform", "motion")


def heading(every: float, frame: str = PLATFORM_FRAME) -> dict[str, object]:
    """Comment lines, by name, at the top of platform.csv, with rows `every` [s] apart along axes `frame` (as `flu`)."""
    columns = legend("platform", limits=", ".join(f"{bit} ({what})" for bit, what in LIMIT_TEXTS.items()))
    return {"frame": frame, "axes": AXES_IN_WORDS[frame]} | columns | {"rate": f"every {every:.9g} s"}


class PlatformLog(Observer, TakesMotion, of=Config):
    """Writes platform.csv during a run, with the rows that `ocean-sim platform` makes from the whole motion log."""

    def __init__(self, config: Config, folder: Path, simulation: Simulation) -> None:
        scene, self.simulation = simulation.scene, simulation
        assert scene.platform is not None
        every = round_interval(config.interval(scene.preflight))
        self.platform, self.ship = scene.platform.build(every), scene.platform.ridden(list(scene.ships))
        self.planner = None
        if scene.platform.look_ahead is not None:
            from ocean_sim.observers.shared.planner import Planner

            self.planner = Planner(simulation)
        self.at_once = self.planner is not None
        self.csv = CsvFile(folder / "platform.csv", heading(every) | {"seed": scene.seed}, PLATFORM_COLUMNS)

    def take_motion(self, ship: str, rows: dict[str, np.ndarray], frame: str) -> None:
        """Write platform commands for rows of its ship's motion log, along axes `frame` (as `flu`); pass them on."""
        if ship == self.ship:
            commands = self.platform.follow(ride_of(rows, frame), self.planner)
            for row in commands.rows():
                self.csv.row(row)
            for observer in self.simulation.observers:
                if isinstance(observer, TakesCommands):
                    observer.take_commands(commands)

    def close(self) -> None:
        if self.planner is not None:
            self.planner.close()
        self.csv.close()
