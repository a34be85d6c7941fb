"""Wind as volumes of moving air (thesis 2.3 and 5.1.2, Algorithm 1).

In a volume `acceleration` and `noise` are the listing's force field, as strong on every particle inside, deep
or shallow: stylised, some hundred thousand times a real wind. `wind_speed` is apart from them: the stress (2.20) and
the lift (2.23) on exposed surface. Volumes add up.
"""

from collections.abc import Iterator
from math import atan2, cos, degrees, hypot, inf, radians, sin
from typing import Any, ClassVar, Literal, get_args

import numpy as np
from pydantic import Field

from ocean_sim.basin import Basin
from ocean_sim.columns import Columns
from ocean_sim.kernel_library import ti, tm
from ocean_sim.model import Faults, NotNegative3, Vector2, Vector3, below, quantity
from ocean_sim.parts import LedgerRow, SceneFacts, WindConfig
from ocean_sim.random_numbers import numpy_uniform3
from ocean_sim.runtime import in_kernels
from ocean_sim.wind import DeviceRow, Drawing, StillAir, Target, Wind
from ocean_sim.wind.shared.air_load import drag, lift
from ocean_sim.wind.shared.noise import DRAW_INTERVAL, DRAWS, Noise
from ocean_sim.wind.shared.place import Passages, Patch, Placed, Shape, rotated_back, turned, within
from ocean_sim.wind.shared.schedule import Scheduled
from ocean_sim.wind.shared.warnings import ship_drag_warnings, stylised, velocity_change

NOISE_STREAM = 0x1_0000  # stream of random numbers; the volume's number is added
PASSAGE_STREAM = 0x2_0000  # stream of random numbers; the volume's number is added
SLAB_MARGIN = 1e-4  # by which the slab around a volume is thicker than it

VOLUME = Columns(
    start=3,  # [m] centre when the clock was restarted
    velocity=3,  # [m/s]
    acceleration=3,  # [m/s2]
    noise=3,  # [m/s2]
    wind=3,  # [m/s]
    lift=1,  # lift coefficient
    normal=3,  # of the slab around the volume
    middle=1,  # [m] of the slab along its normal, from the centre
    half_thickness=1,  # [m] of the slab; -1 while the volume does not blow
    centre=3,  # [m] in this step
    slab=1,  # [m] middle of the slab along its normal in this step
)
SHAPE = Columns(
    arm=3,  # [m] from the centre of the volume to that of the shape
    half_size=3,  # [m] of its core
    radius=1,  # [m]
    cosine=1,  # of its yaw
    sine=1,
    sign=1,  # 1: included, -1: cut out; 0: none
)
"""A volume's row: its own columns, and then those of its shapes, one after the other."""


