"""Moving volumes of air: where they act, how strongly, and how they cross the basin (Algorithm 1)."""

import numpy as np
import pytest

from ocean_sim import basin
from ocean_sim.random_numbers import numpy_uniform3
from ocean_sim.wind.gusts import NOISE_STREAM
from ocean_sim.wind.shared.air_load import stress
from ocean_sim.wind.shared.place import turned

POINTS = np.random.default_rng(3).uniform(-5.0, 5.0, size=(4000, 3))
UP = (0.0, 1.0, 0.0)
BOX = {"kind": "box", "half_size": [0.5, 3.0, 2.0], "centre": [1.0, -1.0, 0.5], "yaw_deg": 30.0}
SPHERE = {"kind": "sphere", "radius": 2.0, "centre": [-1.0, 0.5, 1.0]}
CAPSULE = {
    "kind": "capsule",
    "radius": 0.8,
    "half_length": 2.0,
    "axis": "x",
    "centre": [0.0, 1.0, -1.0],
    "yaw_deg": 50.0,
}
EVERYWHERE = {"kind": "sphere", "radius": 1000.0}


def in_box(x):
    """As in the listing: the columns of box.pose.M are the axes of the box."""
    c, s = np.cos(np.radians(30.0)), np.sin(np.radians(30.0))
    pose = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    return (np.abs((x - [1.0, -1.0, 0.5]) @ pose) <= [0.5, 3.0, 2.0]).all(axis=1)


def in_sphere(x):
    return np.linalg.norm(x - [-1.0, 0.5, 1.0], axis=1) <= 2.0


def in_capsule(x):
    axis = np.array([np.cos(np.radians(50.0)), 0.0, -np.sin(np.radians(50.0))])  # +x turned by the right hand
    along = np.clip((x - [0.0, 1.0, -1.0]) @ axis, -2.0, 2.0)
    return np.linalg.norm(x - [0.0, 1.0, -1.0] - along[:, None] * axis, axis=1) <= 0.8


def gust(**keys):
    return {"include": [EVERYWHERE], **keys}


@pytest.mark.parametrize(
    "include, exclude, expected",
    [
        ([BOX], [], in_box),
        ([SPHERE], [], in_sphere),
        ([CAPSULE], [], in_capsule),
        ([BOX, SPHERE, CAPSULE], [], lambda x: in_box(x) | in_sphere(x) | in_capsule(x)),
        ([SPHERE], [BOX], lambda x: in_sphere(x) & ~in_box(x)),
        ([SPHERE, CAPSULE], [BOX], lambda x: (in_sphere(x) | in_capsule(x)) & ~in_box(x)),
    ],
    ids=["box", "sphere", "capsule", "union", "difference", "union less a box"],
)
def test_it_acts_in_the_included_shapes_less_the_excluded(build, force, include, exclude, expected):
    wind = build("gusts", volumes=[{"include": include, "exclude": exclude, "acceleration": [1.0, 0.0, 0.0]}])
    inside = force(wind, POINTS)[:, 0] == 1.0
    assert 0 < inside.sum() < len(POINTS)
    assert np.array_equal(inside, expected(POINTS))


@pytest.mark.anchor
def test_the_force_is_mass_times_acceleration(build, force):
    wind = build("gusts", volumes=[gust(acceleration=[-12.125, 20.0, 7.0])])
    np.testing.assert_allclose(force(wind, [0.0, 0.0, 0.0], mass=3.0), [[-36.375, 60.0, 21.0]], rtol=1e-14)


def test_volumes_add_up_exactly(build, force):
    one = {"include": [BOX], "acceleration": [1.0, 0.1, -0.3]}
    other = {"include": [SPHERE], "acceleration": [0.7, -2.0, 0.2]}
    both = force(build("gusts", volumes=[one, other]), POINTS)
    apart = [force(build("gusts", volumes=[volume]), POINTS) for volume in (one, other)]
    assert np.array_equal(both, apart[0] + apart[1])
    assert (np.all(apart[0] != 0.0, axis=1) & np.all(apart[1] != 0.0, axis=1)).any()


