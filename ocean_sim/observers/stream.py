"""The platform's poses over UDP while a run goes on, at the pace of simulated time; only when named."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from pydantic import field_validator

from ocean_sim.csv_file import Growing
from ocean_sim.datagrams import Sender, address, packets
from ocean_sim.parts import ObserverConfig

if TYPE_CHECKING:
    from ocean_sim.simulation import Simulation


class Config(ObserverConfig):
    to: str = "udp://127.0.0.1:5005"
    """Where packets go; another machine only when it is named."""
    packets: Literal["ocean_sim", "openmotionsim"] = "ocean_sim"
    """Their format."""
    frame: Literal["flu", "ned", "ship"] = "flu"
    """The axes of their poses."""

    @field_validator("to")
    @classmethod
    def _is_an_address(cls, value: str) -> str:
        address(value)
        return value

    def build(self, folder: Path, simulation: "Simulation") -> "Stream":
        scene = simulation.scene
        if scene.platform is None or "platform_log" not in scene.observers:
            raise ValueError("stream sends what a platform does: name a ship and a platform, and leave platform_log on")
        return Stream(self, folder, scene.observers["motion"].every)


class Stream:
    """Rows of platform.csv as they are written. A run faster than time is held back to it; a slower one stalls, and
    the receiver holds its pose."""

    def __init__(self, config: Config, folder: Path, every: float) -> None:
        self.config, self.every = config, every
        self.log = Growing(folder / "platform.csv")
        self.sender = Sender(config.to, config.packets)

    def observe(self, simulation: "Simulation") -> None:
        self.send()

    def send(self) -> None:
        """Send the rows that are new."""
        table = self.log.rows()
        if table:
            for packet in packets(table, self.config.frame):
                self.sender.send(packet)

    def close(self) -> None:
        if self.log.path.is_file():
            self.send()
        print(f"stream to {self.config.to}: {self.sender.jitter()}", file=sys.stderr, flush=True)
        self.sender.close()
