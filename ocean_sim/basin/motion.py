"""Prescribed motion of the tank, of a piston wavemaker and of gates: displacement, velocity and acceleration in time.

The tank is simulated in its own axes. Its motion then is an acceleration of the water (`fluid/sph/body_force.py`), and
results are given in the axes of the tank.
"""

import re
from abc import abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from math import atanh, cos, cosh, pi, radians, sin, sqrt, tanh
from typing import Annotated, Any, Literal, NamedTuple, cast

import numpy as np
from pydantic import BeforeValidator, Field

from ocean_sim import waves
from ocean_sim.files import csv_file
from ocean_sim.files.input_file import Checked, FileName, Rule, Unreadable, display_path
from ocean_sim.model import Faults, Model, Point, Vector3, quantity

Axis = Literal["x", "y", "z", "roll_x", "roll_y", "roll_z"]
Law = Callable[[float], tuple[float, float, float]]  # time [s] -> displacement, velocity, acceleration

FREQUENCY_SAMPLES = 4000  # samples of a recorded motion for its mean frequency
SMALL_ROLL = 0.5  # [deg] of a tank, which usually rolls by some degrees
JOLT_SHARE = 0.05  # share of the highest speed of a recorded motion above which its speed at an end is a jump
FEWEST_ROWS = 4  # of a cubic spline
ONE_AXIS = Rule("it has the column of one axis, such as x_m, roll_z_rad or roll_z_deg, or `axis` says which")
CHECKS = (
    Checked("Path of an obstacle, `basin.obstacles[].motion.file`: a table over time of four rows or more", ()),
    Checked("Motion of the tank, `basin.motion.file`: a table over time of four rows or more", (ONE_AXIS,)),
    Checked("Path of a wavemaker, `basin.wavemaker.file`: a table over time of four rows or more", ()),
)
LONGEST_PATH = 300.0  # [duration of a run] of the path of a wavemaker; beyond it times are likely in milliseconds
PATH_MOMENTS = 400  # times at which the path of an obstacle is checked
PATH_COLUMNS = ("x_m", "y_m", "z_m")  # columns of a table of ways
SLICE_AXES = ("x", "y", "roll_z")  # along and about which a vertical slice can move
BREAKING_SOLITARY = 0.78  # height over depth at which a solitary wave breaks (McCowan 1894)
STEEP_SOLITARY = 0.5  # height over depth above which theory of first order is far from a solitary wave
STROKE_END_TANH = 0.999  # tanh of the wave's phase at both ends of the stroke for a solitary wave (Goring 1979)
NEWTON_STEPS = 8  # from 0, to machine precision


@dataclass(frozen=True)
class Frame:
    """Motion of the tank's axes in the world at one time; vectors are in the axes of the tank."""

    angle: np.ndarray  # (3,) by which they are turned, along the axis of the turn [rad]
    displacement: np.ndarray  # (3,) of the pivot [m]
    velocity: np.ndarray  # (3,) of the pivot [m/s]
    acceleration: np.ndarray  # (3,) of the pivot [m/s2]
    rate: np.ndarray  # (3,) omega [rad/s]
    angular_acceleration: np.ndarray  # (3,) alpha [rad/s2]
    pivot: np.ndarray  # (3,) [m] in the tank

    def push(self, gravity: np.ndarray) -> np.ndarray:
        """(3,) apparent gravity g - a [m/s2], tank's axes; a: acceleration of the pivot; `gravity`: g, world axes."""
        return turned(gravity, -self.angle) - self.acceleration


