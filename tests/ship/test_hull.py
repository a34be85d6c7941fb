"""Hulls as cubes: volume, inertia, draught, stability; shapes, outlines and mesh files; what is refused."""

import json

import numpy as np
import pytest
import trimesh

from ocean_sim.__main__ import run_command_line
from ocean_sim.basin.solids.mesh import BadMesh
from ocean_sim.basin.solids.packing import Lattice
from ocean_sim.basin.solids.voxels import voxels
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.fluid.sph.smoothing import WENDLAND
from ocean_sim.parts import ALONE, named
from ocean_sim.reading.scene import load
from ocean_sim.ship.body.rigid_body import RigidBody, axis_rotation
from ocean_sim.ship.forces.added_mass import by_rule, pabst_factor
from ocean_sim.ship.hull.hull import Hull, hull_of
from ocean_sim.ship.naval.hydrostatics import Hydrostatics, Matter

WATER = (1000.0, 9.81)


@pytest.fixture(autouse=True, scope="module")
def cache(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        yield


def hull(shape: dict, **keys) -> Hull:
    return Hull.model_validate({"shape": shape, **keys})


BOX = {"kind": "box", "length": 20.0, "breadth": 8.0, "height": 4.0}
VOLUMES = {
    "box": (BOX, 640.0),
    "cylinder": ({"kind": "cylinder", "length": 6.0, "radius": 1.0}, 6.0 * np.pi),
    "sphere": ({"kind": "sphere", "radius": 5.0}, 4.0 / 3.0 * np.pi * 125.0),
    "wigley": ({"kind": "wigley", "length": 3.0, "breadth": 0.3, "draught": 0.1875, "height": 0.1875}, 0.075),
}


@pytest.mark.parametrize("name", VOLUMES)
def test_cubes_hold_the_volume_of_their_shape_and_are_closed(name):
    shape, volume = VOLUMES[name]
    solid = hull(shape).shape
    height = solid.bounds()[1][1]
    cubes = voxels(solid, height / 16.0)
    assert cubes.volume == pytest.approx(volume, rel=0.01)
    np.testing.assert_allclose(cubes.area.sum(axis=0), np.zeros(3), atol=1e-9 * volume)


def test_cubes_are_the_same_from_the_cache_and_other_shapes_are_others():
    solid = hull(BOX).shape
    first, again = voxels(solid, 0.5), voxels(solid, 0.5)
    for a, b in ((first.centre, again.centre), (first.share, again.share), (first.area, again.area)):
        np.testing.assert_array_equal(a, b)
    assert len(voxels(hull({**BOX, "height": 5.0}).shape, 0.5).share) > len(first.share)


def bisected(still: Hydrostatics, up: np.ndarray) -> float:
    """The level at which a hull's cubes displace its mass, by all of them every time."""
    height, spread = still.voxels.centre_heights(up), still.voxels.height_spread(up)
    low, high = float(height.min()) - spread, float(height.max()) + spread
    for _ in range(40):
        middle = 0.5 * (low + high)
        volume = float((still.cube_volumes * np.clip((middle - height) / spread + 0.5, 0.0, 1.0)).sum())
        low, high = (middle, high) if volume < still.needed_volume else (low, middle)
    return 0.5 * (low + high)


@pytest.mark.parametrize("name", VOLUMES)
@pytest.mark.parametrize("share", [1e-6, 0.25, 0.5, 0.97])
def test_the_water_stands_where_all_cubes_together_have_it_to_the_last_bit(name, share):
    """Most cubes are left out while it is sought; of a box at a quarter or half of its height, rows of cubes begin
    to be wet right there."""
    solid = hull(VOLUMES[name][0]).shape
    cubes = voxels(solid, solid.bounds()[1][1] / 16.0)
    still = Hydrostatics(cubes, Matter(share * 1000.0 * cubes.volume, np.zeros(3), np.eye(3)), *WATER)
    for axis, degrees in ((0, 0.0), (2, 0.5), (2, -20.0), (0, 3.0), (2, 45.0), (0, 77.0), (2, 90.0)):
        up = axis_rotation(axis, np.radians(degrees))[1]
        assert still.water_level(up) == bisected(still, up)


def test_inertia_of_cubes_is_that_of_a_box():
    cubes = voxels(hull(BOX).shape, 0.5)
    found = np.diag(cubes.inertia(12.0, np.array([0.0, 2.0, 0.0])))
    np.testing.assert_allclose(found, [20.0**2 + 4.0**2, 20.0**2 + 8.0**2, 8.0**2 + 4.0**2], rtol=1e-9)
    lower = np.diag(cubes.inertia(12.0, np.zeros(3)))
    np.testing.assert_allclose(lower - found, [12.0 * 4.0, 0.0, 12.0 * 4.0], atol=1e-6)


def test_a_barge_floats_and_stands_by_the_book():
    """KB T/2, BM B^2 / 12 T, BM_L L^2 / 12 T; dry periods 2 pi sqrt(m / k)."""
    barge = hull_of("barge20").in_still_water(8, *WATER)
    assert barge.draught == pytest.approx(2.0, rel=1e-6) and barge.kb == pytest.approx(1.0, rel=1e-6)
    assert barge.metacentric_height() == pytest.approx(1.166667, rel=2e-3)
    assert barge.metacentric_height(0) == pytest.approx(15.16667, rel=2e-3)
    dry = barge.periods(np.zeros(6))
    np.testing.assert_allclose([dry["heave"], dry["roll"], dry["pitch"]], [2.837, 5.200, 2.576], rtol=2e-3)


def test_wigleys_hull_floats_and_stands_by_the_book():
    """KB 5/8 T, BM 3/35 B^2 / T, waterplane 2/3 L B; with its centre of mass at 0.17 m it is unstable."""
    wigley = hull_of("wigley").in_still_water(16, *WATER)
    assert wigley.draught == pytest.approx(0.1875, rel=2e-3) and wigley.kb == pytest.approx(0.1171875, rel=2e-3)
    assert wigley.metacentric_height() == pytest.approx(0.0383304, rel=0.02)
    assert wigley.waterplane == pytest.approx(0.6, rel=5e-3)
    top_heavy = hull_of("wigley").model_copy(update={"centre_of_mass": (0.0, 0.17, 0.0)})
    assert top_heavy.in_still_water(16, *WATER).metacentric_height() < 0.0


def test_a_waterline_ends_within_the_slices_at_the_ends():
    """Of a box, of a wedge at each end, and of the yacht: straight lines between the points of her outline, from
    -6.876 to 6.530 m at 1.052 m, which six cubes over the draught take for whole slices, 14.175 m."""
    assert hull_of("barge20").in_still_water(6, *WATER).length == pytest.approx(20.0)
    assert hull_of("wigley").in_still_water(6, *WATER).length == pytest.approx(3.0, rel=5e-3)
    stern, bow = hull_of("yacht").in_still_water(6, *WATER).waterline_ends
    assert stern == pytest.approx(-6.876, abs=0.15) and bow == pytest.approx(6.530, abs=0.15)


def test_stations_lie_in_the_middle_of_slices_and_reach_the_keel():
    """Wigley's hull is the same at bow and stern, and her keel is sharp."""
    wigley = hull_of("wigley").in_still_water(8, *WATER)
    z, breadth, draught = wigley.stations
    np.testing.assert_allclose(z, -z[::-1], atol=1e-12)
    np.testing.assert_allclose(breadth, breadth[::-1], atol=1e-9)
    assert draught.max() == wigley.draught


def test_what_is_too_heavy_sinks():
    assert hull(BOX, mass=641e3).in_still_water(8, *WATER).draught == np.inf
    assert hull(BOX, mass=639e3).in_still_water(8, *WATER).draught < 4.0


def test_added_mass_by_rule_is_near_that_of_a_panel_method():
    """The barge at its natural frequencies: 431.7 t, 11261 and 1167.8 t m2, within 15 %."""
    added = by_rule(hull_of("barge20").in_still_water(8, *WATER))
    np.testing.assert_allclose(added[[1, 3, 5]], [431.7e3, 11261e3, 1167.8e3], rtol=0.15)
    assert pabst_factor(1e6) == pytest.approx(1.0) and pabst_factor(0.4) == pabst_factor(2.5)


@pytest.mark.parametrize("name", named("hull"))
def test_every_ready_made_hull_floats_upright(name):
    afloat = hull_of(name).in_still_water(4, *WATER)
    assert 0.0 < afloat.draught < np.inf and afloat.metacentric_height() > 0.0


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A barge in millimetres with z up and x ahead; the same with a face missing; a ball in metres."""
    import trimesh

    folder = tmp_path_factory.mktemp("meshes")
    box = trimesh.creation.box((20000.0, 8000.0, 4000.0))
    box.export(folder / "barge_mm.stl")
    box.export(folder / "barge_mm.obj")
    box.update_faces(np.arange(len(box.faces)) > 1)
    box.export(folder / "hole.stl")
    trimesh.creation.icosphere(4, 5.0).export(folder / "ball.ply")
    (folder / "empty.stl").write_text("no mesh\n")
    return folder


@pytest.mark.parametrize("kind", ["stl", "obj"])
def test_a_mesh_is_turned_scaled_and_filled(files, kind):
    barge = hull_of(str(files / f"barge_mm.{kind}")).model_copy(update={"mass": 320e3, "centre_of_mass": (0, 2.5, 0)})
    afloat = barge.in_still_water(8, *WATER)
    assert afloat.voxels.volume == pytest.approx(640.0, rel=1e-3)
    assert afloat.draught == pytest.approx(2.0, rel=1e-3)
    assert afloat.metacentric_height() == pytest.approx(1.166667, rel=5e-3)


def test_a_ball_from_a_mesh_is_the_ball_of_the_formula(files):
    cubes = voxels(hull_of(str(files / "ball.ply")).shape, 0.4)
    assert cubes.volume == pytest.approx(4.0 / 3.0 * np.pi * 125.0, rel=0.005)


def test_a_bad_mesh_is_refused_with_what_is_wrong_and_where(files, capsys):
    with pytest.raises(BadMesh, match=r"hole.stl: not watertight: 4 edges bound a hole, around \(-5000, "):
        hull_of(str(files / "hole.stl")).shape.bounds()
    assert run_command_line(["hull", str(files / "hole.stl")]) == 2
    assert "not watertight" in capsys.readouterr().err

    assert run_command_line(["hull", str(files / "hole.stl"), "--json"]) == 2
    answer = json.loads(capsys.readouterr().out)
    assert answer["volume_m3"] is None and "not watertight" in answer["problems"][0]
    assert run_command_line(["hull", str(files / "empty.stl")]) == 2
    assert run_command_line(["hull", "barg20"]) == 2


@pytest.mark.parametrize(
    ("name", "kept", "words"),
    [
        ("ball.stl", slice(0, 300), "ends after 300 bytes"),
        ("hull.stl", slice(0, 16), "ends after 16 bytes"),
        ("face.obj", slice(None), "a corner that is not there"),
    ],
)
def test_a_mesh_file_that_is_cut_or_names_no_corner_is_told_so(tmp_path, name, kept, words):
    ball = trimesh.creation.icosphere().export(file_type="stl")
    (tmp_path / name).write_bytes((ball if name.endswith("stl") else b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")[kept])
    with pytest.raises(BadMesh, match=words):
        hull_of(str(tmp_path / name)).shape.bounds()


def test_a_hull_denser_than_metal_is_refused():
    with pytest.raises(SceneError, match=r"ship\.mass: .* denser than any metal"):
        load(
            {
                "basin": {"depth": 20.0, "length": 80.0, "width": 80.0},
                "fluid": "linear_waves",
                "ship": {"kind": "yacht", "mass": 8e9},
            }
        )


def test_the_command_answers_with_the_agreed_keys_and_a_picture(capsys, tmp_path):
    words = ["hull", "barge20", "--cells", "8", "--json", "--out", str(tmp_path / "barge.png")]
    assert run_command_line(words) == 0
    answer = json.loads(capsys.readouterr().out)
    keys = "volume_m3 displacement_kg draught_m kb_m bm_m gm_m gz periods_s problems".split()
    assert set(keys) <= set(answer) and answer["problems"] == []
    assert answer["draught_m"] == pytest.approx(2.0) and answer["bm_m"] == pytest.approx(2.6667, rel=2e-3)
    assert {row["heel_deg"]: row["gz_m"] for row in answer["gz"]}[30.0] == pytest.approx(0.76036, rel=0.01)
    assert answer["periods_s"]["heave"] == pytest.approx(4.348, rel=0.1)
    assert (tmp_path / "barge.png").stat().st_size > 10_000


SEA = """
basin: {length: 400.0, width: 400.0, depth: 50.0, walls: none}
fluid: {kind: linear_waves, height: 0.2, period: 4.0}
"""


@pytest.mark.parametrize(
    "words", [["barge20", "--bilge-keels", "8,0.3"], ["my boat.stl", "--up", "y", "--draught", "1"]]
)
def test_a_hull_ends_with_a_ship_to_paste_that_check_accepts(words, ask, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    trimesh.creation.box((3.0, 2.0, 12.0)).export("my boat.stl")
    code, out, _ = ask("hull", *words)
    block = out.split("to paste into a scene:\n\n")[1].split("\n\n")[0]
    (tmp_path / "mine.yaml").write_text(f"{SEA}{block}\n")
    code, said, _ = ask("check", "mine.yaml", "--json")
    (ship,) = json.loads(said)["ships"].values()
    assert code == 0 and ship["draught_m"] == pytest.approx(2.0 if words[0] == "barge20" else 1.0, rel=0.01)
    assert load("mine.yaml").ships[ALONE].propeller.thrust > 0.0
    code, out, _ = ask("hull", "showcase", "--json")
    assert json.loads(out)["scene"] == ""  # a ship of a scene is there already


def test_what_is_known_of_a_hull_beforehand_comes_from_the_cache_unchanged(tmp_path, monkeypatch):
    """The second time nothing is worked out anew; another place, lattice or shape is another entry."""
    from ocean_sim.ship.hull import shapes
    from ocean_sim.ship.water import solid

    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    shape = hull_of("wigley").shape
    spacing = 0.4
    box = (np.array([-3.0, -1.0, -3.0]), np.array([3.0, 0.0, 3.0]))
    axes = [low + spacing * (np.arange(round((up - low) / spacing)) + 0.5) for low, up in zip(*box)]
    lattice = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)

    packed = Lattice(spacing, spacing**3, WENDLAND, 2.0)

    def found(x: float) -> list[bytes]:
        unit = np.array([1.0, 0.0, 0.0, 0.0])
        body = RigidBody(500.0, np.eye(3), np.array([x, -0.1, 0.0]), unit, np.zeros(3), np.zeros(3))
        hull = solid.Solid(shape, np.array([0.0, 0.3, 0.0]), body.position, body.matrix, False, False, body=body)
        parts = [
            *shapes.drawn_mesh(shape),
            shapes.convex_corners(shape),
            *hull.make_room(lattice, lattice[:0], [box], packed),
        ]
        return [array.tobytes() for array in parts]

    first, other = found(0.0), found(0.25)
    assert first[:3] == other[:3] and first[3:] != other[3:]

    def never(*given):
        raise AssertionError("worked out anew")

    monkeypatch.setattr("scipy.spatial.ConvexHull", never)
    monkeypatch.setattr(solid.Solid, "carve_room", never)
    assert found(0.0) == first and found(0.25) == other
