"""Estimates by `check` and `run` of a scene's time and memory, against the run itself."""

import json
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from subprocess import Popen
from time import sleep
from types import SimpleNamespace

import pytest

from ocean_sim import machine
from ocean_sim.__main__ import run_command_line
from ocean_sim.observers import render
from ocean_sim.pictures.stage import opengl
from ocean_sim.reading.scene import load
from ocean_sim.verbs.check import memory_text, picture_time, preflight, wall_time
from ocean_sim.verbs.shared import history
from tests.processes import children

OPEN = {"length": 60.0, "width": 60.0, "depth": 30.0, "walls": "none"}
JONSWAP = {"kind": "jonswap", "significant_wave_height": 0.5, "peak_period": 4.0}
TANK = {"basin": {"length": 4.0, "depth": 1.0}, "fluid": {"kind": "delta_sph", "spacing": 0.1}, "surface": "cloth"}
UNDRAWN = {"duration": 10.0, "render": None, "time_step": {"kind": "fixed", "dt": 0.002}}


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """A machine on which nothing has run."""
    monkeypatch.setattr(machine, "cache_directory", lambda: tmp_path)
    return tmp_path


def keep(config, step: float, start: float = 2.0) -> None:
    """Store the wall times [s] of a run, as one that ends does."""
    history.keep_run_times(config, SimpleNamespace(step_time=step, summary=lambda: {"wall_s": {"start": start}}))


def steps(**overrides: object) -> float | None:
    """Measured estimate of the wall time of the steps of a tank [s]; None where it is a guess."""
    found = preflight(load(TANK | UNDRAWN, overrides))
    return found["estimated_by_part"]["steps_s"] if found["estimate_is_measured"] else None


def test_the_time_of_steps_is_a_guess_until_such_water_has_run_and_then_goes_with_particles_and_steps(cache):
    config = load(TANK | UNDRAWN)
    found = preflight(config)
    assert found["estimated_wall_s"] > 0.0 and not found["estimate_is_measured"]
    assert "a guess, for an idle machine, until delta_sph in 2-D has run on it" in wall_time(found, config)
    keep(config, 0.003)
    assert steps() == pytest.approx(0.003 * 5000)
    assert steps(duration=20.0) == pytest.approx(2.0 * steps())
    found = preflight(config)
    assert wall_time(found, config).startswith(
        "about 17.0 s for 10 s (start 2.0 s, steps 15.0 s), by the run of delta_sph"
    )
    assert 2.0 * steps() < steps(**{"fluid.spacing": 0.05}) < 4.0 * steps()
    keep(load(TANK | UNDRAWN, {"fluid.spacing": 0.05}), 0.02)  # each size has times of its own
    assert steps() == pytest.approx(0.003 * 5000) and steps(**{"fluid.spacing": 0.05}) == pytest.approx(0.02 * 5000)
    keep(config, 0.001)
    assert steps() == pytest.approx(0.001 * 5000)


def test_the_time_of_pictures_goes_with_the_last_film_of_the_machine(cache):
    config = load(COLUMN | DRAWN)
    alone, before = picture_time(load(COLUMN | DRAWN, {"render.film": False})), picture_time(config)
    history.keep_picture_ratio(config, 3.0 * (before - alone))
    assert picture_time(config) == pytest.approx(3.0 * before)
    history.keep_picture_ratio(config, None)  # too few pictures were drawn after the run
    history.keep_picture_ratio(load(COLUMN | DRAWN, {"render": None}), 1.0)
    assert picture_time(config) == pytest.approx(3.0 * before)
    flat = load(TANK | DRAWN)
    assert picture_time(flat) == sum(part.picture_time(flat.preflight) for part in flat.observers.values())


@pytest.mark.parametrize(
    "other",
    [
        {"fluid.kind": "mueller"},
        {"basin.width": 1.0},
        {"runtime.arch": "cuda"},
        {"runtime.precision": "f64"},
        {"runtime.threads": 7},
        {"runtime.library": "quadrants"},
    ],
)
def test_a_rate_is_of_one_kind_of_water_dimension_and_backend(cache, other):
    keep(load(TANK | UNDRAWN), 0.003)
    assert steps() is not None and steps(**other) is None


def test_water_without_particles_has_a_time_a_step(cache):
    sea = {"basin": OPEN, "fluid": {"kind": "linear_waves", "spectrum": JONSWAP}} | UNDRAWN
    keep(load(sea), 0.001)
    assert preflight(load(sea))["estimated_wall_s"] == pytest.approx(2.0 + 0.001 * 5000)


@pytest.mark.parametrize("text", ["", "[1, 2]", '{"half'])
def test_a_file_that_cannot_be_read_says_nothing_and_is_replaced(cache, text):
    history.rate_file().write_text(text)
    assert steps() is None
    keep(load(TANK | UNDRAWN), 0.003)
    assert steps() is not None


def test_a_cache_that_cannot_be_written_is_no_failure(cache, monkeypatch):
    (cache / "file").write_text("where the folder should be")
    monkeypatch.setattr(machine, "cache_directory", lambda: cache / "file")
    keep(load(TANK | UNDRAWN), 0.003)
    assert steps() is None