class Volume(Scheduled):
    """One volume of moving air: all included shapes less all excluded ones.

    Its wind may begin, end and follow a `schedule`: the speed, over the highest in the schedule, is a factor on noise
    (random acceleration), acceleration and wind_speed; these last two turn to its heading; the drift stays."""

    include: list[Shape] = Field(min_length=1)
    """Shapes it is made of; the centre of the first is the centre of the volume."""
    exclude: list[Shape] = []
    """Shapes cut out of it."""
    acceleration: Vector3 = quantity("m/s2", (0.0, 0.0, 0.0))
    """Acceleration of everything inside."""
    noise: NotNegative3 = quantity("m/s2", (0.0, 0.0, 0.0))
    """Random acceleration along each axis, uniform between minus and plus this (2.24)."""
    wind_speed: float = quantity("m/s", 0.0, ge=0.0)
    """Wind 10 m above the water, for drag and lift on exposed surface; apart from `acceleration`."""
    lift_coefficient: float = quantity("1", 1.0e-3)
    """C_L of (2.23). The thesis prints none; this one is ours, of the size of C_d."""
    heading_deg: float | None = quantity("deg", None)
    """Direction that the wind blows to, 0 along +z, 90 along +x; none: where `acceleration` points."""
    drift: float | Vector3 = quantity("m/s", 0.0)
    """Velocity of the volume; a number is a speed along its heading."""
    redraw_yaw_deg: Vector2 | None = quantity("deg", None)
    """Smallest and largest yaw of its first shape in later passages; all else turns with it. None: it never turns."""
    redraw_strength: Vector2 = quantity("1", (1.0, 1.0))
    """Smallest and largest factor on `acceleration` and `wind_speed` in later passages."""
    targets: list[Target] | None = None
    """Targets of this volume; null: the targets of the wind."""

    @property
    def ahead(self) -> Vector3:
        """Unit vector of the direction in which the wind blows."""
        heading = self.heading_deg
        angle = atan2(self.acceleration[0], self.acceleration[2]) if heading is None else radians(heading)
        return sin(angle), 0.0, cos(angle)

    @property
    def velocity(self) -> np.ndarray:
        return np.multiply(self.drift, self.ahead) if isinstance(self.drift, (int, float)) else np.array(self.drift)

    @property
    def passing_time(self) -> float:
        """Time [s] for which the drifting volume covers a point on its path; infinite if it does not drift."""
        speed = float(np.linalg.norm(self.velocity))
        return self.include[0].core.chord(self.velocity / speed) / speed if speed else inf

    def blows(self, time: float, dt: float = 0.0) -> tuple[float, float]:
        """Factor on the wind's strength, and its turn [rad] by the schedule, in a step of dt [s] from a time [s] on."""
        if self.course is None:
            return self.blowing(time, dt), 0.0
        speed, heading = self.course.at(time + 0.5 * dt)
        along = degrees(atan2(self.ahead[0], self.ahead[2]))
        fastest = float(self.course.speed.max())
        return self.blowing(time, dt) * (speed / fastest if fastest else 0.0), radians(heading - along)

    @property
    def strongest(self) -> float:
        """Strength that the longest arrow in pictures shows: acceleration [m/s2] or, without one, wind_speed [m/s]."""
        return hypot(*self.acceleration) or self.wind_speed

    @property
    def shapes(self) -> list[tuple[Shape, float]]:
        """Shapes of the volume, each with a sign: 1 if it is included, -1 if it is cut out."""
        return [(shape, 1.0) for shape in self.include] + [(shape, -1.0) for shape in self.exclude]

    def redraw(self, seed: int, number: int, passage: int) -> tuple[float, float]:
        """Turn [rad], strength factor, random by `seed`, of volume `number` on its crossing number `passage`."""
        side, force, _ = numpy_uniform3(seed, PASSAGE_STREAM + number, 0, passage)[0]
        given = self.include[0].core.yaw
        low, high = (radians(a) for a in self.redraw_yaw_deg) if self.redraw_yaw_deg else (given, given)
        weak, strong = self.redraw_strength
        return (low + high + side * (high - low)) / 2 - given, (weak + strong + force * (strong - weak)) / 2

    def outline(self, turn: float) -> tuple[np.ndarray, np.ndarray]:
        """Line segments (n, 2, 3) that draw the included shapes, turned by `turn` [rad], and points (m, 3) for arrows,
        spread over the first shape; both relative to the centre of the volume [m]."""
        first = self.include[0].core
        lines = [turned(shape.core.edges() - first.centre, turn) for shape in self.include]
        return np.concatenate(lines), turned(first.spread() - first.centre, turn)

    def slab(self, turn: float) -> tuple[np.ndarray, float, float]:
        """Thinnest slab, between two planes normal to an axis of the first shape (box, sphere or capsule), around the
        volume turned by `turn` [rad] about the vertical: its unit normal, the distance of its middle from the volume's
        centre along that normal, and half its thickness [m]."""
        cores = [shape.core for shape in self.include]
        slabs = []
        for axis in np.eye(3):
            normal = turned(axis, cores[0].yaw)
            middles = np.array([(core.centre - cores[0].centre) @ normal for core in cores])
            reach = np.array([core.reach(normal) for core in cores]) * (1.0 + SLAB_MARGIN) + SLAB_MARGIN
            low, high = float((middles - reach).min()), float((middles + reach).max())
            slabs.append((turned(normal, turn), (low + high) / 2.0, (high - low) / 2.0))
        return min(slabs, key=lambda slab: slab[2])

    def passages(self, basin: Basin, seed: int, number: int) -> Passages:
        """Repeated crossings of the basin by this volume, which may turn at random each time. `number`: index of the
        volume in the wind, and `seed`, select the random numbers."""
        first, speed = self.include[0].core, float(np.linalg.norm(self.velocity))
        rear = first.reach(self.velocity / speed) if speed else 0.0
        return Passages(first.centre, self.velocity, rear, basin, lambda passage: self.redraw(seed, number, passage))


