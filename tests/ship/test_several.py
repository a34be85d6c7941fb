"""Several ships in one scene: what each feels of the others, and that one by name is the same as one without."""

import json
from pathlib import Path

import numpy as np
import pytest

from ocean_sim import load, run
from ocean_sim.conventions import Diverged
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.fluid.patch.relaxation_zone import rim_depth
from ocean_sim.observers import motion
from ocean_sim.pictures.stage import opengl
from ocean_sim.reading.keys import scene_schema
from ocean_sim.reading.scene import observer_names
from ocean_sim.result import Result
from ocean_sim.simulation import Simulation
from ocean_sim.state import checkpoint_file
from tests.conftest import Start

with_opengl = pytest.mark.skipif(opengl.probe() is not None, reason="no OpenGL on this machine")
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
    return (result.folder / motion.log_name(ship)).read_bytes()


def test_a_barge_rolls_in_the_waves_of_another_and_not_where_they_do_not_reach(abreast):
    near, far = (np.degrees(abreast[name].motions["b"]["roll_rad"]) for name in ("near", "far"))
    assert np.abs(near).max() > 0.04 and np.abs(far).max() < 1e-6
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
        with pytest.raises(ValueError, match="several ships: a, b"):
            _ = simulation.ship
        whole, felt = simulation.fluid, simulation.water_at_ships[0]
        own = next(made for made in whole.made if made.ship is simulation.ships["a"])
        for _ in range(20):
            simulation.step()
        under = np.array([[0.0, 0.0]])
        assert own not in felt.tiles and own in simulation.water_at_ships[1].tiles
        assert whole.elevations(under)[0] < -1.0 < -0.1 < felt.elevations(under)[0]  # her draught is in her own waves


@pytest.mark.parametrize("precision", ["f32", pytest.param("f64", marks=pytest.mark.slow)])
def test_the_threads_change_no_byte(precision, tmp_path):
    waves = CALM | {"height": 0.5, "period": 4.0, "heading_deg": 30.0}
    scene = at_sea({"a": BARGE | PUSHED, "b": BARGE | {"position": [APART, 0.0]}}, waves, 1.0)
    keys = {"runtime.precision": precision}
    one, two = (logs(scene, tmp_path / str(n), **keys, **{"runtime.threads": n}) for n in (1, 2))
    assert list(one) == ["motion_a.csv", "motion_b.csv"] and one == two


@pytest.mark.slow
def test_a_run_that_goes_on_from_a_checkpoint_leaves_the_same_bytes(tmp_path):
    from ocean_sim.observers.checkpoint import restore

    scene = at_sea({"a": BARGE | PUSHED, "b": BARGE | {"position": [APART, 0.0]}}, checkpoint={"every": 1.0})
    scene |= {"platform": {"kind": "hexapod", "ship": "b"}, "platform_log": {}, "frames": {"every": 0.5}}
    config = load(scene, {"runtime.threads": 1})
    run(config, tmp_path / "whole")
    folder = tmp_path / "cut"
    folder.mkdir()
    with Simulation(config, folder) as simulation:
        simulation.run(1.2)
    (tmp_path / "away").mkdir()
    with Simulation(config, tmp_path / "away") as simulation:
        restore(simulation, checkpoint_file.read_checkpoint(next(checkpoint_file.checkpoint_files(folder))), folder)
        simulation.run(config.duration)
    for name in ("motion_a.csv", "motion_b.csv", "platform.csv"):
        assert (folder / name).read_bytes() == (tmp_path / "whole" / name).read_bytes(), name
    whole, cut = (json.loads((path / "manifest.json").read_text()) for path in (tmp_path / "whole", folder))
    assert whole["state_sha256"] == cut["state_sha256"]


