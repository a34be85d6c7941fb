"""Drops that breaking water throws: how many, how they fly and fall, and where pictures show them."""

from copy import deepcopy
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from ocean_sim import waves
from ocean_sim.basin.points import grid_points, middles
from ocean_sim.conventions import GRAVITY, WATER_DENSITY
from ocean_sim.observers import frames
from ocean_sim.pictures.stage import opengl, sky
from ocean_sim.pictures.stage.camera import Camera
from ocean_sim.pictures.stage.plotter import Stage
from ocean_sim.pictures.stage.streaks import Streaks
from ocean_sim.pictures.water import foam, spray
from ocean_sim.pictures.water.far_sea import wind_speed_from_sea
from ocean_sim.pictures.water.waterline import Hull
from ocean_sim.ship.hull.shapes import convex_triangles
from ocean_sim.waves.orbits import surface_fall

STILL = np.zeros(2)


def flat(places: np.ndarray) -> np.ndarray:
    return np.zeros(len(places))


def is_near(position: np.ndarray) -> np.ndarray:
    return (np.abs(position[:, [0, 2]]) < 50.0).all(axis=1)


def fountain(mass: float, speed: float = 4.0) -> spray.Source:
    """Four places at which water is thrown, all together so much of it [kg/s]."""
    place, fast = np.array([[x, 0.01, 0.0] for x in range(4)]), np.full(4, speed)
    radius, each = spray.drop_radius(fast), np.full(4, 0.25 * mass)
    return spray.Source(np.arange(4), place, 0.5, 0.0 * place, spray.UP, fast, radius, each)


def masses(parcels: np.ndarray) -> np.ndarray:
    return parcels[:, 7] * 4.0 / 3.0 * np.pi * WATER_DENSITY * parcels[:, 6] ** 3


def thrown_by_a_sea(spacing: float, wind: float) -> float:
    """Water that a sea of 2 m throws on 160 m x 160 m, whose heights are so far apart [m], in a wind [kg/s]."""
    spectrum = waves.Spectrum(kind="jonswap", significant_wave_height=2.0, peak_period=5.5, seed=7)
    sea, x = spectrum.components(waves.heading_vector(30.0, 3), 60.0), middles(-80.0, 80.0, spacing)
    cell, points, shape, found = np.full(2, spacing), grid_points(x, x), (len(x), len(x)), []
    field, cover = foam.FoamField(shape, cell), foam.monahan_cover(wind_speed_from_sea(sea, np.inf))
    for time in np.arange(0.0, 16.0, 0.2):
        elevation = waves.elevation(sea, points, time).reshape(shape)
        velocity = waves.surface_velocity(sea, points, time).reshape(*shape, 3)
        converging = surface_fall(elevation, *cell)
        field.advance(time, velocity[..., [0, 2]], converging, cover)
        fast = float(np.sqrt(GRAVITY * elevation.std() / converging.std()))
        shares = np.reshape([foam.cell_means(of, shape) for of in (5.0 * field.whitened, field.white)], (2, -1))
        ahead = np.array([wind, 0.0])
        made = spray.foam_sources(np.zeros((len(points), 3)), np.zeros((len(points), 3)), shares, cell, fast, ahead)
        found.append([source.mass.sum() for source in made] if time > 6.0 else [0.0, 0.0])
    assert (np.sum(found, axis=0) > 0.0).tolist() == [True, wind > spray.SPINDRIFT_WIND]
    return float(np.sum(found))


@pytest.mark.parametrize("wind", [0.0, 14.0])
def test_a_sea_throws_as_much_on_cells_half_as_wide(wind):
    """Within 25 %, by its crests and by wind that tears its foam."""
    assert thrown_by_a_sea(1.0, wind) == pytest.approx(thrown_by_a_sea(2.0, wind), rel=0.25)


def test_white_water_throws_what_was_measured():
    """Crests of the speed that calibrates the share: 5e-6 m3/m2 s while foam lasts (Fairall et al. 1994)."""
    cell, fast = np.array([2.0, 3.0]), spray.CALIBRATION_SPEED / spray.BREAKER_SPEED_SHARE
    made = spray.foam_sources(np.zeros((1, 3)), np.zeros((1, 3)), np.array([[1.0], [0.0]]), cell, fast, STILL)[0]
    assert made.mass.sum() == pytest.approx(5.0e-6 * foam.FADE_SECONDS * WATER_DENSITY * 6.0)


