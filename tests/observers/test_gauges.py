import numpy as np
import pytest
from pydantic import ValidationError

import ocean_sim
from ocean_sim.basin import Config as Tank
from ocean_sim.files.csv_file import read_columns
from ocean_sim.observers import gauges
from ocean_sim.reading.scene import observer_names
from tests.conftest import quickly


@pytest.mark.parametrize("steps_of", [(0.01,), (0.013, 0.002, 0.031), (0.12,)])
def test_rows_do_not_depend_on_the_time_steps(tmp_path, watched, steps_of):
    simulation = watched(steps_of)
    simulation.observers = [
        gauges.Config(elevation={"centre": [0.0, 0.0], "bow": [1.0, 2.0]}).build(tmp_path, simulation)
    ]
    simulation.run(until=0.6)
    table = read_columns(tmp_path / "gauges.csv")
    assert list(table) == ["time_s", "centre_m", "bow_m"]
    assert len(table["time_s"]) == 13
    np.testing.assert_allclose(table["time_s"], np.arange(13) * 0.05, rtol=0, atol=1e-15)
    np.testing.assert_allclose(table["centre_m"], 0.25 * table["time_s"], atol=1e-9)
    head = (tmp_path / "gauges.csv").read_text()
    assert (
        "# seed: 7\n" in head and "# frame: world\n" in head and "# axes: " in head and "# rate: every 0.05 s" in head
    )


def test_a_gauge_outside_the_basin_is_refused_with_a_sentence(watched):
    simulation = watched()
    config = gauges.Config(elevation={"far": [9.0, 0.0], "short": [0.0], "good": [0.0, 0.0]})
    problems = dict(config.misplaced_gauges(simulation.basin))
    assert problems["elevation", "far"] == "x = 9 m is outside the basin, which reaches from -3 to 3 m"
    assert "[x, z]" in problems["elevation", "short"] and len(problems) == 2
    assert gauges.Config(elevation={"middle": [0.0]}).misplaced_gauges(watched(width=None).basin) == []
    assert "2-D" in gauges.Config(elevation={"deep": [0.0, 0.0]}).misplaced_gauges(watched(width=None).basin)[0][1]


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
    table = read_columns(tmp_path / "gauges.csv")
    assert list(table) == ["time_s", "bow_m", "bow_Pa", "bed_Pa"]
    np.testing.assert_allclose(table["bow_Pa"], 9810.0 + 100.0 * table["time_s"], rtol=1e-8)
    np.testing.assert_allclose(table["bed_Pa"], 19620.0 + 100.0 * table["time_s"], rtol=1e-8)
    alone = watched(width=None)
    alone.observers = [gauges.Config(pressure={"wall": [3.0, -0.5]}).build(tmp_path, alone)]
    alone.run(until=0.1)
    assert read_columns(tmp_path / "gauges.csv")["wall_Pa"][0] == pytest.approx(4905.0)


def test_a_pressure_gauge_may_be_on_a_wall_and_above_the_water_but_not_outside(watched):
    wet = gauges.Config(pressure={"corner": [3.0, -2.0, 2.0], "side": [-3.0, -1.0, 0.0], "high": [0.0, 9.0, 0.0]})
    assert wet.misplaced_gauges(watched().basin) == []
    beyond = gauges.Config(pressure={"deep": [0.0, -2.1, 0.0], "far": [0.0, 0.0, 2.1], "flat": [0.0, -1.0]})
    problems = dict(beyond.misplaced_gauges(watched().basin))
    assert problems["pressure", "deep"] == "y = -2.1 m is outside the basin, whose bed is at -2 m"
    assert "z = 2.1 m is outside" in problems["pressure", "far"] and "[x, y, z]" in problems["pressure", "flat"]
    assert "2-D" in gauges.Config(pressure={"a": [0.0, 0.0, 0.0]}).misplaced_gauges(watched(width=None).basin)[0][1]
    assert "outside" in gauges.Config(pressure={"a": [0.0, 0.1, 0.0]}).misplaced_gauges(watched(lid={}).basin)[0][1]


