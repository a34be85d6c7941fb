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
    """The set-ups of a case; `coarse` takes two or more times the spacing, `slow` adds those that take minutes, and of
    coarse ones those that a gate has no time for."""
    found: list[Problem] = import_module(f"{__name__}.{name}").problems(coarse)
    if coarse:
        from ocean_sim.validation.shared.coarse import coarse as made_coarse

        found = [made_coarse(name, problem) for problem in found]
    return [problem for problem in found if slow or not problem.slow]
