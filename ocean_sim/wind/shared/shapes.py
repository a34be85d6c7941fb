"""Shapes of volumes of air: boxes, spheres and capsules, each a core box and all that lies within a radius of it."""

from dataclasses import dataclass
from functools import lru_cache
from math import cos, radians, sin
from typing import Annotated, Literal

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field

from ocean_sim.kernel_library import ti, tm
from ocean_sim.model import Model, Vector3, quantity

Length = Annotated[float, Field(gt=0.0)]
HalfSize = Annotated[tuple[Length, Length, Length], Field(strict=False)]


@dataclass(frozen=True)
class Core:
    """Shape made of all points within `radius` of a box."""

    centre: np.ndarray  # [m]
    half: tuple[float, float, float]  # half size of the box [m]: zero in a sphere, one axis long in a capsule
    radius: float  # [m], zero in a box
    yaw: float  # turn about the vertical [rad]

    def in_own_axes(self, direction: np.ndarray) -> np.ndarray:
        """Direction vector in the axes of the shape, from one in the axes of the world."""
        return turned(direction, -self.yaw)

    def edges(self) -> np.ndarray:
        """Line segments (n, 2, 3) [m] that draw the shape: edges of a box, else an outline in each of its planes."""
        return turned(outline(self.half, self.radius), self.yaw) + self.centre

    def spread(self) -> np.ndarray:
        """Points (n, 3) [m] at the height of its centre, as feet of arrows: 3 by 3, or 5 in a row on a long shape."""
        size = np.array(self.half)[[0, 2]] + self.radius
        counts = (3, 3) if size.max() < 2.0 * size.min() else (5, 1) if size[0] > size[1] else (1, 5)
        x, z = (np.linspace(-0.7, 0.7, n) * s if n > 1 else np.zeros(1) for n, s in zip(counts, size))
        x, z = (a.ravel() for a in np.meshgrid(x, z))
        return turned(np.stack([x, np.zeros_like(x), z], axis=-1), self.yaw) + self.centre

    def reach(self, direction: np.ndarray) -> float:
        """Distance [m] from the centre to the farthest point of the shape along a unit vector."""
        return float(np.abs(self.in_own_axes(direction)) @ self.half + self.radius)

    def chord(self, direction: np.ndarray) -> float:
        """Length [m] inside the shape of a line through its centre along a unit vector."""
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
    """Line segments (n, 2, 3) [m] that draw a core, in its own axes, of box half sizes `half` [m] and a radius [m]."""
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
    """A box with a level top, turned by `yaw_deg` about the vertical through its centre."""

    kind: Literal["box"] = "box"
    centre: Vector3 = quantity("m", (0.0, 0.0, 0.0))
    """Centre."""
    half_size: HalfSize = quantity("m")
    """Half its size along its own x, y and z."""
    yaw_deg: float = quantity("deg", 0.0)
    """Turn about the vertical by the right hand."""

    @property
    def core(self) -> Core:
        return Core(np.array(self.centre), self.half_size, 0.0, radians(self.yaw_deg))


class Sphere(Model):
    """A sphere."""

    kind: Literal["sphere"] = "sphere"
    centre: Vector3 = quantity("m", (0.0, 0.0, 0.0))
    """Centre."""
    radius: float = quantity("m", gt=0.0)
    """Radius."""

    @property
    def core(self) -> Core:
        return Core(np.array(self.centre), (0.0, 0.0, 0.0), self.radius, 0.0)


class Capsule(Model):
    """A cylinder with round ends."""

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
def turned_back(v, cosine, sine):
    """Vector v (3,) rotated by minus the angle of this cosine and sine about the vertical axis."""
    return tm.vec3(cosine * v.x - sine * v.z, v.y, cosine * v.z + sine * v.x)


@ti.func
def within(x, half, radius):
    """True if point x [m], from a core's centre and in its axes, lies in that core, of half sizes and a radius [m]."""
    beyond = ti.max(ti.abs(x) - half, 0.0)
    return beyond.dot(beyond) <= radius * radius
