"""`ocean-sim new` and `schema`: a scene to start from, every key with a comment, and the JSON Schema for editors."""

import os
import sys
from collections.abc import Iterator
from pathlib import Path

import typer

from ocean_sim.files.atomic_file import write_file
from ocean_sim.files.yaml_file import Node, in_yaml, read_mapping
from ocean_sim.machine import cache_directory
from ocean_sim.model import in_brackets
from ocean_sim.parts import PACKAGE, SLOTS
from ocean_sim.reading.composition import kind_named, known_names
from ocean_sim.reading.keys import scene_keys, schema_text
from ocean_sim.reading.scene import load, scene_path
from ocean_sim.reading.sentences import part_sentence
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.options import complete_scene

COMMENT_COLUMN = 44  # at which comments begin
MAX_NAMES = 6  # names of what else a slot may hold


def new(
    file: Path = typer.Argument(help="The scene file to write."),
    source: str = typer.Option(
        "showcase", "--from", help="The scene to start from: a name or a file.", autocompletion=complete_scene
    ),
) -> None:
    """Write a scene like another one; never over a file that is there."""
    if file.suffix not in (".yaml", ".yml"):
        raise console.Refused(f"{file}: a scene is a YAML file; name one that ends in .yaml")
    if not file.parent.is_dir():
        raise console.Refused(f"{file}: there is no folder {file.parent}; make it first")
    if file.exists():
        raise console.Refused(f"{file}: this file is there already; name another one")
    load(source)  # what is wrong with it is reported first
    write_file(file, "\n".join(scene_lines(read_mapping(scene_path(source)), file)) + "\n")
    load(file)
    console.reply({"file": file}, f"{file}: try `ocean-sim check {file}`, then `ocean-sim run {file}`")


def scene_lines(scene: Node, file: Path) -> Iterator[str]:
    """Yield the lines of a scene file with a comment on each key, then on absent parts, as `wind`; `file`: its path."""
    schema, here = schema_file(), file.absolute().parent
    near = schema.is_relative_to(PACKAGE) and PACKAGE.parent in (here, *here.parents)  # in a checkout
    yield f"# yaml-language-server: $schema={os.path.relpath(schema, here) if near else schema.absolute().as_uri()}"
    yield "# SI units and radians unless a key says otherwise; `ocean-sim explain KEY` says more of each."
    first = {key: key.meaning.split("; ")[0].split(". ")[0].rstrip(".") for key in scene_keys()}
    meanings = {key.path: f"{meaning}{in_brackets(key.unit)}" for key, meaning in first.items()}
    yield from section_lines(scene.data, meanings)
    absent = [slot for slot in SLOTS if slot not in scene.data and slot != "time_step"]
    if "ships" in scene.data:
        absent.remove("ship")
    if absent:
        yield "\n# It may also have:"
    for slot in absent:
        names = known_names(slot)
        more = ", ..." if len(names) > MAX_NAMES else ""
        yield f"# {slot}: one of {', '.join(names[:MAX_NAMES])}{more}  (`ocean-sim list {slot}`)"


def schema_file() -> Path:
    """Path of the JSON Schema: in the package if installed there by the setup, else written to the user's cache."""
    of_package = PACKAGE / "scene.schema.json"
    if of_package.is_file():
        return of_package
    kept, wanted = cache_directory() / "scene.schema.json", schema_text()
    if not kept.is_file() or kept.read_text(encoding="utf-8") != wanted:
        write_file(kept, wanted)
    return kept


def section_lines(data: dict[str, Node], meanings: dict[str, str]) -> Iterator[str]:
    """Yield the YAML lines of keys and values (`data`, by name), with `meanings` of keys (by path) as comments."""
    for key, node in data.items():
        name = isinstance(node.data, str) and key in SLOTS
        comment = part_sentence(key, node.data) if name else meanings.get(key, "")
        if not node.is_mapping or not node.data:
            yield with_comment(f"{key}: {in_yaml(node.plain())}", comment)
            continue
        yield with_comment(f"{key}:", comment)
        kind = node.data.get("kind")
        place = key if kind is None or key not in SLOTS else f"{key}.{kind_named(key, kind.data)}"
        for inner, value in node.data.items():
            yield with_comment(f"  {inner}: {in_yaml(value.plain())}", meanings.get(f"{place}.{inner}", ""))


def with_comment(text: str, comment: str) -> str:
    """The line `text` of YAML, with the comment at COMMENT_COLUMN unless it is empty."""
    return f"{text:<{COMMENT_COLUMN}}  # {comment}" if comment else text


def print_schema(out: Path | None = typer.Option(None, help="A file to write instead of standard output.")) -> None:
    """Print the JSON Schema of scenes, or write it into a file."""
    if out is None:
        with console.NAMED_OUTPUT:
            sys.stdout.write(schema_text())
            sys.stdout.flush()
    else:
        write_file(out, schema_text())
