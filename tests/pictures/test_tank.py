"""Pictures of water that folds: its surface without the lattice of particles, and air where it is stirred."""

import numpy as np
import pytest

from ocean_sim.pictures.water import tank_walls
from ocean_sim.pictures.water.smoothed_mesh import low_pass_weights, smooth_mesh
from ocean_sim.pictures.water.splash import (
    birth_places,
    floor_heights,
    flying_share,
    particle_splash,
    risen_share,
    sphere_mesh,
    stirred_air,
    torn_drops,
    travel_share,
    values_at_vertices,
)
from ocean_sim.pictures.water.water_mesh import grid_triangles
from ocean_sim.surface import Mesh

SPACING = 0.04  # [m] of particles; edges of a mesh are half as long
BOX = (-1.0, -1.0, -1.0), (1.0, 1.0, 1.0)
MOST = 0.4 * SPACING


def sheet(height) -> Mesh:
    """A surface over x and z that ends within the box."""
    x, z = np.meshgrid(np.linspace(-0.9, 0.9, 91), np.linspace(-0.5, 0.5, 51), indexing="ij")
    vertices = np.stack([x, height(x), z], axis=-1).reshape(-1, 3)
    return Mesh(vertices, grid_triangles(91, 51), np.zeros_like(vertices))


def over(mesh: Mesh, height) -> np.ndarray:
    """Heights of a sheet over a law of x, away from its free edges [m]."""
    x, y, _ = np.moveaxis(mesh.vertices.reshape(91, 51, 3)[20:-20, 15:-15], -1, 0)
    return y - height(x)


def test_terraces_on_a_slope_are_smoothed_away_and_the_mean_stays():
    """Layers of particles on a slope of 1 : 3 are 0.12 m long."""
    slope, terraces = (lambda x: -x / 3.0), (lambda x: 0.15 * SPACING * np.sin(2.0 * np.pi * x / 0.12))
    left = over(smooth_mesh(sheet(lambda x: slope(x) + terraces(x)), *BOX, MOST), slope)
    assert np.abs(left).max() < 0.1 * 0.15 * SPACING
    assert abs(left.mean()) < 0.01 * SPACING


def test_waves_of_a_dozen_spacings_and_more_are_left_alone():
    wave = lambda x: 0.05 * np.cos(2.0 * np.pi * x / (18.0 * SPACING))
    assert np.abs(over(smooth_mesh(sheet(wave), *BOX, MOST), wave)).max() < 0.05 * 0.05


def test_no_vertex_goes_farther_than_it_may():
    rough = sheet(lambda x: np.random.default_rng(1).normal(0.0, SPACING, x.shape))
    way = np.linalg.norm(smooth_mesh(rough, *BOX, MOST).vertices - rough.vertices, axis=1)
    assert 0.9 * MOST < way.max() <= 1.02 * MOST  # the layer that keeps the volume is thin


@pytest.mark.parametrize("edge, degree", [(0.3, 32), (0.8, 12)])
def test_the_filter_passes_long_waves_halves_at_its_edge_and_stops_short_ones(edge, degree):
    weights, n = low_pass_weights(edge, degree), np.arange(degree + 1)
    passed = [float(weights @ np.cos(n * angle)) for angle in (0.0, edge, edge + 2.5 * np.pi / degree, np.pi)]
    assert passed == pytest.approx([1.0, 0.5, 0.0, 0.0], abs=0.06)


