"""Fixtures for all tests: a started runtime, shared by the tests of a module, and kernel caches kept across runs."""

from pathlib import Path
from typing import Any

import pytest

from ocean_sim import runtime
from ocean_sim.state.walk import Restorer, Snapshot


class Start:
    """What a fluid or a simulation holds now, to be put back as a checkpoint does it: its kernels stay compiled."""

    def __init__(self, root: Any) -> None:
        self.root, self.held = root, Snapshot(root, Path())

    def put_back(self) -> None:
        arrays = {name: values.copy() for name, values in self.held.arrays.items()}
        Restorer(self.root, self.held.tree, arrays, Path())


@pytest.fixture(scope="module")
def taichi_cpu() -> runtime.Backend:
    """Taichi on one thread in f64: bitwise repeatable, and exact enough for closed forms."""
    return runtime.start(runtime.RuntimeConfig(precision="f64", threads=1))
