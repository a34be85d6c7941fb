"""A wind as lines and arrows, for pictures."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Drawing:
    """Lines and arrows of a wind."""

    lines: np.ndarray  # (n, 2, 3) ends of the lines that show where it blows [m]
    tails: np.ndarray  # (m, 3) where arrows begin [m]
    arrows: np.ndarray  # (m, 3) along what the wind does there; length 1 is the strongest that the scene has
    strongest: float = 0.0  # that, in its unit; 0 where arrows show nothing, or not all the same
    unit: str = ""  # of what arrows show


NOTHING = Drawing(np.zeros((0, 2, 3)), np.zeros((0, 3)), np.zeros((0, 3)))


def joined(drawings: list[Drawing]) -> Drawing:
    """Join drawings into one."""
    alike = len({drawing.unit for drawing in drawings}) == 1
    return Drawing(
        lines=np.concatenate([drawing.lines for drawing in drawings]),
        tails=np.concatenate([drawing.tails for drawing in drawings]),
        arrows=np.concatenate([drawing.arrows for drawing in drawings]),
        strongest=drawings[0].strongest if alike else 0.0,
        unit=drawings[0].unit if alike else "",
    )
