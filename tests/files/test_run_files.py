"""A run folder: what gives way to another run is what its manifest lists, and who asks is asked alike."""

import json
import os
from pathlib import Path

import numpy as np
import pytest

import ocean_sim
from ocean_sim.__main__ import run_command_line
from ocean_sim.conventions import Refused
from ocean_sim.files import run_files
from ocean_sim.files.input_file import file_digest

SEA = {
    "title": "first",
    "basin": {"length": 20.0, "width": 20.0, "depth": 5.0, "walls": "none"},
    "fluid": {"kind": "linear_waves", "height": 0.2, "period": 4.0, "ramp": 0.0},
    "ship": "otter",
    "motion": {"every": 0.05},
    "gauges": {"every": 0.05, "elevation": {"a": [0.0, 0.0]}},
    "checkpoint": {"every": 0.1},
    "frames": {"every": 0.1, "spacing": 2.0},
    "render": None,
    "duration": 0.2,
    "runtime": {"threads": 1},
}
LESS = {key: value for key, value in SEA.items() if key not in ("ship", "motion", "frames", "checkpoint")}


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("sea.yaml").write_text(json.dumps(SEA))
    Path("less.yaml").write_text(json.dumps(LESS))


def names(folder: str) -> set[str]:
    return {path.relative_to(folder).as_posix() for path in Path(folder).rglob("*") if path.is_file()}


def test_the_manifest_lists_every_file_of_the_run_and_of_what_is_made_of_it_later():
    ships = {"a": "otter", "b": {"kind": "otter", "position": [5.0, 5.0]}}
    gauges = {"every": 0.01, "elevation": {"a": [0.0, 0.0]}}
    scene = {key: value for key, value in SEA.items() if key != "ship"}
    ocean_sim.run(scene | {"ships": ships, "gauges": gauges}, "run")
    for words in (["waves", "run"], ["report", "run"], ["export", "run", "--surface", "vtp"]):
        assert run_command_line(words) == 0
    left = names("run")
    listed = run_files.matching_files(Path("run"), run_files.listed_files(run_files.read_manifest(Path("run"))))
    assert {path.relative_to("run").as_posix() for path in listed} == left
    assert {"motion_a.csv", "motion_b.csv", "replay.html", "waves.csv", "frames/grid.npz"} <= left
    run_files.delete_run(Path("run"))
    assert not any(Path("run").iterdir())


@pytest.mark.parametrize("ask", ["command", "library"])
def test_another_run_clears_what_the_manifest_lists_and_nothing_else(ask, capsys):
    def again(overwrite: bool) -> None:
        if ask == "library":
            ocean_sim.run(LESS, "run", overwrite=overwrite)
        elif run_command_line(["run", "less.yaml", "--out", "run", "--quiet", *["--overwrite"] * overwrite]):
            raise Refused(capsys.readouterr().err)

    ocean_sim.run(SEA, "run")
    mine = ["measured.csv", "platform.csv", "film.mp4", "frames/notes.txt", "frames/frame_mine.npz", "preview/a.png"]
    mine += ["still_mine.png", "checkpoint_mine.h5", "motion_measured.csv"]
    for name in mine:
        Path("run", name).parent.mkdir(exist_ok=True)
        Path("run", name).write_text("mine")
    before = {name: Path("run", name).read_bytes() for name in names("run")}
    with pytest.raises(Refused, match="there is a run here already; name another folder, or"):
        again(False)
    assert {name: Path("run", name).read_bytes() for name in names("run")} == before
    again(True)
    ocean_sim.run(LESS, "fresh")
    assert names("run") == names("fresh") | set(mine)
    assert all(Path("run", name).read_text() == "mine" for name in mine)
    assert Path("run/gauges.csv").read_bytes() == Path("fresh/gauges.csv").read_bytes()


def test_a_file_of_ones_own_is_not_written_over_by_the_new_run(capsys):
    ocean_sim.run(LESS, "run")
    Path("run/motion.csv").write_text("mine")
    before = names("run")
    with pytest.raises(Refused, match=r"motion\.csv: this file is not of the run that is there"):
        ocean_sim.run(SEA, "run", overwrite=True)
    assert names("run") == before and Path("run/motion.csv").read_text() == "mine"


def test_a_manifest_without_a_list_makes_no_file_one_of_its_run():
    ocean_sim.run(SEA, "run")
    manifest = json.loads(Path("run/manifest.json").read_text())
    Path("run/manifest.json").write_text(json.dumps({key: manifest[key] for key in manifest if key != "files"}))
    before = names("run")
    with pytest.raises(Refused, match="this file is not of the run that is there"):
        ocean_sim.run(LESS, "run", overwrite=True)
    assert names("run") == before


