"""Meshes, logs and run folders that are empty, cut short or have a bit turned over: a sentence, and the exit code."""

import json
import random
from math import isfinite
from pathlib import Path

import numpy as np
import pytest
from _breakers import decayed
from _settings import few, many
from hypothesis import given
from hypothesis import strategies as st

from ocean_sim import __main__
from ocean_sim.files import csv_file, input_file
from ocean_sim.files.input_file import Unreadable
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.platform.shared import motion_log
from ocean_sim.platform.shared.motion_log import REQUIRED_COLUMNS
from ocean_sim.waves.spectrum_files import read_spectra
from tests.waves.test_spectrum_files import DIALECTS, one_sea

TALK = ("Traceback", "this should not happen", "Errno")


@pytest.fixture
def tell(capsys):
    """What the command line says: `tell("check", "s.yaml")` is (exit code, output, errors)."""

    def run(*arguments: object) -> tuple[int, str, str]:
        code = __main__.run_command_line([str(argument) for argument in arguments])
        out, err = capsys.readouterr()
        return code, out, err

    return run


def spoilt(content: bytes) -> dict[str, bytes]:
    """The same in many states of decay, always alike."""
    dice = random.Random(5)
    ways = {"empty": b"", "zeros": bytes(len(content)), "noise": dice.randbytes(len(content)), "twice": content * 2}
    ways |= {f"cut at {k}": content[:k] for k in sorted(dice.sample(range(1, len(content)), 6))}
    for _ in range(12):
        bit = dice.randrange(8 * len(content))
        flipped = bytearray(content)
        flipped[bit // 8] ^= 1 << bit % 8
        ways[f"bit {bit}"] = bytes(flipped)
    ways["UTF-16"] = content.decode("latin-1").encode("utf-16")
    return ways


def log_text() -> bytes:
    """A motion log of a ship at rest."""
    rows = [{"time_s": 0.01 * k, "specific_force_y_m_s2": 9.81} for k in range(6)]
    lines = [",".join(f"{row.get(name, 0.0):.9g}" for name in REQUIRED_COLUMNS) for row in rows]
    return ("# frame: ship\n" + ",".join(REQUIRED_COLUMNS) + "\n" + "\n".join(lines) + "\n").encode()


@pytest.mark.parametrize("kind", ["stl", "obj", "ply"])
def test_a_spoilt_hull_is_refused_or_is_one(kind, tmp_path, monkeypatch):
    import trimesh

    from ocean_sim.basin.solids.mesh import BadMesh
    from ocean_sim.ship.hull.shapes import MeshFile

    monkeypatch.chdir(tmp_path)
    whole = trimesh.creation.box((0.4, 0.3, 1.0)).export(file_type=kind)
    whole = whole if isinstance(whole, bytes) else whole.encode()
    refused = 0
    for how, content in spoilt(whole).items():
        Path(f"hull.{kind}").write_bytes(content)
        try:
            lower, upper = MeshFile(kind="mesh", file=f"hull.{kind}").bounds()
            assert np.isfinite([lower, upper]).all(), how
        except BadMesh as error:
            refused += 1
            assert str(error).startswith(f"hull.{kind}: ") and not any(talk in str(error) for talk in TALK), (
                how,
                error,
            )
            assert len(str(error)) < 600, how
    assert refused >= 8


def box(kind: str) -> bytes:
    """A hull that is one."""
    import trimesh

    whole = trimesh.creation.box((0.4, 0.3, 1.0)).export(file_type=kind)
    return whole if isinstance(whole, bytes) else whole.encode()


def hull_judged(data, folder: Path) -> None:
    """A decayed mesh is refused in a sentence, or has the size of a thing."""
    from ocean_sim.basin.solids.mesh import BadMesh
    from ocean_sim.ship.hull.shapes import MeshFile

    kind = data.draw(st.sampled_from(["stl", "obj", "ply"]))
    broken = data.draw(decayed(box(kind)))
    path = folder / f"hull.{kind}"
    path.write_bytes(broken.content)
    try:
        assert np.isfinite(MeshFile(kind="mesh", file=str(path)).bounds()).all(), broken.how
    except BadMesh as error:
        assert path.name in str(error) and not any(talk in str(error) for talk in TALK), (broken.how, error)
        assert str(error).isprintable() and len(str(error)) < 600, broken.how


def log_judged(data, folder: Path) -> None:
    """A decayed motion log is refused in a sentence, or holds numbers."""
    broken = data.draw(decayed(log_text()))
    path = folder / "motion.csv"
    path.write_bytes(broken.content)
    try:
        ride = motion_log.read_log(path).ride
        assert all(np.isfinite(column).all() for column in (ride.time, ride.specific_force, ride.rate, ride.attitude))
    except ValueError as error:
        assert str(path) in str(error) and not any(talk in str(error) for talk in TALK), (broken.how, error)
        assert str(error).isprintable() and len(str(error)) < 600, broken.how


@pytest.fixture(scope="module")
def place(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("decayed")


@pytest.mark.parametrize("judged", [hull_judged, log_judged])
@few
@given(st.data())
def test_a_decayed_hull_or_log_is_refused_or_is_one(place, judged, data):
    judged(data, place)


@pytest.mark.slow
@pytest.mark.parametrize("judged", [hull_judged, log_judged])
@many
@given(st.data())
def test_many_decayed_hulls_and_logs(place, judged, data):
    judged(data, place)


def test_materials_that_a_mesh_names_are_not_looked_for(tmp_path):
    from ocean_sim.ship.hull.shapes import MeshFile

    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
    faces = "usemtl x\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    (tmp_path / "hull.obj").write_text(f"mtllib /dev/zero\n{corners}{faces}")
    lower, upper = MeshFile(kind="mesh", file=str(tmp_path / "hull.obj")).bounds()
    assert np.ptp([lower, upper], axis=0).max() == 1.0


def test_a_spoilt_motion_log_is_refused_or_is_one(tmp_path):
    path = tmp_path / "motion.csv"
    refused = 0
    for how, content in spoilt(log_text()).items():
        path.write_bytes(content)
        try:
            assert np.isfinite(motion_log.read_log(path).ride.specific_force).all(), how
        except ValueError as error:
            refused += 1
            assert str(path) in str(error) and not any(talk in str(error) for talk in TALK), (how, error)
    assert refused >= 10


@pytest.mark.parametrize(
    "name, why",
    [
        ("nowhere.csv", "there is no such file"),
        ("", "this is a folder"),
        ("fifo", "not a regular file"),
        ("/dev/zero", "not a regular file"),
        ("nul\0.csv", "cannot be read: embedded null byte"),
        ("y" * 5000, "cannot be read: File name too long"),
    ],
)
def test_what_is_no_file_is_not_opened(name, why, tmp_path):
    import os

    os.mkfifo(tmp_path / "fifo")
    with pytest.raises(input_file.Unreadable, match=why):
        csv_file.Table(tmp_path / name)


def test_a_table_begins_with_a_byte_order_mark_or_not_and_has_even_rows(tmp_path):
    path = tmp_path / "t.csv"
    path.write_bytes(b"\xef\xbb\xbftime_s,x_m\n0,1\n1,2\n")
    assert csv_file.Table(path)["time_s"].tolist() == [0.0, 1.0]
    for content, why in {
        "time_s,x_m\n0,1\n1\n": r"row 2 \(line 3\) has 1 cells under 2 names, '1'",
        "time_s,time_s\n0,1\n": "two columns 'time_s'",
        "time_s,x_m\n": "no rows under a heading",
    }.items():
        path.write_text(content)
        with pytest.raises(input_file.Unreadable, match=why):
            csv_file.Table(path)


def test_files_are_found_from_the_folder_of_the_scene(tmp_path, monkeypatch):
    from ocean_sim.reading.scene import load

    (tmp_path / "scenes" / "deep").mkdir(parents=True)
    tank = "time_s,x_m\n" + "".join(f"{k},0\n" for k in range(4))
    (tmp_path / "scenes" / "tank.csv").write_text(tank)
    scene = tmp_path / "scenes" / "deep" / "s.yaml"
    text = "basin: {{length: 2.0, depth: 1.0, motion: {{file: {}}}}}\nfluid: {{kind: mueller, spacing: 0.2}}\n"
    scene.write_text(text.format("../tank.csv"))
    monkeypatch.chdir(tmp_path)
    first = load("scenes/deep/s.yaml")
    assert load(first.resolved()).basin == first.basin
    scene.write_text(text.format(tmp_path / "scenes" / "tank.csv"))
    assert load(scene).basin.build().config.motion.rows()[0] == "x"
    (tmp_path / "scenes" / "tank.csv").unlink()
    with pytest.raises(SceneError) as caught:
        load("scenes/deep/s.yaml")
    assert str(caught.value).startswith(
        "scenes/deep/s.yaml:1:49: basin.motion.file: scenes/tank.csv: there is no such file"
    )


@pytest.mark.parametrize(
    "verb", [("waves",), ("render", "--quality", "draft"), ("export", "--particles", "vtkhdf"), ("platform",)]
)
def test_a_spoilt_run_folder_is_refused_in_a_sentence(verb, tell, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    cases = {
        "empty": {},
        "words": {
            "manifest.json": b"words",
            "gauges.csv": b"words",
            "motion.csv": b"words",
            "frames/grid.npz": b"words",
        },
        "cut": {"manifest.json": b'{"scene": ', "gauges.csv": b"time_s,a_m\n", "motion.csv": log_text()[:300]},
        "none": {"manifest.json": b"[]", "frames/grid.npz": b"", "frames/frame_00000.npz": b"PK\x03\x04"},
    }
    for name, files in cases.items():
        folder = tmp_path / name
        folder.mkdir()
        for file, content in files.items():
            (folder / file).parent.mkdir(exist_ok=True)
            (folder / file).write_bytes(content)
        code, out, err = tell(verb[0], name, *verb[1:], "--out", f"{name}-out")
        assert code in (1, 2, 3), (name, code, out, err)
        assert err.strip() and not any(talk in err for talk in TALK), (name, err)
        code, out, err = tell(verb[0], name, *verb[1:], "--out", f"{name}-out", "--json")
        assert code in (1, 2, 3) and json.loads(out)["error"], (name, out)


@pytest.mark.parametrize("odd", ["pipe", "device", "folder", "deep"])
def test_no_file_of_a_run_folder_is_waited_for(tmp_path, odd):
    """Each reader of the files of a run ends, with a sentence or without what the file holds."""
    import os

    from ocean_sim.conventions import Refused
    from ocean_sim.observers.shared.page import embedded_picture
    from ocean_sim.observers.shared.run_report import Run
    from ocean_sim.pictures.frame_files import Frame
    from ocean_sim.pictures.water.sea_state import run_scene
    from ocean_sim.result import Result
    from ocean_sim.state import checkpoint_file as checkpoints
    from ocean_sim.studies.shared import study as table
    from ocean_sim.viewer.replay import Recorded

    def put(name):
        path = tmp_path / name
        if odd == "pipe":
            os.mkfifo(path)
        elif odd == "device":
            path.symlink_to("/dev/zero")
        elif odd == "folder":
            path.mkdir()
        else:
            path.write_text("[" * 100_000)
        return path

    for read in (lambda path: Recorded(path.parent), lambda path: Result(path.parent).manifest):
        put("manifest.json") if not os.path.lexists(tmp_path / "manifest.json") else None
        with pytest.raises(Refused):
            read(tmp_path / "manifest.json")
    assert run_scene(tmp_path) == {} and Run(tmp_path).manifest == {}
    with pytest.raises(checkpoints.UnreadableCheckpoint):
        checkpoints.read_checkpoint(put(checkpoints.checkpoint_name(1.0)))
    with pytest.raises(input_file.Unreadable):
        Frame(put("frame_00000.npz"))
    if odd != "deep":
        with pytest.raises(input_file.Unreadable):
            table.read_table(put("results.csv"))
        with pytest.raises(input_file.Unreadable):
            _ = put("events.jsonl") and Result(tmp_path).events
    assert embedded_picture(put("preview.png"), "a picture") == ""


@pytest.mark.parametrize("write", DIALECTS)
def test_a_spoilt_spectrum_is_refused_or_is_one(write, tmp_path):
    path = write(tmp_path, one_sea())
    for name, content in spoilt(path.read_bytes()).items():
        path.write_bytes(content)
        try:
            for record in read_spectra(path):
                for point in filter(None, record.points):
                    assert isfinite(point.spread("mem").state().hm0_m), name
        except Unreadable as error:
            assert str(error).count("\n") == 0 and not any(word in str(error) for word in TALK), name
