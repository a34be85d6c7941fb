"""Errors of pydantic in the words of scenes: with location, bound and unit."""

import re
from collections.abc import Iterator
from difflib import get_close_matches
from itertools import islice
from math import inf
from pathlib import Path as Folder
from types import UnionType
from typing import Annotated, Any, Literal, NamedTuple, TypeVar, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from ocean_sim.files.input_file import FOLDER
from ocean_sim.files.yaml_file import Node, Problem, described, problem
from ocean_sim.model import in_brackets

LEAST, MOST = 1e-60, 1e15  # size of a number in SI units that a scene may hold
NAMES = "letters, digits and _, a letter first"  # what a name that a scene gives is made of
MANY = 200  # errors of one part beyond which the rest is of the same kind
EXAMPLES = 2  # keys of a mapping that a sentence shows where none is required
FEW = 24  # choices that still fit in a sentence
BOUNDS = {"gt": "greater than", "ge": "at least", "lt": "less than", "le": "at most"}
SHAPES = {
    "float_type": "a number",
    "float_parsing": "a number",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "bool_type": "true or false",
    "string_type": "text",
    "model_type": "a mapping",
    "model_attributes_type": "a mapping",
    "dict_type": "a mapping",
    "list_type": "a list",
    "tuple_type": "a list",
    "none_required": "null",
}

MEASURE = re.compile(r"([+-]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][+-]?\d+)?)\s*\[?([^\s\[\]]*)\]?")  # a number and its unit
UNITS = {  # what people write, in units of scenes
    "mm": ("m", 1e-3),
    "cm": ("m", 1e-2),
    "km": ("m", 1e3),
    "ms": ("s", 1e-3),
    "min": ("s", 60.0),
    "h": ("s", 3600.0),
    "kn": ("m/s", 1852.0 / 3600.0),
    "km/h": ("m/s", 1.0 / 3.6),
    "t": ("kg", 1e3),
    "kPa": ("Pa", 1e3),
    "%": ("1", 1e-2),
}

SHORTEST = 3  # letters of the beginning of a word by which it is known
SLIP, ALMOST = 0.9, 0.6  # parts of the letters that two words share: one mistyped, one like the other

# What other programs call it, and what it may be called here; the first that there is counts.
SYNONYMS = {
    word: tuple(meant.split())
    for words, meant in {
        "speed wind_speed u windspeed": "u10 velocity wind_speed reference_speed",
        "direction heading angle bearing course yaw dir": "heading_deg",
        "pos location place origin xyz": "position centre at",
        "center": "centre",
        "dt step timestep delta_t": "time_step dt every",
        "cfl courant": "courant_number time_step",
        "output outputs save vtk snapshots dump": "frames every",
        "viscosity nu mu": "kinematic_viscosity",
        "density rho rho0": "rest_density",
        "size dimensions extent domain_size": "length half_size size spacing",
        "dx particle_spacing particle_size radius_of_particles": "spacing",
        "smoothing_length kernel_radius support_radius": "support_ratio",
        "time end_time t_end tmax stop_time total_time simulation_time": "duration end stop",
        "hs h_s swh wave_height": "significant_wave_height height",
        "tp t_p wave_period": "peak_period period",
        "amplitude": "height amplitude",
        "boundary boundaries bc sides": "walls",
        "water liquid": "fluid",
        "sph": "fluid delta_sph",
        "left west": "x_min",
        "right east": "x_max",
        "bottom bed ground": "floor",
        "tank domain box": "basin",
        "boat vessel": "ship",
        "boats vessels": "ships",
        "mesh geometry stl": "hull shape surface geometry",
        "probes sensors probe wave_gauges": "gauges",
        "camera video film movie pictures": "render camera film",
        "g": "gravity",
        "c c0 sound_speed speed_of_sound": "reference_speed compression",
        "type model method scheme name": "kind",
        "n count number num_particles": "particles",
        "draft": "draught",
        "beam": "breadth",
        "cog cg center_of_mass centre_of_gravity": "centre_of_mass",
        "backend device gpu cpu": "arch runtime",
        "dtype float": "precision",
        "waves spectrum": "spectrum initial",
        "wsph wcsph sph_scheme": "delta_sph",
        "muller": "mueller",
    }.items()
    for word in words.split()
}

Model = TypeVar("Model", bound=BaseModel)
Path = tuple[str | int, ...]