@pytest.mark.parametrize("kind", ["linear_waves", *quickly("delta_sph", "dfsph")])
def test_the_level_that_water_loses_to_its_own_weight_is_in_the_heading(tmp_path, kind):
    """g h2 / (2 c2) of the depth, in the scheme whose column is pressed together, and not a word in the others."""
    quiet = {name: None for name in observer_names() if name not in ("manifest", "gauges")}
    sea = {"height": 0.02, "period": 1.0} if kind == "linear_waves" else {"spacing": 0.02}
    scene = {"basin": {"length": 0.4, "depth": 0.4}, "fluid": {"kind": kind, **sea}, "duration": 0.01} | quiet
    config = ocean_sim.load(scene | {"runtime": {"threads": 1}, "gauges": {"elevation": {"mid": [0.0]}, "every": 0.01}})
    first = ocean_sim.run(config, tmp_path).gauges["mid_m"][0]
    (line,) = [x for x in (tmp_path / "gauges.csv").read_text().splitlines() if "hydrostatic_offset" in x] or [None]
    assert (line is not None) == (kind == "delta_sph")
    if line is not None:
        lower = 9.81 * 0.4**2 / (2.0 * config.fluid.sound_speed(config.preflight.tank) ** 2)
        assert float(line.split("lowers its level by ")[1].split(" m ")[0]) == pytest.approx(lower, rel=2e-3)
        assert first == pytest.approx(-lower, abs=0.1 * lower)


@pytest.mark.parametrize("kind", ["mueller", *quickly("delta_sph", "dfsph")])
def test_who_asks_for_pressures_that_are_no_measurements_is_told(tmp_path, kind):
    still = {"duration": 1e-3, "basin": {"length": 2.0, "depth": 0.5}, "fluid": {"kind": kind, "spacing": 0.05}}
    quiet = dict.fromkeys(name for name in observer_names() if name != "manifest") | {"render": None}
    quiet["gauges"] = {"pressure": {"bed": [0.0, -0.5]}}
    scene = ocean_sim.load(still | quiet)
    read = ocean_sim.run(scene, out=str(tmp_path / "run")).gauges["bed_Pa"][0]
    told = any("no measurements" in warning for warning in scene.warnings())
    assert told == (abs(read / (1000.0 * 9.81 * 0.5) - 1.0) > 0.05)


def face(place, **keys) -> np.ndarray:
    """(n, 3) points [m] of a sensor from its middle."""
    sensor = gauges.Sensor(**keys)
    return sensor.face_points(place) - np.array((*sensor.at, 0.0)[:3])


def test_the_points_of_a_sensor_have_the_moments_of_its_face(watched):
    """Of a disc of radius R the mean of u2 is R2 / 4, of a segment of length D it is D2 / 12."""
    points = face(watched().basin, at=[3.0, -1.0, 0.0], diameter=0.4)
    assert len(points) == 18 and not points[:, 0].any()
    np.testing.assert_allclose(points.mean(axis=0), 0.0, atol=1e-15)
    np.testing.assert_allclose(points[:, 1:].T @ points[:, 1:] / 18, 0.2**2 / 4.0 * np.eye(2), atol=1e-15)
    assert np.linalg.norm(points, axis=1).max() < 0.2
    points = face(watched(width=None).basin, at=[3.0, -1.0], diameter=0.4)
    assert len(points) == 9 and not points[:, [0, 2]].any() and abs(points.mean()) < 1e-15
    assert (points[:, 1] ** 2).mean() == pytest.approx(0.4**2 / 12.0, rel=1.0 / 80.0)


