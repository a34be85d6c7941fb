"""Shapes of volumes of air (box, sphere, capsule: a core box and all within a radius of it), and the place of a wind:
its path across the basin (Algorithm 1), and its frame over a patch of open sea.

Particles have a position on the patch, which repeats itself, and ships one in the world. A wind sees both around the
middle of the patch, which follows the ships.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from math import cos, inf, radians, sin
from typing import Annotated, Literal

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field

from ocean_sim.basin import Basin
from ocean_sim.kernel_library import ti, tm
from ocean_sim.model import Faults, Model, Positive3, Vector3, quantity
from ocean_sim.parts import SceneFacts
from ocean_sim.runtime import in_kernels
from ocean_sim.wind import DeviceRow


@dataclass(frozen=True)
class Core:
    """Shape of a volume of air: its core, a box, and all points within `radius` of that."""

    centre: np.ndarray  # [m]
    half: tuple[float, float, float]  # half size of the box [m]: zero in a sphere, one axis long in a capsule
    radius: float  # [m], zero in a box
    yaw: float  # turn about the vertical [rad]

    def in_own_axes(self, direction: np.ndarray) -> np.ndarray:
        """Components in the axes of the shape of a direction vector in world axes."""
        return turned(direction, -self.yaw)

    def edges(self) -> np.ndarray:
        """Line segments (n, 2, 3) [m] that draw the shape: edges of a box, or else one outline across each axis."""
        return turned(outline(self.half, self.radius), self.yaw) + self.centre

    def spread(self) -> np.ndarray:
        """Starts (n, 3) [m] of drawn arrows, at the centre's height: 3 by 3, or 5 in line if twice as long as broad."""
        size = np.array(self.half)[[0, 2]] + self.radius
        counts = (3, 3) if size.max() < 2.0 * size.min() else (5, 1) if size[0] > size[1] else (1, 5)
        x, z = (np.linspace(-0.7, 0.7, n) * s if n > 1 else np.zeros(1) for n, s in zip(counts, size))
        x, z = (a.ravel() for a in np.meshgrid(x, z))
        return turned(np.stack([x, np.zeros_like(x), z], axis=-1), self.yaw) + self.centre

    def reach(self, direction: np.ndarray) -> float:
        """Distance [m] from the centre to the farthest point of the shape along the unit vector `direction` (3,)."""
        return float(np.abs(self.in_own_axes(direction)) @ self.half + self.radius)

    def chord(self, direction: np.ndarray) -> float:
        """Length [m], inside the shape, of the line through its centre along the unit vector `direction` (3,)."""
        along = np.abs(self.in_own_axes(direction))
        inside, outside = 0.0, 2.0 * (float(np.linalg.norm(self.half)) + self.radius)
        for _ in range(50):
            middle = 0.5 * (inside + outside)
            if np.linalg.norm(np.maximum(along * middle - self.half, 0.0)) <= self.radius:
                inside = middle
            else:
                outside = middle
        return 2.0 * inside


@lru_cache(maxsize=64)  # frames ask for it again and again
def outline(half: tuple[float, float, float], radius: float) -> np.ndarray:
    """Line segments (n, 2, 3) [m] that draw a `Core` of half sizes `half` [m] and a radius [m], in its own axes."""
    if radius == 0.0:
        corners = np.array(list(np.ndindex(2, 2, 2))) * 2.0 - 1.0
        near = np.abs(corners[:, None] - corners[None]).sum(axis=2) == 2.0
        lines: np.ndarray = corners[np.argwhere(np.triu(near))] * half
        return lines
    angle = np.linspace(0.0, 2.0 * np.pi, 33)
    rings = []
    for k in range(3):
        ring = np.zeros((len(angle), 3))
        for axis, wave in zip(({0, 1, 2} - {k}), (np.cos(angle), np.sin(angle))):
            ring[:, axis] = np.sign(np.round(wave, 9)) * half[axis] + radius * wave
        rings.append(np.stack([ring[:-1], ring[1:]], axis=1))
    return np.concatenate(rings)


