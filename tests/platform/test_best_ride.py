"""The best ride of a platform, and the washout that plans it anew as it goes."""

import numpy as np
import pytest

from ocean_sim.platform.hexapod import Config
from ocean_sim.platform.shared import leg_programme
from ocean_sim.platform.shared.metrics import felt_motions, possible_shares
from ocean_sim.platform.shared.motion_log import Ride
from ocean_sim.verbs.platform import platform_config

pytest.importorskip("clarabel")
DT = 0.02  # [s]


def waves(seconds, acceleration, period=3.0, angle=0.03):
    """Ride in heave and pitch that begins and ends at rest."""
    t = np.arange(round(seconds / DT)) * DT
    swell = np.sin(np.pi * t / t[-1]) ** 2 * np.sin(2.0 * np.pi * t / period)
    pitch = angle * swell
    rate, none = np.gradient(pitch, DT), np.zeros_like(t)
    push = 9.81 + acceleration * swell
    force = np.column_stack([-push * np.sin(pitch), none, push * np.cos(pitch)])
    attitude = np.column_stack([none, pitch, none])
    return Ride(t, np.arange(len(t)), force, np.column_stack([none, rate, none]), attitude)


def sensed(done, pose):
    """Root mean square of the sensed error of poses, in rows of DT."""
    scaled = np.hstack([done.cue.force, done.cue.rate])
    return np.sqrt(np.mean(leg_programme.sensed_error(felt_motions(pose, DT) - scaled, DT)[0] ** 2))


@pytest.mark.parametrize("k, frequency", [(0, 0.5), (2, 4.0), (4, 1.0)])
def test_organs_answer_a_sine_as_their_transfer_functions_do(k, frequency):
    t = np.arange(0.0, 400.0, 0.01)
    error = np.zeros((len(t), 6))
    error[:, k] = np.sin(frequency * t)
    upper, lower = leg_programme.OTOLITH_FILTER if k < 3 else leg_programme.CANAL_FILTER
    gain = abs(np.polyval(upper, 1j * frequency) / np.polyval(lower, 1j * frequency))
    found = leg_programme.sensed_error(error, 0.01)[0][t > 350.0, k]
    assert np.ptp(found) / 2.0 == pytest.approx(gain / leg_programme.SENSED_THRESHOLDS[k], rel=2e-3)


def test_a_ride_that_fits_is_passed_whole():
    machine = Config().build(DT)
    done = machine.follow(waves(9.0, 0.4))
    best, scaled = machine.best(done), done.cue.force[:, 2] - 9.81
    felt = felt_motions(best.pose, DT)
    assert np.sqrt(np.mean((felt[:, 2] - 9.81 - scaled) ** 2)) < 1e-3 * np.sqrt(np.mean(scaled**2))
    turn = done.cue.rate[:, 1]
    assert np.sqrt(np.mean((felt[:, 4] - turn) ** 2)) < 1e-3 * np.sqrt(np.mean(turn**2))


def test_a_ride_too_large_keeps_all_limits_and_is_better_than_any_washout():
    machine = Config(washout="ship").build(DT)
    done = machine.follow(waves(9.0, 8.0, period=4.0, angle=0.2))
    best, legs = machine.best(done), machine.hexapod
    assert legs.low - 1e-6 < best.legs.min() and best.legs.max() < legs.high + 1e-6
    assert np.ptp(best.legs) > 0.95 * (legs.high - legs.low)
    assert np.abs(best.leg_velocity).max() < machine.geometry.leg_speed + 1e-6
    change = np.abs(np.diff(best.leg_velocity, axis=0)).max() / DT
    assert change < machine.geometry.leg_acceleration + 1e-4
    assert possible_shares(done, best, DT)[2].value == pytest.approx(sensed(done, best.pose) / sensed(done, done.pose))
    assert sensed(done, best.pose) < 0.7 * sensed(done, done.pose)


def test_windows_join_without_a_step(monkeypatch):
    whole = Config().build(DT)
    done = whole.follow(waves(9.0, 1.0))
    one = whole.best(done).pose
    monkeypatch.setattr(leg_programme, "WINDOW_TIME", 5.0)
    monkeypatch.setattr(leg_programme, "KEPT_TIME", 3.0)
    parts = whole.best(done).pose
    assert sensed(done, one) < 1e-3 and sensed(done, parts) < 0.05
    assert np.abs(np.diff(parts[:, 2], n=2)).max() / DT**2 < 1.5 * np.abs(np.diff(one[:, 2], n=2)).max() / DT**2


def predictive(*sets):
    return platform_config("hexapod_a", "predictive", [f"washout.{each}" for each in sets]).build(DT)


def test_rows_may_come_in_any_parts_with_what_lies_ahead_of_them():
    ride, sets = waves(3.0, 2.0), ("horizon=1.2", "period=0.4")
    whole, machine = predictive(*sets).follow(ride), predictive(*sets)
    poses = [machine.follow(ride.rows(k, k + 37), ride.rows(k + 37, k + 97)).pose for k in range(0, len(ride.time), 37)]
    assert np.array_equal(np.vstack(poses), whole.pose)
    assert whole.limited.max() == 0 and np.abs(whole.pose[:, 2]).max() > 0.05


def test_plans_over_a_horizon_are_nearly_the_best():
    ride = waves(6.0, 2.0)
    machine = predictive("horizon=4", "period=1")
    done = machine.follow(ride)
    legs = done.legs
    assert machine.hexapod.low - 1e-6 < legs.min() and legs.max() < machine.hexapod.high + 1e-6
    assert sensed(done, done.pose) < 0.3 * sensed(done, Config(ramp=0.0).build(DT).follow(ride).pose)


def test_a_period_must_fit_knots_and_horizon():
    from ocean_sim.conventions import Failed

    for wrong, said in (("period=0.05", "multiple of 0.04"), ("period=39.92", "no room to stop")):
        with pytest.raises(Failed, match=said):
            predictive(wrong)
