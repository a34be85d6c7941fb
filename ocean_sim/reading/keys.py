"""Every key that a scene may have, with its unit, default, range and meaning, read from the JSON Schema of a scene.

The schema is generated from the Configs of all kinds; editors complete and check files by it. Paths of keys are written
as in `--set`, with the kind of a part after its slot: `basin.depth`, `wind.stress.u10`, `motion.every`; `[]` stands for
the entries of a list and `NAME` for a name that the user gives.
"""

import ast
import json
import sys
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from inspect import cleandoc, getsource
from itertools import pairwise
from typing import Any, NamedTuple

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema, models_json_schema

from ocean_sim import basin
from ocean_sim.files.yaml_file import in_yaml
from ocean_sim.model import in_brackets
from ocean_sim.parts import ALONE, KEYS_BESIDE_SLOTS, MEANT, SEVERAL, SLOTS, config_of, kinds, named
from ocean_sim.reading import Heading
from ocean_sim.reading.composition import kind_named, known_names
from ocean_sim.reading.sentences import opening_sentence, part_sentence
from ocean_sim.reading.translation import VALUE_TYPES, data_table, union_members
from ocean_sim.runtime import RuntimeConfig

NAME_STEP, LIST_STEP = "NAME", "[]"
PLAIN_TYPES = ("number", "integer", "boolean", "string")
BOUND_SIGNS = {"exclusiveMinimum": ">", "minimum": ">=", "exclusiveMaximum": "<", "maximum": "<="}


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
        """Name of the table, in the reference of keys, that lists this key: `basin`, `wind.stress`, `motion`."""
        words = self.path.split(".")
        kind = len(words) > 1 and words[0] in SLOTS and words[1] in kinds(words[0])
        return ".".join(words[: 2 if kind else 1])


@cache
def by_path() -> dict[str, Key]:
    """All keys of a scene by path, as `wind.stress.u10` for the kind `stress` of `wind`, in the order of the schema."""
    whole, found = scene_schema(), dict[str, Key]()
    for name, node in whole["properties"].items():
        if name in SLOTS:
            for path in (f"{name}.{kind}" for kind in kinds(name)):
                found |= {key.path: key for key in model_keys(whole["$defs"][path], path)}
        elif name not in (SEVERAL, *KEYS_BESIDE_SLOTS):
            found[name] = key_of_node(name, node, name in whole["required"])
            for key in keys_inside(name, node):
                found.setdefault(key.path, key)
    return found


def scene_keys() -> tuple[Key, ...]:
    return tuple(by_path().values())


def members(node: dict[str, Any]) -> list[dict[str, Any]]:
    """Schemas of the members of a union `node`, or the schema itself if it is none; references are resolved."""
    return list(union_members(node, scene_schema()["$defs"]))


def model_keys(node: dict[str, Any], path: str) -> Iterator[Key]:
    """Yield the keys of a model with schema `node`, found at `path`, each followed by the keys inside its value."""
    for name, inner in node["properties"].items():
        if name != "kind" or "const" not in inner:
            yield key_of_node(f"{path}.{name}", inner, name in node.get("required", ()))
            yield from keys_inside(f"{path}.{name}", inner)


def keys_inside(path: str, node: dict[str, Any]) -> Iterator[Key]:
    """Yield the keys inside the value at a path, by its schema `node`; for a union first `kind`, then each model's."""
    mappings = [member for member in members(node) if "properties" in member]
    if chosen := {kind["const"]: m for m in mappings if "const" in (kind := m["properties"].get("kind", {}))}:
        told = [f"`{kind}`: {opening_sentence(m['description']).rstrip('.')}." for kind, m in chosen.items()]
        takes, example = ", ".join(f"`{word}`" for word in chosen), f"{example_path(path)}.kind={next(iter(chosen))}"
        yield Key(f"{path}.kind", takes, "", "required", "", " ".join(told), example, tuple(chosen), is_plain=True)
    for member in members(node):
        if "properties" in member:
            yield from model_keys(member, path)
        elif "patternProperties" in member:
            yield from keys_inside(f"{path}.{NAME_STEP}", named_value_schema(member))
        elif isinstance(member.get("items"), dict):
            yield from keys_inside(path + LIST_STEP, member["items"])


