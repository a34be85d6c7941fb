"""The platform's poses over UDP while a run goes on, at the pace of simulated time; only when named."""

import sys
from pathlib import Path
from typing import ClassVar, Literal

import numpy as np
from pydantic import field_validator

from ocean_sim.files.input_file import AnyFileName
from ocean_sim.model import Faults
from ocean_sim.observers.shared.csv_rows import TakesCommands
from ocean_sim.parts import ObserverConfig, SceneFacts
from ocean_sim.platform import Commands
from ocean_sim.platform.shared.datagrams import Sender, parse_address, read_key
from ocean_sim.platform.shared.packets import row_packets
from ocean_sim.simulation import Observer, Simulation


class Config(ObserverConfig):
    leaves: ClassVar[str] = "UDP packets, each at its time"
    needs: ClassVar[tuple[str, ...]] = ("platform", "motion", "platform_log")

    to: str = "udp://127.0.0.1:5005"
    """Address of the receiver; another machine only when it is named."""
    packets: Literal["ocean_sim", "openmotionsim", "floats", "text"] = "ocean_sim"
    """Format of packets; `ocean_sim`: poses and legs, and signed with a `key`; `openmotionsim`: angles and height;
    `floats`: six motions for FlyPt Mover and SimHub; `text`: the same, a line of numbers, for SimTools."""
    frame: Literal["flu", "ned", "ship"] = "flu"
    """Axes of the poses; `flu` (ISO 8855), `ned` (SNAME) or `ship`: ours."""
    key: AnyFileName | None = None
    """A file whose content signs every packet (of `ocean_sim` only); null: they are not signed."""

    @field_validator("to")
    @classmethod
    def _is_an_address(cls, value: str) -> str:
        parse_address(value)
        return value

    def problems(self, preflight: SceneFacts) -> Faults:
        if self.key is not None and self.packets != "ocean_sim":
            yield ("key",), f"packets of {self.packets} have no place for a signature; take ocean_sim"
        elif self.key is not None:
            try:
                read_key(self.key)
            except ValueError as error:
                yield ("key",), str(error)


class Stream(Observer, TakesCommands, of=Config):
    """Sends the rows of platform.csv by UDP at the pace of simulated time: a run faster than real time waits, and while
    a slower one computes, the receiver keeps its last pose. At the end the platform returns to neutral."""

    paced = True

    def __init__(self, config: Config, folder: Path, simulation: Simulation) -> None:
        scene = simulation.scene
        assert scene.platform is not None
        self.config = config
        self.platform = scene.platform.build(config.interval(scene.preflight))  # computes the way back to neutral
        self.past = np.zeros((0, 6))  # the last two poses
        self.time, self.seq = 0.0, 0  # of the last row
        self.sender = Sender(config.to, config.packets, read_key(config.key) if config.key else b"")

    def take_commands(self, rows: Commands) -> None:
        self.past = np.vstack([self.past, rows.pose])[-2:]
        self.time, self.seq = float(rows.time[-1]), int(rows.seq[-1])
        self.send(rows)

    def send(self, rows: Commands) -> None:
        """Send each row as one packet at the time in the row, waiting until then."""
        for packet in row_packets(rows, self.config.frame):
            self.sender.send(packet)

    def close(self) -> None:
        """Send the poses that lead back to neutral, print the jitter of the packets' times, and close the socket."""
        if len(self.past):
            self.send(self.platform.return_home(self.past[[0, -1]], self.time, self.seq))
        back = "".join(f"; {told}" for told in (self.sender.latency(), self.sender.stop_report()) if told)
        print(f"stream to {self.config.to}: {self.sender.jitter()}{back}", file=sys.stderr, flush=True)
        self.sender.close()
