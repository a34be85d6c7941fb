"""The parser of all YAML files (YAML 1.2); every value keeps its location in the text."""

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path, PurePath
from typing import Any, NamedTuple

import numpy as np

from ocean_sim.conventions import Refused
from ocean_sim.files.input_file import Unreadable, display_path, read_text

TEXT_TAGS = ("str", "timestamp", "merge", "value")  # the last three are words of YAML 1.1
MAX_TEXT_BYTES = 1_000_000  # a table of numbers that is longer goes into a CSV file
MAX_WRITTEN = 60_000  # values that stand in a text
MAX_EVENTS = 3 * MAX_WRITTEN  # a value has at most a key, a beginning and an end
MAX_VALUES = 200_000  # aliases of aliases can name more values than a machine can hold
MAX_DEPTH = 100  # levels of mappings and lists
MAX_KEY_LENGTH = 100  # characters
MAX_MESSAGE_BYTES, MAX_LINE_BYTES = 1900, 600  # of a message about a scene, and of one sentence in it
CORE_SCHEMA = re.compile(  # plain scalars that are not text, by the core schema of YAML 1.2
    r"(?P<null>~|null|Null|NULL|)"
    r"|(?P<bool>true|True|TRUE|false|False|FALSE)"
    r"|(?P<int>[-+]?(?:0b[01_]+|0x[0-9a-fA-F_]+|0o[0-7_]+|[0-9][0-9_]*))"
    r"|(?P<float>[-+]?(?:[0-9][0-9_]*\.[0-9_]*(?:[eE][-+]?[0-9]+)?|[0-9][0-9_]*[eE][-+]?[0-9]+"
    r"|\.[0-9_]+(?:[eE][-+][0-9]+)?|\.(?:inf|Inf|INF))|\.(?:nan|NaN|NAN))"
)
UNQUOTED_WORD = re.compile(r"[A-Za-z]([ :]?[\w.'/-])*")  # text that needs no quotes, but for words of CORE


class Location(NamedTuple):
    """File, line and column of a piece of text; line and column start at 1, and are None outside a file."""

    file: str
    line: int | None = None
    column: int | None = None


class Problem(NamedTuple):
    """One mistake of a user: file, line, column, key, message, and the likeliest correction or None."""

    file: str
    line: int | None
    column: int | None
    key: str
    message: str
    suggestion: str | None = None

    def __str__(self) -> str:
        """Line of an error message, `file:line:column: key: message`; items that are None are left out."""
        return ": ".join([":".join(str(p) for p in self[:3] if p is not None), *filter(None, [self.key]), self.message])


class SceneError(Refused):
    """Error that lists all problems of a scene, sorted by file and line."""

    def __init__(self, problems: list[Problem]) -> None:
        self.problems: list[Problem] = sorted(
            set(problems), key=lambda p: (p.file, p.line or 0, p.column or 0, p.key, p.message)
        )
        super().__init__("\n".join(self.lines()))

    def lines(self) -> Iterator[str]:
        """Yield a line per problem, up to MAX_MESSAGE_BYTES in all, then the number of problems left out."""
        left = MAX_MESSAGE_BYTES
        for k, each in enumerate(self.problems):
            line = shorten(str(each), MAX_LINE_BYTES)
            left -= len(line.encode(errors="backslashreplace"))
            if left < 0:
                yield f"... and {len(self.problems) - k} more"
                return
            yield line


def shorten(text: str, most: int) -> str:
    """Text of at most `most` bytes: the middle of a longer one is replaced by dots."""
    data = text.encode(errors="backslashreplace")  # halves of characters, too
    if len(data) <= most:
        return text
    half = most // 2 - 2
    return f"{data[:half].decode(errors='ignore')}...{data[-half:].decode(errors='ignore')}"


def problem_at(location: Location, key: str, message: str, suggestion: str | None = None) -> Problem:
    """A problem at a location (file, line, column); `key`: dotted key; `suggestion`: word that may have been meant."""
    return Problem(*location, key, message, suggestion)