def named_value_schema(node: dict[str, Any]) -> dict[str, Any]:
    """Schema of the values in a mapping with names that the user chooses; `node`: schema of the mapping."""
    return next(iter(node["patternProperties"].values()))


def key_of_node(path: str, node: dict[str, Any], required: bool) -> Key:
    """The key at a path, with all facts from the schema `node` of its value; `required`: it has no default."""
    default = "required" if required else in_yaml(node["default"]) if "default" in node else ""
    union, meaning = members(node), " ".join((node.get("meaning") or node.get("description", "")).split())
    takes = " or ".join(dict.fromkeys(map(kind_of, union)))
    bounds = ", ".join(dict.fromkeys(bound for member in union for bound in bounds_of(member)))
    choices = tuple(dict.fromkeys(word for member in union for word in words_of(member)))
    is_plain = bool(choices) or any(member.get("type") in PLAIN_TYPES for member in union)
    example = f"{example_path(path)}={value_of(path, node)}"
    return Key(path, takes, node.get("unit", ""), default, bounds, meaning, example, choices, is_plain)


def bounds_of(node: dict[str, Any]) -> Iterator[str]:
    """Yield the bounds of a number, or of the numbers in a list, by its schema `node`, as text: `> 0`."""
    found = ((sign, node[name]) for name, sign in BOUND_SIGNS.items() if name in node)
    yield from (f"{sign} {bound if isinstance(bound, int) else format(bound, 'g')}" for sign, bound in found)
    if isinstance(node.get("items"), dict):
        yield from bounds_of(node["items"])


def kind_of(node: dict[str, Any]) -> str:
    """The type of a value by its schema `node`, in words: `number`, `list of 3 numbers`, `mapping`."""
    if node.get("type") != "boolean" and (words := words_of(node)):
        return ", ".join(f"`{word}`" for word in words)
    if "prefixItems" in node:
        return f"list of {len(node['prefixItems'])} numbers"
    if isinstance(node.get("items"), dict):
        return f"list of {' or '.join(dict.fromkeys(map(kind_of, members(node['items']))))}"
    if "patternProperties" in node:
        return "mapping of names"
    return VALUE_TYPES[node["type"]][0].removeprefix("a ") if "type" in node else "anything"


def words_of(node: dict[str, Any]) -> list[str]:
    """Words that a value may be by its schema `node`, `true` and `false` for a switch; empty where any are allowed."""
    given = [node["const"]] if "const" in node else node.get("enum", [])
    return ["true", "false"] if node.get("type") == "boolean" else [str(word) for word in given]


def example_path(path: str) -> str:
    """Path of a key as written after `--set`: without the kind of the part, and with 0 for the entry of a list."""
    words = path.split(".")
    if words[0] in SLOTS:
        words = [words[0], *words[2:]]
    return ".".join(words).replace(LIST_STEP, ".0").replace(NAME_STEP, "name")


def value_of(path: str, node: dict[str, Any]) -> str:
    """An example value for the key at a path, as YAML: stated by the Config of its kind, or by its schema `node`."""
    words = path.split(".")
    stated = config_of(words[0], words[1]).example if len(words) == 3 and words[0] in SLOTS else {}
    return in_yaml(stated[words[2]]) if words[-1] in stated else value_within(node, words[-1])


def value_within(node: dict[str, Any], name: str) -> str:
    """An example value for key `name` by its schema `node`, as YAML: default, stated example, or any of its type."""
    default = node.get("default")
    if default not in (None, [], {}, ""):
        return in_yaml(default)
    if name in data_table("examples")["values"]:
        return data_table("examples")["values"][name]
    member = next((member for member in members(node) if member.get("type") != "null"), node)
    if words := words_of(member):
        return words[0]
    if "properties" in member:
        return example_mapping(member)
    if "patternProperties" in member:
        return f"{{name: {value_within(named_value_schema(member), name)}}}"
    entry = data_table("examples")["entries"].get(name)
    if "prefixItems" in member:
        return f"[{', '.join([entry or '0.0'] * len(member['prefixItems']))}]"
    if "items" in member:
        return f"[{', '.join([entry or value_within(member['items'], name)] * max(1, member.get('minItems', 1)))}]"
    if member.get("type") in ("number", "integer"):
        return example_number(node, member)
    return name if member.get("type") == "string" else "null"


