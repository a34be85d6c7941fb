"""`ocean-sim list`: all names to choose from, each with one sentence; no kind is imported for it."""

import typer

from ocean_sim.parts import PACKAGE, SLOTS, kinds, library, named
from ocean_sim.reading.sentences import file_sentence, module_sentence
from ocean_sim.reading.translation import choice_sentence
from ocean_sim.validation import case_names
from ocean_sim.verbs import figure
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.options import completion

SECTION_NAMES = ("scenes", *SLOTS, "hull", "geometry", "washout", "observers", "profiles", "cases", "figures")


def list_choices(
    slot: str | None = typer.Argument(
        None,
        help="scenes, observers, cases, figures, or a slot such as wind.",
        autocompletion=completion(lambda: SECTION_NAMES),
    ),
) -> None:
    """Print the names of every section, or of one (`slot`), each with a sentence."""
    if slot is not None and slot not in SECTION_NAMES:
        raise console.Refused(f"there is nothing called {slot!r} to list{choice_sentence(slot, SECTION_NAMES)[0]}")
    rows = [row for name in ([slot] if slot else SECTION_NAMES) for row in section_rows(name)]
    console.answer(rows)
    for name in dict.fromkeys(row["slot"] for row in rows):
        shown = [[row["name"], row["what"], row["sentence"]] for row in rows if row["slot"] == name]
        console.table(f"\n{name}", ["name", "", ""], shown)


def section_rows(section: str) -> list[dict[str, str]]:
    """Rows of a section of `ocean-sim list` (`scenes`, or a slot such as `wind`): dicts of name, class and sentence."""
    folder = library("configs") / ("run" if section == "profiles" else section)
    if section == "scenes":
        folder = library("scenes")
        files = sorted(folder.rglob("*.yaml"))
        found = [(path.relative_to(folder).with_suffix("").as_posix(), "scene", file_sentence(path)) for path in files]
    elif section == "cases":
        found = [(name, "case", module_sentence(PACKAGE / "validation" / f"{name}.py")) for name in case_names()]
    elif section == "figures":
        scripts = figure.figure_scripts().items()
        found = [(name, "figure", figure.figure_sentence(path)) for name, path in scripts]
    else:
        what = "profile" if section == "profiles" else "preset"
        kind = "observer" if section == "observers" else "kind"
        found = [(name, what, file_sentence(folder / f"{name}.yaml")) for name in named(folder.name)]
        found += [(name, kind, module_sentence(PACKAGE / section / f"{name}.py")) for name in kinds(section)]
    return [{"slot": section, "name": name, "what": what, "sentence": told} for name, what, told in found]
