"""Gauges: height and pressure of the water at points that are fixed, or ride with the ships or the patch of open sea.

Gauges read the fluid, never a drawn surface. A pressure sensor with a face reads the mean over a disc, in 2-D over a
segment. The mean over a segment is the mean of the middles of SEGMENT_POINTS equal parts, exact for a linear pressure.
The mean over a disc is the mean of DISC_POINTS points of equal areas on two rings, each at the root mean square radius
of its ring's area, exact for a quadratic pressure. A dry point reads 0, so the mean times the face's area is its force.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from ocean_sim.basin import BOX_ROUNDING, Basin, Corners, Floor
from ocean_sim.basin.points import in_space
from ocean_sim.fluid import with_particles
from ocean_sim.model import Fault, Faults, Key, Model, Name, Point, quantity
from ocean_sim.observers.shared.csv_rows import CsvFile, Sampled, heading
from ocean_sim.parts import PeriodicConfig, SceneFacts
from ocean_sim.simulation import Observer, Simulation

Column = Annotated[tuple[float, ...], Field(strict=False, min_length=1, max_length=2)]

SEGMENT_POINTS = 9  # points of a sensor in 2-D
RING_POINTS = (6, 12)  # points on the rings of a sensor in 3-D
DISC_POINTS = sum(RING_POINTS)
DENT_SHARE = 1e-3  # of the depth: how far inside the bed a sensor may be that is meant to be on it
RIDING_PHRASE = " from the middle of what it rides with"


class Wave(Model):
    """A gauge of the height of the water, which may ride: move with a ship or a patch of open sea."""

    at: Column = quantity("m")
    """Place [x, z]; in 2-D [x]."""
    rides: bool = False
    """True: `at` is counted from the middle of the ships, or of a patch of open sea without ships, and moves with it
    without turning."""


class Runup(Model):
    """A gauge of the height to which water runs up the bed along a line: the highest point of the bed that is wet, if
    all points below it on the line are wet, too."""

    along: Literal["x", "z"] = "x"
    """The axis along which the water runs up."""
    at: float | None = quantity("m", None)
    """Coordinate of the line across that axis; null: the middle of the basin."""

    def problem(self, basin: Basin) -> str | None:
        """Reason why no run-up can be measured along this line in a basin; None if it can."""
        if not (isinstance(basin.config.floor, Floor) and basin.config.floor.shaped):
            return "this bed is flat: water runs up one with basin.floor.profile"
        if basin.dimension == 2 and (self.along == "z" or self.at is not None):
            return "in a slice, in x-y, water runs up along x, and there is no coordinate across: {along: x}"
        return None if self.at is None else outside_reason((self.at,), "z" if self.along == "x" else "x", basin)

    def height(self, position: np.ndarray, basin: Basin, spacing: float) -> float:
        """Highest bed point [m] that particles (n, 3) [m], `spacing` apart, reach on this line; NaN if it is dry."""
        assert basin.ground is not None  # see `problem`
        along, across = (0, 2) if self.along == "x" else (2, 0)
        beside = position[np.abs(position[:, across] - (self.at or 0.0)) <= spacing]
        return basin.ground.runup(beside, spacing, along)


class Sensor(Model):
    """A pressure sensor at a point, or with a face (disc over which it averages) flush with a wall. It may ride: move
    with a ship or a patch of open sea."""

    at: Point = quantity("m")
    """The middle of its face [x, y, z]; in 2-D [x, y]."""
    diameter: float | None = quantity("m", None, ge=0.0)
    """Diameter of its face, over which the pressure is averaged; null or 0: a point."""
    normal: Point | None = quantity("1", None)
    """The direction in which its face looks, a vector of any length; by default straight away from the nearest side,
    bed, lid or face of a fixed obstacle, so that the sensor is flush with it."""
    rides: bool = False
    """True: `at` is counted from the middle of the ships, or of a patch of open sea without ships, and moves with it
    without turning."""

    def face_normal(self, basin: Basin) -> np.ndarray | None:
        """(3,) unit normal of the sensor's face: key `normal`, else that of the nearest wall; None without both."""
        if self.normal is not None:
            across = in_space(self.normal)
            return across / np.linalg.norm(across) if across.any() else None
        return nearest_normal(in_space(self.at), basin)

    def face_points(self, basin: Basin) -> np.ndarray:
        """(n, 3) points [m] on the sensor's face; it reads their mean pressure. Without a diameter, only its middle."""
        middle, across = in_space(self.at), self.face_normal(basin)
        if not self.diameter or across is None:
            return middle[None]
        if basin.dimension == 2:
            along = np.array([-across[1], across[0], 0.0])
            return middle + self.diameter * ((np.arange(SEGMENT_POINTS) + 0.5) / SEGMENT_POINTS - 0.5)[:, None] * along
        first = np.cross(across, np.eye(3)[np.abs(across).argmin()])
        first /= np.linalg.norm(first)
        return middle + 0.5 * self.diameter * disc_points() @ np.stack([first, np.cross(across, first)])


