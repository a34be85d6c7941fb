"""Waves finer than the drawn mesh: octaves of noise that tilt normals, run with the wind, and fade with distance.

Faded ripples are not lost: the variance of their slopes widens the sun's glint. `water_glsl.py` draws them.
"""

from typing import NamedTuple

import numpy as np

OCTAVE_COUNT = 5
OCTAVE_RATIO, CREST_STRETCH = 0.40, 0.62  # wavelength to wavelength; crests are longer than wavelengths
# Placement of the second noise in an octave, and shift between octaves
NOISE_TURN, NOISE_STRETCH, NOISE_SHIFT, OCTAVE_SHIFT = (0.8, 0.6), 1.13, 5.1, 13.7
PHASE_SPEED = 1.2  # [m^0.5/s] phase speed over the root of the wavelength: 1.25 in deep water
UNRESOLVED_SHARE = 0.25  # share of the variance that no octave holds
MIN_SLOPE_VARIANCE, MAX_SLOPE_VARIANCE = 0.0008, 0.035  # variances of slopes between which the drawn ones stay
MIN_VIEW_COSINE = 0.06  # cosine to the normal below which water is seen no flatter
GRADIENT_VARIANCE = 0.4204  # of the slopes of an octave of unit height and wavelength, along and across together


class Wind(NamedTuple):
    """Wind over the water that drives the ripples."""

    speed: float  # [m/s]
    angle: float  # [rad] where it goes to, from +x to +z


def value_noise(x: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Noise (n,) at points x, z (n,), smooth between random values at integer points, and its two derivatives."""
    i, j = np.floor(x), np.floor(z)
    f, g = x - i, z - j
    i, j = i.astype(np.int64), j.astype(np.int64)
    a, b, c, d = hashed_number(i, j), hashed_number(i + 1, j), hashed_number(i, j + 1), hashed_number(i + 1, j + 1)
    u, v = f**3 * (f * (f * 6.0 - 15.0) + 10.0), g**3 * (g * (g * 6.0 - 15.0) + 10.0)
    du, dv = 30.0 * f**2 * (f * (f - 2.0) + 1.0), 30.0 * g**2 * (g * (g - 2.0) + 1.0)
    k = a - b - c + d
    return a + (b - a) * u + (c - a) * v + k * u * v, du * (b - a + k * v), dv * (c - a + k * u)


def hashed_number(i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """Pseudorandom numbers, 0 to 1, for integers i, j, by an integer hash that is the same on every processor."""
    n = (i * 374761393 + j * 668265263) & 0xFFFFFFFF
    n = ((n ^ (n >> 13)) * 1274126177) & 0xFFFFFFFF
    return (n >> 16) / 65535.0
