"""Planner of a platform's motion: another process, which may run a ghost of the ship ahead.

For a ghost it builds the same scene on one core, without observers. It is sent the state of the run, as a checkpoint
holds it, and steps on with the helm as it is: a script, an autopilot or a pilot goes on, a person's orders are held.
"""

import json
import os
import pickle
import sys
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import nullcontext, suppress
from pathlib import Path
from subprocess import PIPE, Popen
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from ocean_sim.conventions import Failed
from ocean_sim.observers.shared.csv_rows import TakesCommands, TakesMotion
from ocean_sim.platform.shared.motion_log import Ride, ride_of
from ocean_sim.reading.scene import load
from ocean_sim.simulation import NO_FOLDER, Observer, Simulation
from ocean_sim.state.snapshot import Restorer, Snapshot

ON_ONE_CORE = {"runtime.arch": "cpu", "runtime.threads": 1}


class Planner:
    """This side of the process. A checkpoint holds the question, which a run that goes on asks again."""

    left_out = ("simulation", "away", "child", "pool", "coming")
    order: tuple | None = None  # number of the plan under way, and what the process needs for it
    coming: "Future[Any] | None" = None  # the reply

    def __init__(self, simulation: Simulation) -> None:
        platform = simulation.scene.platform
        assert platform is not None
        self.simulation, self.pool, self.runs_ahead = simulation, ThreadPoolExecutor(1), bool(platform.look_ahead)
        self.away = TemporaryDirectory(prefix="ocean-sim-")
        scene = simulation.scene.resolved() | {"manifest": {}}  # which a page leaves out, and a scene cannot
        command = [sys.executable, "-m", __name__, self.away.name, json.dumps(scene)]
        self.child = Popen(command, stdin=PIPE, stdout=PIPE, start_new_session=True)  # which Ctrl-C does not reach

    def exchange(self) -> Any:
        """Send the order to the process, and wait for its reply: a plan, or a sentence why there is none."""
        assert self.child.stdin is not None and self.child.stdout is not None
        try:
            pickle.dump(self.order, self.child.stdin)
            self.child.stdin.flush()
            return pickle.load(self.child.stdout)
        except (OSError, EOFError):
            raise Failed("the process that plans for the platform has ended before the run") from None

    def ask(self, number: int, until: float, every: float, question: tuple) -> None:
        if self.order is None:
            state = Snapshot({"simulation": self.simulation} if self.runs_ahead else {}, NO_FOLDER)
            self.order = number, until, every, question, state.tree, state.arrays
            self.coming = self.pool.submit(self.exchange)

    def answer(self, number: int, dispensable: bool) -> Any:
        assert self.order is not None
        if self.coming is None:  # in a run that goes on from a checkpoint
            self.coming = self.pool.submit(self.exchange)
        found: Any = f"plan {number} came too late"
        observers = self.simulation.observers
        paced = number and any(isinstance(each, TakesCommands) and each.paced for each in observers)
        if not paced or self.coming.done():
            found = self.coming.result() if self.order[0] == number else found
            self.order = self.coming = None
        if not isinstance(found, str):
            return found
        for each in observers if not dispensable else ():
            each.record_event("no plan", what=f"{found}: the classical washout moves the platform")
        return None

    def close(self) -> None:
        """End the process, whatever it does."""
        self.child.kill()
        self.pool.shutdown()
        self.child.communicate()
        self.away.cleanup()


class MotionAhead(Observer, TakesMotion):
    """Collector of the motion of the `ship` in which the platform rides."""

    def __init__(self, ship: str) -> None:
        self.ship, self.rides = ship, list[Ride]()

    def take_motion(self, ship: str, rows: dict[str, np.ndarray], frame: str) -> None:
        if ship == self.ship:
            self.rides.append(ride_of(rows, frame))


def plan_for(order: tuple, simulation: Simulation | None, washout: Any, folder: Path) -> Any:
    """Plan of a washout for the order of a `Planner`, or a sentence why there is none: by a ghost, the `simulation` in
    this process, if there is one. `folder`: of files of no use."""
    _, until, every, question, tree, arrays = order
    try:
        if simulation is None:
            return washout.foresee(None, question)
        scene = simulation.scene
        assert scene.platform is not None
        ahead = MotionAhead(scene.platform.ridden(list(scene.ships)))
        motion = scene.observers["motion"].model_copy(update={"every": every})
        Restorer({"simulation": simulation}, tree, arrays, NO_FOLDER)
        simulation.observers, simulation.begun = [motion.build(folder, simulation), ahead], False
        simulation.run(until)
        simulation.run(simulation.time + 2.0 * simulation.next_dt)  # so that the forces at `until` are known
        simulation.conclude()
        return washout.foresee(Ride(*map(np.concatenate, zip(*ahead.rides))), question)
    except Failed as failure:
        if simulation is not None:
            simulation.conclude()
        return str(failure)


def main() -> None:
    """Reply to orders on standard input until it ends. Arguments: a folder, and a scene in JSON."""
    replies, scene = os.fdopen(os.dup(1), "wb"), load(json.loads(sys.argv[2]), ON_ONE_CORE)
    os.dup2(2, 1)  # for what else is printed
    platform = scene.platform
    assert platform is not None
    washout = None
    with Simulation(scene) if platform.look_ahead else nullcontext() as simulation, suppress(EOFError, OSError):
        if simulation is not None:
            simulation.conclude()  # its observers have nothing to write
        while True:
            order = pickle.load(sys.stdin.buffer)
            washout = washout or platform.build(order[2]).washout
            pickle.dump(plan_for(order, simulation, washout, Path(sys.argv[1])), replies)
            replies.flush()


if __name__ == "__main__":
    main()
