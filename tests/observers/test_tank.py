"""Pictures of water that folds: its surface without the lattice of particles, and air where it is stirred."""

import numpy as np
import pytest

from ocean_sim.pictures.smoothed_mesh import long, low_pass, rim, smoothed
from ocean_sim.pictures.spray import stirred
from ocean_sim.pictures.water_mesh import triangles
from ocean_sim.surface import Mesh

SPACING = 0.04  # [m] of particles; edges of a mesh are half as long
BOX = (-1.0, -1.0, -1.0), (1.0, 1.0, 1.0)
MOST = 0.4 * SPACING


def sheet(height) -> Mesh:
    """A surface over x and z that ends within the box."""
    x, z = np.meshgrid(np.linspace(-0.9, 0.9, 91), np.linspace(-0.5, 0.5, 51), indexing="ij")
    vertices = np.stack([x, height(x), z], axis=-1).reshape(-1, 3)
    return Mesh(vertices, triangles(91, 51), np.zeros_like(vertices))


def over(mesh: Mesh, height) -> np.ndarray:
    """Heights of a sheet over a law of x, away from its free edges [m]."""
    x, y, _ = np.moveaxis(mesh.vertices.reshape(91, 51, 3)[20:-20, 15:-15], -1, 0)
    return y - height(x)


def test_terraces_on_a_slope_are_smoothed_away_and_the_mean_stays():
    """Layers of particles on a slope of 1 : 3 are 0.12 m long."""
    slope, terraces = (lambda x: -x / 3.0), (lambda x: 0.15 * SPACING * np.sin(2.0 * np.pi * x / 0.12))
    left = over(smoothed(sheet(lambda x: slope(x) + terraces(x)), *BOX, MOST), slope)
    assert np.abs(left).max() < 0.1 * 0.15 * SPACING
    assert abs(left.mean()) < 0.01 * SPACING


def test_waves_of_a_dozen_spacings_and_more_are_left_alone():
    wave = lambda x: 0.05 * np.cos(2.0 * np.pi * x / (18.0 * SPACING))
    assert np.abs(over(smoothed(sheet(wave), *BOX, MOST), wave)).max() < 0.05 * 0.05


@pytest.mark.parametrize("tilt", [0.0, 0.3])
def test_the_rim_of_water_in_a_tank_is_a_line_around_its_walls(tilt):
    """As long as the sides of the surface, level or not; none along the edges of the tank."""
    from ocean_sim.surface import Mesh

    n, (low, up) = 9, ((0.0, 0.0, 0.0), (1.0, 1.0, 2.0))
    x, z = np.meshgrid(np.linspace(0.0, 1.0, n), np.linspace(0.0, 2.0, n), indexing="ij")
    top = np.stack([x, 0.4 + tilt * (x - 0.5), z], axis=-1).reshape(-1, 3)
    k = np.arange(n * n).reshape(n, n)
    a, b, c, d = (part.ravel() for part in (k[:-1, :-1], k[1:, :-1], k[1:, 1:], k[:-1, 1:]))
    surface = np.concatenate([np.stack([a, d, b], 1), np.stack([b, d, c], 1)])
    walls = []
    for edge in (k[0], k[-1], k[:, 0], k[:, -1]):
        here, there = edge[:-1], edge[1:]
        walls += [np.stack([here, there, here + n * n], 1), np.stack([there, there + n * n, here + n * n], 1)]
    vertices = np.concatenate([top, top * [1.0, 0.0, 1.0]])
    faces = np.concatenate([surface, *walls, surface[:, ::-1] + n * n])
    ends = vertices[rim(Mesh(vertices, faces, np.zeros(vertices.shape)), low, up)]
    assert np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum() == pytest.approx(4.0 + 2.0 * np.hypot(1.0, tilt))
    np.testing.assert_allclose(ends[..., 1], 0.4 + tilt * (ends[..., 0] - 0.5), atol=1e-12)


def test_lines_around_small_holes_in_a_film_are_left_out():
    turn = np.linspace(0.0, 2.0 * np.pi, 6, endpoint=False)
    hole = np.stack([np.cos(turn), np.sin(turn), 0.0 * turn], axis=1)  # a hexagon of edges of 1 m
    vertices = np.concatenate([hole, [[9.0, 0.0, 0.0], [16.0, 0.0, 0.0], [23.0, 0.0, 0.0]]])
    edges = np.array([*((k, (k + 1) % 6) for k in range(6)), (6, 7), (7, 8)])
    np.testing.assert_array_equal(long(edges, vertices, 5.9), edges)
    np.testing.assert_array_equal(long(edges, vertices, 6.1), edges[6:])


def test_no_vertex_goes_farther_than_it_may():
    rough = sheet(lambda x: np.random.default_rng(1).normal(0.0, SPACING, x.shape))
    way = np.linalg.norm(smoothed(rough, *BOX, MOST).vertices - rough.vertices, axis=1)
    assert 0.9 * MOST < way.max() <= 1.02 * MOST  # the layer that keeps the volume is thin


@pytest.mark.parametrize("edge, degree", [(0.3, 32), (0.8, 12)])
def test_the_filter_passes_long_waves_halves_at_its_edge_and_stops_short_ones(edge, degree):
    weights, n = low_pass(edge, degree), np.arange(degree + 1)
    passed = [float(weights @ np.cos(n * angle)) for angle in (0.0, edge, edge + 2.5 * np.pi / degree, np.pi)]
    assert passed == pytest.approx([1.0, 0.5, 0.0, 0.0], abs=0.06)


def test_water_that_goes_as_one_holds_no_air_and_jets_that_meet_do():
    block = np.stack(np.meshgrid(*[np.arange(8) * SPACING] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    fast = np.tile([3.0, 0.0, 0.0], (len(block), 1))
    meeting = fast * np.where(block[:, :1] < 4 * SPACING, 1.0, -1.0)
    assert stirred(block, 0.0 * fast, 1.0).max() == 0.0
    assert stirred(block, fast, 1.0).max() == 0.0
    air = stirred(block, meeting, 1.0)
    front = np.abs(block[:, 0] - 3.5 * SPACING) < SPACING
    assert air[front].min() > 0.9 and air[block[:, 0] < 1.5 * SPACING].max() < 0.1
