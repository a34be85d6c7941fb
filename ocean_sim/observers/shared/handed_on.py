"""What one observer hands to another while a run goes on: rows in memory, as the files show them.

Who takes rows says so by its base class, so observers need not know one another. Who hands on closes
before who takes: the last rows are handed on as it closes, and observers close by turn and name.
"""

from typing import TYPE_CHECKING, TypeVar

import numpy as np

if TYPE_CHECKING:
    from ocean_sim.platform import Commands
    from ocean_sim.simulation import Simulation


class TakesMotion:
    """An observer that is handed new rows of a ship's motion log, each once, in the order of time: its columns
    before the forces."""

    at_once = False  # whether each row is handed on as soon as it is known, not many together

    def take_motion(self, ship: str, rows: dict[str, np.ndarray], frame: str) -> None:
        raise NotImplementedError


class TakesCommands:
    """An observer that is handed the rows of platform.csv, each once, in the order of time."""

    def take_commands(self, rows: "Commands") -> None:
        raise NotImplementedError


Taker = TypeVar("Taker", TakesMotion, TakesCommands)


def takers(simulation: "Simulation", kind: type[Taker]) -> list[Taker]:
    """The observers of a run that take such rows."""
    return [observer for observer in simulation.observers if isinstance(observer, kind)]