@pytest.mark.anchor
def test_two_ships_among_particles_push_each_other_through_the_water_and_momentum_is_kept():
    """Boxes of kind `pressure` in a slice without walls or gravity to speak of: one is driven into the water, which
    moves the other; what one of them is held back from is the negative control."""
    water = {"kind": "delta_sph", "spacing": 0.1, "compression": 0.01, "reference_speed": 3.0}
    water |= {"fill": [{"min": [-1.5, -0.7], "max": [1.5, -0.1]}]}
    tank = {"length": 8.0, "depth": 2.0, "gravity": [0.0, -1e-15, 0.0], "walls": "none", "floor": "none"}
    still = {"position": [0.7, -0.4, 0.0]}
    scene = {"duration": 0.2, "basin": tank, "fluid": water, "runtime": {"precision": "f64", "threads": 1}}
    scene |= OFF | {"motion": None, "ships": {"a": box(-0.7, position=[-0.7, -0.4, 0.0], velocity=[1.0, 0.0, 0.0])}}
    scene["ships"]["b"] = box(0.0, **still)
    with Simulation(load(scene)) as simulation:
        before, start = momentum(simulation), Start(simulation)
        simulation.run(0.2)
        a, b = (ship.body for ship in simulation.ships.values())
        assert a.velocity[0] < 0.9 and b.velocity[0] > 0.005
        assert np.abs(momentum(simulation) - before).max() < 1e-11 * np.abs(before).max()
        start.put_back()
        simulation.ships["b"].free[:] = False
        simulation.run(0.2)
        assert np.abs(momentum(simulation) - before).max() > 1e-3 * np.abs(before).max()


@pytest.mark.slow
def test_two_ships_in_contact_with_particles_keep_momentum_and_each_has_her_impulse_in_the_accounts():
    """Two boxes that are shot into a block of water that presses, from above and from the side."""
    water = {"kind": "delta_sph", "spacing": 0.1, "compression": 0.01, "reference_speed": 3.0}
    water |= {"fill": [{"min": [-0.6, -0.9, -0.3], "max": [0.6, -0.5, 0.3]}]}
    tank = {"length": 3.0, "width": 2.0, "depth": 1.2, "gravity": [0.0, -1e-15, 0.0], "walls": "none", "floor": "none"}
    shape = {"kind": "box", "length": 0.4, "breadth": 0.4, "height": 0.3}
    hull = {"shape": shape, "mass": 60.0, "centre_of_mass": [0.0, 0.15, 0.0], "inertia": [2.0, 2.0, 2.0]}
    ship = {"kind": "thesis", "hull": hull, "linear_damping": 0.0, "angular_damping": 0.0}
    ships = {
        "a": ship | {"position": [-0.3, -0.25, 0.0], "velocity": [0.0, -2.0, 0.1]},
        "b": ship | {"position": [0.9, -0.7, 0.0], "velocity": [-2.0, 0.0, 0.0]},
    }
    scene = {"duration": 0.1, "basin": tank, "fluid": water, "surface": "cloth", "ships": ships}
    scene |= OFF | {"motion": None, "time_step": {"kind": "fixed", "dt": 0.002}, "runtime": {"precision": "f64"}}
    with Simulation(load(scene, {"runtime.threads": 1})) as simulation:
        before = momentum(simulation)
        simulation.run(0.1)
        met = [ship.contact.impulse[0] for ship in simulation.ships.values()]
        assert met[0][1] > 5.0 and met[1][0] > 5.0
        assert np.abs(momentum(simulation) - before).max() < 1e-11 * 120.0
        given = sum(contact.given for contact in simulation.fluid.contacts)
        np.testing.assert_allclose(given, -sum(met), atol=1e-10)


