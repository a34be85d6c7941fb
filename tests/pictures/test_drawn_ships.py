"""Drawn ships: the physical hull, painted by height over the water at rest, and what stands on it."""

import numpy as np
import pytest
import pyvista
from scipy.optimize import brentq

from ocean_sim.pictures.ships import ship as ship_module
from ocean_sim.pictures.ships import ship_parts
from ocean_sim.pictures.ships.ship_model import PAINTS, build_model
from ocean_sim.pictures.stage import sky
from ocean_sim.ship.body.floating import afloat_pose
from ocean_sim.ship.body.rigid_body import rotation_matrix
from ocean_sim.ship.hull import hull as hull_module
from ocean_sim.ship.hull.hull import hull_of
from ocean_sim.ship.hull.shapes import drawn_mesh

NOWHERE = np.full(3, np.nan)
BLACK, OXIDE, WHITE = (PAINTS[name] for name in ("black", "oxide", "white"))
HULLS = {
    "yacht": (0.0, 4.2, 0.5),
    "tug": (0.0, 8.0, 2.0),
    "barge20": None,
    "wigley": None,
    "cylinder": None,
    "sphere": None,
}


def still_water(still):
    height, turn = afloat_pose(still)
    return np.append(rotation_matrix(turn)[1], height)


def placed(name):
    """Vertices from the centre of mass, triangles, plane of the still water, helm."""
    hull = hull_of(name)
    vertices, triangles = drawn_mesh(hull.shape)
    centre = np.array(hull.centre_of_mass)
    still = hull.in_still_water(8.0, 1000.0, 9.81)
    helm = NOWHERE if HULLS[name] is None else np.array(HULLS[name]) - centre
    return vertices - centre, triangles, still_water(still), helm


@pytest.fixture(scope="module", params=HULLS)
def ship(request):
    vertices, triangles, level, helm = placed(request.param)
    made = build_model(vertices, triangles, level, request.param, helm)
    return request.param, made, ship_parts.Hull(vertices, triangles, level)


def area(corners):
    return np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2.0


def box_corners(lower, upper):
    """Triangles (12, 3, 3) of a box."""
    plan = np.array([lower * [1, 0, 1], (upper[0], 0, lower[2]), upper * [1, 0, 1], (lower[0], 0, upper[2])])
    return ship_parts.Block(plan + [0, lower[1], 0], plan + [0, upper[1], 0]).mesh(WHITE, WHITE).corners


def test_every_model_is_whole_and_small_enough_for_a_film(ship):
    _, made, _ = ship
    mesh = made.mesh
    assert all(np.isfinite(array).all() for array in (*mesh, made.helm))
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=2), 1.0, atol=1e-6)
    assert ((mesh.colour >= 0.0) & (mesh.colour <= 1.0)).all() and len(mesh.corners) < 25_000


def test_the_drawn_hull_is_the_physical_hull(ship):
    _, _, hull = ship
    painted = hull.painted(OXIDE, WHITE, BLACK, WHITE)
    physical = hull.vertices[hull.triangles]
    assert area(painted.corners) == pytest.approx(area(physical), rel=1e-9)
    assert painted.corners.min(axis=(0, 1)) == pytest.approx(hull.lower, abs=1e-9)
    assert painted.corners.max(axis=(0, 1)) == pytest.approx(hull.upper, abs=1e-9)


def test_colours_end_exactly_at_their_heights(ship):
    name, _, hull = ship
    bands = [(0.0, OXIDE), (np.inf, BLACK)]
    height = hull.over_water(hull.values[:, :, :3])
    mesh = ship_parts.paint_bands(hull.values, hull.up, hull.level, bands)
    after = hull.over_water(mesh.corners)
    below = (mesh.colour == OXIDE).all(axis=1)
    assert after[below].max() < 1e-9 and after[~below].min() > -1e-9
    assert ((height.min(axis=1) < -1e-3) & (height.max(axis=1) > 1e-3)).any(), f"{name}: nothing had to be cut"


@pytest.mark.parametrize("name, level", [("barge20", 2.0), ("sphere", 5.0), ("cylinder", 1.0)])
def test_the_waterline_is_where_archimedes_has_it(name, level):
    vertices, triangles, plane, _ = placed(name)
    hull = ship_parts.Hull(vertices, triangles, plane)
    keel = hull.over_water(np.array([0.0, vertices[:, 1].min(), 0.0]))
    assert -keel == pytest.approx(level, abs=2e-3 * np.ptp(vertices[:, 1]))
    np.testing.assert_allclose(hull.up, [0.0, 1.0, 0.0], atol=1e-9)


def test_a_box_that_is_loaded_off_its_middle_trims_as_a_wall_sided_ship():
    length, draught, high, off = 20.0, 2.0, 2.2, 0.4
    shape = {"kind": "box", "length": length, "breadth": 8.0, "height": 4.0}

    def lever(t):  # centre of buoyancy of a wall-sided hull at a trim of tangent t, along the level
        z, y = length**2 / (12.0 * draught) * t, draught / 2.0 + length**2 / (24.0 * draught) * t**2
        return (z - off) + (y - high) * t

    at = {"mass": 1000.0 * 8.0 * length * draught, "centre_of_mass": [0.0, high, off]}
    hull = hull_module.Hull.model_validate({"shape": shape} | at)
    x, y, z, _ = still_water(hull.in_still_water(32.0, 1000.0, 9.81))
    assert abs(z / y) == pytest.approx(brentq(lever, 0.0, 0.3), rel=1e-3) and x == pytest.approx(0.0, abs=1e-9)


