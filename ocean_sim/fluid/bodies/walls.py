"""Limits of the water: sides that particles bounce from, zones that absorb waves, and the largest move in a step."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from math import inf, pi
from typing import Any

import numpy as np

from ocean_sim import waves
from ocean_sim.basin import OPEN, Basin, Side
from ocean_sim.basin.motion import NOT_MOVED, Moved
from ocean_sim.fluid.neighbours.images import SIDE_COLUMNS, Images
from ocean_sim.fluid.open_sea.plane_waves import PlaneWaves
from ocean_sim.fluid.sph.body_force import Relief
from ocean_sim.fluid.sph.initial_state import Initial, bearable_waves, fitted_waves
from ocean_sim.fluid.sph.lattice import Lattice
from ocean_sim.fluid.sph.water_keys import free_fall_speed
from ocean_sim.kernel_library import ti, tm, to_numpy_type
from ocean_sim.runtime import in_kernels
from ocean_sim.waves.absorption import DAMPING_POWER, damping_rate, sea_reflection

REGULAR_ZONE_WAVES, RANDOM_ZONE_WAVES = 1.0, 2.0  # [wavelengths] default lengths of a zone
MAX_ZONE_SHARE = 0.5  # share of the basin in the zones along an axis
MIN_ZONE_WAVES = 0.5  # [wavelengths] a shorter zone reflects most
MIN_WAVE_SPACINGS = 4.0  # [spacings] shortest wave of a target
UNKNOWN_PART, UNKNOWN_RATE = 0.25, 2.5  # share of the basin, [sqrt(|g| / depth)]: zones for unknown waves
GONE = Moved(np.full(3, 1.0e6), np.zeros(3), np.zeros(3))  # [m] from its place: a mesh that is not there
GONE_FACES = np.array([3 * [OPEN], 3 * [-OPEN]])  # lowest and highest corner [m] of what is not there


@dataclass(frozen=True)
class Zone:
    """Absorbing zone before a side. It relaxes water towards a target velocity, faster the closer to the side."""

    side: str
    axis: int
    begin: float  # [m] along the axis
    end: float  # [m] where the side is
    rate: float  # [1/s]
    size: float  # [m] of the basin
    coming: waves.Components | None  # the waves that it is for
    current: tuple[float, float, float]  # [m/s] of the target
    given: waves.Components | None  # the waves of the target

    @property
    def length(self) -> float:
        """Length of the zone along its axis [m]."""
        return abs(self.end - self.begin)

    def contains(self, place: float) -> bool:
        """True if a coordinate `place` [m] along its axis lies in the zone."""
        return min(self.begin, self.end) < place < max(self.begin, self.end)

    @property
    def wavelength(self) -> float:
        """Wavelength [m] of the highest waves this absorbing zone is made for; infinite if the scene names none."""
        return inf if self.coming is None else self.coming.wavelength

    @cached_property
    def reflection(self) -> tuple[float, float]:
        """Reflected shares of wave height by linear theory: of the highest waves, and of the whole sea."""
        assert self.coming is not None
        return sea_reflection(self.coming, self.length, self.rate)

    @property
    def statement(self) -> str:
        """Sentence on length, rate, target and reflection of the zone."""
        what = f"absorbing side {self.side}: a zone of {self.length:.3g} m, "
        rate = f"rate {self.rate:.3g} 1/s at the side"
        aim = "" if not any(self.current) else f"; towards a current of {list(self.current)} m/s"
        if self.given is not None:
            aim += f"{';' if not aim else ' and'} towards waves of {self.given.wavelength:.4g} m"
        if self.coming is None:
            return f"{what}{rate}; the scene names no waves to choose them for{aim}"
        peak, whole = self.reflection
        back = f"by linear theory it sends back {peak:.2%} of the height of waves of {self.coming.period:.3g} s"
        band = f", {whole:.2%} of the whole sea" if self.coming.random else ""
        many = f"{self.length / self.wavelength:.3g} times the wavelength of {self.wavelength:.3g} m"
        return f"{what}{many}, {rate}; {back}{band}{aim}"

    @property
    def warning(self) -> str | None:
        """Sentence if the zone is shorter than half a wavelength and so absorbs badly; else None."""
        if self.coming is None or self.length >= MIN_ZONE_WAVES * self.wavelength:
            return None
        peak, _ = self.reflection
        opening = f"the zone before absorbing side {self.side} is {self.length:.3g} m long,"
        middle = f"less than half the wavelength of {self.wavelength:.3g} m:"
        return f"{opening} {middle} it sends back {peak:.0%} of the height of waves, one wavelength about 1 %"


def scene_waves(basin: Basin, initial: Initial | None) -> waves.Components | None:
    """Waves that a scene makes by its wavemaker, else its initial state, else its moving tank; None without any."""
    if any(waves.basin_faults(basin)):
        return None
    if basin.piston is not None:
        return basin.piston.path.sea
    began = None if initial is None else initial.sea(basin)
    return began or basin.tank_wave


def zones(lattice: Lattice) -> tuple[Zone, ...]:
    """Absorbing zones of the basin, one before each absorbing side, in the order of the sides."""
    basin = lattice.basin
    absorbing = [side for side in basin.sides if side.absorbing is not None]
    of_scene = scene_waves(basin, lattice.config.initial) if absorbing else None
    return tuple(zone(side, basin, of_scene, absorbing, lattice.spacing) for side in absorbing)


def zone(side: Side, basin: Basin, of_scene: waves.Components | None, absorbing: list[Side], spacing: float) -> Zone:
    """Make the absorbing zone of a `side`, for the waves of its target or else `of_scene`; `absorbing`: all such sides,
    between which the basin's length is shared out; `spacing` [m]: of particles."""
    asked, axis = side.absorbing, side.axis
    assert asked is not None
    target, given = asked.target, None
    if target is not None and target.waves is not None:
        given = target.waves.sea(basin)
        if target.waves.spectrum is not None:
            given = bearable_waves(given, target.waves.spectrum.significant_wave_height, MIN_WAVE_SPACINGS * spacing)
        given = fitted_waves(given, basin)
    sea, size = given or of_scene, basin.upper[axis] - basin.lower[axis]
    length, rate = UNKNOWN_PART * size, UNKNOWN_RATE * free_fall_speed(basin) / basin.depth
    if sea is not None:
        k = float(sea.wavenumber[sea.highest])
        wanted = (RANDOM_ZONE_WAVES if sea.random else REGULAR_ZONE_WAVES) * 2.0 * pi / k
        length = asked.length or min(wanted, MAX_ZONE_SHARE * size / sum(other.axis == axis for other in absorbing))
        rate = damping_rate(k, sea.depth, sea.gravity, length)
    length, rate = asked.length or length, asked.rate or rate
    begin = side.position - length if side.upper else side.position + length
    current = (0.0, 0.0, 0.0) if target is None else target.current
    return Zone(side.name, axis, begin, side.position, rate, size, sea, current, given)


