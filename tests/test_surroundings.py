"""What a program finds around itself: closed streams, a folder that is gone, no home, names that no system takes."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from ocean_sim import kernel_library
from ocean_sim.__main__ import run_command_line
from ocean_sim.conventions import Refused
from ocean_sim.files.run_files import Claim
from ocean_sim.viewer.session import Source
from tests.conftest import quickly

SCENE = "basin: {length: 1.0, depth: 0.5}\nfluid: {kind: ballistic, spacing: 0.25}\nduration: 0.1\nrender: null\n"
LONG = "a" * 5000


@pytest.fixture
def scene(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "s.yaml"
    path.write_text(SCENE)
    return path


def ask(words: str, **options) -> subprocess.CompletedProcess[str]:
    """A command line in a shell of its own, where `$O` is the program."""
    ours = os.environ | {"O": f"{sys.executable} -m ocean_sim"}
    there = options.pop("env", {})
    env = {name: value for name, value in (ours | there).items() if value is not None}
    return subprocess.run(["sh", "-c", words], capture_output=True, text=True, timeout=120, env=env, **options)


def test_no_folder_can_be_made_where_the_system_makes_up_folders():
    """/proc answers that it is not there, again and again."""
    signal.alarm(20)
    try:
        with pytest.raises(Refused, match="/proc/run: no folder can be made here"):
            Claim(Path("/proc/run"))
    finally:
        signal.alarm(0)


@pytest.mark.parametrize(
    "words",
    [
        *(["check", LONG], ["run", "s.yaml", "--out", LONG], ["resume", LONG], ["render", LONG], ["hull", LONG]),
        *(["schema", "--out", LONG], ["platform", LONG], ["serve", LONG], ["preview", LONG], ["tradeoff", LONG]),
    ],
    ids=lambda words: words[0],
)
def test_a_name_that_is_too_long_is_said_in_one_short_sentence(words, scene, capsys):
    code, said = run_command_line(words), capsys.readouterr().err
    assert code == 2 and "this name is too long" in said and len(said) < 200


def test_what_never_ends_is_not_played(tmp_path):
    os.mkfifo(tmp_path / "s.yaml")
    for name in ("/dev/zero", tmp_path / "s.yaml"):
        with pytest.raises(Refused, match="not a regular file"):
            Source.of(name)


def test_a_folder_that_was_removed_under_ones_feet_is_said(tmp_path, monkeypatch, capsys):
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    assert run_command_line(["run", "showcase"]) == 2
    assert capsys.readouterr().err == "the folder that you are in has been removed; change to another one\n"


def test_bytes_that_are_no_text_are_refused(scene, capsys):
    name = os.fsdecode(b"\xff")
    for setting, why in ((f"title={name}", "this is not UTF-8 text (byte 0xFF)"), (f"{name}=1", "unknown key")):
        assert run_command_line(["check", "s.yaml", "--set", setting]) == 2
        assert why in capsys.readouterr().err


def test_closed_streams_and_narrow_encodings_take_what_is_printed(scene):
    done = ask(
        '$O list cases >&- && $O list cases 2>&- >&- <&- && PYTHONIOENCODING=ascii $O check s.yaml --set "title=Ü"'
    )
    assert (done.returncode, done.stderr) == (0, "") and done.stdout.startswith("\\xdc\n")


@pytest.mark.parametrize("end", quickly(("", "head -1"), ("2>&1", "true"), ("--json", "true")))
def test_a_run_whose_reader_has_gone_goes_on_to_its_end(end, scene):
    words, reader = end
    done = ask(f"{{ $O run s.yaml --until 0.02 --out went_on {words}; echo $? > code; }} | {reader}")
    assert (Path("code").read_text(), done.stderr) == ("0\n", "")
    assert json.loads(Path("went_on/manifest.json").read_text())["outcome"] == "done"


@pytest.mark.parametrize("words", quickly("list", "check s.yaml", "schema", "--help", "list --json", "check no"))
def test_an_answer_that_nobody_reads_keeps_its_exit_code(words, scene):
    done = ask(f"{{ $O {words} 2>&1; echo $? > code; }} | true")
    assert (Path("code").read_text(), done.stderr) == ("2\n" if words == "check no" else "0\n", "")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no device that is full")
@pytest.mark.parametrize("words", quickly("list", "list --json", "schema"))
def test_an_answer_that_finds_no_room_is_said(words, scene):
    done = ask(f"$O {words} > /dev/full")
    assert (done.returncode, done.stderr) == (1, "No space left on device: standard output\n")


def test_without_a_home_the_program_finds_it_or_says_so(scene):
    """Taichi would end the process without a word of ours."""
    begun = [sys.executable, "-c", f"import os; os.environ.pop('HOME'); import {kernel_library.__name__}"]
    assert subprocess.run(begun, capture_output=True, check=False).returncode == 0
    unknown = f"import os; os.environ.pop('HOME'); os.path.expanduser = str; import {kernel_library.__name__}"
    done = subprocess.run([sys.executable, "-c", unknown], capture_output=True, text=True, check=False)
    assert (
        done.returncode == 1 and "Lacking: HOME is not set, and the system knows no folder of this user" in done.stderr
    )
