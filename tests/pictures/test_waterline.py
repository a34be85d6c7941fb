"""Kelvin's waves behind a ship: where they are, and how long."""

import numpy as np
import pytest

from ocean_sim.conventions import GRAVITY
from ocean_sim.pictures.stage.camera import Track, Vessel
from ocean_sim.pictures.water import waterline
from ocean_sim.pictures.water.waterline import Bow


def test_waves_astern_have_the_length_of_the_speed_and_stay_within_kelvin_s_angle():
    speed, breadth, length = 4.0, 2.0, 14.0
    height = waterline.kelvin_pattern(speed, breadth, length)
    step = waterline.PATTERN_STEP * breadth
    x = step * np.arange(len(height))
    wavelength = 2.0 * np.pi * speed**2 / GRAVITY
    far = x > 3.0 * length
    astern = height[far, 0]
    crossings = x[far][:-1][(astern[:-1] < 0.0) & (astern[1:] >= 0.0)]
    assert np.diff(crossings).mean() == pytest.approx(wavelength, rel=0.12)
    y = step * np.arange(height.shape[1])
    outside = np.arctan2(y[None, :], x[:, None] + 1e-9) > np.arcsin(1.0 / 3.0) + 0.12
    assert np.abs(height[outside & (x > 2.0 * length)[:, None]]).max() < 0.2 * np.abs(height).max()
    assert np.abs(height).max() == pytest.approx(waterline.KELVIN_HEIGHT * speed**2 / GRAVITY)


def test_waves_are_behind_the_ship_and_none_where_she_lies_still():
    time = np.arange(0.0, 5.0, 0.5)
    turn = np.broadcast_to(np.eye(3), (len(time), 3, 3))
    going = np.stack([0.0 * time, 0.0 * time, 4.0 * time], axis=1)
    places = np.array([[0.0, -20.0], [0.0, 30.0], [2.0, -15.0]])
    moving = Vessel(14.0, np.zeros(3), Track(time, going, turn))
    seen = waterline.kelvin_height(moving, 4.0, 4.0, places + [0.0, 16.0])
    assert seen[0] != 0.0 and seen[1] == 0.0 and moving.speed(2.2) == pytest.approx(4.0)
    still = Vessel(14.0, np.zeros(3), Track(time, 0.0 * going, turn))
    assert not waterline.kelvin_height(still, 4.0, 4.0, places).any()


def test_a_bow_wave_has_the_height_and_place_of_a_wedge_s():
    """At 4 m/s by hand: half an entrance of tangent 0.408, draught 1 m, V^2 / g = 1.631 m, a Froude number of 1.277."""
    going = Bow(14.0, 4.0, 4.0)
    assert going.wedge == pytest.approx(0.408, abs=1e-3)
    assert going.crest == pytest.approx((min(2.2 / 2.277 * 0.408 * 1.080 * 1.631, 0.8), 1.1 / 2.277 * 1.631), rel=2e-3)
    aft = np.linspace(-6.0, 14.0, 2001)
    height = going.height(aft, np.zeros_like(aft))
    assert aft[height.argmax()] == pytest.approx(going.crest[1], abs=0.02) and height.max() == pytest.approx(
        going.crest[0], rel=1e-3
    )
    assert height[0] < 1e-3 and height[-1] < 0.1 * height.max()


def test_a_bow_wave_stands_as_high_as_water_can_rise_where_published_theory_has_it():
    """At V / sqrt(g D) = 4.4 tan / cos - 1, above which waves at wedges overturn and below which they are unsteady
    (Delhommeau et al. 2009), the crest is V^2 / 2 g high."""
    wedge = Bow(14.0, 4.0, 1.0).wedge
    speed = (4.4 * wedge * np.hypot(1.0, wedge) - 1.0) * np.sqrt(GRAVITY * waterline.DRAUGHT_SHARE * 4.0)
    assert Bow(14.0, 4.0, speed).crest[0] == pytest.approx(speed**2 / (2.0 * GRAVITY))