def test_noise_is_uniform_on_each_axis(build, force):
    n = 20_000
    a = force(build("gusts", volumes=[gust(noise=[30.0, 2.0, 0.0])]), np.zeros((n, 3)), mass=2.0) / 2.0
    for k, size in enumerate((30.0, 2.0)):
        assert np.abs(a[:, k]).max() <= size
        assert abs(a[:, k].mean()) < 4.0 * size / np.sqrt(3 * n)
        assert a[:, k].var() == pytest.approx(size**2 / 3.0, rel=4.0 * np.sqrt(0.8 / n))
    assert np.all(a[:, 2] == 0.0)


def test_noise_depends_on_seed_volume_particle_and_draw_alone(build, force):
    points, volumes = np.zeros((50, 3)), [gust(noise=[1.0, 1.0, 1.0])]
    a = force(build("gusts", volumes=volumes), points)
    assert np.array_equal(a, numpy_uniform3(7, NOISE_STREAM, np.arange(50), 0))
    assert np.array_equal(a, force(build("gusts", volumes=volumes), POINTS[:50]))
    assert not np.array_equal(a, force(build("gusts", volumes=volumes, seed=8), points))
    twice = force(build("gusts", volumes=volumes * 2), points)
    np.testing.assert_allclose(twice, a + numpy_uniform3(7, NOISE_STREAM + 1, np.arange(50), 0), rtol=1e-12)


def test_a_draw_lasts_for_its_time_whatever_the_step(build, force):
    wind = build("gusts", volumes=[gust(noise=[1.0, 1.0, 1.0])], noise_every=0.02)
    seen = []
    for _ in range(12):
        wind.advance(0.005)
        seen.append(force(wind, [0.0, 0.0, 0.0])[0, 0])
    assert seen == [x for x in numpy_uniform3(7, NOISE_STREAM, 0, np.arange(3))[:, 0] for _ in range(4)]


def test_without_a_lasting_time_every_step_draws(build, force):
    wind = build("gusts", volumes=[gust(noise=[1.0, 1.0, 1.0])], noise_every=0.0)
    seen = []
    for dt in (0.001, 0.1, 0.03):
        wind.advance(dt)
        seen.append(force(wind, [0.0, 0.0, 0.0])[0, 0])
    assert seen == numpy_uniform3(7, NOISE_STREAM, 0, np.arange(3))[:, 0].tolist()


def test_wind_acts_on_exposed_area_relative_to_the_water(build, force):
    wind = build("gusts", volumes=[gust(wind_speed=10.0, heading_deg=90.0)])
    assert wind.needs_area
    at_rest = force(wind, [0.0, 0.0, 0.0], area=(0.0, 1.5, 0.0))[0]
    assert at_rest[0] == pytest.approx(1.5 * stress(10.0)) and at_rest[1] > 0.0
    assert at_rest[2] == pytest.approx(0.0, abs=1e-15)
    assert force(wind, [0.0, 0.0, 0.0], area=(0.0, 1.5, 0.0), velocity=(6.0, 0.0, 0.0))[0, 0] == pytest.approx(
        1.5 * stress(4.0)
    )
    np.testing.assert_allclose(force(wind, [0.0, 0.0, 0.0], area=UP, velocity=(10.0, 0.0, 0.0)), 0.0, atol=1e-15)
    assert np.all(force(wind, [0.0, 0.0, 0.0]) == 0.0), "inside the water there is no exposed area"


@pytest.mark.parametrize(
    "heading, direction", [(0.0, (0.0, 0.0, 1.0)), (90.0, (1.0, 0.0, 0.0)), (-60.0, (-(0.75**0.5), 0.0, 0.5))]
)
def test_headings_say_where_the_wind_goes_to(build, force, heading, direction):
    wind = build("gusts", volumes=[gust(wind_speed=5.0, heading_deg=heading, lift_coefficient=0.0)])
    np.testing.assert_allclose(force(wind, [0.0, 0.0, 0.0], area=UP)[0], stress(5.0) * np.array(direction), atol=1e-15)