def turned(vector: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Vector (3,) rotated about the direction of `angle` (3,), by its length [rad], by the right hand (Rodrigues)."""
    size = float(np.linalg.norm(angle))
    if size == 0.0:
        return np.asarray(vector, dtype=float)
    n = angle / size
    return vector * cos(size) + np.cross(n, vector) * sin(size) + n * (n @ vector) * (1.0 - cos(size))


def ramp_law(law: Law, ramp: float) -> Law:
    """Law of motion `law` times 10 s^3 - 15 s^4 + 6 s^5, s = t / `ramp` [s] up to 1: acceleration does not jump."""

    def grown(t: float) -> tuple[float, float, float]:
        x, v, a = law(t)
        if t >= ramp:
            return x, v, a
        s = max(t, 0.0) / ramp
        r = s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
        r_t = 30.0 * (s * (1.0 - s)) ** 2 / ramp
        r_tt = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / ramp**2
        return r * x, r * v + r_t * x, r * a + 2.0 * r_t * v + r_tt * x

    return grown


def spline_law(times: np.ndarray, moved: np.ndarray) -> Law:
    """Law of motion by a cubic spline through displacements `moved` (n,) at times (n,) [s], at rest outside them."""
    from scipy.interpolate import CubicSpline

    spline = CubicSpline(times, moved)

    def law(t: float) -> tuple[float, float, float]:
        if not times[0] <= t <= times[-1]:
            return float(moved[0 if t < times[0] else -1]), 0.0, 0.0
        return float(spline(t)), float(spline(t, 1)), float(spline(t, 2))

    return law


def solitary_law(height: float, depth: float, gravity: float) -> tuple[Law, float, float]:
    """Law of the piston of a solitary wave (Goring 1979, Caltech report KH-R-38), its stroke [m] and duration [s].

    The wave, of `height` H [m] in a `depth` d [m] under `gravity` g [m/s2], is eta = H / cosh^2 theta, with theta =
    kappa (c t - x), kappa = sqrt(3 H / 4 d) / d, c = sqrt(g (d + H)). The wall moves with the mean velocity of water
    before it, xi' = c eta / (d + eta), so xi = H / (kappa d) tanh theta, theta = kappa (c t - xi), from mid-stroke."""
    ratio, c = height / depth, sqrt(gravity * (depth + height))
    kappa = sqrt(0.75 * ratio) / depth
    half = STROKE_END_TANH * ratio / kappa
    duration = 2.0 * (atanh(STROKE_END_TANH) / kappa + half) / c

    def law(t: float) -> tuple[float, float, float]:
        if not 0.0 <= t <= duration:
            return (0.0 if t < 0.0 else 2.0 * half), 0.0, 0.0
        phase, theta = kappa * c * (t - 0.5 * duration), 0.0
        for _ in range(NEWTON_STEPS):  # theta + H/d tanh theta = phase
            theta += (phase - theta - ratio * tanh(theta)) / (1.0 + ratio / cosh(theta) ** 2)
        eta = height / cosh(theta) ** 2
        v = c * eta / (depth + eta)
        a = -2.0 * kappa * (c - v) * eta * tanh(theta) * c * depth / (depth + eta) ** 2
        return half + ratio / kappa * tanh(theta), v, a

    return law, 2.0 * half, duration


class Tank(Model):
    """Keys common to all motions of the tank."""

    about: Point | None = quantity("m", None)
    """The point about which it rolls; in 2-D [x, y]; by default the centre of the still surface."""

    def axis_problems(self, axis: str, basin: waves.Tank) -> Faults:
        """Yield faults (key path, sentence) of a motion along or about an axis in a basin."""
        if self.about is not None and len(self.about) != basin.dimension:
            yield ("about",), f"a point of this basin has {basin.dimension} numbers, got {len(self.about)}"
        if basin.dimension == 2 and axis not in SLICE_AXES:
            slices = f"a 2-D basin, in x-y, moves along x or y or about z ({', '.join(SLICE_AXES)}), not {axis!r}"
            yield ("axis",), slices


def overturn_warnings(axis: str, angle: float) -> Iterator[str]:
    """Warn if the tank rolls (`axis`: as `roll_z`) by an `angle` [rad] of half a turn or more: most likely degrees."""
    if axis.startswith("roll") and angle >= pi:
        yield f"the tank rolls by {angle:.4g} rad, half a turn or more; {angle:.4g} deg are {radians(angle):.4g} rad"


class Harmonic(Tank):
    """Motion of the tank as amplitude sin(2 pi t / period + phase), along an axis or about it."""

    kind: Literal["harmonic"] = "harmonic"
    axis: Axis
    """`x`, `y` and `z`: along it [m]; `roll_x`, `roll_y` and `roll_z`: about it, by the right hand [rad]."""
    amplitude: float = quantity("m or rad")
    """Half the distance, or half the angle, from end to end."""
    period: float = quantity("s", gt=0.0)
    """Period."""
    phase_deg: float = quantity("deg", 0.0)
    """Phase at time 0; with 90 a cosine."""
    ramp: float | None = quantity("s", None, ge=0.0)
    """Time over which the motion grows to its amplitude, from rest at the middle whatever its phase; by default one
    period. With 0 the tank, and the water with it, starts with the position and speed of its phase."""

    @property
    def mean_frequency(self) -> float:
        """Angular frequency of the motion [rad/s]."""
        return 2.0 * pi / self.period

    def problems(self, basin: waves.Tank) -> Faults:
        """Faults (key path, sentence) of this motion in a basin."""
        return self.axis_problems(self.axis, basin)

    def warnings(self, duration: float) -> Iterator[str]:
        """Warn of a doubtful motion in a run of `duration` [s]."""
        return overturn_warnings(self.axis, abs(self.amplitude))

    def build(self) -> "TankMotion":
        omega, phase = 2.0 * pi / self.period, radians(self.phase_deg)

        def law(t: float) -> tuple[float, float, float]:
            x = self.amplitude * sin(omega * t + phase)
            return x, self.amplitude * omega * cos(omega * t + phase), -(omega**2) * x

        return TankMotion(self.axis, self.about, ramp_law(law, self.period if self.ramp is None else self.ramp))


class Recorded(Tank):
    """The motion in a file, smooth between its rows (a cubic spline); the tank stands still before and after them."""

    kind: Literal["file"] = "file"
    file: FileName
    """CSV with columns `time_s` and that of an axis, with its unit or without: `x_m`, `y_m`, `z_m`, `roll_x_rad`,
    `roll_y_rad` or `roll_z_rad`; `roll_x_deg` and so on are in degrees."""
    axis: Axis | None = None
    """Axis to take of several columns; by default the only one."""

    @cached_property
    def table(self) -> csv_file.Table:
        """Table in the file; raises Unreadable."""
        return csv_file.Table(self.file)

    def rows(self) -> tuple[Axis, np.ndarray, np.ndarray]:
        """Axis, times (n,) [s] and displacements (n,) [m or rad] in the file; raises Unreadable."""
        table = self.table
        axes = {name: re.sub("(?<=roll_[xyz])_deg$|_rad$|_m$", "", name) for name in table}
        wanted = Axis.__args__ if self.axis is None else (self.axis,)  # type: ignore[attr-defined]
        names = [name for name in table if axes[name] in wanted]
        if len(names) != 1:
            there = f"columns {' and '.join(names)}" if names else f"no column of {self.axis or 'an axis'}"
            raise ONE_AXIS.broken(self.file, f"it has {there}")
        times, moved = table.series(names[0], fewest=FEWEST_ROWS)
        return cast(Axis, axes[names[0]]), times, np.radians(moved) if names[0].endswith("_deg") else moved

    @property
    def mean_frequency(self) -> float:
        """Mean angular frequency [rad/s]: standard deviation of velocity over that of displacement; 0 at rest."""
        (_, times, _), law = self.rows(), self.build().law
        found = np.array([law(t) for t in np.linspace(times[0], times[-1], FREQUENCY_SAMPLES)])
        moved, speed = found.std(axis=0)[:2]
        return float(speed / moved) if moved > 0.0 else 0.0

    def problems(self, basin: waves.Tank) -> Faults:
        try:
            return self.axis_problems(self.rows()[0], basin)
        except Unreadable as error:
            return [(("file",), f"{error}")]

    def warnings(self, duration: float) -> Iterator[str]:
        (axis, times, moved), law = self.rows(), self.build().law
        fastest = max(abs(law(float(t))[1]) for t in np.linspace(times[0], times[-1], FREQUENCY_SAMPLES))
        unit = "rad/s" if axis.startswith("roll") else "m/s"
        yield from csv_file.unreached_times_warning(display_path(self.file), times, duration, "the tank never moves")
        yield from overturn_warnings(axis, float(np.abs(moved).max()))
        most = float(np.degrees(np.abs(moved).max()))
        if 0.0 < most < SMALL_ROLL and f"{axis}_deg" in self.table:
            yield f"the tank rolls by {most:.3g} deg at most: is {axis}_deg in radians?"
        for time, end, apart in ((times[0], "begin", "before"), (times[-1], "end", "after")):
            speed = law(float(time))[1]
            if 0.0 < time < duration and abs(speed) > JOLT_SHARE * fastest:
                opening = f"the tank's recorded motion {end}s at {time:.4g} s with {speed:.3g} {unit}, and the tank"
                yield f"{opening} stands still {apart} it: water does not feel that jolt; let the rows {end} at rest"

    def build(self) -> "TankMotion":
        """Motion of the tank as recorded in the file; raises Unreadable."""
        axis, times, moved = self.rows()
        return TankMotion(axis, self.about, spline_law(times, moved))


def kind_by_keys(*models: type[Model]) -> BeforeValidator:
    """Validator that adds a missing `kind` to a mapping: that of the first of `models` with most of its keys. Raises
    ValueError for a key that the model of the kind lacks and another model has."""
    kinds = {model.model_fields["kind"].default: model.model_fields.keys() for model in models}
    known = {key: kind for kind, own in reversed(kinds.items()) for key in own}

    def with_its_kind(written: Any) -> Any:
        if not isinstance(written, dict):
            return written
        keys = [key for key in written if key in known]
        kind = written.get("kind", max(kinds, key=lambda each: sum(key in kinds[each] for key in keys)))
        foreign = [key for key in keys if key not in next((own for each, own in kinds.items() if each == kind), known)]
        if foreign:
            raise ValueError(f"kind: {kind} has no {' and no '.join(foreign)}; kind: {known[foreign[0]]} has")
        return written | {"kind": kind}

    return BeforeValidator(with_its_kind)


Motion = Annotated[Harmonic | Recorded, Field(discriminator="kind"), kind_by_keys(Harmonic, Recorded)]


@dataclass(frozen=True)
class TankMotion:
    """Prescribed motion of the tank along or about one axis."""

    axis: Axis
    about: tuple[float, ...] | None
    law: Law

    @cached_property
    def direction(self) -> np.ndarray:
        """(3,) unit vector of the axis."""
        return np.eye(3)["xyz".index(self.axis[-1])]

    def at(self, time: float) -> Frame:
        """Motion of the tank at a time [s]: displacement, velocity and acceleration, or angle and the angle's rates."""
        x, v, a = (value * self.direction for value in self.law(time))
        still, pivot = np.zeros(3), np.array((*(self.about or (0.0, 0.0)), 0.0)[:3])
        if self.axis.startswith("roll"):
            return Frame(x, still, still, still, v, a, pivot)
        return Frame(still, x, v, a, still, still, pivot)


class Path(NamedTuple):
    """Motion of a piston wavemaker, positive into the basin, and the waves that it makes."""

    law: Law
    retreat: float  # farthest displacement out of the basin [m]
    advance: float  # farthest displacement into it [m]
    sea: waves.Components | None = None  # waves far away by linear theory; None of a motion without a period


class Wavemaker(Model):
    """Keys common to all wavemakers: a wall that moves as a whole (a piston)."""

    wall: Literal["x_min", "x_max", "z_min", "z_max"] = "x_min"
    """The wall that moves; its waves go into the basin."""

    def problems(self, basin: waves.Tank, side: str) -> Faults:
        """Yield faults (key path, sentence) of this wavemaker; `side`: kind of its wall, such as `reflecting`."""
        if basin.dimension == 2 and self.wall.startswith("z"):
            yield ("wall",), "a 2-D basin, in x-y, has no walls along z"
        elif side not in ("reflecting", "no_slip"):
            yield ("wall",), f"a piston is a reflecting or no_slip wall; {self.wall} is {side}"

    @abstractmethod
    def warnings(self, basin: waves.Tank, duration: float) -> Iterator[str]:
        """Warn of a doubtful motion in a run of `duration` [s]."""

    @abstractmethod
    def path(self, depth: float, gravity: float) -> Path:
        """Motion of the piston in water of a depth [m] under a downward gravity [m/s2]."""


class TrainWavemaker(Wavemaker, waves.WaveTrain):
    """Regular or random waves by linear theory, from which the stroke follows."""

    kind: Literal["train"] = "train"
    ramp: float | None = quantity("s", None, ge=0.0)
    """Time over which the motion grows; by default one period (of a spectrum its peak period)."""

    @property
    def growth(self) -> float:
        """Time [s] over which the motion grows to its full amplitude."""
        return self.scale[1] if self.ramp is None else self.ramp

    def problems(self, basin: waves.Tank, side: str) -> Faults:
        yield from ((self.height_key, sentence) for sentence in waves.basin_faults(basin, *self.scale))
        if self.spectrum is not None and self.spectrum.heading_deg is not None:
            yield ("spectrum", "heading_deg"), "the waves of a piston go away from its wall: leave this out"
        yield from super().problems(basin, side)

    def warnings(self, basin: waves.Tank, duration: float) -> Iterator[str]:
        return waves.cut_short(duration, self.growth)

    def path(self, depth: float, gravity: float) -> Path:
        """Motion of the piston: the sum over the waves of S/2 sin(omega t - phase), S the stroke (Biesel & Suquet
        1951). Far away each wave is a cos(k s - omega t + phase), s the distance from the wall's rest position."""
        sea = self.train(np.array([1.0, 0.0]), depth, gravity)
        omega, half = sea.omega, sea.amplitude / waves.piston_transfer(sea.wavenumber * depth)

        def steady(time: float) -> tuple[float, float, float]:
            angle = omega * time - sea.phase
            x, v = half * np.sin(angle), half * omega * np.cos(angle)
            return float(x.sum()), float(v.sum()), -float((omega**2 * x).sum())

        return Path(ramp_law(steady, self.growth), float(half.sum()), float(half.sum()), sea)


class SolitaryWavemaker(Wavemaker):
    """One solitary wave: the wall moves once into the basin and stays there (Goring 1979)."""

    kind: Literal["solitary"] = "solitary"
    height: float = quantity("m", gt=0.0)
    """Height of the crest over the still water; less than 0.78 of the depth."""
    start: float = quantity("s", 0.0, ge=0.0)
    """Time at which the wall begins to move."""

    def problems(self, basin: waves.Tank, side: str) -> Faults:
        yield from ((("height",), sentence) for sentence in waves.basin_faults(basin))
        if self.height >= (most := BREAKING_SOLITARY * basin.depth):
            lower = f"on {basin.depth:g} m of water it is lower than {most:.3g} m"
            yield ("height",), f"a solitary wave of {self.height:g} m would break: {lower}"
        yield from super().problems(basin, side)

    def warnings(self, basin: waves.Tank, duration: float) -> Iterator[str]:
        ratio = self.height / basin.depth
        end = self.start + solitary_law(self.height, basin.depth, waves.downward_gravity(basin))[2]
        if duration < end:
            yield f"the run ends at {duration:.4g} s, and the wavemaker moves until {end:.4g} s"
        if ratio > STEEP_SOLITARY:
            steep = f"a solitary wave of {ratio:.2g} of the depth is lower than asked for and trails others"
            yield f"{steep}: the wavemaker's theory holds up to about {STEEP_SOLITARY:g}"

    def path(self, depth: float, gravity: float) -> Path:
        law, stroke, _ = solitary_law(self.height, depth, gravity)
        return Path(lambda t: law(t - self.start), 0.0, stroke)


class RecordedWavemaker(Wavemaker):
    """The path in a file, smooth between its rows (a cubic spline); the wall stands still before and after them."""

    kind: Literal["file"] = "file"
    file: FileName
    """CSV with columns `time_s` and `x_m`, the displacement of any wall into the basin from its place at time 0."""

    def rows(self) -> list[np.ndarray]:
        """Times (n,) [s] and displacements (n,) [m] in the file; raises Unreadable."""
        return csv_file.Table(self.file).series("x_m", fewest=FEWEST_ROWS)

    def problems(self, basin: waves.Tank, side: str) -> Faults:
        yield from super().problems(basin, side)
        try:
            self.rows()
        except Unreadable as error:
            yield ("file",), f"{error}"
        if basin.closed:
            yield ("file",), "waves need a free surface; this basin has none"

    def warnings(self, basin: waves.Tank, duration: float) -> Iterator[str]:
        path, (times, moved) = display_path(self.file), self.rows()
        yield from csv_file.unreached_times_warning(path, times, duration, "the wavemaker never moves")
        fastest, c = np.abs(np.diff(moved) / np.diff(times)).max(), sqrt(waves.downward_gravity(basin) * basin.depth)
        if fastest > c:
            fast = f"moves at up to {fastest:.3g} m/s, faster than long waves, {c:.3g} m/s"
            yield f"the wavemaker's path in {path} {fast}: is x_m in metres, and time_s in seconds?"
        if times[-1] > LONGEST_PATH * duration:
            long = f"goes on to {times[-1]:.4g} s, and the run to {duration:g} s"
            yield f"the wavemaker's path in {path} {long}: are its times in milliseconds?"

    def path(self, depth: float, gravity: float) -> Path:
        """Motion of the piston as recorded in the file, whatever `depth` and `gravity`; raises Unreadable."""
        times, moved = self.rows()
        law = spline_law(times, moved - spline_law(times, moved)(0.0)[0])
        x = [law(t)[0] for t in np.linspace(0.0, max(times[-1], 0.0), FREQUENCY_SAMPLES).tolist()]
        return Path(law, -min(x), max(x))


AnyWavemaker = Annotated[
    TrainWavemaker | SolitaryWavemaker | RecordedWavemaker,
    Field(discriminator="kind"),
    kind_by_keys(TrainWavemaker, SolitaryWavemaker, RecordedWavemaker),
]


@dataclass(frozen=True)
class Piston:
    """Motion of a wavemaker, a wall that moves as a whole, in water of a depth [m] under a downward gravity [m/s2]."""

    maker: Wavemaker
    depth: float
    gravity: float

    @cached_property
    def path(self) -> Path:
        """Motion of the wall, positive into the basin; raises Unreadable if it lies in a file that cannot be read."""
        return self.maker.path(self.depth, self.gravity)

    def at(self, time: float) -> tuple[float, float, float]:
        """Displacement [m], velocity [m/s] and acceleration [m/s2] of the wall along +x or +z at a time [s]."""
        x, v, a = self.path.law(time)
        inward = 1.0 if self.maker.wall.endswith("min") else -1.0
        return inward * x, inward * v, inward * a


class Moved(NamedTuple):
    """Displacement, velocity and acceleration of an obstacle at one time, (3,) each."""

    way: np.ndarray  # from where it was at first [m]
    velocity: np.ndarray  # [m/s]
    acceleration: np.ndarray  # [m/s2]


NOT_MOVED = Moved(np.zeros(3), np.zeros(3), np.zeros(3))


class Gate(Model):
    """Motion of an obstacle: from `start` on with `velocity` and `acceleration`, or as measured, in a `file`."""

    velocity: Vector3 = quantity("m/s", (0.0, 0.0, 0.0))
    """Velocity of the obstacle at `start`."""
    acceleration: Vector3 = quantity("m/s2", (0.0, 0.0, 0.0))
    """Acceleration from `start` on; that of a gate that a heavy weight pulls up is at most [0, 9.81, 0]."""
    file: FileName | None = None
    """CSV file of its path, in place of both: `time_s` after `start`, and `x_m`, `y_m` or `z_m` or several of them,
    smooth between the rows (a cubic spline). It stands still before and after them."""
    start: float = quantity("s", 0.0, ge=0.0)
    """Time at which it starts to move."""
    end: float | None = quantity("s", None, gt=0.0)
    """Time at which it has left: from then on it is neither in the water nor in pictures. null: it stays."""

    def contradictions(self) -> Iterator[str]:
        if self.file is not None and (any(self.velocity) or any(self.acceleration)):
            yield "give either the file of its way, or velocity and acceleration"
        if self.end is not None and self.end <= self.start and self.moves:
            yield f"it leaves at {self.end:g} s, before it starts to move at {self.start:g} s"

    @property
    def moves(self) -> bool:
        """True if the obstacle moves before it is removed from the basin."""
        return self.file is not None or any(self.velocity) or any(self.acceleration)

    def rows(self) -> tuple[np.ndarray, np.ndarray]:
        """Times (n,) [s] and displacements (n, 3) [m] in the file of this motion; raises Unreadable."""
        assert self.file is not None
        table = csv_file.Table(self.file)
        axes = [axis for axis in PATH_COLUMNS if axis in table] or list(PATH_COLUMNS)
        times, *ways = table.series(*axes, fewest=FEWEST_ROWS)
        along = dict(zip(axes, ways, strict=True))
        return times, np.stack([along.get(axis, np.zeros(len(times))) for axis in PATH_COLUMNS], axis=1)

    def warnings(self, duration: float) -> list[str]:
        """Warn if the file of this motion has rows after the end of a run of `duration` [s]."""
        if self.file is None:
            return []
        path, times = display_path(self.file), self.rows()[0] + self.start
        return csv_file.unreached_times_warning(path, times, duration, "the obstacle never moves")

    @cached_property
    def laws(self) -> list[Callable[[float], tuple[float, float, float]]]:
        """Law of motion along each axis from its file: displacement, velocity and acceleration after `start` [s]."""
        times, ways = self.rows()
        return [spline_law(times, way) for way in ways.T]

    def at(self, time: float) -> Moved | None:
        """Displacement, velocity and acceleration of the obstacle at a time [s]; None once it has left the basin."""
        if self.end is not None and time >= self.end:
            return None
        t = time - self.start
        if self.file is not None:
            way, velocity, acceleration = np.array([law(t) for law in self.laws]).T
            return Moved(way, velocity, acceleration)
        if t < 0.0:
            return NOT_MOVED
        v, a = np.array(self.velocity), np.array(self.acceleration)
        return Moved(v * t + 0.5 * a * t * t, v + a * t, a)

    def moments(self, until: float) -> np.ndarray:
        """Closely spaced times (n,) [s] before `until` [s] at which the obstacle is in the basin, to test its path."""
        last = until if self.end is None else min(until, self.end)
        return np.linspace(0.0, last, PATH_MOMENTS, endpoint=False)

    def fastest(self, until: float) -> float:
        """Highest speed [m/s] of the obstacle before the time `until` [s]."""
        seen = (self.at(float(time)) for time in self.moments(until))
        return max(float(np.linalg.norm(moved.velocity)) for moved in seen if moved is not None)