class Config(Placed, WindConfig):
    """Volumes of moving air, drifting across the basin."""

    example: ClassVar[dict[str, Any]] = {
        "volumes": [{"include": [{"kind": "sphere", "centre": [0.0, 0.0, 0.0], "radius": 1.0}]}]
    }
    kind: Literal["gusts"] = "gusts"
    volumes: list[Volume] = Field(min_length=1)
    """The volumes; their effects add up."""
    targets: list[Target] = ["fluid", "ship"]
    """Targets of the wind, where a volume has none of its own."""
    noise_every: float = quantity("s", DRAW_INTERVAL, ge=0.0)
    """Duration of a draw of the noise. A time step uses each draw for as long as the two overlap, so the noise is
    white in time and stirs the water equally at any time step; 0: a new draw each step, as printed, which stirs it
    less the shorter the step. The default is ours: PhysX's usual step."""

    @property
    def needs_area(self) -> bool:
        return any(self.volumes[g].wind_speed > 0.0 for g in self.aimed("fluid"))

    @property
    def acts_on(self) -> list[Target]:
        return [target for target in get_args(Target) if self.aimed(target)]

    @property
    def is_random(self) -> bool:
        return any(any(v.noise) or v.redraw_yaw_deg or v.redraw_strength != (1.0, 1.0) for v in self.volumes)

    def aimed(self, target: Target) -> list[int]:
        """Indices of the volumes of moving air that act on a target, "fluid" or "ship"."""
        return [g for g, v in enumerate(self.volumes) if target in (self.targets if v.targets is None else v.targets)]

    def problems(self, preflight: SceneFacts) -> Faults:
        for g, volume in enumerate(self.volumes):
            yield from below("volumes", g, faults=volume.schedule_faults())
        yield from self.misframed(preflight)

    def build(self, basin: Basin, seed: int) -> Wind:
        return Gusts(self, basin, seed)

    def ledger(self, preflight: SceneFacts) -> list[LedgerRow]:
        n, numbers = len(self.volumes), len(self.volumes) * row_size(self.volumes) + DRAWS.size
        return [LedgerRow("wind", "moving volumes of air", preflight.word * numbers, f"{n} in wind.volumes")]

    def warnings(self, preflight: SceneFacts) -> Iterator[str]:
        for g, volume in enumerate(self.volumes):
            name, size = f"wind.volumes[{g}]", hypot(*volume.acceleration, *volume.noise)
            if size > 0.0:
                yield stylised(name, size, preflight)
            if any(volume.acceleration):
                yield from velocity_change(name, volume.acceleration, volume.passing_time, preflight)
            yield from (f"{name}: {sentence}" for sentence in volume.end_warnings(preflight.duration))
        if any(self.volumes[g].wind_speed > 0.0 for g in self.aimed("ship")):
            yield from ship_drag_warnings(preflight)


def joined(drawings: list[Drawing]) -> Drawing:
    """Join the drawings of several volumes into one; its arrows have no scale if their units differ."""
    columns = zip(*((drawing.lines, drawing.tails, drawing.arrows) for drawing in drawings))
    lines, tails, arrows = (np.concatenate(column) for column in columns)
    alike, first = len({drawing.unit for drawing in drawings}) == 1, drawings[0]
    return Drawing(lines, tails, arrows, *((first.strongest, first.unit) if alike else ()))


def row_size(volumes: list[Volume]) -> int:
    """Length of each volume's row on the device: VOLUME columns, and SHAPE columns for the most shapes of a volume."""
    return VOLUME.size + SHAPE.size * max(len(volume.shapes) for volume in volumes)


