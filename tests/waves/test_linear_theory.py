"""Linear waves against closed forms and published tables; the identities of the spectra."""

from math import pi
from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

from ocean_sim import waves
from ocean_sim.basin import Config as BasinConfig
from ocean_sim.basin import motion
from ocean_sim.basin.points import grid_points
from ocean_sim.conventions import GRAVITY
from ocean_sim.reading.scene import load
from tests.waves.closed_forms import pressure

# depth [m], kh, period [s], wavelength, c, cg, H/S of a piston: linear wavemaker theory, Biesel & Suquet (1951) and
# Dean & Dalrymple (1991), computed apart from this program to six digits.
FLUMES = [
    (0.25, 0.3, 3.39293, 5.23599, 1.5432, 1.49878, 0.299947),
    (0.25, 1.0, 1.14935, 1.5708, 1.36668, 1.06016, 0.981789),
    (0.5, 0.5, 2.951, 6.28319, 2.12917, 1.97046, 0.499338),
    (0.5, 1.5, 1.21738, 2.0944, 1.72042, 1.11781, 1.39311),
    (0.5, 3.0, 0.821006, 1.0472, 1.27551, 0.656723, 1.93262),
]


@pytest.mark.parametrize("depth, kh, period, wavelength, c, cg, transfer", FLUMES)
def test_dispersion_speeds_and_the_pistons_transfer(depth, kh, period, wavelength, c, cg, transfer):
    k = waves.wavenumber(2.0 * pi / period, depth)
    assert k * depth == pytest.approx(kh, rel=1e-5)
    assert 2.0 * pi / k == pytest.approx(wavelength, rel=1e-5)
    assert waves.phase_speed(k, depth) == pytest.approx(c, rel=1e-5)
    assert waves.group_speed(k, depth) == pytest.approx(cg, rel=1e-5)
    assert waves.piston_transfer(kh) == pytest.approx(transfer, rel=1e-5)


def test_the_dispersion_relation_holds_to_round_off_from_shallow_to_deep():
    omega = np.geomspace(1e-3, 50.0, 400)
    k = waves.wavenumber(omega, 2.0)
    np.testing.assert_allclose(GRAVITY * k * np.tanh(2.0 * k), omega**2, rtol=1e-13)
    np.testing.assert_allclose(waves.angular_frequency(k, 2.0), omega, rtol=1e-13)
    assert waves.group_speed(k[-1], 2.0) == pytest.approx(0.5 * waves.phase_speed(k[-1], 2.0))
    assert waves.piston_transfer(1e6) == pytest.approx(2.0)


def test_the_standing_wave_of_colagrossi_has_its_period():
    """Phys. Rev. E 87, 023302 (2013): g = H = 1, wavelength 2."""
    assert 2.0 * pi / waves.angular_frequency(pi, 1.0, 1.0) == pytest.approx(3.5515, abs=5e-5)
    assert 2.0 * pi / waves.angular_frequency(pi, 1.0) != pytest.approx(3.5515, rel=0.5)


def moment(n: int, gamma: float) -> float:
    """Of JONSWAP with fp = 1, alpha = 1, up to 30 fp."""
    f = np.geomspace(0.2, 30.0, 40_001)
    return float(np.trapezoid(f**n * waves.jonswap(f, 1.0, 1.0, gamma), f))


@pytest.mark.parametrize(
    "gamma, m0, tm01, tm02, tm10", [(1.0, 1.0, 0.7718, 0.7109, 0.8572), (3.3, 1.525, 0.8344, 0.7778, 0.9033)]
)
def test_the_identities_of_the_spectra(gamma, m0, tm01, tm02, tm10):
    """Mean periods over the peak's, up to 30 fp: the fourth moment grows without bound with the upper frequency."""
    exact = GRAVITY**2 / (5.0 * (2.0 * pi) ** 4)
    assert moment(0, gamma) / exact == pytest.approx(m0, abs=5e-4)
    assert moment(0, gamma) / moment(1, gamma) == pytest.approx(tm01, abs=1e-4)
    assert (moment(0, gamma) / moment(2, gamma)) ** 0.5 == pytest.approx(tm02, abs=1e-4)
    assert moment(-1, gamma) / moment(0, gamma) == pytest.approx(tm10, abs=1e-4)


def test_jonswap_with_gamma_one_is_pierson_moskowitz():
    f = np.linspace(0.05, 2.0, 100)
    np.testing.assert_array_equal(waves.jonswap(f, 0.2, 0.0081, 1.0), waves.pierson_moskowitz(f, 0.2, 0.0081))


@pytest.mark.parametrize("kind, tm01", [("jonswap", 0.8344), ("pierson_moskowitz", 0.7718)])
def test_components_carry_the_variance_of_the_spectrum(kind, tm01):
    spectrum = waves.Spectrum(kind=kind, significant_wave_height=2.0, peak_period=8.0, seed=3)
    sea = spectrum.components(np.array([1.0, 0.0]), 50.0)
    variance = 0.5 * sea.amplitude**2
    assert 4.0 * variance.sum() ** 0.5 == pytest.approx(2.0, rel=1e-6)
    mean_frequency = (variance * sea.omega).sum() / variance.sum() / (2.0 * pi)
    assert 1.0 / mean_frequency == pytest.approx(8.0 * tm01, rel=0.02)  # the band ends at 4 fp
    record = [waves.elevation(sea, np.zeros((1, 2)), time)[0] for time in np.arange(0.0, 2000.0, 1.5)]
    assert 4.0 * np.std(record) == pytest.approx(2.0, rel=0.05)


