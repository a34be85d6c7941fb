"""Tagged particles under a regular wave in a periodic slice, against linear theory."""

import numpy as np
import pytest

import ocean_sim
from ocean_sim import waves
from ocean_sim.conventions import GRAVITY
from ocean_sim.reading.scene import SceneError
from ocean_sim.waves.orbits import read_tracers, tracer_motion, wave_direction
from tests.waves.closed_forms import orbit_ratio, orbit_sizes

LENGTH, DEPTH, HEIGHT = 1.0, 0.5, 0.03
K = 2.0 * np.pi / LENGTH
PERIOD = 2.0 * np.pi / float(waves.angular_frequency(K, DEPTH))


def scene(**tracers):
    return ocean_sim.load(
        {
            "title": "tracers",
            "duration": 3.1 * PERIOD,
            "basin": {"length": LENGTH, "depth": DEPTH, "walls": {"x": "periodic"}},
            "fluid": {
                "kind": "delta_sph",
                "spacing": 0.05,
                "initial": {"kind": "regular_wave", "height": HEIGHT, "period": PERIOD},
            },
            "runtime": {"threads": 1},
            "tracers": tracers,
            **dict.fromkeys(("accuracy", "timings", "health", "frames", "render", "report")),
        }
    )


@pytest.fixture(scope="module")
def followed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("tracers")
    with ocean_sim.Simulation(scene(boxes=[{"min": [-0.5, -0.45, -1.0], "max": [0.5, -0.05, 1.0]}]), folder) as run:
        run.run(until=3.1 * PERIOD)
    return folder / "tracers.csv"


def test_orbits_are_those_of_linear_theory(followed):
    """Their shape and their decay with depth; a coarse wave loses height, which the ratio does not see."""
    _, _, places, speeds = read_tracers(followed)
    assert wave_direction(places, speeds) == pytest.approx((1.0, 0.0), abs=0.05)
    _, found = tracer_motion(followed, 0.0, PERIOD)
    for low, high in ((-0.2, -0.1), (-0.3, -0.2), (-0.4, -0.3)):
        there = (found.level_m > low) & (found.level_m < high)
        ratio = np.mean([o.ratio for o, inside in zip(found.orbits, there) if inside])
        wanted = float(np.mean(orbit_ratio(K, found.level_m[there], DEPTH)))
        assert ratio == pytest.approx(wanted, rel=0.15)
    along = orbit_sizes(1.0, K, found.level_m, DEPTH)[0]
    assert found.decay_per_m == pytest.approx(np.polyfit(found.level_m, np.log(along), 1)[0], rel=0.15)


def test_paths_go_on_across_a_periodic_side_and_velocities_belong_to_them(followed):
    _, time, places, speeds = read_tracers(followed)
    steps = np.diff(places, axis=1)
    assert np.abs(steps).max() < 0.05
    middle = 0.5 * (speeds[:, 1:] + speeds[:, :-1]) * np.diff(time)[None, :, None]
    assert np.abs(steps - middle).max() < 0.1 * np.abs(steps).max()
    assert np.ptp(np.diff(time)) < 1e-6


def test_waves_that_go_the_other_way_are_told_apart():
    sea = waves.regular_wave(HEIGHT, PERIOD, np.array([-1.0, 0.0]), DEPTH, GRAVITY)
    time = np.linspace(0.0, 3.0 * PERIOD, 100)
    points = np.array([[0.0, -0.1, 0.0], [0.3, -0.2, 0.0]])
    places = np.stack([points + waves.displacement(sea, points, t) for t in time], axis=1)
    speeds = np.stack([waves.linear_velocity(sea, points, t) for t in time], axis=1)
    assert wave_direction(places, speeds) == pytest.approx((-1.0, 0.0), abs=1e-6)


@pytest.mark.parametrize(
    "tracers, said",
    [
        ({}, "at least one of ids and boxes"),
        ({"ids": [-1]}, "not at least 0"),
        ({"ids": [100_000]}, "no particle 100000; there are 200"),
        ({"boxes": [{"min": [3.0, -0.5, -1.0], "max": [4.0, 0.0, 1.0]}]}, "holds no water"),
        ({"boxes": [{"min": [0.0, 0.0, 0.0], "max": [0.0, 1.0, 1.0]}]}, "greater than that of min"),
    ],
)
def test_what_is_wrong_is_said(tracers, said):
    with pytest.raises(SceneError) as error:
        scene(**tracers)
    assert any(said in problem.message for problem in error.value.problems), error.value


def test_a_box_between_particles_is_refused(tmp_path):
    with pytest.raises(ValueError, match="is in it"):
        ocean_sim.Simulation(scene(boxes=[{"min": [0.0, -0.26, -1.0], "max": [0.001, -0.25, 1.0]}]), tmp_path)
