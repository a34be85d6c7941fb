"""Cameras that go with a ship: where they are is a function of the time and of where the ship has been."""

from types import SimpleNamespace

import numpy as np
import pytest

from ocean_sim.pictures.stage import camera as camera_module
from ocean_sim.pictures.stage.camera import Operator, Track, Vessel
from ocean_sim.pictures.stage.picture import swept_box, windy_box

LOWER, UPPER = np.array([-100.0, -20.0, -100.0]), np.array([100.0, 2.0, 100.0])
LENGTH, SPEED, STEP = 15.0, 4.0, 0.05


def rolled(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


@pytest.fixture
def operator():
    """Of a ship that goes along +z at a constant speed and rolls."""

    def build(name, roll=0.0, **given):
        time = np.arange(400) * STEP
        place = np.stack([0.0 * time, 0.4 + 0.0 * time, SPEED * time - 40.0], axis=1)
        track = Track(time, place, np.repeat(rolled(roll)[None], len(time), axis=0))
        vessel = Vessel(LENGTH, np.array([0.0, 2.5, 1.5]), track)
        return Operator(name, LOWER, UPPER, 16 / 9, (time[0], time[-1]), vessel=vessel, **given)

    return build


def test_every_name_has_a_camera_whose_axes_are_square(operator):
    for name in camera_module.CameraName.__args__:
        given = {"eye": (30.0, 5.0, 0.0), "target": (0.0, 0.0, 0.0)} if name == "fixed" else {}
        camera = operator(name, **given).at(3.0)
        assert np.isfinite(camera.eye).all()
        assert np.linalg.norm(camera.forward) == pytest.approx(1.0) and np.linalg.norm(camera.up) == pytest.approx(1.0)
        assert camera.forward @ camera.up == pytest.approx(0.0, abs=1e-9)


def test_follow_is_behind_the_ship_and_lags_as_a_first_order_filter_does(operator):
    lag = camera_module.FOLLOW_LAGS[0]
    decay = np.exp(-STEP / lag)
    place, heading = camera_module.damped_track(operator("follow").vessel.track)
    behind = SPEED * 18.0 - 40.0 - place[360, 2]
    assert behind == pytest.approx(SPEED * STEP * decay / (1.0 - decay), rel=1e-6)  # steady state of a ramp
    assert behind == pytest.approx(SPEED * lag, rel=0.05) and np.abs(heading).max() < 1e-12
    camera = operator("follow").at(18.0)
    assert camera.eye[2] < SPEED * 18.0 - 40.0 - LENGTH and camera.eye[1] > 0.3 * LENGTH and camera.forward[2] > 0.8


def test_the_heading_of_follow_does_not_jump_where_the_angle_does():
    time = np.arange(200) * STEP
    angle = np.linspace(3.0, 3.3, 200)  # through pi
    turn = np.zeros((200, 3, 3))
    turn[:, 0, 2], turn[:, 2, 2] = np.sin(angle), np.cos(angle)
    _, heading = camera_module.damped_track(Track(time, np.zeros((200, 3)), turn))
    assert np.abs(np.diff(heading)).max() < 0.01


def test_from_the_helm_the_horizon_rolls_with_the_ship(operator):
    roll = np.radians(10.0)
    level, leaning = operator("first_person").at(5.0), operator("first_person", roll).at(5.0)
    assert level.up[0] == 0.0
    right, up = np.cross(leaning.forward, leaning.up), leaning.up
    assert np.arctan2(right[1], up[1]) == pytest.approx(-roll, abs=0.01) or np.arctan2(
        right[1], up[1]
    ) == pytest.approx(roll, abs=0.01)
    np.testing.assert_allclose(level.eye, [0.0, 2.9, -18.5], atol=1e-9)
    assert leaning.eye[0] == pytest.approx(-2.5 * np.sin(roll))
    assert level.forward[1] < 0.0  # the bow is below


def test_orbit_goes_around_once_and_stays_as_far(operator):
    orbit = operator("orbit")
    start, end = orbit.span

    def bearing(time):
        eye = orbit.at(time).eye - [0.0, 0.0, SPEED * time - 40.0]
        return np.arctan2(eye[0], eye[2]), np.linalg.norm(eye)

    times = np.linspace(start, end, 60)
    angles, far = np.array([bearing(time) for time in times]).T
    assert np.unwrap(angles)[-1] - angles[0] == pytest.approx(2.0 * np.pi)
    np.testing.assert_allclose(far, far[0], rtol=1e-9)


def test_a_picture_does_not_depend_on_what_was_drawn_before_it(operator):
    for name in ("follow", "orbit", "first_person", "third_person"):
        one, other = operator(name), operator(name)
        for time in (1.0, 9.0, 4.0):
            one.at(time)
        np.testing.assert_array_equal(one.at(6.0).eye, other.at(6.0).eye)


@pytest.mark.parametrize("side", [30.0, 200.0])  # [m] of a basin that is seen whole, and of one that is not
def test_the_mast_is_in_the_picture_wherever_she_is(side):
    upper, height = np.array([0.5 * side, 0.5, 0.5 * side]), 8.5
    time = np.linspace(0.0, 10.0, 11)
    place = np.stack([0.0 * time, 0.0 * time, np.linspace(-0.3, 0.3, 11) * side], axis=1)
    vessel = Vessel(LENGTH, np.zeros(3), Track(time, place, np.repeat(np.eye(3)[None], 11, axis=0)), height)
    moving = Operator("third_person", -upper, upper, 16 / 9, (0.0, 10.0), vessel=vessel)
    for t, foot in zip(time, place):
        camera = moving.at(t)
        for point, sign in (([0.0, height + 1.0, 0.0], 1.0), ([0.0, -0.5, 0.0], -1.0)):
            away = foot + point - camera.eye
            assert sign * (away @ camera.up) / (away @ camera.forward) < np.tan(np.radians(camera.angle / 2.0))


@pytest.mark.parametrize("width", [1.0, 4.0])
def test_the_frame_of_a_tank_holds_all_its_walls_and_a_tenth_more(width):
    """Whatever floats in it, in a tank that is long for it."""
    lower, upper = np.array([-3.0, -1.0, -0.5 * width]), np.array([3.0, 0.12, 0.5 * width])
    track = Track(np.arange(2.0), np.array([[-2.0, 0.0, 0.0], [2.0, 0.0, 0.0]]), np.repeat(np.eye(3)[None], 2, axis=0))
    vessel = Vessel(0.5, np.zeros(3), track, 0.3)
    tank = Operator("third_person", lower, upper, 16 / 9, (0.0, 1.0), vessel=vessel, whole=True)
    corners = np.array([[(lower, upper)[b][a] for a, b in enumerate(k)] for k in np.ndindex(2, 2, 2)])
    for camera in (tank.at(0.0), tank.at(1.0)):
        away = corners - camera.eye
        half = np.tan(np.radians(camera.angle / 2.0)) * (away @ camera.forward)
        across = np.abs(away @ np.cross(camera.forward, camera.up)) / half / (16 / 9)
        high = np.abs(away @ camera.up) / half
        assert 0.8 < max(across.max(), high.max()) < 1.0001 / 1.1


def test_cameras_without_a_ship_stand_still_or_go_around_the_basin():
    still = Operator("third_person", LOWER, UPPER, 16 / 9, (0.0, 10.0), vessel=None)
    assert still.at(1.0) is still.at(9.0)
    orbit = Operator("orbit", LOWER, UPPER, 16 / 9, (0.0, 10.0), vessel=None)
    np.testing.assert_allclose(orbit.at(0.0).eye, orbit.at(10.0).eye)
    assert np.linalg.norm(orbit.at(0.0).eye - orbit.at(5.0).eye) > 100.0


def test_a_map_holds_all_that_a_piece_of_sea_covers_that_goes_with_its_ships():
    """Two ships, one moored at x = 18 m, one that goes by 60 m along z: their middle goes by 30 m."""
    going = np.stack([np.full(5, -4.0), np.full(5, 0.3), np.linspace(-45.0, 15.0, 5)], axis=1)
    moored = np.tile([18.0, -0.2, 0.0], (5, 1))
    lower, upper = swept_box(np.array([-80.0, -30.0, -120.0]), np.array([80.0, 1.0, 120.0]), [going, moored])
    np.testing.assert_allclose(lower, [-73.0, -30.0, -142.5])
    np.testing.assert_allclose(upper, [87.0, 1.0, 127.5])


def test_a_map_holds_the_wind_beside_a_basin_and_none_that_is_far():
    """A gust that crosses one side by 20 m, and has come from 500 m away: of that a quarter of the basin is shown."""
    near, far = (SimpleNamespace(wind_lines=np.array([[[a, -5.0, 0.0], [90.0, -5.0, 120.0]]])) for a in (-90.0, -500.0))
    np.testing.assert_allclose(windy_box(LOWER, UPPER, [near]), [LOWER, [100.0, 2.0, 120.0]])
    np.testing.assert_allclose(windy_box(LOWER, UPPER, [near, far])[0], [-150.0, -20.0, -100.0])


def test_at_sea_the_camera_from_the_side_goes_with_a_ship_and_shows_her_length():
    """Wherever she heads and has gone to; she goes to the right."""
    time, far = np.linspace(0.0, 10.0, 11), np.array([60.0, 1.0, 60.0])
    for heading in (0.0, 0.9, -2.0):
        ahead = np.array([np.sin(heading), 0.0, np.cos(heading)])
        turn = np.array([[ahead[2], 0.0, ahead[0]], [0.0, 1.0, 0.0], [-ahead[0], 0.0, ahead[2]]])
        track = Track(time, 6.0 * time[:, None] * ahead, np.repeat(turn[None], 11, axis=0))
        vessel = Vessel(LENGTH, np.zeros(3), track, 8.5)
        seen = Operator("side", -far, far, 16 / 9, (0.0, 10.0), vessel=vessel, away=True, at_sea=True).at(10.0)
        at = [track.position[-1] + share * LENGTH * ahead - seen.eye for share in (0.5, -0.5)]
        wide = np.tan(np.radians(seen.angle / 2.0)) * 16 / 9
        bow, stern = (float(off @ np.cross(seen.forward, seen.up) / (off @ seen.forward)) / wide for off in at)
        assert 0.25 < bow < 0.9 and abs(seen.forward @ ahead) < 0.1
        assert 0.5 < bow - stern < 1.0 and 1.0 < seen.eye[1] < 10.0


def test_an_open_sea_is_seen_from_beside_it_low_over_the_water():
    lower, upper = np.array([-60.0, -20.0, -40.0]), np.array([60.0, 1.0, 40.0])
    seen = camera_module.Operator("side", lower, upper, 16 / 9, (0.0, 1.0), at_sea=True).at(0.0)
    assert seen.parallel_height is None and 2.0 < seen.eye[1] < 10.0
    for x in (lower[0], upper[0]):
        off = np.array([x, 0.0, 0.0]) - seen.eye
        aside = abs(off @ np.cross(seen.forward, seen.up)) / (off @ seen.forward)
        assert aside < np.tan(np.radians(seen.angle / 2.0)) * 16 / 9
    block = camera_module.Operator("side", lower, upper, 16 / 9, (0.0, 1.0)).at(0.0)
    assert block.parallel_height is not None


def test_a_map_is_a_plan_whose_scale_is_the_same_at_every_height():
    seen = camera_module.camera_on_box("top", LOWER, UPPER, 16 / 9)
    assert seen.parallel_height is not None and seen.from_above
    assert (
        seen.parallel_height * 16 / 9 >= 0.5 * (UPPER - LOWER)[0] and seen.parallel_height >= 0.5 * (UPPER - LOWER)[2]
    )
    assert seen.eye[1] > UPPER[1]
