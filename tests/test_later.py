"""What is left for later when a library is imported is there once it is asked for."""

import subprocess
import sys

ASKED = """
import inspect, sys
asked = inspect.getframeinfo
from ocean_sim.kernel_library import ti
assert "dill" not in sys.modules and inspect.getframeinfo is asked
from taichi.lang import _wrap_inspect
source = _wrap_inspect.dill.source
import dill
assert source is dill.source
print("done")
"""


def test_what_taichi_leaves_out_is_imported_when_it_is_asked_for():
    done = subprocess.run([sys.executable, "-c", ASKED], capture_output=True, text=True, check=False)
    assert done.stdout == "done\n", done.stderr
