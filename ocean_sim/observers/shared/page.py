"""Pieces of a page that needs no other file: tables, pictures inside the page, curves as SVG, a scene as YAML."""

import base64
import html
import io
import json
import re
from collections.abc import Iterable, Mapping, Sequence
from itertools import count
from pathlib import Path
from string import Template
from typing import Any

import numpy as np

from ocean_sim.files import input_file
from ocean_sim.palette import SERIES

MAX_PICTURE_WIDTH, JPEG_QUALITY = 1200, 82  # of a picture inside the page [pixels], [%]
PLOT_WIDTH, PLOT_HEIGHT = 900, 238  # of a plot with its margins, in units of its drawing
LEFT, RIGHT, TOP, BOTTOM = 72, 12, 8, 38  # margins
CURVE_COLOURS = (*SERIES, "#7a8790")
CURVE_DASHES = ("none", "8 3", "2 3", "9 3 2 3", "5 5", "14 4", "3 2 1 2")  # curves differ without colour, too
SPIKE_RATIO = 4.0  # of the range of all values to the common range: beyond it spikes are cut
NEEDLE_RATIO = 2.0  # of the same ranges: beyond it spikes are explained
COMMON_QUANTILE = 0.995  # the common range lies between this quantile and its opposite
MAX_POINTS = 600  # of a curve
Curves = Mapping[str, np.ndarray]
PAGE_FILE = Path(__file__).with_suffix(".html")  # template of a page, with its style and the clip path of its plots


def html_page(title: str, outcome: str, parts: Iterable[str]) -> str:
    """HTML text of a page: title, `outcome` of the run (HTML), links to all headings, then `parts` (HTML) in order."""
    edges = {"left": LEFT, "top": TOP, "width": PLOT_WIDTH, "low": PLOT_HEIGHT - BOTTOM}
    body, numbers, page = "\n".join(parts), count(1), Template(PAGE_FILE.read_text(encoding="utf-8"))
    headings = enumerate(re.findall("<h2>(.*?)</h2>", body), 1)
    links = "".join(f'<a href="#part{k}">{heading}</a> ' for k, heading in headings)
    body = re.sub("<h2>", lambda _: f'<h2 id="part{next(numbers)}">', body)
    return page.substitute(edges, title=html.escape(title), outcome=outcome, links=links, body=body)


def html_table(rows: Iterable[Sequence[object]], heads: Sequence[str] = (), row_names: bool = True) -> str:
    """HTML table of `rows` of cells below a row of `heads`, if given; `row_names`: True if first cells are headings."""
    across = "".join(f'<th scope="col">{html.escape(name)}</th>' for name in heads)
    top = [f"<tr>{across}</tr>"] if heads else []
    body = []
    for row in rows:
        first, *cells = (html.escape(str(cell)) for cell in row)
        head = f'<th scope="row">{first}</th>' if row_names else f"<td>{first}</td>"
        body.append(f"<tr>{head}{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>")
    return "\n".join(['<div class="wide"><table>', *top, *body, "</table></div>"])


def embedded_picture(path: Path, caption: str, link: str | None = None) -> str:
    """HTML of a picture stored in the page, with a `caption`; a click opens `link`. Empty if it cannot be read."""
    if not path.exists():
        return ""
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(io.BytesIO(input_file.read_bytes(path))) as file:
            image = file.convert("RGB")
    except (OSError, ValueError, UnidentifiedImageError, Image.DecompressionBombError):
        return ""
    if image.width > MAX_PICTURE_WIDTH:
        height = round(image.height * MAX_PICTURE_WIDTH / image.width)
        image = image.resize((MAX_PICTURE_WIDTH, height), Image.Resampling.LANCZOS)
    data = io.BytesIO()
    image.save(data, "JPEG", quality=JPEG_QUALITY, optimize=True)
    source = f"data:image/jpeg;base64,{base64.b64encode(data.getvalue()).decode()}"
    size = f'width="{image.width}" height="{image.height}"'
    shown = f'<img src="{source}" {size} alt="{html.escape(caption)}">'
    if link is not None:
        shown = f'<a href="{html.escape(link)}">{shown}</a>'
    return f"<figure>{shown}<figcaption>{html.escape(caption)}</figcaption></figure>"


def scene_text(value: Any, indent: str = "") -> str:
    """YAML text of a scene, one key a line, each line after `indent`; keys whose value is null are left out."""
    lines = []
    for key, inner in value.items():
        if inner is None:
            continue
        if isinstance(inner, dict) and inner:
            lines += [f"{indent}{key}:", scene_text(inner, indent + "  ")]
        elif isinstance(inner, list) and any(isinstance(item, dict | list) for item in inner):
            lines += [f"{indent}{key}:", *(f"{indent}  - {json.dumps(item, ensure_ascii=False)}" for item in inner)]
        else:
            lines.append(f"{indent}{key}: {json.dumps(inner, ensure_ascii=False)}")
    return "\n".join(line for line in lines if line)


def round_ticks(low: float, high: float, about: int = 6) -> np.ndarray:
    """Round numbers between `low` and `high`, roughly `about` of them; their step is 1, 2 or 5 times a power of ten."""
    raw = (high - low) / about
    power = 10.0 ** np.floor(np.log10(raw))
    step = next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= raw * (1.0 - 1e-9))
    return np.arange(np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9) + 1) * step + 0.0


