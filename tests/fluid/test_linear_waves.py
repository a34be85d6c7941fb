"""A closed-form sea: what kernels read is what linear theory says, at any time and for any step."""

from math import pi

import numpy as np
import pytest
from pydantic import ValidationError

from ocean_sim import waves
from ocean_sim.basin import Config as BasinConfig
from ocean_sim.conventions import GRAVITY
from ocean_sim.fluid.linear_waves import Config
from ocean_sim.parts import SceneFacts
from ocean_sim.time_step.courant import Config as Courant
from ocean_sim.wind.still import Config as Still
from tests.fluid.conftest import read
from tests.waves.closed_forms import pressure

FLUME = {"length": 10.0, "depth": 0.5}
BAY = {"length": 40.0, "width": 40.0, "depth": 7.5}
KNOWN = ("elevation", "velocity")


@pytest.fixture(scope="module")
def sea(taichi_cpu):
    """Builds a sea: `sea(basin, **keys of the fluid)`."""

    def build(basin: dict, **keys):
        place = BasinConfig(**basin).build()
        return Config(**{"ramp": 0.0} | keys).build(place, 7, accounts=True, wind=Still().build(place, 7))

    return build


@pytest.mark.parametrize(
    "keys",
    [
        {"height": 0.4, "period": 3.0, "heading_deg": 30.0},
        {"spectrum": {"significant_wave_height": 0.5, "peak_period": 4.0, "heading_deg": 200.0, "seed": 5}},
    ],
)
def test_kernels_read_what_the_theory_says(sea, keys):
    fluid = sea(BAY, **keys)
    for dt in (0.1, 0.7, 30.0):
        fluid.advance(dt)
    points = np.random.default_rng(0).uniform([-20.0, -7.5, -20.0], [20.0, 0.4, 20.0], (200, 3))
    found = read(fluid, points, *KNOWN)
    np.testing.assert_allclose(found[:, 0], fluid.elevations(points[:, [0, 2]]), atol=1e-11)
    np.testing.assert_allclose(found[:, 1:], fluid.velocities(points), atol=1e-11)
    wanted = pressure(fluid.plane_waves, points, 30.8, fluid.rest_density)
    np.testing.assert_allclose(fluid.pressures(points), wanted, atol=1e-6)
    there = np.insert(points[:, [0, 2]], 1, fluid.elevations(points[:, [0, 2]]), axis=1)
    np.testing.assert_array_equal(fluid.surface_velocities(points[:, [0, 2]]), fluid.velocities(there))
    np.testing.assert_allclose(fluid.elevations(points[:, [0, 2]]), waves.elevation(fluid.plane_waves, points, 30.8))


def test_a_regular_wave_comes_back_after_its_period_and_not_before(sea):
    fluid = sea(FLUME, height=0.05, period=1.5)
    points = np.array([[0.0, 0.0], [0.7, 0.0], [-2.0, 0.0]])
    first = fluid.elevations(points)
    assert first[0] == pytest.approx(0.025)
    for _ in range(15):
        fluid.advance(0.1)
    np.testing.assert_allclose(fluid.elevations(points), first, atol=1e-12)
    fluid.advance(0.75)
    np.testing.assert_allclose(fluid.elevations(points), -first, atol=1e-12)


def test_a_ramp_lets_the_sea_grow_from_calm_water_in_kernels_and_in_numpy_alike(sea):
    """Half of the height half way; afterwards the sea without a ramp, to the digit."""
    points = np.random.default_rng(1).uniform([-20.0, -7.5, -20.0], [20.0, 0.1, 20.0], (50, 3))
    keys = {"height": 0.4, "period": 3.0, "heading_deg": 30.0}
    growing, whole = sea(BAY, **keys, ramp=6.0), sea(BAY, **keys)
    assert np.abs(growing.elevations(points[:, [0, 2]])).max() == 0.0
    for dt, share in ((3.0, 0.5), (1.5, 0.75 + 0.5 / pi), (2.0, 1.0)):
        growing.advance(dt)
        whole.advance(dt)
        found = read(growing, points, *KNOWN)
        np.testing.assert_allclose(found[:, 0], growing.elevations(points[:, [0, 2]]), atol=1e-11)
        np.testing.assert_allclose(found[:, 1:], growing.velocities(points), atol=1e-11)
        np.testing.assert_allclose(found[:, 0], share * whole.elevations(points[:, [0, 2]]), atol=1e-9)


def test_water_that_was_at_rest_goes_to_and_fro_about_one_place_after_the_ramp(sea):
    """What a wave moves from rest keeps no mean velocity of its phase: Hann's window has none of its frequency."""
    fluid = sea(BAY, height=0.4, period=3.0, ramp=None)
    waves_of = fluid.config.with_ramp(fluid.config.sea(BasinConfig(**BAY).build()))
    t = np.linspace(0.0, 6.0, 6001)
    for phase in np.linspace(0.0, 2.0 * pi, 8, endpoint=False):
        push = np.array([waves_of.ramp_share(time) for time in t]) * np.cos(waves_of.omega[0] * t + phase)
        gained = np.trapezoid(push, t) * waves_of.omega[0]
        assert gained == pytest.approx(np.sin(waves_of.omega[0] * 6.0 + phase), abs=1e-5)


def test_still_pressure_under_the_mean_and_the_wave_at_the_bed(sea):
    fluid = sea(FLUME, height=0.05, period=1.5)
    k = 2.0 * pi / 2.827  # wavelength by linear wavemaker tables: h 0.5 m, T 1.5 s
    bed = fluid.pressures(np.array([[0.0, -0.5, 0.0]]))[0] - 1000.0 * GRAVITY * 0.5
    assert bed == pytest.approx(1000.0 * GRAVITY * 0.025 / np.cosh(0.5 * k), rel=1e-3)
    assert fluid.pressures(np.array([[0.0, 0.03, 0.0]]))[0] == 0.0


def test_a_sea_has_no_particles_and_no_account_and_takes_a_hundred_steps_a_wave(sea):
    fluid = sea(FLUME, height=0.05, period=1.5)
    assert fluid.particles is None and fluid.impulse == {} and fluid.work == {} and fluid.internal_energy() == 0.0
    assert Courant().build().next(fluid.limits()) == pytest.approx(0.015)
    assert fluid.status.max_speed == pytest.approx(0.025 * GRAVITY / 1.884, rel=1e-3)  # a g k / omega = a g / c
    (row,) = Config(height=0.05, period=1.5).ledger(SceneFacts({}, BasinConfig(**FLUME).build(), 8, 1.0))
    assert "no particles" in row.why


def test_what_is_wrong_is_said():
    basin = SceneFacts({}, BasinConfig(**FLUME).build(), 8, 1.0)
    said = Config(height=0.6, period=1.5, heading_deg=45.0).problems(basin)
    assert [path for path, _ in said] == [("height",), ("heading_deg",)]
    assert not [*Config(height=0.05, period=1.5, heading_deg=270.0).problems(basin)]
    spectrum = {"significant_wave_height": 0.05, "peak_period": 1.5}
    with pytest.raises(ValidationError, match="either height"):
        Config(height=0.05, period=1.5, spectrum=spectrum)
    with pytest.raises(ValidationError, match=r"spectrum\.heading_deg"):
        Config(heading_deg=90.0, spectrum=spectrum)
