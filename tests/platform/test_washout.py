import csv

import numpy as np
import pytest
from scipy.signal import sosfreqz

from ocean_sim.parts import preset
from ocean_sim.platform import INPUT_LIMIT, TILT_RATE_LIMIT
from ocean_sim.platform.shared.datagrams import preset_geometry
from ocean_sim.platform.shared.motion_log import Ride
from ocean_sim.platform.shared.washing import rest_force
from ocean_sim.platform.washout.adaptive import Config as Adaptive
from ocean_sim.platform.washout.classical import Config, Travel
from tests.platform.conftest import DATA, ride

FREE = np.array([[-np.inf, np.inf]] * 3)
HEXAPOD = preset_geometry("hexapod_a")


def washout(name, every, travel=FREE):
    return Config.model_validate(preset("washout", name)).build(every, HEXAPOD, travel)


def steps():
    """The rows of each step response, (n, 5): time, displacement, its acceleration, tilt in degrees, felt force."""
    with (DATA / "washout_steps.csv").open() as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))[1:]
    return {name: np.array([row[1:] for row in rows if row[0] == name], dtype=float) for name in {r[0] for r in rows}}


@pytest.mark.parametrize("case", sorted(steps()))
@pytest.mark.parametrize("every, bound", [(0.001, 0.01), (1.0 / 60.0, 0.03)])
def test_step_responses(case, every, bound):
    """Displacement, tilt and what is felt, against what was integrated apart; errors over the largest value."""
    name, axis, size = case.split()
    k, known = "xyz".index(axis), steps()[case]
    force = np.zeros(3)
    force[k] = float(size)
    rows = ride(int(known[-1, 0] / every) + 3, every, force)
    pose = washout(name, every).follow(rows).pose
    tilt = {0: -pose[:, 4], 1: pose[:, 3], 2: 0.0 * pose[:, 3]}[k]
    tilt_acceleration = np.gradient(np.gradient(pose[:, k], every), every)
    felt = tilt_acceleration * np.cos(tilt) + 9.81 * np.sin(tilt)
    for column, values, first in ((1, pose[:, k], 0.0), (3, np.degrees(tilt), 0.0), (4, felt, 0.09)):
        some = known[known[:, 0] > first]
        error = np.abs(np.interp(some[:, 0], rows.time, values) - some[:, column]).max()
        largest = np.abs(known[:, column]).max()
        assert error <= bound * largest or largest == 0.0 == error, (column, error / max(largest, 1e-9))


@pytest.mark.parametrize("every, bound", [(0.001, 0.01), (1.0 / 60.0, 0.03)])
@pytest.mark.parametrize("column, omega, damping", [(1, 2.5, 1.0), (3, 4.0, 1.0), (5, 0.6, 0.7), (7, 0.4, 0.7)])
def test_frequency_responses(every, bound, column, omega, damping):
    known = np.genfromtxt(DATA / "washout_heave.csv", delimiter=",", skip_header=2)
    angular = 2.0 * np.pi / known[:, 0]
    _, moved = sosfreqz(Travel(omega, damping, omega / 10.0, every).filter.sections, worN=angular * every)
    motion_gain = moved * (1j * angular) ** 2  # from displacement to displacement
    np.testing.assert_allclose(np.abs(motion_gain), known[:, column], rtol=bound, atol=6e-5)
    turn = np.angle(motion_gain / np.exp(1j * np.radians(known[:, column + 1])), deg=True)
    assert np.abs(turn).max() <= 180.0 * bound


def test_a_step_in_closed_form():
    """zeta = 1, third order: x = k a [e^(-b t) / (w - b)^2 - e^(-w t) (1 / (w - b)^2 + t / (w - b))]."""
    every, w, b = 0.001, 2.5, 0.25
    t = np.arange(8000) * every
    known = np.exp(-b * t) / (w - b) ** 2 - np.exp(-w * t) * (1.0 / (w - b) ** 2 + t / (w - b))
    moved, _ = Travel(w, 1.0, b, every).displace(np.ones(len(t)))
    assert np.abs(moved - known).max() < 1e-3 * known.max()
    assert known.max() == pytest.approx(0.115768, abs=1e-6) and t[np.argmax(moved)] == pytest.approx(1.607, abs=2e-3)