@dataclass(frozen=True)
class Node:
    """A YAML value with its location and that of its key; `data` is a dict or list of nodes, or a plain value."""

    data: Any
    location: Location
    key_location: Location

    @property
    def is_mapping(self) -> bool:
        return isinstance(self.data, dict)

    def child(self, step: str | int) -> "Node | None":
        """The node under `step`, a key or list index; None if there is none."""
        if isinstance(self.data, dict):
            return self.data.get(step)
        if isinstance(self.data, list) and isinstance(step, int) and 0 <= step < len(self.data):
            return self.data[step]
        return None

    def plain(self) -> Any:
        """The value as dicts, lists and scalars, without locations."""
        if isinstance(self.data, dict):
            return {key: node.plain() for key, node in self.data.items()}
        if isinstance(self.data, list):
            return [node.plain() for node in self.data]
        return self.data

    def with_data(self, data: Any) -> "Node":
        """A node with other data at the same location."""
        return Node(data, self.location, self.key_location)


def node_of(data: Any, location: Location) -> Node:
    """Node for plain data (dicts, lists, arrays, scalars), all at one location; nodes inside keep theirs."""
    if isinstance(data, Node):
        return data
    if isinstance(data, dict):
        return Node({str(key): node_of(value, location) for key, value in data.items()}, location, location)
    if isinstance(data, list | tuple):
        return Node([node_of(value, location) for value in data], location, location)
    if isinstance(data, np.ndarray | np.generic):
        return node_of(data.tolist(), location)
    return Node(str(data) if isinstance(data, PurePath) else data, location, location)


def merge_nodes(below: Node, above: Node) -> Node:
    """Merge `above` over `below`: mappings key by key, at all depths; other values of `above` replace those below."""
    if not (below.is_mapping and above.is_mapping):
        return above
    data = dict(below.data)
    for key, node in above.data.items():
        data[key] = merge_nodes(data[key], node) if key in data else node
    return above.with_data(data)


def read_mapping(path: Path, name: str | None = None) -> Node:
    """Mapping (keys and values) in a YAML file; errors call the file `name`, by default its path. Raises SceneError."""
    name = name or display_path(path)
    try:
        return parse_mapping(read_text(path, MAX_TEXT_BYTES), name)
    except Unreadable as error:
        raise SceneError([problem_at(Location(name), "", error.reason)]) from None


def parse_mapping(content: str, name: str) -> Node:
    """Mapping (keys and values) in a YAML text, called `name` in errors; raises SceneError if it is anything else."""
    node = parse_yaml(content, Location(name, 1, 1))
    if node.data is None:
        raise SceneError([problem_at(Location(name, 1, 1), "", "this file is empty; a mapping was expected")])
    if not node.is_mapping:
        message = f"expected a mapping of keys to values, got {describe_value(node.data)}"
        raise SceneError([problem_at(node.location, "", message)])
    return node


def parse_setting(text: str) -> tuple[str, Node]:
    """Dotted key and value of a command-line setting `key=value`, the value parsed as YAML; raises SceneError."""
    key, equals, value = text.partition("=")
    location = Location(f"--set {text}")
    if not equals or not key.strip():
        raise SceneError([problem_at(location, "", "expected key=value, as in fluid.spacing=0.8")])
    if not value.strip():
        raise SceneError([problem_at(location, key, f"there is no value; {key}=null removes it")])
    return key.strip(), node_of(parse_yaml(value, location).plain(), location)


def parse_yaml(text: str, start: Location) -> Node:
    """Parse a YAML text into nodes; `start`: location of its first character. Raises SceneError."""
    import yaml

    try:
        tree = composed_tree(text, start, yaml_loaders())
    except yaml.MarkedYAMLError as error:
        sentence = " ".join(filter(None, [error.context, error.problem])) or "this is not YAML"
        sentence = "a tab stands where only spaces may; indent with spaces" if "'\\t'" in sentence else sentence
        location = mark_location(start, error.problem_mark or error.context_mark)
        raise SceneError([problem_at(location, "", f"not valid YAML: {sentence}")]) from None
    except yaml.reader.ReaderError as error:
        raise SceneError([unprintable_character(text, error, start)]) from None
    except (ValueError, OverflowError) as error:  # an escape of a number that no character has
        raise SceneError([problem_at(start, "", f"not valid YAML: {error}")]) from None
    if tree is None:
        return Node(None, start, start)
    reader = _Reader(start)
    node = reader.node(tree)
    if reader.problems:
        raise SceneError(reader.problems)
    return node


