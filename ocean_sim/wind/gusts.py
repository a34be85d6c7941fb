"""Wind as volumes of moving air (thesis 2.3 and 5.1.2, Algorithm 1).

What a volume does: `acceleration` and `noise` are the listing's force field, as strong on every particle inside, deep
or shallow: stylised, some hundred thousand times a real wind. `wind_speed` is apart from them: the stress (2.20) and
the lift (2.23) on exposed surface. Volumes add up.
"""

from math import atan2, cos, degrees, hypot, inf, radians, sin
from typing import Any, ClassVar, Literal

import numpy as np
import taichi as ti
import taichi.math as tm
from pydantic import Field

from ocean_sim.basin import Basin
from ocean_sim.model import Vector2, Vector3, quantity
from ocean_sim.parts import LedgerRow, Preflight, Problems, WindConfig
from ocean_sim.random_numbers import numpy_uniform3
from ocean_sim.wind.shared.air import Air, joined, turned_all
from ocean_sim.wind.shared.air_load import drag, lift
from ocean_sim.wind.shared.clock import RUN, Now
from ocean_sim.wind.shared.noise import EVERY, OWN, Noise, NoiseSize
from ocean_sim.wind.shared.passages import Passages
from ocean_sim.wind.shared.schedule import Scheduled
from ocean_sim.wind.shared.volumes import Shape, turned, turned_back, within
from ocean_sim.wind.shared.warnings import kick, stylised
from ocean_sim.wind.still import Still

NOISE, PASSAGES = 0x1_0000, 0x2_0000  # streams of random numbers; the volume's number is added

# Columns of a volume's row; after them come its shapes, whose columns count from where the shape begins. START is its
# centre when the clock began; CENTRE, and ACROSS, the middle of its slab, are found in each step.
START, VELOCITY, ACCELERATION, STRENGTH_OF_NOISE, WIND, LIFT = 0, 3, 6, 9, 12, 15
NORMAL, MIDDLE, HALF_THICK, CENTRE, ACROSS, SHAPES = 16, 19, 20, 21, 24, 25
ARM, HALF, RADIUS, COSINE, SINE, SIGN, WIDTH = 0, 3, 6, 7, 8, 9, 10

ADVANCE = 2.0e-5  # [s] of processor time a step; what it blows on is in the particles' and the ship's
ROUNDING = 1e-4  # by which the slab around a volume is thicker than it

Target = Literal["fluid", "ship"]


