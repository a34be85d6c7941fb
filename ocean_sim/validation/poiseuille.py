"""Water driven through a gap by a body force, from rest to the parabola (Morris, Fox & Zhu 1997)."""

from ocean_sim.validation import _shear
from ocean_sim.validation._case import Problem


def problems(coarse: bool) -> list[Problem]:
    force = 8.0 * _shear.FASTEST  # u_max = F L^2 / (8 nu)
    return [_shear.problem(_shear.poiseuille, "u_poiseuille", [0.0, 0.0, 0.0], force, coarse)]
