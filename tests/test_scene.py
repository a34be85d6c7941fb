"""Scenes: what lies over what, what is refused and in which words, and the schema that editors read."""

import json
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from ocean_sim import parts
from ocean_sim.files.yaml_file import SceneError, parse_setting
from ocean_sim.reading import composition
from ocean_sim.reading import scene as scene_module
from ocean_sim.reading.keys import scene_schema, schema_text
from ocean_sim.reading.scene import ALWAYS_ON, load, observer_names

BASIN = {"length": 40.0, "width": 40.0, "depth": 7.5}
PLAIN = {"basin": BASIN, "fluid": {"kind": "mueller", "spacing": 1.25}}
HEAD = "basin: {length: 40.0, width: 40.0, depth: 7.5}\n"


def refusal(*arguments, **keywords) -> list[str]:
    """The sentences with which a scene is refused."""
    with pytest.raises(SceneError) as caught:
        load(*arguments, **keywords)
    return [str(problem) for problem in caught.value.problems]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder to write scenes in, and to name them relative to."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def library(folder, monkeypatch):
    """Ready-made parts of a test's own: `library("wind/calm", text)`."""
    for module in (parts, composition, scene_module):
        monkeypatch.setattr(module, "library", lambda name: folder / name)
    parts.named.cache_clear()

    def add(name: str, text: str) -> None:
        path = folder / "configs" / f"{name}.yaml"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        parts.named.cache_clear()

    yield add
    parts.named.cache_clear()


def test_every_problem_is_told_at_once_in_the_order_of_lines(folder):
    Path("mine.yaml").write_text(
        """title: 3
duration: 0.0
basin: {length: 40.0, width: 40.0, depth: 7.5, wals: reflecting, gravity: [0, -9.81]}
fluid:
  kind: mueller
  spacng: 1.25
  spacing: 0.0
  support_ratio: wide
  minimum_pressure: .nan
time_step: {kind: fixed}
ship: yaht
gaugs: {elevation: {centre: [0.0, 0.0]}}
runtime: {arch: cdua, threads: 2.0, pin: 1}
accuracy: 3
"""
    )
    ships = ", ".join(composition.known_names("ship"))
    assert refusal("mine.yaml", {"fluid.collision_distance": 2.0, "seed": -1}) == [
        "--set fluid.collision_distance=2.0: fluid.collision_distance: 2.0 is not at most 1 [spacings]",
        "--set seed=-1: seed: -1 is not at least 0",
        "mine.yaml:1:8: title: expected text, got 3",
        "mine.yaml:2:11: duration: 0.0 is not greater than 0 [s]",
        "mine.yaml:3:48: basin.wals: unknown key; did you mean 'walls'?",
        "mine.yaml:3:75: basin.gravity: expected 3 entries, got 2",
        "mine.yaml:6:3: fluid.spacng: unknown key; did you mean 'spacing'?",
        "mine.yaml:7:12: fluid.spacing: 0.0 is not greater than 0 [m]",
        "mine.yaml:8:18: fluid.support_ratio: expected a number, got 'wide'",
        "mine.yaml:9:21: fluid.minimum_pressure: nan is not a finite number",
        "mine.yaml:10:12: time_step.dt: missing key",
        f"mine.yaml:11:7: ship: no ship 'yaht'; did you mean 'yacht'? there are {ships}",
        "mine.yaml:12:1: gaugs: unknown key; did you mean 'gauges'?",
        "mine.yaml:13:17: runtime.arch: 'cdua' is not a choice; did you mean 'cuda'?",
        "mine.yaml:13:32: runtime.threads: expected a whole number, got 2.0",
        "mine.yaml:13:42: runtime.pin: expected true or false, got 1",
        "mine.yaml:14:11: accuracy: expected a mapping, got 3, as in {every: ...}",
    ]


