"""What a scene names may be of any size: refused at once, in a short sentence that a terminal can show."""

import io
import os
import re
import time
import zipfile
from pathlib import Path

import numpy as np
import pytest

from ocean_sim.__main__ import run_command_line
from ocean_sim.files import input_file, yaml_file
from ocean_sim.files.input_file import Unreadable
from ocean_sim.parts import library
from ocean_sim.verbs.shared.console import escape_controls

SOON = 4.0  # [s] of processor time, on a slow machine: it took 14 and 32
TANK = "duration: 1.0\nbasin: {length: 90.0, width: 90.0, depth: 2.0}\n"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def ask(capfd):
    """Exit code, everything that was printed, and the processor time that it took [s]."""

    def asked(*words: str) -> tuple[int, str, float]:
        began, code = time.process_time(), run_command_line(list(words))
        took, said = time.process_time() - began, capfd.readouterr()
        return code, said.out + said.err, took

    return asked


def bomb(path: str) -> None:
    """Thousands of bytes that unpack to as many millions."""
    head = io.BytesIO()
    np.lib.format.write_array_header_1_0(head, {"descr": "<f8", "fortran_order": False, "shape": (2_500_000,)})
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive, archive.open("x.npy", "w") as file:
        file.write(head.getvalue())
        for _ in range(20):
            file.write(bytes(1_000_000))


@pytest.mark.parametrize(
    "name, reason",
    [
        ("big.csv", "this file has 50000.0 MB; at most 500 MB are read"),
        ("fifo", "this is not a regular file"),
        ("/proc/kmsg", "it has no rows"),  # the kernel gives its size as 0, and then never ends
    ],
)
def test_a_file_that_would_never_be_read_is_refused_at_once(name, reason, ask):
    Path("big.csv").touch()
    os.truncate("big.csv", 50_000_000_000)
    os.mkfifo("fifo")
    Path("s.yaml").write_text(TANK + f"fluid: {{kind: spectral_sea, components: {name}}}\n")
    code, said, _ = ask("check", "s.yaml")
    assert code == 2 and said.count("\n") == 1 and reason in said


def test_an_archive_is_judged_by_what_it_unpacks_to(monkeypatch):
    bomb("bomb.npz")
    assert len(input_file.read_npz("bomb.npz")["x"]) == 2_500_000
    monkeypatch.setattr(input_file, "MAX_FILE_BYTES", 1_000_000)
    assert Path("bomb.npz").stat().st_size < 100_000
    with pytest.raises(Unreadable, match=r"it unpacks to 20\.0 MB; at most 1 MB are read"):
        input_file.read_npz("bomb.npz")
    np.savez("good.npz", x=np.arange(3.0))
    assert input_file.read_npz("good.npz")["x"].tolist() == [0.0, 1.0, 2.0]


def test_a_megabyte_of_values_and_thousands_of_obstacles_are_judged_soon(ask):
    """Too many values are refused by their count, before any is looked at."""
    boxes = "".join(
        f"    - {{min: [{-44 + 0.02 * k:.2f}, -1.0, -1.0], max: [{-43.99 + 0.02 * k:.2f}, 0.0, 1.0]}}\n"
        for k in range(4000)
    )
    text = TANK.replace("depth: 2.0}", "depth: 2.0, obstacles:\n    [" + boxes.replace("    - ", ", ")[2:] + "]}")
    Path("boxes.yaml").write_text(text + "fluid: {kind: mueller, spacing: 1.0}\n")
    code, said, took = ask("check", "boxes.yaml")
    assert code == 0 and took < SOON, said
    Path("values.yaml").write_text(TANK + "fluid: {kind: mueller}\nwind: {volumes: [" + "1.0, " * 190_000 + "1.0]}\n")
    code, said, took = ask("check", "values.yaml")
    assert (code, said) == (2, "values.yaml:1:1: more than 60000 values; a CSV file holds a table\n") and took < SOON


WIDE = "duration: 1.0\nbasin: {length: 200.0, width: 200.0, depth: 10.0}\nfluid: "


@pytest.mark.parametrize(
    "fluid, arch, sentence",
    [
        ("kind: dfsph, particles: 8000000", "cpu", "of about 7611499 at most can be counted in 32 bits"),
        ("kind: dfsph, particles: 4000000", "cuda", "of about 3435973 at most can be counted in 32 bits"),
        ("kind: delta_sph, particles: 9000000", "cpu", "of about 8585748 at most can be counted in 32 bits"),
        ("kind: mueller, particles: 40000000", "cpu", "of about 33554431 at most can be counted in 32 bits"),
        (
            "kind: mueller, spacing: 0.03, fill: [{min: [0, -10, 0], max: [1, -9, 1]}]",
            "cpu",
            "too many to be counted in 32 bits with their parts",
        ),
    ],
)
def test_more_than_32_bits_can_count_is_refused_at_once(fluid, arch, sentence, ask):
    Path("s.yaml").write_text(f"{WIDE}{{{fluid}}}\nruntime: {{arch: {arch}}}\n")
    code, said, took = ask("check", "s.yaml")
    assert code == 2 and took < SOON and said.count("\n") == 1 and sentence in said, said


