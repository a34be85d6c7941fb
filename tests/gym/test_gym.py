"""Boats for learning: the contract of Gymnasium, episodes that repeat, and motions with known answers."""

from time import perf_counter

import numpy as np
import pytest

from ocean_sim import waves
from ocean_sim.gym.boats import Boat, Boats

DEEP = 50.0


def boats(sea, heading, **keys):
    found = Boats(Boat(**keys), 1, len(sea.amplitude), DEEP)
    found.begin(np.ones(1, bool), [sea], np.array([heading]), 0.0)
    return found


def run(found, seconds, helm=0.0, throttle=0.0, dt=0.1):
    rows = []
    for _ in range(round(seconds / dt)):
        found.advance(np.full(1, helm), np.full(1, throttle), dt)
        rows.append([found.heave[0], *found.angles[0], found.heading[0], found.yaw_rate[0]])
    return np.array(rows)


def test_long_waves_are_followed_and_tilt_the_boat_by_their_slope():
    """A wave of 20 s from abeam to port: heave is its amplitude, roll k a, pitch nothing; from ahead the other way."""
    sea = waves.regular_wave(2.0, 20.0, waves.heading_vector(90.0, 3), DEEP)
    slope = float(sea.wavenumber[0])
    rows = run(boats(sea, 0.0), 120.0)[600:]
    assert np.abs(rows[:, 0]).max() == pytest.approx(1.0, rel=0.06)
    assert np.abs(rows[:, 1]).max() == pytest.approx(slope, rel=0.10) and np.abs(rows[:, 2]).max() < 1e-9
    rows = run(boats(sea, -np.pi / 2.0), 120.0)[600:]
    assert np.abs(rows[:, 2]).max() == pytest.approx(slope, rel=0.10) and np.abs(rows[:, 1]).max() < 1e-9


def test_a_boat_turns_as_nomoto_says():
    """In calm water at cruise: r = K delta after some T, to port where the helm is positive."""
    found = boats(waves.regular_wave(0.0, 6.0, waves.heading_vector(0.0, 3), DEEP), 0.0)
    found.speed[:] = found.boat.cruise
    rows = run(found, 40.0, helm=0.5, throttle=0.5)
    assert rows[-1, 4] == pytest.approx(found.boat.turning * 0.5 * found.boat.rudder, rel=1e-3) and rows[-1, 3] > 0.0


def test_a_heave_that_is_let_go_swings_at_its_period():
    found = boats(waves.regular_wave(0.0, 6.0, waves.heading_vector(0.0, 3), DEEP), 0.0, damping=(0.0, 0.1, 0.1))
    found.state[0, 0] = 1.0
    heave = run(found, 25.0)[:, 0]
    assert heave[-1] == pytest.approx(1.0, abs=1e-9)  # ten periods of 2.5 s


def test_orders_for_other_boats_are_refused():
    """One row for all of them was taken for each."""
    pytest.importorskip("gymnasium")
    from ocean_sim.gym import OceanVectorEnv

    many = OceanVectorEnv(3)
    many.reset(seed=1)
    for actions in (np.zeros((1, 2)), np.zeros(2), np.zeros((3, 3)), None):
        with pytest.raises(ValueError, match="actions: "):
            many.step(actions)
    wrong = ({"num_envs": 0}, {"num_envs": 1.5}, {"height": float("nan")}, {"period": 0.0}, {"depth": -1.0})
    for keys in wrong:
        with pytest.raises(ValueError, match=f"{next(iter(keys))}: "):
            OceanVectorEnv(**({"num_envs": 2} | keys))


def test_it_keeps_the_contract_of_gymnasium():
    pytest.importorskip("gymnasium")
    from gymnasium.utils.env_checker import check_env

    from ocean_sim.gym import OceanEnv

    check_env(OceanEnv(), skip_render_check=True)


def test_boats_are_made_by_name_and_tell_where_they_are():
    gymnasium = pytest.importorskip("gymnasium")
    name = "ocean_sim.gym.environments:OceanSim/HoldHeading-v0"
    with gymnasium.make(name, height=0.0) as one:
        _, at_first = one.reset(seed=3)
        *_, info = one.step(np.array([0.0, 0.5], np.float32))
    way, heading = info["position"] - at_first["position"], info["heading"]
    assert np.hypot(*way) > 0.1
    np.testing.assert_allclose(way / np.hypot(*way), [np.sin(heading), np.cos(heading)], atol=0.02)
    many = gymnasium.make_vec(name, num_envs=3)
    _, info = many.reset(seed=3)
    assert info["position"].shape == (3, 2) and info["_heading"].all()
    many.close()


def test_the_same_seed_gives_the_same_episodes_byte_for_byte_and_another_does_not():
    pytest.importorskip("gymnasium")
    from ocean_sim.gym.environments import EPISODE_STEPS, OceanVectorEnv

    def episode(seed):
        env, random = OceanVectorEnv(4), np.random.default_rng(3)
        rows = [env.reset(seed=seed)[0].tobytes()]
        for _ in range(EPISODE_STEPS + 20):  # over the end of an episode
            seen, reward, *_ = env.step(random.uniform([-1.0, 0.0], 1.0, (4, 2)))
            rows += [seen.tobytes(), reward.tobytes()]
        return rows

    assert episode(7) == episode(7) != episode(8)


@pytest.mark.parametrize("action", [[np.nan, 0.5], [0.0, np.inf]])
def test_an_action_that_is_no_number_is_refused(action):
    """It made a boat that was none, and never capsized, until the end of her episode."""
    pytest.importorskip("gymnasium")
    from ocean_sim.gym.environments import OceanVectorEnv

    boats = OceanVectorEnv(2)
    boats.reset(seed=1)
    with pytest.raises(ValueError, match=r"the action of boat 1 is .*helm and throttle are numbers"):
        boats.step(np.array([[0.0, 0.5], action]))
    assert np.isfinite(boats.step(np.zeros((2, 2)))[0]).all()


def test_a_list_of_seeds_is_refused_where_one_seed_is_for_all_boats():
    gymnasium = pytest.importorskip("gymnasium")
    from ocean_sim.gym.environments import OceanVectorEnv

    with pytest.raises(gymnasium.error.Error, match="must be a python integer"):
        OceanVectorEnv(2).reset(seed=[1, 2])


@pytest.mark.slow
def test_a_thousand_boats_are_ten_times_faster_than_time():
    pytest.importorskip("gymnasium")
    from ocean_sim.gym.environments import TIME_STEP, OceanVectorEnv

    env = OceanVectorEnv(1000)
    env.reset(seed=1)
    orders = np.tile([0.1, 0.5], (1000, 1))
    begin = perf_counter()
    for _ in range(100):
        env.step(orders)
    assert 100 * TIME_STEP / (perf_counter() - begin) > 10.0
