"""Programs of others, measured beside this one."""

import json
import os
import re
import signal
import sys
import textwrap
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from benchmarks import another_python, peers, pysph_dam, splishsplash
from ocean_sim import parts

PEER_PYTHON = os.environ.get("OCEAN_SIM_PEER_PYTHON")


@pytest.fixture(autouse=True)
def in_empty_folder(tmp_path, monkeypatch):
    """Every test runs in a folder of its own."""
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def one_dam_each(monkeypatch):
    """The first dam break under either program, a step of each, and no peer in this environment."""
    few = [o._replace(dams=tuple(dam._replace(seconds=0.0, end=0.0) for dam in o.dams[:1])) for o in peers.OTHERS]
    monkeypatch.setattr(peers, "OTHERS", few)
    monkeypatch.setattr(peers, "measure_installed", lambda peer, task, measured: peers.table_row(peer, None, task, []))


def test_peers_are_measured_by_turns_with_the_same_water(ask, one_dam_each, monkeypatch):
    """Each under the Python that has it."""
    orders = []

    def measured(peer, python: Path, order: dict) -> dict:
        orders.append((peer, python, order))
        return {"particles": 6000, "walls": 9104, "steps": 10, "wall": 0.05, "cpu": 0.04, "simulated": 0.005}

    there = {(splishsplash, Path("one/python")): "2.19.0", (pysph_dam, Path("two/python")): "1.0b2"}
    monkeypatch.setattr(another_python, "version_in", lambda peer, python: there.get((peer, python)))
    monkeypatch.setattr(another_python, "measure_peer", measured)
    pythons = ("--peer-python", "one/python", "--peer-python", "two/python")
    code, out, _ = ask("bench", "--peers", *pythons, "--threads", "1", "--json")
    assert code == 0, out
    rows = json.loads(out)[-2:]
    assert [(row["peer"], row["version"]) for row in rows] == [("SPlisHSPlasH", "2.19.0"), ("PySPH", "1.0b2")]
    for found in rows:
        assert found["peer_s"] == pytest.approx(0.005) and found["ratio"] == pytest.approx(found["ours_s"] / 0.005)
        assert found["peer_cpu_s"] == pytest.approx(0.004)
        assert found["cpu_ratio"] == pytest.approx(found["ours_cpu_s"] / 0.004) and found["ours_cpu_s"] > 0.0
        assert peers.sentence(found).endswith("; its walls are 9104 particles more")
    assert [(peer, python) for peer, python, _ in orders] == [place for place in there for _ in range(peers.DAM_TURNS)]
    order = orders[0][2]
    assert order["threads"] == 1 and np.prod(order["lattice"]) == 6000
    assert splishsplash.scene(order, "box.obj")["FluidBlocks"][0]["end"] == pytest.approx([1.045, 0.795, 1.045])


def test_a_peer_that_is_not_there_is_named(ask, one_dam_each, tmp_path):
    packages = ("pysplishsplash", "pysph setuptools")
    code, out, _ = ask("bench", "--peers")
    assert code == 0
    assert all(f"not installed; pip install {package} into an environment of its own" in out for package in packages)
    assert ask("bench", "--peer-python", "python")[0] == 2
    nowhere = str(tmp_path / "none")
    code, out, _ = ask("bench", "--peers", "--peer-python", nowhere)
    assert code == 3 and out.count(f"dam breaks: not measured: it does not run under {nowhere}: ") == 2
    assert out.count("No such file") == 2


def test_a_python_without_any_peer_is_refused_before_anything_is_measured(ask, one_dam_each):
    code, out, err = ask("bench", "bench/dam_break_6k", "--peers", "--peer-python", sys.executable)
    assert (code, out) == (2, "")
    sentence = f"--peer-python {sys.executable}: this Python has neither pysplishsplash nor pysph"
    assert err == f"{sentence}; install one of them there\n"


