"""Pictures of water that folds: its surface without the lattice of particles, and air where it is stirred."""

from types import SimpleNamespace

import numpy as np
import pytest
import trimesh

from ocean_sim.pictures.stage import opengl
from ocean_sim.pictures.stage.camera import camera_looking
from ocean_sim.pictures.stage.plotter import Stage
from ocean_sim.pictures.water import tank_walls
from ocean_sim.pictures.water.spray import floor_heights, flying_share
from ocean_sim.pictures.water.tank import Shell, low_pass_weights, smooth_mesh
from ocean_sim.surface import Mesh, cell_triangles

SPACING = 0.04  # [m] of particles; edges of a mesh are half as long
BOX = (-1.0, -1.0, -1.0), (1.0, 1.0, 1.0)
MOST = 0.4 * SPACING

with_opengl = pytest.mark.skipif(opengl.probe() is not None, reason="no OpenGL on this machine")


def sheet(height) -> Mesh:
    """A surface over x and z that ends within the box."""
    x, z = np.meshgrid(np.linspace(-0.9, 0.9, 91), np.linspace(-0.5, 0.5, 51), indexing="ij")
    vertices = np.stack([x, height(x), z], axis=-1).reshape(-1, 3)
    return Mesh(vertices, cell_triangles(91, 51), np.zeros_like(vertices))


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


def test_a_crest_over_the_walls_of_a_box_without_a_top_is_smoothed_too():
    """A crest that reaches over the top of a box is held there, as under a lid; a box without a top holds none."""
    low, (x, _, z) = BOX
    rough = sheet(lambda x: 0.15 * SPACING * np.sin(2.0 * np.pi * x / 0.12))
    lidded, free = (smooth_mesh(rough, low, (x, top, z), MOST) for top in (0.05 * SPACING, np.inf))
    assert np.abs(over(free, np.zeros_like)).max() < 0.1 * 0.15 * SPACING < 0.05 * SPACING
    assert np.abs(lidded.vertices[:, 1]).max() > 0.1 * SPACING


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


@with_opengl
def test_bed_and_walls_of_a_tank_look_inwards_and_are_darker_where_they_meet():
    low, up = np.array([-1.0, -1.0, -0.5]), np.array([2.0, 0.2, 0.5])
    stage = Stage((300, 120), camera_looking(np.array([0.5, 0.1, 6.0]), np.array([0.5, -0.4, 0.0])), 1)
    panels = tank_walls.tank_panels(stage, low, up)
    corners = panels.points[panels.regular_faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert ((0.5 * (low + up) - corners.mean(axis=1)) * normal).sum(axis=1).min() > 0.0
    assert len(corners) == 10 and normal[:, 1].min() >= 0.0  # it is open above
    tank_walls.add_panels(stage, low, up, 1.0)
    tank_walls.add_ground(stage, low, up)
    stage.render()
    seen = stage.plotter.screenshot(None, return_img=True).astype(float).sum(axis=2)
    stage.close()
    column = seen[:, 150]
    wall = column[column > 0.5 * column.max()]
    assert len(wall) > 20 and wall.min() < 0.9 * wall.max()


@with_opengl
def test_what_stands_before_the_water_is_not_seen_in_it():
    """A ball in front of a tank changes the picture within its own outline, not where the water beyond bends rays."""
    box = trimesh.creation.box(bounds=[(-1.0, -1.0, -1.0), (1.0, 0.0, 1.0)]).subdivide().subdivide().subdivide()
    frame = SimpleNamespace(mesh=(box.vertices, box.faces, box.vertex_normals), left=None, carried=None)
    stage = Stage((240, 160), camera_looking(np.array([0.0, 1.5, 4.0]), np.array([0.0, -0.2, 0.0])), 1)
    grid = {"depth": 1.0, "lower": np.array(BOX[0]), "upper": np.array([1.0, 0.0, 1.0]), "spacing": 0.1}
    shell = Shell(stage, grid, np.array([1.0, 0.5, 1.0]), white=False)
    stage.plotter.camera.position, stage.plotter.camera.focal_point = tuple(stage.camera.eye), (0.0, -0.2, 0.0)
    stage.plotter.camera.up, stage.plotter.camera.view_angle = (0.0, 1.0, 0.0), stage.camera.angle
    stage.plotter.camera.clipping_range = 0.1, 40.0
    ball = stage.plotter.add_mesh(
        stage.pyvista.Sphere(radius=0.15, center=(0.0, 0.25, 1.4)), color="red", lighting=False
    )

    def picture(water: bool, balls: bool) -> np.ndarray:
        ball.SetVisibility(balls)
        shell.show(frame)
        shell.water.actor.SetVisibility(water)
        stage.render()
        return stage.plotter.screenshot(None, return_img=True).astype(int)

    outline = np.abs(picture(False, True) - picture(False, False)).max(axis=2) > 0
    changed = np.abs(picture(True, True) - picture(True, False)).max(axis=2) > 30  # edges are blended
    stage.close()
    assert outline.sum() > 200 and (changed & outline).sum() > 200 and not (changed & ~outline).any()
