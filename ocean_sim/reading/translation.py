"""Validation errors of pydantic rewritten as problems of a scene, with location, bound and unit."""

import re
from collections.abc import Iterator
from difflib import get_close_matches
from functools import cache
from itertools import islice
from math import inf
from pathlib import Path as Folder
from typing import Any, NamedTuple, TypeVar

from pydantic import BaseModel, ValidationError

from ocean_sim.files.input_file import SCENE_FOLDER_KEY
from ocean_sim.files.yaml_file import Node, Problem, SceneError, describe_value, problem_at, read_mapping
from ocean_sim.model import in_brackets
from ocean_sim.parts import PACKAGE

MIN_NUMBER, MAX_NUMBER = 1e-60, 1e15  # size of a number in SI units that a scene may hold
NAME_RULE = "letters, digits and _, a letter first"  # what a name that a scene gives is made of
MAX_ERRORS = 200  # errors of one part beyond which the rest is of the same kind
SHOWN_KEYS = 2  # keys of a mapping that a sentence shows where none is required
MAX_CHOICES = 24  # choices that still fit in a sentence
BOUND_WORDS = {"gt": "greater than", "ge": "at least", "lt": "less than", "le": "at most"}
VALUE_TYPES = {  # types of JSON Schema, each in words, and the errors by which pydantic says that a value is of another
    "number": ("a number", "float_type float_parsing"),
    "integer": ("a whole number", "int_type int_from_float"),
    "boolean": ("true or false", "bool_type"),
    "string": ("text", "string_type"),
    "object": ("a mapping", "model_type model_attributes_type dict_type"),
    "array": ("a list", "list_type tuple_type"),
    "null": ("null", "none_required"),
}
SHAPE_ERRORS = {error: name for name, (_, errors) in VALUE_TYPES.items() for error in errors.split()}

# A number and its unit.
MEASURE_PATTERN = re.compile(r"([+-]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][+-]?\d+)?)\s*\[?([^\s\[\]]*)\]?")
MIN_PREFIX = 3  # letters of the beginning of a word by which it is known
SLIP_SIMILARITY, NEAR_SIMILARITY = 0.9, 0.6  # shares of letters that a mistyped word, and one like it, have in common

Model = TypeVar("Model", bound=BaseModel)
Path = tuple[str | int, ...]


def validated(
    model: type[Model], node: Node, path: Path, problems: list[Problem], folder: Folder | None = None
) -> Model | None:
    """Validate a node's data as a `model`; None if they are wrong, and their problems are appended to `problems`.
    `path`: of the node in the scene; `folder`: base of relative file names, by default the working directory."""
    beyond = list(islice(out_of_range(node, path), MAX_ERRORS))
    found, wrong = None, list[Problem]()
    try:
        found = model.model_validate(node.plain(), context={SCENE_FOLDER_KEY: folder})
    except ValidationError as error:
        wrong = translate_errors(error, model, node, path)
    told = {each.key for each in wrong}
    problems += [*wrong, *(each for each in beyond if each.key not in told)]
    return None if beyond else found


def checked(model: type[Model], node: Node) -> Model:
    """Validate a node's data as a `model`; raises SceneError with all of its problems."""
    problems: list[Problem] = []
    found = validated(model, node, (), problems)
    if found is None:
        raise SceneError(problems)
    return found


def out_of_range(node: Node, path: Path) -> Iterator[Problem]:
    """Yield a problem for each number in a node beyond MIN_NUMBER or MAX_NUMBER in size: products would overflow."""
    if isinstance(node.data, dict | list):
        for key, inner in node.data.items() if isinstance(node.data, dict) else enumerate(node.data):
            yield from out_of_range(inner, (*path, key))
    elif isinstance(node.data, int | float) and node.data:
        if not MIN_NUMBER <= abs(node.data) <= MAX_NUMBER and abs(node.data) < inf:
            message = f"{describe_value(node.data)} is out of range: 0, or between {MIN_NUMBER:g} and {MAX_NUMBER:g}"
            yield problem_at(node.location, dotted(path), message)


def dotted(path: Path) -> str:
    """A path as users write it: `wind.volumes.0.noise`."""
    return ".".join(map(str, path))