class Box(Model):
    """A box of moving air with a level top, turned by `yaw_deg` about the vertical through its centre."""

    kind: Literal["box"] = "box"
    centre: Vector3 = quantity("m", (0.0, 0.0, 0.0))
    """Centre."""
    half_size: Positive3 = quantity("m")
    """Half its size along its own x, y and z."""
    yaw_deg: float = quantity("deg", 0.0)
    """Turn about the vertical by the right hand."""

    @property
    def core(self) -> Core:
        return Core(np.array(self.centre), self.half_size, 0.0, radians(self.yaw_deg))


class Sphere(Model):
    """A sphere of moving air."""

    kind: Literal["sphere"] = "sphere"
    centre: Vector3 = quantity("m", (0.0, 0.0, 0.0))
    """Centre."""
    radius: float = quantity("m", gt=0.0)
    """Radius."""

    @property
    def core(self) -> Core:
        return Core(np.array(self.centre), (0.0, 0.0, 0.0), self.radius, 0.0)


class Capsule(Model):
    """A cylinder of moving air with round ends."""

    kind: Literal["capsule"] = "capsule"
    centre: Vector3 = quantity("m", (0.0, 0.0, 0.0))
    """Centre."""
    radius: float = quantity("m", gt=0.0)
    """Radius of the cylinder and its ends."""
    half_length: float = quantity("m", gt=0.0)
    """Half the distance between the centres of its ends."""
    axis: Literal["x", "y", "z"] = "y"
    """Axis of the cylinder, before it is turned."""
    yaw_deg: float = quantity("deg", 0.0)
    """Turn about the vertical by the right hand."""

    @property
    def core(self) -> Core:
        x, y, z = (self.half_length if self.axis == k else 0.0 for k in "xyz")
        return Core(np.array(self.centre), (x, y, z), self.radius, radians(self.yaw_deg))


Shape = Annotated[Box | Sphere | Capsule, Field(discriminator="kind")]


def turned(vectors: ArrayLike, angle: float) -> np.ndarray:
    """Vectors (..., 3) rotated by `angle` [rad] about the vertical axis, by the right hand."""
    given = np.asarray(vectors, dtype=float)
    x, y, z = given[..., 0], given[..., 1], given[..., 2]
    c, s = cos(angle), sin(angle)
    return np.stack([c * x + s * z, y, c * z - s * x], axis=-1)


@ti.func
def rotated_back(v, cosine, sine):
    """Vector v (3,) rotated about the vertical axis by minus the angle whose cosine and sine are given."""
    return tm.vec3(cosine * v.x - sine * v.z, v.y, cosine * v.z + sine * v.x)


@ti.func
def within(x, half, radius):
    """True if point x [m], in the axes of a `Core`, is within `radius` [m] of its box of half sizes `half` [m]."""
    beyond = ti.max(ti.abs(x) - half, 0.0)
    return beyond.dot(beyond) <= radius * radius


class Placed(Model):
    """Key of a wind that has a position: the frame (axes) in which it stands or drifts."""

    frame: Literal["tile", "world"] | None = None
    """Over a patch of open sea: `tile`, it travels with the patch, so its places are seen from the ship and it comes in
    again at the border of the patch; `world`, it stands and drifts in the world, and the ship may leave it behind.
    null: tile."""

    def misframed(self, preflight: SceneFacts) -> Faults:
        """Yield a fault if a `frame` is given over a basin other than a patch of open sea."""
        if self.frame is not None and preflight.tank.sea is None:
            yield ("frame",), "a wind has a frame only over a patch of open sea; leave it out, or name a sea"


