"""`ocean-sim list`: what there is to choose from, each with one sentence; no kind is imported for it."""

from typing import Annotated

import typer

from ocean_sim.parts import PACKAGE, SLOTS, kinds, library, named
from ocean_sim.reading.sentences import of_file, of_module
from ocean_sim.reading.translation import choice_sentence
from ocean_sim.validation import case_names
from ocean_sim.verbs import figure
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.options import Json

SECTIONS = ("scenes", *SLOTS, "hull", "geometry", "washout", "observers", "profiles", "cases", "figures")


def complete_section(begun: str) -> list[str]:
    """Sections that begin so."""
    return [name for name in SECTIONS if name.startswith(begun)]


def list_choices(
    slot: Annotated[
        str | None,
        typer.Argument(
            help="scenes, observers, cases, figures, or a slot such as wind.", autocompletion=complete_section
        ),
    ] = None,
    as_json: Json = False,
) -> None:
    """Print every slot, or one of them."""
    if slot is not None and slot not in SECTIONS:
        raise console.Refused(f"there is nothing called {slot!r} to list{choice_sentence(slot, SECTIONS)[0]}")
    rows = [row for name in ([slot] if slot else SECTIONS) for row in entries(name)]
    if as_json:
        console.answer(rows)
        return
    for name in dict.fromkeys(row["slot"] for row in rows):
        shown = [[row["name"], row["what"], row["sentence"]] for row in rows if row["slot"] == name]
        console.table(f"\n{name}", ["name", "", ""], shown)


def entries(section: str) -> list[dict[str, str]]:
    """Name, what it is and a sentence, for everything in a section."""
    if section == "scenes":
        folder = library("scenes")
        return [
            row(section, path.relative_to(folder).with_suffix("").as_posix(), "scene", of_file(path))
            for path in sorted(folder.rglob("*.yaml"))
        ]
    if section == "profiles":
        folder = library("configs") / "run"
        return [row(section, name, "profile", of_file(folder / f"{name}.yaml")) for name in named("run")]
    if section == "cases":
        return [row(section, name, "case", of_module(PACKAGE / "validation" / f"{name}.py")) for name in case_names()]
    if section == "figures":
        return [row(section, name, "figure", figure.sentence(path)) for name, path in figure.scripts().items()]
    parts = [
        row(section, name, "preset", of_file(library("configs") / section / f"{name}.yaml")) for name in named(section)
    ]
    what = "observer" if section == "observers" else "kind"
    return parts + [row(section, name, what, of_module(PACKAGE / section / f"{name}.py")) for name in kinds(section)]


def row(section: str, name: str, what: str, sentence: str) -> dict[str, str]:
    return {"slot": section, "name": name, "what": what, "sentence": sentence}
