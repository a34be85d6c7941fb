"""Save the state of a run as plain data and arrays, and restore it.

Every attribute of every object of this package that can be reached is saved, so no part can be forgotten. Taichi fields
and NumPy arrays are saved by content; an object that is reached twice is saved once. Configs, functions and types are
left out: the same scene builds them again. So are cached properties, computed again when asked for, and the names in a
class's `left_out`, which depend on a clock or belong to the process. Anything of another kind is refused with its name,
and not lost in silence.

To restore a state, the same scene is built again; objects that hold fields keep their identity, by which compiled
kernels know them, and data are created. No code of a file is run: only data classes and tuples of this package are
created, by name, without their initialisers.
"""

import dataclasses
import os
import shutil
import sys
from collections.abc import Iterable
from functools import cached_property
from inspect import get_annotations
from io import TextIOWrapper
from pathlib import Path
from types import BuiltinFunctionType, FunctionType, MethodType, ModuleType, UnionType
from typing import Any, get_args, get_origin

import numpy as np
from pydantic import BaseModel

from ocean_sim.kernel_library import is_library_attribute, ti, to_numpy_type
from ocean_sim.state.fields import FieldContents, array_shape

PACKAGE_NAME = "ocean_sim"
PLAIN_TYPES = (bool, int, float, str)
REBUILT_TYPES = (
    *(BaseModel, type, FunctionType, MethodType, BuiltinFunctionType, ModuleType, np.dtype, np.ufunc),
    ti.Matrix,  # kernels hold one as a constant
)
MISSING_VALUE = object()
NUMBER_TYPES = (int, float, np.number, np.bool_)
COMPARED_TYPES: tuple[Any, ...] = (Path, TextIOWrapper, str, NUMBER_TYPES, list, tuple, dict, range, np.ndarray)
FIELD_KEY, ARRAY_KEY, NUMBER_KEY, SAME_KEY, REBUILT_KEY = "field", "array", "number", "same", "left"
LIST_KEY, TUPLE_KEY, DICT_KEY, RANGE_KEY = "list", "tuple", "dict", "range"
FILE_KEY, PATH_KEY, OBJECT_KEY = "file", "path", "of"


class Mismatch(Exception):
    """Error: a saved state does not fit the newly built simulation; the message names the attribute."""


class FileShortened(Mismatch):
    """Error: a file of the run is missing or shorter than when the state was saved; the message is a full sentence."""


def saved_attributes(value: Any) -> dict[str, Any]:
    """Attributes of an object that are saved, by name: all but `left_out`, cached properties and those of Taichi."""
    declared: dict[str, Any] = {}
    for kind in reversed(type(value).__mro__):
        declared |= vars(kind)
    out = {name for name in vars(value) if isinstance(declared.get(name), cached_property)}  # computed again
    kept = {name: inner for name, inner in vars(value).items() if name not in {*out, *declared.get("left_out", ())}}
    return {name: inner for name, inner in kept.items() if not is_library_attribute(name, inner)}


def path_step(key: Any, number: int) -> str:
    """Path element of entry `number` in a mapping: its key if that is an identifier, else its number."""
    return key if isinstance(key, str) and key.isidentifier() else str(number)


