"""Every key that a scene may have, with its unit, default, range and meaning, read from the schema of a scene.

Paths are written as in `--set`, with the kind of a part after its slot: `basin.depth`, `wind.stress.u10`,
`motion.every`; `[]` stands for the entries of a list and `NAME` for a name that the user gives.
"""

from collections.abc import Iterator
from functools import cache
from typing import Any, NamedTuple

from ocean_sim.files.yaml_file import in_yaml
from ocean_sim.parts import KEYS_BESIDE_SLOTS, SEVERAL, SLOTS, KindConfig, config_of, kinds, slot_of
from ocean_sim.reading.schema import scene_schema
from ocean_sim.reading.sentences import opening_sentence
from ocean_sim.reading.translation import union_members

NAME_STEP, LIST_STEP = "NAME", "[]"
TYPE_WORDS = {
    "number": "number",
    "integer": "whole number",
    "boolean": "true or false",
    "string": "text",
    "null": "null",
    "object": "mapping",
    "array": "list",
}
PLAIN_TYPES = ("number", "integer", "boolean", "string")
BOUND_SIGNS = {"exclusiveMinimum": ">", "minimum": ">=", "exclusiveMaximum": "<", "maximum": "<="}
EXAMPLE_VALUES = {  # of keys by their names, where no default is one; of any other text the name itself
    "particles": "6000",
    "waves": "{height: 1.0, period: 6.0}",
    "wavemaker": "{height: 0.1, period: 2.0}",
    "spectra": "[{height: 1.0, period: 6.0}]",
    "helm": "{speed: 3.0, heading_deg: 90.0}",
    "inertia": "[1.0e+6, 1.0e+6, 1.0e+5]",
    "title": "A trial",
    "file": "rows.csv",
    "path": "particles.csv",
    "components": "waves.csv",
    "point": "helm",
    "ship": "tug",
    "from": "bow",
    "key": "secret.key",
    "radiation": "radiation.csv",
    "period": "2.0",
    "peak_period": "6.0",
}
EXAMPLE_ENTRIES = {"min": "-1.0", "max": "1.0", "half_size": "1.0", "size": "1.0"}  # in a list, by the name of its key
EXAMPLE_SIZES = {"m": "1.0", "s": "0.1", "deg": "30.0", "1": "0.5"}  # an example of a number, by its unit


class Key(NamedTuple):
    """One key that a scene may have: path, values, unit, default, bounds, meaning, example; for docs and `explain`."""

    path: str
    takes: str  # a description of the values that may be written
    unit: str  # unit as in `m/s`; empty for a key that is no quantity, `1` for a number without one
    default: str  # default as YAML; `required` where there is none
    range: str  # bounds as in `> 0`
    meaning: str
    example: str  # a setting as `--set` takes it, without the kind
    choices: tuple[str, ...]  # the words that may be written, where there are only so many
    is_plain: bool  # True if a number, a word or a switch may be written

    @property
    def section(self) -> str:
        """Table of the reference that lists the key: `basin`, `wind.stress`, `motion`."""
        words = self.path.split(".")
        kind = len(words) > 1 and words[0] in SLOTS and words[1] in kinds(words[0])
        return ".".join(words[: 2 if kind else 1])


@cache
def whole_schema() -> dict[str, Any]:
    return scene_schema()


@cache
def scene_keys() -> tuple[Key, ...]:
    """All keys of all parts and kinds, in the order of the schema."""
    found: dict[str, Key] = {}
    for name, node in whole_schema()["properties"].items():
        if name in SLOTS:
            for kind in kinds(name):
                below = of_mapping(definition(f"{name}.{kind}"), f"{name}.{kind}", ())
                found |= {key.path: key for key in below if key.path not in found}
        elif name not in (SEVERAL, *KEYS_BESIDE_SLOTS):
            for key in of_value(name, node, name in whole_schema()["required"], ()):
                found.setdefault(key.path, key)
    return tuple(found.values())


def definition(name: str) -> dict[str, Any]:
    """Schema of a model in the scene's schema, by its name or its `$ref`."""
    return whole_schema()["$defs"][name.removeprefix("#/$defs/")]


def of_mapping(node: dict[str, Any], path: str, within: tuple[str, ...]) -> Iterator[Key]:
    """Yield the keys of the model at a path, of schema `node`, and of models in it; `within`: models entered so far."""
    for name, inner in node.get("properties", {}).items():
        if name == "kind" and "const" in inner:
            continue
        yield from of_value(f"{path}.{name}", inner, name in node.get("required", ()), within)


def of_value(path: str, node: dict[str, Any], required: bool, within: tuple[str, ...]) -> Iterator[Key]:
    """Yield the key at a path, whose value has the schema `node`, and the keys inside its value."""
    yield key_of_node(path, node, required)
    yield from keys_inside(path, node, within)


