"""Kelvin's waves behind a ship: where they are, and how long."""

import numpy as np
import pytest

from ocean_sim.conventions import GRAVITY
from ocean_sim.pictures import wake
from ocean_sim.pictures.camera import Track, Vessel


def test_waves_astern_have_the_length_of_the_speed_and_stay_within_kelvin_s_angle():
    speed, breadth, length = 4.0, 2.0, 14.0
    height = wake.pattern(speed, breadth, length)
    step = wake.FINEST * breadth
    x = step * np.arange(len(height))
    wavelength = 2.0 * np.pi * speed**2 / GRAVITY
    far = x > 3.0 * length
    astern = height[far, 0]
    crossings = x[far][:-1][(astern[:-1] < 0.0) & (astern[1:] >= 0.0)]
    assert np.diff(crossings).mean() == pytest.approx(wavelength, rel=0.12)
    y = step * np.arange(height.shape[1])
    outside = np.arctan2(y[None, :], x[:, None] + 1e-9) > np.arcsin(1.0 / 3.0) + 0.12
    assert np.abs(height[outside & (x > 2.0 * length)[:, None]]).max() < 0.2 * np.abs(height).max()
    assert np.abs(height).max() == pytest.approx(wake.HIGHEST * speed**2 / GRAVITY)


def test_waves_are_behind_the_ship_and_none_where_she_lies_still():
    time = np.arange(0.0, 5.0, 0.5)
    turn = np.broadcast_to(np.eye(3), (len(time), 3, 3))
    going = np.stack([0.0 * time, 0.0 * time, 4.0 * time], axis=1)
    places = np.array([[0.0, -20.0], [0.0, 30.0], [2.0, -15.0]])
    moving = wake.Kelvin(Vessel(14.0, np.zeros(3), Track(time, going, turn)), 4.0)
    seen = moving.height(4.0, places + [0.0, 16.0])
    assert seen[0] != 0.0 and seen[1] == 0.0 and moving.speed(2.2) == pytest.approx(4.0)
    still = wake.Kelvin(Vessel(14.0, np.zeros(3), Track(time, 0.0 * going, turn)), 4.0)
    assert not still.height(4.0, places).any()