@pytest.mark.parametrize("entry", ["../mine.txt", "{here}/mine.txt", "*", "*.txt", "run/../../mine.txt", 3])
def test_no_entry_of_a_manifest_reaches_what_no_run_has_written(entry):
    Path("mine.txt").write_text("mine")
    Path("run").mkdir()
    Path("run/mine.txt").write_text("mine")
    entry = entry.format(here=os.getcwd()) if isinstance(entry, str) else entry
    Path("run/manifest.json").write_text(json.dumps({"files": [entry]}))
    run_files.delete_run(Path("run"))
    assert names("run") == {"mine.txt"} and Path("mine.txt").exists()


def test_the_library_leaves_a_folder_of_other_things_alone():
    Path("mine").mkdir()
    Path("mine/a.txt").write_text("mine")
    for overwrite in (False, True):
        with pytest.raises(Refused, match="this folder holds other things"):
            ocean_sim.run(LESS, "mine", overwrite=overwrite)
    assert names("mine") == {"a.txt"}


def test_a_file_is_hashed_by_its_content_whatever_its_times_say(monkeypatch):
    from ocean_sim.files import input_file

    path, reads = Path("c.csv"), []
    content = input_file.read_bytes
    monkeypatch.setattr(input_file, "read_bytes", lambda path, *more: reads.append(path) or content(path, *more))
    path.write_text("one")
    os.utime(path, (1.0, 1.0))
    first = file_digest(path)
    assert file_digest(path) == first
    path.write_text("two")
    os.utime(path, (1.0, 1.0))
    assert file_digest(path) != first and len(reads) == 3


def test_a_scene_whose_file_has_changed_is_loaded_again():
    Path("c.csv").write_text("time_s,throttle,rudder_rad\n0,1.0,0\n10,1.0,0\n")
    scene = ocean_sim.load({**LESS, "ship": {"kind": "otter", "controls": {"file": "c.csv"}}})
    with ocean_sim.Simulation(scene) as simulation:
        simulation.step()
    assert scene.inputs() == {"c.csv": file_digest("c.csv")}
    Path("c.csv").write_text("time_s,throttle,rudder_rad\n0,0.5,0\n10,0.5,0\n")
    with pytest.raises(Refused, match=r"c\.csv: this file has changed since the scene was loaded"):
        ocean_sim.Simulation(scene)


NUMBERS = [float("nan"), float("inf"), -1.0, "1", None, True, [1.0]]


@pytest.mark.parametrize("until", NUMBERS)
def test_a_run_ends_at_a_time(until):
    with ocean_sim.Simulation(ocean_sim.load(LESS)) as simulation:
        with pytest.raises(ValueError, match=r"until: .* is not a finite number of at least 0"):
            simulation.run(until)
        assert simulation.outcome == "running"
        simulation.run(np.float32(0.05))
        assert simulation.outcome == "done" and simulation.time >= 0.05


@pytest.mark.parametrize("source", [None, b"sea.yaml", 3, ["sea.yaml"]])
def test_what_is_no_scene_is_said(source):
    with pytest.raises(Refused, match="load: source is the name or the file of a scene, or a dict"):
        ocean_sim.load(source)
    for wrong in (lambda: ocean_sim.load(LESS, {1: 2}), lambda: ocean_sim.load(LESS, "seed=1")):
        with pytest.raises(Refused, match="load: overrides is a dict"):
            wrong()
    with pytest.raises(Refused, match=r"takes a scene that ocean_sim\.load has read"):
        ocean_sim.Simulation(source)
    with pytest.raises(Refused, match="run: out is the name of a folder"):
        ocean_sim.run(LESS, None)
    with pytest.raises(Refused, match="view takes a simulation"):
        ocean_sim.view(None)


def test_numbers_of_numpy_and_paths_are_taken_as_they_are_meant():
    gauge = {"elevation": {"a": np.array([0.5, 0.0])}}
    given = LESS | {"seed": np.int64(3), "duration": np.float64(0.2), "gauges": gauge, "title": Path("a/b")}
    meant = LESS | {"seed": 3, "gauges": {"elevation": {"a": [0.5, 0.0]}}, "title": "a/b"}
    assert ocean_sim.load(given).resolved() == ocean_sim.load(meant).resolved()
    assert ocean_sim.load(LESS, {"seed": np.int64(3)}).seed == 3