class Volume(Scheduled):
    """One volume of moving air: all included shapes less all excluded ones.

    What it blows may begin, end and follow a `schedule`: its speed, over the greatest in the schedule, is a factor on
    acceleration, noise and wind_speed, which turn to its heading; the volume drifts on as it does.
    """

    include: list[Shape] = Field(min_length=1)
    """Shapes it is made of; the centre of the first is the centre of the volume."""
    exclude: list[Shape] = []
    """Shapes cut out of it."""
    acceleration: Vector3 = quantity("m/s2", (0.0, 0.0, 0.0))
    """Acceleration of everything inside."""
    noise: NoiseSize = quantity("m/s2", (0.0, 0.0, 0.0))
    """Random acceleration along each axis, uniform between minus and plus this (2.24)."""
    wind_speed: float = quantity("m/s", 0.0, ge=0.0)
    """Wind 10 m above the water, for drag and lift on exposed surface; apart from `acceleration`."""
    lift_coefficient: float = quantity("1", 1.0e-3)
    """C_L of (2.23); the thesis prints none, this is ours: of the size of C_d."""
    heading_deg: float | None = quantity("deg", None)
    """Where the wind goes to, 0 along +z, 90 along +x; none: where `acceleration` points."""
    drift: float | Vector3 = quantity("m/s", 0.0)
    """Velocity of the volume; a number is a speed along its heading."""
    redraw_yaw_deg: Vector2 | None = quantity("deg", None)
    """Least and greatest yaw of its first shape in later passages; everything turns along. None: it never turns."""
    redraw_strength: Vector2 = quantity("1", (1.0, 1.0))
    """Least and greatest factor on `acceleration` and `wind_speed` in later passages."""
    targets: list[Target] | None = None
    """What this volume acts on; null: the targets of the wind."""

    @property
    def ahead(self) -> Vector3:
        """Unit vector where the wind goes to."""
        heading = self.heading_deg
        angle = atan2(self.acceleration[0], self.acceleration[2]) if heading is None else radians(heading)
        return sin(angle), 0.0, cos(angle)

    @property
    def velocity(self) -> np.ndarray:
        """`drift` as a vector [m/s]."""
        return np.multiply(self.drift, self.ahead) if isinstance(self.drift, (int, float)) else np.array(self.drift)

    @property
    def passing_time(self) -> float:
        """How long a point on its path lies inside [s]; infinite where it does not drift."""
        speed = float(np.linalg.norm(self.velocity))
        return self.include[0].core.chord(self.velocity / speed) / speed if speed else inf

    def blows(self, time: float, dt: float = 0.0) -> tuple[float, float]:
        """Factor on its strength in a step of dt [s] from a time [s] on, and the angle [rad] by which what it blows is
        turned."""
        if self.course is None:
            return self.blowing(time, dt), 0.0
        speed, heading = self.course.at(time + 0.5 * dt)
        along = degrees(atan2(self.ahead[0], self.ahead[2]))
        fastest = float(self.course.speed.max())
        return self.blowing(time, dt) * (speed / fastest if fastest else 0.0), radians(heading - along)

    def redrawn(self, seed: int, number: int, passage: int) -> tuple[float, float]:
        """Turn [rad] and strength of volume `number` in a later passage, from the seed."""
        side, force, _ = numpy_uniform3(seed, PASSAGES + number, 0, passage)[0]
        given = self.include[0].core.yaw
        low, high = (radians(a) for a in self.redraw_yaw_deg) if self.redraw_yaw_deg else (given, given)
        weak, strong = self.redraw_strength
        return (low + high + side * (high - low)) / 2 - given, (weak + strong + force * (strong - weak)) / 2

    def slab(self, turn: float) -> tuple[np.ndarray, float, float]:
        """The thinnest slab across an axis of the first shape that holds the volume, turned by `turn` [rad]: its
        normal, and its middle, seen from the centre of the volume, and half its thickness along the normal [m]."""
        cores = [shape.core for shape in self.include]
        slabs = []
        for axis in np.eye(3):
            normal = turned(axis, cores[0].yaw)
            places = np.array([(core.centre - cores[0].centre) @ normal for core in cores])
            reach = np.array([core.reach(normal) for core in cores]) * (1.0 + ROUNDING) + ROUNDING
            low, high = float((places - reach).min()), float((places + reach).max())
            slabs.append((turned(normal, turn), (low + high) / 2.0, (high - low) / 2.0))
        return min(slabs, key=lambda slab: slab[2])

    def passages(self, basin: Basin, seed: int, number: int) -> Passages:
        """The way of volume `number` across the basin."""
        first, speed = self.include[0].core, float(np.linalg.norm(self.velocity))
        rear = first.reach(self.velocity / speed) if speed else 0.0
        return Passages(first.centre, self.velocity, rear, basin, lambda passage: self.redrawn(seed, number, passage))


class Config(WindConfig):
    """Volumes of moving air, drifting across the basin."""

    example: ClassVar[dict[str, Any]] = {
        "volumes": [{"include": [{"kind": "sphere", "centre": [0.0, 0.0, 0.0], "radius": 1.0}]}]
    }
    kind: Literal["gusts"] = "gusts"
    volumes: list[Volume] = Field(min_length=1)
    """The volumes; their effects add up."""
    targets: list[Target] = ["fluid", "ship"]
    """What the wind acts on, where a volume has no targets of its own."""
    noise_every: float = quantity("s", EVERY, ge=0.0)
    """How long a draw of the noise lasts. A step takes every draw for as long as it lasts in it, so the noise is white
    in time and stirs the water alike whatever the step; 0: a new draw each step, as printed, which stirs it less the
    shorter the step. The default, ours, is PhysX's usual step."""

    @property
    def stylised(self) -> bool:
        """Whether a force field acts that is no physical stress."""
        return any(any(v.acceleration) or any(v.noise) for v in self.volumes)

    def aimed(self, target: Target) -> list[int]:
        """Numbers of the volumes that act on a target."""
        return [g for g, v in enumerate(self.volumes) if target in (self.targets if v.targets is None else v.targets)]

    def problems(self, preflight: Preflight) -> Problems:
        return [(("volumes", g, *path), said) for g, v in enumerate(self.volumes) for path, said in v.unscheduled()]

    def build(self, basin: Basin, seed: int) -> "Gusts":
        return Gusts(self, basin, seed)

    def ledger(self, preflight: Preflight) -> list[LedgerRow]:
        n, row = len(self.volumes), SHAPES + WIDTH * most_shapes(self.volumes)
        return [
            LedgerRow(
                "wind", "moving volumes of air", preflight.word * (n * row + OWN), f"{n} in wind.volumes", ADVANCE
            )
        ]

    def warnings(self, preflight: Preflight) -> list[str]:
        sentences = []
        for g, volume in enumerate(self.volumes):
            name, size = f"wind.volumes[{g}]", hypot(*volume.acceleration, *volume.noise)
            sentences += [stylised(name, size, preflight)] if size > 0.0 else []
            sentences += (
                kick(name, volume.acceleration, volume.passing_time, preflight) if any(volume.acceleration) else []
            )
        return sentences


