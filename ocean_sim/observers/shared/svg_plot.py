"""Curves over time as an SVG drawing, small enough for a page."""

import html
from collections.abc import Mapping
from typing import Any

import numpy as np

from ocean_sim.palette import SERIES

WIDTH, HEIGHT = 900, 260
LEFT, RIGHT, TOP, BOTTOM = 72, 12, 30, 38
COLOURS = (*SERIES, "#000000")
POINTS = 600  # of a curve at most


def ticks(low: float, high: float, about: int = 6) -> np.ndarray:
    """Round numbers between `low` and `high`: 1, 2 or 5 times a power of ten apart; never -0."""
    raw = (high - low) / about
    power = 10.0 ** np.floor(np.log10(raw))
    step = next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= raw * (1.0 - 1e-9))
    return np.arange(np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9) + 1) * step + 0.0


def span(values: np.ndarray) -> tuple[float, float]:
    """Least and largest value, with a margin; NaN does not count."""
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)
    gap = 0.05 * (high - low) or 0.05 * abs(high) or 1.0
    return low - gap, high + gap


def thinned(time: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """At most POINTS points of a curve that keep its crests: the least and the greatest of each interval."""
    if len(time) <= POINTS:
        return time, values
    kept = []
    for rows in np.array_split(np.arange(len(time)), POINTS // 2):
        finite = rows[np.isfinite(values[rows])]
        if len(finite):
            kept += sorted({int(finite[values[finite].argmin()]), int(finite[values[finite].argmax()])})
    return time[kept], values[kept]


def curves(time: np.ndarray, series: Mapping[str, np.ndarray], label: str) -> str:
    """An SVG element with one curve a name, over time [s]."""
    left, right = float(time[0]), float(max(time[-1], time[0] + 1e-9))
    low, high = span(np.concatenate(list(series.values())))

    def x(t: Any) -> Any:
        return LEFT + (t - left) / (right - left) * (WIDTH - LEFT - RIGHT)

    def y(value: Any) -> Any:
        return HEIGHT - BOTTOM - (value - low) / (high - low) * (HEIGHT - TOP - BOTTOM)

    parts = [
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" font-size="13" fill="#16242c" role="img" '
        f'aria-label="{html.escape(label)}, {html.escape(", ".join(series))}">'
    ]
    parts.append(f'<text x="{LEFT}" y="16" font-weight="600">{html.escape(label)}</text>')
    for value in ticks(low, high):
        parts.append(f'<path d="M{LEFT} {y(value):.1f}H{WIDTH - RIGHT}" stroke="#dde5ea"/>')
        parts.append(f'<text x="{LEFT - 8}" y="{y(value) + 4:.1f}" text-anchor="end">{value:.4g}</text>')
    for moment in ticks(left, right, 8):
        parts.append(f'<text x="{x(moment):.1f}" y="{HEIGHT - 18}" text-anchor="middle">{moment:.4g}</text>')
    parts.append(f'<text x="{WIDTH - RIGHT}" y="{HEIGHT - 3}" text-anchor="end">time [s]</text>')
    legend = WIDTH - RIGHT
    for k, (name, values) in reversed(list(enumerate(series.items()))):
        colour = COLOURS[k % len(COLOURS)]
        kept = [(t, v) for t, v in zip(*thinned(time, values)) if np.isfinite(v)]
        line = " ".join(f"{x(t):.1f},{y(v):.1f}" for t, v in kept)
        parts.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="1.6"/>')
        parts.append(f'<text x="{legend}" y="16" text-anchor="end" fill="{colour}">{html.escape(name)}</text>')
        legend -= 8 * len(name) + 18
    return "\n".join([*parts, "</svg>"])
