"""How a packet of waves that goes round a patch of open sea is measured."""

import numpy as np
import pytest

from ocean_sim import waves
from ocean_sim.validation import open_sea_waves as case
from ocean_sim.validation.shared.state import State


def test_what_goes_on_and_what_comes_back_are_told_apart_and_slow_eddies_are_neither():
    """One wave each way by linear theory, over a period, in water that a slow eddy stirs as fast as the lesser wave."""
    k = 2.0 * np.pi * np.arange(1, 9) / 4.0
    sea = waves.Components(0.0 * k, np.stack([k, 0.0 * k], axis=1), 0.0 * k, case.DEPTH, case.G)
    both = waves.Components(
        np.array([0.010, 0.002]), np.array([[case.K, 0.0], [-case.K, 0.0]]), np.array([0.0, 0.7]), case.DEPTH, case.G
    )
    x, y = np.meshgrid(np.linspace(-2.0, 2.0, 160, endpoint=False), np.linspace(-0.49, -0.01, 20))
    at = np.stack([x.ravel(), y.ravel(), 0.0 * x.ravel()], axis=1)
    eddy = np.stack([np.sin(case.K * at[:, 0] + 9.0 * at[:, 1]), np.cos(5.0 * at[:, 0]), 0.0 * at[:, 0]], axis=1)
    time, found = 3.0 + case.PERIOD * np.arange(case.PERIOD_SAMPLES) / case.PERIOD_SAMPLES, []
    for t in time:
        v = waves.linear_velocity(both, at, float(t)) + 0.01 * eddy
        found.append(case.fit_heights(State(float(t), 1.0, 0.025, at, v, at[:, 0], at[:, 0]), sea))
    on, back = case.split_directions(np.array(found), sea.omega, time)
    assert abs(on[3]) == pytest.approx(0.010, rel=1e-3) and abs(back[3]) == pytest.approx(0.002, rel=1e-3)
    assert np.abs(np.delete([on, back], 3, axis=1)).max() < 3e-4