def warnings(found: tuple[Zone, ...]) -> Iterator[str]:
    """Yield warnings of absorbing zones (`found`) that are too short or fill over half of the basin along an axis."""
    for one in found:
        if one.warning is not None:
            yield one.warning
    for axis in sorted({one.axis for one in found}):
        along = [one for one in found if one.axis == axis]
        part = sum(one.length for one in along) / along[0].size
        if part > MAX_ZONE_SHARE + 1e-9:
            names = " and ".join(one.side for one in along)
            yield f"the zones before absorbing sides ({names}) take {part:.0%} of the basin along {'xyz'[axis]}"


@in_kernels
class Target:
    """Target velocity of an absorbing zone: a current plus the waves that the side lets in."""

    def __init__(self, zone: Zone) -> None:
        self.current, self.waving = tm.vec3(zone.current), zone.given is not None
        if zone.given is not None:
            self.waves = PlaneWaves(zone.given)

    def turn(self, time: float) -> None:
        """Set the waves of this absorbing zone's target to a time [s]: the phases with which `velocity` reads them."""
        if self.waving:
            self.waves.set_time(time)

    @ti.func
    def velocity(self, x):
        """Target velocity [m/s] at x [m]: current plus orbital velocity of the waves, at the time given to `turn`."""
        v = self.current
        if ti.static(self.waving):
            v += self.waves.velocity(x)
        return v


