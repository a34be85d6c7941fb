"""`ocean-sim explain`: one key of a scene: what it means, its unit, default and range, and how to set it."""

from typing import Any

from ocean_sim.parts import SLOTS
from ocean_sim.reading.keys import Key, found, keys, schema_slots
from ocean_sim.reading.translation import choice_sentence, likeliest
from ocean_sim.verbs.list import list_choices
from ocean_sim.verbs.shared import console

MOST = 12  # keys that are explained at length; of more only their meanings are listed


def explain(word: str, as_json: bool) -> None:
    """Explain a key; what is no key is refused with the likeliest one."""
    if word in SLOTS:
        list_choices(word, as_json)
        return
    same = grouped(found(word) or [key for key in keys() if key.path.split(".")[-1] == word])
    if not same:
        whole = {key.path for key in keys()}
        shorter = {path.partition(".")[0] for path in whole} | {path.rpartition(".")[2] for path in whole}
        end, _ = choice_sentence(word, sorted(whole | shorter))
        ends = sorted({key.path for key in keys() if key.path.split(".")[-1] == word.split(".")[-1]})
        raise console.Refused(f"there is no key {word!r}{among(word) or elsewhere(ends) or end}")
    if as_json:
        console.answer([answer(key, paths) for key, paths in same])
    elif len(same) <= MOST:
        for key, paths in same:
            console.say("\n".join(lines(key, paths)) + "\n")
    else:
        console.table("", ["key", "default", "meaning"], [row(key, paths) for key, paths in same])


def among(word: str) -> str:
    """The likeliest of the keys that lie beside a wrong one: `wind.u10` for `wind.speed`."""
    above, _, last = word.rpartition(".")
    there = {key.path.rpartition(".")[2] for key in found(above)} - {above.rpartition(".")[2]} if above else ()
    meant = likeliest(last, sorted(there))
    return f"; did you mean '{above}.{meant}'?" if meant else ""


def elsewhere(paths: list[str]) -> str:
    """Where keys of this name are, if there are any."""
    more = f" and {len(paths) - 3} more" if len(paths) > 3 else ""
    return f"; there are {', '.join(paths[:3])}{more}" if paths else ""


def grouped(found: list[Key]) -> list[tuple[Key, list[str]]]:
    """Keys that several kinds have alike, once, with the paths of all."""
    same: dict[tuple[Any, ...], tuple[Key, list[str]]] = {}
    for key in found:
        name = key.path.split(".")
        alike = (name[0], *name[2:], *key[1:6]) if len(name) > 2 else key
        same.setdefault(alike, (key, []))[1].append(key.path)
    return list(same.values())


def unit_of(key: Key) -> str:
    return f" [{key.unit}]" if key.unit not in ("", "1") else ""


def lines(key: Key, paths: list[str]) -> list[str]:
    """A key at length."""
    bounds = f", {key.range}" if key.range else ""
    slot = paths[0].partition(".")[0]
    owners = list(dict.fromkeys(path.split(".")[1] for path in paths)) if slot in schema_slots() else []
    return [
        ", ".join(paths),
        f"  {key.meaning}",
        f"  takes    {key.takes}{unit_of(key)}{bounds}",
        f"  default  {key.default or 'none'}",
        f"  example  --set {key.example}",
        *([f"  where    {slot}.kind is {' or '.join(owners)}"] if owners else []),
    ]


def row(key: Key, paths: list[str]) -> list[str]:
    more = f" and {len(paths) - 1} more" if len(paths) > 1 else ""
    return [paths[0] + more, key.default, f"{key.meaning}{unit_of(key)}"]


def answer(key: Key, paths: list[str]) -> dict[str, Any]:
    return {
        "key": paths[0],
        "keys": paths,
        "meaning": key.meaning,
        "takes": key.takes,
        "unit": key.unit,
        "default": key.default,
        "range": key.range,
        "example": key.example,
    }