def validated(
    model: type[Model], node: Node, path: Path, problems: list[Problem], folder: Folder | None = None
) -> Model | None:
    """The model of a node, or None, and then `problems` grows. `folder`: to which names of files are relative, by
    default the working directory."""
    beyond = list(islice(absurd(node, path), MANY))
    found, wrong = None, list[Problem]()
    try:
        found = model.model_validate(node.plain(), context={FOLDER: folder})
    except ValidationError as error:
        wrong = translated(error, model, node, path)
    told = {each.key for each in wrong}
    problems += [*wrong, *(each for each in beyond if each.key not in told)]
    return None if beyond else found


def absurd(node: Node, path: Path) -> Iterator[Problem]:
    """Numbers so large or small that no product of a few of them could be computed."""
    if isinstance(node.data, dict | list):
        for key, inner in node.data.items() if isinstance(node.data, dict) else enumerate(node.data):
            yield from absurd(inner, (*path, key))
    elif isinstance(node.data, int | float) and node.data:
        if not LEAST <= abs(node.data) <= MOST and abs(node.data) < inf:
            message = f"{described(node.data)} is out of range: 0, or between {LEAST:g} and {MOST:g}"
            yield problem(node.location, dotted(path), message)


def dotted(path: Path) -> str:
    """A path as users write it: `wind.volumes.0.noise`."""
    return ".".join(map(str, path))


def likeliest(word: str, choices: Any) -> str | None:
    """The choice that a word most likely meant: one but for a slip, one that begins it, another word for the same, one
    that it begins, or one that is spelled almost so."""
    by_lower = {lowered(str(choice)): str(choice) for choice in choices}
    lower = lowered(word)
    if lower in by_lower:
        return by_lower[lower]
    begun = [choice for choice in by_lower if lower.startswith(f"{choice}_")]
    others = [choice for choice in SYNONYMS.get(lower, ()) if choice in by_lower]
    longer = [choice for choice in by_lower if choice.startswith(lower) and len(lower) >= SHORTEST]
    slip, close = (get_close_matches(lower, by_lower, n=1, cutoff=part) for part in (SLIP, ALMOST))
    found = next(iter([*slip, *sorted(begun, key=len), *others, *sorted(longer, key=len), *close]), None)
    return by_lower[found] if found is not None else None


def lowered(word: str) -> str:
    """A word as those are compared that mean the same."""
    return word.lower().replace("-", "_").replace(" ", "_")


def choice_sentence(word: str, choices: Any) -> tuple[str, str | None]:
    """'; did you mean ...' or '; there are ...', and the suggestion alone."""
    choices = [str(choice) for choice in choices]
    suggestion = likeliest(word, choices)
    if suggestion is not None:
        return f"; did you mean {suggestion!r}?", suggestion
    return (f"; there are {', '.join(choices)}" if 0 < len(choices) <= FEW else ""), None


def key_sentence(word: str, choices: Any) -> tuple[str, str | None]:
    """The same of an unknown key: one with dots, as `--set` takes it, is a mapping in a scene."""
    first, *inner = word.split(".")
    if inner and first in choices:
        return f"; in a scene it is written {first}: {{{': {'.join(inner)}: ...{'}' * len(inner)}", None
    return choice_sentence(word, choices)


def translated(error: ValidationError, model: type[BaseModel], root: Node, prefix: Path) -> list[Problem]:
    """Every problem in a validation error; of each union only those of its likeliest member."""
    found = [_located(e, model, root) for e in error.errors(include_url=False)[:MANY]]
    problems = [_sentence(f, prefix) for f in found if f.union is None and not _is_extra_item(f, found)]
    for union in dict.fromkeys(f.union for f in found if f.union is not None):
        problems += _of_union([f for f in found if f.union == union], prefix)
    return problems


class _Found(NamedTuple):
    """One pydantic error: where in the data it is, and the parts of the models that it concerns."""

    kind: str
    message: str
    context: dict[str, Any]
    path: Path  # keys and indices that exist in the data, then the missing key if one is missing
    node: Node  # the deepest node on that path
    field: FieldInfo | None  # the last field passed on the way
    keys: tuple[str, ...]  # what could be written instead of an unknown key
    form: str  # what a value of its kind looks like, where that is a mapping or a list
    union: Path | None  # the path of the first union on the way, and
    member: str  # which of its members reports it
    shape: bool  # the value has another shape than the member expects


