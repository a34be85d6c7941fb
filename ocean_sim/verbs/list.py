"""`ocean-sim list`: what there is to choose from, each with one sentence; no kind is imported for it."""

from ocean_sim.parts import PACKAGE, SLOTS, kinds, library, named
from ocean_sim.reading.sentences import of_file, of_module
from ocean_sim.reading.translation import choice_sentence
from ocean_sim.validation import names
from ocean_sim.verbs import figure
from ocean_sim.verbs.shared import console

SECTIONS = ("scenes", *SLOTS, "hull", "geometry", "washout", "observers", "profiles", "cases", "figures")


def list_choices(section: str | None, as_json: bool) -> None:
    """Print every section, or one of them."""
    if section is not None and section not in SECTIONS:
        raise console.Refused(f"there is nothing called {section!r} to list{choice_sentence(section, SECTIONS)[0]}")
    rows = [row for name in ([section] if section else SECTIONS) for row in entries(name)]
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
        return [row(section, name, "case", of_module(PACKAGE / "validation" / f"{name}.py")) for name in names()]
    if section == "figures":
        return [row(section, name, "figure", figure.sentence(path)) for name, path in figure.scripts().items()]
    parts = [
        row(section, name, "preset", of_file(library("configs") / section / f"{name}.yaml")) for name in named(section)
    ]
    what = "observer" if section == "observers" else "kind"
    return parts + [row(section, name, what, of_module(PACKAGE / section / f"{name}.py")) for name in kinds(section)]


def row(section: str, name: str, what: str, sentence: str) -> dict[str, str]:
    return {"slot": section, "name": name, "what": what, "sentence": sentence}
