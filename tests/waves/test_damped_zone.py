"""What a damped zone sends back: against closed forms, an independent integration, and other strengths."""

import numpy as np
import pytest

from ocean_sim.conventions import GRAVITY
from ocean_sim.waves import Spectrum, absorption, angular_frequency, group_speed, profiles
from ocean_sim.waves.absorption import (
    DAMPING_POWER,
    LEAST_REFLECTION_RATE,
    damping_rate,
    sea_reflection,
    wave_reflection,
)

DEPTH = 0.5


def sent_back(kh: float, wavelengths: float, rate: float, depth: float = DEPTH) -> float:
    """Reflection of a wave by a zone so many wavelengths long, its rate in k times group speed."""
    k = kh / depth
    omega = angular_frequency(np.array([k]), depth)
    strength = rate * k * float(group_speed(k, depth))
    return float(wave_reflection(omega, depth, GRAVITY, wavelengths * 2.0 * np.pi / k, strength)[0])


@pytest.mark.parametrize("kh", [0.2, 1.0, 5.0, 40.0])
def test_without_damping_or_without_a_zone_the_wall_sends_all_back(kh):
    assert sent_back(kh, 1.0, 0.0) == pytest.approx(1.0, abs=1e-9)
    assert sent_back(kh, 1e-4, LEAST_REFLECTION_RATE) == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("kh", [0.3, 1.0, 3.0])
def test_weak_damping_takes_the_work_it_does_in_a_standing_wave(kh):
    """A wave of speed u0 carries u0^2 (level + upright) / 2 at the group speed; before the wall its velocities are 2 u0
    sin and 2 u0 cos, and damping takes rate times the mean of their squares."""
    k, rate = kh / DEPTH, 1e-4
    length, speed = 0.7 * 2.0 * np.pi / k, float(group_speed(k, DEPTH))
    x, y = np.linspace(0.0, length, 2001), np.linspace(-DEPTH, 0.0, 2001)
    c, s = profiles(k, y, DEPTH)
    level, upright = np.trapezoid(c * c, y), np.trapezoid(s * s, y)
    away, damping = k * (length - x), rate * k * speed * (x / length) ** DAMPING_POWER
    squares = 2.0 * (level * np.sin(away) ** 2 + upright * np.cos(away) ** 2)
    lost = np.trapezoid(damping * squares, x) / (0.5 * (level + upright) * speed)
    assert 1.0 - sent_back(kh, 0.7, rate) ** 2 == pytest.approx(lost, rel=0.005)


def test_long_waves_are_those_of_the_shallow_water_equations():
    """(r - i w) q = -g h d(eta)/dx and i w eta = dq/dx, integrated from the wall on."""
    from scipy.integrate import solve_ivp

    depth, k = 0.01, 1.0
    omega, length = float(np.sqrt(GRAVITY * k * np.tanh(k * depth))), 2.0 * np.pi

    def slopes(away: float, state: np.ndarray) -> np.ndarray:
        eta, q = state
        r = omega * (1.0 - away / length) ** DAMPING_POWER
        return np.array([(r - 1j * omega) * q / (GRAVITY * depth), -1j * omega * eta])

    eta, q = solve_ivp(slopes, (0.0, length), np.array([1.0 + 0j, 0.0 + 0j]), rtol=1e-9, atol=1e-12).y[:, -1]
    c = omega / k
    expected = abs((c * eta - q) / (c * eta + q))
    found = float(wave_reflection(np.array([omega]), depth, GRAVITY, length, omega)[0])
    assert found == pytest.approx(expected, abs=2e-4) and 0.001 < expected < 0.1


def test_damping_that_is_too_strong_is_a_wall_of_its_own():
    by_rate = [sent_back(1.0, 1.0, rate) for rate in (LEAST_REFLECTION_RATE, 10.0, 1e2, 1e4, 1e7)]
    assert by_rate == sorted(by_rate) and by_rate[-1] > 0.95


def test_in_deep_water_the_depth_does_not_matter():
    assert sent_back(8.0, 1.0, LEAST_REFLECTION_RATE) == pytest.approx(
        sent_back(800.0, 1.0, LEAST_REFLECTION_RATE), rel=1e-3
    )


@pytest.mark.parametrize("kh", [0.5, 1.1, 3.0])
@pytest.mark.parametrize("wavelengths, most", [(1.0, 0.012), (1.5, 0.007), (2.0, 0.005)])
def test_the_chosen_rate_is_near_the_best(kh, wavelengths, most):
    chosen = sent_back(kh, wavelengths, LEAST_REFLECTION_RATE)
    best = min(sent_back(kh, wavelengths, rate) for rate in np.arange(1.0, 4.0, 0.2))
    assert chosen < most and chosen - best < 0.006


@pytest.mark.parametrize("kh", [0.5, 1.1, 3.0])
@pytest.mark.parametrize("wavelengths, most", [(0.1, 0.7), (0.25, 0.35), (0.35, 0.18), (0.5, 0.035)])
def test_and_so_it_is_in_a_zone_that_is_short(kh, wavelengths, most):
    k = kh / DEPTH
    share = damping_rate(k, DEPTH, GRAVITY, wavelengths * 2.0 * np.pi / k) / (k * float(group_speed(k, DEPTH)))
    chosen = sent_back(kh, wavelengths, share)
    best = min(sent_back(kh, wavelengths, rate) for rate in np.geomspace(1.0, 40.0, 30))
    assert share > LEAST_REFLECTION_RATE and chosen < most and chosen - best < 0.03


def test_layers_and_modes_are_enough(monkeypatch):
    coarse = sent_back(1.1, 1.0, LEAST_REFLECTION_RATE)
    monkeypatch.setattr(absorption, "ZONE_LAYERS", 240)
    monkeypatch.setattr(absorption, "DEPTH_MODES", 10)
    assert sent_back(1.1, 1.0, LEAST_REFLECTION_RATE) == pytest.approx(coarse, abs=1e-4)


def test_of_a_sea_it_tells_the_highest_wave_and_all_of_them():
    sea = Spectrum(significant_wave_height=0.04, peak_period=1.5).components(np.array([1.0, 0.0]), DEPTH)
    k = float(sea.wavenumber[sea.highest])
    length = 1.5 * 2.0 * np.pi / k
    rate = damping_rate(k, DEPTH, GRAVITY, length)
    peak, whole = sea_reflection(sea, length, rate)
    each = wave_reflection(sea.omega, DEPTH, GRAVITY, length, rate)
    assert peak == pytest.approx(each[sea.highest], rel=1e-6)
    assert whole == pytest.approx(np.sqrt((sea.amplitude**2 * each**2).sum() / (sea.amplitude**2).sum()), rel=0.05)
    assert peak < 0.005 and whole < 0.01
    assert sea_reflection(sea, 0.25 * length, rate)[1] > 10.0 * whole
