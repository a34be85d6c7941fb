"""Answers to a page: the plain keys of a scene and what they hold, and what the water does at points.

Of keys unit, range and meaning are those of the reference. Water that is no more than its plane waves answers for any
time, and so does a square that repeats itself, which is always of plane waves. Other water, particles or a sea with
wakes and breakers, answers for now, as its gauges read it.
"""

from typing import Any

import numpy as np
from pydantic import BaseModel

from ocean_sim.conventions import Refused
from ocean_sim.fluid import Fluid
from ocean_sim.parts import KindConfig, slot_of
from ocean_sim.reading.keys import Key, by_path
from ocean_sim.reading.scene import SceneConfig
from ocean_sim.viewer.protocol import Waves
from ocean_sim.waves.exchange import WaveField

HEADING = ("seed", "duration")
APART = 0.5  # spacings of the water, over which a slope is taken on either side


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


def answer(fluid: Fluid, now: float, asked: Waves) -> dict[str, Any]:
    """What is told of the waves: the time [s] it holds for, and `values`, a row a point, NaN where there is no water as
    null. Raises Refused."""
    time, sea = now if asked.time is None else asked.time, fluid.plane_waves
    if asked.verb == "field":
        if sea is None:
            raise Refused("this water is not a sum of plane waves: it has no square that repeats itself")
        return {"time": time, "values": plain(WaveField(sea).field(asked.cells, asked.side, time))}
    length = 3 if asked.verb == "velocity" else 2
    if any(len(point) != length for point in asked.points):
        raise Refused(f"{asked.verb} is asked at points of {'x, y, z' if length == 3 else 'x, z'} [m]")
    points = np.array(asked.points, dtype=float).reshape(-1, length)
    if sea is not None and fluid.in_closed_form is not None and not fluid.can_be_disturbed:
        whole = WaveField(sea)
        verbs = {"elevation": whole.elevation, "normal": whole.normal, "velocity": whole.velocity}
        return {"time": time, "values": plain(verbs[asked.verb](points, time))}
    if asked.time is not None:
        raise Refused(
            "this water is more than its plane waves: it is known only at the present time, leave the time out"
        )
    if asked.verb == "normal":
        return {"time": now, "values": plain(normals(fluid, points))}
    found = fluid.elevations(points) if asked.verb == "elevation" else fluid.velocities(points)
    return {"time": now, "values": plain(found)}


def normals(fluid: Fluid, points: np.ndarray) -> np.ndarray:
    """(n, 3) upward unit normals of the water's surface at points x, z (n, 2) [m], by differences."""
    step = APART * fluid.spacing
    slopes = [
        (fluid.elevations(points + step * along) - fluid.elevations(points - step * along)) / (2.0 * step)
        for along in np.eye(2)
    ]
    found = np.stack([-slopes[0], np.ones(len(points)), -slopes[1]], axis=1)
    return found / np.linalg.norm(found, axis=1, keepdims=True)


def plain(values: np.ndarray) -> list[Any]:
    """Numbers with six digits, as JSON has them."""
    rows = np.round(np.asarray(values, dtype=float), 6)
    whole = rows.astype(object)
    whole[~np.isfinite(rows)] = None
    return list(whole.tolist())