@pytest.mark.parametrize("width", [4.0, None])
def test_a_sensor_in_waves_reads_less_the_larger_it_is(tmp_path, watched, width):
    """The mean of cos kx over a segment of length D is sin(kD/2) / (kD/2) of that at its middle, over a disc
    2 J1(kR) / (kR)."""
    from scipy.special import j1

    simulation, k = watched(width=width), 3.0
    simulation.fluid.pressures = lambda points: 500.0 * np.cos(k * np.asarray(points)[:, 0] - 0.4)
    sensors, flat = {"point": [0.3, -2.0, 0.0][: 3 if width else 2]}, [0.0] if width else []
    for n, diameter in enumerate((0.0, 0.1, 0.5, 0.9)):
        sensors[f"s{n}"] = {"at": [0.3, -2.0, *flat], "diameter": diameter}
    simulation.observers = [gauges.Config.model_validate({"pressure": sensors}).build(tmp_path, simulation)]
    simulation.run(until=0.05)
    table = {name: column[0] for name, column in read_columns(tmp_path / "gauges.csv").items()}
    assert table["s0_Pa"] == table["point_Pa"] == pytest.approx(500.0 * np.cos(0.5), rel=1e-8)
    for name, diameter in (("s1", 0.1), ("s2", 0.5), ("s3", 0.9)):
        half = 0.5 * k * diameter
        share = 2.0 * j1(half) / half if width else np.sin(half) / half
        assert table[f"{name}_Pa"] == pytest.approx(share * table["point_Pa"], rel=0.006), diameter
    points = 18 if width else 9
    place = [0.3, -2.0, *flat]
    head = (tmp_path / "gauges.csv").read_text()
    assert f"# s2_Pa: mean pressure over 0.5 m about {place} m, of {points} points\n" in head
    assert f"# s0_Pa: pressure at {place} m\n" in head


def test_a_sensor_half_out_of_the_water_reads_the_force_on_it(tmp_path, watched):
    """Half wet in still water a segment of length D reads rho g D / 8, to the 1/81 of nine points."""
    simulation = watched(width=None)
    simulation.fluid.pressures = lambda points: np.maximum(-9810.0 * np.asarray(points)[:, 1], 0.0)
    sensors = {"wall": {"at": [3.0, 0.0], "diameter": 0.2}}
    simulation.observers = [gauges.Config.model_validate({"pressure": sensors}).build(tmp_path, simulation)]
    simulation.run(until=0.05)
    assert read_columns(tmp_path / "gauges.csv")["wall_Pa"][0] == pytest.approx(9810.0 * 0.2 / 8.0, rel=1.0 / 80.0)


def test_a_sensor_is_flush_with_what_is_nearest_or_as_it_is_turned(watched):
    place = watched(obstacles=[{"min": [0.0, -2.0, -1.0], "max": [1.0, -1.0, 1.0]}]).basin
    for at, axis in (
        ([2.9, -1.5, 0.0], 0),
        ([2.0, -1.95, 0.0], 1),
        ([-2.0, -1.0, -1.9], 2),
        ([-0.1, -1.5, 0.0], 0),  # in front of the box
        ([0.5, -1.0, 0.0], 1),  # on its top
        ([0.5, -1.5, 1.0], 2),  # on its side
    ):
        points = face(place, at=at, diameter=0.05)
        assert not points[:, axis].any() and np.ptp(points, axis=0).min() == 0.0 < np.median(np.ptp(points, axis=0))
    points = face(place, at=[0.0, -0.5, 0.0], diameter=0.2, normal=[1.0, 1.0, 0.0])
    np.testing.assert_allclose(points @ [1.0, 1.0, 0.0], 0.0, atol=1e-15)
    np.testing.assert_allclose((points**2).sum(axis=1).mean(), 0.1**2 / 2.0)


@pytest.mark.parametrize(
    "sensor, said",
    [
        (
            {"at": [3.0, -1.9, 0.0], "diameter": 0.3},
            "the face of 0.3 m about [3.0, -1.9, 0.0] reaches out of the basin",
        ),
        ({"at": [2.9, -1.0, 0.0], "diameter": 0.3, "normal": [0.0, 1.0, 0.0]}, "reaches out of the basin"),
        ({"at": [3.0, -1.0, 0.0], "diameter": 0.3, "normal": [0.0, 1.0]}, "should be [x, y, z]"),
        ({"at": [3.0, -1.0, 0.0], "diameter": 0.3, "normal": [0.0, 0.0, 0.0]}, "points nowhere"),
        ({"at": [3.1, -1.0, 0.0], "diameter": 0.3}, "x = 3.1 m is outside the basin"),
    ],
)
def test_a_face_that_cannot_be_there_is_refused(watched, sensor, said):
    config = gauges.Config.model_validate({"pressure": {"a": sensor}})
    ((key, sentence),) = config.misplaced_gauges(watched().basin)
    assert key == ("pressure", "a") and said in sentence


