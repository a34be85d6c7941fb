import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh
from scipy.interpolate import RegularGridInterpolator
from scipy.ndimage import map_coordinates

from ocean_sim.basin.points import grid_points
from ocean_sim.conventions import Failed, in_words
from ocean_sim.files import atomic_file
from ocean_sim.files.atomic_file import atomic_write
from ocean_sim.files.meshes import Series
from ocean_sim.observers import frames
from ocean_sim.pictures.export import scene_file
from ocean_sim.pictures.export.paraview import export_run, save_mesh
from ocean_sim.pictures.export.scene_file import RunWakes
from ocean_sim.pictures.frame_files import Frame, FrameLog, frame_files
from ocean_sim.pictures.stage import opengl
from ocean_sim.pictures.stage.picture import Picture
from ocean_sim.pictures.stage.render_order import Order
from ocean_sim.pictures.water.foam import cell_means
from ocean_sim.pictures.water.waterline import CONTACT_WIDTH, RESTING_FOAM
from ocean_sim.surface import cell_triangles
from ocean_sim.verbs.render import list_files


def area_normals(points, faces):
    """Unit normals (n, 3) of a mesh at its points: means of the triangles around each, weighted by area."""
    normals = np.zeros((len(points), 3))
    mesh = trimesh.Trimesh(points, faces, process=False)
    np.add.at(normals, faces, (mesh.face_normals * mesh.area_faces[:, None])[:, None])
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


@pytest.fixture
def kept(tmp_path, watched):
    """A run folder with frames of a computed sea, and its simulation."""

    def build(**config):
        simulation = watched((0.013,))
        simulation.fluid.rise = 0.0
        simulation.observers = [frames.Config(every=0.05, **config).build(tmp_path, simulation)]
        simulation.run(until=0.2)
        return tmp_path, simulation

    return build


def test_particles_read_back_as_vtk_reads_them(kept, tmp_path):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOHDF import vtkHDFReader

    folder, simulation = kept()
    [file] = export_run(folder, "vtkhdf", None, folder / "export")
    reader = vtkHDFReader()
    reader.SetFileName(str(file))
    reader.Update()
    saved = [np.load(path) for path in sorted((folder / "frames").glob("frame_*.npz"))]
    assert reader.GetNumberOfSteps() == len(saved) == 5
    for k, frame in enumerate(saved):
        reader.SetStep(k)
        reader.Update()
        data = reader.GetOutputDataObject(0)
        assert reader.GetTimeValue() == float(frame["time"])
        assert data.GetNumberOfPoints() == data.GetNumberOfVerts() == simulation.fluid.particles.n
        np.testing.assert_array_equal(vtk_to_numpy(data.GetPoints().GetData()), frame["position"])
        np.testing.assert_array_equal(vtk_to_numpy(data.GetPointData().GetArray("velocity")), frame["velocity"])
        np.testing.assert_array_equal(vtk_to_numpy(data.GetPointData().GetArray("id")), frame["id"])


@pytest.mark.parametrize("kind", ["ply", "vtp"])
def test_surfaces_read_back_facing_up(kept, kind):
    import pyvista

    folder, _ = kept(particles=False)
    files = export_run(folder, None, kind, folder / "export", every=2)
    meshes = [file for file in files if file.suffix == f".{kind}"]
    assert [file.name for file in meshes] == [f"surface_{k:05d}.{kind}" for k in range(3)]
    frame = np.load(folder / "frames" / "frame_00002.npz")
    mesh = pyvista.read(meshes[1])
    np.testing.assert_allclose(mesh.points[:, 1].reshape(12, 8), frame["elevation"], atol=1e-6)
    assert (mesh.compute_normals(auto_orient_normals=False, consistent_normals=False)["Normals"][:, 1] > 0.0).all()
    if kind == "vtp":
        series = json.loads(files[0].read_text())
        assert files[0].name == "surface.vtp.series" and series["files"][1]["time"] == pytest.approx(
            float(frame["time"])
        )


def test_a_surface_lies_where_its_frame_says(tmp_path):
    x, z, away = np.arange(3.0), np.arange(2.0), np.array([40.0, -7.5])
    np.savez(tmp_path / "frame.npz", time=1.0, elevation=np.ones((3, 2)), origin=away)
    grid = {"x": x, "z": z}
    points = scene_file.read_shot(tmp_path / "frame.npz", grid, RunWakes([], grid)).points
    np.testing.assert_allclose(points[:, [0, 2]], grid_points(x, z) + away)


