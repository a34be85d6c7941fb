"""Problems with known answers: every module of this folder without a leading underscore is a case.

A case has `problems()`: set-ups to run, each with a scene that gives geometry, fluid, resolution and duration but no
number of a scheme, what to measure, and the tolerances of each scheme.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from ocean_sim.parts import kinds

if TYPE_CHECKING:
    from ocean_sim.validation.shared.case import Problem

ORDER = (
    "hydrostatic",
    "standing_wave",
    "standing_wave_3d",
    "dam_break_front",
    "elliptical_drop",
    "square_patch",
    "poiseuille",
    "couette",
    "taylor_green",
    "conservation",
    "wall_impact",
    "sloshing",
    "piston_flume",
    "obstacle",
    "absorbing_side",
    "imposed_sea",
    "wind_stress",
    "wind_growth",
    "wind_setup",
    "rough_channel",
)


def names() -> list[str]:
    """Every case there is, the quick ones first."""
    found = kinds("validation")
    return [name for name in ORDER if name in found] + [name for name in found if name not in ORDER]


def problems(name: str, *, slow: bool = False, coarse: bool = False) -> "list[Problem]":
    """The set-ups of a case; `slow` adds those that take minutes, `coarse` takes two or more times the spacing."""
    found = [problem for problem in import_module(f"{__name__}.{name}").problems(coarse) if slow or not problem.slow]
    if not coarse:
        return found
    from ocean_sim.validation.shared.coarse import coarse as made_coarse

    return [made_coarse(name, problem) for problem in found]
