"""Everything drawn of a run in one file (USD, glTF), for Blender, Houdini, Unreal and browsers: water with foam and
velocity, wakes, the ships' own waves and foam along their hulls, moving ships, particles."""

from collections.abc import Iterator
from errno import EIO
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np

from ocean_sim.basin.points import grid_points, middles_of
from ocean_sim.conventions import Lacking
from ocean_sim.files.atomic_file import atomic_write
from ocean_sim.files.input_file import read_npz
from ocean_sim.files.meshes import Glb
from ocean_sim.pictures.frame_files import Frame, FrameLog, frame_files, kept_ground, ship_keys
from ocean_sim.pictures.ships.ship_model import ShipModel, kept_model
from ocean_sim.pictures.stage.camera import Vessel
from ocean_sim.pictures.stage.obstacles import SAND_COLOUR
from ocean_sim.pictures.water.foam import cell_means, read_cells
from ocean_sim.pictures.water.sea_state import is_open_sea, run_scene
from ocean_sim.pictures.water.waterline import Hull, WettedHull, kelvin_height, limited_answer
from ocean_sim.surface import Mesh, sheet

# Linear RGB of water and of its foam
WATER_COLOUR, FOAM_COLOUR = np.array([0.010, 0.060, 0.090]), np.array([0.75, 0.80, 0.82])
STONE_COLOUR = np.array([0.16, 0.15, 0.14])  # linear RGB of what stands in the water
NEAREST_PARTICLES = 6  # particles that tell the velocity of a surface with an underside
Z_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])  # from our axes, y up


