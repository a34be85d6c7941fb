"""A full disk, a folder that cannot be written, a run that lies there already, a renderer that is killed."""

import errno
import os
from pathlib import Path

import pytest

from ocean_sim import __main__

SCENE = """
basin: {length: 1.0, depth: 0.5}
fluid: {kind: ballistic, spacing: 0.25}
duration: 0.1
runtime: {threads: 1}
time_step: {kind: fixed, dt: 0.02}
gauges: {elevation: {a: [0.0]}, every: 0.02}
render: null
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("trouble")
    (path / "s.yaml").write_text(SCENE)
    before = os.getcwd()
    os.chdir(path)
    yield path
    os.chdir(before)


@pytest.fixture
def tell(capsys):
    """What the command line says: `tell("run", "s.yaml")` is (exit code, errors)."""

    def run(*arguments: object) -> tuple[int, str]:
        code = __main__.run_command_line([str(argument) for argument in arguments])
        return code, capsys.readouterr().err

    return run


@pytest.fixture
def full(monkeypatch):
    """`full(name, writes)`: after so many writes to files with this in their name the disk is full."""

    def fill(name: str, writes: int) -> None:
        path_open, left = Path.open, [writes]

        def opened(self, mode="r", *rest, **keywords):
            file = path_open(self, mode, *rest, **keywords)
            return Full(file, left) if name in self.name and "r" not in mode else file

        monkeypatch.setattr(Path, "open", opened)

    return fill


class Full:
    """A file on a disk that has room for few writes more."""

    def __init__(self, file, left: list[int]) -> None:
        self.file, self.left = file, left

    def write(self, text: str) -> int:
        self.left[0] -= 1
        if self.left[0] < 0:
            raise OSError(errno.ENOSPC, "No space left on device", self.file.name)
        return self.file.write(text)

    def __enter__(self) -> "Full":
        return self

    def __exit__(self, *exception: object) -> None:
        self.file.close()

    def __getattr__(self, name: str):
        return getattr(self.file, name)


def test_a_run_is_never_written_over_another(folder, tell):
    assert tell("run", "s.yaml", "--out", "kept")[0] == 0
    before = {path.name: path.read_bytes() for path in Path("kept").iterdir() if path.is_file()}
    code, err = tell("run", "s.yaml", "--out", "kept")
    assert code == 2 and "there is a run here already" in err
    code, err = tell("run", "s.yaml", "--out", "s.yaml")
    assert code == 2 and "this is a file, not a folder" in err
    assert before == {path.name: path.read_bytes() for path in Path("kept").iterdir() if path.is_file()}


@pytest.mark.parametrize(
    "name, writes", [("gauges.csv", 3), ("gauges.csv", 0), ("events.jsonl", 0), ("manifest", 0), ("frame_00002", 0)]
)
def test_a_full_disk_ends_a_run_in_a_sentence_and_keeps_what_was_written(folder, tell, full, name, writes):
    out = f"full-{name}-{writes}"
    full(name, writes)
    code, err = tell("run", "s.yaml", "--out", out)
    assert code == 1 and "No space left on device" in err and name in err
    assert "Traceback" not in err and "should not happen" not in err
    if writes:
        assert Path(out, "gauges.csv").read_text().startswith("# ")


def test_a_folder_that_cannot_be_written_is_told(folder, tell, monkeypatch):
    def refused(self, *rest, **keywords):
        raise PermissionError(errno.EACCES, "Permission denied", str(self))

    monkeypatch.setattr(Path, "mkdir", refused)  # root may write anywhere
    code, err = tell("run", "s.yaml", "--out", "locked/run")
    assert code == 1 and err.strip().endswith("Permission denied: locked/run")


def test_a_killed_renderer_is_told_and_the_run_is_kept(folder, tell, monkeypatch):
    from ocean_sim.observers import render

    if not Path("seen").exists():
        assert tell("run", "s.yaml", "--out", "seen")[0] == 0
    before = Path("seen/gauges.csv").read_bytes()
    monkeypatch.setattr(render.opengl, "window", lambda: "egl")
    monkeypatch.setattr(render.opengl, "drawing_environment", lambda window: dict(os.environ))
    monkeypatch.setattr(render.opengl, "forget", lambda: None)
    monkeypatch.setattr(render.Drawer, "follow", lambda self: self.child.kill())
    code, err = tell("render", "seen", "--quality", "draft")
    assert code == 1 and "the drawing process died (signal 9)" in err and "Traceback" not in err
    assert Path("seen/gauges.csv").read_bytes() == before
