"""Taichi is started once, and afresh before its room for fields runs out."""

import subprocess
import sys

import pytest

from ocean_sim import Simulation, load, runtime

SEA = {
    "basin": {"length": 20.0, "width": 20.0, "depth": 5.0, "walls": "none"},
    "fluid": {"kind": "linear_waves", "height": 0.5, "period": 3.0},
    "duration": 1.0,
    "runtime": {"threads": 1},
}
MANY = """
import taichi as ti
from ocean_sim import runtime
begun = set()
for k in range(540):
    begun.add(id(runtime.start(runtime.RuntimeConfig(threads=1))))
    ti.field(float, shape=4).fill(0.0)
print(len(begun))
"""


def test_the_same_config_gives_what_runs(taichi_cpu):
    assert runtime.start(runtime.RuntimeConfig(precision="f64", threads=1)) is taichi_cpu


def test_a_simulation_whose_fields_are_gone_says_so(monkeypatch):
    with Simulation(load(SEA)) as first, Simulation(load(SEA)) as second:
        first.step()
        second.step()
        monkeypatch.setattr(runtime, "TREES", 0)  # no room is left
        with Simulation(load(SEA)) as third:
            third.step()
            with pytest.raises(RuntimeError, match="the fields of this simulation are gone"):
                first.step()
            third.step()


@pytest.mark.slow
def test_more_fields_than_taichi_holds_are_no_end():
    """Without a fresh start, the 513th set of fields ends the process."""
    done = subprocess.run([sys.executable, "-c", MANY], capture_output=True, text=True)
    assert done.returncode == 0 and int(done.stdout) == 2, done.stderr
    never = MANY.replace("begun = set()", "begun = set()\nruntime.TREES = 10_000")
    assert subprocess.run([sys.executable, "-c", never], capture_output=True).returncode < 0  # the negative control
