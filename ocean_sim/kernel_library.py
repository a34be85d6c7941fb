"""The one module that imports the library which compiles kernels, and hands it out as `ti`: Taichi, or its fork
Quadrants where the environment asks for it.

Taichi was last released in 2025. When it no longer installs, the fork is the way on: it compiles the same kernels. A
process computes with one of them, chosen before anything is compiled, by OCEAN_SIM_LIBRARY; a scene's `runtime.library`
has to agree with it.
"""

import os
from typing import TYPE_CHECKING

from ocean_sim.conventions import Lacking

VARIABLE, TAICHI, QUADRANTS = "OCEAN_SIM_LIBRARY", "taichi", "quadrants"
NAME = os.environ.get(VARIABLE) or TAICHI

__all__ = [
    "NAME",
    "FieldsBuilder",
    "SNodeTree",
    "ScalarField",
    "impl",
    "ti",
    "tm",
    "to_numpy_type",
]

if NAME not in (TAICHI, QUADRANTS):
    raise Lacking(
        f"{VARIABLE}: {NAME!r} is not a library that compiles kernels here; set it to {TAICHI} or {QUADRANTS}"
    )
try:
    if TYPE_CHECKING or NAME == TAICHI:
        import taichi as ti
        import taichi.math as tm
        from taichi._snode.fields_builder import FieldsBuilder
        from taichi._snode.snode_tree import SNodeTree
        from taichi.lang import impl
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
    raise Lacking(f"{VARIABLE}: {QUADRANTS} is not installed here; pip install {QUADRANTS}, or unset it") from missing
