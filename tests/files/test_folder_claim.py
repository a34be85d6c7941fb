"""One writer a folder: who comes second is refused before anything is touched, and a killed writer holds nothing."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

import ocean_sim
from ocean_sim.__main__ import run_command_line
from ocean_sim.files.atomic_file import atomic_write
from ocean_sim.files.run_files import Claim, FolderClaimed
from ocean_sim.verbs.run import run_folder

SEA = """duration: 0.2
basin: {length: 20.0, width: 20.0, depth: 5.0, walls: none}
fluid: {kind: linear_waves, height: 0.5, period: 3.0}
gauges: {elevation: {here: [0.1, 0.2]}, every: 0.02}
checkpoint: {every: 0.1}
render: null
report: null
runtime: {threads: 1}
"""
HOLDER = """import sys
from pathlib import Path
from ocean_sim.files.run_files import Claim
with Claim(Path(sys.argv[1])):
    print("held", flush=True)
    sys.stdin.read()
"""


@pytest.fixture
def holder(tmp_path):
    """`holder(folder)`: another process that has claimed it."""
    begun = []

    def hold(folder: Path) -> "subprocess.Popen[str]":
        words = [sys.executable, "-c", HOLDER, str(folder)]
        child = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        begun.append(child)
        assert child.stdout.readline() == "held\n"
        return child

    yield hold
    for child in begun:
        child.kill()
        child.communicate()


def bytes_of(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_who_comes_second_is_refused_in_a_sentence_and_touches_nothing(tmp_path, monkeypatch, holder, capsys):
    monkeypatch.chdir(tmp_path)
    Path("sea.yaml").write_text(SEA)
    Path("plan.yaml").write_text("scene: sea.yaml\nseeds: [1]\n")
    assert run_command_line(["run", "sea.yaml", "--out", "run"]) == 0
    first, before = holder(Path("run")), bytes_of(Path("run"))
    verbs = [
        ["run", "sea.yaml", "--out", "run"],
        ["run", "sea.yaml", "--out", "run", "--overwrite"],
        ["resume", "run", "--until", "0.3"],
        ["render", "run", "--no-film"],
        ["report", "run"],
        ["sweep", "plan.yaml", "--out", "run"],
        ["platform", "run", "--out", "run"],
    ]
    for words in verbs:
        capsys.readouterr()
        assert run_command_line(words) == 2, words
        assert capsys.readouterr().err.startswith(f"run: process {first.pid} on "), words
    with pytest.raises(FolderClaimed):
        ocean_sim.run("sea.yaml", "run")
    assert bytes_of(Path("run")) == before
    first.kill()  # without a word
    first.wait()
    assert run_command_line(["resume", "run", "--until", "0.3"]) == 0
    manifest = json.loads(Path("run/manifest.json").read_text())
    assert manifest["simulated_s"] == pytest.approx(0.3)
    Path("run/manifest.json").write_text(json.dumps(manifest | {"outcome": "running"}))
    for words in (["waves", "run"], ["export", "run", "--surface", "ply"], ["report", "run"]):
        capsys.readouterr()
        assert run_command_line(words) == 0, words
        assert capsys.readouterr().err.startswith("run: this run is still running, or was killed"), words
    assert not Path("run/.lock").exists()


def test_without_a_name_two_runs_at_once_take_two_folders(tmp_path, monkeypatch, holder):
    monkeypatch.chdir(tmp_path)
    with run_folder("sea", None, False) as first, run_folder("sea", None, False) as second:
        assert (first, second) == (Path("runs/sea"), Path("runs/sea-2"))
    assert not any(Path("runs").iterdir())  # nothing was written


def test_a_folder_is_claimed_once_whoever_asks_at_once(tmp_path):
    """Many processes ask in the same moment, again and again: never two hold it."""
    script = """import os, sys
from pathlib import Path
from ocean_sim.files.run_files import Claim, FolderClaimed
folder, held = Path(sys.argv[1]), 0
for _ in range(300):
    try:
        with Claim(folder):
            os.close(os.open(folder.parent / "alone", os.O_CREAT | os.O_EXCL))
            os.unlink(folder.parent / "alone")
            held += 1
    except FolderClaimed:
        pass
print(held)
"""
    words = [sys.executable, "-c", script, str(tmp_path / "run")]
    children = [subprocess.Popen(words, stdout=subprocess.PIPE, text=True) for _ in range(3)]
    counts = [int(child.communicate()[0]) for child in children]
    assert [child.returncode for child in children] == [0, 0, 0] and min(counts) > 0


def test_a_folder_that_goes_while_it_is_claimed_is_made_again(tmp_path, monkeypatch):
    """Another holder, who had made it for nothing, removes it between two steps of a claim."""
    folder, made = tmp_path / "run", Path.mkdir
    steps = iter([FileExistsError(folder), None])

    def mkdir(path: Path, *words: object, **more: object) -> None:
        error = next(steps, None) if path == folder else None
        if error:
            raise error
        made(path, *words, **more)

    monkeypatch.setattr(Path, "mkdir", mkdir)
    with Claim(folder):
        assert (folder / ".lock").exists()
    assert not folder.exists() and next(steps, "used up") == "used up"


@pytest.mark.parametrize("out", ["file", "file/run", "nowhere", "nowhere/run"])
def test_what_can_be_no_folder_is_refused(tmp_path, monkeypatch, capsys, out):
    monkeypatch.chdir(tmp_path)
    Path("file").write_text("mine")
    Path("nowhere").symlink_to("elsewhere")
    assert run_command_line(["run", "linear_sea", "--out", out, "--until", "0.1"]) == 2
    assert out in capsys.readouterr().err and Path("file").read_text() == "mine"


def test_what_a_killed_writer_left_unfinished_goes_and_nothing_else_does(tmp_path):
    with pytest.raises(KeyboardInterrupt), atomic_write(tmp_path / "film.mp4") as draft:
        draft.write_text("half")
        left = [tmp_path / draft.name, tmp_path / "frames" / ".frame_00001.77.tmp.npz"]
        raise KeyboardInterrupt
    mine = [tmp_path / name for name in (".profile", "mine.tmp", ".mine.tmp")]
    (tmp_path / "frames").mkdir()
    for path in [*left, *mine]:
        path.write_text("")
    with Claim(tmp_path):
        assert not any(path.exists() for path in left) and all(path.exists() for path in mine)