class RunWakes:
    """Waves and foam of ships to add to a run's water, which is too coarse for them; nothing is added in a tank."""

    def __init__(self, files: list[Path], grid: dict[str, np.ndarray]) -> None:
        keys = ship_keys(grid, "_vertices")
        tracks = FrameLog(files).tracks if keys and shows_sea(files, float(grid["depth"])) else {}
        self.grid, self.x, self.z = grid, grid["x"], grid["z"]
        self.hulls = {key: Hull(grid, key) for key in keys if key in tracks}
        self.vessels = {key: Vessel(hull.length, np.zeros(3), tracks[key]) for key, hull in self.hulls.items()}
        self.answers = "sea_answers" in grid  # the water of the run knows of its ships

    def water_with_ships(self, frame: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Water heights (nx, nz) [m] and, on a finer grid, foam shares of a frame, with ships' waves and foam added."""
        height, white = frame["elevation"].astype(float), np.maximum(frame["foam"], frame.get("left", 0.0))
        if not self.vessels:
            return height, white
        time, origin = float(frame["time"]), frame.get("origin", np.zeros(2)).astype(float)
        points = grid_points(self.x + origin[0], self.z + origin[1])
        height += self.wave_heights(time, points, frame.get("answer"))
        if not self.answers:
            for ship in self.wetted_hull(frame, height, origin):
                height += ship.bow_wave_height(points).reshape(height.shape)
        x, z = (middles_of(*self.sides(k), white.shape[k]) for k in range(2))
        for ship in self.wetted_hull(frame, height, origin):
            low, high = (ends - origin for ends in ship.foam_area())
            near = np.ix_((x > low[0]) & (x < high[0]), (z > low[1]) & (z < high[1]))
            along = ship.white(grid_points(x[near[0].ravel()] + origin[0], z[near[1].ravel()] + origin[1]))
            white[near] = np.maximum(white[near], along.reshape(white[near].shape))
        return height, white

    def sides(self, k: int) -> tuple[float, float]:
        """Lower and upper limit [m] of the basin along x (k = 0) or z (k = 1)."""
        return float(self.grid["lower"][2 * k]), float(self.grid["upper"][2 * k])

    def relative_positions(self, at: np.ndarray, origin: np.ndarray) -> np.ndarray:
        """Positions of points `at` x, z (n, 2) [m] as shares (2, n), 0 to 1, of a basin with its middle at `origin`."""
        low, high = np.transpose([self.sides(k) for k in range(2)])
        return ((at - origin - low) / (high - low)).T

    def wetted_hull(self, frame: dict[str, np.ndarray], height: np.ndarray, origin: np.ndarray) -> list[WettedHull]:
        """Hulls that touch the water in a frame. `height` (nx, nz): of water [m]; `origin`: x, z of the basin [m]."""
        time, ships = float(frame["time"]), []
        for key, hull in self.hulls.items():
            pose = frame[f"{key}_position"], frame[f"{key}_turn"], self.vessels[key].speed(time)
            ships.append(hull.wetted_hull(*pose, lambda at: read_cells(height, self.relative_positions(at, origin))))
        return [ship for ship in ships if ship.wet]

    def wave_heights(self, time: float, points: np.ndarray, answer: np.ndarray | None) -> np.ndarray:
        """Height (nx, nz) [m] to add to the run's water at a time [s] for ship waves (not bow waves), at points x, z
        (nx nz, 2) [m]. `answer`: heights [m] that its ships raise, or None; `limited_answer` cuts them near a ship."""
        shape = len(self.x), len(self.z)
        more = np.zeros(shape)
        if answer is not None:
            x, z = points[:: shape[1], 0], points[: shape[1], 1]
            shown = answer.astype(float)
            for key, vessel in self.vessels.items():
                shown = limited_answer(shown, vessel, self.hulls[key].beam, x, z, time)
            more += shown - answer
        if "sea_amplitude" in self.grid and not self.answers:
            for key, vessel in self.vessels.items():
                more += kelvin_height(vessel, self.hulls[key].beam, time, points).reshape(shape)
        return more


def shows_sea(files: list[Path], depth: float) -> bool:
    """True if pictures of a run with these frames show an open sea, not a tank; `depth`: of the water [m]."""
    first = Frame(files[0])
    return not first.folds and is_open_sea(run_scene(files[0].parent.parent), first, depth)


class ExportShot(NamedTuple):
    """Frame to export: time, water mesh, ships, particles, spray, and gates (obstacles that move or leave)."""

    time: float  # [s]
    points: np.ndarray  # (n, 3) of the surface of the water [m]
    faces: np.ndarray  # (m, 3)
    fields: dict[str, np.ndarray]  # values of the points: Normals, foam, velocity [m/s]
    ships: dict[str, tuple[np.ndarray, np.ndarray]]  # position [m] and turn from body to world, by key
    particles: dict[str, np.ndarray]  # position [m], velocity [m/s], pressure [Pa]
    gates: tuple[np.ndarray, np.ndarray]  # corners [m] and triangles of obstacles that move or leave
    spray: dict[str, np.ndarray]  # position [m], velocity [m/s] and spread [m] of parcels, radius and count of drops


def read_shot(frame: Path, grid: dict[str, np.ndarray], wakes: RunWakes) -> ExportShot:
    """Read a frame to export; ship waves and foam are added at sea. `grid`: arrays that the run saves once."""
    data = read_npz(frame)
    raised = np.zeros(data["elevation"].shape)
    if "foam" in data and len(grid["z"]) > 1:
        height, data["foam"] = wakes.water_with_ships(data)
        raised, data["elevation"] = height - data["elevation"], height
    fields: dict[str, np.ndarray] = {}
    if len(grid["z"]) < 2:  # a line
        points, faces = np.zeros((0, 3), np.float32), np.zeros((0, 3), int)
    elif "vertices" in data:
        points, faces, fields["Normals"] = data["vertices"], data["triangles"], data["normals"]
        if not Mesh(points, faces, data["normals"]).folds:
            at = wakes.relative_positions(points[:, [0, 2]], data.get("origin", np.zeros(2)))
            if raised.any():
                points = points + np.outer(read_cells(raised, at), [0.0, 1.0, 0.0])
                areas = Mesh(points, faces, points).vertex_areas  # more than none, as no triangle is upright
                fields["Normals"] = (areas / np.linalg.norm(areas, axis=1, keepdims=True)).astype(np.float32)
            fields |= {
                name: read_cells(data[key], at).astype(np.float32)
                for name, key in (("foam", "foam"), ("velocity", "surface_velocity"))
                if key in data
            }
        elif "velocity" in data:
            fields["velocity"] = values_beside(points, data["position"], data["velocity"]).astype(np.float32)
    else:
        dx, dz = data.get("origin", np.zeros(2))
        level = sheet(grid["x"] + dx, grid["z"] + dz, data["elevation"])
        points, faces = level.vertices.astype(np.float32), level.triangles
        fields["Normals"] = level.normals.astype(np.float32)
        if "foam" in data:
            fields["foam"] = cell_means(data["foam"], data["elevation"].shape).ravel().astype(np.float32)
        if "surface_velocity" in data:
            fields["velocity"] = data["surface_velocity"].reshape(-1, 3).astype(np.float32)
    ships = {key: (data[f"{key}_position"], data[f"{key}_turn"]) for key in ship_keys(data, "_turn")}
    kept = "position", "velocity", "id", "pressure"
    particles = {str(name): data[name] for name in kept if name in data}
    gates = box_mesh(data["gates"] if "gates" in data else np.zeros((0, 2, 3)))
    drops = data["drops"] if "drops" in data else np.zeros((0, 9), np.float32)
    spray = {"position": drops[:, :3], "velocity": drops[:, 3:6]}
    spray |= dict(zip(("radius", "count", "spread"), drops[:, 6:].T, strict=True))
    return ExportShot(float(data["time"]), points, faces, fields, ships, particles, gates, spray)


def export_shots(frames: list[Path], grid: dict[str, np.ndarray], z_up: bool = False) -> Iterator[ExportShot]:
    """Yield the contents of frames to export, with z up if `z_up`; `grid`: arrays that the run saves once."""
    wakes = RunWakes(frame_files(frames[0].parent.parent), grid)
    for frame in frames:
        kept = read_shot(frame, grid, wakes)
        if z_up:
            fields, particles, spray = (
                {name: values @ Z_UP.T if values.ndim == 2 else values for name, values in of.items()}
                for of in (kept.fields, kept.particles, kept.spray)
            )
            ships = {key: (Z_UP @ position, Z_UP @ turn) for key, (position, turn) in kept.ships.items()}
            gates = kept.gates[0] @ Z_UP.T, kept.gates[1]
            kept = ExportShot(kept.time, kept.points @ Z_UP.T, kept.faces, fields, ships, particles, gates, spray)
        yield kept


def values_beside(points: np.ndarray, particles: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Values (n, 3) at surface points (n, 3) [m]: distance-weighted means of `values` (m, 3) of nearby particles."""
    from scipy.spatial import cKDTree

    away, who = cKDTree(particles).query(points, k=min(NEAREST_PARTICLES, len(particles)))
    away, who = away.reshape(len(points), -1), who.reshape(len(points), -1)
    weight = 1.0 / np.maximum(away, 1e-6) ** 2
    return np.einsum("nk,nkc->nc", weight / weight.sum(axis=1, keepdims=True), values[who])


def ship_models(grid: dict[str, np.ndarray]) -> dict[str, ShipModel]:
    """Ship models to draw, by ship key; `grid`: arrays that the run saves once."""
    return {key: kept_model(grid, key) for key in ship_keys(grid, "_look")}


def box_mesh(boxes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corners (8 k, 3) [m] and triangles (12 k, 3) of k boxes, given by lower and upper corners (k, 2, 3) [m]."""
    from trimesh.creation import box

    shapes = [box(bounds=ends) for ends in boxes]
    points, faces = [shape.vertices for shape in shapes], [shape.faces + 8 * n for n, shape in enumerate(shapes)]
    return np.array(points, np.float32).reshape(-1, 3), np.array(faces, int).reshape(-1, 3)


def fixed_bodies(grid: dict[str, np.ndarray]) -> Iterator[tuple[str, np.ndarray, np.ndarray, np.ndarray]]:
    """Yield name, corners (n, 3) [m], triangles (m, 3) and linear RGB (3,): of fixed obstacles, and of a bed if not
    flat. `grid`: arrays that the run saves once."""
    if len(grid["obstacles"]):
        yield "obstacles", *box_mesh(grid["obstacles"]), STONE_COLOUR
    if (ground := kept_ground(grid)) is not None:
        corners = ground.body_mesh(float(grid["spacing"]))[0].reshape(-1, 3).astype(np.float32)
        yield "ground", corners, np.arange(len(corners)).reshape(-1, 3), SAND_COLOUR


def file_name(key: str) -> str:
    """Name of a ship in an exported file: her key, with underscores for all but letters and digits."""
    return "".join(letter if letter.isalnum() else "_" for letter in key)


def frame_rate(first: float, last: float, count: int, every: float) -> float:
    """Frames per second of an export of `count` frames from `first` to `last` [s]. `every`: interval [s] of the run's
    frames, of which the export may skip some."""
    if count < 2:
        return 24.0
    apart = (last - first) / (count - 1)
    return round(1.0 / (every * max(1, round(apart / every))), 3)


def export_usd(frames: list[Path], grid: dict[str, np.ndarray], path: Path, z_up: bool) -> Path:
    """Write `frames` as a USD file (usdc) with time samples in metres and return its path. It holds /sea/water,
    obstacles, ground, gates, particles, spray, and /sea/NAME of each ship. `grid`, `z_up`: as in `export_shots`. Raises
    Lacking without the package usd-core."""
    try:
        from pxr import Gf, Sdf, Tf, Usd, UsdGeom, Vt
    except ImportError:
        raise Lacking("USD files need the package usd-core: pip install 'ocean-sim[usd]'") from None
    first, last = (float(read_npz(frame)["time"]) for frame in (frames[0], frames[-1]))
    per_second = frame_rate(first, last, len(frames), float(grid["every"]))
    with atomic_write(path) as draft:
        stage = Usd.Stage.CreateInMemory()
        UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z if z_up else UsdGeom.Tokens.y)
        UsdGeom.SetStageMetersPerUnit(stage, 1.0)
        stage.SetTimeCodesPerSecond(per_second)
        stage.SetFramesPerSecond(per_second)
        stage.SetStartTimeCode(first * per_second)
        stage.SetEndTimeCode(last * per_second)
        root = UsdGeom.Xform.Define(stage, "/sea")
        stage.SetDefaultPrim(root.GetPrim())
        if z_up:
            root.AddRotateXOp().Set(90.0)
        for name, points, faces, colour in fixed_bodies(grid):
            still = UsdGeom.Mesh.Define(stage, f"/sea/{name}")
            still.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points))
            set_triangles(still, faces.astype(np.int32).ravel(), Vt)
            still.CreateDisplayColorPrimvar(UsdGeom.Tokens.constant).Set([Gf.Vec3f(*colour.tolist())])
        bodies = {}
        for key, model in ship_models(grid).items():
            body = UsdGeom.Xform.Define(stage, f"/sea/{file_name(key)}")
            bodies[key] = body.AddTransformOp()
            corners = model.mesh.corners.reshape(-1, 3).astype(np.float32)
            hull = UsdGeom.Mesh.Define(stage, f"/sea/{file_name(key)}/hull")
            hull.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(corners))
            set_triangles(hull, np.arange(len(corners), dtype=np.int32), Vt)
            hull.CreateNormalsAttr(Vt.Vec3fArray.FromNumpy(model.mesh.normals.reshape(-1, 3).astype(np.float32)))
            paint = Vt.Vec3fArray.FromNumpy(model.mesh.colour.astype(np.float32))
            hull.CreateDisplayColorPrimvar(UsdGeom.Tokens.uniform).Set(paint)
        water = UsdGeom.Mesh.Define(stage, "/sea/water")
        water.CreateDisplayColorPrimvar(UsdGeom.Tokens.constant).Set([Gf.Vec3f(*WATER_COLOUR.tolist())])
        moving, clouds = None, dict[str, Any]()
        numbers = Sdf.ValueTypeNames.FloatArray, UsdGeom.Tokens.vertex
        before: np.ndarray | None = None
        for kept in export_shots(frames, grid):
            code = Usd.TimeCode(kept.time * per_second)
            if before is None or not np.array_equal(before, kept.faces):
                set_triangles(water, kept.faces.astype(np.int32).ravel(), Vt, code)
                before = kept.faces
            water.CreatePointsAttr().Set(Vt.Vec3fArray.FromNumpy(kept.points.astype(np.float32)), code)
            if "velocity" in kept.fields:
                water.CreateVelocitiesAttr().Set(Vt.Vec3fArray.FromNumpy(kept.fields["velocity"]), code)
            if "foam" in kept.fields:
                foam = UsdGeom.PrimvarsAPI(water).CreatePrimvar("foam", *numbers)
                foam.Set(Vt.FloatArray.FromNumpy(kept.fields["foam"]), code)
            if len(kept.gates[0]) or moving is not None:
                moving = moving or UsdGeom.Mesh.Define(stage, "/sea/gates")
                set_triangles(moving, kept.gates[1].astype(np.int32).ravel(), Vt, code)
                moving.CreatePointsAttr().Set(Vt.Vec3fArray.FromNumpy(kept.gates[0]), code)
                moving.CreateDisplayColorPrimvar(UsdGeom.Tokens.constant).Set([Gf.Vec3f(*STONE_COLOUR.tolist())])
            for key, (position, turn) in kept.ships.items():
                if key in bodies:
                    matrix = np.eye(4)
                    matrix[:3, :3], matrix[3, :3] = turn.T, position  # USD's vectors are rows
                    bodies[key].Set(Gf.Matrix4d(*matrix.ravel().tolist()), code)
            for name, cloud in (("particles", kept.particles), ("spray", kept.spray)):
                if name not in clouds and len(cloud.get("position", ())) == 0:
                    continue
                dots = clouds.setdefault(name, UsdGeom.Points.Define(stage, f"/sea/{name}"))
                dots.CreatePointsAttr().Set(Vt.Vec3fArray.FromNumpy(cloud["position"].astype(np.float32)), code)
                dots.CreateVelocitiesAttr().Set(Vt.Vec3fArray.FromNumpy(cloud["velocity"].astype(np.float32)), code)
                if "id" in cloud:
                    dots.CreateIdsAttr().Set(Vt.Int64Array.FromNumpy(cloud["id"].astype(np.int64)), code)
                if "spread" in cloud:
                    dots.CreateWidthsAttr().Set(Vt.FloatArray.FromNumpy(2.0 * cloud["spread"].astype(np.float32)), code)
                for key in (name for name in ("pressure", "radius", "count") if name in cloud):
                    value = UsdGeom.PrimvarsAPI(dots).CreatePrimvar(key, *numbers)
                    value.Set(Vt.FloatArray.FromNumpy(cloud[key].astype(np.float32)), code)
        if "particles" in clouds:
            clouds["particles"].CreateWidthsAttr([float(grid["spacing"])])
            clouds["particles"].SetWidthsInterpolation(UsdGeom.Tokens.constant)
        made = draft.with_suffix(".usdc")  # the writer knows formats by their endings
        try:
            stage.Export(str(made))
        except Tf.ErrorException:  # a page of the writer's own words
            raise OSError(EIO, "USD cannot write this file, as on a full disk", str(path)) from None
        made.replace(draft)
    return path