def likeliest(word: str, choices: Any) -> str | None:
    """The choice most likely meant by a word, or None: by small slips, prefixes, synonyms, then similar spelling."""
    by_lower = {normal_form(str(choice)): str(choice) for choice in choices}
    lower = normal_form(word)
    if lower in by_lower:
        return by_lower[lower]
    begun = [choice for choice in by_lower if lower.startswith(f"{choice}_")]
    synonyms = " ".join(meant for words, meant in data_table("synonyms")["keys"].items() if lower in words.split())
    others = [choice for choice in synonyms.split() if choice in by_lower]
    longer = [choice for choice in by_lower if choice.startswith(lower) and len(lower) >= MIN_PREFIX]
    slip, close = (get_close_matches(lower, by_lower, n=1, cutoff=part) for part in (SLIP_SIMILARITY, NEAR_SIMILARITY))
    found = next(iter([*slip, *sorted(begun, key=len), *others, *sorted(longer, key=len), *close]), None)
    return by_lower[found] if found is not None else None


@cache
def data_table(name: str) -> dict[str, dict[str, Any]]:
    """Content of the YAML file `name` of this folder: `synonyms` or `examples`."""
    found: dict[str, dict[str, Any]] = read_mapping(PACKAGE / "reading" / f"{name}.yaml").plain()
    return found


def normal_form(word: str) -> str:
    """A word in lower case with underscores, for comparison."""
    return word.lower().replace("-", "_").replace(" ", "_")


def choice_sentence(word: str, choices: Any) -> tuple[str, str | None]:
    """End of a message on unknown `word`, '; did you mean ...' or '; there are ...', and the likely choice or None."""
    choices = [str(choice) for choice in choices]
    suggestion = likeliest(word, choices)
    if suggestion is not None:
        return f"; did you mean {suggestion!r}?", suggestion
    return (f"; there are {', '.join(choices)}" if 0 < len(choices) <= MAX_CHOICES else ""), None


def key_sentence(word: str, choices: Any) -> tuple[str, str | None]:
    """End of a message on an unknown key `word`, and the likeliest of `choices` or None; a.b becomes a: {b: ...}."""
    if word.isdigit():
        comma = "in {...} and [...] a comma ends a value: is it a decimal comma?"
        return f"; {comma} Write a point, as in 0.{word}", None
    first, *inner = word.split(".")
    if inner and first in choices:
        return f"; in a scene it is written {first}: {{{': {'.join(inner)}: ...{'}' * len(inner)}", None
    return choice_sentence(word, choices)


def translate_errors(error: ValidationError, model: type[BaseModel], root: Node, prefix: Path) -> list[Problem]:
    """Problems that state a pydantic error of a `model`, read from the YAML node `root` at path `prefix` of a document;
    of a union only its likeliest member's."""
    found = [_locate_error(e, model, root) for e in error.errors(include_url=False)[:MAX_ERRORS]]
    problems = [_problem_of(f, prefix) for f in found if f.union is None and not _is_extra_item(f, found)]
    for union in dict.fromkeys(f.union for f in found if f.union is not None):
        problems += _union_problems([f for f in found if f.union == union], prefix)
    return problems


class _Found(NamedTuple):
    """One pydantic error with its path and node in the data, and the facts of the schema that its message needs."""

    kind: str
    message: str
    context: dict[str, Any]
    path: Path  # keys and indices that exist in the data, then the missing key if one is missing
    node: Node  # the deepest node on that path
    unit: str  # in brackets
    keys: tuple[str, ...]  # what could be written instead of an unknown key
    form: str  # what a value of its kind looks like, where that is a mapping or a list
    union: Path | None  # the path of the first union on the way, and
    member: str  # which of its members reports it
    shape: bool  # the value has another shape than the member expects


@cache
def _model_schema(model: type[BaseModel]) -> dict[str, Any]:
    return model.model_json_schema()


