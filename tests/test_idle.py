"""Keys that are given and change nothing are said, each beside a scene in which it acts."""

from typing import Any

import pytest

from ocean_sim.files.yaml_file import parse_setting
from ocean_sim.reading.scene import load, packaged_scenes
from ocean_sim.validation.shared.tables import table_path

TANK = {"duration": 5.0, "basin": {"length": 8.0, "width": 8.0, "depth": 2.0}}
WATER = TANK | {"fluid": {"kind": "delta_sph", "spacing": 0.5}}
SLICE = WATER | {"basin": {"length": 8.0, "depth": 2.0}}
SEA = {
    "duration": 5.0,
    "basin": {"length": 200.0, "width": 200.0, "depth": 40.0, "walls": "none"},
    "fluid": {"kind": "linear_waves", "height": 0.0, "period": 5.0},
}
YACHT = SEA | {"ship": {"kind": "yacht", "cells_per_draught": 3.0}}
PATCH = WATER | {"basin": {"length": 8.0, "width": 8.0, "depth": 2.0, "walls": "periodic"}, "sea": "calm"}
SPHERE = {"kind": "sphere", "centre": [0.0, 0.0, 0.0], "radius": 1.0}
VOLUME = {"include": [SPHERE], "acceleration": [1.0, 0.0, 0.0]}
GUSTS = WATER | {"wind": {"kind": "gusts", "volumes": [VOLUME]}}
STRESS = WATER | {"wind": {"kind": "stress"}}
SPECTRUM = {"significant_wave_height": 0.5, "peak_period": 5.0, "seed": 3}
RANDOM = SEA | {"fluid": {"kind": "linear_waves", "spectrum": SPECTRUM}}
SHAPE = {"kind": "box", "length": 2.0, "breadth": 1.0, "height": 0.6}
BARGE = SEA | {"ship": {"kind": "dynamic", "hull": "barge20", "radiation": str(table_path("barge20_radiation"))}}
ROUTE = {"route": [[0.0, 90.0]], "speed": 3.0}
RAFT = SEA | {"ship": {"kind": "dynamic", "hull": {"shape": SHAPE, "mass": 400.0}}}
GATE = {"min": [-1.0, -2.0], "max": [0.0, 1.0], "motion": {"velocity": [0.0, 1.0, 0.0], "end": 90.0}}