@in_kernels
class Patch:
    """Axes in which a wind has its position over a patch of open sea: they travel with the patch, which follows its
    ships, or stand in the world. Over any other basin they are those of the world."""

    def __init__(self, config: Placed, basin: Basin) -> None:
        periods = (basin.periods[0], basin.periods[2]) if basin.sea is not None else (0.0, 0.0)
        self.axes = tuple((axis, 2 * axis, float(period)) for axis, period in enumerate(periods) if period)
        self.stands = config.frame == "world"
        self.row = DeviceRow(2)

    def follow(self, middle: np.ndarray) -> None:
        """Set the middle x, z (2,) [m] of the patch in the world."""
        for axis, at in enumerate(middle.tolist()):
            self.row.set(axis, at)

    @property
    def origin(self) -> np.ndarray:
        """Origin (3,) of the wind's axes in the world [m]."""
        x, z = (0.0, 0.0) if self.stands else self.row.values
        return np.array([x, 0.0, z])

    @ti.func
    def seen(self, position):
        """Position [m] in the wind's axes of a point at `position` [m]: of a particle, which stays within one period of
        the patch, or of a ship, which may have gone on by whole periods; these are taken off."""
        found = position
        for axis, k, period in ti.static(self.axes):
            middle = self.row.field[axis]
            far = position[k] - middle
            found[k] = far - period * ti.round(far / period)
            if ti.static(self.stands):
                found[k] += middle
        return found


class Passages:
    """Repeated passages of a drifting wind across the basin: its centre [m], turn [rad], strength and passage number.

    The first begins at `start`. When the wind's rear has left the basin, direction and strength are chosen at random,
    and its front comes in again upwind, on a line through the point of the first path nearest to the basin's centre."""

    def __init__(
        self,
        start: ArrayLike,
        drift: ArrayLike,
        reach: float,
        basin: Basin,
        redraw: Callable[[int], tuple[float, float]] = lambda passage: (0.0, 1.0),
    ) -> None:
        """`start`: first centre [m]; `drift`: velocity [m/s]; `reach`: from centre to rear [m]; `redraw`: function from
        the number of a crossing, 1 for the second, to its random turn [rad] and strength; by default 0 and 1."""
        self.drift, self.reach, self.redraw = np.array(drift, dtype=float), reach, redraw
        self.lower, self.upper = np.array(basin.lower), np.array(basin.upper)
        if basin.dimension == 2:  # a slice of a sea without sides
            self.lower[2], self.upper[2] = -inf, inf
        self.speed = float(np.linalg.norm(self.drift))  # [m/s]
        self.number, self.turn, self.strength = 0, 0.0, 1.0
        self.origin = np.array(start, dtype=float)
        self.velocity = self.drift
        ahead = self.direction
        self.nearest = self.origin - ahead * (self.origin @ ahead)
        self.elapsed = 0.0
        self.lasts = self._duration()

    @property
    def direction(self) -> np.ndarray:
        """Unit vector along the drift; zero at rest."""
        return self.velocity / self.speed if self.speed else np.zeros(3)

    @property
    def centre(self) -> np.ndarray:
        """Present centre (3,) [m] of the drifting volume of air or vortex, in the axes of its wind (see `Patch`)."""
        return self.origin + self.velocity * self.elapsed

    def advance(self, dt: float) -> None:
        """Move the drifting air on by dt [s]; after its rear has left the basin, begin the next crossing (passage)."""
        self.elapsed += dt
        if self.elapsed >= self.lasts:
            self.elapsed -= self.lasts
            self.number += 1
            self.turn, self.strength = self.redraw(self.number)
            self.velocity = turned(self.drift, self.turn)
            ahead = self.direction
            back = max(0.0, self._to_border(self.nearest, -ahead) + self.reach)
            self.origin = self.nearest - back * ahead
            self.lasts = self._duration()

    def _duration(self) -> float:
        """Time [s] from the start of a crossing until the drifting air's rear leaves the basin; infinite at rest."""
        rear = self.origin - self.reach * self.direction
        return max(0.0, self._to_border(rear, self.direction) / self.speed) if self.speed else inf

    def _to_border(self, x: np.ndarray, direction: np.ndarray) -> float:
        """Distance [m] from x along unit vector `direction` (3,) to the basin's border; negative if x is beyond it."""
        face = np.where(direction > 0.0, self.upper, self.lower)
        along = np.abs(direction) > 1e-9
        return float(((face - x)[along] / direction[along]).min())
