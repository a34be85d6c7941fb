"""The last moments of a simulation that is played with, in memory, and the way back to them."""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ocean_sim.observers.motion import Motion
from ocean_sim.observers.shared.csv_rows import Multiples, TakesCommands, TakesMotion
from ocean_sim.simulation import Simulation
from ocean_sim.state.snapshot import Restorer, Snapshot

KEPT = 2  # moments: the newest, and the one before for who is there already


class Moment(NamedTuple):
    """What a checkpoint holds of a state."""

    time: float  # [s]
    tree: Any
    arrays: dict[str, np.ndarray]


class Rewind:
    """Keeps the whole state at multiples of a simulated time, the newest ones."""

    def __init__(self, every: float, folder: Path) -> None:
        """`every`: simulated time between two moments [s]; `folder`: where observers write, if any do."""
        self.every, self.folder = every, folder
        self.forget()

    def forget(self) -> None:
        """The simulation begins anew."""
        self.multiples = Multiples(self.every)
        self.moments: list[Moment] = []

    def keep(self, simulation: Simulation) -> None:
        """Keep this moment if one is due."""
        if self.multiples.reached(simulation.time):
            taken = Snapshot(roots(simulation), self.folder)
            self.moments = [*self.moments, Moment(simulation.time, taken.tree, taken.arrays)][-KEPT:]

    def earlier(self, time: float) -> list[Moment]:
        """The moments before a time [s]; where there is none, the first."""
        return [moment for moment in self.moments if moment.time < time] or self.moments[:1]

    def restore(self, simulation: Simulation, moments: list[Moment]) -> None:
        """Put a simulation that has just been built of the same scene into the last of these, and keep them."""
        self.moments, newest = moments, moments[-1]
        Restorer(roots(simulation), newest.tree, newest.arrays, self.folder)
        self.multiples = Multiples(self.every)
        self.multiples.reached(newest.time)


def roots(simulation: Simulation) -> dict[str, Any]:
    """Where the walk over a simulation without a run folder begins. What a rig has been sent is not taken back."""
    kept = [each for each in simulation.observers if not isinstance(each, Motion | TakesMotion | TakesCommands)]
    return {"simulation": simulation, "observers": kept}