def test_the_same_seed_makes_the_same_sea_and_another_seed_another():
    def first(seed):
        spectrum = waves.Spectrum(significant_wave_height=1.0, peak_period=5.0, seed=seed)
        return spectrum.components(np.array([1.0, 0.0]), 10.0)

    np.testing.assert_array_equal(first(1).phase, first(1).phase)
    np.testing.assert_array_equal(first(1).omega, first(1).omega)
    assert np.abs(first(1).phase - first(2).phase).max() > 1.0


@pytest.fixture
def sea() -> waves.Components:
    """Three waves that cross on 2 m of water."""
    k = np.array([[0.8, 0.3], [-0.2, 1.1], [2.0, -0.5]])
    return waves.Components(np.array([0.05, 0.03, 0.01]), k, np.array([0.1, 2.0, -1.0]), 2.0)


def test_velocity_is_free_of_divergence_and_rotation_and_displacement_moves_with_it(sea):
    x, step = np.array([[0.3, -0.4, 0.7]]), 1e-5

    def gradient(field):
        return np.stack([(field(x + d) - field(x - d))[0] / (2 * step) for d in step * np.eye(3)], axis=1)

    v = gradient(lambda p: waves.linear_velocity(sea, p, 1.3))
    assert abs(np.trace(v)) < 1e-9 and np.abs(v - v.T).max() < 1e-9
    assert abs(np.trace(gradient(lambda p: waves.displacement(sea, p, 1.3)))) < 1e-9
    moved = (waves.displacement(sea, x, 1.3 + step) - waves.displacement(sea, x, 1.3 - step)) / (2 * step)
    np.testing.assert_allclose(moved, waves.linear_velocity(sea, x, 1.3), atol=1e-9)


def test_linear_momentum_balance_and_a_bed_that_nothing_crosses(sea):
    x, step, g = np.array([[0.3, -0.4, 0.7]]), 1e-5, GRAVITY
    at = lambda t: waves.linear_velocity(sea, x, t)
    acceleration = (at(1.3 + step) - at(1.3 - step))[0] / (2 * step)
    push = [waves.pressure_head(sea, x + d, 1.3) - waves.pressure_head(sea, x - d, 1.3) for d in step * np.eye(3)]
    np.testing.assert_allclose(acceleration, -g * np.ravel(push) / (2 * step), atol=1e-8)
    bed = waves.linear_velocity(sea, np.array([[0.3, -2.0, 0.7]]), 1.3)
    assert abs(bed[0, 1]) < 1e-15


def test_the_surface_has_no_pressure_and_moves_with_the_water(sea):
    points = np.random.default_rng(0).uniform(-5.0, 5.0, (50, 3))
    eta = waves.elevation(sea, points, 0.7)
    points[:, 1] = eta - 1e-9
    np.testing.assert_allclose(pressure(sea, points, 0.7, 1000.0), 0.0, atol=1e-3)
    rising = (waves.elevation(sea, points, 0.7 + 1e-5) - waves.elevation(sea, points, 0.7 - 1e-5)) / 2e-5
    np.testing.assert_allclose(waves.velocity(sea, points, 0.7)[:, 1], rising, atol=1e-6)
    points[:, 1] = eta + 0.1
    assert (pressure(sea, points, 0.7, 1000.0) == 0.0).all()


def test_deep_under_the_waves_the_pressure_is_that_of_still_water():
    sea = waves.regular_wave(0.2, 2.0, np.array([1.0, 0.0]), 500.0)
    deep = np.array([[0.0, -100.0, 0.0], [3.0, -499.0, 0.0]])
    np.testing.assert_allclose(pressure(sea, deep, 0.3, 1000.0), -1000.0 * GRAVITY * deep[:, 1], rtol=1e-6)


def test_headings_say_where_waves_go_to():
    for heading, dimension, expected in [(0.0, 3, (0, 1)), (90.0, 3, (1, 0)), (None, 2, (1, 0)), (270.0, 2, (-1, 0))]:
        np.testing.assert_allclose(waves.heading_vector(heading, dimension), expected, atol=1e-15)
    sea = waves.regular_wave(0.2, 2.0, waves.heading_vector(90.0, 3), 5.0)
    c = sea.omega[0] / sea.wavenumber[0]
    crest = np.array([[c * 0.4, 0.0]])  # where the crest of time 0 has gone to
    assert waves.elevation(sea, crest, 0.4)[0] == pytest.approx(0.1)
    assert waves.elevation(sea, -crest, 0.4)[0] < 0.08


