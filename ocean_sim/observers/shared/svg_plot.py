"""Curves over time as an SVG drawing, small enough for a page."""

import html
from collections.abc import Iterable, Mapping
from typing import Any
from zlib import crc32

import numpy as np

from ocean_sim.palette import SERIES

WIDTH, HEIGHT = 900, 260  # of a plot whose legend stands beside its title
LEFT, RIGHT, TOP, BOTTOM = 72, 12, 30, 38
LETTER, BOLD = 7.4, 8.2  # widths of a letter
SAMPLE, APART, LINE = 50, 18, 18  # of a legend: width of a sample, with what is left before it; height of a line
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


def look(k: int) -> tuple[str, str]:
    """Colour and dashes of curve k, another pair for each of the first 49."""
    return COLOURS[k % len(COLOURS)], DASHES[(k + k // len(COLOURS)) % len(DASHES)]


def legend(names: Iterable[str], title: str) -> list[tuple[float, int]]:
    """Where the name of each curve ends from the left edge, and in which line from the title's, 0, down: after the
    title where there is room, else in lines below it; to the left, so that a narrow screen shows them."""
    widths = [SAMPLE + LETTER * len(name) for name in names]
    end, row, places = LEFT + BOLD * len(title), 0, []
    if end + sum(widths) > WIDTH - RIGHT:
        end, row = LEFT - APART, 1
    for width in widths:
        if end + width > WIDTH - RIGHT:
            end, row = LEFT - APART, row + 1
        end += width
        places.append((end, row))
    return places


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
    places = legend(series, label + note)
    top_edge = TOP + LINE * places[-1][1]
    height = HEIGHT + LINE * places[-1][1]

    def x(t: Any) -> Any:
        return LEFT + (t - left) / (right - left) * (WIDTH - LEFT - RIGHT)

    def y(value: Any) -> Any:
        return height - BOTTOM - (value - low) / (high - low) * (HEIGHT - TOP - BOTTOM)

    parts = [
        f'<svg viewBox="0 0 {WIDTH} {height}" font-size="13" fill="currentColor" role="img" '
        f'aria-label="{html.escape(label)}, {html.escape(", ".join(series))}">'
    ]
    parts.append(f'<text x="{LEFT}" y="16" font-weight="600">{html.escape(label + note)}</text>')
    inside = f"c{crc32(label.encode() + everything.tobytes()):08x}"
    frame = f"M{LEFT} {top_edge}H{WIDTH}V{height - BOTTOM}H{LEFT}Z"
    parts.append(f'<clipPath id="{inside}"><path d="{frame}"/></clipPath>')
    for value in ticks(low, high):
        parts.append(
            f'<path d="M{LEFT} {y(value):.1f}H{WIDTH - RIGHT}" class="grid" stroke="#7a8790" stroke-opacity=".3"/>'
        )
        parts.append(f'<text x="{LEFT - 8}" y="{y(value) + 4:.1f}" text-anchor="end">{value:.6g}</text>')
    for moment in ticks(left, right, 8):
        parts.append(f'<text x="{x(moment):.1f}" y="{height - 18}" text-anchor="middle">{moment:.4g}</text>')
    parts.append(f'<text x="{WIDTH - RIGHT}" y="{height - 3}" text-anchor="end">time [s]</text>')
    for name, value in limits.items():
        parts.append(f'<path d="M{LEFT} {y(value):.1f}H{WIDTH - RIGHT}" stroke="currentColor" stroke-dasharray="1 4"/>')
        parts.append(f'<text x="{LEFT + 4}" y="{y(value) - 4:.1f}" font-size="11">{html.escape(name)}</text>')
    for k, ((name, values), (end, row)) in enumerate(zip(series.items(), places, strict=True)):
        colour, dashes = look(k)
        kept = [(t, v) for t, v in zip(*thinned(time, values)) if np.isfinite(v)]
        line = " ".join(f"{x(t):.1f},{y(v):.1f}" for t, v in kept)
        stroke = f'stroke="{colour}" stroke-width="1.7" stroke-dasharray="{dashes}"'
        parts.append(f'<polyline points="{line}" fill="none" {stroke} clip-path="url(#{inside})"/>')
        base, begin = 16 + LINE * row, end - LETTER * len(name)
        parts.append(f'<text x="{begin:.1f}" y="{base}">{html.escape(name)}</text>')
        parts.append(f'<path d="M{begin - 32:.1f} {base - 4}H{begin - 6:.1f}" fill="none" {stroke}/>')
    return "\n".join([*parts, "</svg>"])