def test_what_was_not_kept_is_named(kept, tmp_path):
    folder, _ = kept(particles=False)
    with pytest.raises(Failed, match=r"frames\.particles: true"):
        export_run(folder, "vtkhdf", None, folder / "export")
    with pytest.raises(Failed, match="has no frames"):
        export_run(tmp_path / "nowhere", "vtkhdf", None, folder / "export")


def test_a_slice_has_particles_but_no_mesh(tmp_path):
    """A file with nothing in it would look like success."""
    (tmp_path / "frames").mkdir()
    np.savez(tmp_path / "frames" / "grid.npz", x=np.arange(3.0), z=np.zeros(1), spacing=0.1)
    np.savez(tmp_path / "frames" / "frame_00000.npz", time=0.0, elevation=np.zeros((3, 1)))
    for asked in ({"surface": "vtp"}, {"surface": None, "scene": "glb"}, {"surface": None, "scene": "usd"}):
        with pytest.raises(Failed, match="export its particles"):
            export_run(tmp_path, None, out=tmp_path / "export", **asked)
    assert not (tmp_path / "export").exists()


@pytest.mark.filterwarnings("error")
def test_the_surface_of_a_slice_is_left_out_without_a_word(tmp_path):
    """Its places from side to side of a basin without breadth were numbers over nothing, and NumPy said so."""
    grid = {"x": np.arange(3.0), "z": np.zeros(1), "lower": np.zeros(3), "upper": np.array([3.0, 1.0, 0.0])}
    line = {"vertices": np.zeros((3, 3)), "triangles": np.zeros((0, 3), int), "normals": np.zeros((3, 3))}
    np.savez(tmp_path / "frame.npz", time=1.0, elevation=np.ones((3, 1)), position=np.ones((5, 3)), **line)
    kept = scene_file.read_shot(tmp_path / "frame.npz", grid, RunWakes([], grid))
    assert len(kept.points) == len(kept.faces) == 0 and len(kept.particles["position"]) == 5


def test_what_changes_from_moment_to_moment_reads_back(tmp_path):
    """Another number of points and other triangles in each moment, and once the same as before."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOHDF import vtkHDFReader

    rng = np.random.default_rng(3)
    moments = []
    for n, m in ((5, 3), (9, 4), (9, 4), (4, 1)):
        same = moments and len(moments[-1][0]) == n
        faces = moments[-1][1] if same else np.stack([rng.permutation(n)[:3] for _ in range(m)])
        moments.append((rng.random((n, 3)).astype(np.float32), faces, rng.random((n, 3)).astype(np.float32)))
    with Series(tmp_path / "s.vtkhdf", "Polygons") as series:
        for k, (points, faces, normals) in enumerate(moments):
            series.add(0.1 * k, points, faces, Normals=normals)
    reader = vtkHDFReader()
    reader.SetFileName(str(tmp_path / "s.vtkhdf"))
    reader.Update()
    assert reader.GetNumberOfSteps() == len(moments)
    for k, (points, faces, normals) in enumerate(moments):
        reader.SetStep(k)
        reader.Update()
        data = reader.GetOutputDataObject(0)
        np.testing.assert_array_equal(vtk_to_numpy(data.GetPoints().GetData()), points)
        np.testing.assert_array_equal(vtk_to_numpy(data.GetPointData().GetArray("Normals")), normals)
        cells = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        np.testing.assert_array_equal(cells, faces)


def test_an_export_that_a_disk_has_no_room_for_leaves_no_file(tmp_path, monkeypatch):
    path, points = tmp_path / "s.vtkhdf", np.zeros((3, 3))
    monkeypatch.setattr(atomic_file, "disk_usage", lambda folder: SimpleNamespace(free=1000))
    with pytest.raises(OSError) as failure, atomic_write(path) as draft, Series(draft, "Polygons") as series:
        series.add(0.0, points, np.array([[0, 1, 2]]))
    assert in_words(failure.value) == f"No space left on device: {path}"
    with pytest.raises(OSError) as failure:
        save_mesh(tmp_path / "s.vtp", points, None, {})
    assert in_words(failure.value) == f"No space left on device: {tmp_path / 's.vtp'}"
    assert list(tmp_path.iterdir()) == []


@pytest.fixture
def manned(kept):
    """The same run folder, with a box afloat that turns and moves."""
    folder, _ = kept()
    from scipy.spatial import ConvexHull
    from scipy.spatial.transform import Rotation

    box = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.2, 0.4) for z in (-1.0, 1.0)])
    look = {"ship_look": "box", "ship_helm": np.zeros(0), "ship_still_water": np.eye(4)[1]}
    grid = dict(np.load(folder / "frames" / "grid.npz"))
    found = ConvexHull(box)
    a, b, c = (box[found.simplices[:, k]] for k in range(3))
    inwards = (np.cross(b - a, c - a) * found.equations[:, :3]).sum(axis=1) < 0.0
    skin = np.where(inwards[:, None], found.simplices[:, ::-1], found.simplices)
    np.savez(folder / "frames" / "grid.npz", **grid, ship_vertices=box, ship_triangles=skin, **look)
    for k, path in enumerate(sorted((folder / "frames").glob("frame_*.npz"))):
        turn = Rotation.from_euler("y", 0.2 * k).as_matrix()
        pose = {"ship_position": np.array([0.1 * k, 0.0, 0.3 * k]), "ship_turn": turn}
        np.savez(path, **dict(np.load(path)), **pose)
    return folder


@pytest.fixture
def blocked(manned):
    """The same run folder, with two boxes that stand in the water."""
    boxes = np.array([[[-1.0, -0.5, 0.0], [-0.5, 0.25, 2.0]], [[1.0, -1.0, -1.0], [1.5, 0.5, 0.5]]])
    grid = dict(np.load(manned / "frames" / "grid.npz")) | {"obstacles": boxes}
    np.savez(manned / "frames" / "grid.npz", **grid)
    return manned, np.prod(boxes[:, 1] - boxes[:, 0], axis=1).sum()


def enclosed(points: np.ndarray, faces: np.ndarray) -> float:
    """Volume inside a skin, by the divergence theorem: positive where its triangles face outwards."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