def disc_points() -> np.ndarray:
    """(DISC_POINTS, 2) points in a disc of radius 1; a mean over them is exact for quadratic functions on the disc."""
    rings, within = [], 0
    for count in RING_POINTS:
        radius = ((within + 0.5 * count) / DISC_POINTS) ** 0.5  # root mean square radius of the ring's area
        angle = 2.0 * np.pi * (np.arange(count) + 0.5) / count
        rings.append(radius * np.stack([np.cos(angle), np.sin(angle)], axis=1))
        within += count
    return np.concatenate(rings)


def nearest_normal(point: np.ndarray, basin: Basin) -> np.ndarray | None:
    """(3,) unit normal of the side, obstacle face or spot of the bed nearest to a point (3,) [m]; None without any."""
    found = [(abs(point[side.axis] - side.position), np.eye(3)[side.axis]) for side in basin.sides]
    for low, high in basin.fixed:
        beyond = np.maximum(np.maximum(np.array(low) - point, point - np.array(high)), 0.0)
        inside = np.minimum(np.abs(point - low), np.abs(point - high))
        axis = int(beyond.argmax()) if beyond.any() else int(inside.argmin())
        found.append((float(np.linalg.norm(beyond)) if beyond.any() else float(inside[axis]), np.eye(3)[axis]))
    if (ground := basin.ground) is not None:
        found.append((abs(ground.distances(point[None])[0]), ground.normals(point[None, [0, 2]])[0]))
    return min(found, key=lambda one: one[0])[1] if found else None


class Config(PeriodicConfig):
    turn: ClassVar[int] = -1
    leaves: ClassVar[str] = "gauges.csv"
    elevation: dict[Name, Column | Wave] = {}
    """Height of the water at points [x, z] in metres; in 2-D [x]. One that rides is {at: [x, z], rides: true}."""
    pressure: dict[Name, Point | Sensor] = {}
    """Pressure of the water at points [x, y, z] in metres, also on bed and walls; in 2-D [x, y]; 0 where dry. A
    sensor with a face is {at: [x, y, z], diameter: 0.09}, one that rides {at: [x, y, z], rides: true}."""
    runup: dict[Name, Runup] = {}
    """Height to which water runs up a bed with a profile, as {along: x}, or {along: x, at: 0.5} at z = 0.5 m."""
    every: float = quantity("s", 0.05, gt=0.0)
    """Simulated time between rows."""

    def contradictions(self) -> Iterator[str]:
        if not (self.elevation or self.pressure or self.runup):
            yield "give at least one gauge, under elevation, pressure or runup"
        if both := self.elevation.keys() & self.runup.keys():
            yield f"elevation and runup both have {min(both)}, and would both have the column {min(both)}_m"

    def problems(self, preflight: SceneFacts) -> Faults:
        return self.misplaced_gauges(preflight.tank)

    def mismatches(self, preflight: SceneFacts) -> Faults:
        yield from ((key, why) for key in self.riding_gauges if (why := riding_problem(preflight)))
        if self.runup and not preflight.fluid.made_of_particles:
            yield ("runup",), "only water of particles runs up a bed"

    def warnings(self, preflight: SceneFacts) -> Iterator[str]:
        yield from super().warnings(preflight)
        for name, sensor in self.sensors.items():
            at = in_space(sensor.at)
            if not sensor.rides and any((at > low).all() and (at < up).all() for low, up in preflight.tank.fixed):
                yield f"pressure.{name} is inside an obstacle, where there is no water"
            ground, dent = preflight.tank.ground, DENT_SHARE * preflight.tank.depth
            if ground is not None and not sensor.rides and ground.distances(at[None])[0] < -dent:
                yield f"pressure.{name} is inside the bed, where there is no water"
        if self.pressure and preflight.fluid.misread:
            yield preflight.fluid.misread

    @property
    def riding_gauges(self) -> list[Key]:
        """Keys, as ("elevation", name) or ("pressure", name), of gauges that move with ships or a patch of open sea."""
        waves: list[Key] = [("elevation", name) for name, wave in self.waves.items() if wave.rides]
        return [*waves, *(("pressure", name) for name, sensor in self.sensors.items() if sensor.rides)]

    def misplaced_gauges(self, basin: Basin) -> list[Fault]:
        """Faults (key, sentence) of gauges that are outside the water or have an impossible face or line."""
        found: dict[Key, str | None] = {("runup", name): line.problem(basin) for name, line in self.runup.items()}
        found |= {("elevation", name): outside_reason(wave.at, "xz", basin) for name, wave in self.waves.items()}
        for name, sensor in self.sensors.items():
            found["pressure", name] = outside_reason(sensor.at, "xyz", basin) or face_problem(sensor, basin)
        if self.elevation and basin.periods[1] > 0.0:
            found["elevation",] = "a basin that is periodic along y has no surface"
        return [(key, sentence) for key, sentence in found.items() if sentence is not None]

    @property
    def waves(self) -> dict[str, Wave]:
        """Wave gauges by name; a point given in the scene becomes a fixed gauge at that point."""
        return {n: w if isinstance(w, Wave) else Wave(at=w) for n, w in self.elevation.items()}

    @property
    def sensors(self) -> dict[str, Sensor]:
        """Pressure sensors by name; a point given in the scene becomes a sensor that reads at that point alone."""
        return {n: s if isinstance(s, Sensor) else Sensor(at=s) for n, s in self.pressure.items()}


