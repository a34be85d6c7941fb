"""Noise of a stylised wind (2.24): white in time, drawn from the seed for each particle."""

from math import sqrt
from typing import Annotated

import taichi as ti
from pydantic import Field

from ocean_sim.random_numbers import uniform3
from ocean_sim.wind._now import Now

EVERY = 1.0 / 60.0  # [s] how long a draw lasts: ours, PhysX's usual step
MOST_DRAWS = 8  # in a step; a longer step takes one draw, weaker by the root of their number

# Columns of what a wind is now: the number of the first draw of the step, the part of the step that is left to later
# draws, the part that each of them takes at most, and a factor on all. OWN: where the wind's own columns begin.
FIRST, LEFT, EACH, STRENGTH, OWN = range(5)
WRAP = 1 << 24  # numbers of draws begin anew: up to here single precision knows them
LEAST = 1e-6  # part of a step or a draw that is not worth a draw

NotNegative = Annotated[float, Field(ge=0.0)]
NoiseSize = Annotated[tuple[NotNegative, NotNegative, NotNegative], Field(strict=False)]


@ti.data_oriented
class Noise:
    """The draws of the step. Each lasts `every` [s], and a step takes it for as long as it lasts in it, so the noise
    stirs alike whatever the step; 0: a new draw each step, as printed."""

    def __init__(self, seed: int, every: float, now: Now) -> None:
        self.seed, self.every, self.now = seed, every, now
        self.time, self.steps = 0.0, 0
        now.tell(EACH, 1.0)
        now.tell(STRENGTH, 1.0)

    def advance(self, dt: float) -> None:
        """Which draws a step of dt [s] takes, and for which part of it each lasts."""
        first, left, each, strength = self.steps, 0.0, 1.0, 1.0
        if self.every:
            begin, end = self.time / self.every, (self.time + dt) / self.every
            first = int(begin + LEAST)
            more = int(end - LEAST) - first
            if more >= MOST_DRAWS:
                strength = sqrt(self.every / dt)
            elif more > 0:
                left, each = (end - first - 1) / (end - begin), min(1.0, self.every / dt)
        for column, number in ((FIRST, first % WRAP), (LEFT, left), (EACH, each), (STRENGTH, strength)):
            self.now.tell(column, number)
        self.time += dt
        self.steps += 1

    @ti.func
    def of(self, stream, key):
        """The draws of this step for a particle, each as long as it lasts in it: between -1 and 1 on each axis."""
        now = ti.static(self.now.field)
        draw, left = int(now[FIRST]), now[LEFT]
        mean = (1.0 - left) * uniform3(self.seed, stream, key, draw)
        while left > LEAST:
            draw += 1
            mean += ti.min(now[EACH], left) * uniform3(self.seed, stream, key, draw)
            left -= now[EACH]
        return now[STRENGTH] * mean
