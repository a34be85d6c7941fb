"""The JSON Schema of a scene, made from the models of all kinds, for editors that complete and check as one types."""

import json
from importlib import import_module
from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema

from ocean_sim import basin
from ocean_sim.parts import ALONE, SEVERAL, SLOTS, config_of, kinds, named
from ocean_sim.reading.composition import known
from ocean_sim.reading.scene import Heading, observer_names
from ocean_sim.runtime import RuntimeConfig


def schema() -> dict[str, Any]:
    """JSON Schema, draft 2020-12."""
    definitions: dict[str, Any] = {}
    properties = dict(_properties(Heading, definitions))
    properties["basin"] = _model(basin.Config, definitions)
    properties |= {slot: _slot(slot, definitions) for slot in SLOTS}
    properties[SEVERAL] = {
        "description": "Several ships by name, in place of `ship`.",
        "anyOf": [{"type": "object", "additionalProperties": properties[ALONE]}, {"type": "null"}],
    }
    properties["runtime"] = _model(RuntimeConfig, definitions)
    for name in observer_names():
        module = import_module(f"ocean_sim.observers.{name}")
        described = {"description": (module.__doc__ or "").split("\n")[0]}
        properties[name] = described | {"anyOf": [_model(module.Config, definitions), {"type": "null"}]}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Ocean Sim scene",
        "description": "SI units and radians unless a key says otherwise.",
        "type": "object",
        "properties": properties,
        "required": ["basin", "fluid"],
        "additionalProperties": False,
        "$defs": dict(sorted(definitions.items())),
    }


def text() -> str:
    """The schema as a file that editors read."""
    return json.dumps(schema(), indent=1, ensure_ascii=False) + "\n"


def _slot(slot: str, definitions: dict[str, Any]) -> dict[str, Any]:
    """A name, a mapping with `kind`, or null."""
    module = import_module(f"ocean_sim.{slot}")
    choices: list[dict[str, Any]] = [{"enum": known(slot)}] if known(slot) else []
    choices += [_model(config_of(slot, kind), definitions, kind) for kind in kinds(slot)]
    ready_made = sorted(set(named(slot)) - set(kinds(slot)))
    if ready_made:
        kind_is = {"properties": {"kind": {"enum": ready_made}}, "required": ["kind"]}
        choices.append({"type": "object", "description": "A ready-made part with some keys of its own.", **kind_is})
    return {"description": (module.__doc__ or "").split(":")[0], "anyOf": [*choices, {"type": "null"}]}


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
    """Without the titles that pydantic makes of names."""

    def field_title_should_be_set(self, schema: Any) -> bool:
        return False
