"""report.html: one page that says what was run and how it went, with its pictures and curves; it needs no network."""

from pathlib import Path
from typing import ClassVar

from ocean_sim.observers.shared.run_report import write
from ocean_sim.simulation import ObserverConfig, OutcomeObserver, Simulation


class Config(ObserverConfig):
    """Nothing to choose: the page is written when the run is over."""

    turn: ClassVar[int] = 3
    leaves: ClassVar[str] = "report.html, when the run is over"

    def build(self, folder: Path, simulation: Simulation) -> "Report":
        return Report(folder)


class Report(OutcomeObserver):
    """Reads what the other observers wrote. It closes before `render`, whose film takes long, and who writes the page
    anew with its pictures."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def close(self) -> None:
        write(self.folder)
