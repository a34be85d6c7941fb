"""Files for ParaView and Blender from the frames of a finished run; nothing here needs OpenGL."""

import json
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from ocean_sim.conventions import Failed
from ocean_sim.files.atomic_file import atomic_write, require_disk_space
from ocean_sim.files.input_file import read_npz
from ocean_sim.files.meshes import Series, save_ply
from ocean_sim.pictures.export import scene_file
from ocean_sim.pictures.export.scene_file import export_shots
from ocean_sim.pictures.frame_files import frame_files

POINT_NAMES = ("particles", "spray")  # of what is exported as points
Moment = tuple[float, np.ndarray, np.ndarray, dict[str, np.ndarray]]  # time [s], points [m], numbers of corners, fields


def export_run(
    folder: Path,
    particles: str | None,
    surface: str | None,
    out: Path,
    every: int = 1,
    *,
    scene: str | None = None,
    z_up: bool = False,
) -> list[Path]:
    """Write every `every`-th frame of a run into the folder `out` and return the files. `particles` (vtkhdf, ply),
    `surface` (ply, vtp, vtkhdf; a mesh of each ship too) and `scene` (usd: everything drawn, glb: water and ships) name
    formats. `z_up`: True for axes with z up. Raises Failed if the run saved no such data."""
    frames = frame_files(folder)[::every]
    if not frames:
        raise Failed(f"{folder} has no frames; run with the observer `frames`")
    grid = read_npz(folder / "frames" / "grid.npz")
    meshes = surface is not None or scene == "glb" or (scene == "usd" and "position" not in read_npz(frames[0]))
    if meshes and len(grid["z"]) < 2:
        raise Failed("in 2-D the surface is a line; export its particles")
    out.mkdir(parents=True, exist_ok=True)
    files = []
    if particles is not None:
        files += export_particles(frames, grid, particles, out, z_up)
    if surface is not None:
        files += export_surface(frames, grid, surface, out, z_up)
    if scene == "usd":
        files.append(scene_file.export_usd(frames, grid, out / "run.usdc", z_up))
    if scene == "glb":
        files.append(scene_file.export_glb(frames, grid, out / "run.glb"))
    return files


def export_particles(
    frames: list[Path], grid: dict[str, np.ndarray], kind: str, out: Path, z_up: bool = False
) -> list[Path]:
    """Write position, velocity, id and pressure of particles to one file (`kind` vtkhdf) or one per frame (ply) in the
    folder `out`; returns the files. `grid`, `z_up`: as in `export_shots`. Raises Failed if frames hold none."""
    if "position" not in read_npz(frames[0]):
        raise Failed("these frames hold no particles; run with frames.particles: true")
    shots = export_shots(frames, grid, z_up)
    return save_moments(out, "particles", kind, (dots_at(shot.time, shot.particles) for shot in shots))


def dots_at(time: float, cloud: dict[str, np.ndarray]) -> Moment:
    """`Moment`, without triangles, of points at a time [s]. `cloud`: `position` (n, 3) [m] and more fields by name."""
    fields = {name: values for name, values in cloud.items() if name != "position"}
    return time, cloud["position"], np.arange(len(cloud["position"]))[:, None], fields


def export_surface(
    frames: list[Path], grid: dict[str, np.ndarray], kind: str, out: Path, z_up: bool = False
) -> list[Path]:
    """Write the water's surface with foam and velocity, ships and gates at each frame, fixed obstacles and bed once,
    into the folder `out`. Returns the files: one per object and frame (`kind` ply, vtp) or per object (vtkhdf). `grid`,
    `z_up`: as in `export_shots`."""
    files: dict[str, list[Moment]] = {"surface": []}
    drawn = {key: model.mesh for key, model in scene_file.ship_models(grid).items()}
    for shot in export_shots(frames, grid, z_up):
        files["surface"].append((shot.time, shot.points, shot.faces, shot.fields))
        if len(shot.gates[0]) or "gates" in files:
            files.setdefault("gates", []).append((shot.time, *shot.gates, {}))
        if len(shot.spray["position"]) or "spray" in files:
            files.setdefault("spray", []).append(dots_at(shot.time, shot.spray))
        for key, mesh in drawn.items():
            position, turn = shot.ships[key]
            corners = mesh.corners.reshape(-1, 3)
            points = (corners @ turn.T + position).astype(np.float32)
            numbers = np.arange(len(corners)).reshape(-1, 3)
            shown = np.clip(mesh.colour, 0.0, 1.0) ** (1.0 / 2.2)  # display RGB
            colour = (255.0 * np.repeat(shown, 3, axis=0)).astype(np.uint8)
            normals = (mesh.normals.reshape(-1, 3) @ turn.T).astype(np.float32)
            name = scene_file.file_name(key)
            files.setdefault(name, []).append((shot.time, points, numbers, {"Normals": normals, "RGB": colour}))
    turn, first = scene_file.Z_UP if z_up else np.eye(3), files["surface"][0][0]
    for name, points, faces, _ in scene_file.fixed_bodies(grid):
        files[name] = [(first, (points @ turn.T).astype(np.float32), faces, {})]
    made = []
    for name, moments in files.items():
        made += save_moments(out, name, kind, moments)
    return made


def save_moments(out: Path, name: str, kind: str, moments: Iterable[Moment]) -> list[Path]:
    """Write one object, a mesh or (if `name` is one of POINT_NAMES) points alone, at several times to files called
    `name` in the folder `out`, in the format `kind`; returns the files."""
    solid = name not in POINT_NAMES
    if kind == "vtkhdf":
        path = out / f"{name}.vtkhdf"
        with atomic_write(path) as draft, Series(draft, "Polygons" if solid else "Vertices") as series:
            for time, points, faces, fields in moments:
                series.add(time, points, faces, **fields)
        return [path]
    files, listed = [], []
    for k, (time, points, faces, fields) in enumerate(moments):
        files.append(save_mesh(out / f"{name}_{k:05d}.{kind}", points, faces if solid else None, fields))
        listed.append({"name": files[-1].name, "time": time})
    if kind == "ply":
        return files
    index = out / f"{name}.vtp.series"
    with atomic_write(index) as draft:
        draft.write_text(json.dumps({"file-series-version": "1.0", "files": listed}, indent=1) + "\n", encoding="utf-8")
    return [index, *files]


def save_mesh(path: Path, points: np.ndarray, faces: np.ndarray | None, fields: dict[str, np.ndarray]) -> Path:
    """Write one mesh, or points alone if `faces` is None, in the format of the path's ending; returns the path.
    `fields`: values at the points, by name."""
    if path.suffix == ".ply":
        return save_ply(path, points, faces, fields)
    import pyvista

    mesh = pyvista.PolyData(points) if faces is None else pyvista.PolyData.from_regular_faces(points, faces)
    for name, values in fields.items():
        mesh.point_data[name] = values
    if "Normals" in fields:
        mesh.point_data.active_normals = fields["Normals"]
    with atomic_write(path) as draft:
        require_disk_space(draft, 2 * 1024 * mesh.actual_memory_size)  # VTK goes on where it cannot write
        mesh.save(draft)
    return path
