"""`ocean-sim explain`: one key of a scene: what it means, its unit, default and range, and how to set it."""

import shlex
from typing import Annotated, Any

import typer

from ocean_sim.files.yaml_file import Location, in_yaml, node_of
from ocean_sim.model import in_brackets
from ocean_sim.parts import ALONE, SEVERAL, SLOTS
from ocean_sim.reading.composition import chosen, kind_named, known
from ocean_sim.reading.keys import Key, elsewhere, found, keys
from ocean_sim.reading.sentences import sentence
from ocean_sim.reading.translation import choice_sentence, likeliest
from ocean_sim.verbs.list import list_choices
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.options import Json

MAX_AT_LENGTH = 12  # keys that are explained at length; of more only their meanings are listed


def complete_key(begun: str) -> list[str]:
    """Paths of keys that begin so."""
    return [key.path for key in keys() if key.path.startswith(begun)]


def explain(
    key: Annotated[
        str,
        typer.Argument(
            help="A key such as wind.stress.u10, or without the kind: wind.u10.", autocompletion=complete_key
        ),
    ],
    as_json: Json = False,
) -> None:
    """Explain a key, or the keys of a preset or a kind; what is none of them is refused with the likeliest key."""
    asked = key.partition("=")[0].strip().lower()
    if asked in (*SLOTS, SEVERAL):
        list_choices(ALONE if asked == SEVERAL else asked, as_json)
        return
    same = grouped(found(by_kind(asked)) or [each for each in keys() if each.path.split(".")[-1] == asked])
    part = None if same and "." not in asked else choice(asked)
    if part is not None:
        same = [(over(each, *part), paths) for each, paths in grouped(found(f"{part[0]}.{kind_named(*part)}"))]
    if not same and part is None:
        raise console.Refused(f"there is no key {key!r}{meant(asked)}")
    if as_json:
        console.answer([answer(each, paths) for each, paths in same])
        return
    if part is not None:
        console.say(f"{'.'.join(part)}: {sentence(*part)}\n")
    if len(same) <= MAX_AT_LENGTH:
        for each, paths in same:
            console.say("\n".join(lines(each, paths)) + "\n")
    else:
        console.table("", ["key", "default", "meaning"], [row(each, paths) for each, paths in same])


def choice(word: str) -> tuple[str, str] | None:
    """The slot and the name of a preset or a kind: of `ship.yacht`, or of `yacht` alone."""
    slot, _, name = word.rpartition(".")
    return next(((each, name) for each in SLOTS if slot in ("", each) and name in known(each)), None)


def over(key: Key, slot: str, name: str) -> Key:
    """A key of the kind of a preset, with the preset's own value as its default."""
    own = chosen(slot, node_of(name, Location(name))).base.plain()
    value = own.get(key.path.split(".")[2])
    return key if value is None else key._replace(default=in_yaml(value))


def by_kind(word: str) -> str:
    """A path with the kind in place of the preset: `ship.dynamic.position` for `ship.yacht.position`."""
    slot, _, rest = word.partition(".")
    name, dot, below = rest.partition(".")
    if choice(f"{slot}.{name}") is None:
        return word
    return f"{slot}.{kind_named(slot, name)}{dot}{below}"


def meant(word: str) -> str:
    """The end of a refusal: what the word most likely means, else where there is more."""
    whole = {key.path for key in keys()}
    shorter = {path.partition(".")[0] for path in whole} | {path.rpartition(".")[2] for path in whole}
    end = elsewhere(word.rpartition(".")[2]) or choice_sentence(word, sorted(whole | shorter))[0]
    return among(word) or end or "; `ocean-sim list` shows all there is to choose from"


def among(word: str) -> str:
    """The likeliest of what lies beside a wrong one: the key `wind.u10` for `wind.speed`, the kind `wind.stress`."""
    above, _, last = word.rpartition(".")
    beside = by_kind(above)
    there = {key.path.rpartition(".")[2] for key in found(beside)} - {beside.rpartition(".")[2]} if above else set()
    names = known(above) if above in SLOTS else []
    likely = likeliest(last, sorted({*there, *names}))
    return f"; did you mean '{above}.{likely}'?" if likely else ""


def grouped(found: list[Key]) -> list[tuple[Key, list[str]]]:
    """Keys that several kinds have alike, once, with the paths of all."""
    same: dict[tuple[Any, ...], tuple[Key, list[str]]] = {}
    for key in found:
        name = key.path.split(".")
        alike = (name[0], *name[2:], *key[1:6]) if len(name) > 2 else key
        same.setdefault(alike, (key, []))[1].append(key.path)
    return list(same.values())


def lines(key: Key, paths: list[str]) -> list[str]:
    """A key at length."""
    bounds = f", {key.range}" if key.range else ""
    slot = paths[0].partition(".")[0]
    owners = list(dict.fromkeys(path.split(".")[1] for path in paths)) if slot in SLOTS else []
    return [
        ", ".join(paths),
        f"  {key.meaning}",
        f"  takes    {key.takes}{in_brackets(key.unit)}{bounds}",
        f"  default  {key.default or 'none'}",
        f"  example  --set {shlex.quote(key.example)}",
        *([f"  where    {slot}.kind is {' or '.join(owners)}"] if owners else []),
    ]


def row(key: Key, paths: list[str]) -> list[str]:
    more = f" and {len(paths) - 1} more" if len(paths) > 1 else ""
    return [paths[0] + more, key.default, f"{key.meaning}{in_brackets(key.unit)}"]


def answer(key: Key, paths: list[str]) -> dict[str, Any]:
    shown = ("meaning", "takes", "unit", "default", "range", "example")
    return {"key": paths[0], "keys": paths} | {name: getattr(key, name) for name in shown}