class Snapshot:
    """Saved state of all objects reachable from `root`: a `tree` of plain data, and the `arrays` to which it refers.
    Raises TypeError at an object of an unknown kind that is not left out."""

    def __init__(self, root: Any, folder: Path, contents: FieldContents | None = None) -> None:
        """Save what can be reached from `root`, such as a simulation. `folder`: run folder, to which file names are
        relative; `contents`: reader whose kernels copy these Taichi fields, made here if None."""
        self.folder = folder
        self.arrays: dict[str, np.ndarray] = {}
        self.fields: dict[str, ti.Field] = {}
        self.seen: dict[int, tuple[str, Any]] = {}
        self.stays: set[str] = set()  # paths of what must stay itself when it is put back
        self.tree = self.node(root, "")
        self.arrays |= (contents or FieldContents()).read(self.fields)

    def node(self, value: Any, path: str) -> Any:
        """Tree node for a value at this path: the value itself if plain, else a dict whose first key names its kind."""
        if value is None or type(value) in PLAIN_TYPES:
            return value
        if isinstance(value, np.generic):
            return {NUMBER_KEY: [value.dtype.str, value.item()]}
        if isinstance(value, REBUILT_TYPES):
            return {REBUILT_KEY: type(value).__name__}
        if isinstance(value, Path):
            inside = value.is_relative_to(self.folder)
            return {PATH_KEY: value.relative_to(self.folder).as_posix()} if inside else {REBUILT_KEY: "Path"}
        if id(value) in self.seen:
            return {SAME_KEY: self.seen[id(value)][0]}
        self.seen[id(value)] = (path, value)  # and kept alive, so that its id is not reused
        self.stays.add(path)  # until it is known
        node = self.structure(value, path)
        if self.is_data(node):
            self.stays.discard(path)
        return node

    def is_data(self, node: Any) -> bool:
        """True if a tree node has only data, which are created anew, and no object that has to keep its identity."""
        if isinstance(node, list):
            return all(self.is_data(inner) for inner in node)
        if not isinstance(node, dict):
            return True
        if OBJECT_KEY in node and "at" in node:
            return node["data"]
        if SAME_KEY in node:
            return node[SAME_KEY] not in self.stays
        kept = {FIELD_KEY, REBUILT_KEY, FILE_KEY} & set(node)
        return not kept and all(self.is_data(inner) for inner in node.values())

    def structure(self, value: Any, path: str) -> Any:
        """Tree node of a container, field, array, file or object, first met at `path` from the root."""
        if isinstance(value, ti.Field):
            self.fields[path] = value
            return {FIELD_KEY: path}
        if isinstance(value, np.ndarray) and value.dtype.kind in "biufc":
            self.arrays[path] = value.copy()
            return {ARRAY_KEY: path}
        if isinstance(value, TextIOWrapper):
            value.flush()
            name = Path(value.name).relative_to(self.folder).as_posix()
            return {FILE_KEY: [name, os.fstat(value.fileno()).st_size]}
        if isinstance(value, range):
            return {RANGE_KEY: [value.start, value.stop, value.step]}
        if type(value) is list or isinstance(value, tuple):
            of = {OBJECT_KEY: class_name(value)} if hasattr(value, "_fields") else {}  # of a named tuple
            kind = LIST_KEY if type(value) is list else TUPLE_KEY
            return {kind: [self.node(inner, f"{path}.{k}") for k, inner in enumerate(value)], **of}
        if type(value) is dict:
            steps = [f"{path}.{path_step(key, k)}" for k, key in enumerate(value)]
            pairs = [[self.node(key, f"{at}.key"), self.node(value[key], at)] for key, at in zip(value, steps)]
            return {DICT_KEY: pairs}
        if is_package_object(value):
            inner = {name: self.node(each, f"{path}.{name}") for name, each in saved_attributes(value).items()}
            data = dataclasses.is_dataclass(value) and all(self.is_data(each) for each in inner.values())
            return {OBJECT_KEY: class_name(value), "at": inner, "data": data}
        raise TypeError(f"a checkpoint cannot keep {path.lstrip('.')}, a {type(value).__module__}.{class_name(value)}")


