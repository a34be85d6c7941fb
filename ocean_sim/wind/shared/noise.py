"""Noise of a stylised wind (2.24): white in time, drawn from the seed for each particle."""

from typing import Annotated

import taichi as ti
from pydantic import Field

from ocean_sim.random_numbers import uniform3
from ocean_sim.wind.shared.clock import Now

EVERY = 1.0 / 60.0  # [s] how long a draw lasts: ours, PhysX's usual step
MOST_DRAWS = 8  # in a step; a longer step takes one draw, weaker by the root of their number

# Columns of what a wind is now. Told: the number of the draw when its clock began, and the part of it gone by then.
# Found in each step: the first draw of the step, counted from there, the part of the step that is left to later draws,
# the part that each of them takes at most, and a factor on all. OWN: where the wind's own columns begin.
NUMBER, PHASE, FIRST, LEFT, EACH, STRENGTH, OWN = range(7)
WRAP = 1 << 24  # numbers of draws begin anew: up to here single precision knows them
LEAST = 1e-4  # part of a step or a draw that is not worth a draw

NotNegative = Annotated[float, Field(ge=0.0)]
NoiseSize = Annotated[tuple[NotNegative, NotNegative, NotNegative], Field(strict=False)]


@ti.data_oriented
class Noise:
    """The draws of the step. Each lasts `every` [s], and a step takes it for as long as it lasts in it, so the noise
    stirs alike whatever the step; 0: a new draw each step, as printed."""

    def __init__(self, seed: int, every: float, now: Now) -> None:
        self.seed, self.every, self.now, self.steps = seed, every, now, 0
        now.tell(EACH, 1.0)
        now.tell(STRENGTH, 1.0)

    def begin(self, time: float) -> None:
        """The clock begins anew at a time [s]."""
        if self.every:
            draws = time / self.every
            self.now.tell(NUMBER, int(draws) % WRAP)
            self.now.tell(PHASE, draws % 1.0)

    def advance(self) -> None:
        """Another step."""
        if not self.every:
            self.now.tell(NUMBER, self.steps % WRAP)
            self.steps += 1

    @ti.func
    def hear(self, since, step):
        """Find which draws a step of `step` [s] takes that ends `since` [s] after the clock began, and for which part
        of it each lasts."""
        if ti.static(self.every > 0.0):
            now = ti.static(self.now.field)
            span, left, each, strength = step / self.every, 0.0, 1.0, 1.0
            begin = now[PHASE] + since / self.every - span
            first = ti.floor(begin + LEAST)
            more = int(ti.floor(begin + span - LEAST) - first)
            if more >= MOST_DRAWS:
                strength = 1.0 / ti.sqrt(span)
            elif more > 0:
                left, each = (begin + span - first - 1.0) / span, ti.min(1.0, 1.0 / span)
            now[FIRST], now[LEFT], now[EACH], now[STRENGTH] = first, left, each, strength

    @ti.func
    def of(self, stream, key):
        """The draws of this step for a particle, each as long as it lasts in it: between -1 and 1 on each axis."""
        now = ti.static(self.now.field)
        draw, left = (int(now[NUMBER]) + int(now[FIRST])) % WRAP, now[LEFT]
        mean = (1.0 - left) * uniform3(self.seed, stream, key, draw)
        while left > LEAST:
            draw += 1
            mean += ti.min(now[EACH], left) * uniform3(self.seed, stream, key, draw)
            left -= now[EACH]
        return now[STRENGTH] * mean