@pytest.mark.parametrize("kind", ["ply", "vtp"])
def test_what_stands_in_the_water_goes_with_the_surface(blocked, kind):
    import pyvista

    folder, volume = blocked
    files = export_run(folder, None, kind, folder / "export", z_up=True)
    [box] = [file for file in files if file.name == f"obstacles_00000.{kind}"]
    mesh = pyvista.read(box)
    assert enclosed(np.array(mesh.points), mesh.regular_faces) == pytest.approx(volume, rel=1e-6)
    np.testing.assert_allclose(mesh.bounds, [-1.0, 1.5, -2.0, 1.0, -1.0, 0.5], atol=1e-6)  # x, -z, y


def test_what_stands_in_the_water_is_in_the_scene(blocked):
    import trimesh

    folder, volume = blocked
    [file] = export_run(folder, None, None, folder / "export", scene="glb")
    assert trimesh.load(file).geometry["obstacles"].volume == pytest.approx(volume, rel=1e-6)
    Usd = pytest.importorskip("pxr.Usd")
    from pxr import UsdGeom

    [file] = export_run(folder, None, None, folder / "export", scene="usd")
    stage = Usd.Stage.Open(str(file))
    mesh = UsdGeom.Mesh.Get(stage, "/sea/obstacles")
    faces = np.array(mesh.GetFaceVertexIndicesAttr().Get()).reshape(-1, 3)
    assert enclosed(np.array(mesh.GetPointsAttr().Get()), faces) == pytest.approx(volume, rel=1e-6)


def shown_of(folder, frame) -> tuple[np.ndarray, np.ndarray]:
    """Heights of a frame, and its foam at their points, as pictures show them around ships."""
    height, white = RunWakes(frame_files(folder), dict(np.load(folder / "frames" / "grid.npz"))).water_with_ships(frame)
    return height, cell_means(white, height.shape).ravel()


def test_usd_holds_water_foam_velocity_ship_and_particles(manned):
    Usd = pytest.importorskip("pxr.Usd")
    from pxr import UsdGeom

    [file] = export_run(manned, None, None, manned / "export", scene="usd", z_up=True)
    stage = Usd.Stage.Open(str(file))
    frame = dict(np.load(manned / "frames" / "frame_00003.npz"))
    code = Usd.TimeCode(float(frame["time"]) * stage.GetTimeCodesPerSecond())
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1.0 and UsdGeom.GetStageUpAxis(stage) == "Z"
    water = UsdGeom.Mesh.Get(stage, "/sea/water")
    points = np.array(water.GetPointsAttr().Get(code))
    height, white = shown_of(manned, frame)
    np.testing.assert_allclose(points[:, 1].reshape(12, 8), height, atol=1e-6)
    foam = UsdGeom.PrimvarsAPI(water).GetPrimvar("foam").Get(code)
    np.testing.assert_allclose(np.array(foam), white, atol=1e-6)
    velocity = np.array(water.GetVelocitiesAttr().Get(code))
    np.testing.assert_allclose(velocity, frame["surface_velocity"].reshape(-1, 3), atol=1e-6)
    world = UsdGeom.Xformable(stage.GetPrimAtPath("/sea/ship")).ComputeLocalToWorldTransform(code)
    bow = np.array(world.Transform((0.0, 0.0, 1.0)))
    expected = frame["ship_turn"] @ [0.0, 0.0, 1.0] + frame["ship_position"]
    np.testing.assert_allclose(bow, scene_file.Z_UP @ expected, atol=1e-6)
    cloud = UsdGeom.Points.Get(stage, "/sea/particles")
    np.testing.assert_array_equal(np.array(cloud.GetPointsAttr().Get(code)), frame["position"])
    pressure = UsdGeom.PrimvarsAPI(cloud).GetPrimvar("pressure").Get(code)
    np.testing.assert_array_equal(np.array(pressure), frame["pressure"])