def keys_inside(path: str, node: dict[str, Any], within: tuple[str, ...]) -> Iterator[Key]:
    """Yield the keys inside the value at a path, of schema `node`; models in `within` are not entered again."""
    yield from kind_inside(path, node)
    for member in union_members(node):
        name = member.get("$ref")
        if name is not None and name not in within:
            target = definition(name)
            yield from of_mapping(target, path, (*within, name))
            if "properties" not in target:
                yield from keys_inside(path, target, (*within, name))
        elif member.get("type") == "array" and isinstance(member.get("items"), dict):
            yield from keys_inside(path + LIST_STEP, member["items"], within)
        elif "patternProperties" in member:
            yield from keys_inside(f"{path}.{NAME_STEP}", of_names(member), within)


def of_names(node: dict[str, Any]) -> dict[str, Any]:
    """Schema of the values of a mapping whose keys are names that the user gives; `node`: schema of the mapping."""
    return next(iter(node["patternProperties"].values()))


def kind_inside(path: str, node: dict[str, Any]) -> Iterator[Key]:
    """Yield the key `kind` of a value that may be one of several models; nothing for other values."""
    mappings = [definition(member["$ref"]) for member in union_members(node) if "$ref" in member]
    kinds_of = [(m.get("properties", {}).get("kind", {}), m) for m in mappings]
    chosen = {kind["const"]: m for kind, m in kinds_of if "const" in kind}
    if not chosen:
        return
    told = [
        f"`{kind}`: {opening_sentence(said).rstrip('.')}."
        for kind, m in chosen.items()
        if (said := m.get("description"))
    ]
    words, meaning = tuple(chosen), " ".join(told) or "Which of them it is."
    takes, needed = ", ".join(f"`{word}`" for word in words), f"{example_path(path)}.kind={words[0]}"
    yield Key(f"{path}.kind", takes, "", "required", "", meaning, needed, words, is_plain=True)


def key_of_node(path: str, node: dict[str, Any], required: bool) -> Key:
    """The key at a path, with all facts from the schema `node` of its value."""
    default = "required" if required else in_yaml(node["default"]) if "default" in node else ""
    said = (definition(member["$ref"]).get("description", "") for member in union_members(node) if "$ref" in member)
    meaning = " ".join((node.get("meaning") or node.get("description") or next(said, "")).split())
    takes = " or ".join(dict.fromkeys(kind_of(member) for member in union_members(node)))
    bounds = dict.fromkeys(bound for member in union_members(node) for bound in bounds_of(member))
    choices = tuple(dict.fromkeys(word for member in union_members(node) for word in words_of(member)))
    example = f"{example_path(path)}={value_of(path, node)}"
    return Key(
        *(path, takes, node.get("unit", ""), default, ", ".join(bounds), meaning, example, choices),
        is_plain=bool(choices) or any(member.get("type") in PLAIN_TYPES for member in union_members(node)),
    )


def bounds_of(node: dict[str, Any]) -> Iterator[str]:
    """Yield the bounds of a number, or of the numbers in a list, by its schema, as text: `> 0`."""
    yield from (f"{sign} {node[name]:g}" for name, sign in BOUND_SIGNS.items() if name in node)
    if isinstance(node.get("items"), dict):
        yield from bounds_of(node["items"])


def kind_of(node: dict[str, Any]) -> str:
    """The type of a value by its schema, in words: `number`, `list of 3 numbers`, `mapping`."""
    if "$ref" in node:
        target = definition(node["$ref"])
        return "mapping" if "properties" in target else kind_of(next(union_members(target)))
    if "const" in node:
        return f"`{node['const']}`"
    if "enum" in node:
        return ", ".join(f"`{word}`" for word in node["enum"])
    if "prefixItems" in node:
        return f"list of {len(node['prefixItems'])} numbers"
    if node.get("type") == "array" and isinstance(node.get("items"), dict):
        inner = " or ".join(dict.fromkeys(kind_of(member) for member in union_members(node["items"])))
        return f"list of {inner}"
    if "patternProperties" in node:
        return "mapping of names"
    return TYPE_WORDS.get(str(node.get("type", "")), "anything")


def words_of(node: dict[str, Any]) -> list[str]:
    """Words that a value may be by its schema, `true` and `false` for a switch; empty where any are allowed."""
    given = [node["const"]] if "const" in node else node.get("enum", [])
    return ["true", "false"] if node.get("type") == "boolean" else [str(word) for word in given]


def example_path(path: str) -> str:
    """Path of a key as written after `--set`: without the kind of the part, and with 0 for the entry of a list."""
    words = path.split(".")
    if words[0] in SLOTS:
        words = [words[0], *words[2:]]
    return ".".join(words).replace(LIST_STEP, ".0").replace(NAME_STEP, "name")


def value_of(path: str, node: dict[str, Any]) -> str:
    """An example value for the key at a path, as YAML: that stated by the Config of its kind, or else by its schema."""
    words = path.split(".")
    if len(words) == 3 and words[0] in SLOTS:
        given: type[KindConfig] = config_of(slot_of(words[0]), words[1])
        if words[2] in given.example:
            return in_yaml(given.example[words[2]])
    return value_within(node, words[-1], ())