def _locate_error(error: Any, model: type[BaseModel], root: Node) -> _Found:
    """Facts of a pydantic error in the data `root`, found by following its location through data and model schema."""
    definitions = _model_schema(model).get("$defs", {})
    node, places, keys = root, [*union_members(_model_schema(model), definitions)], tuple[str, ...]()
    path: Path = ()
    union: Path | None = None
    member, unit = "", ""
    steps = error["loc"]
    for k, step in enumerate(steps):
        inner = node.child(step)
        if inner is None and not (k == len(steps) - 1 and error["type"] in ("missing", "extra_forbidden")):
            if union is None:
                union, member = path, str(step)
            places = [place for place in places if _is_meant(place, str(step))] or places
            continue
        keys = tuple(dict.fromkeys(name for place in places for name in place.get("properties", ())))
        path = (*path, step)
        below = [_schema_below(place, step) for place in places]
        if step in keys:
            unit = next((in_brackets(schema["unit"]) for schema in below if "unit" in schema), "")
        places = [member for schema in below for member in union_members(schema, definitions)]
        node = inner if inner is not None else node
    shape = error["type"] in SHAPE_ERRORS or (error["type"] == "literal_error" and isinstance(node.data, dict | list))
    shape = shape and union == path
    fitting = [place for place in places if place.get("type", "") == SHAPE_ERRORS.get(error["type"])]
    form = _value_form(fitting[0], definitions) if fitting else ""
    return _Found(error["type"], error["msg"], error.get("ctx", {}), path, node, unit, keys, form, union, member, shape)