class Restorer:
    """Restores a saved state into `root`, newly built from the same scene; raises Mismatch if it does not fit. Files
    are opened in `folder`, but only `cut` shortens them to their saved length and makes deleted folders again."""

    def __init__(self, root: Any, tree: Any, arrays: dict[str, np.ndarray], folder: Path) -> None:
        """Restore the state (`tree` and `arrays` of a Snapshot) into the objects under `root`; raises Mismatch."""
        self.arrays, self.folder = arrays, folder
        self.made: dict[str, Any] = {}
        self.files: list[tuple[TextIOWrapper, int]] = []
        self.deleted: list[tuple[Path, Path]] = []  # folders as a run begins with them, and where they are to be
        self.used: dict[int, str] = {}
        self.fields: dict[str, ti.Field] = {}
        try:
            self.root = self.value(tree, root, "")
            FieldContents().write(self.fields, self.arrays)
        except Mismatch:
            raise
        except Exception as error:  # a tree that no run has written can be wrong in any way
            raise Mismatch(f"what it holds is not the state of a run ({type(error).__name__})") from error

    def cut(self) -> None:
        """Shorten files to their length when the state was saved, and make deleted folders again."""
        for begun, gone in self.deleted:
            shutil.copytree(begun, gone)
        for file, size in self.files:
            file.seek(size)
            file.truncate()

    def value(self, node: Any, fresh: Any, path: str) -> Any:
        """Value restored from a `node` of the saved tree, at `path` from the root. `fresh`, the value newly built
        there, is kept and filled if it has Taichi fields. May raise Mismatch."""
        found = self.restore_node(node, fresh, path) if isinstance(node, dict) else node
        if has_wrong_kind(found, fresh):
            raise Mismatch(f"its {path.lstrip('.')} is {found!r:.60}")
        return found

    def restore_node(self, node: Any, fresh: Any, path: str) -> Any:
        """Value restored from a dict node of the saved tree, by the method for its first key: `from_list` for `list`.
        `fresh`: the value newly built there."""
        kind = next(iter(node))
        if kind == SAME_KEY:
            return self.made[node[SAME_KEY]]
        if kind == REBUILT_KEY:
            if fresh is MISSING_VALUE:
                raise Mismatch(f"it has {path.lstrip('.')}, which this program does not make")
            return fresh
        if kind == OBJECT_KEY:
            return self.restore_object(node, fresh, path)
        self.made[path] = value = getattr(self, f"from_{kind}")(node, fresh, path)
        return value

    def from_number(self, node: Any, fresh: Any, path: str) -> Any:
        dtype, value = node[NUMBER_KEY]
        return np.dtype(dtype).type(value)

    def from_path(self, node: Any, fresh: Any, path: str) -> Path:
        """Path in the run folder, from its saved name; raises Mismatch if `fresh`, the newly built path, has another
        name. A deleted folder is made again when `cut` shortens the files."""
        found = self.folder / path_inside(node[PATH_KEY])
        if isinstance(fresh, Path) and not (fresh.is_dir() if found == self.folder else fresh.name == found.name):
            raise Mismatch(f"its {path.lstrip('.')} is {node[PATH_KEY]!r:.60}")
        if isinstance(fresh, Path) and fresh.is_dir() and not found.exists():
            self.deleted.append((fresh, found))
        return found

    def from_field(self, node: Any, fresh: Any, path: str) -> Any:
        """The newly built field `fresh`, to be filled later; raises Mismatch if its shape or type has changed."""
        values = self.arrays[node[FIELD_KEY]]
        form = values.shape, values.dtype
        if not isinstance(fresh, ti.Field) or (array_shape(fresh), to_numpy_type(fresh.dtype)) != form:
            raise Mismatch(f"its {path.lstrip('.')} has {values.shape} numbers of type {values.dtype}")
        self.fields[node[FIELD_KEY]] = fresh
        return fresh

    def from_array(self, node: Any, fresh: Any, path: str) -> np.ndarray:
        return self.arrays[node[ARRAY_KEY]]

    def from_file(self, node: Any, fresh: Any, path: str) -> TextIOWrapper:
        """Text file in the run folder, from its saved name and size, opened to go on writing in place of `fresh`, the
        newly built one; raises FileShortened if it has lost saved bytes."""
        name, size = node[FILE_KEY]
        if type(size) is not int or size < 0:
            raise Mismatch(f"{name} cannot have {size!r:.60} bytes")
        on_disk = self.folder / path_inside(name)
        if not on_disk.is_file() or on_disk.stat().st_size < size:
            raise FileShortened(f"{name} is shorter than it was when the checkpoint was made, so the run cannot go on")
        if isinstance(fresh, TextIOWrapper):
            fresh.close()
        file = on_disk.open("r+", encoding="utf-8", newline="\n")
        self.files.append((file, size))
        return file

    def from_range(self, node: Any, fresh: Any, path: str) -> range:
        return range(*node[RANGE_KEY])

    def from_list(self, node: Any, fresh: Any, path: str) -> list:
        """Restored list; or the newly built list `fresh`, so that it keeps its identity, if its items are identical."""
        new = self.restore_items(node[LIST_KEY], fresh if isinstance(fresh, list) else [], path)
        return fresh if isinstance(fresh, list) and are_same_things(new, fresh) else new

    def from_tuple(self, node: Any, fresh: Any, path: str) -> tuple:
        """Restored tuple or named tuple; or the newly built one, `fresh`, if its items are identical to those."""
        new = self.restore_items(node[TUPLE_KEY], fresh if isinstance(fresh, tuple) else (), path)
        if isinstance(fresh, tuple) and are_same_things(new, fresh):
            return fresh
        if OBJECT_KEY not in node:
            return tuple(new)
        named: Any = find_class(node[OBJECT_KEY])._make(new)  # type: ignore[attr-defined]
        for name, inner in named._asdict().items():
            self.require_declared_type(inner, type(named), name, path)
        return named

    def restore_items(self, nodes: list, fresh: Any, path: str) -> list:
        """Values restored from `nodes` of the saved tree, in a list. `fresh`: list newly built there, whose items are
        kept and filled if they have Taichi fields; `path`: of the list from the root."""
        built = [*fresh, *([MISSING_VALUE] * (len(nodes) - len(fresh)))]
        return [self.value(node, built[k], f"{path}.{k}") for k, node in enumerate(nodes)]

    def from_dict(self, node: Any, fresh: Any, path: str) -> dict:
        """Restored dict; or the newly built dict `fresh`, so that it keeps its identity, if all in it is identical."""
        new, there = {}, fresh if isinstance(fresh, dict) else {}
        for k, (key, inner) in enumerate(node[DICT_KEY]):
            name = self.value(key, MISSING_VALUE, f"{path}.{path_step(key, k)}.key")
            new[name] = self.value(inner, there.get(name, MISSING_VALUE), f"{path}.{path_step(name, k)}")
        return there if list(new) == list(there) and are_same_things(new.values(), there.values()) else new

    def restore_object(self, node: Any, fresh: Any, path: str) -> Any:
        """Restored object of this package: `fresh`, newly built, updated in place; but data, and objects of another
        class, are created anew."""
        made, data = find_class(node[OBJECT_KEY]), node["data"]
        if type(data) is not bool:
            raise Mismatch(f"its {path.lstrip('.')} is neither data nor not: {data!r:.60}")
        value = fresh if type(fresh) is made and not data else object.__new__(made)
        if self.used.setdefault(id(value), path) != path:
            both = f"{path.lstrip('.')} and {self.used[id(value)].lstrip('.')}"
            raise Mismatch(f"its {both} are one thing in this program")
        self.made[path] = value
        for name, inner in node["at"].items():
            before = vars(fresh).get(name, MISSING_VALUE) if type(fresh) is made else MISSING_VALUE
            object.__setattr__(value, name, self.value(inner, before, f"{path}.{name}"))
            self.require_declared_type(vars(value)[name], made, name, path)
        return value

    def require_declared_type(self, value: Any, made: type, name: str, path: str) -> None:
        """Raise Mismatch if the restored `value` of attribute `name` is not of the type that class `made` declares."""
        if not has_declared_type(value, get_annotations(made).get(name, object)):
            raise Mismatch(f"its {path.lstrip('.')}.{name} is {value!r:.60}")


