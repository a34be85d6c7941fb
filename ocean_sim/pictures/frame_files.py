"""Frame files of a run (frames/frame_*.npz), and the arrays that a run saves only once beside them
(frames/grid.npz)."""

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zipfile import BadZipFile
from zlib import error as BadStream

import numpy as np
from numpy.lib.npyio import NpzFile

from ocean_sim.files.input_file import Unreadable, size_of
from ocean_sim.parts import key_of
from ocean_sim.pictures.stage.camera import Track
from ocean_sim.pictures.water.foam import read_cells
from ocean_sim.surface import Mesh

if TYPE_CHECKING:
    from ocean_sim.basin import Basin
    from ocean_sim.basin.ground import Ground
    from ocean_sim.fluid import Fluid
    from ocean_sim.ship import Ship
    from ocean_sim.simulation import Simulation

MAX_FRAME_BYTES = 4_000_000_000  # of a file of frames/, and of what it unpacks to
FREEBOARD_SHARE = 0.12  # height of the drawn walls of a tank over still water, over its depth
PLATE_THICKNESS = 0.02  # of a wavemaker, over half the length of the basin
STILL_SHARE = 0.1  # share of the frames, those with ships most nearly at their mean immersion, for a still picture
MALFORMED_ERRORS = (EOFError, LookupError, ValueError, TypeError, AttributeError, BadZipFile, BadStream)


@contextmanager
def open_frame(path: Path) -> Iterator[NpzFile]:
    """Open a frame file, whose arrays are read on access; raises Unreadable if it is damaged or incomplete."""
    try:
        size_of(path, MAX_FRAME_BYTES)
        with np.load(path) as file:
            if sum(member.file_size for member in file.zip.infolist()) > MAX_FRAME_BYTES:
                raise ValueError
            yield file
    except (OSError, MemoryError, *MALFORMED_ERRORS):
        raise Unreadable(path, "this is not a whole npz file of numbers") from None


def frame_files(folder: Path) -> list[Path]:
    """Paths of all frame files in a run's folder, in the order of time."""
    return sorted((folder / "frames").glob("frame_*.npz"))


def frame_path(folder: Path, number: int) -> Path:
    """Path of the frame file of this number, from 0, in a run's folder."""
    return folder / "frames" / f"frame_{number:05d}.npz"


def ship_keys(file: Iterable[str], ending: str) -> list[str]:
    """Keys of the ships in a frame or grid file: names of its arrays that end in `ending`, less that ending."""
    return [name.removesuffix(ending) for name in file if name.endswith(ending)]


class Frame:
    """Contents of one frame file: heights, foam, ships, wind; particles and surface mesh if the run saved them."""

    def __init__(self, path: Path) -> None:
        with open_frame(path) as file:
            self.time = float(file["time"])
            self.elevation = file["elevation"].astype(np.float64)
            self.answer = file["answer"].astype(np.float64) if "answer" in file else None  # beyond the plane waves [m]
            self.left = file["left"].astype(np.float64) if "left" in file else None  # white by ships and drops
            foam = [file[name].astype(np.float64) for name in ("foam", "left") if name in file]
            self.foam = np.max(foam, axis=0) if foam else None  # share that is white, finer
            self.carried = file["carried"].astype(np.float64) if "carried" in file else None  # its grain, x, z [m]
            self.cover = float(file["cover"]) if "cover" in file else None  # share of the sea that is to be white
            self.drops = file.get("drops", np.zeros((0, 9))).astype(np.float64)  # see `Spray`
            self.origin = file.get("origin", np.zeros(2)).astype(np.float64)  # of all these [m]
            self.position, self.velocity, self.id = (file.get(name) for name in ("position", "velocity", "id"))
            self.ships = {key: (file[f"{key}_position"], file[f"{key}_turn"]) for key in ship_keys(file, "_turn")}
            self.gates = file.get("gates", np.zeros((0, 2, 3))).astype(np.float64)
            self.plate_way = file.get("plate_way", np.zeros(3))  # of a wavemaker [m]
            self.moving_meshes = file.get("moving_meshes", np.zeros((0, 3, 3)))
            empty = (("lines", (0, 2, 3)), ("tails", (0, 3)), ("arrows", (0, 3)))
            drawing = (file.get(f"wind_{name}", np.zeros(shape)) for name, shape in empty)
            self.wind_lines, self.wind_tails, self.wind_arrows = drawing  # as in `wind.Drawing`
            self.wind_strongest = float(file.get("wind_strongest", np.zeros(())))
            self.wind_unit = str(file.get("wind_unit", np.array("")))
            self.mesh = [file[name] for name in ("vertices", "triangles", "normals")] if "vertices" in file else None

    @property
    def place(self) -> np.ndarray:
        """Position (3,) [m] in the world of the origin of the frame's grid of heights, at the still water level."""
        return np.insert(self.origin, 1, 0.0)

    @property
    def folds(self) -> bool:
        """True if the frame has a surface mesh, and this folds over."""
        return self.mesh is not None and Mesh(*self.mesh).folds


