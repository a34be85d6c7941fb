"""Units, axes and signs used everywhere in ocean_sim.

SI units and radians. World axes are right-handed: X and Z horizontal, Y up, still water at y = 0, origin at the
centre of the still surface. A ship at rest heads along +Z, so +X is to port. Rotations are positive by the right
hand: pitch about X lowers the bow, yaw about Y turns it to port, roll about Z lifts the port side.
Headings of waves and wind say where they go to: 0 along +Z, 90 degrees along +X.
"""

from typing import NamedTuple

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


class Diverged(Exception):
    """A run left the physical world; the message says what, where, when and what to try."""
