"""Checkpoints that are damaged, and such that are whole but hold another state: a sentence, and nothing is lost."""

import json
import shutil
from io import TextIOWrapper
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from _breakers import changed, decayed, garbage, paths
from _settings import few, many
from _small_sea import SMALL_SEA
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import BaseModel

from ocean_sim.__main__ import run_command_line
from ocean_sim.observers.checkpoint import restore, roots
from ocean_sim.reading.scene import load
from ocean_sim.result import run as run_scene
from ocean_sim.simulation import Simulation
from ocean_sim.state import checkpoint_file
from ocean_sim.state.fields import FieldContents
from ocean_sim.state.snapshot import Mismatch, Restorer, is_package_object

SEA = SMALL_SEA | {"duration": 0.1, "checkpoint": {"every": 0.05}, **dict.fromkeys(("report", "frames", "timings"))}
TALK = ("Traceback", "this should not happen", "Errno")


@pytest.fixture(scope="module")
def kept(tmp_path_factory) -> tuple[Path, Path]:
    """The checkpoint in the midst of a run, and the folder that the tests work in."""
    folder = tmp_path_factory.mktemp("kept")
    run_scene(load(SEA), folder / "run", ())
    newest, before = checkpoint_file.checkpoint_files(folder / "run")
    manifest = folder / "run" / "manifest.json"
    manifest.write_text(json.dumps(json.loads(manifest.read_text()) | {"outcome": "running"}))
    newest.unlink()
    return before, folder


def content_of(kept) -> bytes:
    return kept[0].read_bytes()


@pytest.fixture
def unfilled(monkeypatch) -> None:
    """Taichi fields are compared with what they would get, but not given it: that compiles for seconds each time."""
    monkeypatch.setattr(FieldContents, "write", lambda *rest: None)


def unreadable(kept, content: bytes) -> bool:
    path = kept[1] / checkpoint_file.checkpoint_name(0.0)
    path.write_bytes(content)
    try:
        checkpoint_file.read_checkpoint(path)
    except checkpoint_file.UnreadableCheckpoint as said:
        assert path.name in str(said) and not any(talk in str(said) for talk in TALK)
        return True
    return False


def decay(data, kept) -> None:
    broken = data.draw(decayed(content_of(kept)))
    assert unreadable(kept, broken.content) or broken.content == content_of(kept), broken.how


def decay_with_a_true_hash(data, kept) -> None:
    """As a program would write that knows the head but not the rest: h5py may read it, and may not fall over it."""
    broken = data.draw(decayed(content_of(kept)[checkpoint_file.HEADER_BYTES :]))
    unreadable(kept, checkpoint_file.file_header(broken.content) + broken.content)


def another_state(data, kept, capsys) -> None:
    """The scene or the versions are not those of the run: the message of `resume`."""
    checkpoint = checkpoint_file.read_checkpoint(kept[0])
    part = data.draw(st.sampled_from(["scene", "made"]))
    there = copy_of(kept)
    checkpoint_file.write_checkpoint(checkpoint._replace(**{part: broken(data, getattr(checkpoint, part))}), there)
    before = (there / "gauges.csv").read_bytes()
    capsys.readouterr()
    code = run_command_line(["resume", str(there)])
    said = capsys.readouterr()
    assert not any(talk in said.out + said.err for talk in TALK), (part, said.err)
    assert code == 0 or (code == 2 and said.err.strip() and (there / "gauges.csv").read_bytes() == before)


def another_tree(data, kept) -> None:
    """The state itself, or an array of it, is other than any run would leave it: it is refused, and no file is touched,
    or it has the form of one, and the hash vouches for its numbers."""
    checkpoint = checkpoint_file.read_checkpoint(kept[0])
    if checkpoint.arrays and data.draw(st.integers(0, 4)) == 0:
        name = data.draw(st.sampled_from(sorted(checkpoint.arrays)))
        checkpoint = checkpoint._replace(arrays={k: a for k, a in checkpoint.arrays.items() if k != name})
    else:
        checkpoint = checkpoint._replace(tree=broken(data, checkpoint.tree))
    there = copy_of(kept)
    before = {path.name: path.read_bytes() for path in there.iterdir()}
    with TemporaryDirectory() as scratch:
        simulation = Simulation(load(SEA), Path(scratch))
        files = [*simulation.observers]
        try:
            restore(simulation, checkpoint, there)
        except Mismatch as said:
            assert str(said) and not any(talk in str(said) for talk in TALK)
            assert {path.name: path.read_bytes() for path in there.iterdir()} == before
        finally:
            closed(files)