def value_within(node: dict[str, Any], name: str, within: tuple[str, ...]) -> str:
    """An example value for key `name` by its schema `node`, as YAML: default, stated example, or one of its type."""
    default = node.get("default")
    if default not in (None, [], {}, ""):
        return in_yaml(default)
    if name in EXAMPLE_VALUES:
        return EXAMPLE_VALUES[name]
    member = next((m for m in union_members(node) if m.get("type") != "null" and m.get("$ref") not in within), node)
    if "$ref" in member:
        return value_within(definition(member["$ref"]), name, (*within, member["$ref"]))
    if "const" in member or "enum" in member:
        return in_yaml(member["const"] if "const" in member else member["enum"][0])
    if "prefixItems" in member:
        return f"[{', '.join([EXAMPLE_ENTRIES.get(name, '0.0')] * len(member['prefixItems']))}]"
    if member.get("type") in ("number", "integer"):
        return example_number(node, member)
    if member.get("type") == "array":
        entry = EXAMPLE_ENTRIES.get(name) or value_within(member["items"], name, within)
        return f"[{', '.join([entry] * max(1, member.get('minItems', 1)))}]"
    if "properties" in member:
        return example_mapping(member, within)
    if "patternProperties" in member:
        return f"{{name: {value_within(of_names(member), name, within)}}}"
    return {"boolean": "true", "string": name}.get(str(member.get("type")), "null")


def example_mapping(node: dict[str, Any], within: tuple[str, ...]) -> str:
    """An example of a model as YAML: kind and required keys; if there are none, one number or the first key."""
    own, needed = node["properties"], node.get("required", [])
    names = [name for name in own if name in needed or (name == "kind" and "const" in own[name])]
    if names in ([], ["kind"]):
        numbers = [name for name in own if any(m.get("type") == "number" for m in union_members(own[name]))]
        names += [name for name in numbers or own if name != "kind"][:1]
    return f"{{{', '.join(f'{name}: {value_within(own[name], name, within)}' for name in names)}}}"


def example_number(node: dict[str, Any], member: dict[str, Any]) -> str:
    """An example number within the bounds of the schema `node`, of a size usual for its unit; `member`: its type."""
    low, high = bound_of(node, "minimum", "exclusiveMinimum"), bound_of(node, "maximum", "exclusiveMaximum")
    if member["type"] == "integer":
        return str(int(low or 0) + 1)
    usual = EXAMPLE_SIZES.get(node.get("unit", ""), "1.0")
    if low is not None and float(usual) <= low:
        return f"{low + 1.0 if high is None else 0.5 * (low + high):g}"
    return usual if high is None or float(usual) < high else f"{0.5 * ((low or 0.0) + high):g}"


def bound_of(node: dict[str, Any], *names: str) -> float | None:
    """First of these bounds (`minimum`, ...) that a schema, or a member of its union, states; None without any."""
    return next((place[name] for place in (node, *union_members(node)) for name in names if name in place), None)


@cache
def by_path() -> dict[str, Key]:
    return {key.path: key for key in scene_keys()}


def keys_at(word: str) -> list[Key]:
    """The key at a path, then those directly below it; a path without the kind stands for every kind."""
    wanted = word.replace("[]", "").strip(".").split(".")
    steps = [step for step in wanted if not step.isdigit()]
    exact, below = [], []
    for key in scene_keys():
        path = key.path.replace(LIST_STEP, "").split(".")
        forms = [path] + ([[path[0], *path[2:]]] if path[0] in SLOTS else [])
        if path[0] == "ship":
            forms += [[SEVERAL, NAME_STEP, *form[1:]] for form in forms]
        forms += [path[2:] for name, slot in KEYS_BESIDE_SLOTS.items() if path[0] == slot and path[2:3] == [name]]
        if any(is_path_match(form, steps) for form in forms):
            exact.append(key)
        elif any(len(form) == len(steps) + 1 and is_path_match(form[:-1], steps) for form in forms):
            below.append(key)
    return exact + below


def is_path_match(path: list[str], steps: list[str]) -> bool:
    """True if a key's path equals the steps that a user wrote; NAME in the path matches any step."""
    return len(path) == len(steps) and all(p in (s, NAME_STEP) for p, s in zip(path, steps, strict=True))


def named_so(word: str) -> list[str]:
    """Paths of all keys whose last word is `word`."""
    return [key.path for key in scene_keys() if key.path.rpartition(".")[2] == word]


def keys_elsewhere(word: str) -> str:
    """End of an error message that lists up to three paths of keys called `word`; empty if there are none."""
    paths = sorted(named_so(word), key=lambda path: (path.count("."), path))
    if len(paths) == 1:
        return f"; there is {paths[0]}"
    more = f" and {len(paths) - 3} more" if len(paths) > 3 else ""
    return f"; there are {', '.join(paths[:3])}{more}" if paths else ""
