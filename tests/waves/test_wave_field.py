"""A sea that is asked from outside: what it says is what the formulae say, and a square fits to itself."""

import numpy as np
import pytest

from ocean_sim import load, wave_field, waves
from ocean_sim.conventions import Refused
from ocean_sim.waves.exchange import WaveField

SEA = {
    "basin": {"length": 100.0, "width": 100.0, "depth": 40.0, "walls": "none"},
    "fluid": {"kind": "linear_waves", "spectrum": {"significant_wave_height": 1.5, "peak_period": 6.0, "seed": 4}},
}


@pytest.fixture(scope="module")
def field():
    return wave_field(SEA)


def test_a_scene_that_is_loaded_is_asked_as_a_dict_is(field):
    np.testing.assert_array_equal(wave_field(load(SEA)).sea.wavevector, field.sea.wavevector)


def test_water_is_that_of_columns_stretched_from_bed_to_surface():
    """One wave: a omega cosh k(y' + h) / sinh k h cos(k x - omega t), with Wheeler's y' = h (y - eta) / (h + eta)."""
    sea = waves.regular_wave(1.0, 5.0, waves.heading_vector(90.0, 3), 5.0)
    k, omega, theta, time = float(sea.wavenumber[0]), 2.0 * np.pi / 5.0, -0.1, 2.0
    x = (theta + omega * time) / k
    eta = 0.5 * np.cos(theta)
    down = 5.0 * (-1.0 - eta) / (5.0 + eta) + 5.0
    size = 0.5 * omega / np.sinh(5.0 * k)
    hand = size * np.array([np.cosh(k * down) * np.cos(theta), np.sinh(k * down) * np.sin(theta), 0.0])
    np.testing.assert_allclose(WaveField(sea).velocity([[x, -1.0, 0.0]], time)[0], hand, atol=1e-12)


def test_normals_are_across_the_surface(field):
    at, near = np.random.default_rng(1).uniform(-30.0, 30.0, (20, 2)), 1e-5
    x, z = (field.elevation(at + near * step, 12.0) - field.elevation(at - near * step, 12.0) for step in np.eye(2))
    normal = field.normal(at, 12.0)
    np.testing.assert_allclose(-normal[:, 0] / normal[:, 1], x / (2.0 * near), atol=1e-6)
    np.testing.assert_allclose(-normal[:, 2] / normal[:, 1], z / (2.0 * near), atol=1e-6)


def test_water_at_the_surface_rises_as_the_surface_does(field):
    """To first order in the steepness."""
    sea = WaveField(waves.regular_wave(0.01, 5.0, waves.heading_vector(30.0, 3), 40.0))
    at = np.random.default_rng(2).uniform(-30.0, 30.0, (20, 2))
    rising = (sea.elevation(at, 3.001) - sea.elevation(at, 2.999)) / 0.002
    moved = sea.velocity(np.insert(at, 1, 0.0, axis=1), 3.0)
    np.testing.assert_allclose(moved[:, 1], rising, atol=2e-5)


def test_a_square_fits_to_itself_and_keeps_the_height_of_the_sea(field):
    side, cells = 200.0, 32
    heights, again = field.field(cells, side, 5.0), field.periodic(side)
    assert heights.shape == (cells, cells)
    edge = np.stack([np.zeros(9), np.linspace(0.0, side, 9)], axis=1)
    np.testing.assert_allclose(again.elevation(edge, 5.0), again.elevation(edge + [side, 0.0], 5.0), atol=1e-9)
    assert again.sea.significant_height == pytest.approx(field.sea.significant_height)


@pytest.mark.parametrize(
    "ask",
    [
        lambda field: field.elevation(np.zeros((2, 3)), 0.0),  # y read as z
        lambda field: field.normal(np.zeros((2, 3)), 0.0),
        lambda field: field.velocity(np.zeros((2, 2)), 0.0),
        lambda field: field.elevation([1.0, 2.0], 0.0),
        lambda field: field.elevation(None, 0.0),
        lambda field: field.elevation([["a", "b"]], 0.0),
        lambda field: field.elevation(np.zeros((2, 2)), float("nan")),
        lambda field: field.velocity(np.zeros((2, 3)), "0"),
        lambda field: field.field(0, 10.0, 0.0),
        lambda field: field.field(2.5, 10.0, 0.0),
        lambda field: field.field(4, -10.0, 0.0),
        lambda field: field.periodic(float("nan")),
    ],
)
def test_what_is_no_point_no_time_and_no_square_is_said(field, ask):
    with pytest.raises(ValueError, match=r"^(points|time|cells|side): .*(expected|is not)"):
        ask(field)


def test_what_is_not_known_stays_unknown(field):
    """Masked points, none at all, and lists of whole numbers."""
    assert np.isnan(field.elevation([[np.nan, 0.0], [1, 2]], 3)).tolist() == [True, False]
    assert field.elevation(np.zeros((0, 2)), np.array(1.0)).shape == (0,)


def test_water_of_particles_is_refused():
    tank = {"basin": {"length": 1.0, "depth": 0.5}, "fluid": {"kind": "ballistic", "spacing": 0.1}}
    with pytest.raises(Refused, match="not a sum of plane waves"):
        wave_field(tank)
