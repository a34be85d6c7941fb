"""Scenes that hypothesis draws from the JSON schema: every slot, kind and observer; small enough to be run."""

from functools import cache
from typing import Any

from hypothesis import strategies as st

from ocean_sim.files.yaml_file import SceneError
from ocean_sim.reading.keys import scene_schema
from ocean_sim.reading.scene import SceneConfig, load
from ocean_sim.validation.shared.tables import table_path

NAMES = ("a", "bow", "gauge_2")
OPTIONAL = 3  # keys of a mapping, at most, that need not be written

# Sizes of numbers by unit, where the schema sets no bound: those of a tank of some metres.
SIZES = {
    "m": 1.0,
    "s": 0.5,
    "m/s": 0.5,
    "m/s2": 2.0,
    "m2/s": 0.01,
    "m2/s2": 10.0,
    "m2": 0.1,
    "m3/s": 0.1,
    "kg": 300.0,
    "kg m2": 100.0,
    "kg/m3": 1500.0,
    "N": 100.0,
    "Pa": 100.0,
    "deg": 90.0,
    "deg/s": 5.0,
    "rad": 0.5,
    "rad/s": 0.5,
    "spacings": 2.0,
    "particles": 600.0,
    "pixels": 320.0,
    "triangles": 1000.0,
}
# Numbers that decide what a run costs, or whether it is one at all.
CHOICES: dict[str, st.SearchStrategy] = {
    "basin.length": st.sampled_from([1.5, 2.0, 3.0]),
    "basin.width": st.sampled_from([1.5, 2.0]),
    "basin.depth": st.sampled_from([0.6, 1.0]),
    "spacing": st.sampled_from([0.2, 0.25, 0.3]),
    "cells": st.sampled_from([16, 24]),
    "fluid.particles": st.sampled_from([100, 250, 500]),
    "geometry": st.sampled_from(["hexapod_a", "linuxcnc"]),
    "washout": st.sampled_from(["ship", "air", "srs"]),
    "cap": st.sampled_from([50, 200]),
    "support_ratio": st.sampled_from([1.5, 2.0, 2.6]),
    "rest_density": st.sampled_from([800.0, 1000.0, 1025.0]),
    "threads": st.just(1),
    "arch": st.just("cpu"),
    "precision": st.just("f32"),
    "pin": st.just(False),
    "every": st.sampled_from([0.01, 0.02, 0.05]),
    "cells_per_draught": st.sampled_from([2.0, 4.0]),
    "resolution": st.sampled_from([1.0, 1.0, 1.25]),
    "duration": st.sampled_from([0.05, 0.2]),
    "seed": st.integers(0, 2**31 - 1),
    "to": st.just("udp://127.0.0.1:5005"),
    "mass": st.sampled_from([50.0, 200.0]),
    "inertia": st.none() | st.sampled_from([[5.0, 6.0, 3.0], [20.0, 20.0, 1.0]]),
    "radiation": st.none() | st.just(str(table_path("barge20_radiation"))),
    "title": st.text(st.characters(codec="utf-8", exclude_categories=["C", "Z"]), max_size=8),
    "point": st.none() | st.sampled_from(NAMES),
    "profile": st.none() | st.just([[-9.0, -0.3], [9.0, 0.2]]),
    "grid": st.none(),
    "hull": st.fixed_dictionaries(
        {
            "shape": st.fixed_dictionaries(
                {
                    "kind": st.just("box"),
                    "length": st.sampled_from([0.8, 1.2]),
                    "breadth": st.sampled_from([0.4, 0.8]),
                    "height": st.sampled_from([0.3, 0.5]),
                }
            ),
            "mass": st.sampled_from([30.0, 80.0]),
        }
    ),
}
# What reads files, or draws: broken and tried elsewhere.
ELSEWHERE = ("MeshFile", "MeshObstacle", "FromFile", "Track", "/File", "Recorded")


@cache
def whole() -> dict[str, Any]:
    """The schema, made when a scene is drawn."""
    return scene_schema()


