"""Water dragged along by the upper of two plates, from rest to the straight line (Morris, Fox & Zhu 1997)."""

from ocean_sim.validation import _shear
from ocean_sim.validation._case import Problem


def problems(coarse: bool) -> list[Problem]:
    return [_shear.problem(_shear.couette, "u_couette", [_shear.FASTEST, 0.0, 0.0], 0.0, coarse)]
