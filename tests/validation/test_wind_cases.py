"""The cases of wind and of an imposed sea: formulas against each other, and scores that go red where they must."""

from math import pi

import numpy as np
import pytest

from ocean_sim import waves
from ocean_sim.validation import imposed_sea, problems, wind_growth, wind_setup, wind_stress
from ocean_sim.validation.shared.flume import reflection_ratio
from ocean_sim.validation.shared.state import State
from ocean_sim.validation.wind_stress import WU_STRESS, wind_keys
from ocean_sim.wind.shared.air_load import stress


def test_the_tabulated_stress_is_that_of_the_wind():
    assert stress(10.0) == pytest.approx(WU_STRESS, rel=1e-9)
    for case in ("wind_stress", "wind_setup", "wind_growth"):
        for problem in problems(case, slow=True):
            assert problem.load("delta_sph").wind.kind == "stress"
    scene = problems("wind_stress")[0].load("delta_sph")
    assert scene.wind.on_water(10.0) == pytest.approx(wind_stress.STRESS, rel=1e-9)


def test_the_laminar_profile_satisfies_bed_stress_and_flux():
    """u = drift (3 z^2 - 2 z): no slip, no net flow, the wind's stress on top; its pressure gradient is the slope."""
    z = np.linspace(0.0, 1.0, 10_001)
    u = wind_setup.SURFACE_DRIFT * (3.0 * z**2 - 2.0 * z)
    mu, h = wind_setup.DENSITY * wind_setup.VISCOSITY, wind_setup.DEPTH
    assert u[0] == 0.0 and np.trapezoid(u, z) == pytest.approx(0.0, abs=1e-9)
    assert mu * wind_setup.SURFACE_DRIFT * 4.0 / h == pytest.approx(wind_setup.STRESS)
    gradient = mu * wind_setup.SURFACE_DRIFT * 6.0 / h**2
    assert gradient == pytest.approx(wind_setup.DENSITY * wind_setup.G * wind_setup.SURFACE_SLOPE)
    assert u.min() == pytest.approx(-wind_setup.SURFACE_DRIFT / 3.0, rel=1e-6)


def test_the_pressure_of_the_growth_case_is_what_its_wind_makes():
    wind = problems("wind_growth")[0].load("delta_sph").wind
    assert wind.sheltered(10.0) == pytest.approx(wind_growth.PRESSURE, rel=1e-9)
    assert wind == type(wind).model_validate(
        wind_keys(
            wind_growth.WIND_GAIN * WU_STRESS, sheltering=wind_growth.SHELTERING, wave_speed=wind_growth.CREST_SPEED
        )
    )
    deep = wind_growth.PRESSURE_STRENGTH * wind_growth.OMEGA
    assert pytest.approx(deep, rel=0.01) == wind_growth.GROWTH_RATE  # P w / (rho c^2) on deep water


def test_the_work_of_the_pressure_is_the_growth_rate():
    """Over a wave of linear theory: mean of -P (d eta / dx) (d eta / dt) over the energy density."""
    angle = np.linspace(0.0, 2.0 * pi, 2000, endpoint=False)
    a, k, omega = 0.01, wind_growth.K, wind_growth.OMEGA
    slope, rise = -a * k * np.sin(angle), a * omega * np.sin(angle)
    power = -(wind_growth.PRESSURE * slope * rise).mean()
    assert power / (0.5 * 1000.0 * 9.81 * a**2) == pytest.approx(wind_growth.GROWTH_RATE, rel=1e-3)


@pytest.mark.parametrize("phase", [0.0, 0.7, 2.5])
def test_the_amplitude_of_the_growing_wave_is_that_of_linear_theory(phase):
    spacing = wind_growth.WAVELENGTH / 40
    x, y = np.meshgrid(np.arange(40) * spacing, -(np.arange(20) + 0.5) * spacing, indexing="ij")
    position = np.stack([x.ravel(), y.ravel(), 0.0 * x.ravel()], axis=1)
    wave = waves.Components(np.array([0.01]), np.array([[wind_growth.K, 0.0]]), np.array([phase]), wind_growth.DEPTH)
    velocity = waves.linear_velocity(wave, position)
    water = State(0.0, 1.0, spacing, position, velocity, position[:, 0], position[:, 0])
    assert wind_growth.wave_amplitude(water) == pytest.approx(0.01, rel=1e-9)


def test_a_growth_rate_is_read_from_amplitudes():
    times = np.linspace(0.0, 6.0, 100)
    assert wind_growth.growth_rate(times, 0.02 * np.exp(0.04 * times)) == pytest.approx(0.08)


@pytest.mark.parametrize("sent_back", [0.0, 0.01, 0.05, 0.3])
def test_reflection_is_told_from_three_gauges(sent_back):
    spectrum = waves.Spectrum(significant_wave_height=0.04, peak_period=1.5, seed=1, cut_off=2.0)
    sea = spectrum.components(np.array([1.0, 0.0]), imposed_sea.DEPTH)
    time, x = np.arange(0.0, 60.0, 0.05)[:, None], imposed_sea.GAUGE_POSITIONS
    record = np.zeros((len(time), 3))
    for a, k, omega, phase in zip(sea.amplitude, sea.wavenumber, sea.omega, sea.phase):
        there, back = np.cos(k * x - omega * time + phase), np.cos(k * x + omega * time - phase)
        record += a * (there + sent_back * back)
    found = reflection_ratio(0.05, record, imposed_sea.GAUGE_POSITIONS, imposed_sea.DEPTH, imposed_sea.FREQUENCY_BAND)
    assert found == pytest.approx(sent_back, abs=0.002 + 0.05 * sent_back)
