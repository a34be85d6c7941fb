from time import perf_counter, sleep

import numpy as np
import pytest

from ocean_sim.files.csv_file import read_columns
from ocean_sim.observers import timings


def slow(simulation):
    """Every step takes 2 ms, the first one 50 ms more."""
    advance = simulation.fluid.advance

    def late(dt):
        sleep(0.052 if simulation.steps == 0 else 0.002)
        advance(dt)

    simulation.fluid.advance = late
    return simulation


def test_stages_are_timed_and_the_first_step_is_told_apart(tmp_path, watched):
    simulation = slow(watched((0.01,)))
    observer = timings.Config(every=0.1).build(tmp_path, simulation)
    simulation.observers = [observer]
    simulation.run(until=0.4)
    table = read_columns(tmp_path / "timings.csv")
    assert list(table) == [
        "time_s", "steps", "wall_s", "real_time_factor",
        "wind_ms_per_step", "fluid_ms_per_step", "observers_ms_per_step", "other_ms_per_step",
    ]  # fmt: skip
    assert table["steps"].tolist() == [10, 20, 30, 40]
    assert observer.first_step_s > 0.05
    assert (table["fluid_ms_per_step"] >= 2.0).all() and (table["fluid_ms_per_step"] < 40.0).all()
    steps, wall = np.diff(table["steps"], prepend=1.0), np.diff(table["wall_s"], prepend=0.0)
    stages = sum(table[name] for name in list(table)[4:])
    assert 1e3 * wall / steps == pytest.approx(stages, rel=1e-6)
    assert np.diff(table["time_s"], prepend=0.01) / wall == pytest.approx(table["real_time_factor"], rel=1e-6)
    assert "# first_step_s: 0." in (tmp_path / "timings.csv").read_text()


def test_without_a_folder_a_stage_has_a_mean_between_two_marks(watched):
    simulation = slow(watched())
    observer = timings.Config().build(None, simulation)
    simulation.observers = [observer]
    simulation.run(until=0.02)
    before = observer.take_mark(perf_counter())
    simulation.run(until=0.05)
    after = observer.take_mark(perf_counter())
    assert observer.stage_means(before, after)[1]["fluid"] >= 2.0 and after.steps > before.steps