def axis_range(values: np.ndarray) -> tuple[float, float]:
    """Lower and upper end of an axis: least and greatest of `values`, ignoring NaN, with a margin."""
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)
    gap = 0.05 * (high - low) or 0.05 * abs(high) or 1.0
    return low - gap, high + gap


def range_without_spikes(values: np.ndarray, ratio: float = SPIKE_RATIO) -> tuple[float, float]:
    """Least and greatest value that a plot shows: of all, or without a few that reach over `ratio` common ranges."""
    finite = values[np.isfinite(values)]
    if not finite.size:
        return -np.inf, np.inf
    low, high = np.quantile(finite, [1.0 - COMMON_QUANTILE, COMMON_QUANTILE])
    least, greatest = finite.min(), finite.max()
    if greatest - least <= ratio * max(high - low, 1e-12 * abs(high)) or high == low:
        return float(least), float(greatest)
    return float(max(least, low - 0.5 * (high - low))), float(min(greatest, high + 0.5 * (high - low)))


def keep_crests(time: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Curve thinned to MAX_POINTS (time, value) pairs: least and greatest value in each of many equal intervals."""
    if len(time) <= MAX_POINTS:
        return time, values
    kept = []
    for rows in np.array_split(np.arange(len(time)), MAX_POINTS // 2):
        finite = rows[np.isfinite(values[rows])]
        if len(finite):
            kept += sorted({int(finite[values[finite].argmin()]), int(finite[values[finite].argmax()])})
    return time[kept], values[kept]


def curve_stroke(k: int) -> str:
    """SVG attributes of the line of curve number k; the first 49 curves differ in colour or dashes."""
    colour = CURVE_COLOURS[k % len(CURVE_COLOURS)]
    dashes = CURVE_DASHES[(k + k // len(CURVE_COLOURS)) % len(CURVE_DASHES)]
    return f'fill="none" stroke="{colour}" stroke-width="1.7" stroke-dasharray="{dashes}"'


def draw_curves(
    time: np.ndarray, series: Curves, label: str, limits: Mapping[str, float] | None = None, on_needles: str = ""
) -> str:
    """HTML figure of curves (`series`, by name) over time [s], spikes cut, with lines at `limits`; empty if all are 0
    or NaN. `label`: quantity and unit, read aloud by screen readers; `on_needles`: sentence if few values are far."""
    everything = np.concatenate(list(series.values()))
    if not np.nan_to_num(everything).any():
        return ""
    limits = limits or {}
    left, right = float(time[0]), float(max(time[-1], time[0] + 1e-9))
    bottom, top = range_without_spikes(everything)
    beyond = int(((everything < bottom) | (everything > top)).sum())
    low, high = axis_range(np.array([bottom, top, *limits.values()]))
    farthest = max(np.nanmin(everything), np.nanmax(everything), key=abs)
    note = f" ({beyond} values cut, as far as {farthest:.4g})" if beyond else ""
    has_needles = range_without_spikes(everything, NEEDLE_RATIO) != range_without_spikes(everything, np.inf)

    x = lambda t: LEFT + (t - left) / (right - left) * (PLOT_WIDTH - LEFT - RIGHT)
    y = lambda value: PLOT_HEIGHT - BOTTOM - (value - low) / (high - low) * (PLOT_HEIGHT - TOP - BOTTOM)
    level_line = lambda value, look: f'<path d="M{LEFT} {y(value):.1f}H{PLOT_WIDTH - RIGHT}" {look}/>'
    parts = [
        f'<svg viewBox="0 0 {PLOT_WIDTH} {PLOT_HEIGHT}" font-size="13" fill="currentColor" role="img" '
        f'aria-label="{html.escape(label)}, {html.escape(", ".join(series))}">'
    ]
    for value in round_ticks(low, high):
        parts.append(level_line(value, 'class="grid" stroke="#7a8790" stroke-opacity=".3"'))
        parts.append(f'<text x="{LEFT - 8}" y="{y(value) + 4:.1f}" text-anchor="end">{value:.6g}</text>')
    for moment in round_ticks(left, right, 8):
        parts.append(f'<text x="{x(moment):.1f}" y="{PLOT_HEIGHT - 18}" text-anchor="middle">{moment:.4g}</text>')
    parts.append(f'<text x="{PLOT_WIDTH - RIGHT}" y="{PLOT_HEIGHT - 3}" text-anchor="end">time [s]</text>')
    for name, value in limits.items():
        parts.append(level_line(value, 'stroke="currentColor" stroke-dasharray="1 4"'))
        parts.append(f'<text x="{LEFT + 4}" y="{y(value) - 4:.1f}" font-size="11">{html.escape(name)}</text>')
    legend = [f"<strong>{html.escape(label + note)}</strong>"]
    for k, (name, values) in enumerate(series.items()):
        line = " ".join(f"{x(t):.1f},{y(v):.1f}" for t, v in zip(*keep_crests(time, values)) if np.isfinite(v))
        parts.append(f'<polyline points="{line}" {curve_stroke(k)} clip-path="url(#plot)"/>')
        sample = f'<svg class="sample" viewBox="0 0 26 8"><path d="M0 4H26" {curve_stroke(k)}/></svg>'
        legend.append(f"<span>{sample} {html.escape(name)}</span>")
    legend += [f"<br>{html.escape(on_needles)}"] if on_needles and has_needles else []
    caption = f"<figcaption>{' '.join(legend)}</figcaption>"
    return "\n".join([f'<figure class="plot">{caption}', *parts, "</svg></figure>"])
