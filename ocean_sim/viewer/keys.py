"""Every key of a scene that holds a number, a word or a switch, with its unit and range, as its models know them."""

import types
from typing import Any, Literal, Union, cast, get_args, get_origin

from annotated_types import Ge, Gt, Le, Lt
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from ocean_sim.reading.scene import SceneConfig

PLAIN = (int, float, str, bool)


def keys(scene: SceneConfig) -> list[dict[str, Any]]:
    """`key`, `value`, `unit`, `what`, `type`, `low`, `high`, `choices` of each, in the order of the scene's parts."""
    found = of_model("", scene, ("seed", "duration"))
    found += of_model("basin", scene.basin)
    for name, part in scene.parts().items():
        found += of_model(name, part)
    return found + of_model("runtime", scene.runtime)


def of_model(place: str, model: BaseModel, only: tuple[str, ...] = ()) -> list[dict[str, Any]]:
    """The plain keys of a model, and of the models in it."""
    rows: list[dict[str, Any]] = []
    for name, field in type(model).model_fields.items():
        if only and name not in only:
            continue
        key, value = f"{place}.{name}".lstrip("."), getattr(model, name)
        if isinstance(value, BaseModel):
            rows += of_model(key, value)
        elif name != "kind" and (isinstance(value, PLAIN) or (value is None and holds_plain(field.annotation))):
            rows.append({"key": key, "value": value, **described(field)})
    return rows


def described(field: FieldInfo) -> dict[str, Any]:
    """Unit, meaning and range of a key."""
    extra = field.json_schema_extra
    row: dict[str, Any] = {"what": field.description or "", "type": kind_of(field.annotation)}
    row["unit"] = str(extra.get("unit", "")) if isinstance(extra, dict) else ""
    for bound in field.metadata:
        match bound:
            case Gt(gt=end) | Ge(ge=end):
                row |= {"low": cast(float, end), "low_open": isinstance(bound, Gt)}
            case Lt(lt=end) | Le(le=end):
                row |= {"high": cast(float, end), "high_open": isinstance(bound, Lt)}
    choices = words_of(field.annotation)
    return row | ({"choices": choices} if choices else {})


def members(annotation: Any) -> tuple[Any, ...]:
    """The types of a union, or the one there is."""
    return get_args(annotation) if get_origin(annotation) in (Union, types.UnionType) else (annotation,)


def holds_plain(annotation: Any) -> bool:
    """Whether a key that is null now may hold a plain value."""
    return any(part in PLAIN or get_origin(part) is Literal for part in members(annotation))


def words_of(annotation: Any) -> list[Any]:
    """The words that a key may be."""
    return [word for part in members(annotation) if get_origin(part) is Literal for word in get_args(part)]


def kind_of(annotation: Any) -> str:
    """`number`, `integer`, `switch` or `word`."""
    parts = members(annotation)
    if float in parts:
        return "number"
    if int in parts:
        return "integer"
    return "switch" if bool in parts else "word"