def copy_of(kept) -> Path:
    there = kept[1] / "there"
    shutil.rmtree(there, ignore_errors=True)
    shutil.copytree(kept[0].parent, there)
    return there


def broken(data, whole):
    """A copy with one place changed or gone."""
    path = data.draw(st.sampled_from(paths(whole)))
    value, gone = data.draw(garbage), data.draw(st.integers(0, 4)) == 0
    return changed(whole, path, lambda at, key: at.__delitem__(key) if gone else at.__setitem__(key, value))


def closed(observers) -> None:
    """Their files; what else they would say at the end of a run is nonsense now."""
    for observer in observers:
        for inner in (observer, *vars(observer).values()):
            for thing in vars(inner).values() if hasattr(inner, "__dict__") else ():
                if isinstance(thing, TextIOWrapper):
                    thing.close()


@few
@given(st.data())
def test_a_damaged_checkpoint_is_never_read(kept, data):
    decay(data, kept)


@few
@given(st.data())
def test_a_checkpoint_that_only_seems_whole_is_refused(kept, data):
    decay_with_a_true_hash(data, kept)


@settings(few, max_examples=10)
@given(st.data())
def test_a_checkpoint_of_another_scene_or_version_is_refused_in_a_sentence(kept, capsys, data):
    another_state(data, kept, capsys)


@pytest.mark.parametrize(
    "name, value", [("time", "soon"), ("path", False), ("path", None), ("outcome", 3), ("simulation", 1.5)]
)
def test_words_for_numbers_and_nothing_for_a_path_are_no_state(kept, unfilled, name, value):
    checkpoint = checkpoint_file.read_checkpoint(kept[0])
    spots = [path for path in paths(checkpoint.tree) if path[-2:] == ("at", name)]
    assert spots
    tree = changed(checkpoint.tree, spots[0], lambda at, key: at.__setitem__(key, value))
    with TemporaryDirectory() as scratch:
        simulation = Simulation(load(SEA), Path(scratch))
        files = [*simulation.observers]
        with pytest.raises(Mismatch, match=f"its .*{name} is"):
            restore(simulation, checkpoint._replace(tree=tree), copy_of(kept))
        closed(files)


def objects(thing: Any, found: dict[int, tuple[Any, dict]]) -> dict[int, tuple[Any, dict]]:
    """All that can be reached of what a walk may change, with its attributes as they are."""
    if is_package_object(thing) and not isinstance(thing, BaseModel) and id(thing) not in found:
        found[id(thing)] = thing, dict(vars(thing))
    inner = thing if isinstance(thing, list | tuple) else thing.values() if isinstance(thing, dict) else ()
    for each in inner if id(thing) not in found else found[id(thing)][1].values():
        if id(each) not in found:
            objects(each, found)
    return found


@pytest.mark.parametrize("value", [None, [], "x", {}, {"list": []}], ids=str)
def test_no_number_of_a_state_may_be_of_another_kind(kept, unfilled, value):
    """Every one of the tree, also those of which a run that has just been built has none yet."""
    checkpoint, there = checkpoint_file.read_checkpoint(kept[0]), copy_of(kept)
    numbers = [path for path in paths(checkpoint.tree) if isinstance(at(checkpoint.tree, path), bool | int | float)]
    assert len(numbers) > 50 and any(path[-1] == "next" for path in numbers)
    if value is None:  # which says of this one that no row was written yet
        numbers = [path for path in numbers if path[-1] != "next"]
    with TemporaryDirectory() as away:
        simulation = Simulation(load(SEA), Path(away))
        parts, files = roots(simulation), [*simulation.observers]
        fresh = objects(parts, {})
        for path in numbers:
            tree = changed(checkpoint.tree, path, lambda inner, key: inner.__setitem__(key, value))
            try:
                Restorer(parts, tree, checkpoint.arrays, there)
            except Mismatch as refused:
                assert str(refused) and not any(talk in str(refused) for talk in TALK)
            else:
                held = path[-3:-1] == (2, "tuple") and value == "x"  # a word is as good as a number there
                assert held, f"{path} was taken"

            for thing, attributes in fresh.values():
                vars(thing).clear()
                vars(thing).update(attributes)
        closed(files)


