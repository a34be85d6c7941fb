"""YAML 1.2 with positions: every value knows its line and column, and every mistake has a sentence."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ocean_sim.files.yaml_file import (
    Location,
    SceneError,
    merge_nodes,
    node_of,
    parse_setting,
    parse_yaml,
    read_mapping,
)

HERE = Location("f.yaml", 1, 1)


def complaints(text: str) -> list[str]:
    with pytest.raises(SceneError) as caught:
        parse_yaml(text, HERE)
    return [str(problem) for problem in caught.value.problems]


def test_every_value_and_key_knows_its_place():
    root = parse_yaml("a: 1\nb:\n  - {c: 2.5}\n  - x\nd:\n", HERE)
    assert root.plain() == {"a": 1, "b": [{"c": 2.5}, "x"], "d": None}
    c = root.data["b"].data[0].data["c"]
    assert (c.key_location, c.location) == (Location("f.yaml", 3, 6), Location("f.yaml", 3, 9))
    assert root.data["b"].data[1].location == Location("f.yaml", 4, 5)
    assert root.data["d"].location == Location("f.yaml", 5, 1)  # a value that is not written stands where its key does


@pytest.mark.parametrize(
    "text, value",
    [
        ("1e-3", 1e-3),
        ("1e3", 1000.0),
        ("1.e3", 1000.0),
        ("12e03", 12000.0),
        ("1.", 1.0),
        ("1.0.0", "1.0.0"),
        ("1.5m", "1.5m"),
        ("1,000", "1,000"),
        ("+12", 12),
        ("1_000", 1000),
        ("010", 10),
        ("08", 8),
        ("0o8", "0o8"),
        ("0x1F", 31),
        ("0b101", 5),
        ("-0o17", -15),
        (".5", 0.5),
        ("-.inf", float("-inf")),
        ("inf", "inf"),
        ("yes", "yes"),
        ("No", "No"),
        ("on", "on"),
        ("OFF", "OFF"),
        ("y", "y"),
        ("1:30", "1:30"),
        ("1:30:00.5", "1:30:00.5"),
        ("2001-01-01", "2001-01-01"),
        ("<<", "<<"),
        ("TRUE", True),
        ("tRue", "tRue"),
        ("~", None),
        ("Null", None),
        ("'1'", "1"),
        ("!!str 12", "12"),
        ("!!float 1", 1.0),
        ('"\\ud83d\\ude00"', "\U0001f600"),
    ],
)
def test_scalars_are_those_of_yaml_1_2(text, value):
    plain = parse_yaml(f"a: {text}", HERE).plain()["a"]
    assert plain == value and type(plain) is type(value)
    assert parse_yaml(f"%YAML 1.1\n---\na: {text}", HERE).plain()["a"] == value


@pytest.mark.parametrize(
    "text, sentence",
    [
        ("a: 1\na: 2", "f.yaml:2:1: a: this key is given twice (first in line 1)"),
        ("a: {b: 1, b: 2}", "f.yaml:1:11: a.b: this key is given twice (first in line 1)"),
        (
            "a: [1",
            "f.yaml:1:6: not valid YAML: while parsing a flow sequence expected ',' or ']', but got '<stream end>'",
        ),
        ("a: 1\n b: 2", "f.yaml:2:3: not valid YAML: mapping values are not allowed here"),
        ("a: *x", "f.yaml:1:4: not valid YAML: found undefined alias 'x'"),
        ("a: &x [*x]", "f.yaml:1:4: a.0: this alias is inside what it names"),
        ("a: !!python/object x", "f.yaml:1:4: a: tags such as tag:yaml.org,2002:python/object are not read here"),
        ("? [1, 2]\n: 3", "f.yaml:1:3: a key must be a word"),
        ("[" * 5000, "f.yaml:1:1: nested too deeply"),
        ("a: !!int abc", "f.yaml:1:4: a: 'abc' is not a number that can be read"),
        (
            "a: 1\n---\nb: 2",
            "f.yaml:2:1: not valid YAML: expected a single document in the stream but found another document",
        ),
    ],
)
def test_mistakes_have_a_place_and_a_sentence(text, sentence):
    assert complaints(text) == [sentence]


def test_aliases_of_aliases_do_not_fill_the_memory():
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 10)}]" for k in range(1, 9)]
    assert any("more than 200000 values" in sentence for sentence in complaints("\n".join(lines)))


def test_files_that_cannot_be_scenes(tmp_path):
    def sentence(path: Path) -> str:
        with pytest.raises(SceneError) as caught:
            read_mapping(path, "x.yaml")
        return str(caught.value)

    (tmp_path / "empty.yaml").write_text("# nothing\n")
    (tmp_path / "list.yaml").write_text("- 1\n")
    (tmp_path / "latin.yaml").write_bytes(b"title: \xe9\n")
    (tmp_path / "zero.yaml").write_bytes(b"\x00")
    assert sentence(tmp_path / "none.yaml") == "x.yaml: there is no such file"
    assert sentence(tmp_path) == "x.yaml: this is a folder, not a file"
    assert sentence(tmp_path / "empty.yaml") == "x.yaml:1:1: this file is empty; a mapping was expected"
    assert sentence(tmp_path / "list.yaml") == "x.yaml:1:1: expected a mapping of keys to values, got a list"
    assert sentence(tmp_path / "latin.yaml").startswith("x.yaml: this is not UTF-8 text (byte 7); save it")
    assert sentence(tmp_path / "zero.yaml").startswith("x.yaml:1:1: not valid YAML: ")


def test_settings_are_a_key_and_a_yaml_value():
    key, node = parse_setting("wind.volumes.0.noise=[1, 2.0]")
    assert (key, node.plain()) == ("wind.volumes.0.noise", [1, 2.0])
    assert node.location == Location("--set wind.volumes.0.noise=[1, 2.0]")
    assert parse_setting("ship=null")[1].data is None
    assert parse_setting("title=a=b")[1].data == "a=b"


@pytest.mark.parametrize(
    "text, sentence",
    [
        ("nothing", "--set nothing: expected key=value, as in fluid.spacing=0.8"),
        ("a=", "--set a=: a: there is no value; a=null removes it"),
        (
            "a=[1",
            "--set a=[1: not valid YAML: while parsing a flow sequence expected ',' or ']', but got '<stream end>'",
        ),
    ],
)
def test_settings_that_cannot_be_read(text, sentence):
    with pytest.raises(SceneError) as caught:
        parse_setting(text)
    assert str(caught.value) == sentence


def test_merging_is_deep_for_mappings_and_replaces_lists():
    below, above = ({"a": {"x": 1, "y": [1, 2]}, "b": 1}, {"a": {"y": [3]}, "c": 2})
    both = merge_nodes(node_of(below, Location("low")), node_of(above, Location("high")))
    assert both.plain() == {"a": {"x": 1, "y": [3]}, "b": 1, "c": 2}
    assert both.data["a"].data["x"].location.file == "low"
    assert both.data["a"].data["y"].location.file == "high"


@given(
    st.text(alphabet=st.sampled_from(list("abk:-[]{},&*!|>'\"%@`#?~ \n\t01.xeE_<=")), max_size=60)
    | st.text(max_size=30)
)
def test_any_text_is_read_or_refused_with_a_sentence(text):
    try:
        parse_yaml(text, HERE).plain()
    except SceneError as error:
        assert error.problems and all(problem.message for problem in error.problems)