def test_a_face_may_touch_the_bed_and_needs_a_wall_or_a_normal(watched):
    touching = gauges.Config.model_validate({"pressure": {"a": {"at": [3.0, -1.9, 0.0], "diameter": 0.2}}})
    assert touching.misplaced_gauges(watched().basin) == []
    alone = watched(walls="none", floor="none").basin
    assert "give its normal" in touching.misplaced_gauges(alone)[0][1]
    turned = {"at": [0.0, -1.0, 0.0], "diameter": 0.2, "normal": [1.0, 0.0, 0.0]}
    assert gauges.Config.model_validate({"pressure": {"a": turned}}).misplaced_gauges(alone) == []


def test_a_basin_without_a_surface_has_no_elevation(watched):
    place = watched(walls={"y": "periodic"}, floor="none").basin
    assert "no surface" in dict(gauges.Config(elevation={"a": [0.0, 0.0]}).misplaced_gauges(place))[("elevation",)]
    assert gauges.Config(pressure={"a": [0.0, -1.0, 0.0]}).misplaced_gauges(place) == []


def test_a_gauge_over_a_dry_block_reads_its_top_and_one_beside_it_the_bed():
    """Also over blocks on each other; below a block in the air is what is there."""
    on_bed, stacked, in_air = (
        ((x, low, -1e30), (x + 0.4, up, 1e30)) for x, low, up in ((0.4, -0.5, -0.1), (0.4, -0.1, 0.2), (1.0, 0.1, 0.3))
    )
    columns = np.array([[0.6, 0.0], [0.2, 0.0], [1.2, 0.0]])
    dry = np.full(3, -0.5)
    np.testing.assert_allclose(gauges.dry_tops([on_bed], columns, dry), [-0.1, -0.5, -0.5])
    np.testing.assert_allclose(gauges.dry_tops([stacked, on_bed, in_air], columns, dry), [0.2, -0.5, -0.5])
    np.testing.assert_allclose(gauges.dry_tops([on_bed], columns, np.array([0.05, 0.05, 0.05])), 0.05)


def test_a_pressure_gauge_inside_an_obstacle_is_warned_of():
    basin = {"length": 2.0, "depth": 0.5, "obstacles": [{"min": [0.4, -0.5], "max": [0.8, -0.1]}]}
    points = {"inside": [0.6, -0.3], "on_top": [0.6, -0.1], "beside": [0.2, -0.3]}
    made = {"basin": basin, "fluid": {"kind": "delta_sph", "spacing": 0.05}, "gauges": {"pressure": points}}
    said = [w for w in ocean_sim.load(made).warnings() if "inside an obstacle" in w]
    assert said == ["pressure.inside is inside an obstacle, where there is no water"]


BEACH = {"profile": [[-3.0, -2.0], [-2.0, -2.0], [3.0, 1.0]]}  # rises by 3 in 5, to the still water at x = 1.33 m


def test_a_gauge_over_a_dry_beach_reads_nan_and_one_in_the_water_its_height(tmp_path, watched):
    simulation = watched((0.05,), floor=BEACH, obstacles=[{"min": [1.9, 0.2, -2.0], "max": [2.1, 1.2, 2.0]}])
    places = {"sea": [1.0, 0.0], "beach": [1.5, 0.0], "block": [2.0, 0.0]}
    simulation.observers = [gauges.Config(elevation=places, runup={"shore": {}}).build(tmp_path, simulation)]
    simulation.run(until=0.1)
    table = read_columns(tmp_path / "gauges.csv")
    np.testing.assert_allclose(table["sea_m"], [0.0, 0.0125, 0.025], atol=1e-9)
    assert np.isnan(table["beach_m"]).all() and (table["block_m"] == 1.2).all()
    assert table["shore_m"] == pytest.approx(0.0, abs=0.5)  # particles 0.5 m apart
    head = (tmp_path / "gauges.csv").read_text()
    assert "nan over a dry bed" in head and "highest place of the bed that water touches along x at z = 0 m" in head


