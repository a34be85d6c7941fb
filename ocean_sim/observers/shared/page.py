"""Pieces of a page that needs nothing but itself: tables, pictures inside the page, curves as SVG, a scene as text."""

import base64
import html
import io
import json
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any
from zlib import crc32

import numpy as np

from ocean_sim.files import input_file
from ocean_sim.palette import SERIES

WIDEST, QUALITY = 1200, 82  # pixels of a picture in the page, and JPEG quality
WIDTH, HEIGHT = 900, 260  # of a plot whose legend stands beside its title
LEFT, RIGHT, TOP, BOTTOM = 72, 12, 30, 38
LETTER, BOLD = 7.4, 8.2  # widths of a letter
SAMPLE, APART, LINE = 50, 18, 18  # of a legend: width of a sample, with what is left before it; height of a line
COLOURS = (*SERIES, "#7a8790")
DASHES = ("none", "8 3", "2 3", "9 3 2 3", "5 5", "14 4", "3 2 1 2")  # of curves, so that they differ without colour
SPIKE, USUAL = 4.0, 0.995  # a curve whose range is so many times that of the share USUAL of its values is cut
POINTS = 600  # of a curve at most
STYLE = """
:root { color-scheme: light dark; --ink: #16242c; --paper: #fff; --soft: #4a5d68; --line: #dde5ea; --block: #f4f7f9;
  --bad: #9c2b12; --link: #0b5c94; --curves: .68; }
@media (prefers-color-scheme: dark) { :root { --ink: #e6edf1; --paper: #10181d; --soft: #a9bac4; --line: #31414b;
  --block: #1a252c; --bad: #ff9d85; --link: #7cc4f5; --curves: 1.5; } }
body { font: 16px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper);
  max-width: 62rem; margin: 0 auto; padding: 1rem 1rem 4rem; overflow-wrap: break-word; }
h1 { margin: .5rem 0 0; line-height: 1.2; } h2 { margin: 2.5rem 0 .5rem; border-bottom: 1px solid var(--line); }
figure { margin: 1rem 0; } figcaption { color: var(--soft); font-size: .9rem; }
img { width: 100%; height: auto; display: block; }
.plot { overflow-x: auto; margin: 1rem 0; } .plot svg { width: 100%; min-width: 34rem; height: auto; display: block; }
.plot [stroke-dasharray]:not([stroke=currentColor]) { filter: brightness(var(--curves)); }
.wide { overflow-x: auto; } table { border-collapse: collapse; }
th, td { padding: .15rem 1.2rem .15rem 0; vertical-align: top; text-align: left; }
th { font-weight: 600; } td:first-child, th[scope=row] { color: var(--soft); font-weight: 400; }
a { color: var(--link); } nav { font-size: .9rem; } nav a { margin-right: 1rem; white-space: nowrap; }
.outcome { font-weight: 600; } .bad { color: var(--bad); }
pre { background: var(--block); padding: .8rem; overflow-x: auto; font-size: .85rem; line-height: 1.4; }
@media (max-width: 500px) {
  body { padding: .6rem; font-size: 15px; } th, td { padding-right: .7rem; } .plot svg { min-width: 46rem; }
}
@media print {
  :root { --ink: #000; --paper: #fff; }
  body { max-width: none; padding: 0; font-size: 10pt; } .plot, .wide, pre { overflow: visible; }
  .plot svg { min-width: 0; } figure, .plot, tr { break-inside: avoid; } h2 { break-after: avoid; }
  pre { white-space: pre-wrap; } a { color: inherit; text-decoration: none; }
}
"""


def page(title: str, parts: Iterable[str]) -> str:
    """A whole document in English, of HTML parts."""
    parts = contents(list(parts))
    head = [
        '<meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>{html.escape(title)}</title>",
        f"<style>{STYLE}</style>",
    ]
    return "\n".join(
        ["<!doctype html>", '<html lang="en">', "<head>", *head, "</head>", "<body>", *parts, "</body>", "</html>", ""]
    )


def contents(parts: list[str]) -> list[str]:
    """The parts, with a name for every heading and links to them before the first."""
    heads: list[str] = []

    def found(match: re.Match[str]) -> str:
        heads.append(match[1])
        return f'<h2 id="part{len(heads)}">{match[1]}</h2>'

    marked = [re.sub(r"<h2>(.*?)</h2>", found, part) for part in parts]
    if not heads:
        return marked
    links = "".join(f'<a href="#part{k + 1}">{head}</a> ' for k, head in enumerate(heads))
    first = next(k for k, part in enumerate(marked) if "<h2 " in part)
    return [*marked[: min(first, 2)], f'<nav aria-label="Contents">{links}</nav>', *marked[min(first, 2) :]]


def table(rows: Iterable[Sequence[object]], heads: Sequence[str] = (), named: bool = True) -> str:
    """Rows of cells, with a line of heads where there are any; `named`: whether the first cell is the name of a row."""
    across = "".join(f'<th scope="col">{html.escape(name)}</th>' for name in heads)
    top = [f"<tr>{across}</tr>"] if heads else []
    body = []
    for row in rows:
        first, *cells = (html.escape(str(cell)) for cell in row)
        head = f'<th scope="row">{first}</th>' if named else f"<td>{first}</td>"
        body.append(f"<tr>{head}{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>")
    return "\n".join(['<div class="wide"><table>', *top, *body, "</table></div>"])


def picture(path: Path, caption: str, link: str | None = None) -> str:
    """A picture file inside the page, not wider than WIDEST; nothing where it cannot be read."""
    if not path.exists():
        return ""
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(io.BytesIO(input_file.read_bytes(path))) as file:
            image = file.convert("RGB")
    except (OSError, ValueError, UnidentifiedImageError, Image.DecompressionBombError):
        return ""
    if image.width > WIDEST:
        image = image.resize((WIDEST, round(image.height * WIDEST / image.width)), Image.Resampling.LANCZOS)
    data = io.BytesIO()
    image.save(data, "JPEG", quality=QUALITY, optimize=True)
    source = f"data:image/jpeg;base64,{base64.b64encode(data.getvalue()).decode()}"
    size = f'width="{image.width}" height="{image.height}"'
    shown = f'<img src="{source}" {size} alt="{html.escape(caption)}">'
    if link is not None:
        shown = f'<a href="{html.escape(link)}">{shown}</a>'
    return f"<figure>{shown}<figcaption>{html.escape(caption)}</figcaption></figure>"


def plot(drawing: str) -> str:
    """An SVG element that a narrow screen may scroll; nothing of nothing."""
    return drawing and f'<div class="plot">{drawing}</div>'


def text(value: Any, indent: str = "") -> str:
    """A scene as YAML, a key a line; what is null is left out."""
    lines = []
    for key, inner in value.items():
        if inner is None:
            continue
        if isinstance(inner, dict) and inner:
            lines += [f"{indent}{key}:", text(inner, indent + "  ")]
        elif isinstance(inner, list) and any(isinstance(item, dict | list) for item in inner):
            lines += [f"{indent}{key}:", *(f"{indent}  - {json.dumps(item, ensure_ascii=False)}" for item in inner)]
        else:
            lines.append(f"{indent}{key}: {json.dumps(inner, ensure_ascii=False)}")
    return "\n".join(line for line in lines if line)


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