def test_gltf_opens_elsewhere_with_its_ship_on_her_way(manned):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOGeometry import vtkGLTFReader

    [file] = export_run(manned, None, None, manned / "export", scene="glb")
    reader = vtkGLTFReader()
    reader.SetFileName(str(file))
    reader.ApplyDeformationsToGeometryOn()
    reader.UpdateInformation()
    reader.EnableAnimation(0)
    frame = dict(np.load(manned / "frames" / "frame_00002.npz"))
    reader.GetOutputInformation(0).Set(reader.GetExecutive().UPDATE_TIME_STEP(), float(frame["time"]))
    reader.Modified()
    reader.Update()
    found, blocks = [], [reader.GetOutput()]
    while blocks:
        block = blocks.pop()
        if block.IsA("vtkMultiBlockDataSet"):
            blocks += [block.GetBlock(k) for k in range(block.GetNumberOfBlocks()) if block.GetBlock(k)]
        else:
            found.append(vtk_to_numpy(block.GetPoints().GetData()))
    import trimesh

    scene = trimesh.load(file)
    assert set(scene.geometry) == {"water", "ship"} and scene.geometry["water"].faces.shape[1] == 3
    water = next(points for points in found if len(points) == 12 * 8)
    first, _ = shown_of(manned, dict(np.load(manned / "frames" / "frame_00000.npz")))
    heights = water[:, 1].reshape(12, 8)
    moved = np.abs(heights - shown_of(manned, frame)[0]).max() < 1e-4
    assert moved or np.abs(heights - first).max() < 1e-4  # readers that know no time show the first moment


def test_a_surface_comes_with_foam_velocity_and_ships_and_particles_as_points(manned):
    import pyvista
    import trimesh

    files = export_run(manned, "ply", "vtp", manned / "export", z_up=True)
    frame = dict(np.load(manned / "frames" / "frame_00004.npz"))
    surface = pyvista.read(manned / "export" / "surface_00004.vtp")
    height, white = shown_of(manned, frame)
    np.testing.assert_allclose(surface["foam"], white, atol=1e-6)
    np.testing.assert_allclose(surface.points[:, 2].reshape(12, 8), height, atol=1e-6)
    ship = pyvista.read(manned / "export" / "ship_00004.vtp")
    np.testing.assert_allclose(np.mean(ship.bounds[:2]), frame["ship_position"][0], atol=0.02)
    cloud = trimesh.load(manned / "export" / "particles_00004.ply")
    np.testing.assert_allclose(cloud.vertices, frame["position"] @ scene_file.Z_UP.T, atol=1e-6)
    assert {file.name for file in files} >= {"surface.vtp.series", "ship.vtp.series", "particles_00000.ply"}


def test_a_surface_that_was_kept_as_triangles_has_the_foam_and_velocity_of_its_places(tmp_path):
    """What the frame kept on its grid, linear between middles of cells; a surface with an underside has none."""
    x, z = np.meshgrid(np.arange(8) + 0.5, np.arange(4) + 0.5, indexing="ij")  # of a basin from 0 to 8 and to 4 m
    fine_x, fine_z = np.meshgrid((np.arange(16) + 0.5) / 2.0, (np.arange(8) + 0.5) / 2.0, indexing="ij")
    vertices = np.array([[11.0, 0.1, 21.0], [11.0, 0.2, 23.0], [16.3, 0.0, 22.0]])
    grid = {"lower": np.zeros(3), "upper": np.array([8.0, 1.0, 4.0]), "x": x[:, 0], "z": z[0]}
    data = {"time": 0.0, "elevation": 0.0 * x, "origin": np.array([10.0, 20.0]), "vertices": vertices}
    data |= {"normals": np.tile([0.0, 1.0, 0.0], (3, 1)), "foam": 0.1 * fine_x + 0.05 * fine_z}
    data["surface_velocity"] = np.stack([x, -z, 0.0 * x], axis=-1)
    for name, triangles in (("up", [[0, 1, 2]]), ("folded", [[0, 1, 2], [0, 2, 1]])):
        np.savez(tmp_path / f"{name}.npz", triangles=np.array(triangles), **data)
    fields = scene_file.read_shot(tmp_path / "up.npz", grid, RunWakes([], grid)).fields
    np.testing.assert_allclose(fields["foam"], [0.15, 0.25, 0.73], atol=1e-6)
    np.testing.assert_allclose(fields["velocity"], [[1.0, -1.0, 0.0], [1.0, -3.0, 0.0], [6.3, -2.0, 0.0]], atol=1e-6)
    assert list(scene_file.read_shot(tmp_path / "folded.npz", grid, RunWakes([], grid)).fields) == ["Normals"]