@pytest.mark.parametrize("spacing", [0.02, 0.05])
def test_still_water_over_a_beach_of_1_to_5_runs_up_by_nothing(spacing):
    """Nor do a puddle beyond a dry gap, a drop in the air and water beside the line count."""
    floor = {"profile": [[-1.5, -0.4], [-1.0, -0.4], [1.5, 0.1]]}
    basin = Tank.model_validate({"length": 3.0, "width": 1.0, "depth": 0.4, "floor": floor}).build()
    axes = [np.arange(low + 0.5 * spacing, up, spacing) for low, up in ((-1.5, 1.5), (-0.4, 0.0), (-0.5, 0.5))]
    lattice = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    water = lattice[basin.ground.distances(lattice) > 0.3 * spacing]
    line = gauges.Runup(at=0.2)
    assert line.height(water, basin, spacing) == pytest.approx(0.0, abs=spacing)
    puddle, drop, beside = (
        [x, 0.2 * x - 0.2 + up, z] for x, up, z in ((1.4, 0.01, 0.2), (1.2, 0.3, 0.2), (1.1, 0.01, 0))
    )
    more = np.concatenate([water, [puddle, drop, beside]])
    assert line.height(more, basin, spacing) == line.height(water, basin, spacing)
    assert np.isnan(line.height(more[:0], basin, spacing))


@pytest.mark.parametrize(
    "floor, width, line, said",
    [
        ("free_slip", 4.0, {}, "this bed is flat: water runs up one with basin.floor.profile"),
        (BEACH, None, {"along": "z"}, "in a slice, in x-y, water runs up along x"),
        (BEACH, 4.0, {"at": 2.5}, "z = 2.5 m is outside the basin, which reaches from -2 to 2 m"),
        (BEACH, 4.0, {"along": "z", "at": -3.5}, "x = -3.5 m is outside the basin"),
    ],
)
def test_a_run_up_that_cannot_be_measured_is_refused(watched, floor, width, line, said):
    config = gauges.Config.model_validate({"runup": {"shore": line}})
    ((key, sentence),) = config.misplaced_gauges(watched(width=width, floor=floor).basin)
    assert key == ("runup", "shore") and said in sentence


def test_a_faulty_bed_is_not_called_flat(watched):
    config = gauges.Config.model_validate({"runup": {"shore": {}}})
    assert not [*config.misplaced_gauges(watched(floor={"profile": [[-1.0, -900.0], [1.0, 900.0]]}).basin)]


def test_a_run_up_has_a_column_of_its_own():
    with pytest.raises(ValidationError, match="both have the column shore_m"):
        gauges.Config.model_validate({"runup": {"shore": {}}, "elevation": {"shore": [0.0, 0.0]}})


def test_a_sensor_on_a_beach_looks_away_from_it_and_one_inside_is_warned_of(watched):
    place = watched(floor=BEACH).basin
    points = face(place, at=[0.5, -0.5, 0.0], diameter=0.2)
    np.testing.assert_allclose(place.ground.distances(points + [0.5, -0.5, 0.0]), 0.0, atol=1e-12)
    basin = {"length": 6.0, "depth": 2.0, "floor": BEACH}
    sensors = {"on": [0.5, -0.5], "inside": [0.5, -0.6], "above": [0.5, -0.4]}
    made = {"basin": basin, "fluid": {"kind": "delta_sph", "spacing": 0.1}, "gauges": {"pressure": sensors}}
    said = [w for w in ocean_sim.load(made).warnings() if "inside the bed" in w]
    assert said == ["pressure.inside is inside the bed, where there is no water"]
