"""The library that a scene asks for on the command line, where the process computes with the other."""

import json
import os
import subprocess
import sys
from importlib.util import find_spec

import pytest

from ocean_sim import __main__, kernel_library
from ocean_sim.conventions import Lacking
from ocean_sim.reading.scene import load
from ocean_sim.verbs import resume
from ocean_sim.verbs.shared import console

OTHER = {"taichi": "quadrants", "quadrants": "taichi"}[kernel_library.LIBRARY_NAME]
SCENE = """duration: 0.01
basin: {length: 1.0, width: 1.0, depth: 0.5}
fluid: {kind: mueller, spacing: 0.25}
render: null
report: null
frames: null
checkpoint: {every: 0.005}
"""


@pytest.fixture
def unchosen(monkeypatch):
    monkeypatch.delenv(kernel_library.LIBRARY_VARIABLE, raising=False)
    return monkeypatch


def test_what_the_process_computes_with_is_taken(unchosen):
    console.must_compute_with(None)
    console.must_compute_with(kernel_library.LIBRARY_NAME)


def test_a_library_that_is_not_there_is_named(unchosen):
    unchosen.setattr(console, "installed_version", lambda package: None)
    with pytest.raises(Lacking, match=f"runtime.library: {OTHER} is not installed here; pip install {OTHER}"):
        console.must_compute_with(OTHER)


def test_what_a_person_has_chosen_stays(monkeypatch):
    monkeypatch.setenv(kernel_library.LIBRARY_VARIABLE, kernel_library.LIBRARY_NAME)
    console.must_compute_with(OTHER)  # the start of the backend tells that the two do not agree


def test_the_process_begins_anew_with_the_same_words(unchosen, tmp_path):
    unchosen.setattr(console, "installed_version", lambda package: "1.0")
    begun = []
    unchosen.setattr(os, "execve", lambda *given: begun.append(given))
    (tmp_path / "small.yaml").write_text(SCENE)
    words = ["run", str(tmp_path / "small.yaml"), "--out", str(tmp_path / "run"), "--set", f"runtime.library={OTHER}"]
    with pytest.raises(console.Anew) as other:
        __main__.run_command_line(words)
    other.value.begin(words)
    ((program, line, environment),) = begun
    assert (program, line) == (sys.executable, [sys.executable, "-m", "ocean_sim", *words])
    assert environment[kernel_library.LIBRARY_VARIABLE] == OTHER
    assert not (tmp_path / "run").exists()


def test_a_scene_that_asks_for_the_other_library_is_computed_with_it_and_goes_on(unchosen, tmp_path):
    if find_spec(OTHER) is None:
        pytest.skip(f"{OTHER} is not installed here: `pip install {OTHER}`")
    (tmp_path / "small.yaml").write_text(f"{SCENE}runtime: {{library: {OTHER}, threads: 1}}\n")
    run = tmp_path / "run"
    for words in (["run", str(tmp_path / "small.yaml"), "--out", str(run)], ["resume", str(run), "--until", "0.02"]):
        done = subprocess.run([sys.executable, "-m", "ocean_sim", *words], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
    manifest = json.loads((run / "manifest.json").read_text())
    assert OTHER in manifest["versions"] and kernel_library.LIBRARY_NAME not in manifest["versions"]
    assert manifest["simulated_s"] >= 0.02


@pytest.mark.parametrize("library", ["taichi", "quadrants"])
def test_a_run_goes_on_with_the_library_that_it_began_with(library):
    config = load({"basin": {"length": 1.0, "width": 1.0, "depth": 0.5}, "fluid": {"kind": "mueller", "spacing": 0.25}})
    assert resume.library_of({"versions": {"numpy": "2.0", library: "1.0"}}, config) == library
    assert resume.library_of({"versions": 3}, config) is None