def test_it_heads_where_the_acceleration_points_by_default(build):
    assert build("gusts", volumes=[gust(acceleration=[-12.125, 20.0, 7.0], drift=14.0)]).passages[
        0
    ].velocity == pytest.approx([-12.125, 0.0, 7.0], rel=1e-3)


def test_only_volumes_with_a_wind_speed_ask_for_areas(build):
    assert not build("gusts", volumes=[gust(acceleration=[1.0, 0.0, 0.0], noise=[1.0, 1.0, 1.0])]).needs_area


def test_what_is_no_target_feels_still_air(build, force):
    wind = build("gusts", volumes=[gust(acceleration=[1.0, 0.0, 0.0], wind_speed=5.0)], targets=["ship"])
    assert wind.on("ship") is wind
    assert np.all(force(wind.on("fluid"), POINTS[:5], area=UP) == 0.0) and not wind.on("fluid").needs_area


def test_a_volume_moves_in_a_straight_line(build, force):
    moving = {
        "include": [{"kind": "sphere", "radius": 1.0, "centre": [-5.0, 0.0, 2.0]}],
        "acceleration": [0.0, 1.0, 0.0],
    }
    wind = build("gusts", volumes=[moving | {"drift": [4.0, 0.5, -1.0]}])
    for step in range(1, 101):
        wind.advance(0.01)
        centre = np.array([-5.0, 0.0, 2.0]) + 0.01 * step * np.array([4.0, 0.5, -1.0])
        np.testing.assert_allclose(wind.passages[0].centre, centre, atol=1e-12)
        around = centre + np.array(
            [[0.0, 0.0, 0.0], [0.99, 0.0, 0.0], [0.0, -0.99, 0.0], [0.0, 0.0, 1.01], [-1.01, 0.0, 0.0]]
        )
        assert force(wind, around)[:, 1].tolist() == [1.0, 1.0, 1.0, 0.0, 0.0]


NARROW = {
    "include": [{"kind": "box", "half_size": [0.5, 15.0, 18.0], "yaw_deg": 30.0, "centre": [20.433, 0.0, -11.797]}],
    "acceleration": [-12.125, 20.0, 7.0],
    "drift": 14.0,
    "redraw_yaw_deg": [20.0, 40.0],
    "redraw_strength": [0.8, 1.2],
}


def passages_seen(wind, duration, dt=0.01):
    """(number, time, turn, strength, centre) at the first step of each passage after the first."""
    seen = []
    for step in range(round(duration / dt)):
        before = wind.passages[0].number
        wind.advance(dt)
        p = wind.passages[0]
        if p.number != before:
            seen.append((p.number, (step + 1) * dt, p.turn, p.strength, p.centre))
    return seen


def test_out_of_the_border_it_comes_in_again_upwind_redrawn_from_the_seed(build, force):
    wind = build("gusts", volumes=[NARROW])
    seen = passages_seen(wind, 60.0)
    assert [s[0] for s in seen] == list(range(1, 1 + len(seen))) and len(seen) >= 15
    turns, strengths = np.array([s[2] for s in seen]), np.array([s[3] for s in seen])
    assert np.abs(np.degrees(turns)).max() <= 10.0 and np.degrees(turns).std() > 3.0
    assert strengths.min() >= 0.8 and strengths.max() <= 1.2 and strengths.std() > 0.05
    for _, _, turn, _, centre in seen:
        ahead = turned(np.array([-12.125, 0.0, 7.0]) / 14.0, turn)
        front = centre + 0.5 * ahead
        assert (
            0.0 <= 20.0 - np.abs(front[[0, 2]]).max() <= 0.14 and front @ ahead < 0.0
        )  # upwind, at most a step inside
        assert abs(np.cross(ahead, centre)[1]) < 0.05  # on a line through the middle of the basin
    p = wind.passages[0]
    a = force(wind, p.centre)[0]
    np.testing.assert_allclose(a, p.strength * turned(np.array([-12.125, 20.0, 7.0]), p.turn), rtol=1e-12)
    edge = turned(np.array([np.cos(np.pi / 6), 0.0, -np.sin(np.pi / 6)]), p.turn)  # the thin axis of the box
    assert force(wind, p.centre + 0.49 * edge)[0, 1] > 0.0 and force(wind, p.centre + 0.51 * edge)[0, 1] == 0.0


