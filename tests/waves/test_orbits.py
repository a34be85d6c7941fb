"""Orbits, drift, circulation and white caps of fields whose values are closed forms."""

from itertools import pairwise

import numpy as np
import pytest

from ocean_sim import waves
from ocean_sim.waves.orbits import circulation, fit_orbit
from tests.waves.closed_forms import orbit_ratio, orbit_sizes, stokes_drift

DEPTH, PERIOD, HEIGHT, PERIODS, STEPS = 0.5, 1.2, 0.04, 5, 200
LEVELS = np.array([-0.05, -0.15, -0.3, -0.45])  # [m]


@pytest.fixture(scope="module")
def sea() -> waves.Components:
    return waves.regular_wave(HEIGHT, PERIOD, np.array([1.0, 0.0]), DEPTH)


@pytest.fixture(scope="module")
def paths(sea):
    """Times and places of particles that move with linear theory, by Runge-Kutta."""
    dt = PERIOD / STEPS
    x = np.stack([np.zeros(4), LEVELS, np.zeros(4)], axis=1)
    seen = [x]
    for n in range(PERIODS * STEPS):
        t = n * dt
        a = waves.linear_velocity(sea, x, t)
        b = waves.linear_velocity(sea, x + 0.5 * dt * a, t + 0.5 * dt)
        c = waves.linear_velocity(sea, x + 0.5 * dt * b, t + 0.5 * dt)
        d = waves.linear_velocity(sea, x + dt * c, t + dt)
        x = x + dt / 6.0 * (a + 2.0 * b + 2.0 * c + d)
        seen.append(x)
    return dt * np.arange(len(seen)), np.array(seen)


@pytest.mark.parametrize("n", range(4))
def test_orbits_of_linear_theory(sea, paths, n):
    time, x = paths
    found, k = fit_orbit(time, x[:, n], PERIOD), float(sea.wavenumber[0])
    mean = x[:, n, 1].mean()
    along, up = orbit_sizes(HEIGHT / 2.0, k, mean, DEPTH)
    assert found.along_m == pytest.approx(along, rel=0.01) and found.up_m == pytest.approx(up, rel=0.01)
    assert found.ratio == pytest.approx(orbit_ratio(k, mean, DEPTH), rel=0.01)
    assert found.drift_m_s == pytest.approx(stokes_drift(HEIGHT / 2.0, k, mean, DEPTH), rel=0.05)


def test_orbits_shrink_and_flatten_towards_the_bed(paths):
    time, x = paths
    found = [fit_orbit(time, x[:, n], PERIOD) for n in range(4)]
    for high, low in pairwise(found):
        assert low.along_m < high.along_m and low.ratio < high.ratio and low.drift_m_s < high.drift_m_s


def test_the_drift_is_second_order(sea):
    k = float(sea.wavenumber[0])
    once, twice = (stokes_drift(a, k, -0.1, DEPTH) for a in (0.01, 0.02))
    assert twice == pytest.approx(4.0 * once)


def test_a_path_that_is_too_short_is_refused(paths):
    time, x = paths
    with pytest.raises(ValueError, match="shorter than two periods"):
        fit_orbit(time[:100], x[:100, 0], PERIOD)


def test_circulation_of_a_vortex_and_of_a_stream():
    x = np.random.default_rng(1).uniform(-5.0, 5.0, size=(40_000, 3))
    strength = 12.0  # [m2/s]
    r2 = x[:, 0] ** 2 + x[:, 2] ** 2
    around = np.stack([x[:, 2], 0.0 * r2, -x[:, 0]], axis=1)
    vortex = strength / (2.0 * np.pi * r2)[:, None] * around
    assert circulation(x, vortex, 3.0, 0.5) == pytest.approx(strength, rel=0.02)
    assert abs(circulation(x, vortex, 1.0, 0.2, centre=(3.5, 0.0))) < 0.05 * strength  # the axis is outside
    assert circulation(x, 0.7 * around, 2.0, 0.1) == pytest.approx(0.7 * 2.0 * np.pi * 4.0, rel=0.01)
    assert abs(circulation(x, np.tile([3.0, 0.0, 1.0], (len(x), 1)), 2.0, 0.5)) < 0.05 * strength
    with pytest.raises(ValueError, match="no particles"):
        circulation(x, vortex, 30.0, 0.5)