@in_kernels
class Gusts(Wind):
    """Wind of drifting volumes of air; kernels read the numbers of each volume from its row of an array."""

    config: Config

    def __init__(self, config: Config, basin: Basin, seed: int) -> None:
        super().__init__(config)
        self.volumes, self.patch = config.volumes, Patch(config, basin)
        self.loads = any(v.wind_speed > 0.0 for v in self.volumes)
        self.noisy = any(any(v.noise) for v in self.volumes)
        self.passages = [v.passages(basin, seed, g) for g, v in enumerate(self.volumes)]
        self.n, self.shapes = len(self.volumes), max(len(v.shapes) for v in self.volumes)
        self.rows = np.zeros((self.n, row_size(self.volumes)))
        self.half = [0.0] * self.n  # half the thickness of the slabs [m]
        self.row = ti.field(float, shape=self.rows.shape)
        self.noise = Noise(seed, config.noise_every, DeviceRow(DRAWS.size))
        self.blown = [volume.blows(0.0) for volume in self.volumes]
        self.steady = [volume.always and volume.schedule is None for volume in self.volumes]
        for g in range(self.n):
            self._lay_out(g)
            self._set_strength(g)
        self._restart()

    def on(self, target: Target) -> Wind:
        numbers = self.config.aimed(target)
        return self if len(numbers) == self.n else Aimed(self, numbers) if numbers else StillAir()

    def strengthen(self, factor: float) -> None:
        super().strengthen(factor)
        for g in range(self.n):
            self._set_strength(g)
        self._restart()

    def drawing(self) -> Drawing:
        """Outlines of the volumes at present, with arrows along their acceleration, or their wind if they have none."""
        drawings = []
        strongest = max(v.strongest for v in self.volumes)
        for p, volume, (part, turn) in zip(self.passages, self.volumes, self.blown):
            centre, (lines, tails) = p.centre + self.patch.origin, volume.outline(p.turn)
            pushes = any(volume.acceleration)
            push = volume.acceleration if pushes else np.multiply(volume.wind_speed, volume.ahead)
            arrow = self.gain * part * p.strength / (strongest or 1.0) * turned(push, p.turn + turn)
            arrows, unit = np.tile(arrow, (len(tails), 1)), "m/s²" if pushes else "m/s"
            drawings.append(Drawing(lines + centre, tails + centre, arrows, strongest, unit))
        return joined(drawings)

    def follow(self, middle: np.ndarray) -> None:
        self.patch.follow(middle)

    def advance(self, dt: float) -> None:
        """Move the volumes of air by a step dt [s] (thesis, Algorithm 1); set wind, steady and random acceleration."""
        begun, changed = self.clock.time, False
        self.clock.advance(dt)
        for g, (passage, volume) in enumerate(zip(self.passages, self.volumes)):
            before, blown = passage.number, self.blown[g]
            passage.advance(dt)
            if not self.steady[g]:
                self.blown[g] = volume.blows(begun, dt)
            if passage.number != before:
                self._lay_out(g)
            if passage.number != before or self.blown[g] != blown:
                self._set_strength(g)
                changed = True
        if changed or self.clock.is_due():
            self._restart()
        if self.noisy:
            self.noise.advance()

    def _lay_out(self, g: int) -> None:
        """Write shapes of volume g, as turned now, and the slab of space around them into its row on the host."""
        volume, turn = self.volumes[g], self.passages[g].turn
        centre = volume.include[0].core.centre
        normal, middle, self.half[g] = volume.slab(turn)
        self.rows[g, VOLUME.normal : VOLUME.half_thickness] = *normal, middle
        numbers: list[float] = []
        for shape, sign in volume.shapes:
            c = shape.core
            arm, yaw = turned(c.centre - centre, turn), c.yaw + turn
            numbers += [*arm, *c.half, c.radius, cos(yaw), sin(yaw), sign]
        self.rows[g, VOLUME.size : VOLUME.size + len(numbers)] = numbers

    def _set_strength(self, g: int) -> None:
        """Write acceleration, noise (random acceleration) and wind of volume g at present into its row on the host."""
        p, volume, (part, turn) = self.passages[g], self.volumes[g], self.blown[g]
        part *= self.gain
        acceleration = part * p.strength * turned(volume.acceleration, p.turn + turn)
        wind = part * p.strength * volume.wind_speed * turned(volume.ahead, p.turn + turn)
        numbers = (*acceleration, *np.multiply(part, volume.noise), *wind)
        self.rows[g, VOLUME.acceleration : VOLUME.normal] = *numbers, volume.lift_coefficient
        self.rows[g, VOLUME.half_thickness] = self.half[g] if any(numbers) else -1.0

    def _restart(self) -> None:
        """Restart the clock: write the volumes' present centres into their rows, and copy these to the device."""
        for numbers, passage in zip(self.rows, self.passages):
            numbers[VOLUME.start : VOLUME.acceleration] = (*passage.centre, *passage.velocity)
        self.row.from_numpy(self.rows)
        if self.noisy:
            self.noise.restart(self.clock.time)
        self.clock.restart()

    @ti.func
    def set_clock(self, since, step):
        ti.loop_config(serialize=True)
        for g in range(self.n):
            centre = self.vector(g, VOLUME.start) + since * self.vector(g, VOLUME.velocity)
            for k in ti.static(range(3)):
                self.row[g, VOLUME.centre + k] = centre[k]
            self.row[g, VOLUME.slab] = centre.dot(self.vector(g, VOLUME.normal)) + self.row[g, VOLUME.middle]
        if ti.static(self.noisy):
            self.noise.set_clock(since, step)

    @ti.func
    def force(self, key, position, velocity, area, bend, mass):
        """Force [N] on a particle or voxel: (2.26) of the thesis, summed over the volumes that contain its `position`
        [m]. `key`: its number, from which random acceleration (noise) is drawn; `area`: exposed [m2]; no `bend`."""
        total, x = tm.vec3(0.0), self.patch.seen(position)
        for g in range(self.n):
            total += self.push(g, key, x, velocity, area, mass)
        return total

    @ti.func
    def push(self, g, key, position, velocity, area, mass):
        """Force [N] of volume number g on a particle or voxel at `position` [m], in the wind's axes; 0 outside the
        volume. `key`: its number, from which random acceleration is drawn; other arguments as in `Wind.force`."""
        total, off = tm.vec3(0.0), position.dot(self.vector(g, VOLUME.normal)) - self.row[g, VOLUME.slab]
        if ti.abs(off) <= self.row[g, VOLUME.half_thickness]:
            if self.contains(g, position - self.vector(g, VOLUME.centre)):
                total += mass * self.vector(g, VOLUME.acceleration)
                if ti.static(self.noisy):
                    total += mass * self.vector(g, VOLUME.noise) * self.noise.of(NOISE_STREAM + g, key)
                if ti.static(self.loads):
                    wind = self.vector(g, VOLUME.wind)
                    if wind.dot(wind) > 0.0:
                        total += self.load(g, wind - velocity, area.norm())
        return total

    @ti.func
    def load(self, g, wind, area):
        """Drag and lift [N] by volume g on an exposed area [m2]; `wind`: air velocity relative to that area [m/s]."""
        return drag(wind, area) + lift(wind, area, self.row[g, VOLUME.lift])

    @ti.func
    def contains(self, g, x):
        """True if volume g contains x, relative to its centre [m]: in an included shape, and in no excluded one."""
        included, excluded = False, False
        for s in range(self.shapes):
            k = VOLUME.size + SHAPE.size * s
            arm = x - self.vector(g, k + SHAPE.arm)
            own = rotated_back(arm, self.row[g, k + SHAPE.cosine], self.row[g, k + SHAPE.sine])
            if within(own, self.vector(g, k + SHAPE.half_size), self.row[g, k + SHAPE.radius]):
                included |= self.row[g, k + SHAPE.sign] > 0.0
                excluded |= self.row[g, k + SHAPE.sign] < 0.0
        return included and not excluded

    @ti.func
    def vector(self, g, column):
        """Vector (3,) in the row of numbers of volume g: three columns from `column` on."""
        return tm.vec3(self.row[g, column], self.row[g, column + 1], self.row[g, column + 2])


@in_kernels
class Aimed(Wind):
    """Wind of some of the volumes of moving air of a `Gusts`: those that act on a target, the fluid or ships."""

    def __init__(self, gusts: Gusts, numbers: list[int]) -> None:
        """`numbers`: indices of the volumes in `gusts` that act on the target."""
        super().__init__(gusts.config, gusts.clock)
        self.gusts, self.n = gusts, len(numbers)
        self.number = ti.field(int, shape=self.n)
        self.number.from_numpy(np.array(numbers, dtype=np.int32))

    def on(self, target: Target) -> Wind:
        return self.gusts.on(target)

    @ti.func
    def set_clock(self, since, step):
        self.gusts.set_clock(since, step)

    @ti.func
    def force(self, key, position, velocity, area, bend, mass):
        total, x = tm.vec3(0.0), self.gusts.patch.seen(position)
        for k in range(self.n):
            total += self.gusts.push(self.number[k], key, x, velocity, area, mass)
        return total