@pytest.mark.parametrize(
    ("keys", "sentence"),
    [
        ({"ship": "yacht"}, "ship: give either `ship` or `ships`, not both"),
        ({"ships": ["yacht"]}, "ships: expected a mapping of names to ships, got a list"),
        ({"ships": {"2nd": "yacht"}}, "ships.2nd: '2nd' is not a name: letters, digits and _, a letter first"),
        ({"ships": {"ship": "yacht"}}, "ships.ship: 'ship' is the name of the only ship of a scene; choose another"),
        ({"ships": {"a": "yaht"}}, "ships.a: no ship 'yaht'; did you mean 'yacht'?"),
        ({"ships": {"a": {"kind": "yacht", "mas": 1.0}}}, "ships.a.mas: unknown key; did you mean 'mass'?"),
        (
            {"ships": {"a": {"kind": "pressure", "hull": "wigley"}}},
            "ships.a: water of kind spectral_sea does not carry",
        ),
        (
            {"ships.b.position": [4.0, 2.0]},
            "ships.b.position: the hulls of a and b reach 4 m into each other; move one",
        ),
        ({"ships.b.position": [400.0, 0.0]}, "ships.b.position: x = 400 m is outside the basin"),
        ({"platform": {"kind": "hexapod", "ship": "c"}}, "platform.ship: this scene has no ship 'c'; there are a, b"),
        ({"render": {"ship": "c"}, "frames": {}}, "render.ship: this scene has no ship 'c'; there are a, b"),
        ({"motion.point": "mast"}, "motion.point: a has no point 'mast'; it names none"),
    ],
)
def test_what_is_wrong_with_ships_is_one_sentence_each(keys, sentence):
    scene = at_sea({"a": BARGE, "b": BARGE | {"position": [APART, 0.0]}})
    whole = {key: value for key, value in keys.items() if "." not in key}
    with pytest.raises(SceneError) as refused:
        load(scene | whole, {key: value for key, value in keys.items() if "." in key})
    assert any(str(problem).removeprefix("scene: ").find(sentence) >= 0 for problem in refused.value.problems), str(
        refused.value
    )


def test_ships_are_set_one_by_one_and_dumped_as_they_were():
    scene = at_sea({"a": "barge20", "b": {"kind": "barge20", "position": [APART, 0.0]}})
    sets = {"ships.a.position": [-5.0, 0.0], "ships.c.kind": "otter", "ships.c.position": [60.0, 0.0], "ships.b": None}
    config = load(scene, sets)
    assert list(config.ships) == ["a", "c"] and config.ships["a"].position == (-5.0, 0.0)
    dump = config.resolved()
    assert list(dump["ships"]) == ["a", "c"] and "ship" not in dump
    assert json.dumps(load(dump).resolved()) == json.dumps(dump)
    rows = {row.part: row.what for row in config.ledger()}
    assert "cubes of the hull" in rows["ships.a"] and "Otter" in rows["ships.c"]
    assert rows["motion"] == "motion_a.csv, motion_c.csv"
    assert any(sentence.startswith("ships.c: the Otter's model") for sentence in config.warnings())
    assert load(scene, {"ships": None, "motion": None}).resolved()["ship"] is None
    assert scene_schema()["properties"]["ships"]["anyOf"][0]["type"] == "object"


def test_the_longest_step_is_that_which_every_ship_bears():
    small = BARGE | {"hull": {"shape": {"kind": "box", "length": 2.0, "breadth": 1.0, "height": 1.0}, "mass": 900.0}}
    both = {"a": BARGE, "b": small | {"position": [APART, 0.0]}}
    with Simulation(load(at_sea(both, {"kind": "linear_waves", "height": 0.0, "period": 9.0}))) as simulation:
        forces = [ship.limits().force for ship in simulation.ships.values()]
        assert forces[1] < forces[0] and simulation.limits().force == forces[1]


def test_a_run_in_which_hulls_come_to_overlap_stops_with_what_where_and_when(tmp_path):
    ships = {"a": BARGE, "b": BARGE | {"position": [18.0, 0.0], "velocity": [-4.0, 0.0, 0.0]}}
    scene = at_sea(ships, {"kind": "linear_waves", "height": 0.0, "period": 9.0}, 10.0)
    with pytest.raises(Diverged) as stopped:
        run(load(scene, {"runtime.threads": 1}), tmp_path / "run")
    sentence = str(stopped.value)
    assert sentence.startswith("the hulls of a and b reach 0.") and "m into each other at (" in sentence
    assert "contact between hulls is not modelled: keep them apart" in sentence and ", step " in sentence
    assert Result(tmp_path / "run").events[-1]["event"] == "stopped"