def has_wrong_kind(found: Any, fresh: Any) -> bool:
    """True if a restored value `found` is of another kind than the new `fresh`; None may replace a string or object."""
    if fresh is None or fresh is MISSING_VALUE:
        return False
    if is_package_object(fresh):
        return not (found is None or is_package_object(found))
    kind = next((kind for kind in COMPARED_TYPES if isinstance(fresh, kind)), object)
    return not isinstance(found, kind) and not (found is None and kind is str)


def has_declared_type(value: Any, declared: Any) -> bool:
    """True if a value is of a declared type; types given as text, protocols and Any allow every value."""
    if get_origin(declared) is UnionType:
        return any(has_declared_type(value, one) for one in get_args(declared))
    if get_origin(declared) is tuple and get_args(declared)[-1] is ...:
        return isinstance(value, tuple) and all(has_declared_type(one, get_args(declared)[0]) for one in value)
    kind = NUMBER_TYPES if declared in (int, float, bool) else get_origin(declared) or declared
    return isinstance(value, kind) if kind is NUMBER_TYPES or type(kind) is type else True


def is_package_object(value: Any) -> bool:
    """True if a value is an object of this package that has attributes."""
    return type(value).__module__.split(".")[0] == PACKAGE_NAME and hasattr(value, "__dict__")


def are_same_things(new: Iterable[Any], fresh: Iterable[Any]) -> bool:
    """True if two sequences hold identical objects in the same order."""
    a, b = list(new), list(fresh)
    return len(a) == len(b) and all(one is other for one, other in zip(a, b))


def class_name(value: Any) -> str:
    """Name of the class of a value, as `module:name`."""
    return f"{type(value).__module__}:{type(value).__qualname__}"


def find_class(name: str) -> type:
    """Class of this package by its `module:name`; raises Mismatch if its module is not imported or lacks it."""
    module, _, qualified = name.partition(":")
    found: Any = sys.modules.get(module) if module.split(".")[0] == PACKAGE_NAME else None
    for step in qualified.split("."):
        found = vars(found).get(step) if found is not None else None
    if not isinstance(found, type):
        raise Mismatch(f"it has a {name}, which this program does not make")
    return found


def path_inside(name: str) -> Path:
    """Convert text to a relative path; raises Mismatch if absolute or with "..", and so able to leave its folder."""
    path = Path(name)
    if path.is_absolute() or ".." in path.parts:
        raise Mismatch(f"it names a file outside its folder: {name}")
    return path
