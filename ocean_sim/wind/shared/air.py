"""A wind as lines and arrows, for people who look at it."""

from dataclasses import dataclass
from math import cos, sin

import numpy as np


@dataclass(frozen=True, eq=False)
class Air:
    """What is drawn of a wind."""

    edges: np.ndarray  # (n, 2, 3) ends of the lines that show where it blows [m]
    feet: np.ndarray  # (m, 3) where arrows begin [m]
    pushes: np.ndarray  # (m, 3) where they point to; length 1 is the strongest that the scene has


NONE = Air(np.zeros((0, 2, 3)), np.zeros((0, 3)), np.zeros((0, 3)))


def joined(pieces: list[Air]) -> Air:
    """All of them in one."""
    return Air(*(np.concatenate([getattr(piece, name) for piece in pieces]) for name in ("edges", "feet", "pushes")))


def turned_all(points: np.ndarray, angle: float) -> np.ndarray:
    """(..., 3) turned by `angle` [rad] about the vertical, by the right hand."""
    c, s = cos(angle), sin(angle)
    return points @ np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])