@in_kernels
class Walls:
    """Walls, floor, bed and obstacles, from which particles bounce at `collision_distance`, and absorbing zones."""

    def __init__(self, lattice: Lattice, images: Images) -> None:
        gap = lattice.config.collision_distance * lattice.spacing
        low, up = lattice.basin.stops()
        # Planes [m] at which walls, floor and lid stop the centres of particles, and their distance from a wall.
        self.low, self.up, self.gap = tuple(x + gap for x in low), tuple(x - gap for x in up), gap
        self.images = images
        self.pistons = tuple((s, side.axis, side.upper) for s, side, _ in images.pistons)
        self.axes = range(lattice.basin.dimension)  # with walls
        self.restitution = lattice.basin.config.restitution
        self.friction = lattice.basin.config.friction
        boxes = lattice.basin.boxes
        self.obstacles = len(boxes)
        self.gates = [(b, box.gate) for b, box in enumerate(boxes) if box.gate is not None]
        if self.obstacles:
            self.faces = ti.field(float, shape=(self.obstacles, 2, 3))
            self.first = np.array(lattice.basin.obstacles) + np.array([[-gap], [gap]])  # (n, 2, 3) at time 0 [m]
            self.faces.from_numpy(self.first.astype(to_numpy_type(self.faces.dtype)))
        if self.gates:
            self.speed = ti.field(float, shape=(self.obstacles, 3))  # [m/s]
        limit = lattice.config.motion_limit
        self.zones = tuple((zone.axis, zone.begin, zone.end, zone.rate, Target(zone)) for zone in zones(lattice))
        self.limited = limit is not None
        self.limit = (limit or 0.0) * lattice.spacing  # [m]
        self.shaped = lattice.basin.ground is not None
        self.relief: Any = None  # the Relief of a bed with a shape
        if lattice.basin.ground is not None:
            self.relief = Relief(lattice.basin.ground, lattice.spacing, images.support)
        meshes = lattice.basin.meshes.values()
        self.nets = [(n, mesh.net(lattice.spacing), mesh) for n, mesh in enumerate(meshes)]
        if self.nets:
            self.places = ti.field(float, shape=(len(self.nets), 2, 3))  # middle [m] and velocity [m/s] of each mesh
        self.advance(0.0)

    def advance(self, time: float) -> None:
        """Move gates and the target waves of absorbing zones to a time [s]; remove gates that have left."""
        for *_, target in self.zones:
            target.turn(time)
        for b, gate in self.gates:
            moved = gate.at(time)
            faces = GONE_FACES if moved is None else self.first[b] + moved.way
            for side, k in product(range(2), range(3)):
                self.faces[b, side, k] = faces[side, k]
            for k in range(3):
                self.speed[b, k] = 0.0 if moved is None else moved.velocity[k]
        for n, _, mesh in self.nets:
            moved = NOT_MOVED if mesh.gate is None else mesh.gate.at(time) or GONE
            for k in range(3):
                self.places[n, 0, k], self.places[n, 1, k] = mesh.origin[k] + moved.way[k], moved.velocity[k]

    @ti.func
    def bounce(self, x, v):
        """Position x [m], velocity v [m/s] after collisions with walls, obstacles, bed by restitution and friction."""
        for k in ti.static(self.axes):
            low, up, wall, normal = self.low[k], self.up[k], tm.vec3(0.0), tm.vec3(0.0)
            for s, axis, upper in ti.static(self.pistons):
                if ti.static(axis == k):
                    wall[k] = 0.5 * self.images.side[s, SIDE_COLUMNS.twice_velocity + axis]
                    if ti.static(upper):
                        up = self.images.side[s, SIDE_COLUMNS.position] - self.gap
                    else:
                        low = self.images.side[s, SIDE_COLUMNS.position] + self.gap
            inside = tm.clamp(x[k], low, up)
            if inside != x[k]:
                normal[k] = ti.select(x[k] > inside, -1.0, 1.0)
                v = self.reflect(v, wall, normal)
                x[k] = inside
        if ti.static(self.shaped):
            away, normal = self.relief.distance(x)
            if away < self.gap:
                x += (self.gap - away) * normal
                v = self.reflect(v, tm.vec3(0.0), normal)
        for n, net, _mesh in ti.static(self.nets):
            place, wall = tm.vec3(0.0), tm.vec3(0.0)
            for k in ti.static(range(3)):
                place[k], wall[k] = self.places[n, 0, k], self.places[n, 1, k]
            normal, away, _thinning = net.at(x - place)
            if away < self.gap:
                x += (self.gap - away) * normal
                v = self.reflect(v, wall, normal)
        if ti.static(self.obstacles > 0):
            for b in range(self.obstacles):
                x, v = self.leave_obstacle(b, x, v)
        return x, v

    @ti.func
    def piston_velocity(self, x):
        """Velocity [m/s] of pistons (moving sides) within a support of x [m], which push water there; else zero."""
        v = tm.vec3(0.0)
        for s, axis, _upper in ti.static(self.pistons):
            if ti.abs(x[axis] - self.images.side[s, SIDE_COLUMNS.position]) < self.images.support:
                v[axis] += 0.5 * self.images.side[s, SIDE_COLUMNS.twice_velocity + axis]
        return v

    @ti.func
    def reflect(self, v, wall, normal):
        """Velocity v [m/s] after a collision with a face of outward unit `normal` that moves at `wall` [m/s]."""
        speed = (wall - v).dot(normal)
        if speed > 0.0:
            along = v - wall + speed * normal
            kick = self.friction * (1.0 + self.restitution) * speed
            along *= tm.max(0.0, 1.0 - kick / tm.max(along.norm(), 1e-12))
            v = along + (wall + self.restitution * speed * normal)
        return v

    @ti.func
    def leave_obstacle(self, b, x, v):
        """Position x [m] and velocity v [m/s] after a bounce from the nearest face of obstacle b, if x lies in it."""
        least, face, across = OPEN, -1, 0.0
        for k in ti.static(self.axes):
            below, above = x[k] - self.faces[b, 0, k], self.faces[b, 1, k] - x[k]
            if below <= 0.0 or above <= 0.0:
                least = -OPEN
            if below < least and self.faces[b, 0, k] >= self.low[k]:
                least, face, across = below, k, self.faces[b, 0, k]
            if above < least and self.faces[b, 1, k] <= self.up[k]:
                least, face, across = above, k, self.faces[b, 1, k]
        if least > 0.0:
            for k in ti.static(self.axes):
                if face == k:
                    wall, normal = tm.vec3(0.0), tm.vec3(0.0)
                    normal[k] = ti.select(across > x[k], 1.0, -1.0)
                    if ti.static(len(self.gates) > 0):
                        wall[k] = self.speed[b, k]
                    v = self.reflect(v, wall, normal)
                    x[k] = across
        return x, v

    @ti.func
    def relax(self, x, v, dt):
        """Velocity v [m/s] at x [m] after relaxation over dt [s] in absorbing zones: dv/dt = rate s^q (target - v), q =
        DAMPING_POWER, s from 0 at the inner edge of a zone to 1 at its side."""
        for axis, begin, end, rate, target in ti.static(self.zones):
            s = (x[axis] - begin) / (end - begin)
            if s > 0.0:
                v += (1.0 - ti.exp(-dt * rate * tm.min(s, 1.0) ** DAMPING_POWER)) * (target.velocity(x) - v)
        return v

    @ti.func
    def limit_motion(self, v, dt):
        """Velocity v [m/s], scaled down if its way in dt [s] exceeds `motion_limit`; and 1 if scaled, else 0."""
        fast = 0
        if ti.static(self.limited):
            way = v.norm() * dt
            if way > self.limit:
                v *= self.limit / way
                fast = 1
        return v, fast