def at(whole: Any, path: tuple) -> Any:
    for step in path:
        whole = whole[step]
    return whole


@pytest.mark.parametrize("value", [None, [], "x", 3.0], ids=str)
@pytest.mark.parametrize("part", ["scene", "made", "tree"])
def test_a_part_of_a_checkpoint_of_another_kind_is_refused(kept, capsys, part, value):
    there = copy_of(kept)
    for path in checkpoint_file.checkpoint_files(there):
        path.unlink()
    checkpoint_file.write_checkpoint(checkpoint_file.read_checkpoint(kept[0])._replace(**{part: value}), there)
    assert run_command_line(["resume", str(there)]) == 2
    assert "is whole, but holds no state of a run" in capsys.readouterr().err


@pytest.mark.parametrize("part, value", [("time", float("nan")), ("time", -1.0), ("steps", -1), ("steps", "x")])
def test_a_time_or_a_count_that_no_run_has_is_refused(kept, part, value):
    path = checkpoint_file.write_checkpoint(
        checkpoint_file.read_checkpoint(kept[0])._replace(**{part: value}), copy_of(kept)
    )
    with pytest.raises(checkpoint_file.UnreadableCheckpoint, match="holds no state of a run"):
        checkpoint_file.read_checkpoint(path)


@pytest.mark.parametrize("size", [-3, "long", None, 1e3])
def test_a_file_of_no_size_is_no_state(kept, unfilled, size):
    checkpoint, there = checkpoint_file.read_checkpoint(kept[0]), copy_of(kept)
    spot = next(path for path in paths(checkpoint.tree) if path[-3:] == ("file", "file", 1))
    tree = changed(checkpoint.tree, spot, lambda at, key: at.__setitem__(key, size))
    with TemporaryDirectory() as scratch:
        simulation = Simulation(load(SEA), Path(scratch))
        files = [*simulation.observers]
        with pytest.raises(Mismatch, match=r"cannot have .* bytes"):
            restore(simulation, checkpoint._replace(tree=tree), there)
        closed(files)


def test_a_checkpoint_without_its_backend_is_refused_in_a_sentence(kept, capsys):
    checkpoint, there = checkpoint_file.read_checkpoint(kept[0]), copy_of(kept)
    checkpoint_file.write_checkpoint(
        checkpoint._replace(made={k: v for k, v in checkpoint.made.items() if k != "backend"}), there
    )
    assert run_command_line(["resume", str(there)]) == 2
    assert "the checkpoint was made on None, and this one on" in capsys.readouterr().err


@pytest.mark.slow
@settings(few, max_examples=10)
@given(st.data())
def test_a_state_that_no_run_has_left_is_refused_and_touches_nothing(kept, unfilled, data):
    another_tree(data, kept)


@pytest.mark.slow
@many
@given(st.data())
def test_many_damaged_checkpoints(kept, data):
    decay(data, kept)


@pytest.mark.slow
@many
@given(st.data())
def test_many_checkpoints_that_only_seem_whole(kept, data):
    decay_with_a_true_hash(data, kept)


@pytest.mark.slow
@settings(many, max_examples=300)
@given(st.data())
def test_many_checkpoints_of_other_scenes_and_versions(kept, capsys, data):
    another_state(data, kept, capsys)


@pytest.mark.slow
@many
@given(st.data())
def test_many_states_that_no_run_has_left(kept, unfilled, data):
    another_tree(data, kept)
