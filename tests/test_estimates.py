"""What `check` and `run` estimate of a scene's time and memory, against what it takes."""

import json
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage
from subprocess import Popen, run
from time import process_time, sleep

import numpy as np
import pytest

from ocean_sim.observers import render
from ocean_sim.pictures.stage import opengl
from ocean_sim.reading.scene import SceneConfig, load
from ocean_sim.simulation import Simulation
from ocean_sim.verbs.check import memory_taken, preflight, wall_time
from tests.processes import children

OPEN = {"length": 60.0, "width": 60.0, "depth": 30.0, "walls": "none"}
JONSWAP = {"kind": "jonswap", "significant_wave_height": 0.5, "peak_period": 4.0}
KEPT = {"frames": {"spacing": 1.0}, "render": None}


def steps(scene: dict, **overrides: object) -> float:
    """Estimated time of the steps [s]."""
    return preflight(load(scene, overrides))["estimated_by_part"]["steps_s"]


def taken(scene: SceneConfig, folder, count: int) -> float:
    """Processor time of a step [s], kernels compiled."""
    with Simulation(scene, folder) as simulation:
        simulation.run(3.0 * simulation.next_dt)
        before, first = simulation.steps, process_time()
        simulation.run(simulation.time + count * simulation.next_dt)
        return (process_time() - first) / (simulation.steps - before)


@pytest.mark.parametrize("kind", ["linear_waves", "spectral_sea"])
def test_a_sea_without_particles_has_an_estimate_near_what_its_steps_take(kind, taichi_cpu, tmp_path):
    scene = load({"basin": OPEN, "fluid": {"kind": kind, "spectrum": JONSWAP}, "duration": 100.0} | KEPT)
    found = preflight(scene)
    expected = found["estimated_by_part"]["steps_s"] * found["time_step"] / scene.duration
    assert 0.25 < taken(scene, tmp_path, 30) / expected < 4.0
    assert "steps" in wall_time(found, scene) and found["estimated_wall_s"] > found["estimated_by_part"]["steps_s"]


SHIP = {"basin": OPEN, "ship": "yacht", "platform": {"kind": "hexapod"}, "render": None, "report": None}
TANK = {"basin": {"length": 4.0, "depth": 1.0}, "fluid": {"kind": "delta_sph", "spacing": 0.1}, "surface": "cloth"}
SPECTRAL = {"kind": "spectral_sea", "spectrum": JONSWAP, "cells": 64}
WATCHED = {  # scene, time [s] before it is watched and then, and who watches
    "ship": (
        SHIP | {"fluid": SPECTRAL, "frames": {"spacing": 3.0, "every": 0.2}},
        (1.1, 3.0),
        ["frames", "motion", "platform_log"],
    ),
    "tank": (TANK | {"accuracy": {"every": 0.01}, "frames": {"every": 0.02}}, (0.05, 0.3), ["accuracy", "frames"]),
}
TURNS = 3  # at most


@pytest.mark.parametrize("kind", WATCHED)
def test_observers_have_an_estimate_near_what_they_take(kind, taichi_cpu, tmp_path):
    """Within three times: it is of another machine. Others are at work on this one: of TURNS the quickest counts."""
    given, (before, after), names = WATCHED[kind]
    scene = load(given | {"duration": 10.0, "render": None})
    spent, ratios = dict.fromkeys(names, 0.0), []

    def watched(name: str, observe):
        def timed(simulation: Simulation) -> None:
            begun = process_time()
            observe(simulation)
            spent[name] += process_time() - begun

        return timed

    with Simulation(scene, tmp_path) as simulation:
        simulation.run(before)
        for observer in simulation.observers:
            name = type(observer).__module__.rpartition(".")[2]
            if name in names:
                observer.observe = watched(name, observer.observe)
        for _ in range(TURNS):
            time, steps, spent_before = simulation.time, simulation.steps, dict(spent)
            simulation.run(time + after)
            time, steps = simulation.time - time, simulation.steps - steps
            expected = [steps * sum(row.a_step(time / steps) for row in scene.ledger() if row.part == n) for n in names]
            ratios.append([(spent[n] - spent_before[n]) / each for n, each in zip(names, expected)])
            if max(ratios[-1]) < 3.0:
                break
    least, mean = np.min(ratios, axis=0), np.mean(ratios, axis=0)  # rows are handed on in blocks: a turn may have none
    assert (least < 3.0).all() and (mean > 1.0 / 3.0).all(), dict(zip(names, zip(least, mean)))


def test_frames_take_longer_with_more_waves_and_points_and_nothing_without():
    scene = {"basin": OPEN, "fluid": {"kind": "linear_waves", "height": 0.5, "period": 4.0}, "duration": 20.0} | KEPT
    many = scene | {"fluid": {"kind": "linear_waves", "spectrum": JONSWAP}}
    assert steps(many) > 1.5 * steps(scene)
    assert steps(many, **{"frames.spacing": 0.5}) > 1.5 * steps(many)  # two times was measured
    assert steps(many, frames=None) < 0.2 * steps(many)
    wide = steps(many, **{"frames.spacing": None})  # a sixteenth of the highest wave
    assert steps(many, **{"frames.spacing": 2.0}) < wide < steps(many)


def test_a_picture_in_2d_takes_less_than_one_in_3d():
    def pictures(**basin: float) -> float:
        tank = {"length": 4.0, "depth": 1.0} | basin
        return preflight(load({"basin": tank, "fluid": {"kind": "delta_sph", "spacing": 0.25}}))["estimated_by_part"][
            "pictures_s"
        ]

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
    assert memory_taken(whole).endswith(f" MB ({one / 1e6:.0f} of them for pictures)")
    assert memory_taken(without).endswith(" MB")
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


def used() -> float:
    """Processor time [s] of all processes that this one has started and waited for."""
    used = getrusage(RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


RUNS = {"showcase": 4.0, "gallery/yacht_in_waves": 2.0}  # until [s]


@pytest.mark.slow
def test_a_run_takes_the_processor_time_that_it_was_said_to_take(tmp_path):
    """Pictures included; kernels in the cache, so the first of two runs does not count. The estimates are of one
    machine: on another all runs take more, or less, by one factor."""
    factors = {}
    for scene, until in RUNS.items():
        folder, command = tmp_path / Path(scene).name, [sys.executable, "-m", "ocean_sim", "run", scene, "--quiet"]
        run([*command, "--out", str(folder / "first"), "--until", "0.1", "--set", "render=null"], check=True)
        before = used()
        until_then = ["--until", f"{until:g}", "--set", "render.every=0.1"]
        run([*command, "--out", str(folder / "run"), *until_then], check=True)
        expected = preflight(load(scene, {"duration": until, "render.every": 0.1}))["estimated_processor_s"]
        factors[scene] = (used() - before) / expected
    assert max(factors.values()) < 1.5 * min(factors.values()), factors
    assert all(1.0 / 3.0 < factor < 3.0 for factor in factors.values()), factors
