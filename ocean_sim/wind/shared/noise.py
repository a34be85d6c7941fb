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
    """Random vectors for the noise of a wind. Each lasts `every` [s] and is weighted in a time step by their overlap,
    so that the noise has the same effect at any step; `every` 0: a new one each step, as printed in the thesis."""

    def __init__(self, seed: int, every: float, row: DeviceRow) -> None:
        """`seed`: of random numbers; `every`: time that a vector lasts [s]; `row`: on the device, with columns DRAWS
        (vectors in use) first."""
        self.seed, self.every, self.row, self.steps = seed, every, row, 0
        row.set(DRAWS.each, 1.0)
        row.set(DRAWS.strength, 1.0)

    def restart(self, time: float) -> None:
        """Store number and elapsed share of the random vector (noise of the wind) in use at a `time` [s]; called as the
        wind's clock, which counts from there, restarts."""
        if self.every:
            draws = time / self.every
            self.row.set(DRAWS.number, int(draws) % DRAW_NUMBERS)
            self.row.set(DRAWS.phase, draws % 1.0)

    def advance(self) -> None:
        """Go on to the next random vector if each lasts a step (`every` 0); if they last a time, `set_clock` does."""
        if not self.every:
            self.row.set(DRAWS.number, self.steps % DRAW_NUMBERS)
            self.steps += 1

    @ti.func
    def set_clock(self, since, step):
        """Compute numbers and weights of the random vectors in a step [s], `since` [s] after the clock's restart."""
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
        """Noise (3,) of this step on particle `key`, -1 to 1 along each axis; `stream`: number of its sequence."""
        row = ti.static(self.row.field)
        draw, left = (int(row[DRAWS.number]) + int(row[DRAWS.first])) % DRAW_NUMBERS, row[DRAWS.left]
        mean = (1.0 - left) * uniform3(self.seed, stream, key, draw)
        while left > MIN_DRAW_SHARE:
            draw += 1
            mean += ti.min(row[DRAWS.each], left) * uniform3(self.seed, stream, key, draw)
            left -= row[DRAWS.each]
        return row[DRAWS.strength] * mean
