"""`ocean-sim explain`: meaning, unit, default and range of a key of a scene, with an example of its setting."""

import shlex
from typing import Any

import typer

from ocean_sim.files.yaml_file import Location, in_yaml, node_of
from ocean_sim.model import in_brackets
from ocean_sim.parts import ALONE, SEVERAL, SLOTS
from ocean_sim.reading.composition import choice_of, kind_named, known_names
from ocean_sim.reading.keys import Key, by_path, keys_at, keys_elsewhere, scene_keys
from ocean_sim.reading.sentences import part_sentence
from ocean_sim.reading.translation import choice_sentence, likeliest
from ocean_sim.verbs.list import list_choices
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.options import completion

SHOWN = ("meaning", "takes", "unit", "default", "range", "example")
MAX_AT_LENGTH = 12  # keys that are explained at length; of more only their meanings are listed


def explain(
    key: str = typer.Argument(
        help="A key such as wind.stress.u10, or without the kind: wind.u10.", autocompletion=completion(by_path)
    ),
) -> None:
    """Explain a key, or the keys of a preset or a kind; another word is refused, with the likeliest key."""
    asked = key.partition("=")[0].strip().lower()
    slot = asked.removesuffix(".kind")
    if slot in (*SLOTS, SEVERAL):
        list_choices(ALONE if slot == SEVERAL else slot)
        return
    same = group_alike(keys_at(by_kind(asked)) or [each for each in scene_keys() if each.path.split(".")[-1] == asked])
    part = None if same and "." not in asked else preset_choice(asked)
    if part is not None:
        named = group_alike(keys_at(f"{part[0]}.{kind_named(*part)}"))
        same = [(with_preset_value(each, *part), paths) for each, paths in named]
    if not same and part is None:
        whole = {each.path for each in scene_keys()}
        shorter = {path.partition(".")[0] for path in whole} | {path.rpartition(".")[2] for path in whole}
        end = keys_elsewhere(asked.rpartition(".")[2]) or choice_sentence(asked, sorted(whole | shorter))[0]
        end = suggestion_ending(asked) or end or "; `ocean-sim list` shows all there is to choose from"
        raise console.Refused(f"there is no key {key!r}{end}")
    told = lambda key: {name: getattr(key, name) for name in SHOWN}
    console.answer([{"key": paths[0], "keys": paths} | told(each) for each, paths in same])
    if part is not None:
        console.say(f"{'.'.join(part)}: {part_sentence(*part)}\n")
    if len(same) <= MAX_AT_LENGTH:
        for each, paths in same:
            console.say("\n".join(key_lines(each, paths)) + "\n")
    else:
        console.table("", ["key", "default", "meaning"], [key_row(each, paths) for each, paths in same])


def preset_choice(word: str) -> tuple[str, str] | None:
    """Slot and name of a preset or kind given as `ship.yacht` or `yacht`; None if the word names neither."""
    slot, _, name = word.rpartition(".")
    return next(((each, name) for each in SLOTS if slot in ("", each) and name in known_names(each)), None)


def with_preset_value(key: Key, slot: str, name: str) -> Key:
    """Copy of a key whose default is the value that preset `name` of a slot sets; the key itself if it sets none."""
    value = choice_of(slot, node_of(name, Location(name))).base.plain().get(key.path.split(".")[2])
    return key if value is None else key._replace(default=in_yaml(value))


def by_kind(word: str) -> str:
    """Replace the preset in a key's path by its kind: `ship.dynamic.position` for `ship.yacht.position`."""
    slot, _, rest = word.partition(".")
    name, dot, below = rest.partition(".")
    if preset_choice(f"{slot}.{name}") is None:
        return word
    return f"{slot}.{kind_named(slot, name)}{dot}{below}"


def suggestion_ending(word: str) -> str:
    """End of an error message: key or kind of the same level most like `word`, `wind.u10` for `wind.u`; or empty."""
    above, _, last = word.rpartition(".")
    beside = by_kind(above)
    there = {key.path.rpartition(".")[2] for key in keys_at(beside)} - {beside.rpartition(".")[2]} if above else set()
    names = known_names(above) if above in SLOTS else []
    likely = likeliest(last, sorted({*there, *names}))
    return f"; did you mean '{above}.{likely}'?" if likely else ""


def group_alike(found: list[Key]) -> list[tuple[Key, list[str]]]:
    """Group keys that differ only in the kind that has them: the first key of each group, and the paths of all."""
    same: dict[tuple[Any, ...], tuple[Key, list[str]]] = {}
    for key in found:
        name = key.path.split(".")
        alike = (name[0], *name[2:], *key[1:6]) if len(name) > 2 else key
        same.setdefault(alike, (key, []))[1].append(key.path)
    return list(same.values())


def key_lines(key: Key, paths: list[str]) -> list[str]:
    """Lines of text that describe a key in full; `paths`: all paths that lead to it, one for each kind."""
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


def key_row(key: Key, paths: list[str]) -> list[str]:
    more = f" and {len(paths) - 1} more" if len(paths) > 1 else ""
    return [paths[0] + more, key.default, f"{key.meaning}{in_brackets(key.unit)}"]