def greatest(volume: Volume) -> float:
    """The most that an arrow in the volume stands for [m/s2], or [m/s] where nothing but wind_speed is given."""
    return hypot(*volume.acceleration) or volume.wind_speed


def most_shapes(volumes: list[Volume]) -> int:
    """Shapes of the volume that has most of them."""
    return max(len(v.include) + len(v.exclude) for v in volumes)


@ti.data_oriented
class Gusts:
    """Volumes on their way, and the load of their air."""

    blows = True

    def __init__(self, config: Config, basin: Basin, seed: int) -> None:
        self.config, self.volumes = config, config.volumes
        self.needs_area = any(v.wind_speed > 0.0 for v in self.volumes)
        self.noisy = any(any(v.noise) for v in self.volumes)
        self.passages = [v.passages(basin, seed, g) for g, v in enumerate(self.volumes)]
        self.n, self.shapes = len(self.volumes), most_shapes(self.volumes)
        self.rows = np.zeros((self.n, SHAPES + WIDTH * self.shapes))
        self.half = [0.0] * self.n  # half the thickness of the slabs [m]
        self.row = ti.field(float, shape=self.rows.shape)
        self.now = Now(OWN)
        self.noise = Noise(seed, config.noise_every, self.now) if self.noisy else None
        self.time, self.gain = 0.0, 1.0
        self.since, self.step = 0.0, 0.0
        self.blown = [volume.blows(0.0) for volume in self.volumes]
        self.steady = [volume.always and volume.schedule is None for volume in self.volumes]
        for g in range(self.n):
            self._shape(g)
            self._blow(g)
        self._tell()

    def on(self, target: Target) -> "Gusts | Aimed | Still":
        """The wind that a target feels: all volumes, those that act on it, or still air where none does."""
        numbers = self.config.aimed(target)
        return self if len(numbers) == self.n else Aimed(self, numbers) if numbers else Still()

    def strengthen(self, factor: float) -> None:
        """Blow so many times as strongly as the scene says: acceleration, noise and wind_speed."""
        self.gain = factor
        for g in range(self.n):
            self._blow(g)
        self._tell()

    def shown(self) -> Air:
        """The volumes where they are now, an arrow along each acceleration, or along the wind where there is none."""
        pieces = []
        strongest = max(greatest(v) for v in self.volumes) or 1.0
        for p, volume, (part, turn) in zip(self.passages, self.volumes, self.blown):
            first = volume.include[0].core
            edges = [turned_all(s.core.edges() - first.centre, p.turn) + p.centre for s in volume.include]
            push = volume.acceleration if any(volume.acceleration) else np.multiply(volume.wind_speed, volume.ahead)
            push = self.gain * part * p.strength / strongest * turned(push, p.turn + turn)
            feet = turned_all(first.spread() - first.centre, p.turn) + p.centre
            pieces.append(Air(np.concatenate(edges), feet, np.tile(push, (len(feet), 1))))
        return joined(pieces)

    def advance(self, dt: float) -> None:
        """Algorithm 1 for every volume, what it blows in the middle of a step of dt [s], and the noise of the step."""
        begun, changed = self.time, False
        self.time, self.since, self.step = begun + dt, self.since + dt, dt
        for g, (passage, volume) in enumerate(zip(self.passages, self.volumes)):
            before, blown = passage.number, self.blown[g]
            passage.advance(dt)
            if not self.steady[g]:
                self.blown[g] = volume.blows(begun, dt)
            if passage.number != before:
                self._shape(g)
            if passage.number != before or self.blown[g] != blown:
                self._blow(g)
                changed = True
        if changed or self.since > RUN:
            self._tell()
        if self.noise is not None:
            self.noise.advance()

    def _shape(self, g: int) -> None:
        """Note where the shapes of volume g lie around its centre in this passage."""
        volume, turn = self.volumes[g], self.passages[g].turn
        signs, first = [1.0] * len(volume.include) + [-1.0] * len(volume.exclude), volume.include[0].core.centre
        normal, middle, self.half[g] = volume.slab(turn)
        self.rows[g, NORMAL:HALF_THICK] = *normal, middle
        numbers: list[float] = []
        for shape, sign in zip(volume.include + volume.exclude, signs):
            c = shape.core
            arm, yaw = turned(c.centre - first, turn), c.yaw + turn
            numbers += [*arm, *c.half, c.radius, cos(yaw), sin(yaw), sign]
        self.rows[g, SHAPES : SHAPES + len(numbers)] = numbers

    def _blow(self, g: int) -> None:
        """Note what volume g blows now."""
        p, volume, (part, turn) = self.passages[g], self.volumes[g], self.blown[g]
        part *= self.gain
        acceleration = part * p.strength * turned(volume.acceleration, p.turn + turn)
        wind = part * p.strength * volume.wind_speed * turned(volume.ahead, p.turn + turn)
        numbers = (*acceleration, *np.multiply(part, volume.noise), *wind)
        self.rows[g, ACCELERATION : LIFT + 1] = *numbers, volume.lift_coefficient
        self.rows[g, HALF_THICK] = self.half[g] if any(numbers) else -1.0  # nothing lies in it while it does not blow

    def _tell(self) -> None:
        """Begin the clock anew: tell the kernels all rows, with the centres where they are now."""
        for numbers, passage in zip(self.rows, self.passages):
            numbers[START:ACCELERATION] = (*passage.centre, *passage.velocity)
        self.row.from_numpy(self.rows)
        if self.noise is not None:
            self.noise.begin(self.time)
        self.since = 0.0

    @ti.func
    def hear(self, since, step):
        """Find where the volumes are, and the draws of the step."""
        ti.loop_config(serialize=True)
        for g in range(self.n):
            centre = self.vector(g, START) + since * self.vector(g, VELOCITY)
            for k in ti.static(range(3)):
                self.row[g, CENTRE + k] = centre[k]
            self.row[g, ACROSS] = centre.dot(self.vector(g, NORMAL)) + self.row[g, MIDDLE]
        if ti.static(self.noisy):
            self.noise.hear(since, step)

    @ti.func
    def force(self, key, position, velocity, area, mass):
        """(2.26), summed over the volumes that hold the position [N]."""
        total = tm.vec3(0.0)
        for g in range(self.n):
            total += self.push(g, key, position, velocity, area, mass)
        return total

    @ti.func
    def push(self, g, key, position, velocity, area, mass):
        """The load of volume g [N]; most particles are seen to lie outside its slab at once."""
        total = tm.vec3(0.0)
        if ti.abs(position.dot(self.vector(g, NORMAL)) - self.row[g, ACROSS]) <= self.row[g, HALF_THICK]:
            if self.holds(g, position - self.vector(g, CENTRE)):
                total += mass * self.vector(g, ACCELERATION)
                if ti.static(self.noisy):
                    total += mass * self.vector(g, STRENGTH_OF_NOISE) * self.noise.of(NOISE + g, key)
                if ti.static(self.needs_area):
                    wind = self.vector(g, WIND)
                    if wind.dot(wind) > 0.0:
                        total += self.load(g, wind - velocity, area.norm())
        return total

    @ti.func
    def load(self, g, wind, area):
        """Drag and lift of volume g on an exposed area [m2], the wind relative to it [N]."""
        return drag(wind, area) + lift(wind, area, self.row[g, LIFT])

    @ti.func
    def holds(self, g, x):
        """Whether x, seen from the centre of volume g [m], lies in an included shape of it and in no excluded one."""
        included, excluded = False, False
        for s in range(self.shapes):
            k = SHAPES + WIDTH * s
            own = turned_back(x - self.vector(g, k + ARM), self.row[g, k + COSINE], self.row[g, k + SINE])
            if within(own, self.vector(g, k + HALF), self.row[g, k + RADIUS]):
                included |= self.row[g, k + SIGN] > 0.0
                excluded |= self.row[g, k + SIGN] < 0.0
        return included and not excluded

    @ti.func
    def vector(self, g, column):
        return tm.vec3(self.row[g, column], self.row[g, column + 1], self.row[g, column + 2])