def mark_location(start: Location, mark: Any) -> Location:
    """Location of a PyYAML `mark` (counted from 0); `start`, the location of the text, without a mark or a file."""
    return start if start.line is None or mark is None else Location(start.file, mark.line + 1, mark.column + 1)


@cache
def yaml_loaders() -> tuple[Any, ...]:
    """PyYAML's loaders to try in turn: libyaml's (ten times as fast) if present, then the one in Python."""
    import yaml

    bases = (yaml.CBaseLoader, yaml.BaseLoader) if yaml.__with_libyaml__ else (yaml.BaseLoader,)
    return tuple(type(base.__name__, (base,), {"resolve": core_tag}) for base in bases)


def core_tag(loader: Any, kind: Any, text: str, implicit: Any) -> str:
    """YAML tag (null, bool, int, float or str) of an untagged scalar `text` by YAML 1.2's core schema; for PyYAML."""
    match = CORE_SCHEMA.fullmatch(text) if kind.id == "scalar" and implicit[0] else None
    return str(match.lastgroup) if match is not None else "str"


def composed_tree(text: str, start: Location, candidates: Sequence[Any]) -> Any:
    """PyYAML's tree of a text, by the first loader of `candidates` that succeeds; raises SceneError if too deep."""
    import yaml
    from yaml.events import CollectionEndEvent, CollectionStartEvent

    first, *others = candidates
    depth = 0
    try:
        for count, event in enumerate(yaml.parse(text, first)):
            depth += isinstance(event, CollectionStartEvent) - isinstance(event, CollectionEndEvent)
            if depth > MAX_DEPTH:
                raise SceneError([problem_at(start, "", "nested too deeply")])
            if count > MAX_EVENTS:
                raise SceneError([problem_at(start, "", f"more than {MAX_WRITTEN} values; a CSV file holds a table")])
        return yaml.compose(text, first)
    except (yaml.YAMLError, UnicodeError):
        if not others:
            raise
        return composed_tree(text, start, others)


def unprintable_character(text: str, error: Any, start: Location) -> Problem:
    """Problem that reports a character which YAML does not allow, with its location; `error`: PyYAML's ReaderError."""
    character = text[error.position : error.position + 1] or "?"
    before = text[: error.position].splitlines() or [""]
    location = start if start.line is None else Location(start.file, len(before), len(before[-1]) + 1)
    if "\udc80" <= character <= "\udcff":  # how Python keeps what a command line has that is not UTF-8
        return problem_at(location, "", f"this is not UTF-8 text (byte 0x{ord(character) - 0xDC00:02X})")
    return problem_at(location, "", f"not valid YAML: the character U+{ord(character):04X} is not allowed")


