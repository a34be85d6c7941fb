"""What `bench` keeps of each machine, and when it says that something has become slower."""

import json

import pytest

from ocean_sim.verbs.shared import history

ORDER = {"scene": "bench/dam_break_6k", "profile": None, "sets": [], "threads": 1, "repeats": 5}


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "ocean-sim"


def row(speed, **other):
    return {
        "library": "taichi",
        "particles": 6000,
        "threads": 1,
        "ms_per_step": 1.5,
        "particle_steps_per_cpu_s": speed,
    } | other


def times(speeds, order=ORDER, **other):
    return [history.slowdown(order, row(speed, **other)) for speed in speeds]


def test_a_measurement_is_compared_with_the_median_of_those_before_it():
    assert times([4.0e6, 4.4e6, 1.0e6, 2.0e6]) == [None, None, None, pytest.approx(2.0)]


def test_only_more_than_a_tenth_slower_is_told():
    times([4.0e6] * 3)
    (a_little,), (more,) = times([3.7e6]), times([3.5e6])
    assert history.slowdown_warning("x", a_little) is None
    assert history.slowdown_warning("x", more).startswith("x: 14 % slower in processor time than before")
    (faster,) = times([8.0e6])
    assert faster == pytest.approx(0.5) and history.slowdown_warning("x", faster) is None


def test_other_scenes_threads_settings_and_machines_are_not_compared(monkeypatch):
    times([4.0e6] * 3)
    assert times([1.0e6], threads=2) == [None]
    assert times([1.0e6], library="quadrants") == [None]
    assert times([1.0e6], ORDER | {"scene": "bench/dam_break_50k"}) == [None]
    assert times([1.0e6], ORDER | {"sets": ["fluid.kind=delta_sph"]}) == [None]
    monkeypatch.setattr(history, "processor_name", lambda: "another")
    assert times([1.0e6]) == [None]


def test_the_newest_are_kept_and_what_cannot_be_read_is_left_out(cache, monkeypatch):
    monkeypatch.setattr(history, "MAX_COMPARED", 5)
    times([1.0e6] * 4)
    times([2.0e6] * 3)
    [speeds] = json.loads(history.bench_file().read_text()).values()
    assert speeds == [1.0e6, 1.0e6, 2.0e6, 2.0e6, 2.0e6]
    [conditions] = json.loads(history.bench_file().read_text())
    for text in ('{"half a li', "[1, 2]", json.dumps({conditions: 3.0}), json.dumps({conditions: ["x", None]})):
        history.bench_file().write_text(text)
        assert times([1.0e6]) == [None]


def test_a_cache_that_cannot_be_written_is_no_failure(cache):
    cache.write_text("a file where the folder should be")
    assert times([1.0e6] * 5) == [None] * 5
