"""Values at exact multiples of `every`, whatever the time steps were: straight lines between the states around them."""

import math
from typing import NamedTuple

import numpy as np

ROUNDING = 1.0e-9  # a time that is short of a multiple by this part of `every` has reached it


class Multiples:
    """The multiples of `every` [s] that simulated time reaches, each counted once, from the first time seen on."""

    next: int | None

    def __init__(self, every: float) -> None:
        self.every = every
        self.next = None

    def reached(self, time: float) -> range:
        """Numbers k of the multiples k * every that were passed since the last call."""
        if self.next is None:
            self.next = math.ceil(time / self.every - ROUNDING)
        end = math.floor(time / self.every + ROUNDING) + 1
        passed = range(self.next, end)
        self.next = max(self.next, end)
        return passed


class Sample(NamedTuple):
    """One row: `values` lie on the line between two states, `held` are those of the state before."""

    time: float
    values: np.ndarray
    held: tuple[float | str, ...]


class Sampled:
    """A vector that is known after some steps and sampled at multiples of `every`.

    A run calls its observers with the last state before and the first state after each multiple; a straight line
    between the two is second-order in the time step. Names and counts have no in-between: they are held from the
    state before.
    """

    before: Sample | None

    def __init__(self, every: float, most: float = math.inf) -> None:
        """`most`: multiples that one step may pass; of more, the first and the last have rows."""
        self.every, self.most = every, most
        self.multiples = Multiples(every)
        self.before = None

    def rows(self, time: float, values: np.ndarray, held: tuple = ()) -> list[Sample]:
        """The samples that the state at `time` completes."""
        now = Sample(time, np.asarray(values, dtype=np.float64), held)
        passed = self.multiples.reached(time)
        shown = passed if len(passed) <= self.most else (passed[0], passed[-1])
        rows = [between(self.before or now, now, k * self.every) for k in shown]
        self.before = now
        return rows


def between(before: Sample, after: Sample, time: float) -> Sample:
    """The state at `time` on the straight line from `before` to `after`."""
    if time >= after.time or after.time <= before.time:
        return Sample(time, after.values, after.held)
    part = max(0.0, (time - before.time) / (after.time - before.time))
    return Sample(time, before.values + part * (after.values - before.values), before.held)
