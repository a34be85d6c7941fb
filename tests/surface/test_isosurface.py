"""Marching cubes on fields whose surface is known, and on random ones: closed, in the right place, normals outwards."""

import numpy as np
import pytest

from ocean_sim.surface import Mesh
from ocean_sim.surface.shared.isosurface import Isosurface, Nodes

TORUS, TUBE = 0.9, 0.35  # [m] radii


def cut(nodes: Nodes, field: np.ndarray, isosurface: Isosurface | None = None) -> Mesh:
    isosurface = isosurface or Isosurface(nodes)
    isosurface.value.from_numpy(np.append(field.ravel(), np.full(nodes.shape[0], -1.0)))  # and the dry row
    return isosurface.mesh(isosurface.count_surface())


def topology(mesh: Mesh) -> tuple[bool, int]:
    """Whether each edge has two triangles, which run along it in opposite directions; and V - E + F."""
    corners = mesh.triangles
    directed = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]).astype(np.int64)
    low, high, n = directed.min(axis=1), directed.max(axis=1), max(len(mesh.vertices), 1)
    edges, uses = np.unique(low * n + high, return_counts=True)
    closed = bool((uses == 2).all()) and len(np.unique(directed @ [n, 1])) == len(directed)
    return closed, len(mesh.vertices) - len(edges) + len(corners)


def cube(n: int, half: float) -> Nodes:
    return Nodes((-half,) * 3, (half,) * 3, 2.0 * half / n)


def node_positions(nodes: Nodes) -> np.ndarray:
    """Positions (nz, ny, nx, 3) of all nodes [m], in the order in which the field is stored: x runs fastest."""
    along = [low + (np.arange(n) - 0.5) * width for low, n, width in zip(nodes.lower, nodes.shape, nodes.width)]
    z, y, x = np.meshgrid(*along[::-1], indexing="ij")
    return np.stack([x, y, z], axis=-1)


def ball(x: np.ndarray, centre: tuple[float, ...] = (0.0, 0.0, 0.0), radius: float = 1.0) -> np.ndarray:
    return radius - np.linalg.norm(x - np.array(centre), axis=-1)


def torus(x: np.ndarray) -> np.ndarray:
    return TUBE - np.hypot(np.hypot(x[..., 0], x[..., 2]) - TORUS, x[..., 1])


@pytest.fixture(scope="module")
def spheres(taichi_cpu) -> dict[int, Mesh]:
    return {n: cut(cube(n, 1.25), ball(node_positions(cube(n, 1.25)))) for n in (8, 16, 32, 64)}


def test_area_and_volume_of_a_sphere_are_second_order(spheres):
    area = [1.0 - mesh.area / (4.0 * np.pi) for mesh in spheres.values()]
    volume = [1.0 - mesh.volume() / (4.0 / 3.0 * np.pi) for mesh in spheres.values()]
    for errors in (area, volume):
        assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx([2.0] * 3, abs=0.1)
    # scikit-image on the same field and cells: 3.1e-2 and 5.76e-2 at 8 cells, 4.8e-4 and 9.1e-4 at 64
    assert area[0] < 3.2e-2 and volume[0] < 5.9e-2
    assert area[3] < 4.9e-4 and volume[3] < 9.3e-4


def test_normals_of_a_sphere_are_within_two_degrees(spheres):
    for mesh in spheres.values():
        outward = mesh.vertices / np.linalg.norm(mesh.vertices, axis=1, keepdims=True)
        assert np.degrees(np.arccos(np.clip((outward * mesh.normals).sum(axis=1), -1.0, 1.0))).max() < 2.0


def test_spheres_and_tori_have_their_euler_characteristic(spheres):
    assert topology(spheres[32]) == (True, 2)
    nodes = cube(40, 1.4)
    ring = cut(nodes, torus(node_positions(nodes)))
    assert topology(ring) == (True, 0)
    assert ring.area == pytest.approx(12.43570, rel=5e-3) and ring.volume() == pytest.approx(2.17625, rel=1e-2)
    x = node_positions(nodes)
    two = cut(nodes, np.maximum(ball(x, (-0.7, 0.0, 0.0), 0.5), ball(x, (0.6, 0.2, 0.1), 0.6)))
    assert topology(two) == (True, 4)


def test_two_hundred_random_fields_that_are_dry_all_round_give_closed_surfaces(taichi_cpu):
    nodes = Nodes((0.0,) * 3, (12.0,) * 3, 1.0)
    isosurface, rng, characteristics = Isosurface(nodes), np.random.default_rng(5), set()
    for _ in range(200):
        field = -np.ones((14, 14, 14))
        field[1:-1, 1:-1, 1:-1] = rng.uniform(-1.0, 1.0, (12, 12, 12))
        mesh = cut(nodes, field, isosurface)
        closed, characteristic = topology(mesh)
        assert closed and 0.0 < mesh.volume() < 12.0**3
        characteristics.add(characteristic)
    assert len(characteristics) > 20  # handles and bubbles galore
    assert 0.2 < isosurface.count_surface().ambiguous_share < 0.5


def test_the_check_of_closedness_sees_a_missing_triangle_and_one_turned_round(spheres):
    mesh = spheres[16]
    turned = mesh.triangles.copy()
    turned[7] = turned[7, ::-1]
    assert not topology(Mesh(mesh.vertices, mesh.triangles[1:], mesh.normals))[0]
    assert not topology(Mesh(mesh.vertices, turned, mesh.normals))[0]


def test_nodes_that_lie_on_the_surface_do_no_harm(taichi_cpu):
    nodes = cube(8, 2.0)
    field = -np.ones(nodes.shape[::-1])
    field[3:6, 3:6, 3:6] = 0.0
    field[4, 4, 4] = 1.0
    mesh = cut(nodes, field)
    assert topology(mesh) == (True, 2)
    assert np.isfinite(mesh.vertices).all() and np.isfinite(mesh.normals).all()


def test_flying_edges_of_vtk_has_the_same_vertices_area_and_volume(taichi_cpu):
    import pyvista

    nodes = cube(40, 1.4)
    x = node_positions(nodes)
    for field in (ball(x), torus(x), ball(x) + 0.1 * np.sin(7.0 * x[..., 0]) * np.cos(5.0 * x[..., 1])):
        mesh = cut(nodes, field)
        image = pyvista.ImageData(dimensions=nodes.shape, spacing=nodes.width, origin=tuple(x[0, 0, 0]))
        other = image.contour([0.0], field.ravel(), method="flying_edges")
        assert (other.n_points, other.n_cells) == (len(mesh.vertices), len(mesh.triangles))
        assert mesh.area == pytest.approx(other.area, rel=1e-3)
        assert mesh.volume() == pytest.approx(other.volume, rel=1e-3)
        theirs = other.points[np.lexsort(np.round(other.points, 3).T)]
        np.testing.assert_allclose(theirs, mesh.vertices[np.lexsort(np.round(mesh.vertices, 3).T)], atol=2e-3)


def test_a_field_without_water_has_no_surface(taichi_cpu):
    nodes = cube(4, 1.0)
    mesh = cut(nodes, -np.ones(nodes.shape[::-1]))
    assert len(mesh.triangles) == len(mesh.vertices) == 0 and mesh.area == mesh.volume() == 0.0
