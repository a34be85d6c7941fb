"""Several ships in one scene: what each feels of the others, and that one by name is the same as one without."""

import json
from pathlib import Path

import numpy as np
import pytest

from ocean_sim import load, run
from ocean_sim.observers import motion
from ocean_sim.reading.scene import observer_names
from ocean_sim.result import Result
from ocean_sim.simulation import Simulation
from ocean_sim.state import file

OFF = {name: None for name in observer_names() if name not in ("manifest", "health", "motion")}
SEA = {"length": 240.0, "width": 240.0, "depth": 60.0, "walls": "none"}
CALM = {"kind": "spectral_sea", "tile": 96.0, "cells": 48}
BARGE = {"kind": "dynamic", "hull": "barge20", "cells_per_draught": 4.0}
APART = 24.0  # [m] between the middles of two barges abreast
PUSHED = {"position": [0.0, 0.0], "attitude_deg": [0.0, 0.0, 12.0]}  # she rolls, and makes waves
SLICE = {"length": 4.0, "depth": 0.8}


def at_sea(ships: dict | None, fluid: dict = CALM, duration: float = 2.0, **keys) -> dict:
    """Ships in open water, two logs of whose motion can be compared byte by byte."""
    scene = {"duration": duration, "basin": SEA, "fluid": fluid, "motion": {"every": 0.05}}
    return scene | OFF | {"time_step": {"kind": "fixed", "dt": 0.05}, "ships": ships} | keys


def logs(scene: dict, folder: Path, **keys) -> dict[str, bytes]:
    """The motion logs of a run, by file."""
    run(load(scene, {"runtime.threads": 1} | keys), folder)
    return {path.name: path.read_bytes() for path in sorted(folder.glob("motion*.csv"))}


def box(x: float, **keys) -> dict:
    """A box of a slice of particles, or of a tank of them, at x [m]."""
    shape = {"kind": "box", "length": 0.6, "breadth": 0.6, "height": 0.5}
    hull = {"shape": shape, "mass": 90.0, "centre_of_mass": [0.0, 0.15, 0.0]}
    return {"kind": "pressure", "hull": hull, "position": [x, 0.0]} | keys


def momentum(simulation: Simulation) -> np.ndarray:
    """(3,) of water and ships [kg m/s]."""
    water = simulation.fluid.particles
    total = water.mass * water.velocity.to_numpy().astype(float).sum(axis=0)
    return total + sum(ship.body.mass * ship.body.velocity for ship in simulation.ships.values())


@pytest.mark.parametrize("water", [{"kind": "linear_waves", "height": 0.5, "period": 4.0}, CALM | {"order": 1}])
def test_a_ship_by_name_has_the_same_motion_as_one_without(water, tmp_path):
    ship = "yacht" if "height" in water else BARGE | PUSHED
    scene = at_sea(None, water, 1.0)
    alone = logs({key: value for key, value in scene.items() if key != "ships"} | {"ship": ship}, tmp_path / "alone")
    named = logs(scene | {"ships": {"a": ship}}, tmp_path / "named")
    assert list(alone) == ["motion.csv"] and list(named) == ["motion_a.csv"]
    assert alone["motion.csv"] == named["motion_a.csv"]
    result = Result(tmp_path / "named")
    assert list(result.motions) == ["a"] and np.ptp(result.motions["a"]["heave_m"]) > 0.0
    assert len(Result(tmp_path / "alone").motion["time_s"]) == 21


@pytest.fixture(scope="module")
def abreast(tmp_path_factory) -> dict[str, Result]:
    """A barge that rolls and makes waves: alone, and beside others."""
    folder = tmp_path_factory.mktemp("abreast")
    still = BARGE | {"position": [APART, 0.0]}
    ships = {
        "alone": {"a": BARGE | PUSHED},
        "near": {"a": BARGE | PUSHED, "b": still},
        "far": {"a": BARGE | PUSHED, "b": still | {"position": [100.0, 100.0]}},
        "without waves": {"a": BARGE | PUSHED, "b": {"kind": "manoeuvring", "position": [APART, 0.0]}},
    }
    for name, found in ships.items():
        scene = at_sea(found, duration=10.0, time_step={"kind": "fixed", "dt": 0.1})
        run(load(scene, {"runtime.threads": 1}), folder / name)
    return {name: Result(folder / name) for name in ships}