def test_a_part_without_its_kind_is_read_as_the_one_that_its_keys_are_of(folder):
    Path("s.yaml").write_text(HEAD + "fluid: thesis_6000\nwind: {speed: 12.0, dir: 90.0}")
    assert refusal("s.yaml") == [
        "s.yaml:3:7: wind.kind: missing key; with these keys, did you mean 'stress'? there are "
        f"{', '.join(composition.known_names('wind'))}",
        "s.yaml:3:8: wind.speed: unknown key; did you mean 'u10'?",
        "s.yaml:3:21: wind.dir: unknown key; did you mean 'heading_deg'?",
    ]


@pytest.mark.parametrize(
    "text, sentence",
    [
        ("basin: 3\nfluid: {kind: mueller, spacing: 1.0}", "s.yaml:1:8: basin: expected a mapping, got 3"),
        (HEAD + "fluid: muller", "s.yaml:2:8: fluid: no fluid 'muller'; did you mean 'mueller'? there are ballistic, "),
        (HEAD + "fluid: {kind: 3}", "s.yaml:2:15: fluid.kind: expected a name, got 3"),
        (
            HEAD + "fluid: {spacing: 1.0}",
            "s.yaml:2:8: fluid.kind: missing key; there are ballistic, delta_sph, dfsph, linear_waves, mueller, "
            "spectral_sea",
        ),
        (
            HEAD + "fluid: [1]",
            "s.yaml:2:8: fluid: expected a name or a mapping with `kind`, got a list, as in {kind: ballistic}; there",
        ),
        (
            HEAD + "fluid: thesis_6000\nwind: {kind: gusts, volumes: {acceleration: [1.0, 0.0, 0.0]}}",
            "s.yaml:3:30: wind.volumes: expected a list, got a mapping, as in [{include: ...}, ...]",
        ),
        (
            HEAD + "fluid: thesis_6000\ngauges: {elevation: [0.0, 0.0]}",
            "s.yaml:3:21: gauges.elevation: expected a mapping, got a list, as in {NAME: [..., ...]}",
        ),
        (
            HEAD + "fluid: {knd: mueller}",
            "s.yaml:2:9: fluid.knd: unknown key; did you mean 'kind'? there are ballistic, ",
        ),
        (HEAD + "fluid: {type: mueller}", "s.yaml:2:9: fluid.type: unknown key; did you mean 'kind'? there are "),
        (
            HEAD + "fluid: thesis_6000\nships: {positon: [0.0, 0.0]}",
            "s.yaml:3:9: ships.positon: expected the name of a ship; did you mean 'ship.position', or "
            "'ships.NAME.position'?",
        ),
        (
            HEAD + "fluid: thesis_6000\nships: {kind: yacht}",
            "s.yaml:3:9: ships.kind: expected the name of a ship; did you mean 'ship.kind', or 'ships.NAME.kind'?",
        ),
        (
            HEAD + "fluid: thesis_6000\nships: {tug: 3}",
            "s.yaml:3:14: ships.tug: expected a name or a mapping with `kind`, got 3",
        ),
        (
            HEAD + "fluid: thesis_6000\nship: {kind: yacht, free: [heve]}",
            "s.yaml:3:28: ship.free.0: 'heve' is not a choice; did you mean 'heave'?",
        ),
        (
            HEAD + "fluid: thesis_6000\ngauges: {elevation: {'../x,y': [0.0, 0.0]}}",
            "s.yaml:3:22: gauges.elevation: '../x,y' is not a name: letters, digits and _, a letter first",
        ),
        (
            HEAD + "fluid: thesis_6000\nmotion.every: 0.1",
            "s.yaml:3:1: motion.every: unknown key; in a scene it is written motion: {every: ...}",
        ),
        (
            HEAD + "fluid: {kind: mueller, spacing: 1.25, initial.wave.height: 0.1}",
            "s.yaml:2:39: fluid.initial.wave.height: unknown key; in a scene it is written "
            "initial: {wave: {height: ...}}",
        ),
        (
            HEAD + "fluid: {kind: mueller, spacing: 1.25, <<: {exponent: 7}}",
            "s.yaml:2:39: fluid: merge keys (<<) are not read: YAML 1.2 has none",
        ),
        (
            HEAD + "fluid: thesis_6000\ntime_step: {kind: fixed, dt: 1.0e-30}",
            "s.yaml:3:30: time_step.dt: 1e-30 is not at least 1e-09 [s]",
        ),
        (HEAD + "duration: 1.0", "s.yaml:1:1: fluid: missing key"),
        (HEAD + "fluid:", "s.yaml:1:1: fluid: missing key"),
        (
            HEAD + "fluid: {kind: mueller, spacing: 1.25}\nduration: .inf",
            "s.yaml:3:11: duration: inf is not a finite number",
        ),
        (
            HEAD + "fluid: {kind: mueller, spacing: 1.0, stiffness: 20.0, compression: 0.01}",
            "s.yaml:2:8: fluid: give either compression or stiffness [m2/s2], not both",
        ),
        (
            HEAD + "fluid: {kind: mueller, spacing: [1.0, 0.5]}",
            "s.yaml:2:33: fluid.spacing: particles of mixed size are not modelled",
        ),
        (
            HEAD + "fluid: {kind: mueller, spacing: 1.25, fill: [{min: [-20, -7.5, -20], max: [30, 0, 20]}]}",
            "s.yaml:2:46: fluid.fill.0: the box reaches out of the basin along x",
        ),
        (
            HEAD + "fluid: {kind: mueller, spacing: 1.25}\ntime_step: {kind: fixed, dt: '0,01'}",
            "s.yaml:3:30: time_step.dt: expected a number, got '0,01'; did you mean 0.01?",
        ),
        (
            "basin: {length: 1.0, depth: 1.0}\nfluid: {kind: mueller, spacing: 10 cm}",
            "s.yaml:2:33: fluid.spacing: expected a number, got '10 cm'; did you mean 0.1?",
        ),
        (
            "basin: {length: 1.0, depth: 1.0}\nfluid: {kind: mueller, spacing: '0.1[m]'}",
            "s.yaml:2:33: fluid.spacing: expected a number, got '0.1[m]'; did you mean 0.1?",
        ),
        (
            "basin: {length: 3 feet, depth: 1.0}\nfluid: {kind: mueller, spacing: 0.1}",
            "s.yaml:1:17: basin.length: expected a number, got '3 feet'; a number stands without its unit, which is m "
            "here",
        ),
        (HEAD + "fluid: thesis_6000\nseed: '1'", "s.yaml:3:7: seed: expected a whole number, got '1'; did you mean 1?"),
        (HEAD + "fluid: thesis_6000\nseed: 1e30", "s.yaml:3:7: seed: expected a whole number, got 1e+30"),
        (HEAD + "fluid: thesis_6000\nduration: 1e30", "s.yaml:3:11: duration: 1e+30 is out of range: 0, or between "),
        (HEAD + "fluid: thesis_6000\nseed: '1.5'", "s.yaml:3:7: seed: expected a whole number, got '1.5'"),
        (
            "basin: {length: 1.0, depth: 1.0, walls: [1]}\nfluid: {kind: mueller, spacing: 0.1}",
            "s.yaml:1:41: basin.walls: expected one of 'none', 'reflecting', 'no_slip', 'periodic' or 'absorbing' or a "
            "mapping, got a list",
        ),
        (
            "basin: {length: 1.0, depth: 1.0, walls: {x_min: non}}\nfluid: {kind: mueller, spacing: 0.1}",
            "s.yaml:1:49: basin.walls.x_min: 'non' is not a choice; did you mean 'none'?",
        ),
        (
            HEAD + "fluid: {kind: mueller, spacing: 1.25}\nmanifest: null",
            "s.yaml:3:11: manifest: every run writes its manifest; this key cannot be null",
        ),
        (
            HEAD + "fluid: {kind: mueller, spacing: 1.25}\ngauges: {elevation: {far: [30, 0]}}",
            "s.yaml:3:27: gauges.elevation.far: x = 30 m is outside the basin, which reaches from -20 to 20 m",
        ),
        (HEAD + "fluid: {kind: mueller, spacing: 1.25}\nmotion: {every: 0.1}", "s.yaml:3:9: motion: there is no ship"),
    ],
)
def test_what_is_wrong_is_said_where_it_is(folder, text, sentence):
    Path("s.yaml").write_text(text)
    (said,) = refusal("s.yaml")
    assert said.startswith(sentence)


