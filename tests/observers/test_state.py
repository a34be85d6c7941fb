"""The walk over a run: what it keeps, what it refuses, and that putting it back runs no code."""

import json
from pathlib import Path

import numpy as np
import pytest

from ocean_sim.kernel_library import ti, to_numpy_type
from ocean_sim.observers.shared.csv_rows import CsvFile, Sampled
from ocean_sim.platform.shared.washing import Filter
from ocean_sim.ship.body.rigid_body import RigidBody
from ocean_sim.state import fields as state_fields
from ocean_sim.state.fields import FieldContents, array_shape, group_names
from ocean_sim.state.snapshot import Mismatch, Restorer, Snapshot


def through(root, fresh, folder=Path("/nowhere")):
    """`fresh` in the state of `root`, by way of JSON as in a file."""
    taken = Snapshot(root, folder)
    restoring = Restorer(fresh, json.loads(json.dumps(taken.tree)), taken.arrays, folder)
    restoring.cut()
    return restoring.root


def test_what_has_come_to_be_since_the_start_is_made_anew():
    """A named tuple with an array where there was None; floats to the last bit, and no number that is none is lost."""
    sampled, fresh = Sampled(0.1), Sampled(0.1)
    sampled.rows(0.0, [1.0, 2.0])
    sampled.rows(0.123456789012345678, [np.nan, 1.0 / 3.0], held=(np.float32(0.1), "acoustic", np.inf))
    through({"sampled": sampled}, {"sampled": fresh})
    assert fresh.multiples.next == sampled.multiples.next == 2
    assert fresh.before._fields == sampled.before._fields and fresh.before.time == sampled.before.time
    assert np.array_equal(fresh.before.values, sampled.before.values, equal_nan=True)
    assert fresh.before.held == sampled.before.held and type(fresh.before.held[0]) is np.float32


def test_what_is_one_thing_stays_one_and_what_is_two_stays_two():
    """Data that was shared at the start is not written through: bodies are replaced, never changed."""
    body = RigidBody(1.0, np.eye(3), np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]), np.zeros(3), np.zeros(3))
    moved = RigidBody(1.0, body.inertia_body, np.ones(3), body.orientation, np.ones(3), np.zeros(3))
    fresh = through({"now": moved, "again": moved, "start": body}, {"now": body, "again": body, "start": body})
    assert isinstance(fresh["now"], RigidBody) and fresh["now"] is not body
    assert fresh["now"].position.tolist() == [1.0] * 3 and fresh["start"].position.tolist() == [0.0] * 3
    assert fresh["again"] is fresh["now"] and fresh["now"].inertia_body is fresh["start"].inertia_body


def test_objects_with_a_law_stay_themselves():
    """Compiled kernels know them by identity; a filter goes on where it was."""
    one, fresh = Filter([], [-1.0], 1.0, 0.01), Filter([], [-1.0], 1.0, 0.01)
    one.apply(np.ones(50))
    assert through({"filter": one}, {"filter": fresh})["filter"] is fresh
    assert np.array_equal(fresh.state, one.state) and np.any(fresh.state)


@pytest.mark.parametrize("longest", [2**31 - 1, 30])
def test_fields_of_every_type_and_shape_are_written_and_read_each_in_its_place(longest, monkeypatch, taichi_cpu):
    """However few numbers a row may hold."""
    monkeypatch.setattr(state_fields, "MAX_ROW_LENGTH", longest)
    shapes = [(), (3, 4), (2, 3, 4), (3, 4), *[(5,)] * 33]  # more than a kernel takes
    kinds = [ti.f32] * 4 + [ti.i32] * len(shapes)
    fields = [ti.field(kind, shape) for kind, shape in zip(kinds, [*shapes[:4], *shapes])]
    held = {f"{k}": field for k, field in enumerate([*fields, ti.Vector.field(3, ti.f32, 6)])}
    given = {}
    for k, field in held.items():
        places, first = array_shape(field), 1000 * int(k)
        given[k] = np.arange(first, first + np.prod(places, dtype=int)).reshape(places)
        given[k] = np.asarray(given[k], dtype=to_numpy_type(field.dtype))
    FieldContents().write(held, given)
    for k in ("0", "3", "7", str(len(held) - 1)):
        assert np.array_equal(held[k].to_numpy(), given[k])
    found = FieldContents().read(held)
    for k in held:
        assert found[k].dtype == given[k].dtype and found[k].shape == given[k].shape
        assert np.array_equal(found[k], given[k])


