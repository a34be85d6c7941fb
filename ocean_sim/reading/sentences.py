"""One sentence on each thing that a scene may name; no kind is imported for it."""

import ast
from functools import cache
from itertools import dropwhile, takewhile
from pathlib import Path

from ocean_sim.files.yaml_file import read_mapping
from ocean_sim.parts import PACKAGE, kinds, library, named


@cache
def part_sentence(slot: str, name: str) -> str:
    """The sentence of a kind, or of a preset."""
    if name in named(slot) and name not in kinds(slot):
        return file_sentence(library("configs") / slot / f"{name}.yaml")
    return module_sentence(PACKAGE / slot / f"{name}.py")


def module_sentence(path: Path) -> str:
    """The sentence that the docstring of a module begins with."""
    return opening_sentence(ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or "")


def opening_sentence(docstring: str) -> str:
    """The lines of a docstring up to the first that ends a sentence, as one."""
    lines = docstring.split("\n\n")[0].splitlines()
    last = next((k for k, line in enumerate(lines) if line.endswith(".")), len(lines) - 1)
    return " ".join(line.strip() for line in lines[: last + 1])


def file_sentence(path: Path) -> str:
    """The title in a file, or else the beginning of its first comment."""
    title = read_mapping(path).data.get("title")
    if title is not None and isinstance(title.data, str):
        return title.data
    lines = [line for line in path.read_text(encoding="utf-8").splitlines() if "yaml-language-server" not in line]
    comment = takewhile(is_comment, dropwhile(lambda line: not is_comment(line), lines))
    return opening_sentence("\n".join(line.removeprefix("# ") for line in comment))


def is_comment(line: str) -> bool:
    return line.startswith("# ")
