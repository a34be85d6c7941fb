"""Pieces of a page that needs nothing but itself: tables, pictures inside the page, a scene as text."""

import base64
import html
import io
import json
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from ocean_sim.files import input_file

WIDEST, QUALITY = 1200, 82  # pixels of a picture in the page, and JPEG quality
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
        with Image.open(io.BytesIO(input_file.content(path))) as file:
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
