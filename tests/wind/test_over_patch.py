"""Winds over a patch of open sea that drifts: they travel with it, or stand in the world."""

import numpy as np
import pytest

from ocean_sim import basin
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.reading.scene import load
from ocean_sim.sea.linear_waves import Config as Calm

SPHERE = {"kind": "sphere", "radius": 2.0, "centre": [3.0, 0.0, 0.0]}
GUST = {"include": [SPHERE], "acceleration": [1.0, 0.0, 0.0]}
MIDDLE = np.array([100.0, -7.0])  # of a patch of 20 m by 16 m: at 0, -7 on it
WINDS = {
    "gusts": ({"volumes": [GUST]}, [3.0, 0.0, 0.0]),
    "vortex": ({"centre": [3.0, 0.0], "core_radius": 1.0, "drift": [0.0, 0.0]}, [4.0, 0.0, 0.0]),
}


@pytest.fixture(scope="module")
def patch():
    return basin.Config(length=20.0, width=16.0, depth=5.0, walls="periodic").build(Calm())


def on_patch(point):
    """Where a particle knows this place of the world to be."""
    size = np.array([20.0, 1.0, 16.0])
    return point - size * np.round(point / size) * [1.0, 0.0, 1.0]


@pytest.mark.parametrize("kind", WINDS)
@pytest.mark.parametrize("frame", ["tile", None, "world"])
def test_it_travels_with_the_patch_or_stands_in_the_world(build, force, patch, kind, frame):
    """Particles, known by where they are on the patch, and ships, by where they are in the world, feel the same."""
    keys, place = WINDS[kind]
    wind = build(kind, place=patch, frame=frame, **keys)
    here = np.array(place)
    there = here + [MIDDLE[0], 0.0, MIDDLE[1]]
    at_first = force(wind, here)[0]
    assert np.linalg.norm(at_first) > 0.5
    wind.follow(MIDDLE)
    away = here + [0.0, 0.0, 2.0] if frame != "world" else there
    assert np.linalg.norm(force(wind, away)[0] - at_first) > 0.3
    if frame != "world":
        for point in (there, on_patch(there)):
            assert force(wind, point)[0] == pytest.approx(at_first, abs=1e-4)


@pytest.mark.parametrize("kind", WINDS)
def test_one_that_stands_is_met_where_it_stands(build, force, patch, kind):
    """A patch that has moved on by a whole side and a bit: the wind is no longer where it was on the patch."""
    keys, place = WINDS[kind]
    wind = build(kind, place=patch, frame="world", **keys)
    here, at_first = np.array(place), force(wind, place)[0]
    wind.follow(np.array([4.0, 0.0]))
    assert force(wind, here)[0] == pytest.approx(at_first, abs=1e-4)
    wind.follow(np.array([23.0, 0.0]))  # the patch now reaches from 13 to 33 m
    assert np.linalg.norm(force(wind, here)[0]) < 0.2 * np.linalg.norm(at_first)
    assert np.linalg.norm(force(wind, here + [20.0, 0.0, 0.0])[0]) < 0.2 * np.linalg.norm(at_first)


def test_those_that_it_does_not_act_on_feel_nothing_wherever_the_patch_is(build, force, patch):
    other = GUST | {"targets": ["ship"], "acceleration": [0.0, 0.0, 2.0]}
    wind = build("gusts", place=patch, volumes=[GUST, other])
    wind.follow(MIDDLE)
    at = np.array([3.0 + MIDDLE[0], 0.0, MIDDLE[1]])
    assert force(wind.on("fluid"), at)[0] == pytest.approx([1.0, 0.0, 0.0])
    assert force(wind.on("ship"), at)[0] == pytest.approx([1.0, 0.0, 2.0])


@pytest.mark.parametrize("kind", WINDS)
def test_it_is_drawn_where_it_blows(build, patch, kind):
    keys, _ = WINDS[kind]
    for frame, shift in (("tile", [MIDDLE[0], 0.0, MIDDLE[1]]), ("world", np.zeros(3))):
        wind = build(kind, place=patch, frame=frame, **keys)
        before = wind.drawing().lines
        wind.follow(MIDDLE)
        assert wind.drawing().lines == pytest.approx(before + shift)


@pytest.mark.parametrize("kind", WINDS)
def test_without_an_open_sea_a_frame_is_refused(kind):
    keys, _ = WINDS[kind]
    scene = {
        "duration": 1.0,
        "basin": {"length": 10.0, "width": 10.0, "depth": 5.0},
        "fluid": {"kind": "delta_sph", "spacing": 1.0},
        "wind": {"kind": kind, "frame": "world", **keys},
    }
    with pytest.raises(SceneError, match="a wind has a frame only over a patch of open sea"):
        load(scene)
