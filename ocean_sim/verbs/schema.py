"""`ocean-sim schema`: the JSON Schema of a scene, for editors."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from ocean_sim.files.atomic_file import atomic_write
from ocean_sim.reading.schema import text
from ocean_sim.verbs.shared import console


def schema(
    out: Annotated[Path | None, typer.Option(help="A file to write instead of standard output.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="The output is always JSON.")] = True,
) -> None:
    """Print the schema, or write it into a file."""
    if out is None:
        with console.OUTPUT:
            sys.stdout.write(text())
            sys.stdout.flush()
    else:
        with atomic_write(out) as draft:
            draft.write_text(text(), encoding="utf-8")
