import numpy as np
import pytest
from pydantic import ValidationError

from ocean_sim.observers import gauges
from ocean_sim.observers._csv import columns


@pytest.mark.parametrize("steps_of", [(0.01,), (0.013, 0.002, 0.031), (0.12,)])
def test_rows_do_not_depend_on_the_time_steps(tmp_path, watched, steps_of):
    simulation = watched(steps_of)
    simulation.observers = [
        gauges.Config(elevation={"centre": [0.0, 0.0], "bow": [1.0, 2.0]}).build(tmp_path, simulation)
    ]
    simulation.run(until=0.6)
    table = columns(tmp_path / "gauges.csv")
    assert list(table) == ["time_s", "centre_m", "bow_m"]
    assert len(table["time_s"]) == 13
    np.testing.assert_allclose(table["time_s"], np.arange(13) * 0.05, rtol=0, atol=1e-15)
    np.testing.assert_allclose(table["centre_m"], 0.25 * table["time_s"], atol=1e-9)
    head = (tmp_path / "gauges.csv").read_text()
    assert (
        "# seed: 7\n" in head and "# frame: world\n" in head and "# axes: " in head and "# rate: every 0.05 s" in head
    )


def test_a_gauge_outside_the_basin_is_refused_with_a_sentence(tmp_path, watched):
    simulation = watched()
    config = gauges.Config(elevation={"far": [9.0, 0.0], "short": [0.0], "good": [0.0, 0.0]})
    problems = dict(config.problems(simulation.basin))
    assert problems["elevation.far"] == "x = 9 m is outside the basin, which reaches from -3 to 3 m"
    assert "[x, z]" in problems["elevation.short"] and len(problems) == 2
    with pytest.raises(ValueError, match=r"gauges\.elevation\.far: x = 9 m is outside"):
        config.build(tmp_path, simulation)
    assert gauges.Config(elevation={"middle": [0.0]}).problems(watched(width=None).basin) == []
    assert "slice" in gauges.Config(elevation={"deep": [0.0, 0.0]}).problems(watched(width=None).basin)[0][1]


@pytest.mark.parametrize("wrong", [{}, {"a,b": [0.0, 0.0]}, {"a": []}, {"a": [0.0, 1.0, 2.0]}, {"a": ["x"]}])
def test_a_wrong_gauge_is_an_error_of_the_scene(wrong):
    with pytest.raises(ValidationError):
        gauges.Config(elevation=wrong)


def test_pressure_gauges_are_not_there_yet():
    with pytest.raises(ValidationError, match="pressure"):
        gauges.Config(elevation={"a": [0.0]}, pressure={"bed": [0.0, 0.0, 0.0]})
