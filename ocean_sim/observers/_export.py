"""Files for ParaView and Blender from the frames of a finished run; nothing here needs OpenGL."""

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ocean_sim.observers._water_mesh import triangles

TOPOLOGIES = ("Vertices", "Lines", "Strips", "Polygons")


class NothingToExport(Exception):
    """The run did not keep what was asked for; the message says what to switch on."""


def export_run(folder: Path, particles: str | None, surface: str | None, out: Path, every: int = 1) -> list[Path]:
    """Write `particles` (vtkhdf) and `surface` (ply or vtp) of every `every`-th frame into `out`; returns the files."""
    frames = sorted((folder / "frames").glob("frame_*.npz"))[::every]
    if not frames:
        raise NothingToExport(f"{folder} has no frames; run with the observer `frames`")
    out.mkdir(parents=True, exist_ok=True)
    files = []
    if particles is not None:
        files.append(export_particles(frames, out / "particles.vtkhdf"))
    if surface is not None:
        with np.load(folder / "frames" / "grid.npz") as grid:
            files += export_surface(frames, dict(grid), surface, out)
    return files


def export_particles(frames: list[Path], path: Path) -> Path:
    """One file with all moments: VTKHDF 2.2 (ParaView 5.12 or newer), points with `velocity` and `id`."""
    import h5py

    with np.load(frames[0]) as first:
        if "position" not in first:
            raise NothingToExport("these frames hold no particles; run with frames.particles: true")
        n, with_id = len(first["position"]), "id" in first
    beside, steps = path.with_name(f".{path.name}.tmp"), len(frames)
    with h5py.File(beside, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = np.array([2, 2])
        root.attrs.create("Type", b"PolyData", dtype=h5py.string_dtype("ascii", len("PolyData")))
        root["NumberOfPoints"] = np.array([n])  # one part, the same at all moments
        points = root.create_dataset("Points", (steps * n, 3), np.float32, chunks=(n, 3))
        velocity = root.create_dataset("PointData/velocity", (steps * n, 3), np.float32, chunks=(n, 3))
        identity = root.create_dataset("PointData/id", (steps * n,), np.int32, chunks=(n,)) if with_id else None
        times = np.empty(steps)
        for k, frame in enumerate(frames):
            with np.load(frame) as data:
                rows = slice(k * n, (k + 1) * n)
                points[rows], velocity[rows], times[k] = data["position"], data["velocity"], data["time"]
                if identity is not None:
                    identity[rows] = data["id"]
        write_vertices(root, n)
        write_steps(root.create_group("Steps"), times, n, ["velocity", "id"] if with_id else ["velocity"])
    os.replace(beside, path)
    return path


def write_vertices(root: Any, n: int) -> None:
    """Every point is a vertex of its own; all moments share one list of them, written once."""
    for name in TOPOLOGIES:
        count = n if name == "Vertices" else 0
        group = root.create_group(name)
        group["NumberOfCells"] = np.array([count])
        group["NumberOfConnectivityIds"] = np.array([count])
        group["Offsets"] = np.arange(count + 1)
        group["Connectivity"] = np.arange(count)


def write_steps(group: Any, times: np.ndarray, n: int, fields: list[str]) -> None:
    """Where in the arrays each moment begins."""
    steps = len(times)
    group.attrs["NSteps"] = steps
    group["Values"] = times
    group["PartOffsets"] = np.zeros(steps, dtype=int)
    group["NumberOfParts"] = np.ones(steps, dtype=int)
    group["PointOffsets"] = np.arange(steps) * n
    group["CellOffsets"] = np.zeros((steps, len(TOPOLOGIES)), dtype=int)
    group["ConnectivityIdOffsets"] = np.zeros((steps, len(TOPOLOGIES)), dtype=int)
    for name in fields:
        group[f"PointDataOffsets/{name}"] = np.arange(steps) * n


def export_surface(frames: list[Path], grid: dict[str, np.ndarray], kind: str, out: Path) -> list[Path]:
    """surface_00000 and so on: the scene's surface, or the heights that its particles have; for ParaView also a list of
    their times. Y is up, as in the run."""
    import pyvista

    if len(grid["z"]) < 2:
        raise NothingToExport("a slice has a line for a surface; export its particles")
    x, z = np.meshgrid(grid["x"], grid["z"], indexing="ij")
    faces = triangles(*x.shape)
    listed = []
    for k, frame in enumerate(frames):
        with np.load(frame) as data:
            if "vertices" in data:
                mesh = pyvista.PolyData.from_regular_faces(data["vertices"], data["triangles"])
                mesh.point_data.active_normals = data["normals"]
            else:
                points = np.stack([x, data["elevation"], z], axis=-1).reshape(-1, 3).astype(np.float32)
                mesh = pyvista.PolyData.from_regular_faces(points, faces)
            listed.append({"name": f"surface_{k:05d}.{kind}", "time": float(data["time"])})
        write(out / str(listed[-1]["name"]), mesh.save)
    if kind == "ply":
        return [out / str(entry["name"]) for entry in listed]
    series = out / "surface.vtp.series"
    series.write_text(json.dumps({"file-series-version": "1.0", "files": listed}, indent=1) + "\n", encoding="utf-8")
    return [series, *(out / str(entry["name"]) for entry in listed)]


def write(path: Path, save: Callable[[Path], None]) -> None:
    """A file that appears whole."""
    beside = path.with_name(f".{path.stem}.tmp{path.suffix}")
    save(beside)
    os.replace(beside, path)
