"""The one module that imports the library which compiles kernels, and hands it out as `ti`: Taichi, or its fork
Quadrants where the environment asks for it.

Taichi was last released in 2025. When it no longer installs, the fork is the way on: it compiles the same kernels. A
process computes with one of them, chosen before anything is compiled, by OCEAN_SIM_LIBRARY; a scene's `runtime.library`
has to agree with it.
"""

import inspect
import linecache
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType, ModuleType
from typing import TYPE_CHECKING

from ocean_sim.conventions import Lacking
from ocean_sim.machine import left_for_later, processor_facts

NEWEST_AMD_FAMILY = 25  # family of AMD's processors, the last that the compiler in Taichi 1.7 knows (LLVM 15)
LIBRARY_VARIABLE, TAICHI, QUADRANTS = "OCEAN_SIM_LIBRARY", "taichi", "quadrants"
LIBRARY_NAME = os.environ.get(LIBRARY_VARIABLE) or TAICHI

__all__ = [
    "LIBRARY_NAME",
    "FieldsBuilder",
    "SNodeTree",
    "ScalarField",
    "ast_transformer",
    "expr",
    "impl",
    "is_library_attribute",
    "kernel_impl",
    "knows_processor",
    "matrix_ops",
    "ti",
    "tm",
    "to_numpy_type",
]

if LIBRARY_NAME not in (TAICHI, QUADRANTS):
    raise Lacking(
        f"{LIBRARY_VARIABLE}: {LIBRARY_NAME!r} is not a library that compiles kernels here; set it to {TAICHI} or "
        f"{QUADRANTS}"
    )
if "HOME" not in os.environ:  # without which Taichi ends the process
    os.environ["HOME"] = os.path.expanduser("~")
    if os.environ["HOME"] == "~":
        raise Lacking("HOME is not set, and the system knows no folder of this user; set it: compiled kernels go there")
if (
    LIBRARY_NAME == TAICHI
):  # whose own check of its version, which nobody asks for, imports all of Python's ways to a server
    unasked = ModuleType("taichi._version_check")
    unasked.start_version_check_thread = lambda: None  # type: ignore[attr-defined]
    sys.modules.setdefault(unasked.__name__, unasked)


def _line_of(frame: FrameType, context: int = 1) -> tuple[str, int, str, list[str], int]:
    """What `inspect.getframeinfo` tells of a frame, without looking through all modules for the one that it is in."""
    code, line = frame.f_code, frame.f_lineno
    return code.co_filename, line, code.co_name, [linecache.getline(code.co_filename, line, frame.f_globals)], 0


@contextmanager
def _imported_quickly() -> Iterator[None]:
    """While Taichi is imported: it asks of each of its own functions where it is decorated, and imports dill for the
    source of functions that a person types."""
    asked = inspect.getframeinfo
    inspect.getframeinfo = _line_of  # type: ignore[assignment]
    try:
        with left_for_later("dill"):
            yield
    finally:
        inspect.getframeinfo = asked


try:
    if TYPE_CHECKING or LIBRARY_NAME == TAICHI:
        with _imported_quickly():
            import taichi as ti
            from taichi.lang import matrix_ops
        import taichi.math as tm
        from taichi._snode.fields_builder import FieldsBuilder
        from taichi._snode.snode_tree import SNodeTree
        from taichi.lang import expr, impl, kernel_impl, snode
        from taichi.lang.ast import ast_transformer
        from taichi.lang.field import ScalarField
        from taichi.lang.util import to_numpy_type
    else:
        import quadrants as ti
        import quadrants.math as tm
        from quadrants._snode.fields_builder import FieldsBuilder
        from quadrants._snode.snode_tree import SNodeTree
        from quadrants.lang import impl
        from quadrants.lang.field import ScalarField
        from quadrants.lang.util import to_numpy_type
except ModuleNotFoundError as missing:
    if missing.name != QUADRANTS:
        raise
    raise Lacking(
        f"{LIBRARY_VARIABLE}: {QUADRANTS} is not installed here; pip install {QUADRANTS}, or unset it"
    ) from missing


def knows_processor() -> bool:
    """Whether the library's compiler knows this processor. One that it does not, it takes for the first of its kind,
    which works on four numbers of single precision at once."""
    found = processor_facts()
    return (
        LIBRARY_NAME == QUADRANTS
        or found.get("vendor_id") != "AuthenticAMD"
        or int(found.get("cpu family", NEWEST_AMD_FAMILY)) <= NEWEST_AMD_FAMILY
    )


def is_library_attribute(name: str, value: object) -> bool:
    """Whether the library has put this attribute on an object of ours: the fork keeps what it has worked out there, by
    names of its own, and each method that kernels call, bound, by that of the method."""
    return LIBRARY_NAME == QUADRANTS and (
        name.startswith("_qd_") or type(value).__module__.startswith("quadrants.lang._quadrants_callable")
    )


def _untraced(stacklevel: int = 1) -> str:
    """What Taichi keeps of a field's stack of calls: nothing."""
    return ""


def _in_oriented_class(level_of_class_stackframe: int) -> bool:
    """Whether a function is decorated in the body of a class, by the line where that begins."""
    try:
        frame = sys._getframe(level_of_class_stackframe)
    except ValueError:  # a script's own function
        return False
    line = linecache.getline(frame.f_code.co_filename, frame.f_lineno, frame.f_globals).strip()
    return any(pattern.match(line) for pattern in kernel_impl._KERNEL_CLASS_STACKFRAME_STMT_RES)


if not TYPE_CHECKING and LIBRARY_NAME == TAICHI:
    # Each field took Taichi 1.7 a millisecond for the stack of calls that declared it, and each decorated function one
    # for the module it is in.
    kernel_impl._inside_class = _in_oriented_class
    impl.get_traceback = snode.get_traceback = _untraced
