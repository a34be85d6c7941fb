"""What a motion platform would do: washout and leg lengths, one row for each row of the motion log."""

from pathlib import Path
from typing import ClassVar

import numpy as np

from ocean_sim.observers.shared.csv_rows import CsvFile, TakesCommands, TakesMotion, takers
from ocean_sim.platform import COLUMNS, LIMITS, Platform
from ocean_sim.platform.shared.motion_log import AXES_IN_WORDS, as_logged, ride_of
from ocean_sim.simulation import Observer, ObserverConfig, Simulation

FRAME = "flu"
ROWS = 100  # answered together, where nobody waits for each


class Config(ObserverConfig):
    """No keys: its rate is that of `motion`."""

    leaves: ClassVar[str] = "platform.csv; washout and hexapod"
    needs: ClassVar[tuple[str, ...]] = ("platform", "motion")

    def build(self, folder: Path, simulation: Simulation) -> "PlatformLog":
        scene = simulation.scene
        assert scene.platform is not None
        rate = self.interval(scene.preflight)
        observing = [config for config in scene.observers.values() if isinstance(config, ObserverConfig)]
        at_once = any(self.name() in config.needs for config in observing)  # another waits for each row
        logged = as_logged(rate)
        head = heading(logged) | {"seed": scene.seed}
        csv = CsvFile(folder / "platform.csv", head, COLUMNS)
        ship, every = scene.platform.ridden(list(scene.ships)), 0.0 if at_once else ROWS * rate
        return PlatformLog(csv, every, scene.platform.build(logged), simulation, ship)


def heading(every: float, frame: str = FRAME) -> dict[str, object]:
    """The comment lines that every platform.csv begins with."""
    return {
        "frame": frame,
        "axes": AXES_IN_WORDS[frame],
        "pose": "from neutral; Rz(yaw) Ry(pitch) Rx(roll)",
        "felt": "specific force, gravity included, and rates on the platform in its own axes, by differences of the "
        "poses so far: accelerations are those of the row before, rates half a row late",
        "limited": "the sum of " + ", ".join(f"{bit} ({what})" for bit, what in LIMITS.items()),
        "rate": f"every {every:.9g} s",
    }


class PlatformLog(Observer, TakesMotion):
    """platform.csv, from the rows of the motion log: what `ocean-sim platform` would make of motion.csv later."""

    def __init__(self, csv: CsvFile, every: float, platform: Platform, simulation: Simulation, ship: str) -> None:
        """`ship`: the name of the one that it rides in."""
        self.csv, self.every, self.platform, self.simulation, self.ship = csv, every, platform, simulation, ship
        self.at_once = every == 0.0
        self.new: list[dict[str, np.ndarray]] = []  # rows that are not answered yet
        self.frame = FRAME  # theirs

    def take_motion(self, ship: str, rows: dict[str, np.ndarray], frame: str) -> None:
        if ship == self.ship:
            self.new.append(rows)
            self.frame = frame

    def observe(self, simulation: Simulation) -> None:
        self.answer()

    def answer(self) -> None:
        """Follow the rows that are new, write what the platform does, and hand it on."""
        if self.new:
            rows = {name: np.concatenate([row[name] for row in self.new]) for name in self.new[0]}
            commands = self.platform.follow(ride_of(rows, self.frame))
            self.new = []
            for row in commands.rows():
                self.csv.row(row)
            for observer in takers(self.simulation, TakesCommands):
                observer.take_commands(commands)

    def close(self) -> None:
        self.answer()
        self.csv.close()
