"""Water dragged along by the upper of two plates, from rest to the straight line (Morris, Fox & Zhu 1997)."""

from ocean_sim.validation.shared import shear
from ocean_sim.validation.shared.case import Problem


def problems(coarse: bool) -> list[Problem]:
    return [shear.problem(shear.couette, "u_couette", [shear.FASTEST, 0.0, 0.0], 0.0, coarse)]