def union_members(schema: dict[str, Any], definitions: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield members of a union in a JSON Schema, and of unions in it, or the schema; `definitions`: of references."""
    union = [definitions[schema["$ref"].removeprefix("#/$defs/")]] if "$ref" in schema else None
    union = union or schema.get("anyOf", schema.get("oneOf"))
    if union is None:
        yield schema
    for member in union or ():
        yield from union_members(member, definitions)


def _is_meant(place: dict[str, Any], tag: str) -> bool:
    """True if `tag`, of the location of a pydantic error, is title or discriminator of the union member `place`."""
    keys = place.get("properties", {}).values()
    return place.get("title") == tag or any(tag in (key.get("const"), *key.get("enum", ())) for key in keys)


def _schema_below(place: dict[str, Any], step: str | int) -> dict[str, Any]:
    """Schema of the entry at a key or index `step` of a value of schema `place`; empty if it may be anything."""
    if isinstance(step, int):
        entries = place.get("prefixItems", [])
        return entries[min(step, len(entries) - 1)] if entries else place.get("items", {})
    named = [*place.get("patternProperties", {}).values(), place.get("additionalProperties")]
    found = place.get("properties", {}).get(step, named[0])
    return found if isinstance(found, dict) else {}  # true: anything; false, or none: nothing


def _is_extra_item(found: _Found, all_found: list[_Found]) -> bool:
    """True if an error on a list's length repeats another error on the same list, which is reported instead."""
    if found.kind == "too_short" and len(found.node.data) >= found.context["min_length"]:
        return True
    return _is_short(found) and any(_is_short(f) and f.node is found.node and f.path > found.path for f in all_found)


def _is_short(found: _Found) -> bool:
    """True if an error says that a list has too few entries."""
    return found.kind == "missing" and isinstance(found.node.data, list)


def _union_problems(found: list[_Found], prefix: Path) -> list[Problem]:
    """Problems of a value that fits no member of a union: those of the likeliest member, or one with all forms."""
    members: dict[str, list[_Found]] = {}
    for f in found:
        members.setdefault(f.member, []).append(f)
    fitting = [errors for errors in members.values() if not any(f.shape for f in errors)]
    if fitting:
        best = min(fitting, key=len)
        return [_problem_of(f, prefix) for f in best if not _is_extra_item(f, best)]
    first, firsts = found[0], [errors[0] for errors in members.values()]
    wanted = dict.fromkeys(_shape_words(f) for f in firsts)
    hint = next(filter(None, map(_number_hint, firsts)), "")
    message = f"expected {' or '.join(wanted)}, got {describe_value(first.node.plain())}{hint}"
    return [problem_at(first.node.location, dotted(prefix + first.path), message)]


def _problem_of(found: _Found, prefix: Path) -> Problem:
    """A pydantic error as a problem with key, location and message; `prefix`: path of the model in the scene."""
    key, location = dotted(prefix + found.path), found.node.location
    value, context, suggestion = describe_value(found.node.plain()), found.context, None
    bound = next((name for name in BOUND_WORDS if name in context), None)
    if found.member == "[key]":
        key, location = dotted(prefix + found.path[:-1]), found.node.key_location
        message = f"{found.path[-1]!r} is not a name: {NAME_RULE}"
    elif found.kind == "extra_forbidden":
        message, suggestion = key_sentence(str(found.path[-1]), found.keys)
        message, location = f"unknown key{message}", found.node.key_location
    elif _is_short(found):
        key = dotted(prefix + found.path[:-1])
        message = f"expected {_entry_count(int(found.path[-1]) + 1)}, got {len(found.node.data)}"
    elif found.kind == "missing":
        message = "missing key"
    elif found.kind == "too_short" and found.node.data == []:
        message = "this list is empty"
    elif found.kind in ("too_long", "too_short") and isinstance(found.node.data, list | dict):
        wanted = context["max_length"] if found.kind == "too_long" else context["min_length"]
        word = "most" if found.kind == "too_long" else "least"
        message = f"expected at {word} {_entry_count(wanted)}, got {len(found.node.data)}"
    elif bound is not None:
        limit = f"{context[bound]:g}" if isinstance(context[bound], float) else context[bound]
        message = f"{value} is not {BOUND_WORDS[bound]} {limit}{found.unit}"
    elif found.kind == "finite_number":
        message = f"{value} is not a finite number"
    elif found.kind == "literal_error":
        choices = [word.strip("'") for word in context["expected"].replace(" or ", ", ").split(", ")]
        end, suggestion = choice_sentence(str(found.node.data), choices)
        none_near = f"one of {context['expected']}"
        message = f"{value} is not {none_near if suggestion is None else f'a choice{end}'}"
    elif found.kind in ("union_tag_invalid", "union_tag_not_found"):
        name = context["discriminator"].strip("'")
        choices = [word.strip("'") for word in context.get("expected_tags", "").split(", ") if word]
        key = f"{key}.{name}" if key else name
        location = found.node.data[name].location if found.kind == "union_tag_invalid" else location
        end, suggestion = choice_sentence(str(context.get("tag", "")), choices)
        message = "missing key" if found.kind == "union_tag_not_found" else f"{context['tag']!r} is not a choice{end}"
    elif found.kind in SHAPE_ERRORS:
        form = f", as in {found.form}" if found.form else ""
        message = f"expected {_shape_words(found)}, got {value}{_number_hint(found)}{form}"
    elif found.kind in ("value_error", "assertion_error"):
        message = str(context.get("error", found.message))
    else:
        message = found.message.replace("Input should be", "this should be")
    return problem_at(location, key, message, suggestion)


def _shape_words(found: _Found) -> str:
    """Words for the form of value that an error says was expected: a type, or one of some choices."""
    name = SHAPE_ERRORS.get(found.kind)
    return VALUE_TYPES[name][0] if name is not None else f"one of {found.context.get('expected', '')}"


def _number_hint(found: _Found) -> str:
    """End of an error message with the number meant by a text such as '1,5' or '3 m'; empty if it is none."""
    text, numbers = found.node.data, ("float_type", "int_type")
    measure = MEASURE_PATTERN.fullmatch(text.strip()) if isinstance(text, str) and found.kind in numbers else None
    if measure is None:
        return ""
    written, unit = measure[2].replace("^", ""), found.unit.strip(" []")
    of, factor = data_table("synonyms")["units"].get(written, (written, 1.0))
    if of not in ("", unit or "1"):
        return f"; a number stands without its unit{f', which is {unit} here' if unit else ''}"
    number = float(measure[1].replace(",", ".")) * factor
    return f"; did you mean {number:.12g}?" if found.kind == "float_type" or number.is_integer() else ""


def _value_form(place: dict[str, Any], definitions: dict[str, Any]) -> str:
    """Outline of a value of schema `place`, as `{height: ..., period: ...}` or `[..., ...]`; empty for plain values."""
    if "properties" in place:
        names = place.get("required") or [*place["properties"]][:SHOWN_KEYS]
        return f"{{{', '.join(f'{name}: ...' for name in names)}}}"
    if "prefixItems" in place:
        return f"[{', '.join('...' for _ in place['prefixItems'])}]"
    if place.get("type") not in ("array", "object"):
        return ""
    inside = next(union_members(_schema_below(place, 0 if place["type"] == "array" else ""), definitions))
    entry = _value_form(inside, definitions) or "..."
    return f"[{entry}, ...]" if place["type"] == "array" else f"{{NAME: {entry}}}"


def _entry_count(count: int) -> str:
    return "1 entry" if count == 1 else f"{count} entries"