def read_elevation(path: Path) -> np.ndarray:
    """Read the water heights (nx, nz) [m] of a frame, and no other array of its file."""
    with open_frame(path) as file:
        return file["elevation"].astype(np.float64)


class FrameLog:
    """Times of all frames of a run so far, and the poses of its ships at these times; loads no other arrays."""

    def __init__(self, files: list[Path]) -> None:
        self.files: list[Path] = []
        self.times = np.zeros(0)
        self.poses: dict[str, list[tuple[np.ndarray, np.ndarray]]] = defaultdict(list)
        self.tracks: dict[str, Track] = {}  # by the key of the ship
        self.grow(files)

    def grow(self, files: list[Path]) -> None:
        """Read times and ship poses of new frame files, and append them."""
        if not files:
            return
        times: list[float] = []
        for path in files:
            with open_frame(path) as file:
                times.append(float(file["time"]))
                for key in ship_keys(file, "_turn"):
                    self.poses[key].append((file[f"{key}_position"].astype(float), file[f"{key}_turn"].astype(float)))
        self.files, self.times = [*self.files, *files], np.append(self.times, times)
        for key, rows in self.poses.items():
            if len(rows) == len(self.times):
                position, turn = (np.array(column) for column in zip(*rows))
                track = self.tracks.setdefault(key, Track(self.times, position, turn))
                track.time, track.position, track.turn = self.times, position, turn

    @property
    def span(self) -> tuple[float, float]:
        """Times of the first and of the last frame [s]."""
        return float(self.times[0]), float(self.times[-1])

    def nearest(self, time: float) -> Path:
        """Path of the frame nearest to a time [s]."""
        return self.files[int(np.abs(self.times - time).argmin())]


def film_frames(times: np.ndarray, every: float, ended: bool = True) -> list[int]:
    """Indices of the frames that a film shows: those nearest to moments `every` [s] apart, from the first of `times`
    [s]. While the run goes on (`ended` False), only those that later frames cannot replace."""
    moments = np.arange(times[0], times[-1] + 0.5 * every, every)
    return [int(np.abs(times - moment).argmin()) for moment in moments if ended or moment <= times[-1]]


def ends_afloat(frame: Frame, grid: Any) -> np.ndarray:
    """Water height [m], and depth under water of the hull's middle line [m], at bow and stern of each ship: (ends, 2).
    `grid`: arrays in the run's grid.npz."""
    ends = [np.zeros((0, 3))]
    for key, (position, turn) in frame.ships.items():
        ends.append(position + np.outer([-0.5, 0.5], np.ptp(grid[f"{key}_vertices"][:, 2]) * turn[:, 2]))
    points, size = np.concatenate(ends), np.maximum(grid["upper"] - grid["lower"], 1e-9)
    level = read_cells(frame.elevation, ((points - frame.place - grid["lower"]) / size)[:, [0, 2]].T)
    return np.stack([level, level - points[:, 1]], axis=1)


def survey_run(files: list[Path], grid: Any) -> tuple[Frame, float]:
    """Frame of `files` for the still picture of a run, and the highest 99th percentile of particle speeds [m/s] in any.
    Of the second half, STILL_SHARE of the frames is eligible: those where water rises at the ships and these float
    nearest to their mean immersion. The one with the highest waves is taken; in a slice, which is coloured by speed,
    that with the largest product of height and speed. `grid`: arrays in grid.npz."""
    waves, speed, ends = [], [0.1], []
    for frame in map(Frame, files):  # one at a time: a frame of a large run is large
        waves.append(float(frame.elevation.std()))
        ends.append(ends_afloat(frame, grid))
        if frame.velocity is not None:
            speed.append(float(np.percentile(np.linalg.norm(frame.velocity, axis=1), 99)))
            waves[-1] *= 1.0 if grid["has_surface"] else speed[-1]
    half, (level, depth) = len(files) // 2, np.moveaxis(np.array(ends), -1, 0)
    chosen = np.arange(half, len(files))
    if depth.size:
        away = np.abs(depth - depth[half:].mean(axis=0)).max(axis=1)
        falls = np.diff(level.mean(axis=1), prepend=-np.inf) <= 0.0
        chosen = chosen[np.lexsort((away[half:], falls[half:]))][: int(np.ceil(STILL_SHARE * len(chosen)))]
    return Frame(files[chosen[np.array(waves)[chosen].argmax()]]), max(speed)


