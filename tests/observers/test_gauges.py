import numpy as np
import pytest
from pydantic import ValidationError

from ocean_sim.files.csv_file import columns
from ocean_sim.observers import gauges


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
    problems = dict(config.misplaced(simulation.basin))
    assert problems["elevation", "far"] == "x = 9 m is outside the basin, which reaches from -3 to 3 m"
    assert "[x, z]" in problems["elevation", "short"] and len(problems) == 2
    with pytest.raises(ValueError, match=r"gauges\.elevation\.far: x = 9 m is outside"):
        config.build(tmp_path, simulation)
    assert gauges.Config(elevation={"middle": [0.0]}).misplaced(watched(width=None).basin) == []
    assert "slice" in gauges.Config(elevation={"deep": [0.0, 0.0]}).misplaced(watched(width=None).basin)[0][1]


@pytest.mark.parametrize(
    "wrong",
    [
        {},
        {"elevation": {"a,b": [0.0, 0.0]}},
        {"elevation": {"a": []}},
        {"elevation": {"a": [0.0, 1.0, 2.0]}},
        {"elevation": {"a": ["x"]}},
        {"elevation": {}, "pressure": {}},
        {"pressure": {"a": [0.0]}},
        {"pressure": {"a": [0.0, 1.0, 2.0, 3.0]}},
    ],
)
def test_a_wrong_gauge_is_an_error_of_the_scene(wrong):
    with pytest.raises(ValidationError):
        gauges.Config(**wrong)


def test_pressure_stands_beside_elevation_or_alone(tmp_path, watched):
    simulation = watched((0.013, 0.002))
    both = gauges.Config(elevation={"bow": [1.0, 0.0]}, pressure={"bow": [1.0, -1.0, 0.0], "bed": [0.0, -2.0, 0.0]})
    simulation.observers = [both.build(tmp_path, simulation)]
    simulation.run(until=0.2)
    table = columns(tmp_path / "gauges.csv")
    assert list(table) == ["time_s", "bow_m", "bow_Pa", "bed_Pa"]
    np.testing.assert_allclose(table["bow_Pa"], 9810.0 + 100.0 * table["time_s"], rtol=1e-8)
    np.testing.assert_allclose(table["bed_Pa"], 19620.0 + 100.0 * table["time_s"], rtol=1e-8)
    alone = watched(width=None)
    alone.observers = [gauges.Config(pressure={"wall": [3.0, -0.5]}).build(tmp_path, alone)]
    alone.run(until=0.1)
    assert columns(tmp_path / "gauges.csv")["wall_Pa"][0] == pytest.approx(4905.0)


def test_a_pressure_gauge_may_be_on_a_wall_and_above_the_water_but_not_outside(watched):
    wet = gauges.Config(pressure={"corner": [3.0, -2.0, 2.0], "side": [-3.0, -1.0, 0.0], "high": [0.0, 9.0, 0.0]})
    assert wet.misplaced(watched().basin) == []
    problems = dict(
        gauges.Config(pressure={"deep": [0.0, -2.1, 0.0], "far": [0.0, 0.0, 2.1], "flat": [0.0, -1.0]}).misplaced(
            watched().basin
        )
    )
    assert problems["pressure", "deep"] == "y = -2.1 m is outside the basin, whose bed is at -2 m"
    assert "z = 2.1 m is outside" in problems["pressure", "far"] and "[x, y, z]" in problems["pressure", "flat"]
    assert "slice" in gauges.Config(pressure={"a": [0.0, 0.0, 0.0]}).misplaced(watched(width=None).basin)[0][1]
    assert "outside" in gauges.Config(pressure={"a": [0.0, 0.1, 0.0]}).misplaced(watched(lid={}).basin)[0][1]


def test_a_basin_without_a_surface_has_no_elevation(watched):
    place = watched(walls={"y": "periodic"}, floor="none").basin
    assert "no surface" in dict(gauges.Config(elevation={"a": [0.0, 0.0]}).misplaced(place))[("elevation",)]
    assert gauges.Config(pressure={"a": [0.0, -1.0, 0.0]}).misplaced(place) == []
