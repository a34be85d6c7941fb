"""report.html: one page that needs no network, with scene, outcome, pictures and curves of the run."""

from pathlib import Path
from typing import ClassVar

from ocean_sim.observers.shared.run_report import write_report
from ocean_sim.parts import ObserverConfig
from ocean_sim.simulation import OutcomeObserver, Simulation


class Config(ObserverConfig):
    """No keys: the page is written when the run is over."""

    turn: ClassVar[int] = 3
    leaves: ClassVar[str] = "report.html, when the run is over"


class Report(OutcomeObserver, of=Config):
    """Writes report.html from the files of the other observers; `render`, which closes later, writes it again."""

    def __init__(self, config: Config, folder: Path, simulation: Simulation) -> None:
        self.folder = folder

    def close(self) -> None:
        write_report(self.folder)
