"""Waves finer than the drawn mesh: octaves of noise that tilt normals, run with the wind, and fade with distance.

What fades is not lost: the variance of its slopes widens the sun's glint. NumPy is the reference of `water_glsl.py`.
"""

from typing import NamedTuple

import numpy as np

OCTAVES = 5
LACUNARITY, ACROSS = 0.40, 0.62  # wavelength to wavelength; crests are longer than wavelengths
TURN, STRETCH, SHIFT, STEP = (0.8, 0.6), 1.13, 5.1, 13.7  # of the second noise in an octave, and between octaves
SPEED = 1.2  # [m^0.5/s] phase speed over the root of the wavelength: 1.25 in deep water
UNRESOLVED = 0.25  # share of the variance that no octave holds
SMOOTHEST, SHARPEST = 0.0008, 0.035  # variances of slopes between which the drawn ones stay
FLATTEST = 0.06  # cosine to the normal below which water is seen no flatter
GRADIENT_VARIANCE = 0.4204  # of the slopes of an octave of unit height and wavelength, along and across together


class Wind(NamedTuple):
    """Wind over the water, as ripples follow it."""

    speed: float  # [m/s]
    angle: float  # [rad] where it goes to, from +x to +z


def noise(x: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Random values at integer points, smooth between them, and their derivatives."""
    i, j = np.floor(x), np.floor(z)
    f, g = x - i, z - j
    i, j = i.astype(np.int64), j.astype(np.int64)
    a, b, c, d = chance(i, j), chance(i + 1, j), chance(i, j + 1), chance(i + 1, j + 1)
    u, v = f**3 * (f * (f * 6.0 - 15.0) + 10.0), g**3 * (g * (g * 6.0 - 15.0) + 10.0)
    du, dv = 30.0 * f**2 * (f * (f - 2.0) + 1.0), 30.0 * g**2 * (g * (g - 2.0) + 1.0)
    k = a - b - c + d
    return a + (b - a) * u + (c - a) * v + k * u * v, du * (b - a + k * v), dv * (c - a + k * u)


def chance(i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """A number from 0 to 1 for whole i, j: integers hashed, so that every processor finds the same."""
    n = (i * 374761393 + j * 668265263) & 0xFFFFFFFF
    n = ((n ^ (n >> 13)) * 1274126177) & 0xFFFFFFFF
    return (n >> 16) / 65535.0


def slopes(
    x: np.ndarray, z: np.ndarray, time: float, footprint: np.ndarray, wind: Wind, longest: float, variance: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Slopes along x and z, and the variance along each axis of those that are finer than the footprint [m] of a pixel.

    `longest`: wavelength of the first octave [m]; `variance`: of all slopes, both axes together.
    """
    cos, sin = np.cos(wind.angle), np.sin(wind.angle)
    steep = np.sqrt((1.0 - UNRESOLVED) * variance / (OCTAVES * GRADIENT_VARIANCE))
    slope_x, slope_z = np.zeros(np.shape(x)), np.zeros(np.shape(x))
    lost = np.full(np.shape(x), UNRESOLVED * variance)
    for octave in range(OCTAVES):
        wave = longest * LACUNARITY**octave
        fade = np.clip((wave / footprint - 2.0) / 4.0, 0.0, 1.0)
        along = (x * cos + z * sin) / wave + STEP * octave - time * SPEED / np.sqrt(wave)
        across = ACROSS * (z * cos - x * sin) / wave + STEP * octave
        _, a, b = noise(along, across)
        turned = TURN[0] * along - TURN[1] * across, TURN[1] * along + TURN[0] * across
        _, c, d = noise(STRETCH * turned[0] + SHIFT, STRETCH * turned[1] + SHIFT)
        down = a + 0.8 * (TURN[0] * c + TURN[1] * d)
        across = ACROSS * (b + 0.8 * (TURN[0] * d - TURN[1] * c))
        slope_x += fade * steep * (down * cos - across * sin)
        slope_z += fade * steep * (down * sin + across * cos)
        lost += (1.0 - fade**2) * (1.0 - UNRESOLVED) * variance / OCTAVES
    return slope_x, slope_z, 0.5 * lost


def lengthened(footprint: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    """The footprint [m] by which ripples fade, of pixels whose sides are that long in the geometric mean: water that is
    seen flat, by its cosine to the normal, is longer in a pixel than it is broad, and ripples across the view would
    leave streaks and grain on the crests of waves."""
    return footprint * np.maximum(cosine, FLATTEST) ** -0.25


def tilted(normal: np.ndarray, slope_x: np.ndarray, slope_z: np.ndarray) -> np.ndarray:
    """Normals (n, 3) of a surface with these slopes on top of its own."""
    up = np.maximum(normal[:, 1], 0.1)
    steeper = np.stack([normal[:, 0] / up - slope_x, np.ones(len(up)), normal[:, 2] / up - slope_z], axis=1)
    return steeper / np.linalg.norm(steeper, axis=1, keepdims=True)