def log(result: Result, ship: str) -> bytes:
    return (result.folder / motion.file_of(ship)).read_bytes()


def test_a_barge_rolls_in_the_waves_of_another_and_not_where_they_do_not_reach(abreast):
    near, far = (np.degrees(abreast[name].motions["b"]["roll_rad"]) for name in ("near", "far"))
    assert np.abs(near).max() > 0.05 and np.abs(far).max() < 1e-6
    early = abreast["near"].motions["b"]["time_s"] < 0.5 * APART / 30.0
    assert np.abs(near[early]).max() < 0.1 * np.abs(near).max()


def test_her_own_waves_never_act_on_a_ship(abreast):
    """Far from her, or of a law of motion that makes no waves, another ship changes none of her bytes; near her, the
    waves with which it answers to hers do."""
    alone = log(abreast["alone"], "a")
    assert log(abreast["without waves"], "a") == alone
    assert log(abreast["far"], "a") == alone
    assert log(abreast["near"], "a") != alone


def test_her_own_waves_would_act_on_her_if_she_were_shown_the_whole_sea(abreast):
    """Negative control of the one before: the whole water in place of what she feels."""
    with Simulation(load(at_sea({"a": BARGE | PUSHED, "b": BARGE | {"position": [APART, 0.0]}}))) as simulation:
        whole, felt = simulation.fluid, simulation.felt[0]
        own = next(made for made in whole.made if made.ship is simulation.ships["a"])
        for _ in range(20):
            simulation.step()
        under = np.array([[0.0, 0.0]])
        assert own not in felt.tiles and own in simulation.felt[1].tiles
        assert whole.elevations(under)[0] < -1.0 < -0.1 < felt.elevations(under)[0]  # her draught is in her own waves


@pytest.mark.parametrize("precision", ["f32", "f64"])
def test_the_threads_change_no_byte(precision, tmp_path):
    waves = CALM | {"height": 0.5, "period": 4.0, "heading_deg": 30.0}
    scene = at_sea({"a": BARGE | PUSHED, "b": BARGE | {"position": [APART, 0.0]}}, waves, 1.0)
    keys = {"runtime.precision": precision}
    one, two = (logs(scene, tmp_path / str(n), **keys, **{"runtime.threads": n}) for n in (1, 2))
    assert list(one) == ["motion_a.csv", "motion_b.csv"] and one == two


def test_a_run_that_goes_on_from_a_checkpoint_leaves_the_same_bytes(tmp_path):
    from ocean_sim.observers.checkpoint import restore

    scene = at_sea({"a": BARGE | PUSHED, "b": BARGE | {"position": [APART, 0.0]}}, checkpoint={"every": 0.5})
    scene |= {"platform": {"kind": "hexapod", "ship": "b"}, "platform_log": {}, "frames": {"every": 0.5}}
    config = load(scene, {"runtime.threads": 1})
    run(config, tmp_path / "whole")
    folder = tmp_path / "cut"
    folder.mkdir()
    with Simulation(config, folder) as simulation:
        simulation.run(1.2)
    (tmp_path / "away").mkdir()
    with Simulation(config, tmp_path / "away") as simulation:
        restore(simulation, file.read(next(file.kept(folder))), folder)
        simulation.run(config.duration)
    for name in ("motion_a.csv", "motion_b.csv", "platform.csv"):
        assert (folder / name).read_bytes() == (tmp_path / "whole" / name).read_bytes(), name
    whole, cut = (json.loads((path / "manifest.json").read_text()) for path in (tmp_path / "whole", folder))
    assert whole["state_sha256"] == cut["state_sha256"]