def test_no_row_has_more_numbers_than_can_be_counted_in_32_bits():
    """The largest fields of 1.3 million particles of dfsph: together they have 1.01 times as many."""
    sizes = {"x": 367_688_512, "y": 367_688_512, "z": 367_688_512, "shape": 1_073_866_016, "density": 1_300_000}
    assert list(group_names(sizes)) == [["x", "y", "z"], ["shape", "density"]]


def test_a_file_goes_on_where_it_was(tmp_path):
    """Rows that came later, whole or torn, are cut; nothing is cut before all fits."""
    csv = CsvFile(tmp_path / "a.csv", {"seed": 1}, ["time_s", "x"])
    csv.row([0.0, 1.0])
    taken = Snapshot({"csv": csv, "path": tmp_path / "a.csv", "n": 3}, tmp_path)
    before = (tmp_path / "a.csv").read_bytes()
    csv.row([0.1, 2.0])
    csv.file.write("0.2,3.")
    csv.close()
    late = (tmp_path / "a.csv").read_bytes()
    (tmp_path / "beside").mkdir()
    fresh = {"csv": CsvFile(tmp_path / "beside" / "a.csv", {"seed": 1}, ["time_s", "x"]), "path": None, "n": 0}
    restoring = Restorer(fresh, taken.tree, taken.arrays, tmp_path)
    assert (tmp_path / "a.csv").read_bytes() == late
    restoring.cut()
    assert restoring.root["path"] == tmp_path / "a.csv" and restoring.root["n"] == 3
    restoring.root["csv"].row([0.1, 5.0])
    restoring.root["csv"].close()
    assert (tmp_path / "a.csv").read_bytes() == before + b"0.1,5\n"
    (tmp_path / "a.csv").write_bytes(before[:-3])
    with pytest.raises(Mismatch, match=r"a\.csv is shorter than it was"):
        Restorer(fresh, taken.tree, taken.arrays, tmp_path)


@pytest.mark.parametrize("named", ["b.csv", "deeper/b.csv", "."])
def test_a_path_names_what_the_scene_writes(named, tmp_path):
    (tmp_path / "a.csv").touch()
    with pytest.raises(Mismatch, match=r"its path is '"):
        Restorer({"path": tmp_path / "a.csv"}, {"dict": [["path", {"path": named}]]}, {}, tmp_path)


def test_what_is_not_known_is_refused_with_its_name():
    with pytest.raises(TypeError, match=r"cannot keep part\.b, a builtins\.builtins:set"):
        Snapshot({"part": {"a": 1, "b": {1, 2}}}, Path("/nowhere"))


@pytest.mark.parametrize(
    "tree, sentence",
    [
        ({"of": "os:system", "at": {}, "data": True}, "a os:system, which this program does not make"),
        ({"of": "ocean_sim.runtime:os.system", "at": {}, "data": True}, "which this program does not make"),
        ({"of": "ocean_sim.nothing:Thing", "at": {}, "data": True}, "which this program does not make"),
        ({"file": ["../../etc/passwd", 0]}, "names a file outside its folder"),
        ({"file": ["/etc/passwd", 0]}, "names a file outside its folder"),
        ({"path": "/etc"}, "names a file outside its folder"),
        ({"left": "function"}, "it has part, which this program does not make"),
    ],
)
def test_a_state_makes_nothing_but_data_of_this_package(tree, sentence, tmp_path):
    with pytest.raises(Mismatch, match=sentence):
        Restorer({}, {"dict": [["part", tree]]}, {}, tmp_path)