def test_a_platform_rides_in_the_ship_that_it_names(tmp_path):
    ships = {"a": BARGE, "b": BARGE | PUSHED | {"position": [APART, 0.0]}}
    calm = {"kind": "linear_waves", "height": 0.0, "period": 9.0}
    moved = {}
    for name in ("a", "b", None):
        keys = {"platform": {"kind": "hexapod", "ship": name, "ramp": 0.0}, "platform_log": {}}
        config = load(at_sea(ships, calm, 1.0, **keys), {"runtime.threads": 1})
        assert any("rides in a, the first" in sentence for sentence in config.warnings()) == (name is None)
        moved[name] = np.abs(run(config, tmp_path / str(name)).table("platform")["roll_rad"]).max()
    assert moved["a"] == moved[None] < 1e-6 < 1e-3 < moved["b"]


def test_frames_keep_every_ship_and_cameras_follow_the_one_that_is_named(tmp_path, capsys):
    from ocean_sim.__main__ import run_command_line
    from ocean_sim.observers import render
    from ocean_sim.pictures.frame_files import Frame, FrameLog, frame_files

    ships = {"a": BARGE | {"velocity": [0.0, 0.0, 2.0]}, "b": BARGE | {"position": [APART, 0.0]}}
    ships["c"] = {"kind": "otter", "position": [60.0, 0.0]}
    calm = {"kind": "linear_waves", "height": 0.0, "period": 9.0}
    keys = {"frames": {"every": 0.5, "spacing": 20.0}}
    folder = run(load(at_sea(ships, calm, 1.0, **keys), {"runtime.threads": 1}), tmp_path / "run").folder
    files = frame_files(folder)
    tracks = FrameLog(files).tracks
    assert list(Frame(files[0]).ships) == list(tracks) == ["ships.a", "ships.b"]  # the otter has no hull to draw
    assert tracks["ships.a"].position[-1, 2] > 1.0 and abs(tracks["ships.b"].position[:, 0] - APART).max() < 1e-3
    assert render.obstacle_to_pictures(folder, "follow", (), "b") is None
    assert run_command_line(["render", str(folder), "--ship", "d"]) == 2
    assert "this run draws no ship 'd'; there is a, b" in capsys.readouterr().err


@pytest.mark.slow
@with_opengl
def test_every_ship_is_drawn_and_each_meets_the_water(tmp_path):
    """Seen from above: a picture of both barges differs from that of one where the other lies, and nowhere else."""
    from ocean_sim.observers import render

    pictures, calm = [], {"kind": "linear_waves", "height": 0.0, "period": 9.0}
    for name, ships in {"one": {"a": BARGE}, "both": {"a": BARGE, "b": BARGE | {"position": [APART, 0.0]}}}.items():
        keys = {"frames": {"every": 0.1, "spacing": 4.0}}
        run(load(at_sea(ships, calm, 0.1, **keys), {"runtime.threads": 1}), tmp_path / name)
        options = {"camera": "fixed", "eye": (12.0, 60.0, 0.0), "target": (12.0, 0.0, 0.1), "caption": False}
        [image] = render.variants(tmp_path / name, 0.0, [options], size=(160, 90))
        pictures.append(image.astype(float))
    changed = np.abs(pictures[1] - pictures[0]).max(axis=2) > 25.0
    half = changed.shape[1] // 2
    sides = sorted([changed[:, :half].sum(), changed[:, half:].sum()])
    assert sides[1] > 200 and sides[0] < 0.02 * sides[1]


