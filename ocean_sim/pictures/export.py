"""Files for ParaView and Blender from the frames of a finished run; nothing here needs OpenGL."""

import json
from pathlib import Path

import numpy as np

from ocean_sim.conventions import Failed
from ocean_sim.files.input_file import arrays
from ocean_sim.files.vtkhdf import Series
from ocean_sim.files.whole_file import whole
from ocean_sim.pictures.water_mesh import triangles


class NothingToExport(Failed):
    """The run did not keep what was asked for; the message names what to switch on."""


def export_run(folder: Path, particles: str | None, surface: str | None, out: Path, every: int = 1) -> list[Path]:
    """Write `particles` (vtkhdf) and `surface` (ply, vtp, vtkhdf) of every `every`-th frame into `out`; returns the
    files."""
    frames = sorted((folder / "frames").glob("frame_*.npz"))[::every]
    if not frames:
        raise NothingToExport(f"{folder} has no frames; run with the observer `frames`")
    out.mkdir(parents=True, exist_ok=True)
    files = []
    if particles is not None:
        files.append(export_particles(frames, out / "particles.vtkhdf"))
    if surface is not None:
        files += export_surface(frames, arrays(folder / "frames" / "grid.npz"), surface, out)
    return files


def export_particles(frames: list[Path], path: Path) -> Path:
    """One file with all moments: points with `velocity` and `id`."""
    with Series(path, "Vertices") as series:
        for frame in frames:
            data = arrays(frame)
            if "position" not in data:
                raise NothingToExport("these frames hold no particles; run with frames.particles: true")
            x = data["position"]
            fields = {name: data[name] for name in ("velocity", "id") if name in data}
            series.add(float(data["time"]), x, np.arange(len(x))[:, None], **fields)
    return path


def export_surface(frames: list[Path], grid: dict[str, np.ndarray], kind: str, out: Path) -> list[Path]:
    """The scene's surface, or the heights that its particles have: surface_00000 and so on, for ParaView with a list of
    their times (`vtp`) or all in one file (`vtkhdf`). Y is up, as in the run."""
    if len(grid["z"]) < 2:
        raise NothingToExport("a slice has a line for a surface; export its particles")
    meshes = (kept_surface(frame, grid) for frame in frames)
    if kind == "vtkhdf":
        path = out / "surface.vtkhdf"
        with Series(path, "Polygons") as series:
            for time, points, faces, fields in meshes:
                series.add(time, points, faces, **fields)
        return [path]
    import pyvista

    listed = []
    for k, (time, points, faces, fields) in enumerate(meshes):
        mesh = pyvista.PolyData.from_regular_faces(points, faces)
        if fields:
            mesh.point_data.active_normals = fields["Normals"]
        listed.append({"name": f"surface_{k:05d}.{kind}", "time": time})
        with whole(out / str(listed[-1]["name"])) as draft:
            mesh.save(draft)
    if kind == "ply":
        return [out / str(entry["name"]) for entry in listed]
    index = out / "surface.vtp.series"
    index.write_text(json.dumps({"file-series-version": "1.0", "files": listed}, indent=1) + "\n", encoding="utf-8")
    return [index, *(out / str(entry["name"]) for entry in listed)]


def kept_surface(
    frame: Path, grid: dict[str, np.ndarray]
) -> tuple[float, np.ndarray, np.ndarray, dict[str, np.ndarray]]:
    """Time [s], points, triangles and, of a surface, normals."""
    data = arrays(frame)
    time = float(data["time"])
    if "vertices" in data:
        return time, data["vertices"], data["triangles"], {"Normals": data["normals"]}
    x, z = np.meshgrid(grid["x"], grid["z"], indexing="ij")
    dx, dz = data.get("origin", np.zeros(2))
    points = np.stack([x + dx, data["elevation"], z + dz], axis=-1).reshape(-1, 3).astype(np.float32)
    return time, points, triangles(*x.shape), {}