IDLE = [  # a scene, changes that give an idle key, the key that is said, and changes with which it acts
    (RANDOM, {"seed": 4}, "seed", {"wind": GUSTS["wind"], "wind.volumes": [VOLUME | {"noise": [1.0, 0.0, 0.0]}]}),
    (WATER, {"runtime.arch": "cuda", "runtime.threads": 2}, "runtime.threads", {"runtime.arch": "cpu"}),
    (SLICE, {"basin.walls": {"z": "no_slip"}}, "basin.walls.z", {"basin.width": 8.0}),
    (SLICE, {"basin.walls": {"z_min": "no_slip"}}, "basin.walls.z_min", {"basin.width": 8.0}),
    (
        WATER,
        {"basin.walls": {"x": "no_slip", "x_min": "no_slip", "x_max": "reflecting"}},
        "basin.walls.x",
        {"basin.walls": {"x": "no_slip", "x_min": "reflecting"}},
    ),
    (SEA, {"basin.walls": "no_slip"}, "basin.walls", WATER),
    (SEA, {"basin.floor": "no_slip"}, "basin.floor", WATER),
    (SEA, {"basin.friction": 0.1}, "basin.friction", WATER),
    (SEA, {"basin.restitution": 0.1}, "basin.restitution", WATER),
    (
        WATER,
        {
            "basin.restitution": 0.1,
            "basin.walls": "periodic",
            "basin.floor": "none",
        },
        "basin.restitution",
        {"basin.floor": "free_slip"},
    ),
    (
        SLICE,
        {"basin.lid": {"slip": "free_slip", "velocity": [1.0, 0.0, 0.0]}},
        "basin.lid.velocity",
        {"basin.lid": {"velocity": [1.0, 0.0, 0.0]}},
    ),
    (
        SLICE,
        {"basin.motion": {"kind": "harmonic", "axis": "x", "amplitude": 0.1, "period": 2.0, "about": [0.0, 1.0]}},
        "basin.motion.about",
        {"basin.motion": {"kind": "harmonic", "axis": "roll_z", "amplitude": 0.1, "period": 2.0, "about": [0.0, 1.0]}},
    ),
    (
        SLICE,
        {"basin.obstacles": [GATE | {"motion": {"velocity": [0.0, 1.0, 0.0], "start": 50.0}}]},
        "basin.obstacles.0.motion.start",
        {"basin.obstacles": [GATE | {"motion": {"velocity": [0.0, 1.0, 0.0], "start": 1.0}}]},
    ),
    (
        PATCH | {"ship": {"kind": "pressure", "hull": {"shape": SHAPE, "mass": 400.0}}},
        {"sea": {"kind": "linear_waves", "rim": {"velocity": [1.0, 0.0]}}},
        "sea.rim.velocity",
        {"ship": None},
    ),
    (PATCH, {"sea": {"kind": "spectral_sea", "order": 1, "breaking": False}}, "sea.breaking", {"sea.order": 3}),
    (SEA, {"fluid": {"kind": "spectral_sea", "onset": 5.0}}, "fluid.onset", {"fluid.order": 3}),
    (
        WATER,
        {"fluid": {"kind": "dfsph", "spacing": 0.5, "compression": 0.02}},
        "fluid.compression",
        {"fluid.kind": "mueller"},
    ),
    (GUSTS, {"wind.noise_every": 0.1}, "wind.noise_every", {"wind.volumes": [VOLUME | {"noise": [1.0, 0.0, 0.0]}]}),
    (GUSTS, {"wind.targets": ["ship"]}, "wind.targets", {"wind.targets": ["fluid"]}),
    (
        GUSTS,
        {"wind.volumes": [VOLUME | {"targets": ["ship"]}]},
        "wind.volumes.0.targets",
        {"wind.volumes": [VOLUME | {"targets": ["fluid"]}]},
    ),
    (
        GUSTS,
        {"wind.volumes": [VOLUME | {"lift_coefficient": 0.2}]},
        "wind.volumes.0.lift_coefficient",
        {"wind.volumes": [VOLUME | {"lift_coefficient": 0.2, "wind_speed": 5.0}]},
    ),
    (
        GUSTS,
        {"wind.volumes": [VOLUME | {"redraw_strength": [0.5, 1.5]}]},
        "wind.volumes.0.redraw_strength",
        {"wind.volumes": [VOLUME | {"redraw_strength": [0.5, 1.5], "drift": 5.0}]},
    ),
    (
        GUSTS,
        {"wind.volumes": [VOLUME | {"heading_deg": 40.0}]},
        "wind.volumes.0.heading_deg",
        {"wind.volumes": [VOLUME | {"heading_deg": 40.0, "drift": 2.0}]},
    ),
    (STRESS, {"wind.pressure_gain": 2.0}, "wind.pressure_gain", {"wind.sheltering": 0.3}),
    (STRESS, {"wind.wave_speed": 2.0}, "wind.wave_speed", {"wind.sheltering": 0.3}),
    (
        STRESS,
        {"wind.u10": 12.0, "wind.schedule": [{"time": 0.0, "speed": 5.0, "heading_deg": 0.0}]},
        "wind.u10",
        {"wind.schedule": None},
    ),
    (
        YACHT,
        {"ship.propeller": {"thrust": 1.0e4, "wake": 0.2}},
        "ship.propeller.wake",
        {"ship.propeller.zero_thrust_speed": 9.0},
    ),
    (
        YACHT,
        {"ship.propeller.diameter": 0.5, "ship.rudder": None},
        "ship.propeller.diameter",
        {"ship.rudder": {"area": 0.8, "position": [0.0, 0.9, -6.5]}},
    ),
    (
        YACHT,
        {"ship.helm": {"heading_deg": 0.0, "speed": 3.0, "look_ahead": 9.0}},
        "ship.helm.look_ahead",
        {"ship.helm": ROUTE | {"look_ahead": 9.0}},
    ),
    (YACHT, {"ship.contact": {"friction": 0.2}}, "ship.contact", {"ship.contact": None}),
    (
        YACHT,
        {"ship.free": [], "ship.moorings": [{"from": [0.0, 2.0, 5.0], "to": [0.0, 0.0, 19.0], "stiffness": 1e4}]},
        "ship.moorings",
        {"ship.free": ["surge"]},
    ),
    (RAFT, {"ship.mass": 500.0}, "ship.hull.mass", {"ship.mass": None}),
    (BARGE, {"ship.added_mass": {"heave": 1.0e5}}, "ship.added_mass.heave", {"ship.radiation": None}),
    (
        YACHT,
        {"ship.controls": [{"time": 0.0, "throttle": 0.5}], "ship.propeller": None},
        "controls: the throttle that they ask for",
        {"ship.controls": []},
    ),
    (
        YACHT,
        {"ship.controls": [{"time": 0.0, "rudder": 0.5}], "ship.rudder": None},
        "controls: the rudder that they ask for",
        {"ship.controls": []},
    ),
    (YACHT, {"platform": "hexapod_a", "motion": None}, "platform", {"motion": {}}),
    (SEA, {"health": {"max_level_ratio": 1.5}}, "health.max_level_ratio", WATER),
    (SEA, {"frames": {"particles": False}}, "frames.particles", WATER),
    (
        WATER,
        {"gauges": {"pressure": {"bed": {"at": [0.0, -2.0, 0.0], "normal": [0.0, 1.0, 0.0]}}}},
        "gauges.pressure.bed.normal",
        {"gauges": {"pressure": {"bed": {"at": [0.0, -2.0, 0.0], "normal": [0.0, 1.0, 0.0], "diameter": 0.2}}}},
    ),
    (WATER, {"render": {"foam": False, "foam_cover": 0.1}}, "render.foam_cover", {"render.foam": True}),
    (WATER, {"render": {"wind": True}}, "render.wind", GUSTS),
    (WATER, {"render": {"film": False, "every": 0.5}}, "render.every", {"render.film": True}),
    (SEA, {"render": {"particles": True}}, "render.particles", WATER),
]