def test_problems_are_data_too(folder):
    Path("s.yaml").write_text(HEAD + "fluid: {kind: mueller, spacng: 1.25, spacing: 1.25}")
    with pytest.raises(SceneError) as caught:
        load("s.yaml", {"duration": "long"})
    first, second = caught.value.problems
    assert first == ("--set duration=long", None, None, "duration", "expected a number, got 'long'", None)
    assert second == ("s.yaml", 2, 24, "fluid.spacng", "unknown key; did you mean 'spacing'?", "spacing")


def test_a_scene_in_a_dict_has_no_lines():
    assert refusal(PLAIN | {"duration": 0.0}) == ["scene: duration: 0.0 is not greater than 0 [s]"]


def test_a_mistake_in_a_part_names_the_file_of_the_part(folder, library):
    library("fluid/lake", "kind: mueller\nspacing: 1.25\nrest_density: -1.0\n")
    Path("s.yaml").write_text(HEAD + "fluid: {kind: lake, spacing: 0.0}")
    assert refusal("s.yaml") == [
        "configs/fluid/lake.yaml:3:15: fluid.rest_density: -1.0 is not at least 0.001 [kg/m3]",
        "s.yaml:2:30: fluid.spacing: 0.0 is not greater than 0 [m]",
    ]


def test_what_is_wrong_with_a_part_beside_the_others_is_told_where_the_scene_names_it(folder):
    """Not where its preset says what kind it is."""
    for ship, kind in (("{kind: yacht}", 14), ("yacht", 7)):
        text = "basin: {length: 2.0, depth: 0.5}\nfluid: {kind: delta_sph, spacing: 0.1}\n"
        Path("s.yaml").write_text(f"{text}ship: {ship}\n")
        assert refusal("s.yaml") == [
            f"s.yaml:3:{kind}: ship.kind: a ship needs a basin with a width; in a slice of particles take kind pressure"
        ]
        text = "basin: {length: 40.0, width: 40.0, depth: 8.0}\nfluid: {kind: delta_sph, spacing: 1.0}\n"
        Path("s.yaml").write_text(f"{text}ship: {ship}\n")
        assert refusal("s.yaml") == [
            "s.yaml:3:7: ship: a dynamic ship over particles reads the height of the water from a surface; add a "
            "`surface`"
        ]


