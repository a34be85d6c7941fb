"""A rotating column of air has circulation; gusts have none."""

import numpy as np
import pytest

from ocean_sim import basin
from ocean_sim.parts import SceneFacts, config_of

LOOP = 4000  # points on a circle


def circulation(force, wind, radius, centre=(0.0, 0.0), y=0.0):
    """Integral of the acceleration along a circle, by the right hand about +y, and that of its size [m2/s2]."""
    angle = 2.0 * np.pi * (np.arange(LOOP) + 0.5) / LOOP
    out = np.stack([np.sin(angle), 0.0 * angle, np.cos(angle)], axis=1)
    along = np.stack([np.cos(angle), 0.0 * angle, -np.sin(angle)], axis=1)
    a = force(wind, [centre[0], y, centre[1]] + radius * out)
    step = 2.0 * np.pi * radius / LOOP
    return (a * along).sum() * step, np.linalg.norm(a[:, ::2], axis=1).sum() * step


@pytest.mark.parametrize("radius", [1.0, 4.0, 8.0, 15.0])
@pytest.mark.parametrize("acceleration", [3.0, -1.0])
def test_circulation_is_that_of_a_rankine_vortex(build, force, radius, acceleration):
    wind = build("vortex", core_radius=8.0, acceleration=acceleration, inward=2.0, upward=1.0)
    found, _ = circulation(force, wind, radius)
    closed_form = 2.0 * np.pi * acceleration * (radius**2 / 8.0 if radius < 8.0 else 8.0)
    assert found == pytest.approx(closed_form, rel=1e-9)
    assert found == pytest.approx(wind.config.circulation(radius), rel=1e-9)


def test_inward_and_upward_parts(build, force):
    wind = build("vortex", core_radius=8.0, acceleration=0.0, inward=2.0, upward=1.0)
    np.testing.assert_allclose(force(wind, [8.0, 0.0, 0.0], mass=2.0)[0], [-4.0, 2.0, 0.0], atol=1e-14)
    np.testing.assert_allclose(force(wind, [0.0, 0.0, -4.0])[0], [0.0, 0.5, 1.0], atol=1e-14)


def test_it_fades_with_depth(build, force):
    wind = build("vortex", core_radius=8.0, acceleration=1.0, layer=4.0)
    depths = [[8.0, y, 0.0] for y in (3.0, 0.0, -1.0, -4.0, -7.0)]
    np.testing.assert_allclose(force(wind, depths)[:, 2], [-1.0, -1.0, -0.75, 0.0, 0.0], atol=1e-14)


def test_its_axis_drifts_and_comes_in_again(build, force):
    wind = build("vortex", core_radius=2.0, acceleration=1.0, centre=[5.0, 0.0], drift=[4.0, 0.0])
    for _ in range(100):
        wind.advance(0.01)
    assert circulation(force, wind, 1.0, centre=(9.0, 0.0))[0] == pytest.approx(np.pi, rel=1e-9)
    for _ in range(400):
        wind.advance(0.01)  # its rear leaves after (20 + 2 - 5) / 4 s
    assert wind.passage.number == 1
    assert wind.passage.centre[0] == pytest.approx(-22.0 + 4.0 * (5.0 - 4.25), abs=1e-9)


def test_its_noise_is_drawn_from_the_seed_and_has_its_profile(build, force):
    points = np.random.default_rng(1).uniform(-20.0, 20.0, size=(4000, 3)) * [1.0, 0.0, 1.0]
    keys = {"core_radius": 8.0, "acceleration": 3.0}
    quiet, one, again, other = (
        force(build("vortex", seed=seed, noise=noise, **keys), points)
        for seed, noise in ((1, (0.0, 0.0, 0.0)), (1, (0.5, 0.5, 0.0)), (1, (0.5, 0.5, 0.0)), (2, (0.5, 0.5, 0.0)))
    )
    np.testing.assert_array_equal(one, again)
    assert not np.allclose(one, other)
    r = np.hypot(points[:, 0], points[:, 2])
    drawn = (one - quiet) / np.minimum(r / 8.0, 8.0 / r)[:, None]
    assert np.abs(drawn).max(axis=0) == pytest.approx([0.5, 0.5, 0.0], abs=0.01)
    assert drawn.std(axis=0)[:2] == pytest.approx(0.5 / 3.0**0.5, rel=0.03)
    assert np.abs(drawn.mean(axis=0)).max() < 4.0 * 0.29 / np.sqrt(len(points))


@pytest.mark.parametrize("preset", ["narrow", "wide", "noise_only"])
def test_gusts_have_no_circulation_about_the_middle_of_the_basin(build, force, preset_data, preset):
    """A steady field in a box around the centre: zero. On its way: zero on the average of a passage. Noise: zero but
    for chance."""
    volume = preset_data("wind", preset)["volumes"][0]
    quiet, shape = volume | {"noise": [0.0, 0.0, 0.0]}, volume["include"][0] | {"centre": [0.0, 0.0, 0.0]}
    centred = build("gusts", volumes=[quiet | {"include": [shape], "drift": 0.0}])
    found, size = circulation(force, centred, 10.0)
    assert abs(found) <= 1e-9 * size
    if volume.get("drift"):
        wind, sums = build("gusts", volumes=[quiet]), np.zeros(2)
        while wind.passages[0].number == 0:
            sums += circulation(force, wind, 10.0)
            wind.advance(0.01)
        assert abs(sums[0]) < 0.01 * sums[1]
    noise = build("gusts", volumes=[volume | {"include": [shape], "acceleration": [0.0, 0.0, 0.0], "drift": 0.0}])
    found, size = circulation(force, noise, 10.0)
    assert abs(found) < 4.0 * size / np.sqrt(LOOP)


def test_a_vortex_in_a_slice_is_refused():
    config = config_of("wind", "vortex")()
    assert [*config.problems(SceneFacts({}, basin.Config(length=40.0, depth=7.5).build(), 4, 1.0))]
    assert not [*config.problems(SceneFacts({}, basin.Config(length=40.0, width=40.0, depth=7.5).build(), 4, 1.0))]