def set_triangles(mesh: Any, corners: np.ndarray, vt: ModuleType, *at: Any) -> None:
    """Set a USD mesh's triangles from vertex numbers `corners` (3 m,). `vt`: USD's module of arrays; `at`: time code
    from which they hold; without one they hold always."""
    mesh.CreateFaceVertexCountsAttr().Set(vt.IntArray.FromNumpy(np.full(len(corners) // 3, 3, np.int32)), *at)
    mesh.CreateFaceVertexIndicesAttr().Set(vt.IntArray.FromNumpy(corners), *at)
    mesh.CreateSubdivisionSchemeAttr("none")


def export_glb(frames: list[Path], grid: dict[str, np.ndarray], path: Path) -> Path:
    """Write water, obstacles, bed and moving ships as binary glTF and return the path. The water is one deforming mesh,
    coloured by the first frame, or one per frame if its triangles change. `grid`: as in `export_shots`."""
    from scipy.spatial.transform import Rotation

    shots = list(export_shots(frames, grid))
    first = shots[0]
    made = Glb(np.array([kept.time for kept in shots]))
    if any(not np.array_equal(kept.faces, first.faces) for kept in shots):
        waters = {k: made.mesh(f"water_{k:05d}", w.points, w.faces, water_colours(w)) for k, w in enumerate(shots)}
        made.show_at_moments(waters, len(shots))
    elif len(first.points):
        moved = np.stack([kept.points for kept in shots]) if len(shots) > 1 else None
        made.mesh("water", first.points, first.faces, water_colours(first), moved)
    for name, points, faces, colour in fixed_bodies(grid):
        made.mesh(name, points, faces, colour)
    gates = {k: kept.gates for k, kept in enumerate(shots) if len(kept.gates[0])}
    drawn = {k: made.mesh(f"gates_{k:05d}", *gate, STONE_COLOUR) for k, gate in gates.items()}
    made.show_at_moments(drawn, len(shots))
    for key, model in ship_models(grid).items():
        corners = model.mesh.corners.reshape(-1, 3)
        colour = np.repeat(model.mesh.colour, 3, axis=0)
        node = made.mesh(file_name(key), corners, np.arange(len(corners)).reshape(-1, 3), colour)
        poses = [kept.ships[key] for kept in shots]
        made.animate(node, "translation", np.array([position for position, _ in poses]))
        turns = Rotation.from_matrix([turn for _, turn in poses]).as_quat()
        back = (turns[1:] * turns[:-1]).sum(axis=1) < 0.0  # a ship turns the short way between two moments
        made.animate(node, "rotation", turns * np.cumprod([1.0, *np.where(back, -1.0, 1.0)])[:, None])
    made.save(path)
    return path


def water_colours(kept: ExportShot) -> np.ndarray:
    """Linear RGB (n, 3) at the water points of `kept`, a frame to export; the more foam, the whiter."""
    return WATER_COLOUR + kept.fields.get("foam", np.zeros(len(kept.points)))[:, None] * (FOAM_COLOUR - WATER_COLOUR)
