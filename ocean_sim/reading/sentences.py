"""What each thing that a scene may name is, in one sentence; no kind is imported for it."""

import ast
from functools import cache
from pathlib import Path

from ocean_sim.files.yaml_file import read
from ocean_sim.parts import PACKAGE, kinds, library, named


@cache
def sentence(slot: str, name: str) -> str:
    """Of a kind, or of a ready-made part."""
    if name in named(slot) and name not in kinds(slot):
        return of_file(library("configs") / slot / f"{name}.yaml")
    return of_module(PACKAGE / slot / f"{name}.py")


def of_module(path: Path) -> str:
    """The first line of a module's docstring."""
    return (ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or "").split("\n")[0]


def of_file(path: Path) -> str:
    """The title in a file, or else its first comment line."""
    title = read(path).data.get("title")
    if title is not None and isinstance(title.data, str):
        return title.data
    comments = [line for line in path.read_text(encoding="utf-8").splitlines() if line.startswith("# ")]
    return next((line[2:] for line in comments if "yaml-language-server" not in line), "")
