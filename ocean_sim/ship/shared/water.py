"""What a hull asks of the water, on a small lattice around it that turns with its heading.

Asked at a few hundred nodes instead of at every cube; between nodes lines are straight, so still water is exact. Where
a hull keeps particles out, the surface over them falls into the hole that it leaves: nodes at which it comes near the
hull are filled straight across from the water on both sides, those at the edge of the lattice that come near another
hull as the nearest that does not.
"""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
import taichi as ti
import taichi.math as tm

from ocean_sim.fluid import Contact, Hull
from ocean_sim.runtime import Template
from ocean_sim.ship.shared.distance import Distance

ALONG, ACROSS, LEVELS = 25, 13, 4  # nodes; levels lie half a draught apart, downwards from the surface
REACH = 1.1  # of the hull's half sizes
TOP = 4  # of the frame: the highest level [m]


@ti.data_oriented
class SurroundingWater:
    """Height of the water around a hull; of a closed form also its velocity and acceleration below."""

    left_out: ClassVar[tuple[str, ...]] = ("others",)  # the water keeps them

    def __init__(
        self,
        length: float,
        breadth: float,
        height: float,
        draught: float,
        gravity: float,
        below: bool,
        hollow: Distance | None = None,
        rim: float = 0.0,
        others: Sequence[Contact] = (),
    ) -> None:
        """Sizes of the hull [m]; `below`: whether the water is a closed form that is asked under its surface too;
        `hollow`: distances from the hull where it keeps particles out, as far as `rim` [m]; `others`: all hulls that
        do, this one with them."""
        self.below, self.gravity, self.layer = below, gravity, 0.5 * draught
        self.hollow = hollow is not None
        if hollow is not None:
            self.hull, self.rim, self.others, self.asked = hollow, rim, others, ti.field(int, shape=(ALONG, ACROSS))
        self.half = tuple(REACH * np.hypot(side / 2, height) + rim for side in (length, breadth))  # [m]
        self.step = (2.0 * self.half[0] / (ALONG - 1), 2.0 * self.half[1] / (ACROSS - 1))  # [m]
        self.level = ti.field(float, shape=(ALONG, ACROSS))
        # x, z of the middle [m], cosine and sine of the heading, highest level [m]
        self.frame = ti.field(float, shape=5)
        if below:
            self.speed = ti.Vector.field(3, float, shape=(ALONG, ACROSS, LEVELS))  # [m/s]
            self.pull = ti.Vector.field(3, float, shape=(ALONG, ACROSS, LEVELS))  # acceleration / gravity

    def beside(self) -> list[Hull]:
        """The hulls but its own that keep particles out."""
        return [other.hull for other in self.others if other.hull.distance is not self.hull]

    @staticmethod
    def bytes(below: bool, word: int) -> int:
        """Memory that it takes."""
        return word * ALONG * ACROSS * (1 + (6 * LEVELS if below else 0))

    @ti.func
    def look(self, water: Template, position, turn):
        """Ask the water [ti.func elevation; `moving`, velocity and acceleration, if `below`] around a ship, along its
        heading; `position` [m] and matrix `turn` of the ship. Call it at the top of a kernel."""
        x, z = position.x, position.z
        ahead, heading = tm.vec2(turn[0, 2], turn[2, 2]), tm.vec2(0.0, 1.0)
        if ahead.norm() > 0.0:
            heading = ahead.normalized()
        sine, cosine = heading.x, heading.y
        ti.loop_config(serialize=not self.below)  # a surface is read in less time than a parallel task takes to start
        for n in range(ALONG * ACROSS):
            i, k = n // ACROSS, n % ACROSS
            along, across = i * self.step[0] - self.half[0], k * self.step[1] - self.half[1]
            point = tm.vec3(x + along * sine + across * cosine, 0.0, z + along * cosine - across * sine)
            eta = water.elevation(point.x, point.z)
            self.level[i, k] = eta
            if ti.static(self.hollow):
                point.y = eta
                _normal, away, _thinning = self.hull.at(turn.transpose() @ (point - position))
                clear = away >= self.rim or k == 0 or k == ACROSS - 1
                for other in ti.static(self.beside()):
                    clear = clear and other.away(point) >= self.rim
                self.asked[i, k] = int(clear)
            if ti.static(self.below):
                for l in range(LEVELS):
                    point.y = eta - l * self.layer
                    speed, pull = water.moving(point, eta)
                    self.speed[i, k, l], self.pull[i, k, l] = speed, pull / self.gravity
        if ti.static(self.hollow):
            ti.loop_config(serialize=True)
            for i in range(ALONG):
                last = -1
                for k in range(ACROSS):
                    if self.asked[i, k] == 1:
                        low, rise = self.level[i, k], 0.0
                        if last >= 0:
                            low, rise = self.level[i, last], self.level[i, k] - self.level[i, last]
                        for inner in range(last + 1, k):
                            self.level[i, inner] = low + rise * (inner - last) / (k - last)
                        last = k
                for inner in range(last + 1, ACROSS):
                    self.level[i, inner] = self.level[i, ti.max(last, 0)]
        ti.loop_config(serialize=True)
        for _ in range(1):
            self.frame[0], self.frame[1], self.frame[2], self.frame[3] = x, z, cosine, sine
            self.frame[TOP] = self.level[0, 0]
            for n in range(1, ALONG * ACROSS):
                self.frame[TOP] = ti.max(self.frame[TOP], self.level[n // ACROSS, n % ACROSS])

    def heights(self, points: np.ndarray) -> np.ndarray:
        """(m,) elevation of the water as it was last asked [m], at points x, z (m, 2) [m]; 0 before."""
        x, z, cosine, sine = self.frame.to_numpy()[:TOP]
        level, apart = self.level.to_numpy(), points - [x, z]
        along = (apart[:, 0] * sine + apart[:, 1] * cosine + self.half[0]) / self.step[0]
        across = (apart[:, 0] * cosine - apart[:, 1] * sine + self.half[1]) / self.step[1]
        i = np.clip(along.astype(int), 0, ALONG - 2)
        k = np.clip(across.astype(int), 0, ACROSS - 2)
        a, b = np.clip(along - i, 0.0, 1.0), np.clip(across - k, 0.0, 1.0)
        near, far = (1.0 - b) * level[i, k] + b * level[i, k + 1], (1.0 - b) * level[i + 1, k] + b * level[i + 1, k + 1]
        return (1.0 - a) * near + a * far

    @ti.func
    def corner(self, x, z):
        """Number of the lower node, and the shares of the way to the next, along and across."""
        dx, dz = x - self.frame[0], z - self.frame[1]
        a = (dx * self.frame[3] + dz * self.frame[2] + self.half[0]) / self.step[0]
        b = (dx * self.frame[2] - dz * self.frame[3] + self.half[1]) / self.step[1]
        i = tm.clamp(int(ti.floor(a)), 0, ALONG - 2)
        k = tm.clamp(int(ti.floor(b)), 0, ACROSS - 2)
        return i, k, tm.clamp(a - i, 0.0, 1.0), tm.clamp(b - k, 0.0, 1.0)

    @ti.func
    def elevation(self, x, z):
        """Of the water [m]."""
        return self.sheet(x, z)[0]

    @ti.func
    def sheet(self, x, z):
        """Elevation [m], and what the waves add to the push of still water over its weight, where the surface alone is
        known: that of long waves, along its slope."""
        i, k, a, b = self.corner(x, z)
        here, left = self.level[i, k], self.level[i, k + 1]
        ahead, across = self.level[i + 1, k], self.level[i + 1, k + 1]
        near, far = (1.0 - b) * here + b * left, (1.0 - b) * ahead + b * across
        slope, aside = (far - near) / self.step[0], ((1.0 - a) * (left - here) + a * (across - ahead)) / self.step[1]
        c, s = self.frame[2], self.frame[3]
        return (1.0 - a) * near + a * far, -tm.vec3(slope * s + aside * c, 0.0, slope * c - aside * s)

    @ti.func
    def push(self, position, depth):
        """The same where the water is asked below: the pressure's slope there."""
        i, k, a, b = self.corner(position.x, position.z)
        return self.between(self.pull, i, k, a, b, depth)

    @ti.func
    def velocity(self, position, depth):
        """[m/s]; only where the water is asked below."""
        i, k, a, b = self.corner(position.x, position.z)
        return self.between(self.speed, i, k, a, b, depth)

    @ti.func
    def between(self, field: Template, i, k, a, b, depth):
        level = tm.clamp(depth / self.layer, 0.0, LEVELS - 1.0)
        l = ti.min(int(level), LEVELS - 2)
        c = level - l
        near = (1.0 - b) * field[i, k, l] + b * field[i, k + 1, l]
        far = (1.0 - b) * field[i + 1, k, l] + b * field[i + 1, k + 1, l]
        near_low = (1.0 - b) * field[i, k, l + 1] + b * field[i, k + 1, l + 1]
        far_low = (1.0 - b) * field[i + 1, k, l + 1] + b * field[i + 1, k + 1, l + 1]
        return (1.0 - c) * ((1.0 - a) * near + a * far) + c * ((1.0 - a) * near_low + a * far_low)