def test_a_file_that_is_not_there(folder):
    (sentence,) = refusal("thesis/fig6_3c_wid")
    assert sentence.startswith("thesis/fig6_3c_wid: there is no such file or scene")
    assert refusal(folder)[0].endswith("this is a folder, not a file")


def test_part_is_under_scene_is_under_profile_is_under_set(folder, library):
    library(
        "time_step/slow", "kind: courant\ncourant_number: 0.1\nviscous_number: 0.1\nforce_number: 0.1\nlongest: 0.1\n"
    )
    library("run/quick", "time_step: {force_number: 0.3, longest: 0.3}\nruntime: {threads: 1}\n")
    scene = PLAIN | {"time_step": {"kind": "slow", "viscous_number": 0.2, "force_number": 0.2, "longest": 0.2}}
    config = load(scene, {"time_step.longest": 0.4}, "quick")
    step = config.time_step
    assert (step.courant_number, step.viscous_number, step.force_number, step.longest) == (0.1, 0.2, 0.3, 0.4)
    assert config.runtime.threads == 1


def test_a_name_is_a_part_or_else_a_kind_with_its_defaults(library):
    library("wind/still", "kind: gusts\nvolumes: [{include: [{kind: sphere, centre: [0, 0, 0], radius: 1.0}]}]\n")
    library("fluid/lake", "kind: mueller\nspacing: 0.9\n")
    assert load(PLAIN | {"wind": "still"}).wind.kind == "gusts"
    assert load(PLAIN | {"wind": {"kind": "still"}}).wind.kind == "still"
    config = load(PLAIN | {"fluid": "lake"}, {"fluid.support_ratio": 2.5})
    assert (config.fluid.spacing, config.fluid.support_ratio, config.time_step.kind) == (0.9, 2.5, "courant")


