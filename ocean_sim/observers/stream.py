"""The platform's poses over UDP while a run goes on, at the pace of simulated time; only when named."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np
from pydantic import field_validator

from ocean_sim.files.csv_file import Growing
from ocean_sim.observers import Observer
from ocean_sim.parts import ObserverConfig
from ocean_sim.platform import Platform
from ocean_sim.platform.shared.datagrams import POSE, Sender, address, packets

if TYPE_CHECKING:
    from ocean_sim.simulation import Simulation


class Config(ObserverConfig):
    leaves: ClassVar[str] = "UDP packets, each at its time"
    needs: ClassVar[tuple[str, ...]] = ("platform", "motion", "platform_log")

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
        every = scene.observers["motion"].every
        return Stream(self, folder, every, scene.platform.build(every))


class Stream(Observer):
    """Rows of platform.csv as they are written. A run faster than time is held back to it; a slower one stalls, and
    the receiver holds its pose. At the end the platform goes back to neutral."""

    def __init__(self, config: Config, folder: Path, every: float, platform: Platform) -> None:
        self.config, self.every, self.platform = config, every, platform
        self.log = Growing(folder / "platform.csv")
        self.past = np.zeros((0, 6))  # the last two poses
        self.time, self.seq = 0.0, 0  # of the last row
        self.sender = Sender(config.to, config.packets)

    def observe(self, simulation: "Simulation") -> None:
        self.send(self.log.rows())

    def send(self, table: dict[str, np.ndarray]) -> None:
        """Send rows, each at its time."""
        if table and len(table["seq"]):
            self.past = np.vstack([self.past, np.column_stack([table[name] for name in POSE])])[-2:]
            self.time, self.seq = float(table["time_s"][-1]), int(table["seq"][-1])
            for packet in packets(table, self.config.frame):
                self.sender.send(packet)

    def close(self) -> None:
        if self.log.path.is_file():
            self.send(self.log.rows())
        if len(self.past):
            self.send(self.platform.settled(self.past[[0, -1]], self.time, self.seq).table())
        print(f"stream to {self.config.to}: {self.sender.jitter()}", file=sys.stderr, flush=True)
        self.sender.close()