TOP = (
    "basin",
    "fluid",
    "wind",
    "ship",
    "sea",
    "render",
    "gauges",
    "health",
    "frames",
    "motion",
    "platform",
    "duration",
)


def said(scene: dict[str, Any], *changes: dict[str, Any]) -> list[str]:
    """The keys of a scene that have no effect."""
    whole, given = dict(scene), {key: value for change in changes for key, value in change.items()}
    for key in [key for key in given if key in TOP]:
        whole[key] = given.pop(key)
    return [sentence for sentence in load(whole, given).warnings() if "no effect" in sentence]


@pytest.mark.parametrize("scene, given, key, acting", IDLE, ids=[entry[2].replace(" ", "_") for entry in IDLE])
def test_a_key_that_changes_nothing_is_said_and_only_where_it_does_not(scene, given, key, acting):
    found = said(scene, given)
    assert len([sentence for sentence in found if sentence.startswith(f"{key} ")]) == 1, found
    if "fluid" in acting and "basin" in acting:  # another scene
        scene, acting = acting, {}
    elif "wind" in acting and "fluid" in acting:
        scene, acting = acting, {}
    assert not [sentence for sentence in said(scene, given, acting) if sentence.startswith(f"{key} ")]


def test_it_is_said_after_a_scene_is_dumped_and_read_again_and_of_each_ship():
    ship = YACHT["ship"] | {"contact": {"friction": 0.2}}
    scene = load(SEA | {"ships": {"one": ship, "two": ship | {"position": [40.0, 0.0]}}})
    sentences = [sentence for sentence in scene.warnings() if "no effect" in sentence]
    assert [sentence.split()[0] for sentence in sentences] == ["ships.one.contact", "ships.two.contact"]
    assert load(scene.resolved()).warnings() == scene.warnings()


@pytest.mark.parametrize("profile", [None, "ci", "reference"])
def test_no_shipped_scene_gives_a_key_without_effect(profile):
    for name in packaged_scenes():
        assert not [sentence for sentence in load(name, profile=profile).warnings() if "no effect" in sentence], name


def test_settings_are_read_as_the_command_reads_them():
    key, value = parse_setting("wind.noise_every=0.1")
    assert said(GUSTS, {key: value})


@pytest.mark.parametrize("angle, told", [(1.5708, True), (-3.14, True), (0.785, True), (5.5, False), (90.0, False)])
def test_an_angle_in_degrees_that_is_a_part_of_pi_is_said(angle, told):
    found = load(YACHT, {"ship.heading_deg": angle, "fluid.heading_deg": 30.0}).warnings()
    said = [sentence for sentence in found if "radians" in sentence]
    assert len(said) == told and all(sentence.startswith("ship.heading_deg is ") for sentence in said)


@pytest.mark.parametrize(
    "asking",
    [
        {"motion": {"every": 0.1, "point": "bow"}},
        {"ship.moorings": [{"from": "bow", "to": [0.0, 0.0, 19.0], "stiffness": 1e4}]},
    ],
)
def test_a_point_that_nothing_asks_for_is_said(asking):
    named = {"ship.points": {"bow": [0.0, 2.0, 5.0]}}
    for given, said in ((named, True), (named | asking, False)):
        found = load(
            YACHT | {"motion": given.get("motion", {"every": 0.1})}, {k: v for k, v in given.items() if k != "motion"}
        )
        assert any("motion.point asks for bow" in sentence for sentence in found.warnings()) is said