@pytest.mark.parametrize("name, peak_deg, at", [("srs", 2.207, 1.0), ("ship", 7.358, 3.33)])
def test_a_turn_is_washed_out(name, peak_deg, at):
    """A rate r gives the angle k r t e^(-w t), which peaks at k r / (w e)."""
    rows = ride(20000, 0.001, rate=[0.0, 0.0, np.radians(10.0)])
    yaw = np.degrees(washout(name, 0.001).follow(rows).pose[:, 5])
    assert yaw.max() == pytest.approx(peak_deg, rel=2e-3)
    assert rows.time[np.argmax(yaw)] == pytest.approx(at, abs=0.01)


@pytest.mark.parametrize("name", ["srs", "air", "ship"])
def test_a_ship_at_rest_leaves_the_platform_in_neutral(name):
    cue = washout(name, 0.01).follow(ride(1000, 0.01))
    assert not cue.pose.any() and not cue.limited.any()
    np.testing.assert_array_equal(cue.force, np.tile([0.0, 0.0, 9.81], (1000, 1)))


def test_a_heel_that_lasts_is_shown_once():
    """The ship set shows a heel as it is; srs filters the angle away and lets gravity come back as tilt, scaled."""
    heel = np.radians(8.0)
    force = rest_force(np.array([[heel, 0.0, 0.0]])) - [0.0, 0.0, 9.81]
    rows = ride(6000, 0.01, force, attitude=[heel, 0.0, 0.0])
    assert washout("ship", 0.01).follow(rows).pose[-1, 3] == pytest.approx(heel, abs=1e-9)
    assert washout("srs", 0.01).follow(rows).pose[-1, 3] == pytest.approx(np.arcsin(0.6 * np.sin(heel)), rel=1e-6)


def test_tilt_keeps_to_its_rate_and_says_so():
    cue = washout("air", 0.01).follow(ride(1000, 0.01, [3.0, 0.0, 0.0]))
    rates = np.degrees(np.diff(cue.pose[:, 4])) / 0.01
    assert np.abs(rates).max() == pytest.approx(3.0, rel=1e-9) and (cue.limited & TILT_RATE_LIMIT).any()
    gentle = washout("air", 0.01).follow(ride(1000, 0.01, [0.1, 0.0, 0.0]))
    assert not gentle.limited.any()


def test_blocks_of_any_size_give_the_same_poses():
    t = np.arange(900) * 0.01
    force = np.column_stack([np.sin(t), 2.0 * np.cos(3.0 * t), 4.0 * np.sin(0.7 * t)])
    rows = ride(900, 0.01, force, rate=0.1 * force)
    travel = np.array([[-0.3, 0.3]] * 3)
    whole = washout("srs", 0.01, travel).follow(rows)
    machine, k, parts = washout("srs", 0.01, travel), 0, []
    for size in (1, 1, 7, 300, 591):
        parts.append(machine.follow(Ride(*(column[k : k + size] for column in rows))))
        k += size
    assert whole.limited.any()
    np.testing.assert_array_equal(np.concatenate([part.pose for part in parts]), whole.pose)
    np.testing.assert_array_equal(np.concatenate([part.limited for part in parts]), whole.limited)