def test_passages_depend_on_the_seed_and_not_on_the_step(build):
    seen = passages_seen(build("gusts", volumes=[NARROW]), 20.0)
    again = passages_seen(build("gusts", volumes=[NARROW]), 20.0)
    finer = passages_seen(build("gusts", volumes=[NARROW]), 20.0, dt=0.0025)
    other = passages_seen(build("gusts", volumes=[NARROW], seed=8), 20.0)
    assert all(a[:4] == b[:4] and np.array_equal(a[4], b[4]) for a, b in zip(seen, again, strict=True))
    assert [s[2:4] for s in seen] == [s[2:4] for s in finer]
    assert [s[1] for s in seen] == pytest.approx([s[1] for s in finer], abs=0.0101)
    assert [s[2] for s in seen] != [s[2] for s in other]


def test_a_volume_that_stands_still_never_leaves(build):
    wind = build("gusts", volumes=[gust(acceleration=[1.0, 0.0, 0.0])])
    wind.advance(1.0e6)
    assert wind.passages[0].number == 0


def test_a_volume_put_beyond_the_lee_border_comes_in_upwind(build):
    wind = build(
        "gusts",
        volumes=[gust(include=[{"kind": "sphere", "radius": 1.0, "centre": [30.0, 0.0, 0.0]}], drift=[5.0, 0, 0])],
    )
    wind.advance(0.01)
    assert wind.passages[0].number == 1
    assert wind.passages[0].centre[0] == pytest.approx(-21.0, abs=0.06)


def test_in_a_slice_a_slanting_gust_crosses_from_end_to_end(build, force):
    wind = build("gusts", place=basin.Config(length=40.0, depth=7.5).build(), volumes=[NARROW])
    pushed, x = np.zeros(39, dtype=bool), np.linspace(-19.0, 19.0, 39)
    for _ in range(330):
        wind.advance(0.01)
        pushed |= force(wind, np.stack([x, 0 * x, 0 * x], axis=1))[:, 1] > 0.0
    assert pushed.all()


def velocities(build, force, dt, every, n=400, until=2.0):
    """What the noise has made of the velocities of particles that stay where they are, (n, 3) [m/s]."""
    wind = build("gusts", volumes=[gust(noise=[30.0, 30.0, 30.0])], noise_every=every)
    v = np.zeros((n, 3))
    for _ in range(round(until / dt)):
        wind.advance(dt)
        v += dt * force(wind, np.zeros((n, 3)))
    return v


@pytest.mark.parametrize("dt", [1 / 240, 1 / 100, 1 / 75, 1 / 30, 1 / 10])
def test_noise_is_white_in_time_and_heats_alike_whatever_the_step(build, force, dt):
    """Not the variance alone: every particle ends at the same velocity, which is that of the draws."""
    exact = 30.0 / 60.0 * numpy_uniform3(7, NOISE_STREAM, np.arange(400)[:, None], np.arange(120)).sum(axis=1)
    np.testing.assert_allclose(velocities(build, force, dt, 1 / 60), exact, atol=1e-9)


def test_a_step_much_longer_than_a_draw_heats_alike_in_the_mean(build, force):
    n, every = 2000, 1 / 300
    found = velocities(build, force, 0.05, every, n).var()
    assert found == pytest.approx(30.0**2 / 3.0 * every * 2.0, rel=4.0 * np.sqrt(2.0 / (3 * n)))


def test_a_new_draw_each_step_heats_less_the_shorter_the_step(build, force):
    """As printed: the negative control."""
    coarse, fine = (velocities(build, force, dt, 0.0).var() for dt in (1 / 30, 1 / 120))
    assert fine / coarse == pytest.approx(0.25, rel=0.15)


