"""Frames for pictures and exports: particles, height and surface of the water, and poses of ships, one file a frame.
The names of a ship's arrays begin with the key of the ship."""

from collections.abc import Sequence
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ocean_sim import waves
from ocean_sim.basin import shifts
from ocean_sim.basin.points import grid, grid_points, grid_size
from ocean_sim.conventions import GRAVITY
from ocean_sim.files.atomic_file import write_file
from ocean_sim.model import Faults, quantity
from ocean_sim.observers.shared.csv_rows import Multiples
from ocean_sim.parts import PeriodicConfig, SceneFacts, key_of
from ocean_sim.pictures.frame_files import grid_arrays, middle_cell
from ocean_sim.pictures.live.scene_lines import surface_heights
from ocean_sim.pictures.water import foam, spray
from ocean_sim.pictures.water.far_sea import wind_speed_from_sea
from ocean_sim.pictures.water.sea_state import gust_speed, wind_heading
from ocean_sim.pictures.water.waterline import STERN_DISTANCE, Hull, ship_coordinates
from ocean_sim.simulation import Observer, Simulation
from ocean_sim.waves.orbits import surface_fall

if TYPE_CHECKING:
    from ocean_sim.fluid import Snapshot
    from ocean_sim.surface import Mesh


SURFACE_FIELDS = 6 + 2 * foam.FLECKS_PER_CELL**2  # elevation, displacement of foam, velocity; two kinds of foam
BYTES_PER_PARTICLE = 32  # position, velocity, id and pressure
FOAM_LEAD_SECONDS = 2.0 * foam.FADE_SECONDS  # of sea before a run begins, from which its first foam comes
FOAM_LEAD_STEP = 0.25  # [s] between two moments of it
FOAM_LAYER_DEPTH = 1.2  # [spacings] under the surface, of the particles that carry foam
WAKE_SECONDS = 7.0  # [s] in which foam that ships and drops leave falls to a third
WAKE_WHITENESS, WHITEST_SPEED = 0.8, 4.0  # of a wake at most, and the speed [m/s] of a ship from which it is so white
WAKE_POINTS = 4, 12  # along and across the way of a stern between two frames, at which it whitens the water
LANDING_CELLS = 5  # cells of heights, the lowest of which is that on which drops among particles fall
MAX_POINTS = 20_000_000  # of a frame
WARNING_BYTES = 2.0e9  # of all frames


class Config(PeriodicConfig):
    turn: ClassVar[int] = 1
    leaves: ClassVar[str] = "frames/grid.npz, frames/frame_*.npz"
    every: float = quantity("s", 0.033, gt=0.0)
    """Simulated time between frames; a frame is the first state at or after it."""
    spacing: float | None = quantity("m", None, gt=0.0)
    """Distance of the points at which the height of the water is kept; by default the spacing of the particles, or
    a sixteenth of the wave where there are none."""
    particles: bool = True
    """Keep the positions and velocities of the particles, which `export` and pictures of particles need."""

    def point_count(self, preflight: SceneFacts) -> int:
        """Number of grid points at which a frame stores the height of the water."""
        return grid_size(preflight.tank, self.spacing or preflight.fluid.point_spacing(preflight))

    def mismatches(self, preflight: SceneFacts) -> Faults:
        if (points := self.point_count(preflight)) > MAX_POINTS:
            many = f"a frame would keep {points:.3g} heights, at most {MAX_POINTS:g}"
            yield ("spacing",), f"{many}; give a larger one [m]"

    def warnings(self, preflight: SceneFacts) -> list[str]:
        kept = preflight.particles if self.particles else 0
        frame = 4 * SURFACE_FIELDS * self.point_count(preflight) + BYTES_PER_PARTICLE * kept
        size = frame * (preflight.duration / self.every + 1.0)
        if size < WARNING_BYTES:
            return []
        cure = "; frames.particles: false keeps only the surface" if kept else ""
        return [f"frames: about {size / 1e9:.1f} GB on disk at one frame every {self.every:g} s{cure}"]


