"""Curves of a running simulation: wave height, roll, time per picture; as lines in the unit square of a picture."""

from math import floor, log10, nan

import numpy as np

ROLLING = 10.0  # [s] over which H_s is taken
KEPT = 240  # points of a curve
NAMES = ("H_s", "roll", "picture")
UNITS = {"H_s": "m", "roll": "deg", "picture": "ms"}
DIGITS = {"H_s": 2, "roll": 1, "picture": 0}
LEAST = {"H_s": 0.1, "roll": 1.0, "picture": 20.0}  # the shortest axis


class Curves:
    """The last values of every curve, in the order in which they came."""

    def __init__(self) -> None:
        self.values: dict[str, list[float]] = {name: [] for name in NAMES}
        self.variances: list[tuple[float, float]] = []

    def add(self, time: float, heights: np.ndarray, roll: float | None, milliseconds: float | None) -> None:
        """Heights of the surface now [m], roll [rad], wall time of the last picture; None where there is none."""
        if len(heights) and not (self.variances and time <= self.variances[-1][0]):
            known = [*self.variances, (time, float(np.var(heights)))]
            self.variances = [(at, variance) for at, variance in known if at >= time - ROLLING]
        degrees = nan if roll is None else float(np.degrees(roll))
        for name, value in zip(NAMES, (self.wave_height(), degrees, nan if milliseconds is None else milliseconds)):
            self.values[name] = [*self.values[name], value][-KEPT:]

    def wave_height(self) -> float:
        """4 sqrt(m0) [m] of all points of the surface over the last seconds."""
        return 4.0 * float(np.mean([v for _, v in self.variances])) ** 0.5 if self.variances else nan

    def scale(self, name: str) -> tuple[float, float]:
        """Lowest and highest value of the axis: round numbers; roll about zero, the others from zero. Of the times of
        pictures one in ten may lie beyond: the first ones wait for a compiler."""
        known = np.abs(np.array([v for v in self.values[name] if v == v] or [0.0]))
        top = rounded_up(max(float(np.quantile(known, 0.9 if name == "picture" else 1.0)), LEAST[name]))
        return (-top, top) if name == "roll" else (0.0, top)

    def reading(self, name: str) -> str:
        """The last value and the axis, in words."""
        last = self.values[name][-1] if self.values[name] else nan
        if last != last:
            return "none"
        low, high = self.scale(name)
        return f"{round(last, DIGITS[name]) + 0.0:.{DIGITS[name]}f} {UNITS[name]}   axis {low:g} to {high:g}"

    def lines(self, name: str, box: tuple[float, float, float, float]) -> np.ndarray:
        """(n, 2, 2) ends of segments inside box (x, y, width, height) of the picture, y upwards; the newest right."""
        values = np.array(self.values[name], dtype=float)
        low, high = self.scale(name)
        x = box[0] + box[2] * (np.arange(len(values)) + KEPT - len(values)) / (KEPT - 1)
        y = box[1] + box[3] * np.clip((values - low) / (high - low), 0.0, 1.0)
        points = np.stack([x, y], axis=1)
        ends = np.stack([points[:-1], points[1:]], axis=1) if len(points) > 1 else np.zeros((0, 2, 2))
        return ends[np.isfinite(ends).all(axis=(1, 2))]


def rounded_up(value: float) -> float:
    """The next of 1, 2, 5, 10, ... times a power of ten."""
    power = 10.0 ** floor(log10(value))
    return next(float(f"{m * power:.3g}") for m in (1, 2, 5, 10) if m * power >= value * (1.0 - 1e-9))