@pytest.mark.parametrize(
    "keys, parts",
    [
        ({"start": 1.0}, {0.5: 0.0, 1.5: 1.0, 9.0: 1.0}),
        ({"stop": 2.0}, {0.5: 1.0, 1.9: 1.0, 2.1: 0.0}),
        ({"start": 1.0, "duration": 2.0, "ramp": 0.5}, {0.5: 0.0, 1.25: 0.5, 2.0: 1.0, 2.75: 0.5, 3.5: 0.0}),
    ],
)
def test_it_begins_ends_and_rises_over_its_ramp(build, force, keys, parts):
    wind, time = build("gusts", volumes=[gust(acceleration=[2.0, 0.0, 0.0], wind_speed=5.0) | keys]), 0.0
    for moment, part in parts.items():
        wind.advance(moment + 0.005 - time)
        wind.advance(0.0)
        time = moment + 0.005
        assert force(wind, [0.0, 0.0, 0.0])[0, 0] / 2.0 == pytest.approx(part, abs=0.03), moment


def test_it_follows_a_schedule_of_speed_and_heading(build, force):
    rows = [
        {"time": 0.0, "speed": 10.0, "heading_deg": 350.0},
        {"time": 2.0, "speed": 5.0, "heading_deg": 90.0},
    ]
    wind = build("gusts", volumes=[gust(acceleration=[0.0, 1.0, 4.0], schedule=rows)])
    wind.advance(1.0)
    wind.advance(0.0)
    a = force(wind, [0.0, 0.0, 0.0])[0]
    heading = np.radians(40.0)  # half way from 350 to 450 degrees
    np.testing.assert_allclose(a, 0.75 * np.array([4.0 * np.sin(heading), 1.0, 4.0 * np.cos(heading)]), rtol=1e-12)
    wind.advance(9.0)
    wind.advance(0.0)
    np.testing.assert_allclose(force(wind, [0.0, 0.0, 0.0])[0], [2.0, 0.5, 0.0], atol=1e-12)


def test_no_field_at_all_is_refused(build):
    with pytest.raises(ValueError, match="at least 1"):
        build("gusts", volumes=[])


def test_a_thousand_fields_add_up(build, force):
    n = 1000
    volumes = [gust(acceleration=[0.001 * k, 1.0, 0.0], drift=[1.0, 0.0, 0.0]) for k in range(n)]
    wind = build("gusts", volumes=volumes)
    wind.advance(0.01)
    np.testing.assert_allclose(force(wind, [0.0, 0.0, 0.0])[0], [0.001 * n * (n - 1) / 2, n, 0.0], rtol=1e-12)


@pytest.mark.parametrize("dt", [1.0, 100.0])
def test_a_field_that_leaves_the_basin_in_mid_step_comes_in_again(build, force, dt):
    """It is finite and somewhere, also where a step is longer than a whole passage."""
    small = {"include": [{"kind": "sphere", "radius": 1.0, "centre": [20.5, 0.0, 0.0]}]}
    wind = build("gusts", volumes=[small | {"acceleration": [1.0, 0.0, 0.0], "drift": [5.0, 0.0, 0.0]}])
    for _ in range(5):
        wind.advance(dt)
        p = wind.passages[0]
        assert p.number > 0 and np.isfinite(p.centre).all() and p.centre[0] >= -21.0 - 1e-9
        assert force(wind, p.centre)[0, 0] == 1.0


@pytest.mark.parametrize("start, duration", [(0.1, 1e-3), (0.1037, 0.005), (0.1037, 0.0231)])
def test_a_short_gust_gives_the_impulse_of_its_duration_whatever_the_step(build, force, start, duration):
    wind = build("gusts", volumes=[gust(acceleration=[2.0, 0.0, 0.0], start=start, duration=duration)])
    given = 0.0
    for _ in range(40):
        wind.advance(0.005)
        given += 0.005 * force(wind, [0.0, 0.0, 0.0])[0, 0]
    assert given == pytest.approx(2.0 * duration, rel=1e-9)