def middle_cell(ships: Collection["Ship"], cell: np.ndarray) -> np.ndarray:
    """Mean position x, z (2,) [m] of ships, rounded to a multiple of the `cell` sides (2,) [m]."""
    middle = np.mean([ship.body.position[[0, 2]] for ship in ships], axis=0)
    return cell * np.round(middle / cell)


def basin_slab(basin: "Basin", axis: int, *ends: float) -> np.ndarray:
    """Corners (2, 3) [m] of a tank's slice between two `ends` [m] on an axis, from the bed to the top of the walls."""
    corners = np.array([basin.lower, basin.upper], dtype=float)
    corners[1, 1], corners[:, axis] = FREEBOARD_SHARE * basin.depth, sorted(ends)
    return corners


def grid_arrays(simulation: "Simulation", x: np.ndarray, z: np.ndarray) -> dict[str, Any]:
    """Arrays that a run saves once: basin with obstacles and wavemakers, plane waves, hulls, x and z [m] of heights."""
    basin, fluid, scene = simulation.basin, simulation.fluid, simulation.scene
    arrays: dict[str, Any] = {
        "x": x,
        "z": z,
        "lower": np.array(basin.lower),
        "upper": np.array(basin.upper),
        "depth": basin.depth,
        "spacing": fluid.spacing,
        "obstacles": np.array(basin.fixed).reshape(-1, 2, 3),
    }
    water = fluid.of_particles if any(side.absorbing for side in basin.sides) else None
    zones = [] if water is None else [basin_slab(basin, *zone[:3]) for zone in water.walls.zones]
    makers = [(side.axis, side.position) for side in basin.sides if side.piston]
    plates = [basin_slab(basin, axis, at, at + PLATE_THICKNESS * at) for axis, at in makers]
    arrays |= {"zones": np.reshape(zones, (-1, 2, 3)), "plates": np.reshape(plates, (-1, 2, 3))}
    if (ground := basin.ground) is not None:
        arrays |= {"ground_x": ground.x, "ground_z": ground.z, "ground_y": ground.y}
    if basin.meshes:
        arrays["meshes"] = basin.mesh_triangles(0.0, moving=False)
    for name, ship in simulation.ships.items():
        drawn, look = ship.drawn(), scene.ships[name].look(scene.preflight)
        if drawn is not None:
            shape: dict[str, Any] = {"vertices": drawn[0], "triangles": drawn[1]}
            if look is not None:  # helm: from the centre of mass in body axes [m]
                helm = ship.points.get("helm", np.zeros(0))
                shape |= {"still_water": look.still_water, "look": look.name, "helm": helm}
            arrays |= {f"{key_of(name)}_{part}": value for part, value in shape.items()}
    open_air = basin.dimension == 3 and (fluid.particles is None or fluid.sound_speed > 0.0)
    return arrays | wave_arrays(fluid) | {"has_surface": open_air}


def kept_ground(grid: Any) -> "Ground | None":
    """Uneven bed, rebuilt from the arrays that a run saves once (`grid`); None if the bed is flat."""
    if "ground_y" not in grid:
        return None
    from ocean_sim.basin.ground import Ground

    x, z, y = (np.asarray(grid[f"ground_{axis}"], dtype=float) for axis in "xzy")
    dimension = 2 if grid["lower"][2] == grid["upper"][2] else 3
    return Ground(x, z, y, float(grid["lower"][1]), dimension, (False, False), no_slip=False)


def wave_arrays(fluid: "Fluid") -> dict[str, np.ndarray]:
    """Arrays of the plane waves of closed-form water, to draw the sea beyond the basin; empty for other water."""
    sea = fluid.plane_waves
    if sea is None:
        return {}
    exact = {"sea_amplitude": sea.amplitude, "sea_wavevector": sea.wavevector, "sea_phase": sea.phase}
    exact["sea_ramp"] = np.array(sea.ramp)
    return exact | ({"sea_answers": np.array(True)} if fluid.can_be_disturbed else {})