def number(node: dict[str, Any], unit: str) -> st.SearchStrategy:
    """A number within the schema's bounds, else of the size that its unit suggests."""
    size = SIZES.get(unit, 1.0)
    low = node.get("minimum", node.get("exclusiveMinimum"))
    high = node.get("maximum", node.get("exclusiveMaximum"))
    low = -size if low is None else low
    high = low + size if high is None else min(high, max(low, 0.0) + 10.0 * size)
    if node["type"] == "integer":
        return st.integers(int(low) + ("exclusiveMinimum" in node), max(int(low) + 1, int(high)))
    ends = {"exclude_min": "exclusiveMinimum" in node, "exclude_max": "exclusiveMaximum" in node}
    few = st.sampled_from([low + share * (high - low) for share in (0.1, 0.25, 0.5, 0.9)])  # of a size that is met
    return few | st.floats(low, high, width=64, allow_subnormal=False, **ends)


@cache
def model(name: str, dimension: int) -> st.SearchStrategy:
    """A mapping that a definition of the schema allows."""
    node = whole()["$defs"][name]
    if "properties" not in node:
        return value(node, dimension)
    return mapping(name, dimension)


@st.composite
def mapping(draw: Any, name: str, dimension: int) -> dict[str, Any]:
    node = whole()["$defs"][name]
    properties, required = node["properties"], list(node.get("required", []))
    optional = [key for key in properties if key not in required]
    some = draw(st.lists(st.sampled_from(optional), unique=True, max_size=OPTIONAL)) if optional else []
    keys = [key for key in properties if key in required or key in some or key == "kind"]
    short = name.split(".")[0]
    return {key: draw(CHOICES.get(f"{short}.{key}", value(properties[key], dimension, key))) for key in keys}


def value(node: dict[str, Any], dimension: int, key: str = "", unit: str = "") -> st.SearchStrategy:
    """What a node of the schema allows; points have as many numbers as the basin."""
    unit = node.get("unit", unit)
    if key in CHOICES:
        return CHOICES[key]
    if "$ref" in node:
        return model(node["$ref"].removeprefix("#/$defs/"), dimension)
    if "const" in node:
        return st.just(node["const"])
    if "enum" in node:
        return st.sampled_from(node["enum"])
    for union in ("anyOf", "oneOf"):
        if union in node:
            members = [m for m in node[union] if not m.get("$ref", "").endswith(ELSEWHERE)]
            return st.one_of([value(m, dimension, "", unit) for m in members])
    kind = node["type"]
    if kind in ("number", "integer"):
        return number(node, unit)
    if kind == "array":
        return array(node, dimension, unit)
    if kind == "object":
        inner = next(iter(node.get("patternProperties", {}).values()), node.get("additionalProperties", {}))
        return st.dictionaries(st.sampled_from(NAMES), value(inner, dimension, "", unit), max_size=2)
    if kind == "string" and "pattern" in node:
        return st.from_regex(node["pattern"], fullmatch=True)
    return {"null": st.none(), "boolean": st.booleans(), "string": st.sampled_from(NAMES)}[kind]


def array(node: dict[str, Any], dimension: int, unit: str) -> st.SearchStrategy:
    if "prefixItems" in node:
        return st.tuples(*(value(item, dimension, "", unit) for item in node["prefixItems"])).map(list)
    least, most = node.get("minItems", 0), node.get("maxItems", node.get("minItems", 0) + 2)
    if (least, most) in ((1, 2), (2, 3)):  # a place
        least = most = most - 3 + dimension
    return st.lists(value(node["items"], dimension, "", unit), min_size=least, max_size=most)


def slot(name: str, dimension: int) -> st.SearchStrategy:
    """A ready-made part, or a kind with keys of its own."""
    references = [m["$ref"].removeprefix("#/$defs/") for m in whole()["properties"][name]["anyOf"] if "$ref" in m]
    ready = [m["enum"] for m in whole()["properties"][name]["anyOf"] if "enum" in m]
    kinds = st.one_of([model(reference, dimension) for reference in references])
    return kinds | st.sampled_from(ready[0]) if ready and name in ("wind", "platform") else kinds