DROPS = np.array([[3.0, 2.0, 1.0, 2.0, 5.0, 1e-3, 40.0, 0.05], [0.0, 3.0, 0.0, 0.0, 5.0, 2e-3, 1.0, 2e-3]], np.float32)


def voyage(folder, answers):
    """A run folder of a ship that goes at 5 m/s along z: over a sea that `answers` to her, so that it sinks under her,
    or over long waves that know nothing of her, whose surface is kept as triangles, too."""
    (folder / "frames").mkdir()
    x, z = np.arange(-20.0, 20.5), np.arange(-40.0, 40.5)
    box = np.array([[x, y, z] for x in (-2.0, 2.0) for y in (-1.0, 2.0) for z in (-7.5, 7.5)])
    low = {"lower": np.array([-20.5, -9.0, -40.5]), "upper": np.array([20.5, 0.0, 40.5]), "depth": 9.0}
    low |= {"spacing": 1.0, "every": 0.5, "has_surface": True} | ({"sea_answers": True} if answers else {})
    ship = {"ship_vertices": box, "ship_triangles": trimesh.creation.box().faces, "ship_still_water": np.eye(4)[1]}
    ship |= {"ship_look": "box", "ship_helm": np.zeros(0)}
    np.savez(folder / "frames" / "grid.npz", x=x, z=z, obstacles=np.zeros((0, 2, 3)), **low, **ship)
    for k in range(7):
        at = 5.0 * 0.5 * k
        sunk = -3.0 * np.exp(-((x[:, None] / 2.0) ** 2) - ((z - at) / 7.0) ** 2)
        left = np.repeat(np.repeat(0.8 * (np.abs(x[:, None]) < 2.0) * (z < at - 7.0), 2, axis=0), 2, axis=1)
        long = 0.2 * np.cos(0.15 * x[:, None] + 0.1 * z - 0.3 * k)
        corners = np.insert(grid_points(x, z), 1, long.ravel(), axis=1)
        faces = cell_triangles(len(x), len(z))
        mesh = {"vertices": corners, "triangles": faces, "normals": area_normals(corners, faces)}
        np.savez(
            folder / "frames" / f"frame_{k:05d}.npz",
            time=0.5 * k,
            foam=np.zeros((2 * len(x), 2 * len(z))),
            drops=np.insert(DROPS, 2, at, axis=1),
            ship_position=np.array([0.0, 0.5, at]),
            ship_turn=np.eye(3),
            **({"elevation": sunk, "answer": sunk, "left": left} if answers else {"elevation": long} | mesh),
        )
    return folder


@pytest.fixture
def sailing(tmp_path):
    return voyage(tmp_path, answers=True)


@pytest.fixture
def passing(tmp_path):
    return voyage(tmp_path, answers=False)


@pytest.fixture
def pictured(passing):
    """The last moment of it as a picture shows it: the sea that was drawn."""
    files, grid = frame_files(passing), dict(np.load(passing / "frames" / "grid.npz"))
    order = Order(folder=str(passing), out="", size=(160, 90), every=0.5, film=False, foam_cover=0.0)
    picture = Picture(grid, order, Frame(files[0]), 1.0, FrameLog(files))
    picture.draw(Frame(files[-1]))
    yield picture.content
    picture.close()


def foam_of(sea, places) -> np.ndarray:
    """What the sea's programs take for white at places around its ship: along her hull, at her bow and in her wake."""
    map_size = np.array(sea.gap.shape[2:0:-1])
    low, high = sea.wetted_hull("ship", *sea.frame.ships["ship"]).foam_area()
    at = ((places - low) / (high - low) * map_size - 0.5).T[::-1]
    gap, breaking = (map_coordinates(sea.gap[0, ..., k].astype(float), at, order=1, mode="nearest") for k in range(2))
    on = ((places > low) & (places < high)).all(axis=1)
    along = np.where(on, np.maximum(breaking, RESTING_FOAM * np.exp(-np.maximum(gap, 0.0) / CONTACT_WIDTH)), 0.0)
    traits = np.asarray(sea.near.mesh.point_data["att"])[:, 0].reshape(len(sea.surface.x), len(sea.surface.z))
    nodes = (sea.surface.x, sea.surface.z)
    return np.maximum(along, RegularGridInterpolator(nodes, traits.astype(float))(places))


