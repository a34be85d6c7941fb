"""The JSON Schema of a scene, generated from the Configs of all kinds, by which editors complete and check files."""

import ast
import json
import sys
from functools import lru_cache
from importlib import import_module
from inspect import cleandoc, getsource
from itertools import pairwise
from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema, models_json_schema

from ocean_sim import basin
from ocean_sim.model import in_brackets
from ocean_sim.parts import ALONE, KEYS_BESIDE_SLOTS, MEANT, SEVERAL, SLOTS, config_of, kinds, named
from ocean_sim.reading import Heading
from ocean_sim.reading.composition import kind_named, known_names
from ocean_sim.reading.sentences import opening_sentence, part_sentence
from ocean_sim.reading.translation import union_members
from ocean_sim.runtime import RuntimeConfig


@lru_cache
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
    presets = sorted(set(named(slot)) - set(kinds(slot)))
    choices += [_preset_schema(slot, name, definitions) for name in presets]
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


@lru_cache
def _classes(module: str) -> list[ast.ClassDef]:
    return [node for node in ast.parse(getsource(sys.modules[module])).body if isinstance(node, ast.ClassDef)]