def example_mapping(node: dict[str, Any]) -> str:
    """Example of a model, schema `node`, as YAML: kind and required keys, or else one number or the first key."""
    own, needed = node["properties"], node.get("required", [])
    names = [name for name in own if name in needed or (name == "kind" and "const" in own[name])]
    if names in ([], ["kind"]):
        numbers = [name for name in own if any(member.get("type") == "number" for member in members(own[name]))]
        names += [name for name in numbers or own if name != "kind"][:1]
    return f"{{{', '.join(f'{name}: {value_within(own[name], name)}' for name in names)}}}"


def example_number(node: dict[str, Any], member: dict[str, Any]) -> str:
    """An example number within the bounds of the schema `node`, of a size usual for its unit; `member`: its type."""
    low, high = bound_of(node, "minimum", "exclusiveMinimum"), bound_of(node, "maximum", "exclusiveMaximum")
    if member["type"] == "integer":
        return str(int(low or 0) + 1)
    usual = data_table("examples")["sizes"].get(node.get("unit", ""), "1.0")
    if low is not None and float(usual) <= low:
        return f"{low + 1.0 if high is None else 0.5 * (low + high):g}"
    return usual if high is None or float(usual) < high else f"{0.5 * ((low or 0.0) + high):g}"


def bound_of(node: dict[str, Any], *names: str) -> float | None:
    """First of the bounds `names` (as `minimum`) that the schema `node`, or a member of its union, states; or None."""
    return next((place[name] for place in (node, *members(node)) for name in names if name in place), None)


def keys_at(word: str) -> list[Key]:
    """The key at the path `word`, then those directly below; `wind.u10`, without a kind, matches that of every kind."""
    steps = [step for step in word.replace("[]", "").strip(".").split(".") if not step.isdigit()]
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
    """Paths of all keys, of any part of a scene, whose last element is `word`."""
    return [key.path for key in scene_keys() if key.path.rpartition(".")[2] == word]


def keys_elsewhere(word: str) -> str:
    """End of an error message that lists up to three paths of keys called `word`; empty if there are none."""
    paths = sorted(named_so(word), key=lambda path: (path.count("."), path))
    if len(paths) == 1:
        return f"; there is {paths[0]}"
    more = f" and {len(paths) - 3} more" if len(paths) > 3 else ""
    return f"; there are {', '.join(paths[:3])}{more}" if paths else ""


@cache
def scene_schema() -> dict[str, Any]:
    """The JSON Schema of a scene (draft 2020-12); descriptions contain unit and default, for editors."""
    observers = {name: import_module(f"ocean_sim.observers.{name}") for name in kinds("observers")}
    models = [Heading, basin.Config, RuntimeConfig, *(module.Config for module in observers.values())]
    models += [config_of(slot, kind) for slot in SLOTS for kind in kinds(slot)]
    references, whole = models_json_schema([(model, "validation") for model in models], schema_generator=_Generator)
    definitions = whole["$defs"]
    properties = definitions.pop(Heading.__name__)["properties"]
    properties["basin"] = references[basin.Config, "validation"]
    properties |= {slot: _slot_schema(slot, definitions) for slot in SLOTS}
    properties[SEVERAL] = {
        "description": "Several ships by name, in place of `ship`.",
        "anyOf": [{"type": "object", "additionalProperties": properties[ALONE]}, {"type": "null"}],
    }
    for key, slot in KEYS_BESIDE_SLOTS.items():
        inner = definitions[f"{slot}.{MEANT[slot]}"]["properties"][key]
        properties[key] = {"description": f"As `{slot}.{key}`.", "anyOf": [{"$ref": inner["$ref"]}, {"type": "null"}]}
    properties["runtime"] = references[RuntimeConfig, "validation"]
    for name, module in observers.items():
        choices = [references[module.Config, "validation"], {"type": "null"}]
        properties[name] = {"description": opening_sentence(module.__doc__ or ""), "anyOf": choices}
    found = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Ocean Sim scene",
        "description": "SI units and radians unless a key says otherwise.",
        "type": "object",
        "properties": properties,
        "required": ["basin", "fluid"],
        "additionalProperties": False,
        "$defs": dict(sorted(definitions.items())),
    }
    for node in (found, *definitions.values()):
        for inner in node.get("properties", {}).values():
            _add_explanation(inner, definitions)
    return found