@pytest.mark.skipif(opengl.probe() is not None, reason="no OpenGL on this machine")
def test_files_have_the_wave_and_the_white_that_pictures_draw_at_a_ship(passing, pictured):
    """As VTK reads them, heights are a picture's but for what a spline differs from lines between cells, and foam the
    mean of a picture's over cells of a metre, of which a file knows four points: in the mean within 4 % of it."""
    import pyvista

    x, z = np.arange(-20.0, 20.5), np.arange(-40.0, 40.5)
    inside = (np.abs(grid_points(x, z)) < [12.0, 32.0]).all(axis=1)  # where nothing of the far sea is mixed in
    places = grid_points(x, z)[inside]
    export_run(passing, None, "vtp", passing / "export")
    mesh = pyvista.read(passing / "export" / "surface_00006.vtp")
    np.testing.assert_allclose(mesh.points[inside, 1], pictured.heights_at(places), atol=2e-3)
    kept = np.load(passing / "frames" / "frame_00006.npz")["elevation"].ravel()
    assert (mesh.points[:, 1] - kept).max() > 0.3
    within = (np.arange(4) - 1.5) / 4.0
    spots = (places[:, None] + grid_points(within, within)).reshape(-1, 2)
    drawn = foam_of(pictured, spots).reshape(-1, 16).mean(axis=1)
    found = np.asarray(mesh["foam"])[inside]
    assert drawn.max() > 0.6 and found.mean() == pytest.approx(drawn.mean(), rel=0.04)
    assert np.abs(found - drawn).max() < 0.15


def test_files_of_all_kinds_have_the_same_wave_and_white_at_a_ship(passing):
    """As VTK, trimesh and USD read the first moment."""
    import pyvista
    import trimesh

    export_run(passing, None, "vtp", passing / "export", scene="glb")
    export_run(passing, None, "ply", passing / "export")
    first = pyvista.read(passing / "export" / "surface_00000.vtp")
    points, foam = np.array(first.points), np.asarray(first["foam"])
    assert foam.max() > 0.6
    np.testing.assert_allclose(first["Normals"], area_normals(points, first.regular_faces), atol=1e-5)
    file = vertices_of(passing / "export" / "surface_00000.ply")
    np.testing.assert_allclose(np.stack([file[axis] for axis in "xyz"], axis=1), points, atol=1e-5)
    np.testing.assert_allclose(file["foam"], foam, atol=1e-6)
    water = trimesh.load(passing / "export" / "run.glb", process=False).geometry["water"]
    np.testing.assert_allclose(water.vertices, points, atol=1e-5)
    painted = scene_file.WATER_COLOUR + foam[:, None] * (scene_file.FOAM_COLOUR - scene_file.WATER_COLOUR)
    np.testing.assert_allclose(water.visual.vertex_attributes["color"][:, :3], painted, atol=1e-5)
    Usd = pytest.importorskip("pxr.Usd")
    from pxr import UsdGeom

    [made] = export_run(passing, None, None, passing / "export", scene="usd")
    stage = Usd.Stage.Open(str(made))
    mesh = UsdGeom.Mesh.Get(stage, "/sea/water")
    np.testing.assert_allclose(np.array(mesh.GetPointsAttr().Get(0.0)), points, atol=1e-5)
    np.testing.assert_allclose(np.array(UsdGeom.PrimvarsAPI(mesh).GetPrimvar("foam").Get(0.0)), foam, atol=1e-6)