def test_what_cannot_be_is_said():
    basin = BasinConfig(length=10.0, depth=0.5).build()
    assert not list(waves.basin_faults(basin, 0.05, 1.5))
    assert "would break" in next(waves.basin_faults(basin, 0.5, 1.0))
    sideways = BasinConfig(length=10.0, depth=0.5, gravity=(1.0, -9.0, 0.0)).build()
    assert "straight down" in next(waves.basin_faults(sideways))
    assert "2-D" in next(waves.heading_faults(45.0, basin))
    assert not list(waves.heading_faults(270.0, basin))
    with pytest.raises(ValidationError, match="no gamma"):
        waves.Spectrum(kind="pierson_moskowitz", significant_wave_height=1.0, peak_period=5.0, gamma=3.3)
    with pytest.raises(ValidationError, match="either height"):
        waves.WaveTrain(height=1.0)


def test_a_spectrum_that_is_cut_off_keeps_its_height():
    spectrum = waves.Spectrum(significant_wave_height=2.0, peak_period=8.0, cut_off=2.0)
    sea = spectrum.components(np.array([1.0, 0.0]), 50.0)
    assert 4.0 * (0.5 * sea.amplitude**2).sum() ** 0.5 == pytest.approx(2.0, rel=1e-6)
    assert sea.omega.max() <= 2.0 * 2.0 * pi / 8.0 * (1.0 + 1e-9)
    with pytest.raises(ValidationError, match="cut_off"):
        waves.Spectrum(significant_wave_height=2.0, peak_period=8.0, cut_off=1.0)


def test_the_waves_do_not_name_the_basin_that_holds_them():
    """Not even for type checkers: the tank's motion knows the waves, and the basin both."""
    for module in (*(Path(waves.__file__).parent).glob("*.py"), Path(motion.__file__)):
        assert "import Basin" not in module.read_text(encoding="utf-8"), module


def test_the_elevation_on_a_lattice_is_that_at_its_points():
    amount = np.random.default_rng(3).random((40, 4))
    sea = waves.Components(amount[:, 0], amount[:, 1:3], amount[:, 3], 12.0)
    points = grid_points(np.linspace(-20.0, 20.0, 23), np.linspace(-9.0, 9.0, 31))
    assert waves.lattice_rows(points) == 23
    shuffled = np.random.default_rng(5).permutation(len(points))
    assert waves.lattice_rows(points[shuffled]) is None
    np.testing.assert_allclose(
        waves.elevation(sea, points, 7.3)[shuffled], waves.elevation(sea, points[shuffled], 7.3), atol=1e-12
    )


GROWING = {
    "linear_waves": ({}, {"kind": "linear_waves", "height": 0.2, "period": 2.0}, {}),
    "spectral_sea": ({}, {"kind": "spectral_sea", "height": 0.2, "period": 2.0, "tile": 60.0}, {}),
    "a patch of particles": (
        {"walls": "periodic"},
        {"kind": "delta_sph", "spacing": 0.4},
        {"sea": {"kind": "linear_waves", "height": 0.2, "period": 2.0, "ramp": 4.0}},
    ),
    "a piston": (
        {"wavemaker": {"wall": "x_min", "height": 0.2, "period": 2.0, "ramp": 4.0}},
        {"kind": "delta_sph", "spacing": 0.4},
        {},
    ),
}


@pytest.mark.parametrize("water", GROWING)
def test_a_run_that_ends_while_its_waves_grow_is_told_how_high_they_are(water):
    """After half the ramp the share is 1/2, by the symmetry of its window."""
    basin, fluid, more = GROWING[water]
    scene = {"basin": {"length": 25.0, "depth": 2.0} | basin, "fluid": fluid, "duration": 2.0} | more
    if water == "spectral_sea":
        scene["basin"]["width"] = 25.0
    told = [line for line in load(scene).warnings() if "grow from calm water" in line]
    assert len(told) == 1 and "first 4 s" in told[0] and "ends at 2 s, when they have 50 % of their height" in told[0]
    assert not [line for line in load(scene | {"duration": 4.0}).warnings() if "grow from calm water" in line]


def test_the_velocity_of_the_surface_on_a_lattice_is_that_at_its_points():
    rng = np.random.default_rng(4)
    sea = waves.Components(0.02 * rng.random(40), rng.normal(size=(40, 2)), rng.random(40), 3.0, ramp=20.0)
    points = np.insert(grid_points(np.linspace(-20.0, 20.0, 23), np.linspace(-9.0, 9.0, 31)), 1, 0.0, axis=1)
    shuffled = rng.permutation(len(points))
    there = waves.linear_velocity(sea, points[shuffled], 7.3)
    np.testing.assert_allclose(waves.linear_velocity(sea, points, 7.3)[shuffled], there, atol=1e-12)
    points[:, 1] = waves.elevation(sea, points, 7.3)
    np.testing.assert_allclose(waves.velocity(sea, points, 7.3)[shuffled], there, atol=1e-12)
    points[:, 1] = -0.5  # under the surface no lattice is taken
    assert np.abs(waves.linear_velocity(sea, points, 7.3)[shuffled] - there).max() > 0.01