@ti.data_oriented
class Aimed:
    """Some of the volumes: what a target feels of gusts that do not all act on it."""

    blows = True

    def __init__(self, gusts: Gusts, numbers: list[int]) -> None:
        self.gusts, self.n = gusts, len(numbers)
        self.needs_area = any(gusts.volumes[g].wind_speed > 0.0 for g in numbers)
        self.number = ti.field(int, shape=self.n)
        self.number.from_numpy(np.array(numbers, dtype=np.int32))

    @property
    def since(self) -> float:
        """That of the gusts [s]."""
        return self.gusts.since

    @property
    def step(self) -> float:
        """That of the gusts [s]."""
        return self.gusts.step

    def on(self, target: Target) -> "Gusts | Aimed | Still":
        """The wind that a target feels."""
        return self.gusts.on(target)

    def advance(self, dt: float) -> None:
        """The gusts go on by themselves."""

    def strengthen(self, factor: float) -> None:
        """Blow so many times as strongly as the scene says: all of the gusts."""
        self.gusts.strengthen(factor)

    def shown(self) -> Air:
        """All of the gusts."""
        return self.gusts.shown()

    @ti.func
    def hear(self, since, step):
        """All of the gusts."""
        self.gusts.hear(since, step)

    @ti.func
    def force(self, key, position, velocity, area, mass):
        """(2.26), summed over these volumes [N]."""
        total = tm.vec3(0.0)
        for k in range(self.n):
            total += self.gusts.push(self.number[k], key, position, velocity, area, mass)
        return total
