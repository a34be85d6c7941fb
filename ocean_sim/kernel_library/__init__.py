"""Import of the library that compiles kernels, as `ti`: Taichi, or its fork Quadrants if the environment asks for it.

No other module imports either. Taichi was last released in 2025; when it no longer installs, the fork is the way on: it
compiles the same kernels. A process computes with one of them, chosen before anything is compiled, by
OCEAN_SIM_LIBRARY; a scene's `runtime.library` has to agree with it.
"""

# ruff: noqa: F401 (names that other modules take from here)
import os
import sys
from types import ModuleType
from typing import TYPE_CHECKING

from ocean_sim.conventions import Lacking
from ocean_sim.machine import processor_facts

NEWEST_AMD_FAMILY = 25  # of processors, that the compiler in Taichi 1.7 knows (LLVM 15)
LIBRARY_VARIABLE, TAICHI, QUADRANTS = "OCEAN_SIM_LIBRARY", "taichi", "quadrants"
LIBRARY_NAME = os.environ.get(LIBRARY_VARIABLE) or TAICHI

if LIBRARY_NAME not in (TAICHI, QUADRANTS):
    unknown = f"{LIBRARY_VARIABLE}: {LIBRARY_NAME!r} is not a library that compiles kernels here"
    raise Lacking(f"{unknown}; set it to {TAICHI} or {QUADRANTS}")
if "HOME" not in os.environ:  # without it Taichi ends the process
    os.environ["HOME"] = os.path.expanduser("~")
    if os.environ["HOME"] == "~":
        raise Lacking("HOME is not set, and the system knows no folder of this user; set it: compiled kernels go there")
if LIBRARY_NAME == TAICHI:  # its check for a newer version would import urllib and ask a server
    no_version_check = ModuleType("taichi._version_check")
    no_version_check.start_version_check_thread = lambda: None  # type: ignore[attr-defined]
    sys.modules.setdefault(no_version_check.__name__, no_version_check)

try:
    if TYPE_CHECKING or LIBRARY_NAME == TAICHI:
        import taichi as ti
        import taichi.math as tm
        from taichi._snode.fields_builder import FieldsBuilder
        from taichi._snode.snode_tree import SNodeTree
        from taichi.lang import impl, kernel_impl, matrix_ops
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
    cure = f"pip install {QUADRANTS}, or unset it"
    raise Lacking(f"{LIBRARY_VARIABLE}: {QUADRANTS} is not installed here; {cure}") from missing


def knows_processor() -> bool:
    """True if the compiler knows this processor; else it compiles for a generic one, with vectors of four f32."""
    facts = processor_facts()
    family = int(facts.get("cpu family", NEWEST_AMD_FAMILY))
    return LIBRARY_NAME == QUADRANTS or facts.get("vendor_id") != "AuthenticAMD" or family <= NEWEST_AMD_FAMILY


def is_library_attribute(name: str, value: object) -> bool:
    """True if attribute `name` of one of our objects is a result or bound kernel that the fork Quadrants put there."""
    return LIBRARY_NAME == QUADRANTS and (
        name.startswith("_qd_") or type(value).__module__.startswith("quadrants.lang._quadrants_callable")
    )
