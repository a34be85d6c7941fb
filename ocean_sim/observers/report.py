"""report.html: one page that needs no network, with scene, outcome, pictures and curves of the run."""

from pathlib import Path
from typing import ClassVar

from ocean_sim.observers.shared.run_report import write_report
from ocean_sim.simulation import ObserverConfig, OutcomeObserver, Simulation


class Config(ObserverConfig):
    """No keys: the page is written when the run is over."""

    turn: ClassVar[int] = 3
    leaves: ClassVar[str] = "report.html, when the run is over"

    def build(self, folder: Path, simulation: Simulation) -> "Report":
        return Report(folder)


class Report(OutcomeObserver):
    """Writes report.html from the files of the other observers; `render`, which closes later, writes it again."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def close(self) -> None:
        write_report(self.folder)