def test_an_absent_wind_is_still_and_any_other_absent_slot_is_nothing():
    config = load(PLAIN)
    assert (config.wind.kind, config.time_step.kind) == ("still", "courant")
    assert config.surface is config.platform is None and not config.ships


def test_another_kind_keeps_the_keys_that_it_also_has_and_says_which_it_drops():
    fluid = {"kind": "mueller", "spacing": 1.25, "rest_density": 1025.0, "support_ratio": 2.5}
    config = load(PLAIN | {"fluid": fluid}, {"fluid.kind": "ballistic"})
    assert (config.fluid.kind, config.fluid.spacing, config.fluid.rest_density) == ("ballistic", 1.25, 1025.0)
    assert config.notes == ["fluid: kind ballistic has no support_ratio; dropped"]


def test_a_mistyped_key_is_not_dropped_with_the_kind():
    fluid = {"kind": "mueller", "spacing": 1.25, "suport_ratio": 2.5}
    (sentence,) = refusal(PLAIN | {"fluid": fluid}, {"fluid.kind": "ballistic"})
    assert sentence.startswith("scene: fluid.suport_ratio: unknown key")


def test_the_order_of_settings_does_not_matter():
    one = load(PLAIN, {"time_step.kind": "fixed", "time_step.dt": 0.001})
    other = load(PLAIN, {"time_step.dt": 0.001, "time_step.kind": "fixed"})
    assert one.time_step == other.time_step
    assert one.time_step.dt == 0.001


def test_another_part_keeps_what_the_scene_itself_says(library):
    library("fluid/lake", "kind: mueller\nspacing: 0.9\nrest_density: 1000.0\n")
    library("fluid/sea", "kind: mueller\nspacing: 1.8\nrest_density: 1025.0\n")
    scene = PLAIN | {"fluid": {"kind": "lake", "support_ratio": 3.0}}
    fluid = load(scene, {"fluid.kind": "sea"}).fluid
    assert (fluid.spacing, fluid.rest_density, fluid.support_ratio) == (1.8, 1025.0, 3.0)
    assert load(scene, {"fluid": "sea"}).fluid.support_ratio == 2.0


def test_null_takes_a_slot_or_an_observer_away():
    gusts = {"kind": "gusts", "volumes": [{"include": [{"kind": "sphere", "centre": [0, 0, 0], "radius": 1.0}]}]}
    scene = PLAIN | {"wind": gusts, "gauges": {"elevation": {"centre": [0.0, 0.0]}}}
    config = load(scene, {"wind": None, "gauges": None, "accuracy": None})
    assert config.wind.kind == "still"
    assert not {"gauges", "accuracy"} & set(config.observers)


def test_settings_reach_into_lists():
    sphere = {"kind": "sphere", "centre": [0, 0, 0], "radius": 1.0}
    scene = PLAIN | {"wind": {"kind": "gusts", "volumes": [{"include": [sphere]}, {"include": [sphere]}]}}
    config = load(scene, {"wind.volumes.1.include.0.radius": 3.0})
    assert [volume.include[0].radius for volume in config.wind.volumes] == [1.0, 3.0]
    assert refusal(scene, {"wind.volumes.2.drift": 1.0}) == [
        "--set wind.volumes.2.drift=1.0: wind.volumes.2.drift: wind.volumes is a list; its entries are numbered: 0 to 1"
    ]