def test_a_platform_at_the_end_of_its_travel_comes_back_when_the_motion_turns():
    """Without the cut the filter is full, and keeps the platform beyond its end long after the push has gone."""
    every = 0.01
    push = np.concatenate([np.full(400, 3.0), np.full(300, -1.0), np.zeros(300)])
    cut, was_limited = Travel(0.4, 0.7, 0.04, every, (-0.6, 0.6)).displace(push)
    free, _ = Travel(0.4, 0.7, 0.04, every).displace(push)
    assert was_limited.any() and free.max() > 5.0
    assert (cut > 0.6).sum() < 0.6 * (free > 0.6).sum()
    assert np.flatnonzero(cut > 0.6).max() < np.flatnonzero(free > 0.6).max() - 150


def test_an_angle_that_is_followed_is_not_told_to_be_limited_by_its_rate():
    """Under `ship` roll is followed itself: no limit of rates changes it; under `srs` its rate is filtered, and cut."""
    t = np.arange(500) * 0.01
    zero, angle, rate = np.zeros_like(t), 0.2 * np.sin(t), 0.2 * np.cos(t)
    force = rest_force(np.column_stack([angle, zero, zero])) - [0.0, 0.0, 9.81]
    rows = ride(500, 0.01, force, np.column_stack([rate, zero, zero]), np.column_stack([angle, zero, zero]))
    for name, cut in (("ship", False), ("srs", True)):
        given = preset("washout", name)
        free, tight = (
            Config.model_validate(given | {"rate_limit_deg": limit}).build(0.01, HEXAPOD, FREE).follow(rows)
            for limit in (60.0, 2.0)
        )
        assert not (free.limited & INPUT_LIMIT).any() and (tight.limited & INPUT_LIMIT).any() == cut
        assert (tight.pose != free.pose).any() == cut


def test_input_beyond_its_limit_is_clipped_and_told():
    cue = washout("ship", 0.01).follow(ride(10, 0.01, [0.0, 0.0, 50.0]))
    assert (cue.limited & INPUT_LIMIT).all()


def test_gravity_in_body_axes_and_the_worked_example_of_specific_force():
    """NED: centre of mass (0.5, -0.3, 0.8) m/s2, omega (0.1, 0.2, 0.05), its rate (0.3, -0.2, 0.1), the head at
    (2, 0.5, -1.5) m, roll 8 and pitch -5 degrees: f = (-0.187498, -0.991343, -8.237563)."""
    omega, rate, arm = np.array([0.1, 0.2, 0.05]), np.array([0.3, -0.2, 0.1]), np.array([2.0, 0.5, -1.5])
    head = np.array([0.5, -0.3, 0.8]) + np.cross(rate, arm) + np.cross(omega, np.cross(omega, arm))
    np.testing.assert_allclose(head, [0.6675, 0.36875, 1.44], atol=1e-12)
    flu = np.diag([1.0, -1.0, -1.0]) @ head + rest_force(np.radians([[8.0, 5.0, 0.0]]))[0]
    np.testing.assert_allclose(flu, [-0.187498, 0.991343, 8.237563], atol=1e-6)


def test_an_adaptive_share_is_that_of_the_least_cost_in_high_waves_and_recovers():
    """In closed form 1 / (1 + W_s / omega^4) of high waves well above the corner; small heave passes whole."""
    weights = {"position_weight": [0.0, 0.0, 2.0], "velocity_weight": [0.0] * 3, "return_frequency": [0.05] * 3}
    every, omega = 0.01, 1.2
    t = np.arange(20000) * every
    heave = Adaptive.model_validate(preset("washout", "ship_adaptive") | weights).build(every, HEXAPOD, FREE).travels[2]
    small, _ = heave.displace(0.01 * np.cos(omega * t))
    assert np.ptp(small[-1000:]) == pytest.approx(0.02 / omega**2, rel=0.01) and heave.share > 0.99
    high, _ = heave.displace(2.0 * np.cos(omega * t))
    share = 1.0 / (1.0 + 2.0 / omega**4)
    assert np.ptp(high[-1000:]) == pytest.approx(share * 4.0 / omega**2, rel=0.08)
    heave.displace(np.zeros(40000))
    assert heave.share > 0.95 and abs(heave.place) < 0.01