def riding_problem(preflight: SceneFacts) -> str | None:
    """Reason that no gauge can move with ships or a patch of open sea in this scene; None if one can."""
    if preflight.tank.sea is not None:
        return None
    if preflight.fluid.made_of_particles:
        return "a gauge rides only over a patch of open sea; this water stays in place: leave rides out, or name a sea"
    return None if preflight.ships else "there is no ship that it could ride with; leave rides out"


def outside_reason(point: tuple[float, ...], axes: str, basin: Basin) -> str | None:
    """Reason why a point, by coordinates along `axes`, is outside the basin, or None. Above an open basin is inside."""
    wanted = axes if basin.dimension == 3 else axes.replace("z", "")
    if len(point) != len(wanted):
        slice_ = "" if basin.dimension == 3 else ", the basin is 2-D"
        return f"{list(point)} should be [{', '.join(wanted)}]{slice_}"
    for axis, value in zip(wanted, point):
        low, high = basin.lower["xyz".index(axis)], basin.upper["xyz".index(axis)]
        if axis == "y" and not basin.closed:
            if value < low:
                return f"y = {value:g} m is outside the basin, whose bed is at {low:g} m"
        elif not low <= value <= high:
            return f"{axis} = {value:g} m is outside the basin, which reaches from {low:g} to {high:g} m"
    return None


def face_problem(sensor: Sensor, basin: Basin) -> str | None:
    """Reason why a sensor with its middle in the basin cannot have its stated face (averaging area); None if it can."""
    wanted = "xyz"[: basin.dimension]
    if sensor.normal is not None and len(sensor.normal) != len(wanted):
        return f"the normal {list(sensor.normal)} should be [{', '.join(wanted)}]"
    if sensor.normal is not None and not any(sensor.normal):
        return "a normal of length 0 points nowhere"
    if not sensor.diameter:
        return None
    across = sensor.face_normal(basin)
    if across is None:
        return "no wall is near that the sensor could be flush with; give its normal"
    reach = np.maximum(0.5 * sensor.diameter * np.sqrt(np.maximum(1.0 - across**2, 0.0)) - BOX_ROUNDING, 0.0)
    ends = [in_space(sensor.at) + way * reach for way in (-1.0, 1.0)]
    if any(outside_reason(tuple(end[: basin.dimension].tolist()), "xyz", basin) for end in ends):
        return f"the face of {sensor.diameter:g} m about {list(sensor.at)} reaches out of the basin"
    return None


def sensor_description(sensor: Sensor, points: int) -> str:
    """Text on a sensor's position and face (averaging area) for gauges.csv; `points`: their number on the face."""
    place = f"{list(sensor.at)} m{RIDING_PHRASE if sensor.rides else ''}"
    if points == 1:
        return f"pressure at {place}"
    return f"mean pressure over {sensor.diameter:g} m about {place}, of {points} points"


def hydrostatic_offset(simulation: Simulation) -> dict[str, object]:
    """Comment line of gauges.csv, by name: how far compression by weight lowers the surface; empty if it does not."""
    if not simulation.fluid.surface_drop:
        return {}
    by = f"{simulation.fluid.surface_drop:.4g} m where it is deepest, g h^2 / (2 c^2) of a column of height h"
    return {"hydrostatic_offset": f"the water's own weight lowers its level by {by}"}


