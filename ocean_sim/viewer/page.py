"""The page: one document that holds its style and its programs, and may hold a replay."""

import base64
import html
import json
import re
from functools import cache
from pathlib import Path
from typing import Any

STATIC = Path(__file__).parent / "static"
SCRIPTS = ("math", "packets", "draw", "world", "cameras", "plots", "editor", "xr", "app")


@cache
def part(name: str) -> str:
    """A file of the page."""
    return (STATIC / name).read_text(encoding="utf-8")


def page(title: str, start: dict[str, Any], data: dict[str, bytes] | None = None) -> bytes:
    """The document. `start`: what its programs begin with; `data`: packets that it holds, by name."""
    held = "".join(
        f'<script type="application/octet-stream" id="{name}">{base64.b64encode(content).decode()}</script>\n'
        for name, content in (data or {}).items()
    )
    program = "".join(part(f"{name}.js") for name in SCRIPTS)
    given = json.dumps(start, allow_nan=False).replace("<", "\\u003c")
    contents = {
        "<!--title-->": html.escape(title),
        "/*style*/": part("style.css"),
        "<!--data-->": held,
        "/*start*/": f"const START = {given};",
        "/*program*/": program,
    }
    places = "|".join(map(re.escape, contents))
    return re.sub(places, lambda place: contents[place[0]], part("index.html")).encode(errors="replace")