def test_files_have_drops_with_radius_and_velocity(passing):
    """As PLY, VTK, VTKHDF and USD hold them, with z up: points, one for each parcel."""
    import pyvista

    drops = np.load(passing / "frames" / "frame_00002.npz")["drops"]
    turned = [np.column_stack([of[:, 0], -of[:, 2], of[:, 1]]) for of in (drops[:, :3], drops[:, 3:6])]
    for kind in ("ply", "vtp", "vtkhdf"):
        export_run(passing, None, kind, passing / "export", z_up=True)
    file = vertices_of(passing / "export" / "spray_00002.ply")
    np.testing.assert_allclose(np.stack([file[f"velocity_{axis}"] for axis in "xyz"], axis=1), turned[1])
    np.testing.assert_allclose([file["radius"], file["count"], file["spread"]], drops[:, 6:].T)
    points = pyvista.read(passing / "export" / "spray_00002.vtp")
    np.testing.assert_allclose(points.points, turned[0])
    np.testing.assert_allclose(points["radius"], drops[:, 6])
    series = pyvista.get_reader(passing / "export" / "spray.vtkhdf")
    assert series.read().n_verts == 2
    Usd = pytest.importorskip("pxr.Usd")
    from pxr import UsdGeom

    [made] = export_run(passing, None, None, passing / "export", scene="usd")
    stage = Usd.Stage.Open(str(made))
    dots, code = UsdGeom.Points.Get(stage, "/sea/spray"), 2.0 * 0.5 * stage.GetTimeCodesPerSecond()
    np.testing.assert_allclose(np.array(dots.GetVelocitiesAttr().Get(code)), drops[:, 3:6])
    np.testing.assert_allclose(np.array(dots.GetWidthsAttr().Get(code)), 2.0 * drops[:, 8])
    np.testing.assert_allclose(np.array(UsdGeom.PrimvarsAPI(dots).GetPrimvar("radius").Get(code)), drops[:, 6])


def test_files_show_the_wake_of_a_ship_and_her_water_no_deeper_than_pictures(sailing):
    """Behind her stern it is white, ahead it is not; under her the water sinks by no more than V^2 / 2 g."""
    grid = dict(np.load(sailing / "frames" / "grid.npz"))
    wakes = RunWakes(frame_files(sailing), grid)
    kept = scene_file.read_shot(sailing / "frames" / "frame_00006.npz", grid, wakes)
    white = kept.fields["foam"].reshape(len(grid["x"]), len(grid["z"]))
    middle = white[np.abs(grid["x"]) <= 1.5]
    assert middle[:, (grid["z"] > -5.0) & (grid["z"] < 5.0)].max() > 0.3 and middle[:, grid["z"] > 27.0].max() == 0.0
    assert -(5.0**2) / (2.0 * 9.81) <= kept.points[:, 1].min() < -1.0


@pytest.fixture
def folded(tmp_path):
    """A run folder of two moments of a surface with an underside, whose triangles change, beside its particles."""
    from scipy.spatial import ConvexHull

    (tmp_path / "frames").mkdir()
    rng = np.random.default_rng(5)
    np.savez(
        tmp_path / "frames" / "grid.npz",
        x=np.arange(3.0),
        z=np.arange(2.0),
        lower=np.zeros(3),
        upper=np.ones(3),
        spacing=0.1,
        every=0.04,
        obstacles=np.zeros((0, 2, 3)),
    )
    for k, count in enumerate((40, 60)):
        points = rng.normal(size=(count, 3))
        points /= np.linalg.norm(points, axis=1)[:, None]
        inside = 0.99 * points  # a tenth as far from its point of the surface as the next, or nearer
        np.savez(
            tmp_path / "frames" / f"frame_{k:05d}.npz",
            time=0.0413 * k,  # the first step after 0.04 s
            vertices=points.astype(np.float32),
            triangles=ConvexHull(points).simplices,
            normals=points.astype(np.float32),
            elevation=np.zeros((3, 2)),
            position=inside.astype(np.float32),
            velocity=np.cross([0.0, 1.0, 0.0], inside).astype(np.float32),
            pressure=np.arange(count, dtype=np.float32),
            id=np.arange(count),
        )
    return tmp_path


def test_a_folded_surface_has_the_velocity_of_its_particles_and_a_frame_rate_as_kept(folded):
    import pyvista

    export_run(folded, None, "vtp", folded / "export")
    mesh = pyvista.read(folded / "export" / "surface_00001.vtp")
    exact = np.cross([0.0, 1.0, 0.0], 0.99 * mesh.points)
    assert np.sqrt(np.mean((mesh["velocity"] - exact) ** 2)) < 0.02 * np.abs(exact).max()
    assert (
        scene_file.frame_rate(0.0, 0.0413, 2, 0.04) == 25.0 and scene_file.frame_rate(0.0, 0.4237, 2, 0.0833) == 2.401
    )
    assert scene_file.frame_rate(0.0, 1.4013, 36, 0.04) == 25.0 and scene_file.frame_rate(3.0, 3.0, 1, 0.04) == 24.0