class Frames(Observer, of=Config):
    """Writes frames/grid.npz once, then frames/frame_00000.npz and so on, at intervals, each by an atomic write."""

    def __init__(self, config: Config, folder: Path, simulation: Simulation) -> None:
        self.config, self.every = config, config.every
        self.folder = folder / "frames"
        self.folder.mkdir(exist_ok=True)
        self.multiples = Multiples(config.every)
        self.count = 0
        basin, fluid = simulation.basin, simulation.fluid
        x, z = grid(basin, config.spacing or fluid.spacing)
        self.shape = (len(x), len(z))
        self.points = grid_points(x, z)
        self.cell = np.array([x[1] - x[0], z[1] - z[0] if len(z) > 1 else fluid.spacing])  # [m]
        arrays = grid_arrays(simulation, x, z)
        self.white = foam.FoamField(self.shape, self.cell) if arrays["has_surface"] else None
        self.left = foam.FoamField(self.shape, self.cell, WAKE_SECONDS, fine=False)  # by sterns and drops
        self.spray = spray.Spray(simulation.scene.seed, basin.dimension)
        self.wind_speed = simulation.scene.wind.strongest
        stated = simulation.scene.resolved()
        self.gust_speed, angle = gust_speed(stated), wind_heading(stated, fluid.plane_waves)
        self.wind_ahead = np.array([np.cos(angle), np.sin(angle)]) * self.spray.axes[[0, 2]]
        self.before = np.zeros(2)  # origin of the frame before [m]
        self.ships = [ship for name, ship in simulation.ships.items() if f"{key_of(name)}_vertices" in arrays]
        self.hulls = [Hull(arrays, key_of(ship.name)) for ship in self.ships]
        self.sizes = [np.array([hull.beam, hull.length]) for hull in self.hulls]  # [m]
        ends = [hull.vertices[hull.vertices[:, 2] > hull.bounds[1, 2] - 0.05 * hull.length] for hull in self.hulls]
        self.stems = [of[of[:, 1].argmin()] * [0.0, 1.0, 1.0] for of in ends]  # feet, body axes [m]
        self.write("grid", every=config.every, **arrays)

    def observe(self, simulation: Simulation) -> None:
        if not self.multiples.reached(simulation.time):
            return
        particles = simulation.fluid.particles
        seen = self.config.particles or self.white is not None
        snapshot = particles.snapshot() if particles is not None and seen else None
        sea = simulation.fluid.plane_waves if simulation.fluid.can_be_disturbed else None
        origin = np.zeros(2) if sea is None else self.origin()
        points = self.points + origin
        frame: dict[str, np.ndarray] = {"elevation": surface_heights(simulation, points).reshape(self.shape)}
        if sea is not None:
            known = waves.elevation(sea, points, simulation.time).reshape(self.shape)
            frame |= {"answer": frame["elevation"] - known, "origin": origin}
        if self.white is not None:
            frame |= self.foam_arrays(simulation, points, frame["elevation"], snapshot)
        elif (foam_share := simulation.fluid.foam(points)) is not None:
            frame["foam"] = foam_share.reshape(self.shape)
        elif snapshot is not None and simulation.basin.dimension == 2:
            place = np.insert(points, 1, frame["elevation"].ravel(), axis=1).reshape(*self.shape, 3)
            frame["drops"] = self.fly_drops(simulation, place, np.zeros_like(place), snapshot, self.wind_speed)
        if simulation.surface is not None:
            mesh = simulation.surface.mesh()
            if origin.any():
                mesh = move_triangles(mesh, origin, simulation.basin.periods)
            frame |= {"vertices": mesh.vertices, "triangles": mesh.triangles, "normals": mesh.normals}
        wind = simulation.wind.drawing()
        if len(wind.tails):
            frame |= {"wind_lines": wind.lines, "wind_tails": wind.tails, "wind_arrows": wind.arrows}
            frame |= {"wind_strongest": np.array(wind.strongest), "wind_unit": np.array(wind.unit)}
        if (piston := simulation.basin.piston) is not None:
            frame["plate_way"] = piston.at(simulation.time)[0] * np.eye(3)["xyz".index(piston.maker.wall[0])]
        if simulation.basin.gates:
            frame["gates"] = np.array(simulation.basin.gates_at(simulation.time)).reshape(-1, 2, 3)
            if simulation.basin.meshes:
                frame["moving_meshes"] = simulation.basin.mesh_triangles(simulation.time, moving=True)
        for ship in self.ships:
            key = key_of(ship.name)
            frame |= {f"{key}_position": ship.body.position, f"{key}_turn": ship.body.matrix}  # body to world
        if self.config.particles and snapshot is not None:
            x = snapshot.position
            frame |= snapshot._asdict()
            frame["position"] = x + shifts(x, origin, simulation.basin.periods) if origin.any() else x
        single = {key: array.astype(np.float32, copy=False) for key, array in frame.items() if array.dtype.kind == "f"}
        self.write(f"frame_{self.count:05d}", time=simulation.time, **frame | single)
        self.count += 1

    def foam_arrays(
        self, simulation: Simulation, points: np.ndarray, elevation: np.ndarray, snapshot: "Snapshot | None"
    ) -> dict[str, np.ndarray]:
        """Foam arrays of a frame, by name: shares of white water, displacement of the foam's texture [m], surface
        velocity [m/s], drops and, unless the water models foam, the share that breaking crests should whiten. `points`
        (n, 2): x, z [m]; `elevation` (nx, nz): heights [m] there; `snapshot`: particles, or None."""
        assert self.white is not None
        origin = points[0] - self.points[0]
        for field in (self.white, self.left):
            field.shift(np.round((origin - self.before) / self.cell))
        self.before = origin
        made = simulation.fluid.foam(points)
        if made is None and not self.white.started:
            self.whiten_past_sea(simulation, points)
        if snapshot is None:
            velocity = simulation.fluid.surface_velocities(points).reshape(*self.shape, 3)
        else:
            top = elevation - FOAM_LAYER_DEPTH * simulation.fluid.spacing
            velocity = topmost_velocity(snapshot, points, top, simulation.basin.periods)
        sea = simulation.fluid.plane_waves
        wind = self.wind_speed or (0.0 if sea is None else wind_speed_from_sea(sea, simulation.time))
        if made is None:
            due = self.white.due(simulation.time)
            crests = self.breaking_heights(simulation, points, elevation, origin) if due else None
            self.advance_foam(simulation.time, crests, velocity, wind)
        else:
            self.white.advance(simulation.time, velocity[..., [0, 2]], made.reshape(self.shape))
        self.leave_wakes(simulation.time, points[0], velocity[..., [0, 2]])
        place = np.insert(points, 1, elevation.ravel(), axis=1).reshape(*self.shape, 3)
        drops = self.fly_drops(simulation, place, velocity, snapshot, wind)
        shown = {"drops": drops, "left": self.left.white, "foam": self.white.white, "carried": self.white.carried}
        shown["surface_velocity"] = velocity
        return shown | ({} if made is not None else {"cover": np.array(self.white.cover)})

    def leave_wakes(self, time: float, low: np.ndarray, velocity: np.ndarray) -> None:
        """Advance the foam of ships' wakes to a `time` [s]: carry it with the surface `velocity` (nx, nz, 2) [m/s], and
        add new foam where sterns have passed since the last call. `low` (2,): x, z [m] of the first grid point."""
        step = time - self.left.time
        self.left.advance(time, velocity, None)
        for ship, (breadth, length) in zip(self.ships, self.sizes, strict=True):
            ahead, way = ship.body.matrix[[0, 2], 2], ship.body.velocity[[0, 2]] * step
            share, sides = np.meshgrid(*[(np.arange(n) + 0.5) / n for n in WAKE_POINTS])
            aside = np.outer(breadth * (sides.ravel() - 0.5), [ahead[1], -ahead[0]])
            stern = ship.body.position[[0, 2]] - STERN_DISTANCE * length * ahead - np.outer(share, way) + aside
            speed = float(np.linalg.norm(ship.body.velocity[[0, 2]]))
            area = WAKE_WHITENESS * min(speed / WHITEST_SPEED, 1.0) * breadth * speed * step
            self.left.receive((stern - low) / self.cell, np.full(share.size, area / share.size))

    def fly_drops(
        self, simulation: Simulation, place: np.ndarray, velocity: np.ndarray, snapshot: "Snapshot | None", wind: float
    ) -> np.ndarray:
        """Advance the spray thrown by foam, fast particles and ships' bows; returns its drops, (n, 9) as in
        `spray.Spray`. `place`, `velocity` (nx, nz, 3): surface points [m] and their velocities [m/s]; `snapshot`:
        particles, or None; `wind`: speed at 10 m [m/s]."""
        from scipy.ndimage import minimum_filter

        basin, time, spacing = simulation.basin, simulation.time, simulation.fluid.spacing
        boxes = np.array(basin.obstacles_at(time)).reshape(-1, 2, 3)
        low, ahead = place[0, 0, [0, 2]], (wind or self.gust_speed) * self.wind_ahead
        # Jets of particles have heights, too, but no water below them.
        level = place[..., 1] if snapshot is None else minimum_filter(place[..., 1], LANDING_CELLS)

        def heights_at(places: np.ndarray) -> np.ndarray:
            return foam.read_ways(level[None], ((places - low) / self.cell).T)[0]

        def is_open(position: np.ndarray) -> np.ndarray:
            share, bodies = ((position[:, [0, 2]] - low) / self.cell + 0.5) / self.shape, list[np.ndarray]()
            bodies += [((position > lower) & (position < upper)).all(axis=1) for lower, upper in boxes]
            bodies += [mesh.distances(position - way, spacing) < 0.0 for mesh, way in basin.meshes_at(time)]
            hulls = zip(self.hulls, self.ships, strict=True)
            bodies += [hull.encloses(position, ship.body.position, ship.body.matrix) for hull, ship in hulls]
            return np.asarray(((share > 0.0) & (share < 1.0)).all(axis=1) & ~np.any(bodies, axis=0))

        sources = []
        if self.white is not None:
            rate = 1.0 / max(time - self.spray.time, 1e-9)
            shares = [foam.cell_means(of, self.shape) for of in (rate * self.white.whitened, self.white.white)]
            surface = place.reshape(-1, 3), velocity.reshape(-1, 3), np.reshape(shares, (2, -1))
            falls = max(float(surface_fall(place[..., 1], *self.cell).std()), 1e-9)
            fast = float(np.sqrt(GRAVITY * place[..., 1].std() / falls))
            sources += spray.foam_sources(*surface, self.cell, fast, ahead)
            for n, (ship, size, stem) in enumerate(zip(self.ships, self.sizes, self.stems, strict=True)):
                foot, forward = ship.body.point(stem), ship.body.matrix[:, 2] * [1.0, 0.0, 1.0]
                at = (foot[None, [0, 2]] - low) / self.cell
                meets = ship.body.point_velocity(stem) - foam.read_ways(np.moveaxis(velocity, -1, 0), at.T)[:, 0]
                sources.append(spray.bow_source(n, size, foot, meets, forward / np.linalg.norm(forward), heights_at))
        if snapshot is not None and len(snapshot.position):
            x, v = snapshot.position.astype(float), snapshot.velocity.astype(float)
            bed = basin.lower[1] if basin.ground is None else basin.ground.heights(x[:, [0, 2]])
            floor = spray.floor_heights(x, bed, boxes)
            x += shifts(x, place.mean(axis=(0, 1))[[0, 2]], basin.periods)
            sources.append(spray.airborne_source(x, v, floor, spacing))
        landed = self.spray.advance(time, sources, ahead, heights_at, is_open)
        self.left.receive((landed[:, [0, 2]] - low) / self.cell, spray.cross_section(landed))
        return self.spray.parcels

    def breaking_heights(
        self, simulation: Simulation, points: np.ndarray, elevation: np.ndarray, origin: np.ndarray
    ) -> np.ndarray:
        """Heights (nx, nz) [m] in which to look for breaking crests: `elevation` at `points` x, z (n, 2) around
        `origin`, less the disturbance by ships, whose hulls would count as crests."""
        if not self.ships:
            return elevation
        undisturbed = simulation.fluid.undisturbed_elevations(points, elevation.ravel())
        if undisturbed is not None:
            return undisturbed.reshape(self.shape)
        inside = np.zeros(len(points), bool)
        for ship, size in zip(self.ships, self.sizes, strict=True):
            at = ship.body.position + shifts(ship.body.position, origin, simulation.basin.periods)
            along, aside = ship_coordinates(points[:, 0], points[:, 1], at, ship.body.matrix)
            reach = 0.5 * size + self.cell.max()
            inside |= (along / reach[1]) ** 4 + (aside / reach[0]) ** 4 < 1.0
        widest = 0.5 * max(size[0] for size in self.sizes) + self.cell.max()
        return foam.levelled_heights(elevation, inside.reshape(self.shape), widest / self.cell)

    def whiten_past_sea(self, simulation: Simulation, points: np.ndarray) -> None:
        """Begin with the foam that a sea of plane waves would have left at points x, z (n, 2) [m] before the run."""
        sea, begins = simulation.fluid.plane_waves, simulation.time
        if sea is None or sea.ramp_share(begins) < 1.0:
            return
        wind = self.wind_speed or wind_speed_from_sea(sea, begins)
        for time in begins + np.arange(-FOAM_LEAD_SECONDS, 0.0, FOAM_LEAD_STEP):
            elevation = waves.elevation(sea, points, time).reshape(self.shape)
            velocity = waves.surface_velocity(sea, points, float(time)).reshape(*self.shape, 3)
            self.advance_foam(time, elevation, velocity, wind)

    def advance_foam(self, time: float, elevation: np.ndarray | None, velocity: np.ndarray, wind: float) -> None:
        """Advance the foam to a `time` [s]: carry it with the `velocity` (nx, nz, 3) [m/s], and form new foam on crests
        of the heights `elevation` (nx, nz) [m], if given, up to the cover usual at this `wind` speed [m/s]."""
        assert self.white is not None
        # A column before its release does not break.
        source = None if elevation is None or not velocity.any() else surface_fall(elevation, *self.cell)
        wanted = None if source is None else foam.wanted_cover(source, wind)
        self.white.advance(time, velocity[..., [0, 2]], source, wanted)

    def origin(self) -> np.ndarray:
        """Middle x, z (2,) [m] of a frame: in 3-D the mean position of the ships, in whole cells; else the origin."""
        return middle_cell(self.ships, self.cell) if self.ships and self.shape[1] > 1 else np.zeros(2)

    def resumed(self, changed: str) -> None:
        """Delete the frames later than the checkpoint to continue from, whatever has `changed` in the program."""
        for path in self.folder.glob("frame_*.npz"):
            if int(path.stem.removeprefix("frame_")) >= self.count:
                path.unlink()

    def write(self, name: str, **arrays: object) -> None:
        """Write arrays into the file `name`.npz of the folder, atomically."""
        file = BytesIO()  # in memory: savez seeks and writes for every array
        np.savez(file, **arrays)  # type: ignore[arg-type]
        write_file(self.folder / f"{name}.npz", file.getbuffer())


