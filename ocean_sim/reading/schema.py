"""The JSON Schema of a scene, made from the models of all kinds, for editors that complete and check as one types."""

import ast
import json
import sys
from functools import lru_cache
from importlib import import_module
from inspect import cleandoc, getsource
from itertools import pairwise
from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema

from ocean_sim import basin
from ocean_sim.files.yaml_file import Location, node_of
from ocean_sim.parts import ALONE, BESIDE, MEANT, SEVERAL, SLOTS, config_of, kinds, named
from ocean_sim.reading.composition import chosen, known
from ocean_sim.reading.heading import Heading
from ocean_sim.reading.sentences import opening, sentence
from ocean_sim.runtime import RuntimeConfig


def schema() -> dict[str, Any]:
    """JSON Schema, draft 2020-12; descriptions as editors show them, with unit and default."""
    definitions: dict[str, Any] = {}
    properties = dict(_properties(Heading, definitions))
    properties["basin"] = _model(basin.Config, definitions)
    properties |= {slot: _slot(slot, definitions) for slot in SLOTS}
    properties[SEVERAL] = {
        "description": "Several ships by name, in place of `ship`.",
        "anyOf": [{"type": "object", "additionalProperties": properties[ALONE]}, {"type": "null"}],
    }
    for key, slot in BESIDE.items():
        inner = definitions[_name(config_of(slot, MEANT[slot]))]["properties"][key]
        properties[key] = {"description": f"As `{slot}.{key}`.", "anyOf": [{"$ref": inner["$ref"]}, {"type": "null"}]}
    properties["runtime"] = _model(RuntimeConfig, definitions)
    for name in kinds("observers"):
        module = import_module(f"ocean_sim.observers.{name}")
        described = {"description": opening(module.__doc__ or "")}
        properties[name] = described | {"anyOf": [_model(module.Config, definitions), {"type": "null"}]}
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
            _explain(inner, definitions)
    return found


def text() -> str:
    """The schema as a file that editors read."""
    return json.dumps(schema(), indent=1, ensure_ascii=False) + "\n"


def _slot(slot: str, definitions: dict[str, Any]) -> dict[str, Any]:
    """A name, a mapping with `kind`, or null."""
    module = import_module(f"ocean_sim.{slot}")
    words = known(slot)
    told = [sentence(slot, word) for word in words]
    choices: list[dict[str, Any]] = [{"enum": words, "markdownEnumDescriptions": told}] if words else []
    for kind in kinds(slot):
        choices.append(_model(config_of(slot, kind), definitions, None if MEANT.get(slot) == kind else kind))
    presets = sorted(set(named(slot)) - set(kinds(slot)))
    choices += [_preset(slot, name, definitions) for name in presets]
    return {"description": (module.__doc__ or "").split(":")[0], "anyOf": [*choices, {"type": "null"}]}


def _preset(slot: str, name: str, definitions: dict[str, Any]) -> dict[str, Any]:
    """A preset with some keys of its own: those of its kind, none of them required."""
    kind = chosen(slot, node_of(name, Location(name))).kind
    own = definitions[_name(config_of(slot, kind))]
    properties = own["properties"] | {"kind": {"const": name, "description": sentence(slot, name)}}
    return {
        "type": "object",
        "description": sentence(slot, name),
        "properties": properties,
        "required": ["kind"],
        "additionalProperties": False,
    }


def _explain(node: dict[str, Any], definitions: dict[str, Any]) -> None:
    """Append unit and default to a description, which is what editors show; `meaning` keeps it without."""
    if "meaning" in node or "const" in node:
        return
    union = node.get("anyOf", node.get("oneOf", [node]))
    names = [member["$ref"].removeprefix("#/$defs/") for member in union if "$ref" in member]
    of_model = next((definitions[name].get("description", "") for name in names), "")
    meaning = node.get("description") or of_model
    if not meaning:
        return
    unit, default = node.get("unit", ""), node.get("default")
    more = f" [{unit}]" if unit not in ("", "1") else ""
    more += f" Default: {json.dumps(default)}." if default not in (None, [], {}, "") else ""
    node |= {"meaning": meaning, "description": f"{meaning}{more}"}


def _properties(model: type[BaseModel], definitions: dict[str, Any]) -> dict[str, Any]:
    return _generated(model, definitions)["properties"]


def _model(model: type[BaseModel], definitions: dict[str, Any], kind: str | None = None) -> dict[str, Any]:
    """A reference to a model's own definition; of a slot's kinds `kind` must be written."""
    generated = _generated(model, definitions)
    if kind is not None:
        generated["required"] = ["kind", *generated.get("required", [])]
    name = _name(model)
    definitions[name] = generated
    return {"$ref": f"#/$defs/{name}"}


def _generated(model: type[BaseModel], definitions: dict[str, Any]) -> dict[str, Any]:
    """The schema of a model; the models inside it become definitions that carry its name too, so that none collide."""
    generated = model.model_json_schema(schema_generator=_Generator, ref_template=f"#/$defs/{_name(model)}.{{model}}")
    for inner, definition in generated.pop("$defs", {}).items():
        definitions[f"{_name(model)}.{inner}"] = definition
    generated.pop("title", None)
    return generated


def _name(model: type[BaseModel]) -> str:
    return f"{model.__module__.removeprefix('ocean_sim.')}.{model.__qualname__}".removesuffix(".Config")


class _Generator(GenerateJsonSchema):
    """Without the titles that pydantic makes of names, and with the docstrings of keys. A model does not read them as
    it is made, as pydantic would: that took a tenth of the time to a first step."""

    def field_title_should_be_set(self, schema: Any) -> bool:
        return False

    def model_schema(self, schema: Any) -> dict[str, Any]:
        made, model = super().model_schema(schema), schema["cls"]
        docstrings = _docstrings(model)
        for key, field in model.model_fields.items():
            if key in docstrings:
                made["properties"][field.alias or key]["description"] = docstrings[key]
        return made


def _docstrings(model: type[BaseModel]) -> dict[str, str]:
    """What stands under each key of a model, or of the one that it has the key from."""
    found: dict[str, str] = {}
    for kind in reversed(model.__mro__[: model.__mro__.index(BaseModel)]):
        under = _under(kind)
        found = {key: text for key, text in found.items() if key not in vars(kind).get("__annotations__", {})} | under
    return found


def _under(kind: type) -> dict[str, str]:
    """The docstring under each annotated name in the body of a class."""
    body: list[ast.stmt] = _module(kind.__module__).body
    for name in kind.__qualname__.split("."):
        body = next(node.body for node in body if isinstance(node, ast.ClassDef) and node.name == name)
    found = {}
    for node, after in pairwise(body):
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name) and isinstance(after, ast.Expr):
            if isinstance(after.value, ast.Constant) and isinstance(after.value.value, str):
                found[node.target.id] = cleandoc(after.value.value)
    return found


@lru_cache
def _module(name: str) -> ast.Module:
    return ast.parse(getsource(sys.modules[name]))
