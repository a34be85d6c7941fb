"""Hulls from mesh files: the inside by winding numbers, axes, and sentences about what may not be meant."""

import json
import warnings

import numpy as np
import pytest
import trimesh

from ocean_sim.__main__ import run_command_line
from ocean_sim.basin.solids.mesh import BadMesh
from ocean_sim.ship.hull.hull import hull_of
from ocean_sim.ship.hull.shapes import MeshFile


@pytest.fixture(autouse=True, scope="module")
def cache(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        yield


def box(lower, upper):
    """A box between two corners, with x ahead and z up."""
    lower, upper = np.array(lower, dtype=float), np.array(upper, dtype=float)
    return trimesh.creation.box(upper - lower, trimesh.transformations.translation_matrix(0.5 * (lower + upper)))


HULL = ((-6, -2, 0), (6, 2, 2))


def inverted(mesh):
    return trimesh.Trimesh(mesh.vertices, mesh.faces[:, ::-1], process=False)


@pytest.fixture
def file(tmp_path):
    """A function that writes bodies into one file and returns its name."""

    def written(*bodies, name: str = "hull.stl") -> str:
        whole = bodies[0] if len(bodies) == 1 else trimesh.util.concatenate(bodies)
        whole.export(tmp_path / name)
        return str(tmp_path / name)

    return written


@pytest.fixture
def told(capsys):
    """A function that returns the answer of `hull` on a file."""

    def run(*words) -> dict:
        assert run_command_line(["hull", *map(str, words), "--json"]) == 0
        return json.loads(capsys.readouterr().out)

    return run


def test_a_keel_sunk_into_a_hull_counts_once(file, told):
    """V = 96 + 6; T = (54 - 6) / 48 + 1; KB = (6 x 0.5 + 48 x 1.5) / 54; BM = 64 / 54."""
    name = file(box(*HULL), box((-3, -0.5, -1), (3, 0.5, 1)))
    answer = told(name, "--mass", 54000, "--kg", 1.0, "--cells", 8)
    wanted = {"volume_m3": 102.0, "draught_m": 2.0, "kb_m": 1.38889, "bm_m": 1.18519, "gm_m": 1.57407}
    assert {key: answer[key] for key in wanted} == pytest.approx(wanted, rel=5e-3)
    assert answer["gm_of_faces_m"] == pytest.approx(1.574074, rel=1e-5) and answer["problems"] == []
    assert any("2 closed skins" in note for note in answer["notes"])


@pytest.mark.parametrize("house", [((-2, -1, 1), (2, 1, 3)), ((-2, -1, 2), (2, 1, 3)), ((-6, -2, 0), (6, 2, 2))])
def test_bodies_that_overlap_touch_or_repeat_are_one(file, house):
    other = box(*house)
    mesh = hull_of(file(box(*HULL), other)).shape.closed_mesh()
    assert mesh.volume == pytest.approx(96.0 + 8.0 * max(0, house[1][2] - 2), rel=1e-6)


def test_solids_of_an_ascii_file_are_bodies_of_one_hull(tmp_path):
    bodies = (box(*HULL), box((-3, -0.5, -1), (3, 0.5, 1)))
    (tmp_path / "solids.stl").write_text("\n".join(trimesh.exchange.stl.export_stl_ascii(body) for body in bodies))
    assert hull_of(str(tmp_path / "solids.stl")).shape.closed_mesh().volume == pytest.approx(102.0)


def test_a_void_inside_stays_dry_and_is_told(file):
    """It displaces as the hull does: no water comes into it."""
    void = inverted(box((-5, -1.5, 0.5), (5, 1.5, 1.5)))
    for bodies in ((box(*HULL), void), (inverted(box(*HULL)), inverted(void))):
        mesh = hull_of(file(*bodies)).shape.closed_mesh()
        assert mesh.volume == pytest.approx(96.0) and "void" in " ".join(mesh.remarks)


def test_a_skin_inside_out_is_turned_and_told(file):
    """A whole hull as before, without a word; beside another one, with one."""
    assert hull_of(file(inverted(box(*HULL)))).shape.closed_mesh().remarks == []
    starboard = inverted(box((-6, -5, 0), (6, -3, 2)))
    mesh = hull_of(file(box(*HULL), starboard)).shape.closed_mesh()
    assert mesh.volume == pytest.approx(144.0) and "faces inwards beside others" in " ".join(mesh.remarks)


def test_an_open_shell_is_told_and_floats_alike_for_motions_and_stability(file):
    """Planks of 5 cm: a bottom of 2.4 m3, and four sides of 1.57 m2 of waterplane."""
    outer, planks = box(*HULL), trimesh.Trimesh()
    sides = [((-6, -2, 0), (6, 2, 0.05)), ((-6, -2, 0), (-5.95, 2, 2)), ((5.95, -2, 0), (6, 2, 2))]
    sides += [((-6, -2, 0), (6, -1.95, 2)), ((-6, 1.95, 0), (6, 2, 2))]
    planks = [box(*side) for side in sides]
    hull = hull_of(file(*planks)).model_copy(update={"mass": 4000.0, "centre_of_mass": (0.0, 1.0, 0.0)})
    assert "open shell" in " ".join(hull.shape.closed_mesh().remarks)
    draughts = [hull.in_still_water(cells, 1000.0, 9.81).draught for cells in (8, 16)]
    assert draughts[0] == pytest.approx(draughts[1], rel=1e-9)
    assert draughts[0] == pytest.approx(0.05 + 1.6 / 1.59, rel=0.03)
    assert hull_of(file(outer)).shape.closed_mesh().remarks == []


def test_facets_of_no_area_bound_nothing(file):
    body = box(*HULL)
    body.faces = np.concatenate([body.faces, [[0, 0, 1]]])
    with open(file(body, name="needle.obj"), encoding="utf-8") as text:
        assert len(text.read().split("\nf ")) == 14
    assert hull_of(file(body, name="needle.obj")).shape.closed_mesh().volume == pytest.approx(96.0)


def wedge():
    """A hull of 12 m that is 2 m broad at the keel and 4 m at the deck."""
    body = box(*HULL)
    vertices = body.vertices.copy()
    vertices[vertices[:, 2] < 1.0, 1] *= 0.5
    return trimesh.Trimesh(vertices, body.faces, process=False)


def test_axes_have_signs_and_a_hull_on_its_head_is_told(file, told):
    """A trapezium of 6 m2 by 12 m that carries half of its 72 m3: 2 T + T^2 / 2 = 3."""
    down = wedge()
    down.vertices[:, 2] *= -1.0
    name = file(inverted(down))
    head, right = (told(name, "--kg", 1, "--cells", 6, *axes) for axes in ((), ("--up", "-z", "--bow", "-x")))
    assert right["draught_m"] == pytest.approx(np.sqrt(10.0) - 2.0, rel=2e-3)
    assert head["draught_m"] == pytest.approx(2.0 - (np.sqrt(10.0) - 2.0), rel=2e-3)
    assert any("--up -z" in note for note in head["notes"]) and not any("unlike" in note for note in right["notes"])
    assert right["notes"][0].startswith("12 m long, 4 m broad and 2 m high")
    small = told(name, "--up", "-z", "--scale", 0.001, "--cells", 6)
    assert small["volume_m3"] == pytest.approx(72e-9, rel=1e-2)
    assert run_command_line(["hull", "yacht", "--up", "z"]) == 2
    assert run_command_line(["hull", name, "--up", "z", "--bow", "-z"]) == 2
    with pytest.raises(BadMesh, match="same axis"):
        MeshFile(kind="mesh", file=name, up="-x", bow="x").bounds()


def test_a_spar_has_cubes_that_are_narrower_than_it_is(file):
    """KB + BM - KG of a square spar of 0.5 m at a draught of 16 m."""
    spar = box((-0.25, -0.25, 0.0), (0.25, 0.25, 20.0))
    hull = hull_of(file(spar), up="z").model_copy(update={"mass": 4000.0, "centre_of_mass": (0.0, 6.0, 0.0)})
    still = hull.in_still_water(8, 1000.0, 9.81)
    assert (0.5 / still.voxels.size[[0, 2]] >= 7.9).all()
    assert still.metacentric_height() == pytest.approx(8.0 + 0.5**2 / 12.0 / 16.0 - 6.0, rel=2e-3)


@pytest.mark.parametrize("far", [1e308, 1e150])
def test_a_mesh_beyond_numbers_is_refused_without_warnings(tmp_path, far):
    rows = [
        f"v {far:g} 0 0",
        f"v 0 {far:g} 0",
        f"v 0 0 {-far:g}",
        "v 0 0 0",
        "f 1 2 3",
        "f 1 4 2",
        "f 2 4 3",
        "f 3 4 1",
    ]
    (tmp_path / "far.obj").write_text("\n".join(rows) + "\n")
    with warnings.catch_warnings(action="error"), pytest.raises(BadMesh, match="far"):
        hull_of(str(tmp_path / "far.obj")).shape.closed_mesh()


def random_bodies(seed: int):
    """Two to five boxes, balls and cylinders anywhere, some in one another, some mirrored; a scale."""
    dice = np.random.default_rng(seed)
    kinds = [lambda: trimesh.creation.box((1, 1, 1)), lambda: trimesh.creation.icosphere(2, 0.6)]
    kinds.append(lambda: trimesh.creation.cylinder(0.4, 1.2, sections=24))
    bodies = []
    for _ in range(dice.integers(2, 6)):
        body = kinds[dice.integers(3)]()
        turn = np.linalg.qr(dice.normal(size=(3, 3)))[0]
        vertices = body.vertices * dice.uniform(0.3, 1.5, 3) @ turn.T + dice.uniform(-0.8, 0.8, 3)
        faces = body.faces if np.linalg.det(turn) > 0.0 else body.faces[:, ::-1]
        bodies.append(trimesh.Trimesh(vertices, faces, process=False))
    return bodies, 10.0 ** dice.uniform(-3.0, 3.0), bool(dice.integers(2)), dice


def volume_by_throws(bodies, dice, n: int) -> float:
    """Volume of the union of convex bodies, by points thrown into the box around them."""
    whole = trimesh.util.concatenate(bodies)
    points = dice.uniform(*whole.bounds, (n, 3))
    within = np.zeros(n, dtype=bool)
    for body in bodies:
        within |= (points @ body.face_normals.T <= (body.face_normals * body.triangles[:, 0]).sum(axis=1)).all(axis=1)
    return float(within.mean() * np.prod(whole.extents))


@pytest.mark.parametrize("seeds", [range(3), pytest.param(range(100, 220), marks=pytest.mark.slow)])
def test_random_bodies_have_the_volume_of_their_union(file, seeds):
    """Within 1 % and three deviations of the throws."""
    n = 200_000 if len(seeds) < 10 else 1_000_000
    for seed in seeds:
        bodies, scale, mirror, dice = random_bodies(seed)
        wanted = volume_by_throws(bodies, dice, n)
        scaled = [trimesh.Trimesh(scale * b.vertices, b.faces, process=False) for b in bodies]
        if mirror:
            scaled = [trimesh.Trimesh(b.vertices * [-1.0, 1.0, 1.0], b.faces, process=False) for b in scaled]
        shape = MeshFile(kind="mesh", file=file(*scaled), scale=1.0 / scale)
        noise = 3.0 * np.sqrt((float(np.prod(trimesh.util.concatenate(bodies).extents)) / wanted - 1.0) / n)
        assert shape.closed_mesh().volume == pytest.approx(wanted, rel=0.01 + noise), seed