def in_yaml(value: Any) -> str:
    """A plain value (dict, list or scalar) as one line of YAML."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {in_yaml(inner)}" for key, inner in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(in_yaml, value)) + "]"
    quoted = isinstance(value, str) and (not UNQUOTED_WORD.fullmatch(value) or CORE_SCHEMA.fullmatch(value))
    return json.dumps(value, ensure_ascii=False) if quoted or value is None or isinstance(value, bool) else str(value)


def describe_value(value: Any) -> str:
    """Text on a value for messages, at most 60 characters long: of mappings and lists only the type."""
    if value is None or isinstance(value, bool):
        return in_yaml(value)
    if isinstance(value, dict):
        return "a mapping" if value else "an empty mapping"
    if isinstance(value, list):
        return "a list" if value else "an empty list"
    try:
        text = repr(value)
    except ValueError:  # Python refuses to print integers of more than 4300 digits
        return "a number too long to print"
    return text if len(text) <= 60 else f"{text[:57]}..."


class _Reader:
    """Converter of PyYAML's tree to nodes with locations; merge keys (<<) are refused, as YAML 1.2 has none."""

    def __init__(self, start: Location) -> None:
        self.start = start
        self.problems: list[Problem] = []
        self.count = 0
        self.open: set[int] = set()

    def location(self, tree: Any) -> Location:
        return mark_location(self.start, tree.start_mark)

    def refuse(self, tree: Any, key: str, message: str) -> Node:
        """Add a problem (dotted `key`, message) at a PyYAML node `tree`; returns a node without value in its place."""
        self.problems.append(problem_at(self.location(tree), key, message))
        return Node(None, self.location(tree), self.location(tree))

    def node(self, tree: Any, key: Any = None, path: str = "") -> Node:
        """Convert a PyYAML `tree` and all in it; `key`: PyYAML node of its key; `path`: dotted key for messages."""
        location = self.location(tree)
        key_location = self.location(key) if key is not None else location
        if key is not None and tree.id == "scalar" and tree.value == "":
            location = key_location  # a value that is not written stands where its key does
        self.count += 1
        if self.count > MAX_VALUES:
            raise SceneError([*self.problems, problem_at(location, path, f"more than {MAX_VALUES} values")])
        if id(tree) in self.open:
            return self.refuse(tree, path, "this alias is inside what it names")
        self.open.add(id(tree))
        data: Any
        if tree.id == "mapping":
            data = self.mapping(tree, path)
        elif tree.id == "sequence":
            data = [self.node(item, None, f"{path}.{i}".lstrip(".")) for i, item in enumerate(tree.value)]
        else:
            data = self.scalar(tree, path)
        self.open.discard(id(tree))
        return Node(data, location, key_location)

    def mapping(self, tree: Any, path: str) -> dict[str, Node]:
        """Convert a PyYAML mapping `tree` to nodes by key; keys that are not words or occur twice are refused."""
        data: dict[str, Node] = {}
        for key, value in tree.value:
            if key.id != "scalar" or not key.value.isprintable() or len(key.value) > MAX_KEY_LENGTH:
                self.refuse(key, path, "a key must be a word")
                continue
            if key.value == "<<":
                self.refuse(key, path, "merge keys (<<) are not read: YAML 1.2 has none")
                continue
            inside = f"{path}.{key.value}".lstrip(".")
            if key.value in data:
                first = data[key.value].key_location
                where = f" (first in line {first.line})" if first.line is not None else ""
                self.refuse(key, inside, f"this key is given twice{where}")
                continue
            data[key.value] = self.node(value, key, inside)
        return data

    def scalar(self, tree: Any, path: str) -> Any:
        """Convert a PyYAML scalar by its type to None, bool, int, float or text; None after a problem."""
        kind = str(tree.tag).removeprefix("tag:yaml.org,2002:")
        text = tree.value
        if kind == "null":
            return None
        if kind == "bool":
            return text.lower() == "true"
        if kind in ("int", "float"):
            digits = text.replace("_", "").lower()
            try:
                if kind == "int":
                    return int(digits, {"0x": 16, "0o": 8, "0b": 2}.get(digits.lstrip("+-")[:2], 10))
                return float(digits.replace(".inf", "inf").replace(".nan", "nan"))
            except ValueError:
                return self.refuse(tree, path, f"{describe_value(text)} is not a number that can be read").data
        if any("\ud800" <= c <= "\udfff" for c in text):
            try:  # JSON writes one character as two escapes
                text = text.encode("utf-16", "surrogatepass").decode("utf-16")
            except UnicodeDecodeError:
                return self.refuse(tree, path, "an escape that stands for half of a character").data
        if kind not in TEXT_TAGS:
            return self.refuse(tree, path, f"tags such as {tree.tag} are not read here").data
        return text
