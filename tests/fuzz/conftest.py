"""A folder full of files that are none of what a scene needs."""

import os
import random
from pathlib import Path

import pytest


@pytest.fixture(scope="module")
def traps(tmp_path_factory) -> Path:
    """Pipes, folders, loops, empty, cut and random files; the tests of a module share it as their working directory."""
    import trimesh

    folder = tmp_path_factory.mktemp("traps")
    noise = random.Random(9)
    for name in ("fifo", "fifo.stl"):
        os.mkfifo(folder / name)
    for name in ("folder", "folder.stl"):
        (folder / name).mkdir()
    for kind in ("csv", "stl", "obj", "ply"):
        (folder / f"empty.{kind}").write_bytes(b"")
    for kind in ("stl", "obj", "ply", "npz"):
        (folder / f"noise.{kind}").write_bytes(noise.randbytes(2000))
    for kind in ("stl", "ply"):
        (folder / f"words.{kind}").write_text("these are words, not a mesh\n" * 5)
    (folder / "words.csv").write_text("time_s,x_m\nhello,there\nwords,only\n")
    (folder / "short.csv").write_text("time_s,x_m,throttle,rudder_rad\n0,0,0,0\n")
    (folder / "latin.csv").write_bytes("time_s,x_m\n1,\xe9\n".encode("latin-1"))
    (folder / "loop.csv").symlink_to("loop.csv")
    barge = trimesh.creation.box((0.4, 0.3, 1.0))
    (folder / "cut.stl").write_bytes(barge.export(file_type="stl")[:-70])
    barge.update_faces([True] * 10 + [False] * 2)
    barge.export(folder / "hole.stl")
    before = os.getcwd()
    os.chdir(folder)
    yield folder
    os.chdir(before)
