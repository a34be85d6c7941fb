"""Water dragged along by the upper of two plates, from rest to the straight line (Morris, Fox & Zhu 1997)."""

import numpy as np

from ocean_sim.validation.poiseuille import FINAL_SPEED, SERIES_TERMS, gap_problem
from ocean_sim.validation.shared.case import Problem


def problems(coarse: bool) -> list[Problem]:
    return [gap_problem(couette_profile, [FINAL_SPEED, 0.0, 0.0], 0.0, coarse)]


def couette_profile(y: np.ndarray, time: float) -> np.ndarray:
    """Exact speed (n,) over the speed of the upper plate, at heights `y` (n,) [gap widths L] and a time [L^2 / nu]."""
    waves = np.sin(np.pi * np.outer(y, SERIES_TERMS)) * np.exp(-((SERIES_TERMS * np.pi) ** 2) * time)
    waves = waves * (-1.0) ** SERIES_TERMS / SERIES_TERMS
    return y + 2.0 / np.pi * waves.sum(axis=1)