def _located(error: Any, model: type[BaseModel], root: Node) -> _Found:
    node, types = root, [model]
    path: Path = ()
    union: Path | None = None
    field: FieldInfo | None = None
    member, keys = "", tuple[str, ...]()
    steps = error["loc"]
    for k, step in enumerate(steps):
        inner = node.child(step)
        last = k == len(steps) - 1
        if inner is None and not (last and error["type"] in ("missing", "extra_forbidden")):
            if union is None:
                union, member = path, str(step)
            types = _narrowed(types, str(step))
            continue
        keys = tuple(dict.fromkeys(name for t in types if _is_model(t) for name in t.model_fields))
        path = (*path, step)
        types, field = _inside(types, step, field)
        node = inner if inner is not None else node
    shape = error["type"] in SHAPES or (error["type"] == "literal_error" and isinstance(node.data, dict | list))
    shape = shape and union == path
    context = error.get("ctx", {})
    form = _form([t for t in types if _fits(error["type"], t)])
    return _Found(error["type"], error["msg"], context, path, node, field, keys, form, union, member, shape)


def _members(annotation: Any) -> list[Any]:
    """An annotation without `Annotated`, a union as its members."""
    origin = get_origin(annotation)
    if origin is Annotated:
        return _members(get_args(annotation)[0])
    if origin in (Union, UnionType):
        return [member for argument in get_args(annotation) for member in _members(argument)]
    return [annotation]


def _is_model(annotation: Any) -> bool:
    return isinstance(annotation, type) and issubclass(annotation, BaseModel)


def _narrowed(types: list[Any], tag: str) -> list[Any]:
    """The members of a union that pydantic means by a tag: a class by name, or by the word of its discriminator."""

    def meant(model: Any) -> bool:
        words = [
            w
            for f in model.model_fields.values()
            if get_origin(f.annotation) is Literal
            for w in get_args(f.annotation)
        ]
        return model.__name__ == tag or tag in words

    return [t for t in types if _is_model(t) and meant(t)] or types


def _inside(types: list[Any], step: str | int, field: FieldInfo | None) -> tuple[list[Any], FieldInfo | None]:
    """The annotations one step further in, and the last model field passed."""
    inner: list[Any] = []
    for t in types:
        arguments = get_args(t)
        if _is_model(t) and step in t.model_fields:
            field = t.model_fields[step]
            inner += _members(field.annotation)
        elif get_origin(t) is dict and arguments:
            inner += _members(arguments[1])
        elif get_origin(t) in (list, tuple) and isinstance(step, int) and arguments:
            inner += _members(arguments[min(step, len(arguments) - 1)] if arguments[-1] is not ... else arguments[0])
    return inner, field


def _is_extra_item(found: _Found, all_found: list[_Found]) -> bool:
    """A list that is too short is reported once, not once for each missing entry, nor for entries that are wrong."""
    if found.kind == "too_short" and len(found.node.data) >= found.context["min_length"]:
        return True
    return _is_short(found) and any(_is_short(f) and f.node is found.node and f.path > found.path for f in all_found)


def _is_short(found: _Found) -> bool:
    return found.kind == "missing" and isinstance(found.node.data, list)


def _of_union(found: list[_Found], prefix: Path) -> list[Problem]:
    members: dict[str, list[_Found]] = {}
    for f in found:
        members.setdefault(f.member, []).append(f)
    fitting = [errors for errors in members.values() if not any(f.shape for f in errors)]
    if fitting:
        best = min(fitting, key=len)
        return [_sentence(f, prefix) for f in best if not _is_extra_item(f, best)]
    wanted = list(dict.fromkeys(_wanted(errors[0]) for errors in members.values()))
    first = found[0]
    hint = next(filter(None, (_hint(errors[0]) for errors in members.values())), "")
    message = f"expected {' or '.join(wanted)}, got {described(first.node.plain())}{hint}"
    return [problem(first.node.location, dotted(prefix + first.path), message)]


def _wanted(found: _Found) -> str:
    return SHAPES.get(found.kind) or f"one of {found.context.get('expected', '')}"