def test_water_that_goes_as_one_holds_no_air_and_jets_that_meet_do():
    block = np.stack(np.meshgrid(*[np.arange(8) * SPACING] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    fast = np.tile([3.0, 0.0, 0.0], (len(block), 1))
    meeting = fast * np.where(block[:, :1] < 4 * SPACING, 1.0, -1.0)
    assert stirred_air(block, 0.0 * fast, 1.0).max() == 0.0
    assert stirred_air(block, fast, 1.0).max() == 0.0
    air = stirred_air(block, meeting, 1.0)
    front = np.abs(block[:, 0] - 3.5 * SPACING) < SPACING
    assert air[front].min() > 0.9 and air[block[:, 0] < 1.5 * SPACING].max() < 0.1


def column(breadth: int, height: int) -> np.ndarray:
    """Particles of a block of water, its corner at the origin."""
    return SPACING * (
        np.stack(np.meshgrid(*map(np.arange, (breadth, height, breadth)), indexing="ij"), -1) + 0.5
    ).reshape(-1, 3)


def test_water_over_air_flies_and_what_stands_on_the_bed_or_on_a_box_does_not():
    pool = column(10, 3)
    sheet, box = pool[pool[:, 1] < SPACING] + [0.0, 8 * SPACING, 0.0], np.array([[[-1.0, -1.0, -1.0], [1.0, 0.2, 1.0]]])
    both = np.concatenate([pool, sheet])
    np.testing.assert_array_equal(flying_share(both, np.zeros(len(both)), SPACING), both[:, 1] > 8 * SPACING)
    assert not flying_share(pool + [0.0, 0.2, 0.0], floor_heights(pool + [0.0, 0.2, 0.0], 0.0, box), SPACING).any()
    assert flying_share(pool + [0.0, 0.2, 0.0], np.zeros(len(pool)), SPACING).all()


def test_a_jet_is_over_the_water_around_it_and_a_slope_is_not():
    cells = SPACING * (np.arange(40) + 0.5)
    cell, corner = np.array([SPACING, SPACING]), np.zeros(2)
    slope = np.broadcast_to(0.3 * cells[:, None], (40, 40)).copy()
    top = np.stack([cells[20], slope[20, 20], cells[20]])[None]
    assert risen_share(top, slope, corner, cell, SPACING)[0] == 0.0
    slope[19:22, 19:22] += 8 * SPACING
    assert risen_share(top + [0.0, 8 * SPACING, 0.0], slope, corner, cell, SPACING)[0] == 1.0


def test_calm_water_is_whole_and_a_fast_thin_jet_comes_apart():
    """Beside the sides of its tank, too, behind which there are no neighbours."""
    pool, jet = column(8, 8), column(8, 8)
    jet = jet[(jet[:, 0] < SPACING) & (jet[:, 2] < SPACING)]
    calm = particle_splash(pool, np.zeros_like(pool), np.zeros(len(pool)), np.zeros(len(pool)), SPACING, 1.0)
    assert not any(part.any() for part in calm)
    sides = ((pool < SPACING) | (pool > 7 * SPACING))[:, [0, 2]].sum(axis=1)
    fast = np.full_like(pool, 3.0)
    assert (
        not particle_splash(pool, fast, np.zeros(len(pool)), sides, SPACING, 1.0)
        .torn[pool[:, 1] < 7 * SPACING][8:]
        .any()
    )
    apart = particle_splash(jet, np.full_like(jet, 3.0), np.zeros(len(jet)), np.zeros(len(jet)), SPACING, 1.0)
    assert apart.torn.min() == 1.0 and apart.air.min() >= 0.5


def test_grain_is_that_of_the_place_where_water_was_in_the_first_picture():
    now, first = np.random.default_rng(2).normal(size=(2, 5, 3))
    found = birth_places(now, np.array([4, 0, 9, 2, 1]), first, np.array([2, 0, 1, 3, 4]))
    np.testing.assert_array_equal(found, [first[4], first[1], now[2], first[0], first[2]])


def test_water_has_set_off_once_it_is_elsewhere_or_where_it_was_not_at_first():
    """What stands where the run began does not splash up, however high over the water around it."""
    first = column(2, 2)
    now, number = first + 3.0 * SPACING * (first[:, :1] > SPACING), np.arange(8)
    gone = travel_share(now, number, first, number[1:], SPACING)
    np.testing.assert_array_equal(gone, (first[:, 0] > SPACING) | (number == 0))
    assert 0.0 < travel_share(first + [SPACING, 0.0, 0.0], number, first, number, SPACING).min() < 1.0


def test_drops_fly_where_water_is_torn_along_its_way_and_are_the_same_ones_in_the_next_picture():
    position, velocity = np.tile([[0.0, 0.0, 0.0], [9.0, 0.0, 0.0]], (200, 1)), np.tile([3.0, 0.0, 0.0], (400, 1))
    number, torn = np.arange(400), np.tile([1.0, 0.0], 200)
    middles, radii = torn_drops(position, velocity, number, torn, SPACING)
    assert len(middles) > 1000 and np.abs(middles).max() < 9.0 * SPACING  # none around the second
    spread = middles.std(axis=0)
    assert spread[0] > 1.8 * spread[1] and spread[1] == pytest.approx(spread[2], rel=0.1)
    assert 0.0 < radii.min() and radii.max() <= 0.2 * SPACING
    later, _ = torn_drops(position[::-1] + 1.0, velocity, number[::-1], torn[::-1], SPACING)
    np.testing.assert_allclose(np.sort(later[:, 1] - 1.0), np.sort(middles[:, 1]), atol=1e-12)


def test_balls_are_closed_and_as_large_as_they_are_told():
    from ocean_sim.surface import Mesh

    corners = np.concatenate([np.eye(3), -np.eye(3)])
    faces = np.array([[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]])
    mesh = sphere_mesh(
        np.array([[1.0, 2.0, 3.0], [9.0, 0.0, 0.0]]), np.array([0.5, 2.0]), Mesh(corners, faces, corners)
    )
    assert mesh.volume() == pytest.approx(4.0 / 3.0 * (0.5**3 + 2.0**3))


def test_a_vertex_has_the_mean_of_what_particles_around_it_have():
    block = column(6, 6)
    middle = np.full((1, 3), 3 * SPACING)
    found = values_at_vertices(middle, block, np.column_stack([block, np.ones(len(block))]), SPACING)
    np.testing.assert_allclose(found, [[*middle[0], 1.0]], atol=1e-9)


def test_bed_and_walls_of_a_tank_look_inwards_and_are_darker_where_they_meet():
    low, up = np.array([-1.0, -1.0, -0.5]), np.array([2.0, 0.2, 0.5])
    whole = tank_walls.tank_panels(low, up)
    assert len(whole) == 5 and not any(panel.axis == 1 and panel.inwards < 0.0 for panel in whole)  # it is open above
    for panel in whole:
        first, second = ((panel.axis + n) % 3 for n in (1, 2))
        u, v = (np.linspace(low[k], up[k], 5) for k in (first, second))
        points, faces = tank_walls.panel_sheet(panel, u, v, 0.01)
        corners = points[faces]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert (panel.inwards * normal[:, panel.axis] > 0.0).all()
        np.testing.assert_allclose(panel.inwards * (panel.at - points[:, panel.axis]), 0.01)
        bright = tank_walls.panel_light(points, panel, whole, 1.2).reshape(5, 5)
        assert bright[0, 0] < bright[0, 2] < bright[2, 2] <= 1.2