def test_yaml_reads_alike_with_and_without_libyaml(monkeypatch):
    def read(text: str) -> object:
        try:
            return yaml_file.parse_yaml(text, yaml_file.Location("f", 1, 1))
        except yaml_file.SceneError as error:
            return str(error)

    texts = [path.read_text() for folder in ("scenes", "configs") for path in library(folder).rglob("*.yaml")]
    texts += ["a: [1", "a: &x [*x]", "a: *x", "[" * 5000, "- " * 5000, "a: \x07", "a: 1\n---\nb: 2", "a: 1\na: 2"]
    found = [read(text) for text in texts]
    monkeypatch.setattr(yaml_file, "yaml_loaders", lambda slow=yaml_file.yaml_loaders()[-1:]: slow)
    for text, each in zip(texts, found, strict=True):
        assert read(text) == each, text


def test_a_message_is_short_however_much_is_wrong(ask):
    lists = ", ".join(f"wrong_{k}: 1" for k in range(500))
    Path("s.yaml").write_text(TANK + f"fluid: {{kind: mueller, spacing: 1.0, {lists}}}\ntitle: 5\n")
    code, said, _ = ask("check", "s.yaml")
    assert code == 2 and len(said.encode()) <= 2000 and " more\n" in said
    code, said, _ = ask("check", "s.yaml", "--set", f"title={'a' * 5000}", "--set", f"{'b' * 5000}=1")
    assert code == 2 and len(said.encode()) <= 2000


def test_what_a_terminal_would_obey_is_escaped(ask):
    assert escape_controls("a\x1b[2Jb\u202ec\x9b\n") == "a\\x1b[2Jb\\u202ec\\x9b\n"
    Path("s.yaml").write_text(TANK + 'title: "a \\e[31m sea"\nfluid: {kind: linear_waves, height: 0.5, period: 3.0}\n')
    code, said, _ = ask("check", "s.yaml")
    assert code == 0 and "\x1b" not in said and "a \\x1b[31m sea" in said


def test_a_spoilt_hull_is_told_by_us_alone(ask):
    """The library that reads meshes has words of its own, and warnings of arithmetic."""
    vertices = "v 1 2 nan\nv 1e300 1e300 1e300\nv -1e300 3 4\n"
    Path("a.obj").write_text(vertices + "f 1 2 9\nf 1 2 3\nusemtl none\nmtllib no.mtl\n")
    Path("b.ply").write_text("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nend_header\n1\n2\n3\n")
    Path("c.stl").write_bytes(bytes(80) + b"\xff\xff\xff\xff" + bytes(100))
    for name in ("a.obj", "b.ply", "c.stl"):
        code, said, _ = ask("hull", name)
        assert code == 2 and said.count("\n") == 1 and said.startswith(f"{name}: "), said


def test_a_frame_of_billions_of_points_is_refused_before_one_is_made(ask):
    Path("s.yaml").write_text(
        "basin: {length: 2.0e+9, depth: 0.6}\nfluid: {kind: linear_waves, height: 0.01, period: 1.0}\n"
    )
    code, printed, seconds = ask("check", "s.yaml")
    assert code == 2 and "frames.spacing: a frame would keep 2.08e+10 heights" in printed and seconds < SOON


@pytest.mark.parametrize("kind", ["mueller", "delta_sph", "dfsph"])
def test_too_fine_a_spacing_is_refused_with_the_one_that_fits(kind, ask, monkeypatch):
    """The count of particles, and the least spacing by memory and by what can be counted: that one is accepted."""
    monkeypatch.setattr("ocean_sim.machine.memory_limit", lambda: 4_000_000_000)
    Path("s.yaml").write_text(f"{WIDE}{{kind: {kind}, spacing: 0.0001}}\n")
    code, said, took = ask("check", "s.yaml")
    assert code == 2 and took < SOON and "would make 4e+17 particles" in said, said
    fits = re.search(r"fluid\.spacing from (\S+) m on fits this machine", said)[1]
    assert ask("check", "s.yaml", "--set", f"fluid.spacing={fits}")[0] == 0


def test_a_scene_too_large_for_memory_names_the_spacing_that_fits(ask, monkeypatch):
    monkeypatch.setattr("ocean_sim.machine.memory_limit", lambda: 1_500_000_000)
    Path("s.yaml").write_text(f"{WIDE}{{kind: mueller, spacing: 0.4}}\nrender: null\nframes: null\n")
    code, said, _ = ask("check", "s.yaml")
    fits = re.search(r"this machine has 1.5 GB; fluid\.spacing from (\S+) m on fits", said)[1]
    assert code == 0 and " of memory; " not in ask("check", "s.yaml", "--set", f"fluid.spacing={fits}")[1]


@pytest.mark.parametrize(
    "text, sentence",
    [
        ("fluid:\n\tkind: mueller\n", "s.yaml:2:1: not valid YAML: a tab stands where only spaces may; indent with"),
        ("fluid: {kind: mueller, spacing: 0,1}\n", "is it a decimal comma? Write a point, as in 0.1"),
        ("fluid: {kind: mueller, spacing: 1.0}\nwind: {kind: stress, schedule: {file: gust.csv}}\n", "'gusts.csv'?"),
    ],
)
def test_a_slip_is_answered_by_what_was_meant(text, sentence, ask):
    Path("gusts.csv").write_text("time_s,u10_m_s\n0,5\n1,6\n")
    Path("s.yaml").write_text(text + ("basin: {length: 20.0, depth: 10.0}\n" if "\t" not in text else ""))
    code, said, _ = ask("check", "s.yaml")
    assert code == 2 and sentence in said
