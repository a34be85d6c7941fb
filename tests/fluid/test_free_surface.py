"""Elevation: flat water lies where it should, beside walls too; spray does not count; a dry place shows the bed."""

import numpy as np
import pytest

from tests.fluid.conftest import put


@pytest.fixture(scope="module")
def sea(water):
    return water(basin={"length": 4.0, "width": 3.0, "depth": 1.0}, spacing=0.1)


def points(length: float, width: float) -> np.ndarray:
    x, z = np.meshgrid(np.linspace(-length / 2, length / 2, 41), np.linspace(-width / 2, width / 2, 31))
    return np.stack([x.ravel(), z.ravel()], axis=1)


def test_flat_water_lies_at_zero_everywhere_up_to_the_walls(sea):
    x = sea.particles.position.to_numpy()
    put(sea, x)
    assert np.abs(sea.elevations(points(4.0, 3.0))).max() < 0.03 * 0.1 + 0.01


def test_a_gentle_slope_is_followed(sea):
    x = sea.particles.position.to_numpy()
    y = (x[:, 1] + 1.0) * (1.0 + 0.1 * x[:, 0]) - 1.0
    put(sea, np.stack([x[:, 0], y, x[:, 2]], axis=1))
    where = points(3.2, 2.4)
    np.testing.assert_allclose(sea.elevations(where), 0.1 * where[:, 0], atol=0.03)


def test_a_lone_drop_is_not_the_surface_and_a_dry_place_shows_the_bed(sea):
    x = sea.particles.position.to_numpy()
    flat = x.copy()
    flat[:, 0] = -2.0 + (x[:, 0] + 2.0) / 2.0
    flat[np.argmax(x[:, 1])] = [-1.0, 0.8, 0.0]
    put(sea, flat)
    at_drop, dry = sea.elevations(np.array([[-1.0, 0.0], [1.5, 0.0]]))
    assert abs(at_drop) < 0.1
    assert dry == -1.0


@pytest.mark.parametrize("top", [1.3, 1.7, 2.5, 3.6])
def test_water_thrown_higher_than_the_grid_is_the_surface(sea, top):
    """A metre of it, and a drop in the uppermost cells, which end at 1 m."""
    x = sea.grid.size.lattice.positions() + [0.0, top, 0.0]
    x[0] = [0.05, 0.95, 0.05]
    put(sea, x)
    np.testing.assert_allclose(sea.elevations(np.array([[0.0, 0.0], [1.0, -0.5]])), top, atol=0.03)


def test_in_a_slice_too(water):
    slice_ = water(basin={"length": 4.0, "width": None, "depth": 1.0}, spacing=0.1)
    line = np.stack([np.linspace(-2.0, 2.0, 50), np.zeros(50)], axis=1)
    assert np.abs(slice_.elevations(line)).max() < 0.02


@pytest.mark.parametrize(
    "walls", [{"x": "periodic"}, {"x_min": "none", "x_max": "no_slip", "z": "periodic"}, "absorbing"]
)
def test_whatever_the_sides_are(water, walls):
    fluid = water(basin={"length": 2.0, "width": 1.0, "depth": 0.6, "walls": walls}, spacing=0.1)
    where = points(2.0, 1.0)
    if isinstance(walls, dict) and "x_min" in walls:
        where = where[where[:, 0] > -0.8]  # nothing holds the water up at the open side
    assert np.abs(fluid.elevations(where)).max() < 0.015


def test_both_ends_of_a_period_are_one_place(water):
    fluid = water(basin={"length": 2.0, "width": None, "depth": 1.0, "walls": {"x": "periodic"}}, spacing=0.05)
    x = fluid.particles.position.to_numpy()
    wave = 0.1 * np.sin(np.pi * x[:, 0] + 1.0)
    put(fluid, np.stack([x[:, 0], (x[:, 1] + 1.0) * (1.0 + wave) - 1.0, x[:, 2]], axis=1))
    line = np.stack([np.linspace(-1.0, 1.0, 41), np.zeros(41)], axis=1)
    np.testing.assert_allclose(fluid.elevations(line), 0.1 * np.sin(np.pi * line[:, 0] + 1.0), atol=0.012)
    ends = fluid.elevations(np.array([[-1.0, 0.0], [1.0, 0.0], [3.0, 0.0]]))
    np.testing.assert_allclose(ends, ends[0], atol=1e-9)


def test_a_film_on_the_bed_is_as_deep_as_its_layers(water):
    fluid = water(basin={"length": 2.0, "width": None, "depth": 1.0}, spacing=0.1)
    for layers in (1, 2, 3):
        x = fluid.grid.size.lattice.positions()
        spray = np.stack([x[:, 0], x[:, 1] + 3.0, x[:, 2]], axis=1) * [10.0, 10.0, 1.0]
        put(fluid, np.where((x[:, 1] < -1.0 + 0.1 * layers)[:, None], x, spray))
        middle = fluid.elevations(np.array([[0.7, 0.0]]))[0]
        assert middle == pytest.approx(-1.0 + 0.1 * layers, abs=0.02), layers


def test_under_a_lid_the_water_ends_at_the_lid_or_before_it(water):
    fluid = water(basin={"length": 2.0, "width": None, "depth": 1.0, "lid": {}}, spacing=0.05)
    line = np.stack([np.linspace(-1.0, 1.0, 21), np.zeros(21)], axis=1)
    full = fluid.elevations(line)
    assert full.max() <= 0.0 and full.min() > -0.01
    x = fluid.grid.size.lattice.positions()
    put(fluid, np.stack([x[:, 0], (x[:, 1] + 1.0) * 0.9 - 1.0, x[:, 2]], axis=1))
    np.testing.assert_allclose(fluid.elevations(line), -0.1, atol=0.03)
