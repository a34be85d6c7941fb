import json

import numpy as np
import pytest

from ocean_sim.basin.points import pairs
from ocean_sim.files.vtkhdf import Series
from ocean_sim.observers import frames
from ocean_sim.pictures import export as export_module
from ocean_sim.pictures.export import NothingToExport, export_run


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
    _, points, _, _ = export_module.kept_surface(tmp_path / "frame.npz", {"x": x, "z": z})
    np.testing.assert_allclose(points[:, [0, 2]], pairs(x, z) + away)


def test_what_was_not_kept_is_named(kept, tmp_path):
    folder, _ = kept(particles=False)
    with pytest.raises(NothingToExport, match=r"frames\.particles: true"):
        export_run(folder, "vtkhdf", None, folder / "export")
    with pytest.raises(NothingToExport, match="has no frames"):
        export_run(tmp_path / "nowhere", "vtkhdf", None, folder / "export")


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


def test_a_series_that_fails_leaves_no_file(tmp_path):
    with pytest.raises(ValueError), Series(tmp_path / "s.vtkhdf", "Polygons"):
        raise ValueError
    assert list(tmp_path.iterdir()) == []