def test_gltf_shows_water_whose_triangles_change_a_moment_at_a_time(folded):
    import trimesh

    [file] = export_run(folded, None, None, folded / "export", scene="glb")
    scene = trimesh.load(file)
    for k, name in enumerate(("water_00000", "water_00001")):
        frame = np.load(folded / "frames" / f"frame_{k:05d}.npz")
        assert scene.geometry[name].faces.shape == frame["triangles"].shape
    size = int.from_bytes(file.read_bytes()[12:16], "little")
    tree = json.loads(file.read_bytes()[20 : 20 + size])
    assert [node["scale"] for node in tree["nodes"]] == [[1.0] * 3, [0.0] * 3]
    [run] = tree["animations"]
    assert [channel["target"]["path"] for channel in run["channels"]] == ["scale", "scale"]
    assert {sampler["interpolation"] for sampler in run["samplers"]} == {"STEP"}


def vertices_of(path) -> np.ndarray:
    """The rows of a binary PLY file's points, read by its head."""
    head, _, body = path.read_bytes().partition(b"end_header\n")
    words = [line.split() for line in head.decode().splitlines()]
    count = next(int(line[2]) for line in words if line[:2] == ["element", "vertex"])
    types = {"float": "<f4", "int": "<i4", "uchar": "u1"}
    return np.frombuffer(
        body, [(line[2], types[line[1]]) for line in words if line[0] == "property" and line[1] in types], count
    )


def test_a_gate_is_where_it_is_until_it_leaves(folded):
    """In every format: at the first moment, raised at the second, gone at the third."""
    import pyvista

    gate = np.array([[[0.2, 0.0, 0.0], [0.3, 0.5, 1.0]]])
    last = dict(np.load(folded / "frames" / "frame_00001.npz")) | {"time": 0.08}
    np.savez(folded / "frames" / "frame_00002.npz", **last)
    for k, raised in enumerate((0.0, 0.4)):
        path = folded / "frames" / f"frame_{k:05d}.npz"
        np.savez(path, **dict(np.load(path)), gates=gate + [0.0, raised, 0.0])
    export_run(folded, None, "vtp", folded / "export")
    meshes = [pyvista.read(folded / "export" / f"gates_{k:05d}.vtp") for k in range(3)]
    assert [mesh.n_points for mesh in meshes] == [8, 8, 0]
    assert enclosed(np.array(meshes[1].points), meshes[1].regular_faces) == pytest.approx(0.05, rel=1e-5)
    np.testing.assert_allclose(meshes[1].bounds[2:4], [0.4, 0.9], atol=1e-6)
    for kind in ("ply", "vtkhdf"):
        export_run(folded, None, kind, folded / "export")
    [file] = export_run(folded, None, None, folded / "export", scene="glb")
    size = int.from_bytes(file.read_bytes()[12:16], "little")
    tree = json.loads(file.read_bytes()[20 : 20 + size])
    assert [node["name"] for node in tree["nodes"]][3:] == ["gates_00000", "gates_00001"]
    Usd = pytest.importorskip("pxr.Usd")
    from pxr import UsdGeom

    [file] = export_run(folded, None, None, folded / "export", scene="usd")
    stage = Usd.Stage.Open(str(file))
    points = UsdGeom.Mesh.Get(stage, "/sea/gates").GetPointsAttr()
    assert [len(points.Get(time)) for time in points.GetTimeSamples()] == [8, 8, 0]


def test_a_ply_file_holds_what_is_known_of_its_points(folded, manned):
    export_run(folded, "ply", "ply", folded / "ply")
    frame = np.load(folded / "frames" / "frame_00001.npz")
    cloud = vertices_of(folded / "ply" / "particles_00001.ply")
    np.testing.assert_array_equal(np.stack([cloud[a] for a in "xyz"], axis=1), frame["position"])
    np.testing.assert_array_equal(cloud["pressure"], frame["pressure"])
    np.testing.assert_array_equal(cloud["velocity_z"], frame["velocity"][:, 2])
    np.testing.assert_array_equal(cloud["id"], frame["id"])
    export_run(manned, None, "ply", manned / "ply", z_up=True)
    water = vertices_of(manned / "ply" / "surface_00003.ply")
    assert {"nx", "foam", "red", "velocity_x"} <= set(water.dtype.names) and (water["nz"] > 0.5).all()
    ship = vertices_of(manned / "ply" / "ship_00003.ply")
    np.testing.assert_allclose(np.linalg.norm([ship[f"n{a}"] for a in "xyz"], axis=0), 1.0, atol=1e-5)


def test_many_files_are_not_named_one_by_one(capsys):
    list_files([Path(f"surface_{k:05d}.vtp") for k in range(31)])
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 8 and lines[5:] == ["surface_00005.vtp", "... 24 more ...", "surface_00030.vtp"]
    list_files([Path("a.ply"), Path("b.ply")])
    assert capsys.readouterr().out.splitlines() == ["a.ply", "b.ply"]
