"""The sky above the water: a clear gradient, brighter and warmer around the sun. Colours are linear RGB."""

import numpy as np


def unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


SUN = unit(np.array([-0.86, 0.50, -0.36]))  # direction to the sun
SUNLIGHT = np.array([1.0, 0.86, 0.66])
ZENITH = np.array([0.035, 0.14, 0.42])
HORIZON = np.array([0.42, 0.66, 0.92])
HAZE = np.array([0.72, 0.74, 0.74])  # at the horizon below the sun
GROUND = np.array([0.13, 0.16, 0.19])  # what lies around the basin, straight down


def colour(direction: np.ndarray) -> np.ndarray:
    """Radiance of the sky in unit directions (n, 3); the horizon's below it."""
    up = np.clip(direction[:, 1], 0.0, 1.0)[:, None]
    towards = np.clip(direction @ SUN, 0.0, 1.0)[:, None]
    low = (1.0 - up) ** 20
    clear = ZENITH + (HORIZON - ZENITH) * (0.3 * (1.0 - up) ** 3 + 0.7 * low)
    return clear + (HAZE - HORIZON) * low * towards**3 + SUNLIGHT * (0.22 * towards**12 + 0.5 * towards**220)


def around(direction: np.ndarray) -> np.ndarray:
    """The sky, and below the horizon a quiet ground that darkens downwards; for the background."""
    down = np.clip(-direction[:, 1], 0.0, 1.0)[:, None]
    flat = unit(np.column_stack([direction[:, 0], np.zeros(len(direction)), direction[:, 2]]))
    ground = GROUND + (0.72 * colour(flat) - GROUND) * np.exp(-down / 0.22)
    return np.where(direction[:, 1:2] >= 0.0, colour(direction), ground)
