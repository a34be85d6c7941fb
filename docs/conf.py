"""Configuration of Sphinx for these pages: `./sandbox docs`. Nothing is fetched; a warning is an error."""

import json
import re
import sys
from pathlib import Path
from typing import Any

import yaml
from docutils import nodes
from latex2mathml.converter import convert

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parent.parent)]

import generate  # noqa: E402

project = "Ocean Sim"
copyright = "Ocean Sim contributors"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.githubpages"]  # the last: hosts keep _static/
myst_enable_extensions = ["dollarmath", "deflist", "colon_fence", "attrs_inline"]
myst_heading_anchors = 3
html_theme = "furo"
html_title = "Ocean Sim"
html_show_sphinx = False
html_show_search_summary = False  # it would fetch pages, which browsers refuse on file://; see excerpts.js
html_copy_source = False
html_static_path = ["static"]
html_css_files = ["pages.css"]
html_js_files = ["excerpts.js"]
autodoc_member_order = "bysource"
autodoc_typehints = "description"
html_math_renderer = "mathml"
exclude_patterns = ["tutorials/*.py", "_build"]
smartquotes = False  # which would make one dash of the two of an option
suppress_warnings = ["myst.header"]
UNREAD = nodes.raw, nodes.comment, nodes.literal_block  # left out of excerpts
WORD_LENGTHS = {"whole": 40, "short": 16}  # characters that fit a line of text on a phone, and a cell of a table
contents = yaml.safe_load((Path(__file__).parent / "contents.yaml").read_text(encoding="utf-8"))


def inline_math(self: Any, node: nodes.math) -> None:
    self.body.append(convert(node.astext()))
    raise nodes.SkipNode


def block_math(self: Any, node: nodes.math_block) -> None:
    self.body.append(f'<div class="math">{convert(node.astext(), display="block")}</div>')
    raise nodes.SkipNode


def add_contents(app: Any, page: str, source: list[str]) -> None:
    """Add a table of contents to root pages, and turn links to tutorial scripts into links to their pages.

    On the web's view of files the page so shows no directive, and its links open the scripts.
    """
    source[0] = re.sub(r"\]\(((?:\.\./)?)tutorials/(\w+)\.py\)", r"](\1generated/tutorial_\2.md)", source[0])
    for caption, names in app.config.contents.get(page, {}).items():
        shown = ":reversed:" if "*" in names[0] else ":hidden:"
        source[0] += "\n".join(["\n```{toctree}", f":caption: {caption}", ":glob:", shown, "", *names, "```\n"])


def mark_code(app: Any, page: nodes.document, docname: str) -> None:
    """Add classes to inline code whose words are short enough to stay whole on a line of a page, or of a table."""
    for node in page.findall(nodes.literal):
        longest = max(map(len, node.astext().split()), default=0)
        node["classes"] += [name for name, most in WORD_LENGTHS.items() if longest <= most]


def write_texts(app: Any, failure: Exception | None) -> None:
    """Write the prose of each page, for excerpts in the results of the search, as a script that assigns it to TEXTS."""
    if failure is None:
        texts = {}
        for page in sorted(app.env.found_docs):
            words = app.env.get_doctree(page)
            for node in list(words.findall(lambda node: isinstance(node, UNREAD))):
                node.parent.remove(node)
            texts[page] = " ".join(words.astext().split())
        Path(app.outdir, "_static", "texts.js").write_text(f"const TEXTS = {json.dumps(texts)};\n", encoding="utf-8")


def setup(app: Any) -> None:
    """Register formulas as MathML, which browsers draw by themselves, so that no script is fetched."""
    app.add_config_value("contents", {}, "env")  # another tree builds all pages anew
    app.add_html_math_renderer("mathml", (inline_math, None), (block_math, None))
    app.connect("source-read", add_contents)
    app.connect("doctree-resolved", mark_code)
    app.connect("build-finished", write_texts)
    app.connect("builder-inited", lambda app: generate.pages(Path(app.srcdir) / "generated"))