@pytest.mark.parametrize(
    "text, sentence",
    [
        ("fluid.spacng=1", "fluid.spacng: unknown key; did you mean 'spacing'?"),
        ("flud.spacing=1", "flud: unknown key; did you mean 'fluid'?"),
        ("leg_speed=1", "leg_speed: unknown key; there is platform.hexapod.geometry.leg_speed"),
        ("spacing=1", "spacing: unknown key; did you mean 'fluid.spacing'?"),
        ("depth=1", "depth: unknown key; did you mean 'basin.depth'?"),
        ("u10=1", "u10: unknown key; there is wind.stress.u10"),
        ("tile=1", "tile: unknown key; there is fluid.spectral_sea.tile"),
        ("fluidsupport_ratio=2", "fluidsupport_ratio: unknown key; did you mean 'fluid.support_ratio'?"),
        (
            "fluid.spacing.x=1",
            "fluid.spacing.x: fluid.spacing is 1.25, which has no keys; set fluid.spacing as a whole",
        ),
        ("fluid..spacing=1", "fluid..spacing: there is a dot where a key should be; did you mean 'fluid.spacing'?"),
        ("ship.hull=yacht", f"ship.kind: missing key; there are {', '.join(composition.known_names('ship'))}"),
        ("basin.walls.x_min=non", "basin.walls.x_min: 'non' is not a choice; did you mean 'none'?"),
    ],
)
def test_settings_that_make_no_sense(text, sentence):
    key, node = parse_setting(text)
    assert refusal(PLAIN, {key: node}) == [f"--set {text}: {sentence}"]


def test_a_key_without_its_part_is_looked_for_in_the_parts_of_the_scene():
    for key, meant in (("leg_speed", "platform.geometry.leg_speed"), ("u10", "wind.u10"), ("spacing", "fluid.spacing")):
        with pytest.raises(SceneError) as caught:
            load("showcase", {"wind": {"kind": "stress", "u10": 5.0}, key: 1.0})
        assert caught.value.problems[0].message == f"unknown key; did you mean {meant!r}?"
        assert caught.value.problems[0].suggestion == meant


def test_a_profile_holds_what_a_machine_can_afford_and_nothing_else(folder, library):
    library("run/bad", "runtime: {threads: 1}\nbasin: {depth: 1.0}\nfluid: mueller\nhealht: null\n")
    assert refusal(PLAIN, profile="bad")[:3] == [
        "configs/run/bad.yaml:2:1: basin: a profile has no such key; there are runtime, time_step, resolution, "
        + ", ".join(observer_names()),
        "configs/run/bad.yaml:3:1: fluid: a profile has no such key; there are runtime, time_step, resolution, "
        + ", ".join(observer_names()),
        "configs/run/bad.yaml:4:1: healht: a profile has no such key; did you mean 'health'?",
    ]
    assert refusal(PLAIN, profile="bda") == ["--profile bda: no profile 'bda'; did you mean 'bad'? there are bad"]


def test_a_profile_switches_observers_off_and_a_setting_on_again(library):
    library("run/quiet", "health: null\naccuracy: null\n")
    config = load(PLAIN, {"accuracy.every": 0.5}, "quiet")
    assert "health" not in config.observers
    assert config.observers["accuracy"].every == 0.5


def test_resolution_is_a_factor_on_every_spacing(library):
    library("run/coarse", "resolution: 2.0\n")
    config = load(PLAIN, profile="coarse")
    assert config.fluid.spacing == 2.5
    assert config.notes[0] == "resolution 2: fluid.spacing 1.25 -> 2.5"
    budget = PLAIN | {"fluid": {"kind": "mueller", "particles": 8000}}
    assert load(budget, profile="coarse").fluid.particles == 1000
    assert load(budget | {"basin": {"length": 40.0, "depth": 7.5}}, profile="coarse").fluid.particles == 2000