def test_calm_water_throws_nothing():
    """Slow water, a ship that lies still, and water at rest beside air and on a step."""
    block = 0.1 * grid_points(np.arange(6.0), np.arange(6.0))
    block = np.concatenate([np.insert(block, 1, 0.1 * k, axis=1) for k in range(6)])
    calm = spray.airborne_source(block, 0.0 * block, np.full(len(block), -0.05), 0.1)
    bow = spray.bow_source(0, np.array([4.0, 14.0]), np.zeros(3), np.zeros(3), np.array([0.0, 0.0, 1.0]), flat)
    few = np.array([[1.0], [0.0]])
    slow = spray.foam_sources(np.zeros((1, 3)), np.zeros((1, 3)), few, np.ones(2), 0.5, np.array([9.0, 0.0]))
    pool = spray.Spray(1, 3)
    pool.advance(0.0, [], STILL, flat, is_near)
    for time in (0.1, 0.2):
        pool.advance(time, [calm, bow, *slow], STILL, flat, is_near)
    assert not len(pool.parcels) and not sum(source.mass.sum() for source in (calm, bow, *slow))


def test_a_bow_throws_more_the_faster_she_goes_and_as_she_plunges():
    def thrown(speed: float, rise: float) -> float:
        meets, ahead = np.array([0.0, -rise, speed]), np.array([0.0, 0.0, 1.0])
        made = spray.bow_source(0, np.array([4.0, 14.0]), np.array([0.0, -0.5, 7.0]), meets, ahead, flat)
        assert (made.place[:, 2] <= 7.0).all() and made.place[:, 0].sum() == pytest.approx(0.0, abs=1e-9)
        return float(made.mass.sum())

    slow, fast, plunging, rising = thrown(3.0, 0.0), thrown(6.0, 0.0), thrown(6.0, 1.5), thrown(6.0, -1.5)
    assert 0.0 < 3.0 * slow < fast < plunging and rising == fast


def test_drops_fly_alike_in_one_step_and_in_many_and_reach_their_terminal_speed_and_the_wind():
    start = np.array([[0.0, 20.0, 0.0, 3.0, 6.0, 0.0, 1e-3, 1.0, 1e-3]])
    once, often = spray.fly_parcels(start, 0.5, STILL), start
    for _ in range(50):
        often = spray.fly_parcels(often, 0.01, STILL)
    np.testing.assert_allclose(once, often, rtol=1e-9)
    late = spray.fly_parcels(spray.fly_parcels(start, 20.0, np.array([10.0, 0.0])), 1e-9, STILL)
    assert late[0, 4] == pytest.approx(-6.55, abs=0.05)  # of drops of 2 mm (Gunn & Kinzer 1949, J. Meteorol. 6)
    assert late[0, 3] == pytest.approx(10.0, rel=1e-6)


def test_as_much_falls_back_as_is_thrown_and_the_pool_holds_no_more_than_it_may():
    pool, fallen, thrown = spray.Spray(3, 3), 0.0, 4.0
    pool.advance(0.0, [], STILL, flat, is_near)
    for n in range(1, 41):
        landed = pool.advance(0.05 * n, [fountain(thrown if n <= 20 else 0.0)], STILL, flat, is_near)
        fallen += masses(landed).sum()
        assert len(pool.parcels) <= spray.POOL_PARCELS
    left = masses(pool.parcels).sum()
    assert fallen + left == pytest.approx(thrown, rel=0.1) and left < 0.1 * thrown


def test_drops_depend_on_seed_place_and_frame_alone():
    """A copy, as a checkpoint keeps it, goes on to the byte; another seed throws others."""
    pool, other = spray.Spray(3, 3), spray.Spray(4, 3)
    for n in range(3):
        for each in (pool, other):
            each.advance(0.1 * n, [fountain(2.0)], np.array([3.0, 1.0]), flat, is_near)
    copy = deepcopy(pool)
    for each in (pool, copy):
        each.advance(0.3, [fountain(2.0)], np.array([3.0, 1.0]), flat, is_near)
    assert pool.parcels.tobytes() == copy.parcels.tobytes() != other.parcels.tobytes()
    radius = np.log(pool.parcels[:, 6])
    assert radius.std() == pytest.approx(spray.RADIUS_DEVIATION, rel=0.1)  # log-normal


