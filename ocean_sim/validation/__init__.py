"""Problems with known answers: every module of this folder without a leading underscore is a case.

A case has `problems()`: set-ups to run. The scene of a set-up gives geometry, fluid, resolution and duration but no
number of a scheme; beside it stand the measurement and the tolerances of each scheme.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from ocean_sim.parts import kinds

if TYPE_CHECKING:
    from ocean_sim.validation.shared.case import Problem

FIRST_CASES = (
    "hydrostatic standing_wave standing_wave_3d dam_break_front elliptical_drop square_patch poiseuille couette "
    "taylor_green conservation wall_impact sloshing piston_flume obstacle absorbing_side imposed_sea wind_stress "
    "wind_growth wind_setup rough_channel"
).split()


def case_names() -> list[str]:
    """Names of all validation cases, those that run quickly first."""
    found = kinds("validation")
    return [name for name in FIRST_CASES if name in found] + [name for name in found if name not in FIRST_CASES]


def problems(name: str, *, slow: bool = False, coarse: bool = False) -> "list[Problem]":
    """Set-ups of the case `name` (its module). `coarse`: with at least twice the particle spacing; `slow`: include
    those that take minutes (if coarse: those too long for a regression gate)."""
    found: list[Problem] = import_module(f"{__name__}.{name}").problems(coarse)
    if coarse:
        found = [problem.coarsened(name) for problem in found]
    return [problem for problem in found if slow or not problem.slow]