def test_the_bow_wave_leaves_the_hull_at_an_angle_and_is_steeper_outside():
    going, aside = Bow(14.0, 4.0, 4.0), np.linspace(-1.0, 9.0, 2001)
    near, far = (going.height(np.full_like(aside, at), aside) for at in (3.0, 7.0))
    assert aside[far.argmax()] - aside[near.argmax()] == pytest.approx(4.0 * waterline.CREST_SLOPE, abs=0.01)
    crest = near.argmax()
    assert near[crest + 100] < near[crest - 100]


def test_the_bow_is_the_whiter_the_faster_she_goes_and_not_at_all_where_she_lies():
    abaft, gap = np.linspace(0.0, 14.0, 57), np.zeros(57)
    white = np.array([Bow(14.0, 4.0, speed).white(abaft, gap).mean() for speed in (0.0, 0.5, 1.0, 2.0, 4.0)])
    assert white[0] == white[1] == 0.0 and (np.diff(white[1:]) > 0.0).all()
    fast = Bow(14.0, 4.0, 4.0)
    assert fast.white(np.array([fast.crest[1]]), np.zeros(1))[0] == pytest.approx(1.0)
    assert fast.white(np.array([1.0, -4.0]), np.array([6.0, 0.0])).max() < 0.02  # far off, and ahead of her
    assert Bow(14.0, 4.0, 0.0).height(abaft, gap).max() == 0.0


def test_water_behind_a_transom_is_hollow_and_rises_again_half_a_wave_astern():
    speed, breadth = 4.0, 4.2
    half_wave = np.pi * speed**2 / GRAVITY
    astern = np.array([1e-6, 0.5 * half_wave, half_wave, 40.0 * half_wave, -2.0 * breadth, 1e-6])
    depth = waterline.transom_hollow(astern, np.array([0.0, 0.0, 0.0, 0.0, 0.0, 2.0 * breadth]), speed, breadth)
    assert depth[0] == pytest.approx(waterline.HOLLOW_DEPTH * speed**2 / GRAVITY, rel=1e-4)
    assert depth[1:] == pytest.approx([0.0, -np.exp(-0.3 * np.pi) * depth[0], 0.0, 0.0, 0.0], abs=1e-6)
    assert waterline.transom_hollow(astern, 0.0 * astern, 20.0, breadth).max() <= waterline.MAX_HOLLOW * breadth


def test_waves_at_a_ship_stand_no_higher_than_her_speed_lets_them_and_small_ones_are_left():
    speed, length, breadth = 4.0, 14.0, 4.0
    time = np.arange(0.0, 5.0, 0.5)
    turn = np.broadcast_to(np.eye(3), (len(time), 3, 3))
    going = np.stack([0.0 * time, 0.0 * time, speed * time], axis=1)
    ship = Vessel(length, np.zeros(3), Track(time, going, turn))
    x, z = np.linspace(-40.0, 40.0, 41), np.linspace(-60.0, 80.0, 71)
    steep = 2.5 * np.cos(0.9 * z)[None, :] * np.ones((41, 1))
    drawn = waterline.limited_answer(steep, ship, breadth, x, z, 4.0)
    beside, behind = np.abs(x) <= 2.0, (z < 16.0) & (z > 16.0 - 0.6 * length)
    most = speed**2 / (2.0 * GRAVITY)
    assert np.abs(drawn[np.ix_(beside, behind)]).max() < 1.2 * most
    np.testing.assert_allclose(drawn[np.abs(x) > 10.0], steep[np.abs(x) > 10.0], atol=1e-6)
    low = waterline.limited_answer(0.1 * most * steep / 2.5, ship, breadth, x, z, 4.0)
    np.testing.assert_allclose(low, 0.1 * most * steep / 2.5, rtol=0.01)