def dry_tops(obstacles: Sequence[Corners], columns: np.ndarray, heights: np.ndarray) -> np.ndarray:
    """Heights (n,) [m] that gauges read at x, z `columns` (n, 2) [m]: the top of an obstacle that rises there above the
    water, else the water's own from `heights` (n,). `obstacles`: lower and upper corners of boxes."""
    for low, up in sorted(obstacles, key=lambda box: box[0][1]):
        over = ((columns >= np.array(low)[[0, 2]]) & (columns <= np.array(up)[[0, 2]])).all(axis=1)
        heights = np.where(over & (heights >= low[1] - BOX_ROUNDING) & (heights < up[1]), up[1], heights)
    return heights


class Gauges(Observer, of=Config):
    """Writes gauges.csv: one column of elevation [m], run-up [m] or pressure [Pa] for each gauge."""

    def __init__(self, config: Config, folder: Path, simulation: Simulation) -> None:
        self.every = config.every
        waves = config.waves
        self.columns = np.array([(*wave.at, 0.0)[:2] for wave in waves.values()]).reshape(-1, 2)  # x, z [m]
        sensors = config.sensors
        faces = {name: sensor.face_points(simulation.basin) for name, sensor in sensors.items()}
        self.points = np.concatenate([np.zeros((0, 3)), *faces.values()])  # [m]
        self.sizes = np.array([len(face) for face in faces.values()], dtype=int)  # points of each sensor
        self.columns_ride = np.array([[wave.rides] for wave in waves.values()], dtype=float).reshape(-1, 1)
        ride = [sensor.rides for sensor in sensors.values()]
        self.points_ride = np.repeat(np.array(ride, dtype=float), self.sizes)[:, None]  # 1 where a point rides, else 0
        self.any_rides = bool(config.riding_gauges)  # True if any gauge rides
        self.sampled = Sampled(config.every)
        self.runups = [*config.runup.values()]
        meaning = {
            f"{name}_m": f"elevation at {list(wave.at)} m{RIDING_PHRASE if wave.rides else ''}"
            + (", over a dry obstacle its top" if simulation.basin.config.obstacles else "")
            + (", nan over a dry bed" if simulation.basin.ground is not None else "")
            for name, wave in waves.items()
        }
        for name, line in config.runup.items():
            place = "" if simulation.basin.dimension == 2 else f" at {'zx'[line.along == 'z']} = {line.at or 0.0:g} m"
            meaning[f"{name}_m"] = f"highest place of the bed that water touches along {line.along}{place}"
        meaning |= {f"{name}_Pa": sensor_description(sensors[name], len(face)) for name, face in faces.items()}
        rate = f"every {config.every:g} s, linear between steps"
        head = heading(simulation, rate, **hydrostatic_offset(simulation), **meaning)
        self.csv = CsvFile(folder / "gauges.csv", head, ["time_s", *meaning])

    def observe(self, simulation: Simulation) -> None:
        fluid, parts = simulation.fluid, []
        x, z = 0.0, 0.0  # [m] of the point with which gauges ride: the middle of the ships, or of the patch of open sea
        if self.any_rides:
            places = [ship.body.position[[0, 2]] for ship in simulation.ships.values()]
            x, z = np.mean(places, axis=0) if places else fluid.patch_centre
        if len(self.columns):
            columns = self.columns + self.columns_ride * [x, z]
            heights, ground = fluid.elevations(columns), simulation.basin.ground
            if ground is not None:
                heights = np.maximum(heights, ground.heights(columns))
            heights = dry_tops(simulation.basin.obstacles_at(simulation.time), columns, heights)
            for mesh, way in simulation.basin.meshes_at(simulation.time):
                tops = mesh.tops_below(np.insert(columns, 1, heights, axis=1) - way) + way[1]
                heights = np.maximum(heights, tops)
            parts.append(heights if ground is None else ground.wet_heights(columns, heights))
        if self.runups:
            position = with_particles(fluid).particles.position.to_numpy()
            parts.append(np.array([line.height(position, simulation.basin, fluid.spacing) for line in self.runups]))
        if len(self.points):
            pressures = fluid.pressures(self.points + self.points_ride * [x, 0.0, z])
            parts.append(np.add.reduceat(pressures, np.cumsum(self.sizes) - self.sizes) / self.sizes)
        for time, values, _ in self.sampled.rows(simulation.time, np.concatenate(parts)):
            self.csv.row([time, *values])

    def close(self) -> None:
        self.csv.close()
