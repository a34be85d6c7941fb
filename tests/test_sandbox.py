"""What `./sandbox` hands over, with a program in the place of ocean-sim that prints its arguments."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from ocean_sim.parts import library

SANDBOX = library("scenes").parent / "sandbox"
VERSION = ".".join(map(str, sys.version_info[:3]))

pytestmark = pytest.mark.skipif(not SANDBOX.is_file(), reason="an installed package has no sandbox")


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A checkout that is set up already, and whose ocean-sim prints its arguments line by line."""
    shutil.copy(SANDBOX, tmp_path)
    inputs = [tmp_path / "requirements.lock", tmp_path / "pyproject.toml"]
    for file in inputs:
        file.write_text("nothing\n")
    binaries = tmp_path / ".venv" / "bin"
    binaries.mkdir(parents=True)
    program = binaries / "ocean-sim"
    program.write_text("#!/bin/sh\nprintf '%s\\n' \"$@\"\n")
    program.chmod(0o755)
    text = b"".join(file.read_bytes() for file in inputs)
    cksum = subprocess.run(["cksum"], input=text, capture_output=True, check=True).stdout.decode().strip()
    (tmp_path / ".venv" / "stamp").write_text(f"{tmp_path} python {VERSION} {cksum}\n")
    return tmp_path


def lines(checkout: Path, *words: str) -> list[str]:
    command = ["sh", str(checkout / "sandbox"), *words]
    environment = {"PYTHON": sys.executable, "PATH": "/usr/bin:/bin"}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert done.stderr == "", "it sets nothing up"
    return done.stdout.splitlines()


def test_demo_takes_the_next_folder_where_there_is_a_run(checkout):
    runs = checkout / "runs"
    assert lines(checkout, "demo")[:4] == [
        "run",
        str(checkout / "scenes/showcase.yaml"),
        "--out",
        str(runs / "showcase"),
    ]
    for name in ("showcase", "showcase-2"):
        (runs / name).mkdir(parents=True)
    assert lines(checkout, "demo")[3] == str(runs / "showcase-3")


def test_demo_leaves_what_is_said_of_pictures_to_the_run(checkout):
    """Which knows of `--out`, of `render=null`, and of what this machine lacks."""
    options = ["--out", "else where", "--set", "render=null"]
    said = lines(checkout, "demo", *options)
    assert said[-4:] == options and said.index("--out") < len(said) - 4, "later options win"
    assert not [line for line in said if "preview.png" in line]


def test_any_other_verb_goes_to_ocean_sim_as_it_is(checkout):
    assert lines(checkout, "figure", "6-3", "--fast") == ["figure", "6-3", "--fast"]