def test_drops_end_at_a_hull_and_stay_in_a_slice():
    """A box, whose corner is cut off, from its mesh; thrown where all of z is 0, drops fly along x and y alone."""
    corners = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (0.0, 1.0) for z in (-3.0, 3.0)][:-1])
    mesh = convex_triangles(SimpleNamespace(vertices=lambda: corners))
    hull = Hull({f"own_{name}": values for name, values in mesh.items()}, "own")
    at, turn = np.array([0.0, 0.2, 0.0]), Rotation.from_euler("y", 90.0, degrees=True).as_matrix()
    inside = np.array([[0.0, 0.5, 0.0], [-0.9, 0.9, 2.8]]) @ turn.T + at
    outside = np.array([[0.0, 1.1, 0.0], [0.9, 0.9, 2.8], [1.2, 0.5, 0.0], [0.0, -9.0, 0.0]]) @ turn.T + at
    assert hull.encloses(inside, at, turn).all() and not hull.encloses(outside, at, turn).any()
    free, held, thin = spray.Spray(3, 3), spray.Spray(3, 3), spray.Spray(3, 2)
    for n in range(4):
        for pool, is_open in (
            (free, is_near),
            (held, lambda points: ~hull.encloses(points, at, turn)),
            (thin, is_near),
        ):
            pool.advance(0.1 * n, [fountain(2.0)], STILL, flat, is_open)
    assert hull.encloses(free.parcels[:, :3], at, turn).any() and len(held.parcels) > 0
    assert not hull.encloses(held.parcels[:, :3], at, turn).any()
    assert not thin.parcels[:, [2, 5]].any() and thin.parcels[:, 3].any()


def test_drops_that_fall_whiten_as_large_an_area():
    field = foam.FoamField((20, 20), np.array([2.0, 2.0]))
    field.receive(np.array([[4.0, 6.0], [4.0, 6.0], [11.0, 3.2], [30.0, 3.0]]), np.array([0.2, 0.1, 0.4, 9.0]))
    assert field.white.sum() == pytest.approx(0.7) and field.white[9, 13] == pytest.approx(0.3)


def test_a_wake_lies_where_the_stern_was_fades_and_none_where_she_rests():
    """Of 4 m in breadth, 4 m/s: white as wide as she is, down to a third in 7 s."""
    cell, shape = np.array([1.0, 1.0]), (41, 121)
    left = {}
    for speed in (0.0, 4.0):
        body = SimpleNamespace(position=np.zeros(3), matrix=np.eye(3), velocity=np.array([0.0, 0.0, speed]))
        field = foam.FoamField(shape, cell, frames.WAKE_SECONDS)
        fake = SimpleNamespace(left=field, ships=[SimpleNamespace(body=body)], sizes=[(4.0, 15.0)], cell=cell)
        for n in range(61):
            body.position = np.array([0.0, 0.0, speed * 0.2 * n])
            frames.Frames.leave_wakes(fake, 0.2 * n, np.array([-20.0, -40.0]), np.zeros((*shape, 2)))
        left[speed] = foam.cell_means(field.white, shape)
    assert not left[0.0].any()
    stern, behind = 48.0 - 0.46 * 15.0 + 40.0, left[4.0][19:22].mean(axis=0)
    assert behind[int(stern) - 3] > 0.6 and not left[4.0][:, int(stern) + 3 :].any() and not left[4.0][:16].any()
    assert behind[int(stern) - 30] == pytest.approx(behind[int(stern) - 2] * np.exp(-28.0 / 4.0 / 7.0), rel=0.15)


@pytest.mark.skipif(opengl.probe() is not None, reason="no OpenGL on this machine")
def test_drops_are_seen_before_a_wall_and_not_behind_it_and_longer_the_faster_they_fly():
    """White on a dark wall of which the eye is 5 m away."""
    eye, ahead, up = np.array([0.0, 0.0, 5.0]), np.array([0.0, 0.0, -1.0]), np.array([0.0, 1.0, 0.0])
    stage = Stage((320, 180), Camera(eye, ahead, up, None), 1)
    stage.plotter.camera.position, stage.plotter.camera.focal_point = tuple(eye), (0.0, 0.0, 0.0)
    stage.plotter.camera.up, stage.plotter.camera.view_angle = tuple(up), 35.0
    stage.plotter.camera.clipping_range = (0.1, 50.0)
    wall = np.array([[-9.0, -9.0, 0.0], [9.0, -9.0, 0.0], [9.0, 9.0, 0.0], [-9.0, 9.0, 0.0]])
    stage.add(wall, np.array([[0, 1, 2, 3]]), np.full((4, 3), 20, np.uint8))
    drawn = Streaks(stage, sky.clear_sky_image(), 1.0)
    bright = {}
    for name, z, speed, many in (
        ("none", 1.0, 0.0, 0),
        ("slow", 1.0, 0.1, 1),
        ("fast", 1.0, 10.0, 1),
        ("hidden", -1.0, 10.0, 1),
    ):
        drawn.show(np.tile([[0.0, 0.0, z, speed, 0.0, 0.0, 0.03, 1.0, 0.03]], (many, 1)))
        stage.render()
        bright[name] = int((stage.plotter.screenshot(None, return_img=True).max(axis=2) > 40).sum())
    stage.plotter.close()
    assert bright["none"] == bright["hidden"] == 0 and bright["fast"] > 3 * bright["slow"] > 0