def _sentence(found: _Found, prefix: Path) -> Problem:
    """One error as a problem."""
    key, location = dotted(prefix + found.path), found.node.location
    value, context, suggestion = described(found.node.plain()), found.context, None
    bound = next((name for name in BOUNDS if name in context), None)
    if found.member == "[key]":
        key, location = dotted(prefix + found.path[:-1]), found.node.key_location
        message = f"{found.path[-1]!r} is not a name: {NAMES}"
    elif found.kind == "extra_forbidden":
        message, suggestion = key_sentence(str(found.path[-1]), found.keys)
        message, location = f"unknown key{message}", found.node.key_location
    elif _is_short(found):
        key = dotted(prefix + found.path[:-1])
        message = f"expected {_entries(int(found.path[-1]) + 1)}, got {len(found.node.data)}"
    elif found.kind == "missing":
        message = "missing key"
    elif found.kind in ("too_long", "too_short") and isinstance(found.node.data, list | dict):
        wanted = context["max_length"] if found.kind == "too_long" else context["min_length"]
        word = "most" if found.kind == "too_long" else "least"
        message = f"expected at {word} {_entries(wanted)}, got {len(found.node.data)}"
    elif bound is not None:
        message = f"{value} is not {BOUNDS[bound]} {_number(context[bound])}{_unit(found.field)}"
    elif found.kind == "finite_number":
        message = f"{value} is not a finite number"
    elif found.kind == "literal_error":
        choices = [word.strip("'") for word in context["expected"].replace(" or ", ", ").split(", ")]
        end, suggestion = choice_sentence(str(found.node.data), choices)
        message = (
            f"{value} is not one of {context['expected']}" if suggestion is None else f"{value} is not a choice{end}"
        )
    elif found.kind in ("union_tag_invalid", "union_tag_not_found"):
        name = context["discriminator"].strip("'")
        choices = [word.strip("'") for word in context.get("expected_tags", "").split(", ") if word]
        key = f"{key}.{name}" if key else name
        location = found.node.data[name].location if found.kind == "union_tag_invalid" else location
        end, suggestion = choice_sentence(str(context.get("tag", "")), choices)
        message = "missing key" if found.kind == "union_tag_not_found" else f"{context['tag']!r} is not a choice{end}"
    elif found.kind in SHAPES:
        message = (
            f"expected {SHAPES[found.kind]}, got {value}{_hint(found)}{f', as in {found.form}' if found.form else ''}"
        )
    elif found.kind in ("value_error", "assertion_error"):
        message = str(context.get("error", found.message))
    else:
        message = found.message.replace("Input should be", "this should be")
    return problem(location, key, message, suggestion)


def _hint(found: _Found) -> str:
    """The number that a text means: YAML 1.2 reads one in quotes, with a comma or with a unit as text."""
    text, numbers = found.node.data, ("float_type", "int_type")
    measure = MEASURE.fullmatch(text.strip()) if isinstance(text, str) and found.kind in numbers else None
    if measure is None:
        return ""
    written, unit = measure[2].replace("^", ""), _unit(found.field).strip(" []")
    of, factor = UNITS.get(written, (written, 1.0))
    if of not in ("", unit or "1"):
        return f"; a number stands without its unit{f', which is {unit} here' if unit else ''}"
    number = float(measure[1].replace(",", ".")) * factor
    return f"; did you mean {number:.12g}?" if found.kind == "float_type" or number.is_integer() else ""


def _fits(wanted: str, annotation: Any) -> bool:
    """Whether a member of a union is of the shape that an error says was expected."""
    shapes = {"a mapping": (dict,), "a list": (list, tuple)}.get(SHAPES.get(wanted, ""), ())
    return get_origin(annotation) in shapes or (dict in shapes and _is_model(annotation))


def _form(types: list[Any]) -> str:
    """What a value looks like: a mapping with the keys that it must have, else its first ones; a list with an entry."""
    annotation = next(iter(types), None)
    origin, arguments = get_origin(annotation), get_args(annotation)
    if _is_model(annotation):
        fields = annotation.model_fields  # type: ignore[union-attr]
        names = [name for name, field in fields.items() if field.is_required()] or [*fields][:EXAMPLES]
        return f"{{{', '.join(f'{name}: ...' for name in names)}}}"
    if origin is dict:
        return f"{{NAME: {_form(_members(arguments[1])) or '...'}}}"
    if origin is list or (origin is tuple and ... in arguments):
        return f"[{_form(_members(arguments[0])) or '...'}, ...]"
    if origin is tuple:
        return f"[{', '.join('...' for _ in arguments)}]"
    return ""


def _entries(count: int) -> str:
    return "1 entry" if count == 1 else f"{count} entries"


def _number(bound: Any) -> str:
    return f"{bound:g}" if isinstance(bound, float) else str(bound)


def _unit(field: FieldInfo | None) -> str:
    extra = field.json_schema_extra if field is not None else None
    return in_brackets(str(extra.get("unit", "")) if isinstance(extra, dict) else "")
