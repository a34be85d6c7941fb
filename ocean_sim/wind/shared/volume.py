"""A volume of moving air, as a scene describes it: its shapes, what it blows, and how it crosses the basin."""

from math import atan2, cos, degrees, hypot, inf, radians, sin

import numpy as np
from pydantic import Field

from ocean_sim.basin import Basin
from ocean_sim.model import Vector2, Vector3, quantity
from ocean_sim.random_numbers import numpy_uniform3
from ocean_sim.wind import Target
from ocean_sim.wind.shared.noise import NoiseSize
from ocean_sim.wind.shared.passages import Passages
from ocean_sim.wind.shared.schedule import Scheduled
from ocean_sim.wind.shared.shapes import Shape, turned

PASSAGES = 0x2_0000  # stream of random numbers; the volume's number is added
ROUNDING = 1e-4  # by which the slab around a volume is thicker than it


class Volume(Scheduled):
    """One volume of moving air: all included shapes less all excluded ones.

    Its wind may begin, end and follow a `schedule`: the speed, over the highest in the schedule, is a factor on
    acceleration, noise and wind_speed, which turn to the schedule's heading; the drift of the volume stays as it is."""

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
    """C_L of (2.23). The thesis prints none; this one is ours, of the size of C_d."""
    heading_deg: float | None = quantity("deg", None)
    """Where the wind goes to, 0 along +z, 90 along +x; none: where `acceleration` points."""
    drift: float | Vector3 = quantity("m/s", 0.0)
    """Velocity of the volume; a number is a speed along its heading."""
    redraw_yaw_deg: Vector2 | None = quantity("deg", None)
    """Smallest and largest yaw of its first shape in later passages; all else turns with it. None: it never turns."""
    redraw_strength: Vector2 = quantity("1", (1.0, 1.0))
    """Smallest and largest factor on `acceleration` and `wind_speed` in later passages."""
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

    @property
    def strongest(self) -> float:
        """The most that an arrow in the volume stands for [m/s2], or [m/s] where nothing but wind_speed is given."""
        return hypot(*self.acceleration) or self.wind_speed

    @property
    def shapes(self) -> list[tuple[Shape, float]]:
        """All shapes, with 1 for those included and -1 for those cut out."""
        return [(shape, 1.0) for shape in self.include] + [(shape, -1.0) for shape in self.exclude]

    def redrawn(self, seed: int, number: int, passage: int) -> tuple[float, float]:
        """Turn [rad] and strength of volume `number` in a later passage, from the seed."""
        side, force, _ = numpy_uniform3(seed, PASSAGES + number, 0, passage)[0]
        given = self.include[0].core.yaw
        low, high = (radians(a) for a in self.redraw_yaw_deg) if self.redraw_yaw_deg else (given, given)
        weak, strong = self.redraw_strength
        return (low + high + side * (high - low)) / 2 - given, (weak + strong + force * (strong - weak)) / 2

    def outline(self, turn: float) -> tuple[np.ndarray, np.ndarray]:
        """(n, 2, 3) ends of the lines that show the volume, turned by `turn` [rad], and (m, 3) points spread over its
        first shape, seen from the centre of the volume [m]."""
        first = self.include[0].core
        lines = [turned(shape.core.edges() - first.centre, turn) for shape in self.include]
        return np.concatenate(lines), turned(first.spread() - first.centre, turn)

    def slab(self, turn: float) -> tuple[np.ndarray, float, float]:
        """The thinnest slab across an axis of the first shape that holds the volume, turned by `turn` [rad]: its
        normal, and its middle, seen from the centre of the volume, and half its thickness along the normal [m]."""
        cores = [shape.core for shape in self.include]
        slabs = []
        for axis in np.eye(3):
            normal = turned(axis, cores[0].yaw)
            middles = np.array([(core.centre - cores[0].centre) @ normal for core in cores])
            reach = np.array([core.reach(normal) for core in cores]) * (1.0 + ROUNDING) + ROUNDING
            low, high = float((middles - reach).min()), float((middles + reach).max())
            slabs.append((turned(normal, turn), (low + high) / 2.0, (high - low) / 2.0))
        return min(slabs, key=lambda slab: slab[2])

    def passages(self, basin: Basin, seed: int, number: int) -> Passages:
        """The path of volume `number` across the basin."""
        first, speed = self.include[0].core, float(np.linalg.norm(self.velocity))
        rear = first.reach(self.velocity / speed) if speed else 0.0
        return Passages(first.centre, self.velocity, rear, basin, lambda passage: self.redrawn(seed, number, passage))
