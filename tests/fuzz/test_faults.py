"""The nth write, fsync or rename of a run goes wrong, for every n: nothing that was whole is lost, and resume leaves
the bytes of a run to which nothing happened."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
MODES = {"fails": 1, "fails, and all after it": 2, "is not reached by a killed process": 3}


@pytest.fixture(scope="module")
def shim(tmp_path_factory) -> Path:
    if shutil.which("cc") is None or not sys.platform.startswith("linux"):
        pytest.skip("there is no C compiler")
    path = tmp_path_factory.mktemp("shim") / "faults.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-o", str(path), str(HERE / "_faults.c"), "-ldl"], check=True)
    return path


@pytest.mark.slow
@pytest.mark.parametrize("mode", MODES)
def test_whatever_call_goes_wrong_nothing_is_lost(mode, shim, tmp_path):
    stride = int(os.environ.get("OCEAN_SIM_STRIDE", 1))
    words = [sys.executable, str(HERE / "_faulty_runs.py"), str(tmp_path), str(MODES[mode]), str(stride)]
    environment = os.environ | {"LD_PRELOAD": str(shim)}
    done = subprocess.run(words, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)
    print(mode, report)
    assert report["wrong"] == [] and report["struck"] > 0.8 * report["calls"] / stride
