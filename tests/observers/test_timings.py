from time import sleep

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
    table, summary = read_columns(tmp_path / "timings.csv"), observer.summary()
    assert list(table) == [
        "time_s", "steps", "wall_s", "real_time_factor",
        "wind_ms_per_step", "fluid_ms_per_step", "observers_ms_per_step", "other_ms_per_step",
    ]  # fmt: skip
    assert table["steps"].tolist() == [10, 20, 30, 40]
    assert summary["first_step_s"] > 0.05 and summary["steps"] == 40
    assert 2.0 <= summary["stages"]["fluid"] < 40.0
    assert summary["ms_per_step"] == pytest.approx(sum(summary["stages"].values()))
    assert summary["real_time_factor"] == pytest.approx(0.39 / summary["wall_s"])
    assert "# first_step_s: 0." in (tmp_path / "timings.csv").read_text()


def test_without_a_folder_there_is_a_summary(watched):
    simulation = slow(watched())
    observer = timings.Config().build(None, simulation)
    simulation.observers = [observer]
    assert observer.summary()["steps"] == 0
    simulation.run(until=0.05)
    assert observer.summary()["stages"]["fluid"] >= 2.0
