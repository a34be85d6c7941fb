"""Curves over time as an SVG drawing, small enough for a page."""

import html
from collections.abc import Mapping
from typing import Any

import numpy as np

from ocean_sim.palette import SERIES

WIDTH, HEIGHT = 900, 260
LEFT, RIGHT, TOP, BOTTOM = 72, 12, 30, 38
COLOURS = (*SERIES, "#7a8790")
DASHES = ("none", "8 3", "2 3", "9 3 2 3", "5 5", "14 4", "3 2 1 2")  # of curves, so that they differ without colour
SPIKE, USUAL = 4.0, 0.995  # a curve whose range is so many times that of the share USUAL of its values is cut
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


def usual(values: np.ndarray) -> tuple[float, float]:
    """The range [least, greatest] that is drawn: of all values, or where a few spikes would flatten the rest, of these
    others."""
    finite = values[np.isfinite(values)]
    if not finite.size:
        return -np.inf, np.inf
    low, high = np.quantile(finite, [1.0 - USUAL, USUAL])
    least, greatest = finite.min(), finite.max()
    if greatest - least <= SPIKE * max(high - low, 1e-12 * abs(high)) or high == low:
        return float(least), float(greatest)
    return float(max(least, low - 0.5 * (high - low))), float(min(greatest, high + 0.5 * (high - low)))


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


def identifier(label: str) -> str:
    """A label as part of an identifier."""
    return "".join(letter for letter in label if letter.isalnum())


def curves(
    time: np.ndarray, series: Mapping[str, np.ndarray], label: str, limits: Mapping[str, float] | None = None
) -> str:
    """An SVG element with one curve a name, over time [s], and lines at the limits; nothing where every value is 0 or
    none is a number. Spikes that would flatten the rest are cut, which is said."""
    everything = np.concatenate(list(series.values()))
    if not np.nan_to_num(everything).any():
        return ""
    limits = limits or {}
    left, right = float(time[0]), float(max(time[-1], time[0] + 1e-9))
    bottom, top = usual(everything)
    beyond = int(((everything < bottom) | (everything > top)).sum())
    low, high = span(np.array([bottom, top, *limits.values()]))
    reached = max(np.nanmin(everything), np.nanmax(everything), key=abs)
    note = f" ({beyond} values cut, as far as {reached:.4g})" if beyond else ""

    def x(t: Any) -> Any:
        return LEFT + (t - left) / (right - left) * (WIDTH - LEFT - RIGHT)

    def y(value: Any) -> Any:
        return HEIGHT - BOTTOM - (value - low) / (high - low) * (HEIGHT - TOP - BOTTOM)

    parts = [
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" font-size="13" fill="currentColor" role="img" '
        f'aria-label="{html.escape(label)}, {html.escape(", ".join(series))}">'
    ]
    parts.append(f'<text x="{LEFT}" y="16" font-weight="600">{html.escape(label + note)}</text>')
    parts.append(
        f'<clipPath id="c{identifier(label)}"><path d="M{LEFT} {TOP}H{WIDTH}V{HEIGHT - BOTTOM}H{LEFT}Z"/></clipPath>'
    )
    for value in ticks(low, high):
        parts.append(
            f'<path d="M{LEFT} {y(value):.1f}H{WIDTH - RIGHT}" class="grid" stroke="#7a8790" stroke-opacity=".3"/>'
        )
        parts.append(f'<text x="{LEFT - 8}" y="{y(value) + 4:.1f}" text-anchor="end">{value:.4g}</text>')
    for moment in ticks(left, right, 8):
        parts.append(f'<text x="{x(moment):.1f}" y="{HEIGHT - 18}" text-anchor="middle">{moment:.4g}</text>')
    parts.append(f'<text x="{WIDTH - RIGHT}" y="{HEIGHT - 3}" text-anchor="end">time [s]</text>')
    for name, value in limits.items():
        parts.append(f'<path d="M{LEFT} {y(value):.1f}H{WIDTH - RIGHT}" stroke="currentColor" stroke-dasharray="1 4"/>')
        parts.append(f'<text x="{LEFT + 4}" y="{y(value) - 4:.1f}" font-size="11">{html.escape(name)}</text>')
    legend = WIDTH - RIGHT
    for k, (name, values) in reversed(list(enumerate(series.items()))):
        colour = COLOURS[k % len(COLOURS)]
        kept = [(t, v) for t, v in zip(*thinned(time, values)) if np.isfinite(v)]
        line = " ".join(f"{x(t):.1f},{y(v):.1f}" for t, v in kept)
        stroke = f'stroke="{colour}" stroke-width="1.7" stroke-dasharray="{DASHES[k % len(DASHES)]}"'
        parts.append(f'<polyline points="{line}" fill="none" {stroke} clip-path="url(#c{identifier(label)})"/>')
        parts.append(f'<text x="{legend}" y="16" text-anchor="end">{html.escape(name)}</text>')
        legend -= 8 * len(name) + 8
        parts.append(f'<path d="M{legend - 26} 12H{legend}" fill="none" {stroke}/>')
        legend -= 44
    return "\n".join([*parts, "</svg>"])