def test_a_peer_that_dies_at_import_or_never_ends_is_named(tmp_path, monkeypatch):
    """Another Python whose peer crashes, one whose peer hangs, and both in a process of ours."""
    python = tmp_path / "python"
    for script, why in (("kill -SEGV $$", "it ended with -11"), ("exec sleep 60", "it was not done after 0.5 s")):
        python.write_text(f"#!/bin/sh\n{script}\n")
        python.chmod(0o755)
        monkeypatch.setattr(another_python, "MAX_IMPORT_SECONDS", 0.5)
        for others in peers.OTHERS:
            (row,) = peers.dam_breaks(others, [python], 1)
            assert row["failed"] == f"it does not run under {python}: {why}" and row["ratio"] is None
            assert peers.sentence(row).startswith(f"{others.peer.PEER}, dam breaks") and why in peers.sentence(row)
    monkeypatch.setattr(peers, "version", lambda peer: "1.0")
    assert peers.measure_installed("p", "task", os.abort)["failed"] == "its process died (-6)"
    assert "TypeError" in peers.measure_installed("p", "task", os.strerror)["failed"]
    monkeypatch.setattr(peers, "MAX_PEER_SECONDS", 0.3)
    assert peers.measure_installed("p", "task", signal.pause)["failed"] == "it was not done after 0.3 s"


def peer_that(does: str, folder: Path) -> Any:
    """A program of others whose dam break is these lines."""
    file = folder / "peer.py"
    file.write_text("import os, sys, time\ndef main(order, watch):\n" + textwrap.indent(does, "    "))
    return SimpleNamespace(
        PEER="other", PACKAGE="pip", INSTALLED="pip", ENVIRONMENT={"HALF": "0.5"}, __file__=str(file)
    )


def test_another_python_takes_the_time_of_steps_alone(tmp_path):
    """What is before the begin does not count, nor what the program prints."""
    does = """print("begins")
time.sleep(0.3)
for step in range(100):
    print(step)
    watch.look(float(os.environ["HALF"]) * step, 7, 3)
    time.sleep(0.01)
"""
    order = {"begin": 2.0, "seconds": 0.05, "end": 12.0, "threads": 1}
    found = another_python.measure_peer(peer_that(does, tmp_path), Path(sys.executable), order)
    assert (found["particles"], found["walls"], found["steps"], found["simulated"]) == (7, 3, 20, 10.0)
    assert 0.2 < found["wall"] and found["cpu"] < found["wall"]


@pytest.mark.parametrize(
    ("does", "why"),
    [
        ("import ocean_sim", "ModuleNotFoundError: No module named 'ocean_sim'"),
        ("sys.exit('no compiler')", "no compiler"),
        ("os.abort()", "it ended with -6"),
        ("watch.look(0.0, 1, 0)", "its run ended before it was measured"),
        ("time.sleep(60.0)", "it was not done after 2 s"),
    ],
)
def test_another_python_says_in_a_sentence_what_went_wrong(does, why, tmp_path, monkeypatch):
    """The interpreter is that of the environment's base, which has nothing of ours."""
    monkeypatch.setattr(another_python, "MAX_RUN_SECONDS", 2.0)
    python = Path(sys.base_prefix) / "bin" / "python3"
    with pytest.raises(ValueError, match=re.escape(why)):
        another_python.measure_peer(peer_that(does, tmp_path), python, {"begin": 0.0, "threads": 1})


@pytest.mark.slow
@pytest.mark.skipif(PEER_PYTHON is None, reason="OCEAN_SIM_PEER_PYTHON names no Python that has programs of others")
@pytest.mark.parametrize("others", peers.OTHERS, ids=lambda others: others.peer.PEER)
def test_other_programs_compute_the_dam_breaks(others, tmp_path):
    """Every one of 6000 particles, in steps that water lives through; what they leave lies in their folder."""
    if peers.find_peer(others.peer, [Path(PEER_PYTHON)]) is None:
        pytest.skip(f"{PEER_PYTHON} has no {others.peer.PACKAGE}")
    before = set(Path.home().iterdir())
    for dam in others.dams:
        if dam.name == "dam_break_6k":
            brief = dam._replace(seconds=0.2, end=min(dam.end, 0.05))
            row = peers.dam_break(others.peer, brief, Path(PEER_PYTHON), "any", 1, str(tmp_path))
            assert row["failed"] is None and row["ratio"] > 0.0
    assert set(Path.home().iterdir()) == before


def test_without_a_checkout_a_sentence_says_where_the_peers_are(ask, monkeypatch, tmp_path):
    monkeypatch.setattr(parts, "PACKAGE", tmp_path / "ocean_sim")
    code, out, err = ask("bench", "--peers")
    assert (code, out) == (2, "")
    assert err == "--peers: the programs that run others are in a checkout of the project, in benchmarks/; use that\n"