@pytest.mark.parametrize("way", ["check --time", "run"])
def test_a_run_and_a_check_with_time_make_the_time_known(taichi_cpu, cache, tmp_path, capsys, way):
    """The estimate lies within ten times of what is measured beside other work."""
    scene = tmp_path / "scene.yaml"
    scene.write_text(json.dumps(TANK | UNDRAWN | {"duration": 0.1}))
    verb, *options = way.split()
    folder = ["--out", str(tmp_path / "run")] if verb == "run" else []
    assert run_command_line([verb, str(scene), *options, "--json", *folder]) == 0
    answer = json.loads(capsys.readouterr().out)
    wall = preflight(load(scene))["estimated_wall_s"]
    assert wall is not None and (wall == answer["estimated_wall_s"] if folder == [] else wall < 60.0)
    assert (tmp_path / "run").exists() == (verb == "run")


def test_a_picture_in_2d_takes_less_than_one_in_3d(cache):
    def pictures(**basin: float) -> float:
        tank = {"length": 4.0, "depth": 1.0} | basin
        scene = load({"basin": tank, "fluid": {"kind": "delta_sph", "spacing": 0.25}})
        return preflight(scene)["estimated_by_part"]["pictures_s"]

    assert 0.0 < pictures() < 0.25 * pictures(width=4.0)


COLUMN = {  # a tank with a box in it
    "basin": {
        "length": 3.2,
        "width": 1.0,
        "depth": 1.0,
        "obstacles": [{"min": [0.6, -1.0, -0.2], "max": [0.8, -0.8, 0.2]}],
    },
    "fluid": {"kind": "mueller", "spacing": 0.1, "fill": [{"min": [-1.6, -1.0, -0.5], "max": [-0.4, -0.4, 0.5]}]},
    "surface": "marching_cubes",
}
SEA = {"basin": OPEN, "fluid": {"kind": "linear_waves", "spectrum": JONSWAP}}
DRAWN = {"duration": 0.3, "frames": {"every": 0.01}, "render": {"every": 0.01, "size": [640, 360]}}  # 31 pictures


def of_pictures(scene: dict, **overrides: object) -> int:
    """Bytes that the pictures of a run are said to take."""
    [row] = [row for row in load(scene | DRAWN, overrides).ledger() if row.part == "render"]
    return row.bytes


def test_memory_has_a_row_of_the_processes_that_draw(monkeypatch):
    """Without pictures nothing; the larger and the finer they are, the more; as much again for a second process."""
    monkeypatch.setattr(render, "available_cores", lambda: 1)
    one, whole = of_pictures(COLUMN), preflight(load(COLUMN | DRAWN))
    without = preflight(load(COLUMN | DRAWN, {"render": None}))
    assert whole["memory_mb"] - without["memory_mb"] == pytest.approx(one / 1e6) == whole["pictures_mb"]
    assert memory_text(whole).endswith(f" MB ({one / 1e6:.0f} of them for pictures)")
    assert memory_text(without).endswith(" MB")
    assert of_pictures(COLUMN, frames=None) == 0 and of_pictures(COLUMN, **{"render.film": False}) < one
    assert one < of_pictures(COLUMN, **{"render.size": [1280, 720]})
    assert one < of_pictures(COLUMN, **{"render.quality": "final"})
    assert of_pictures(SEA, **{"render.far_sea": False}) < of_pictures(SEA)
    monkeypatch.setattr(render, "available_cores", lambda: 2)
    assert 1.7 * one < of_pictures(COLUMN) < 2.0 * one
    assert preflight(load(COLUMN | DRAWN))["most_particles"] < without["most_particles"]
    card = {"runtime.arch": "cuda"}
    rooms = [preflight(load(COLUMN | DRAWN, card | more))["most_particles"] for more in ({}, {"render": None})]
    assert rooms[0] == rooms[1]  # what is drawn does not lie where the water does


def tree(process: int) -> Iterator[int]:
    """A process and all below it."""
    yield process
    for child in children(process):
        yield from tree(child)


def resident(process: int) -> int:
    """Bytes of a process, its share of what it holds together with others; 0 once it has ended."""
    with suppress(OSError):
        rows = Path(f"/proc/{process}/smaps_rollup").read_text().splitlines()
        return sum(1024 * int(row.split()[1]) for row in rows if row.startswith("Pss:"))
    return 0


@pytest.mark.slow  # half a minute each
@pytest.mark.skipif(not Path("/proc/self/smaps_rollup").exists(), reason="only Linux tells the memory of others")
@pytest.mark.skipif(opengl.probe() is not None, reason="no OpenGL on this machine")
@pytest.mark.parametrize("size", [(640, 360), (1280, 720)])
@pytest.mark.parametrize("scene", [COLUMN, SEA, TANK], ids=["tank", "sea", "slice"])
def test_a_run_takes_the_memory_that_it_was_said_to_take(scene, size, tmp_path):
    """With its film, all processes together, at their peak."""
    config = load(scene | DRAWN, {"render.size": list(size)})
    file, most = tmp_path / "scene.yaml", 0
    file.write_text(json.dumps(config.resolved()))
    command = [sys.executable, "-m", "ocean_sim", "run", str(file), "--quiet", "--out", str(tmp_path / "run")]
    with Popen(command) as child:
        while child.poll() is None:
            most = max(most, sum(map(resident, tree(child.pid))))
            sleep(0.1)
    assert child.returncode == 0 and (tmp_path / "run" / "film.mp4").exists()
    told = 1e6 * preflight(config)["memory_mb"]
    print(f"\n{most / 1e6:.0f} MB, {told / 1e6:.0f} MB told: {most / told:.2f}")
    assert 1.0 / 1.5 < most / told < 1.5
