"""Fixtures for all tests: a started runtime, shared by the tests of a module, and kernel caches kept across runs."""

import pytest

from ocean_sim import runtime


@pytest.fixture(scope="module")
def taichi_cpu() -> runtime.Backend:
    """Taichi on one thread in f64: bitwise repeatable, and exact enough for closed forms."""
    return runtime.start(runtime.RuntimeConfig(precision="f64", threads=1))
