"""The plain keys of a scene and what they hold, for the page; unit, range and meaning are those of the reference."""

from typing import Any

from pydantic import BaseModel

from ocean_sim.parts import KindConfig, slot_of
from ocean_sim.reading.keys import Key, by_path
from ocean_sim.reading.scene import SceneConfig

HEADING = ("seed", "duration")


def keys(scene: SceneConfig) -> list[dict[str, Any]]:
    """`key`, `value`, `unit`, `meaning`, `range` and `choices` of each number, word or switch that may be set, in the
    order of the scene's parts."""
    rows = [row(by_path()[name], name, getattr(scene, name)) for name in HEADING]
    for name, part in {"basin": scene.basin, **scene.parts(), "runtime": scene.runtime}.items():
        rows += inside(name, f"{slot_of(name)}.{part.kind}" if isinstance(part, KindConfig) else name, part)
    return rows


def inside(place: str, path: str, model: BaseModel) -> list[dict[str, Any]]:
    """The plain keys of a model, and of the models in it; `path`: where the reference has it."""
    rows: list[dict[str, Any]] = []
    for name in type(model).model_fields:
        value, known = getattr(model, name), by_path().get(f"{path}.{name}")
        if isinstance(value, BaseModel):
            rows += inside(f"{place}.{name}", f"{path}.{name}", value)
        elif name != "kind" and known is not None and known.is_plain and not isinstance(value, list | tuple | dict):
            rows.append(row(known, f"{place}.{name}", value))
    return rows


def row(known: Key, key: str, value: Any) -> dict[str, Any]:
    return {
        "key": key,
        "value": value,
        "unit": known.unit,
        "meaning": known.meaning,
        "range": known.range,
        "choices": list(known.choices),
    }
