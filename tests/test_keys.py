"""The keys of a scene as users are told of them: every one has a meaning, and what it says is so."""

import json
import re
import shlex
from pathlib import Path

import pytest

from ocean_sim.__main__ import run_command_line
from ocean_sim.files.yaml_file import SceneError, parse_setting
from ocean_sim.parts import SLOTS, config_of, kinds, named
from ocean_sim.reading.keys import keys_at, scene_keys, scene_schema
from ocean_sim.reading.scene import load
from ocean_sim.reading.sentences import opening_sentence, part_sentence
from ocean_sim.reading.translation import likeliest

SEA = {"basin": {"length": 20.0, "width": 20.0, "depth": 5.0}, "fluid": {"kind": "linear_waves", "height": 0.5}}


def test_every_key_has_a_meaning_and_its_path_is_found():
    for key in scene_keys():
        assert key.meaning and key.takes, key.path
    for key in scene_keys()[::60]:
        assert any(key.path == other.path for other in keys_at(key.path)), key.path


def test_every_word_that_a_key_may_have_is_told():
    meanings = {key.path: key.meaning for key in scene_keys()}
    letters = re.compile(r"-?[xyz](_min|_max)?")
    for key in scene_keys():
        told = key.meaning + meanings.get(key.path.rpartition(".")[0], "")
        words = [word for word in key.choices if word not in ("true", "false") and not letters.fullmatch(word)]
        assert len(words) < 2 or all(f"`{word}`" in told for word in words), key.path


def test_a_key_is_explained_with_and_without_its_kind(capsys):
    assert [key.path for key in keys_at("wind.u10")] == ["wind.stress.u10"]
    assert next(key.path for key in keys_at("ships.tug.moorings.0.stiffness")) == "ship.dynamic.moorings[].stiffness"
    assert run_command_line(["explain", "wind.stress.u10", "--json"]) == 0
    (told,) = json.loads(capsys.readouterr().out)
    assert (told["unit"], told["range"]) == ("m/s", ">= 0, <= 200")
    assert run_command_line(["explain", "wind.stres.u10"]) == 2
    assert "there is wind.stress.u10" in capsys.readouterr().err
    for word, meant in (
        ("wind.speed", "wind.u10"),
        ("wind.stres", "wind.stress"),
        ("ship.direction", "ship.heading_deg"),
        ("ship.hul", "ship.hull"),
        ("ship.yacht.pos", "ship.yacht.position"),
        ("density", "rest_density"),
    ):
        assert run_command_line(["explain", word]) == 2
        assert f"did you mean '{meant}'?" in capsys.readouterr().err


def test_a_preset_or_a_kind_is_explained_by_its_sentence_and_its_keys(capsys):
    for word in ("ship.yacht", "yacht"):
        assert run_command_line(["explain", word]) == 0
        told = capsys.readouterr().out
        assert told.startswith("ship.yacht: A motor yacht") and "ship.dynamic.heading_deg" in told
    assert "{helm: [0.0, 4.2, 0.5]}" in told and run_command_line(["explain", "ship.dynamic"]) == 0
    assert "helm: [0.0" not in capsys.readouterr().out
    for word in ("ship.yacht.position", "Ship.Position", "ship.position=[1.0, 2.0]"):
        assert run_command_line(["explain", word]) == 0
        assert "ship.dynamic.position" in capsys.readouterr().out
    assert run_command_line(["explain", "xyzzy"]) == 2
    assert "`ocean-sim list`" in capsys.readouterr().err


def test_the_kinds_of_what_is_inside_a_part_are_a_key():
    (key,) = keys_at("fluid.delta_sph.initial.kind")
    assert "taylor_green" in key.choices and "`standing_wave`: A standing wave along x" in key.meaning
    assert any(key.choices == ("adaptive", "classical", "predictive") for key in keys_at("platform.washout.kind"))


def test_every_example_is_a_value_that_its_key_takes():
    """But for one key of two that go together, and for files that are not there."""
    in_pairs = {"height", "period", "particles", "spectrum"}
    for key in scene_keys():
        value = parse_setting(key.example)[1].plain()
        assert "..." not in key.example and value != [], key.example
        words = key.path.split(".")
        if len(words) == 3 and words[0] in SLOTS and words[2] not in in_pairs:
            config = config_of(words[0], words[1])
            try:
                config.model_validate({**config.example, "kind": words[1], words[2]: value}, strict=False)
            except ValueError as error:
                assert "there is no such file" in str(error), f"{key.example}: {error}"


@pytest.mark.parametrize(
    "word, choices, meant",
    [
        ("speed", ["u10", "start", "gain"], "u10"),
        ("direction", ["heading_deg", "u10"], "heading_deg"),
        ("heading", ["height", "heading_deg"], "heading_deg"),
        ("pos", ["position", "mass"], "position"),
        ("dt", ["time_step", "duration"], "time_step"),
        ("output", ["frames", "fluid"], "frames"),
        ("viscosity", ["kinematic_viscosity", "spacing"], "kinematic_viscosity"),
        ("Density", ["rest_density", "density_diffusion", "spacing"], "rest_density"),
        ("size", ["length", "depth"], "length"),
        ("size", ["spacing", "fill"], "spacing"),
        ("spacng", ["spacing", "support_ratio"], "spacing"),
        ("xyzzy", ["spacing", "support_ratio"], None),
    ],
)
def test_the_likeliest_intention(word, choices, meant):
    assert likeliest(word, choices) == meant