def schema_text() -> str:
    return json.dumps(scene_schema(), indent=1, ensure_ascii=False) + "\n"


def _slot_schema(slot: str, definitions: dict[str, Any]) -> dict[str, Any]:
    """Schema of a slot, as `wind`: a kind or preset by name, or a mapping, or null; `definitions`: all Configs."""
    module = import_module(f"ocean_sim.{slot}")
    words = known_names(slot)
    told = [part_sentence(slot, word) for word in words]
    choices: list[dict[str, Any]] = [{"enum": words, "markdownEnumDescriptions": told}]
    for kind in kinds(slot):
        choices.append({"$ref": f"#/$defs/{slot}.{kind}"})
        if MEANT.get(slot) != kind:
            definition = definitions[f"{slot}.{kind}"]
            definition["required"] = ["kind", *definition.get("required", [])]
    choices += [_preset_schema(slot, name, definitions) for name in sorted(set(named(slot)) - set(kinds(slot)))]
    return {"description": (module.__doc__ or "").split(":")[0], "anyOf": [*choices, {"type": "null"}]}


def _preset_schema(slot: str, name: str, definitions: dict[str, Any]) -> dict[str, Any]:
    """Schema of a part in a slot (as `wind`) whose `kind` is the preset `name` (as `gale`): keys of the kind on which
    this is based, none of them required. `definitions`: schemas of all Configs by name."""
    name_only = {"const": name, "description": part_sentence(slot, name)}
    properties = definitions[f"{slot}.{kind_named(slot, name)}"]["properties"] | {"kind": name_only}
    mapping = {"type": "object", "description": part_sentence(slot, name), "properties": properties}
    return mapping | {"required": ["kind"], "additionalProperties": False}


def _add_explanation(node: dict[str, Any], definitions: dict[str, Any]) -> None:
    """Append unit and default to the description in a key's schema `node`, and keep the description as `meaning`."""
    if "meaning" in node or "const" in node:
        return
    models = (member for member in union_members(node, definitions) if "properties" in member)
    meaning = node.get("description") or next(models, {}).get("description")
    if not meaning:
        return
    default = node.get("default")
    more = in_brackets(node.get("unit"))
    more += f" Default: {json.dumps(default)}." if default not in (None, [], {}, "") else ""
    node |= {"meaning": meaning, "description": f"{meaning}{more}"}


class _Generator(GenerateJsonSchema):
    """Schema generator that omits titles and describes keys by their docstrings, read only now to keep starts fast."""

    def field_title_should_be_set(self, schema: Any) -> bool:
        return False

    def normalize_name(self, name: str) -> str:
        """Name of a definition: `wind.stress` for the Config of a kind, else module and class."""
        return name.removeprefix("ocean_sim.").removesuffix(".Config")

    def model_schema(self, schema: Any) -> dict[str, Any]:
        """Schema of a model with the docstrings of its keys, and a title unless it is a part's Config."""
        made, model = super().model_schema(schema), schema["cls"]
        if model.__name__.endswith("Config"):
            del made["title"]
        docstrings = _docstrings(model)
        for key, field in model.model_fields.items():
            if docstrings.get(key):
                made["properties"][field.alias or key]["description"] = docstrings[key]
        return made


def _docstrings(model: type[BaseModel]) -> dict[str, str]:
    """Docstring of each key of a model, from the last class of its inheritance that declares the key."""
    found: dict[str, str] = {}
    for above in reversed(model.__mro__[: model.__mro__.index(BaseModel)]):
        body = next(node.body for node in _classes(above.__module__) if node.name == above.__name__)
        for node, after in pairwise([*body, None]):
            if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
                text = after.value if isinstance(after, ast.Expr) else None
                found[node.target.id] = cleandoc(str(text.value)) if isinstance(text, ast.Constant) else ""
    return found


@cache
def _classes(module: str) -> list[ast.ClassDef]:
    return [node for node in ast.parse(getsource(sys.modules[module])).body if isinstance(node, ast.ClassDef)]
