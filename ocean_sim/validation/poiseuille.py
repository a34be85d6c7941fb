"""Water driven through a gap by a body force, from rest to the parabola (Morris, Fox & Zhu 1997)."""

from ocean_sim.validation.shared import shear
from ocean_sim.validation.shared.case import Problem


def problems(coarse: bool) -> list[Problem]:
    force = 8.0 * shear.FASTEST  # u_max = F L^2 / (8 nu)
    return [shear.problem(shear.poiseuille, "u_poiseuille", [0.0, 0.0, 0.0], force, coarse)]
