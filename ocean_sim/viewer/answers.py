"""Replies to a page: the scalar keys of a scene with their values, and the water at points.

Water in closed form is known at any time by its plane waves, as heights over a periodic square are. Other water, of
particles or of a sea with wakes and breakers, is known at the present time only, as its gauges read it.
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

SHOWN_TRAITS = ("unit", "meaning", "range", "choices")  # of a key
SLOPE_STEP = 0.5  # [spacings] of the water, on either side of a point


def key_table(scene: SceneConfig) -> list[dict[str, Any]]:
    """Rows of `key`, `value`, `unit`, `meaning`, `range`, `choices` for all numbers, words and switches of a scene."""
    rows = [key_row(by_path()[name], name, getattr(scene, name)) for name in ("seed", "duration")]
    for name, part in {"basin": scene.basin, **scene.parts(), "runtime": scene.runtime}.items():
        rows += model_rows(name, f"{slot_of(name)}.{part.kind}" if isinstance(part, KindConfig) else name, part)
    return rows


def model_rows(place: str, path: str, model: BaseModel) -> list[dict[str, Any]]:
    """Rows of `key_table` for a model and its parts. `place`: scene key (`wind`); `path`: with kind (`wind.stress`)."""
    rows: list[dict[str, Any]] = []
    for name in type(model).model_fields:
        value, known = getattr(model, name), by_path().get(f"{path}.{name}")
        if isinstance(value, BaseModel):
            rows += model_rows(f"{place}.{name}", f"{path}.{name}", value)
        elif name != "kind" and known is not None and known.is_plain and not isinstance(value, list | tuple | dict):
            rows.append(key_row(known, f"{place}.{name}", value))
    return rows


def key_row(known: Key, key: str, value: Any) -> dict[str, Any]:
    """Row of `key_table` for one key, `known` from the key list, with its value in the scene."""
    return {"key": key, "value": value} | {name: getattr(known, name) for name in SHOWN_TRAITS}


def answer_waves(fluid: Fluid, now: float, asked: Waves) -> dict[str, Any]:
    """Reply to a wave query at time `now` [s]: `time` [s], and `values` per point, null where dry. Raises Refused."""
    time, sea = now if asked.time is None else asked.time, fluid.plane_waves
    if asked.verb == "field":
        if sea is None:
            raise Refused("this water is not a sum of plane waves: it has no square that repeats itself")
        return {"time": time, "values": json_numbers(WaveField(sea).field(asked.cells, asked.side, time))}
    length = 3 if asked.verb == "velocity" else 2
    if any(len(point) != length for point in asked.points):
        raise Refused(f"{asked.verb} is asked at points of {'x, y, z' if length == 3 else 'x, z'} [m]")
    points = np.array(asked.points, dtype=float).reshape(-1, length)
    if sea is not None and fluid.in_closed_form is not None and not fluid.can_be_disturbed:
        whole = WaveField(sea)
        verbs = {"elevation": whole.elevation, "normal": whole.normal, "velocity": whole.velocity}
        return {"time": time, "values": json_numbers(verbs[asked.verb](points, time))}
    if asked.time is not None:
        why = "it is known only at the present time, leave the time out"
        raise Refused(f"this water is more than its plane waves: {why}")
    if asked.verb == "normal":
        return {"time": now, "values": json_numbers(surface_normals(fluid, points))}
    found = fluid.elevations(points) if asked.verb == "elevation" else fluid.velocities(points)
    return {"time": now, "values": json_numbers(found)}


def surface_normals(fluid: Fluid, points: np.ndarray) -> np.ndarray:
    """Upward unit normals (n, 3) of the water surface at points x, z (n, 2) [m], by central differences of heights."""
    step = SLOPE_STEP * fluid.spacing
    rises = [fluid.elevations(points + step * along) - fluid.elevations(points - step * along) for along in np.eye(2)]
    found = np.stack([-rises[0], np.full(len(points), 2.0 * step), -rises[1]], axis=1)
    return found / np.linalg.norm(found, axis=1, keepdims=True)


def json_numbers(values: np.ndarray) -> list[Any]:
    """Nested lists of an array for JSON, rounded to six decimals, with null for numbers that are not finite."""
    rows = np.round(np.asarray(values, dtype=float), 6)
    whole = rows.astype(object)
    whole[~np.isfinite(rows)] = None
    return list(whole.tolist())
