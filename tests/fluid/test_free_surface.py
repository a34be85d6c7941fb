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


def test_in_a_slice_too(water):
    slice_ = water(basin={"length": 4.0, "width": None, "depth": 1.0}, spacing=0.1)
    line = np.stack([np.linspace(-2.0, 2.0, 50), np.zeros(50)], axis=1)
    assert np.abs(slice_.elevations(line)).max() < 0.02
