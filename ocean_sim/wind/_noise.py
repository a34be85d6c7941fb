"""Noise of a stylised wind (2.24): white in time, drawn from the seed for each particle."""

from math import sqrt
from typing import Annotated

import taichi as ti
import taichi.math as tm
from pydantic import Field

from ocean_sim.random_numbers import uniform3

EVERY = 1.0 / 60.0  # [s] how long a draw lasts: ours, PhysX's usual step
MOST_DRAWS = 8  # in a step; a longer step takes one draw, weaker by the root of their number

NotNegative = Annotated[float, Field(ge=0.0)]
NoiseSize = Annotated[tuple[NotNegative, NotNegative, NotNegative], Field(strict=False)]


@ti.data_oriented
class Noise:
    """The draws of the step. Each lasts `every` [s], and a step takes it for as long as it lasts in it, so the noise
    stirs alike whatever the step; 0: a new draw each step, as printed."""

    def __init__(self, seed: int, every: float) -> None:
        self.seed, self.every = seed, every
        self.draws = ti.field(int, shape=2)  # numbers of the first and the last draw in this step
        # of the step that the first of several, each other, and the last of several take
        self.shares = ti.field(float, shape=3)
        self.time, self.steps = 0.0, 0
        self.drawn: tuple[float, ...] = ()
        self._draw(0.0)

    def advance(self, dt: float) -> None:
        """Which draws a step of dt [s] takes."""
        self._draw(dt)
        self.time += dt
        self.steps += 1

    def _draw(self, dt: float) -> None:
        """Which draws of the noise a step of dt [s] takes, and for which part of it each lasts."""
        first = last = self.steps
        begun, ended = self.drawn[2::2] if self.drawn else (1.0, 1.0)  # not read of a step within one draw
        shares = (begun, 1.0, ended)
        if self.every and dt > 0.0:
            begin, end = self.time / self.every, (self.time + dt) / self.every
            first = int(begin + 1e-6)
            last = max(first, int(end - 1e-6))
            if last - first >= MOST_DRAWS:
                last, shares = first, (begun, sqrt(self.every / dt), ended)
            elif last > first:
                shares = tuple(part / (end - begin) for part in (first + 1 - begin, 1.0, end - last))
        drawn = (first & 0x3FFFFFFF, (first & 0x3FFFFFFF) + last - first, *shares)
        if drawn != self.drawn:
            before, self.drawn = self.drawn or (None,) * 5, drawn
            for k, number in enumerate(drawn):
                if number != before[k]:
                    if k < 2:
                        self.draws[k] = int(number)
                    else:
                        self.shares[k - 2] = number

    @ti.func
    def of(self, stream, key):
        """The draws of this step for a particle, each as long as it lasts in it: between -1 and 1 on each axis."""
        mean, first, last = tm.vec3(0.0), self.draws[0], self.draws[1]
        for draw in range(first, last + 1):
            share = self.shares[1]
            if first < last:
                share = ti.select(draw == first, self.shares[0], ti.select(draw == last, self.shares[2], share))
            mean += share * uniform3(self.seed, stream, key, draw)
        return mean