def test_what_is_below_a_wrong_kind_is_reported_in_the_same_go():
    with pytest.raises(SceneError) as refused:
        load(SEA | {"fluid": {"kind": "muller", "viscosity": 1.0, "spacing": -1.0}})
    keys_told = {problem.key for problem in refused.value.problems}
    assert keys_told == {"fluid.kind", "fluid.viscosity", "fluid.spacing"}


def test_a_new_scene_says_what_its_keys_mean_and_is_the_same_scene(tmp_path, capsys):
    file = tmp_path / "mine.yaml"
    for source in ("showcase", "gallery/dam_break_on_a_box", "gallery/two_ships"):
        assert run_command_line(["new", str(file), "--from", source]) == 0
        assert load(file).resolved() == load(source).resolved()
        assert "# Simulated time [s]" in file.read_text()
        assert run_command_line(["new", str(file)]) == 2 and "there already" in capsys.readouterr().err
        file.unlink()
    assert run_command_line(["new", str(tmp_path / "nowhere" / "mine.yaml")]) == 2
    assert "there is no folder" in capsys.readouterr().err


def test_editors_know_the_keys_of_ready_made_parts_and_hover_units_and_defaults():
    whole = scene_schema()
    choices = whole["properties"]["ship"]["anyOf"]
    ready = {c["properties"]["kind"]["const"]: c for c in choices if "properties" in c}
    assert set(ready) == set(named("ship")) - set(kinds("ship"))
    yacht = ready["yacht"]
    assert not yacht["additionalProperties"] and yacht["required"] == ["kind"]
    assert {"position", "heading_deg", "mass"} <= set(yacht["properties"]) and "15 m" in yacht["description"]
    assert choices[0]["enum"] and len(choices[0]["enum"]) == len(choices[0]["markdownEnumDescriptions"])
    assert whole["properties"]["duration"]["description"] == "Simulated time. [s] Default: 10.0."


def test_the_version_and_a_quiet_run(capsys, tmp_path):
    assert run_command_line(["--version"]) == 0
    assert capsys.readouterr().out.split()[0] == "ocean-sim"
    scene = Path(tmp_path / "sea.yaml")
    off = "render: null\nframes: null\nreport: null\naccuracy: null\n"
    waves = "fluid: {kind: linear_waves, height: 0.5, period: 3.0, ramp: 0.0}\n"
    sea = f"basin: {{length: 9.0, width: 9.0, depth: 5.0}}\n{waves}"
    scene.write_text(f"duration: 0.05\n{sea}{off}")
    assert run_command_line(["run", str(scene), "--quiet", "--out", str(tmp_path / "run")]) == 0
    assert capsys.readouterr().out == f"{tmp_path / 'run'}\n"
    assert run_command_line(["run", str(scene), "--json", "--out", str(tmp_path / "again")]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["outcome"] == "done" and told["warnings"] == []
    assert set(told["wall_s"]) == {"start", "steps", "pictures", "total"} and told["wall_s"]["total"] > 0.0


def test_a_key_of_another_kind_names_that_kind(capsys):
    assert run_command_line(["explain", "wind.stress.u10"]) == 0
    assert "where    wind.kind is stress" in capsys.readouterr().out
    assert run_command_line(["check", "showcase", "--set", "wind.u10=8"]) == 2
    assert "wind.u10: unknown key; there are kind, " in (said := capsys.readouterr().err)
    assert said.rstrip().endswith("it is a key of kind stress")
    assert run_command_line(["check", "showcase", "--set", "wind.tragets=[ship]"]) == 2
    assert "did you mean 'targets'" in (said := capsys.readouterr().err) and "it is a key" not in said


def test_a_value_of_another_form_is_refused_with_the_keys_that_a_scene_writes(capsys):
    assert run_command_line(["check", "gallery/yacht_in_waves", "--set", "ship.moorings=3"]) == 2
    assert "expected a list, got 3, as in [{from: ..., to: ..., stiffness: ...}, ...]" in capsys.readouterr().err


def test_no_sentence_of_a_list_is_cut_where_its_line_ends():
    assert (
        opening_sentence("A flume: a slice\nand a wall. More.\nYet more.\n\nElse.")
        == "A flume: a slice and a wall. More."
    )
    assert opening_sentence("") == "" and opening_sentence("A title, for `bench`") == "A title, for `bench`"
    assert part_sentence("ship", "tug").endswith(".") and "three lengths" in part_sentence("ship", "tug")


def test_the_example_of_a_number_lies_within_its_range():
    holds = {">=": float.__ge__, "<=": float.__le__, ">": float.__gt__, "<": float.__lt__}
    for key in scene_keys():
        value = key.example.partition("=")[2]
        if re.fullmatch(r"-?\d+(\.\d+)?", value):
            for sign, bound in re.findall(r"(>=|<=|>|<) (-?[\d.]+(?:e[-+]\d+)?)", key.range):
                assert holds[sign](float(value), float(bound)), f"{key.path}: {key.example}, {key.range}"


def test_an_example_can_be_pasted_into_a_shell(capsys):
    assert run_command_line(["explain", "basin.walls.x_min.target"]) == 0
    line = next(line for line in capsys.readouterr().out.splitlines() if "--set" in line)
    assert shlex.split(line)[1:] == ["--set", "basin.walls.x_min.target={current: [0.0, 0.0, 0.0]}"]
    assert run_command_line(["explain", "wind.stress.u10"]) == 0
    assert "--set wind.u10=1.0\n" in capsys.readouterr().out
