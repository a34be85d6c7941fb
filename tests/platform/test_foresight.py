"""Guesses of the motion to come, from what was."""

import numpy as np
import pytest

from ocean_sim.conventions import GRAVITY
from ocean_sim.platform.shared.foresight import LAW_ORDER, fitted_law, held_motion, predicted_motion
from ocean_sim.platform.shared.leg_programme import KNOT_INTERVAL
from ocean_sim.platform.shared.washing import rest_force

pytest.importorskip("scipy")
AHEAD = KNOT_INTERVAL * np.arange(1, 51)


def rows_of(time, waves):
    """Rows as `predicted_motion` takes them, of a body that rolls, pitches and heaves with `waves`: amplitude, rate."""
    roll, roll_rate, pitch, pitch_rate, heave = np.zeros((5, len(time)))
    for size, omega, phase in waves:
        roll += 0.1 * size * np.sin(omega * time + phase)
        roll_rate += 0.1 * size * omega * np.cos(omega * time + phase)
        pitch += 0.05 * size * np.sin(omega * time + 2.0 * phase)
        pitch_rate += 0.05 * size * omega * np.cos(omega * time + 2.0 * phase)
        heave += size * np.cos(omega * time + 3.0 * phase)
    attitude = np.column_stack([roll, pitch, 0.0 * roll])
    force = rest_force(attitude) + heave[:, None] * [0.0, 0.0, 1.0]
    return np.column_stack([time, force, roll_rate, pitch_rate, 0.0 * roll, attitude])


def test_waves_that_were_seen_go_on():
    """Two frequencies that beat, for 2 s: within an eighth of their rms."""
    waves = [(1.0, 1.1, 0.3), (0.6, 1.5, 1.0)]
    true = rows_of(60.0 + AHEAD, waves)[:, 1:7]
    motion = predicted_motion(rows_of(np.arange(0.0, 60.01, 0.02), waves), len(AHEAD))
    size = np.sqrt(np.mean((true - true.mean(axis=0)) ** 2, axis=0))[[2, 3, 4]]
    assert (np.sqrt(np.mean((motion - true) ** 2, axis=0))[[2, 3, 4]] < 0.125 * size).all()


@pytest.mark.parametrize("seconds", [0.0, 0.1, 1.0, 5.0])
def test_a_prediction_from_little_stays_small(seconds):
    motion = predicted_motion(rows_of(np.arange(0.0, seconds + 0.01, 0.02), [(1.0, 1.1, 0.3)]), 250)
    assert np.isfinite(motion).all() and np.abs(motion[:, 3:]).max() < 0.5
    assert np.abs(motion[:, 2] - GRAVITY).max() < 4.0


def test_what_grew_is_not_promised_to_grow_on():
    series = np.exp(np.arange(80)[:, None] / 20.0) * np.cos(np.arange(80)[:, None] + np.arange(6))
    law, last = fitted_law(series), series[-LAW_ORDER:][::-1]
    for _ in range(300):
        last = np.vstack([last.ravel() @ law, last[:-1]])
    assert np.abs(last).max() < np.abs(series).max()


def test_a_held_motion_turns_gravity_with_the_body_and_dies_away():
    rows = rows_of(np.array([0.0]), [(1.0, 1.1, 0.3)])
    motion = held_motion(rows, 500)
    roll = np.arctan2(motion[:, 1], motion[:, 2])
    np.testing.assert_allclose(np.gradient(roll, KNOT_INTERVAL)[100:], motion[100:, 3], atol=1e-3)
    np.testing.assert_allclose(motion[0], rows[0, 1:7], atol=0.2)
    assert np.abs(motion[-1, 3:]).max() < 1e-9 and np.linalg.norm(motion[-1, :3]) == pytest.approx(GRAVITY)
