"""Builds that fail at the k-th allocation, each followed by one that must not be changed by it; a process of its own,
since a failure may be its end: `python -m tests.fuzz._failed_builds SCENE.json STRIDE`."""

import hashlib
import json
import sys
from contextlib import nullcontext
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np

from ocean_sim import Simulation, load
from ocean_sim.fluid import with_particles

ALLOCATING = ("empty", "zeros", "array", "arange", "concatenate", "expr_field", "create_root", "dense", "place")
MATERIALIZING = "finalize_snode_tree"
FAILURES = (MemoryError, RuntimeError, KeyboardInterrupt)


class Injector:
    """Counts allocations of NumPy and Taichi, and raises `failure` at the k-th; counted twice, before and after, is
    where Taichi takes memory."""

    def __init__(self, k: int, failure: type[BaseException]) -> None:
        self.k, self.failure, self.count = k, failure, 0

    def __call__(self, frame: Any, event: str, function: Any) -> None:
        if event not in ("c_call", "c_return"):
            return
        name = function.__name__
        if name == MATERIALIZING or (event == "c_call" and name in ALLOCATING):
            self.count += 1
            if self.count == self.k:
                raise self.failure("injected")

    def build(self, scene: Any) -> BaseException | None:
        """What building a scene ends with; None where it is built, and closed."""
        sys.setprofile(self)
        try:
            simulation = Simulation(scene)
        except BaseException as failure:  # which a library may have put in place of what was injected
            return failure
        finally:
            sys.setprofile(None)
        simulation.close()
        return None


def state(simulation: Simulation) -> str:
    """Digest of the water."""
    parts = [simulation.fluid.elevations(np.array([[0.1, 0.0], [-0.3, 0.0]])).tobytes()]
    if simulation.scene.fluid.made_of_particles:
        parts.append(with_particles(simulation.fluid).particles.position.to_numpy().tobytes())
    return hashlib.sha256(b"".join(parts)).hexdigest()


def digest(scene: Any) -> str:
    """State after two steps of a scene."""
    with Simulation(scene) as simulation:
        for _ in range(2):
            simulation.step()
        return state(simulation)


def main(path: str, stride: int) -> dict[str, Any]:
    """Failures, and what went `wrong` after them: nothing open, and once more beside a simulation that is open, whose
    state must be that of an undisturbed one."""
    scenes = json.loads(Path(path).read_text())
    small, large = load(scenes["small"]), load(scenes["large"])
    answer: dict[str, Any] = {"fresh": digest(small), "failures": 0, "wrong": []}
    failures = answer["failures"]
    with Simulation(small) as undisturbed:
        for _ in range(50):
            undisturbed.step()
        expected = state(undisturbed)
    for beside in (nullcontext, lambda: Simulation(small)):
        with beside() as kept:
            for k in count(1, stride):
                failure = FAILURES[k // stride % len(FAILURES)]
                injector = Injector(k, failure)
                ended = injector.build(large)
                if injector.count < k:
                    break
                failures += ended is not None
                found = digest(small)
                if found != answer["fresh"]:
                    answer["wrong"].append([k, repr(ended), found])
                if kept is not None and kept.steps < 50:
                    kept.step()
            while kept is not None and kept.steps < 50:
                kept.step()
            if kept is not None and state(kept) != expected:
                answer["wrong"].append(["the one that is open"])
    return answer | {"failures": failures}


if __name__ == "__main__":
    print(json.dumps(main(sys.argv[1], int(sys.argv[2]))))
