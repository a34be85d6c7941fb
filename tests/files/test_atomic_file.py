"""Files that appear whole or not at all, and their names in what the system says."""

import os
import resource
from collections.abc import Iterator

import numpy as np
import pytest

from ocean_sim.__main__ import run_command_line
from ocean_sim.conventions import in_words
from ocean_sim.files.atomic_file import atomic_write
from ocean_sim.verbs.waves import draw_waves, write_columns

RECORD = np.linspace(0.0, 1.0, 1000)


@pytest.fixture
def no_room() -> Iterator[None]:
    """No file may grow beyond 4 kB, as on a disk that is all but full."""
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, limits[1]))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, limits)


def test_what_a_verb_writes_stays_as_it_was_where_there_is_no_room(no_room, tmp_path, capsys):
    writers = {
        "s.json": lambda path: run_command_line(["schema", "--out", str(path)]),
        "spectra.csv": lambda path: write_columns(path, {"frequency_Hz": RECORD}),
        "waves.png": lambda path: draw_waves(path, RECORD, {"here": RECORD}, RECORD, {"here": RECORD}),
    }
    for name, write in writers.items():
        path = tmp_path / name
        path.write_text("earlier")
        try:
            assert write(path) == 1
            said = capsys.readouterr().err.strip()
        except OSError as failure:
            said = in_words(failure)
        assert said == f"File too large: {path}"
        assert path.read_text() == "earlier"
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(writers)


def test_a_file_is_named_by_its_own_name_not_that_of_its_draft(tmp_path):
    with pytest.raises(FileNotFoundError) as failure, atomic_write(tmp_path / "gone" / "a.csv") as draft:
        draft.write_text("")
    assert in_words(failure.value) == f"No such file or directory: {tmp_path / 'gone' / 'a.csv'}"


def test_links_are_followed_and_pipes_are_written_to(tmp_path):
    file, link, pipe = tmp_path / "file", tmp_path / "link", tmp_path / "pipe"
    file.touch()
    link.symlink_to(file)
    with atomic_write(link) as draft:
        draft.write_text("new")
    assert link.is_symlink() and file.read_text() == "new"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    with atomic_write(pipe) as draft:
        draft.write_text("new")
    assert os.read(reader, 9) == b"new" and pipe.is_fifo()
    os.close(reader)
