"""What the user's cache keeps: found again, made anew by other sources, and no more than a folder may hold."""

import os

import numpy as np
import pytest

from ocean_sim.files import cache_file
from ocean_sim.files.cache_file import cached_arrays


@pytest.fixture
def asked(tmp_path, monkeypatch):
    """Ask for the array of a number; and how often it was made so far."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    made = []

    def ask(number: int) -> int:
        def make() -> dict[str, np.ndarray]:
            made.append(number)
            return {"value": np.full(100, float(number))}

        make.__module__ = "ocean_sim.ship.hull"
        assert cached_arrays("numbers", bytes([number]), make)["value"][0] == number
        return len(made)

    return ask


def test_it_is_found_again_by_the_same_sources_alone(asked, monkeypatch):
    assert [asked(1), asked(1), asked(2), asked(1)] == [1, 1, 2, 2]
    monkeypatch.setattr(cache_file, "source_hashes", lambda: {"ship/hull.py": "changed"})
    assert [asked(1), asked(1)] == [3, 3]
    monkeypatch.setattr(cache_file, "source_hashes", lambda: {"ship/hull.py": "changed", "fluid/sph.py": "changed"})
    assert asked(1) == 3


def test_what_was_not_used_for_the_longest_time_goes(asked, tmp_path, monkeypatch):
    asked(1), asked(2)
    folder = tmp_path / "ocean-sim" / "numbers"
    one = sum(path.stat().st_size for path in folder.iterdir()) // 2
    monkeypatch.setattr(cache_file, "MAX_FOLDER_BYTES", 2 * one)
    for k, path in enumerate(sorted(folder.iterdir(), key=os.path.getmtime)):
        os.utime(path, (k, k))
    assert asked(1) == 2  # used: 2 is the oldest now
    assert asked(3) == 3 and len(list(folder.iterdir())) == 2
    assert [asked(1), asked(3), asked(2)] == [3, 3, 4]


def test_a_spoilt_file_is_made_anew(asked, tmp_path):
    asked(1)
    (path,) = (tmp_path / "ocean-sim" / "numbers").iterdir()
    path.write_bytes(path.read_bytes()[:-20])
    assert [asked(1), asked(1)] == [2, 2]