@st.composite
def scenes(draw: Any, dimension: int | None = None) -> dict[str, Any]:
    """A scene; it may still contradict itself in ways that only its loading tells."""
    dimension = dimension or draw(st.sampled_from([2, 3, 3]))
    basin = draw(model("basin", dimension))
    basin.pop("width", None)
    scene: dict[str, Any] = {"basin": basin | ({"width": draw(CHOICES["basin.width"])} if dimension == 3 else {})}
    scene["fluid"] = draw(slot("fluid", dimension))
    for name in ("wind", "surface", "ship", "platform", "time_step"):
        if draw(st.booleans()) and not (name == "ship" and dimension == 2):
            scene[name] = draw(slot(name, dimension))
    if "ship" in scene and draw(st.booleans()):  # and her sister, clear of her where the basin is broad enough
        place = {"position": [-0.5, 0.0]}, {"position": [0.9, 0.0]}
        ship = {key: value for key, value in scene.pop("ship").items() if key != "position"}
        scene["ships"] = {name: ship | at for name, at in zip("ab", place)}
    afloat = "ship" in scene or "ships" in scene
    if afloat:
        for key in ("gravity", "lid", "motion"):
            scene["basin"].pop(key, None)
    if afloat and scene["fluid"]["kind"] not in ("linear_waves", "spectral_sea") and draw(st.integers(0, 9)):
        scene.setdefault("surface", draw(slot("surface", dimension)))
    if scene["fluid"]["kind"] in ("mueller", "delta_sph", "dfsph") and draw(st.booleans()):
        scene["sea"] = draw(slot("sea", dimension))
        scene["basin"]["walls"] = "periodic"
        for keys, part in (
            (("wavemaker", "motion", "lid", "obstacles", "floor"), "basin"),
            (("initial", "fill", "emitter"), "fluid"),
        ):
            for key in keys:
                scene[part].pop(key, None)
    for key in ("title", "seed", "duration", "resolution"):
        if draw(st.booleans()):
            scene[key] = draw(CHOICES[key])
    observers = [
        name for name, node in whole()["properties"].items() if node.get("anyOf", [{}])[-1] == {"type": "null"}
    ]
    parts = ("sea", "rim", "wind", "surface", "ship", "ships", "platform", "fluid")
    for name in (name for name in observers if name not in parts):
        if name not in ("time_step", "manifest", "stream", "health") and draw(st.integers(0, 3)) == 0:
            scene[name] = draw(value(whole()["properties"][name], dimension))
    return scene


def settled(scene: dict[str, Any], rounds: int = 6) -> SceneConfig | None:
    """The scene without what is complained of, loaded; None where complaints go on."""
    dimension = 3 if "width" in scene["basin"] else 2
    for _ in range(rounds):
        try:
            return load(scene)
        except SceneError as error:
            for problem in error.problems:
                leave_out(scene, problem.key.split("."), dimension)
    return None


def leave_out(scene: dict[str, Any], path: list[str], dimension: int) -> None:
    """Take away what a key names; what a scene cannot be without is replaced by its simplest form."""
    if path[-1] == "kind" and len(path) == 2 and path[0] != "fluid":
        scene.pop(path[0], None)  # this kind does not go with the rest
        return
    at: Any = scene
    for step in path[:-1]:
        inner = at.get(step) if isinstance(at, dict) else at[int(step)] if int(step) < len(at) else None
        if not isinstance(inner, dict | list):
            break  # a part that is named, or was taken away already
        at = inner
    if isinstance(at, dict) and at is not scene:
        if at is scene["fluid"]:
            scene["basin"].pop("walls", None)  # periodic sides may be too near each other
            scene["fluid"] = plain("delta_sph" if path == ["fluid", "kind"] else at["kind"])
        elif path[-1] in at:
            del at[path[-1]]
        else:  # a key that is missing
            leave_out(scene, path[:-1], dimension)
    elif isinstance(at, list) and path[-1].isdecimal():
        del at[int(path[-1]) :]
    elif path[0] == "basin":
        scene["basin"] = {"length": 2.0, "depth": 0.6} | ({"width": 1.5} if dimension == 3 else {})
    elif path[0] == "fluid":
        scene["fluid"] = plain(scene["fluid"]["kind"])
    else:
        scene.pop(path[0], None)


PLAIN: dict[str, dict[str, Any]] = {"linear_waves": {"height": 0.02, "period": 0.8}, "spectral_sea": {"cells": 16}}


def plain(kind: str) -> dict[str, Any]:
    """Water of a kind, and no more."""
    return {"kind": kind} | PLAIN.get(kind, {"spacing": 0.25})