def move_triangles(mesh: "Mesh", origin: np.ndarray, period: Sequence[float]) -> "Mesh":
    """Copy of a surface `mesh` in a periodic basin, each triangle moved by whole periods to its image nearest to
    `origin` (x, z) [m]. `period`: of the basin along each axis [m], 0 if none."""
    shift = np.repeat(shifts(mesh.vertices[mesh.triangles].mean(axis=1), origin, period), 3, axis=0)
    at = np.column_stack([mesh.triangles.ravel(), np.round(shift, 6)])
    kept, which = np.unique(at, axis=0, return_inverse=True)
    number = kept[:, 0].astype(int)
    vertices = (mesh.vertices[number] + kept[:, 1:]).astype(mesh.vertices.dtype)
    triangles = which.reshape(-1, 3).astype(mesh.triangles.dtype)
    return replace(mesh, vertices=vertices, triangles=triangles, normals=mesh.normals[number])


def topmost_velocity(snapshot: "Snapshot", points: np.ndarray, top: np.ndarray, period: Sequence[float]) -> np.ndarray:
    """Mean velocity (nx, nz, 3) [m/s] of the particles above the heights `top` (nx, nz) [m] in 3 x 3 cells around each
    of `points` (n, 2) [m], whose flow is smooth as that of single particles is not; 0 without any. `period`: of the
    basin per axis [m], or 0."""
    from scipy.ndimage import uniform_filter

    high = np.flatnonzero(snapshot.position[:, 1] > top.min())  # all others lie lower
    x = snapshot.position.take(high, axis=0).astype(float)
    if any(period):
        x = x + shifts(x, 0.5 * (points[0] + points[-1]), period)
    low, (nx, nz) = points[0], top.shape
    cell = (points[-1] - low) / np.maximum(np.array([nx, nz]) - 1, 1)
    i, k = (np.round((x[:, axis] - low[n]) / cell[n]).astype(int) for n, axis in enumerate((0, 2)))
    at = np.clip(i, 0, nx - 1) * nz + np.clip(k, 0, nz - 1)
    above = np.flatnonzero(x[:, 1] > top.take(at))
    at, v = at.take(above), snapshot.velocity.take(high.take(above), axis=0)
    sums = [np.bincount(at, weights, nx * nz).reshape(nx, nz).astype(float) for weights in (None, *v.T)]
    count, *parts = (uniform_filter(each, 3, mode="nearest") for each in sums)
    return np.stack(parts, axis=-1) / np.maximum(count, 1e-6)[..., None]
