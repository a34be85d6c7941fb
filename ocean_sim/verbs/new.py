"""`ocean-sim new`: a scene of one's own to start from, every key with a comment."""

import json
import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

import typer

from ocean_sim.files.whole_file import whole
from ocean_sim.files.yaml_file import Node, read
from ocean_sim.machine import cache_directory
from ocean_sim.parts import PACKAGE, SLOTS
from ocean_sim.reading.composition import kind_named, known
from ocean_sim.reading.keys import in_yaml, keys
from ocean_sim.reading.scene import load, scene_path
from ocean_sim.reading.schema import text
from ocean_sim.reading.sentences import sentence
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.options import Json, complete_scene

WORD = re.compile(r"[A-Za-z][A-Za-z0-9_]*( [A-Za-z0-9_'.-]+)*")
NOT_TEXT = ("null", "true", "false")
MARGIN = 44  # column at which comments begin
FEW = 6  # names of what else a slot may hold


def new(
    file: Annotated[Path, typer.Argument(help="The scene file to write.")],
    source: Annotated[
        str, typer.Option("--from", help="The scene to start from: a name or a file.", autocompletion=complete_scene)
    ] = "showcase",
    as_json: Json = False,
) -> None:
    """Write a scene like another one; never over a file that is there."""
    if file.suffix not in (".yaml", ".yml"):
        raise console.Refused(f"{file}: a scene is a YAML file; name one that ends in .yaml")
    if not file.parent.is_dir():
        raise console.Refused(f"{file}: there is no folder {file.parent}; make it first")
    if file.exists():
        raise console.Refused(f"{file}: this file is there already; name another one")
    load(source)  # what is wrong with it is reported first
    scene = read(scene_path(source))
    with whole(file) as draft:
        draft.write_text("\n".join(lines(scene, file)) + "\n", encoding="utf-8")
    load(file)
    if as_json:
        console.answer({"file": file})
    else:
        console.say(f"{file}: try `ocean-sim check {file}`, then `ocean-sim run {file}`")


def lines(scene: Node, file: Path) -> Iterator[str]:
    """The text of a scene with comments."""
    schema, here = schema_file(), file.absolute().parent
    near = schema.is_relative_to(PACKAGE) and PACKAGE.parent in (here, *here.parents)  # in a checkout
    yield f"# yaml-language-server: $schema={os.path.relpath(schema, here) if near else schema.absolute().as_uri()}"
    yield "# SI units and radians unless a key says otherwise; `ocean-sim explain KEY` says more of each."
    meanings = {key.path: f"{key.meaning.split('; ')[0].split('. ')[0].rstrip('.')}{unit(key.unit)}" for key in keys()}
    yield from block(scene.data, (), meanings, "")
    absent = [slot for slot in SLOTS if slot not in scene.data and slot != "time_step"]
    if "ships" in scene.data:
        absent.remove("ship")
    if absent:
        yield "\n# It may also have:"
    for slot in absent:
        names = known(slot)
        more = ", ..." if len(names) > FEW else ""
        yield f"# {slot}: one of {', '.join(names[:FEW])}{more}  (`ocean-sim list {slot}`)"


def schema_file() -> Path:
    """The schema as a file: the one that setting up writes into the package, else one in the user's cache, as a package
    that pip installed has none."""
    of_package = PACKAGE / "scene.schema.json"
    if of_package.is_file():
        return of_package
    kept, wanted = cache_directory() / "scene.schema.json", text()
    if not kept.is_file() or kept.read_text(encoding="utf-8") != wanted:
        kept.parent.mkdir(parents=True, exist_ok=True)
        with whole(kept) as draft:
            draft.write_text(wanted, encoding="utf-8")
    return kept


def unit(of: str) -> str:
    return f" [{of}]" if of not in ("", "1") else ""


def block(data: dict[str, Node], path: tuple[str, ...], meanings: dict[str, str], kind: str) -> Iterator[str]:
    """The lines of a mapping: short ones within a line, others below their key."""
    indent = "  " * len(path)
    for key, node in data.items():
        inner = (*path, key)
        words = (inner[0], kind, *inner[1:]) if kind else inner
        comment = meanings.get(".".join(words), "")
        if len(path) == 0 and key in SLOTS and isinstance(node.data, str):
            comment = sentence(key, node.data)
        if isinstance(node.data, dict) and node.data and not path:
            yield commented(f"{indent}{key}:", comment)
            own = node.data.get("kind")
            yield from block(node.data, inner, meanings, kind_of(inner, own.data if own is not None else ""))
        else:
            yield commented(f"{indent}{key}: {flow(node.plain())}", comment)


def kind_of(path: tuple[str, ...], name: str) -> str:
    """The kind whose keys are written below a slot; empty elsewhere."""
    if path[0] not in SLOTS or not name:
        return ""
    return kind_named(path[0], name)


def commented(text: str, comment: str) -> str:
    return f"{text:<{MARGIN}}  # {comment}" if comment else text


def flow(value: Any) -> str:
    """A value within a line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {flow(inner)}" for key, inner in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(flow, value)) + "]"
    if isinstance(value, str):
        plain = WORD.fullmatch(value) and value not in NOT_TEXT
        return value if plain else json.dumps(value, ensure_ascii=False)
    return in_yaml(value)