def test_a_ship_heavier_than_its_hull_can_carry_is_awash():
    shape = {"kind": "box", "length": 2.0, "breadth": 2.0, "height": 2.0}
    hull = hull_module.Hull.model_validate({"shape": shape, "mass": 1e5, "centre_of_mass": [0.0, 1.0, 0.0]})
    still = hull.in_still_water(8.0, 1000.0, 9.81)
    *up, level = still_water(still)
    assert up == [0.0, 1.0, 0.0] and level == pytest.approx(-1.0, abs=0.5 * still.voxels.size[1] + 1e-9)


def hits(corners, eye, ray):
    """Whether a ray meets a triangle ahead (Moeller and Trumbore 1997)."""
    a, u, v = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    p = np.cross(ray, v)
    size = (u * p).sum(axis=1)
    size = np.where(np.abs(size) > 1e-12, size, np.inf)
    s = ((eye - a) * p).sum(axis=1) / size
    q = np.cross(eye - a, u)
    t, far = q @ ray / size, (v * q).sum(axis=1) / size
    return bool(((s >= 0) & (t >= 0) & (s + t <= 1) & (far > 1e-6)).any())


@pytest.mark.parametrize("name", ["yacht", "tug"])
def test_the_helmsman_sees_the_sea_ahead_and_the_bow_below(name):
    made = build_model(*placed(name)[:3], name, placed(name)[3])

    def looks(eye, down, aside):
        ray = np.array([np.sin(aside), -np.sin(down), np.cos(aside)])
        return hits(made.mesh.corners, eye, ray / np.linalg.norm(ray))

    sides = np.radians(np.linspace(-60.0, 60.0, 25) + 0.3)
    assert not any(looks(made.helm, np.radians(-2.0), aside) for aside in sides)
    assert looks(made.helm, np.radians(30.0), 0.003)
    assert looks(made.helm - [0.0, 0.0, 1.0], np.radians(-2.0), 0.003)  # from inside the house nothing is seen


def test_smooth_shading_stops_at_a_crease():
    vertices, triangles = drawn_mesh(hull_of("barge20").shape)
    normals = ship_parts.smooth_normals(vertices, triangles)
    corners = vertices[triangles]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    flat /= np.linalg.norm(flat, axis=1, keepdims=True)
    np.testing.assert_allclose(normals, np.repeat(flat[:, None], 3, axis=1), atol=1e-9)
    vertices, triangles = drawn_mesh(hull_of("sphere").shape)
    normals = ship_parts.smooth_normals(vertices, triangles).reshape(-1, 3)
    radial = (vertices - [0.0, 5.0, 0.0])[triangles].reshape(-1, 3)
    cosine = (normals * radial).sum(axis=1) / np.linalg.norm(radial, axis=1)
    assert cosine.min() > np.cos(np.radians(0.1))


@pytest.mark.parametrize("name", ["box", "cylinder"])
def test_a_body_is_drawn_plain(name):
    """A box and a cylinder of a laboratory have neither a boot top nor a mast nor cargo."""
    vertices, triangles, level, helm = placed("barge20" if name == "box" else name)
    mesh = build_model(vertices, triangles, level, f" {name}", helm).mesh
    assert len(np.unique(mesh.colour, axis=0)) == 1
    np.testing.assert_allclose(np.ptp(mesh.corners.reshape(-1, 3), axis=0), np.ptp(vertices, axis=0))


def test_a_hull_without_a_deck_to_stand_on_is_a_test_body():
    vertices, triangles, plane, _ = placed("sphere")
    round_yacht = build_model(vertices, triangles, plane, "yacht", NOWHERE)
    plain = build_model(vertices, triangles, plane, "sphere", NOWHERE)
    assert len(round_yacht.mesh.corners) == len(plain.mesh.corners)


def test_light_is_finite_and_brighter_towards_the_sun():
    normals = np.stack([sky.SUN_DIRECTION, -sky.SUN_DIRECTION])
    colours = sky.painted_light(normals, np.full((2, 3), 0.5), np.zeros((2, 1)))
    assert (colours[0] > 2.0 * colours[1]).all() and (colours > 0.0).all()


def test_points_that_cast_a_shadow_leave_no_gap_and_reach_the_edges():
    corners = np.array(
        [[[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [2.0, 1.0, 0.0]], [[0.0, 0.0, 1.0], [0.0, 0.02, 1.0], [0.0, 0.0, 3.0]]]
    )
    mesh = pyvista.PolyData.from_regular_faces(corners.reshape(-1, 3), np.arange(6).reshape(-1, 3))
    points = ship_module.spread_points(mesh, 0.1)
    for corner in corners.reshape(-1, 3):
        assert np.linalg.norm(points - corner, axis=1).min() < 1e-6
    share = np.random.default_rng(3).dirichlet(np.ones(3), 200)
    inside = np.einsum("nk,mkx->mnx", share, corners).reshape(-1, 3)
    assert np.linalg.norm(inside[:, None] - points, axis=2).min(axis=1).max() < 0.1
    assert len(points) < 500
