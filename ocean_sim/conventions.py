"""Units, axes and signs used everywhere in ocean_sim.

SI units and radians. World axes are right-handed: X and Z horizontal, Y up, still water at y = 0, origin at the
centre of the still surface. A ship at rest heads along +Z, so +X is to port. Rotations are positive by the right
hand: pitch about X lowers the bow, yaw about Y turns it to port, roll about Z lifts the port side.
Headings of waves and wind say where they go to: 0 along +Z, 90 degrees along +X.
"""

from typing import Literal, NamedTuple

import numpy as np

GRAVITY = 9.81  # [m/s^2]
WATER_DENSITY = 1000.0  # rest density [kg/m^3]
AIR_DENSITY = 1.225  # [kg/m^3], ICAO standard atmosphere at sea level


class Motions(NamedTuple):
    """The six motions of a ship, in the order they are logged: [m] and [rad]."""

    sway: float  # along X
    heave: float  # along Y
    surge: float  # along Z
    pitch: float  # about X
    yaw: float  # about Y
    roll: float  # about Z


Frame = Literal["ship", "ned", "flu"]

# Rows: the axes of a frame in ours (X to port, Y up, Z to the bow). All are right-handed, so what turns maps alike.
FRAMES = {
    "ship": np.eye(3),
    "ned": np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]),  # SNAME: x bow, y starboard, z down
    "flu": np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),  # ISO 8855, ROS: x bow, y port, z up
}


def to_frame(frame: Frame, vectors: np.ndarray) -> np.ndarray:
    """(..., 3) vectors, rates or vector parts of quaternions from our axes to those of a frame."""
    return np.asarray(vectors) @ FRAMES[frame].T


def from_frame(frame: Frame, vectors: np.ndarray) -> np.ndarray:
    """(..., 3) vectors, rates or vector parts of quaternions from the axes of a frame to ours."""
    return np.asarray(vectors) @ FRAMES[frame]


class Diverged(Exception):
    """A run left the physical world; the message says what, where, when and what to try."""
