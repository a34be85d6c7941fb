"""Closed forms of pressure, orbits and drift by linear theory (Dean & Dalrymple 1991, chapters 4 and 10)."""

import numpy as np

from ocean_sim.conventions import GRAVITY
from ocean_sim.waves import Components, Values, angular_frequency, elevation, pressure_head, stretched_height


def pressure(sea: Components, points: np.ndarray, time: float, density: float) -> np.ndarray:
    """(m,) pressure [Pa] of the stretched column at points (m, 3): hydrostatic and that of the waves; 0 above."""
    eta = elevation(sea, points, time)
    below = np.stack([points[:, 0], stretched_height(sea, points, eta), points[:, 2]], axis=1)
    head = pressure_head(sea, below, time) - points[:, 1]
    return np.where(points[:, 1] < eta, density * sea.gravity * head, 0.0)


def orbit_ratio(k: float, y: Values, depth: float) -> np.ndarray:
    """Height over length of the orbits at a level y [m] below the still surface, on water of this depth [m]."""
    return np.tanh(k * (np.asarray(y) + depth))


def orbit_sizes(amplitude: float, k: float, y: Values, depth: float) -> tuple[np.ndarray, np.ndarray]:
    """Half length and half height [m] of the orbits under a wave of this amplitude [m]: they fall with depth."""
    above = k * (np.asarray(y) + depth)
    return amplitude * np.cosh(above) / np.sinh(k * depth), amplitude * np.sinh(above) / np.sinh(k * depth)


def stokes_drift(amplitude: float, k: float, y: Values, depth: float, gravity: float = GRAVITY) -> np.ndarray:
    """Mean velocity [m/s] of the particles along the waves (Stokes 1847): a^2 w k cosh 2k(y+h) / (2 sinh^2 kh)."""
    above, omega = k * (np.asarray(y) + depth), angular_frequency(k, depth, gravity)
    return amplitude**2 * omega * k * np.cosh(2.0 * above) / (2.0 * np.sinh(k * depth) ** 2)
