"""Noise of a stylised wind (2.24): white in time, drawn from the seed for each particle."""

from ocean_sim.columns import Columns
from ocean_sim.kernel_library import ti
from ocean_sim.random_numbers import uniform3
from ocean_sim.runtime import in_kernels
from ocean_sim.wind import DeviceRow

DRAW_INTERVAL = 1.0 / 60.0  # [s] how long a draw lasts: ours, PhysX's usual step
MAX_DRAWS = 8  # in a step; a longer step takes one draw, weaker by the root of their number

DRAWS = Columns(
    number=1,  # of the draw when the clock was restarted
    phase=1,  # part of that draw gone by then
    first=1,  # the first draw of this step, counted from there
    left=1,  # part of this step that is left to later draws
    each=1,  # part of it that each of them takes at most
    strength=1,  # factor on all
)
DRAW_NUMBERS = 1 << 24  # numbers of draws begin anew: up to here single precision knows them
MIN_DRAW_SHARE = 1e-4  # part of a step or a draw that is not worth a draw


@in_kernels
class Noise:
    """Noise of a wind: random vectors (3,), -1 to 1 along each axis, that scale its random acceleration of a particle.
    Each lasts `every` [s] and counts in a step by their overlap, so that the effect is the same at any step; `every` 0:
    a new one each step, as printed in the thesis."""

    def __init__(self, seed: int, every: float, row: DeviceRow) -> None:
        """`seed`: of random numbers; `every`: time [s] that a random vector lasts, 0 for a step; `row`: numbers on the
        device, which begin with those of the vectors in use (DRAWS)."""
        self.seed, self.every, self.row, self.steps = seed, every, row, 0
        row.set(DRAWS.each, 1.0)
        row.set(DRAWS.strength, 1.0)

    def restart(self, time: float) -> None:
        """Store the number of the random vector in use at a `time` [s], and the share of its duration that has gone;
        called as the wind's clock restarts at that time."""
        if self.every:
            draws = time / self.every
            self.row.set(DRAWS.number, int(draws) % DRAW_NUMBERS)
            self.row.set(DRAWS.phase, draws % 1.0)

    def advance(self) -> None:
        """Take the next random vector of the noise if each lasts a step (`every` 0); else `set_clock` chooses it."""
        if not self.every:
            self.row.set(DRAWS.number, self.steps % DRAW_NUMBERS)
            self.steps += 1

    @ti.func
    def set_clock(self, since, step):
        """Choose and weight the random vectors of a `step` [s] that ends `since` [s] after the clock's restart."""
        if ti.static(self.every > 0.0):
            row = ti.static(self.row.field)
            span, left, each, strength = step / self.every, 0.0, 1.0, 1.0
            begin = row[DRAWS.phase] + since / self.every - span
            first = ti.floor(begin + MIN_DRAW_SHARE)
            more = int(ti.floor(begin + span - MIN_DRAW_SHARE) - first)
            if more >= MAX_DRAWS:
                strength = 1.0 / ti.sqrt(span)
            elif more > 0:
                left, each = (begin + span - first - 1.0) / span, ti.min(1.0, 1.0 / span)
            row[DRAWS.first], row[DRAWS.left], row[DRAWS.each], row[DRAWS.strength] = first, left, each, strength

    @ti.func
    def of(self, stream, key):
        """Random numbers (3,), -1 to 1, for particle `key` in this step; `stream`: number of one wind's sequence."""
        row = ti.static(self.row.field)
        draw, left = (int(row[DRAWS.number]) + int(row[DRAWS.first])) % DRAW_NUMBERS, row[DRAWS.left]
        mean = (1.0 - left) * uniform3(self.seed, stream, key, draw)
        while left > MIN_DRAW_SHARE:
            draw += 1
            mean += ti.min(row[DRAWS.each], left) * uniform3(self.seed, stream, key, draw)
            left -= row[DRAWS.each]
        return row[DRAWS.strength] * mean