def test_a_resolved_scene_loads_to_itself(library):
    library("run/coarse", "resolution: 1.6\nframes: null\ntime_step: {kind: fixed, dt: 0.001}\n")
    config = load(
        PLAIN | {"gauges": {"elevation": {"centre": [0.0, 0.0]}}, "seed": 7}, {"basin.walls": "none"}, "coarse"
    )
    resolved = json.loads(json.dumps(config.resolved()))
    again = load(resolved)
    assert again.resolved() == config.resolved()
    assert (again.fluid, again.seed, list(again.observers)) == (config.fluid, 7, list(config.observers))


def test_what_a_scene_switches_off_is_off_after_its_dump_is_read():
    sea = {"kind": "linear_waves", "height": 0.5, "period": 3.0}
    tank = {"length": 60.0, "width": 60.0, "depth": 20.0, "walls": "none"}
    config = load({"basin": tank, "fluid": sea, "ship": "yacht", "platform": "hexapod_a", "motion": None})
    assert "motion" not in config.observers
    assert load(config.resolved()).resolved() == config.resolved()


def test_observers_are_on_unless_null_and_watch_in_their_order():
    config = load(PLAIN | {"gauges": {"elevation": {"centre": [0.0, 0.0]}}})
    names = list(config.observers)
    turns = [config.observers[name].turn for name in names]
    assert turns == sorted(turns) and turns[0] < 0 < turns[-1]
    assert set(ALWAYS_ON) | {"gauges"} == set(names)
    # What it says of the end is written when all data lie there, and before pictures, which may take long.
    assert names.index("frames") < names.index("manifest") < names.index("report")


def test_a_config_is_frozen():
    with pytest.raises(ValueError, match="frozen"):
        load(PLAIN).fluid.spacing = 1.0


def test_the_schema_knows_every_kind_and_every_observer():
    definitions = json.loads(schema_text())["$defs"]
    assert {f"{slot}.{kind}" for slot in parts.SLOTS for kind in parts.kinds(slot)} <= set(definitions)
    assert {f"observers.{name}" for name in observer_names()} <= set(definitions)


def test_the_schema_is_in_the_form_of_its_draft():
    whole = scene_schema()
    references, kinds = set(), {"object", "array", "string", "number", "integer", "boolean", "null"}

    def walk(node: object) -> None:
        if isinstance(node, dict):
            if isinstance(node.get("$ref"), str):
                references.add(node["$ref"].removeprefix("#/$defs/"))
            if isinstance(node.get("type"), str):
                assert node["type"] in kinds
            for inner in node.values():
                walk(inner)
        elif isinstance(node, list):
            for inner in node:
                walk(inner)

    walk(whole)
    assert references == set(whole["$defs"])
    assert whole["$defs"]["fluid.mueller"]["properties"]["spacing"]["unit"] == "m"
    assert {"basin", "fluid", "wind", "gauges", "duration"} <= set(whole["properties"])
    assert whole["required"] == ["basin", "fluid"]


words = st.sampled_from(
    ["kind", "mueller", "gusts", "spacing", "x", "wide", "fixed", "dt", "0", "every", "elevation", ""]
)
leaves = st.none() | st.booleans() | st.integers() | st.floats() | words | st.text(max_size=5)
garbage = st.recursive(
    leaves, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(words, inner, max_size=3), max_leaves=8
)
keys = st.sampled_from(
    [*PLAIN, "wind", "ship", "time_step", "runtime", "gauges", "resolution", "title", "seed", "health", "x"]
)
inside = st.tuples(keys, words, words, words).flatmap(
    lambda path: st.integers(1, 4).map(lambda depth: ".".join(path[:depth]))
)


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.dictionaries(keys, garbage, max_size=5), st.dictionaries(inside, garbage, max_size=3))
def test_garbage_is_refused_with_sentences_and_never_raises_anything_else(scene, overrides):
    try:
        config = load(PLAIN | scene, overrides)
        assert load(config.resolved()).resolved() == config.resolved()
    except SceneError as error:
        assert error.problems and all(problem.message for problem in error.problems)
        assert "pydantic" not in str(error) and "Input should" not in str(error)