def test_a_preview_shows_every_hull_and_keys_steer_the_ship_that_the_panel_names():
    from ocean_sim.pictures.live.panel import Panel
    from ocean_sim.pictures.live.preview_scene import PreviewScene

    calm = {"kind": "linear_waves", "height": 0.0, "period": 9.0}
    with Simulation(load(at_sea({"a": BARGE, "b": BARGE | {"position": [APART, 0.0]}}, calm))) as simulation:
        hulls = PreviewScene(simulation).ship_patch()
        assert hulls is not None and np.ptp(hulls.vertices[:, 0]) > APART
        assert hulls.triangles.max() == len(hulls.vertices) - 1
        panel = Panel(ships=tuple(simulation.ships), ship="a")
        panel.hold({"Up"}, 0.1)
        assert panel.take("helm")
        panel.person = simulation.ships[panel.ship].hand_over()
        panel.hold({"Up"}, 1.0)
        panel.press("h")
        assert panel.ship == "b" and panel.person is None
        simulation.run(0.2)
        assert simulation.ships["a"].orders[0] > 0.0 == simulation.ships["b"].orders[0]
        panel.press("h")
        assert panel.ship == "a"


@pytest.mark.slow
def test_a_hull_over_particles_does_not_read_the_hole_that_another_one_makes():
    """Two boxes four spacings apart in still water keep upright; shown the hole of the other, each would heel."""
    water = {"kind": "mueller", "spacing": 0.1, "kinematic_viscosity": 0.01, "compression": 0.008}
    hull = {"shape": {"kind": "box", "length": 0.6, "breadth": 0.6, "height": 0.5}, "mass": 108.0}
    ship = {"kind": "hydrostatic", "hull": hull | {"centre_of_mass": [0.0, 0.15, 0.0]}}
    ships = {"a": ship | {"position": [-0.5, 0.0]}, "b": ship | {"position": [0.5, 0.0]}}
    tank = {"length": 2.6, "width": 1.6, "depth": 0.6}
    scene = (
        {"duration": 0.1, "basin": tank, "fluid": water, "surface": "cloth", "ships": ships} | OFF | {"motion": None}
    )
    with Simulation(load(scene, {"runtime.threads": 1})) as simulation:
        torques = {}
        for beside in (True, False):
            if not beside:
                for one in simulation.ships.values():
                    one.water.others = ()
                    one.cubes = type(one.cubes)(one.hydrostatics)  # its kernels anew
            for name, one in simulation.ships.items():
                load_on = one.load(simulation.wind_on_ship, simulation.fluid, simulation.surface)
                torques[name, beside] = float(load_on.torque[2])
    scale = 108.0 * 9.81 * 0.3
    assert max(abs(torques[name, True]) for name in "ab") < 0.02 * scale
    assert torques["a", False] * torques["b", False] < 0.0
    assert min(abs(torques[name, False]) for name in "ab") > 2.0 * max(abs(torques[name, True]) for name in "ab")


def test_a_ship_nearer_round_the_patch_is_not_in_the_rim():
    """On a patch of 100 m with a rim of 20 m on either side of the seam: 90 m away one way is 10 m the other way."""
    away = np.array([[0.0, 0.0], [29.0, 0.0], [31.0, 0.0], [50.0, 0.0], [90.0, 0.0], [0.0, 45.0]])
    both, slice_ = np.array([100.0, 100.0]), np.array([100.0, 0.0])
    assert rim_depth(away, both, 20.0) == pytest.approx([-30.0, -1.0, 1.0, 20.0, -20.0, 15.0])
    assert rim_depth(away, slice_, 20.0) == pytest.approx([-30.0, -1.0, 1.0, 20.0, -20.0, -30.0])


def test_the_order_in_which_ships_are_written_changes_no_byte(tmp_path):
    ships = {
        "b": BARGE | PUSHED,
        "a": BARGE | {"position": [APART, 0.0]},
        "c": BARGE | {"position": [0.0, 30.0], "attitude_deg": [0.0, 0.0, 5.0]},
    }
    there = logs(at_sea(ships), tmp_path / "there")
    assert logs(at_sea(dict(reversed(ships.items()))), tmp_path / "back") == there
