"""Configuration of Sphinx for these pages: `./sandbox docs`. Nothing is fetched; a warning is an error."""

import sys
from pathlib import Path
from typing import Any

from docutils import nodes
from latex2mathml.converter import convert

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parent.parent)]

import generate  # noqa: E402

project = "Ocean Sim"
copyright = "Ocean Sim contributors"
extensions = ["myst_parser", "sphinx.ext.autodoc"]
myst_enable_extensions = ["dollarmath", "deflist", "colon_fence"]
myst_heading_anchors = 3
html_theme = "furo"
html_title = "Ocean Sim"
html_show_sphinx = False
html_static_path: list[str] = []
autodoc_member_order = "bysource"
autodoc_typehints = "description"
html_math_renderer = "mathml"
exclude_patterns = ["tutorials/*.py", "_build"]
suppress_warnings = ["myst.header"]


def inline_math(self: Any, node: nodes.math) -> None:
    self.body.append(convert(node.astext()))
    raise nodes.SkipNode


def block_math(self: Any, node: nodes.math_block) -> None:
    self.body.append(f'<div class="math">{convert(node.astext(), display="block")}</div>')
    raise nodes.SkipNode


def setup(app: Any) -> None:
    """Browsers draw MathML by themselves, so that no script is fetched for formulas."""
    app.add_html_math_renderer("mathml", (inline_math, None), (block_math, None))
    app.connect("builder-inited", lambda app: generate.pages(Path(app.srcdir) / "generated"))
