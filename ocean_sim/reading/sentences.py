"""One descriptive sentence for each kind, preset and scene, read from source files without importing a kind."""

import ast
from functools import cache
from itertools import dropwhile, takewhile
from pathlib import Path

from ocean_sim.files.yaml_file import read_mapping
from ocean_sim.parts import PACKAGE, kinds, library, named


@cache
def part_sentence(slot: str, name: str) -> str:
    """Sentence that describes the kind (from its module) or preset (from its file) `name` of a slot, such as `wind`."""
    if name in named(slot) and name not in kinds(slot):
        return file_sentence(library("configs") / slot / f"{name}.yaml")
    return module_sentence(PACKAGE / slot / f"{name}.py")


def module_sentence(path: Path) -> str:
    """The first sentence of a module's docstring, from its file."""
    return opening_sentence(ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or "")


def opening_sentence(docstring: str) -> str:
    """The first sentence of a docstring on one line: its lines up to the first that ends with a full stop."""
    lines = docstring.split("\n\n")[0].splitlines()
    last = next((k for k, line in enumerate(lines) if line.endswith(".")), len(lines) - 1)
    return " ".join(line.strip() for line in lines[: last + 1])


def file_sentence(path: Path) -> str:
    """The title in a YAML file, or else the first sentence of its first comment."""
    title = read_mapping(path).data.get("title")
    if title is not None and isinstance(title.data, str):
        return title.data
    lines = [line for line in path.read_text(encoding="utf-8").splitlines() if "yaml-language-server" not in line]
    comment = takewhile(is_comment, dropwhile(lambda line: not is_comment(line), lines))
    return opening_sentence("\n".join(line.removeprefix("# ") for line in comment))


def is_comment(line: str) -> bool:
    return line.startswith("# ")
