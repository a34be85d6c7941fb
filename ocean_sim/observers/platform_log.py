"""What a motion platform would do: washout and leg lengths, row by row beside the motion log."""

from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from ocean_sim.files.csv_file import Growing
from ocean_sim.observers import Observer
from ocean_sim.observers.shared.csv_rows import CsvFile
from ocean_sim.parts import ObserverConfig
from ocean_sim.platform import COLUMNS, LIMITS
from ocean_sim.platform.shared.motion_log import AXES_IN_WORDS, ride_of

if TYPE_CHECKING:
    from ocean_sim.simulation import Simulation

FRAME = "flu"
ROWS = 25  # answered at once, where no stream waits for each


class Config(ObserverConfig):
    """It has no keys: its rate is that of `motion`."""

    leaves: ClassVar[str] = "platform.csv; washout and hexapod"
    takes: ClassVar[tuple[float, float]] = (8.4e-5, 0.0)
    needs: ClassVar[tuple[str, ...]] = ("platform", "motion")

    def build(self, folder: Path, simulation: "Simulation") -> "PlatformLog":
        return PlatformLog(folder, simulation)


def heading(every: float, frame: str = FRAME) -> dict[str, object]:
    """The comment lines that every platform.csv begins with."""
    return {
        "frame": frame,
        "axes": AXES_IN_WORDS[frame],
        "pose": "from neutral; Rz(yaw) Ry(pitch) Rx(roll)",
        "felt": "specific force, gravity included, and rates on the platform in its own axes",
        "limited": "the sum of " + ", ".join(f"{bit} ({what})" for bit, what in LIMITS.items()),
        "rate": f"every {every:.9g} s",
    }


class PlatformLog(Observer):
    """platform.csv. It reads the rows of motion.csv as they are written, so it is what the command would say later."""

    def __init__(self, folder: Path, simulation: "Simulation") -> None:
        rate = simulation.scene.observers["motion"].every  # [s]
        self.every = rate if "stream" in simulation.scene.observers else ROWS * rate
        self.platform = simulation.scene.platform.build(rate)
        self.motion = Growing(folder / "motion.csv")
        head = heading(rate) | {"seed": simulation.scene.seed}
        self.csv = CsvFile(folder / "platform.csv", head, COLUMNS)

    def observe(self, simulation: "Simulation") -> None:
        self.follow()

    def follow(self) -> None:
        """Answer the rows that are new."""
        table = self.motion.rows()
        if table and len(table["time_s"]):
            for row in self.platform.follow(ride_of(table, self.motion.head.get("frame", "world"))).rows():
                self.csv.row(row)

    def close(self) -> None:
        self.follow()
        self.csv.close()
