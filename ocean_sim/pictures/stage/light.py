"""The light of sun and sky on paint, for what is drawn with plain colours."""

import numpy as np

from ocean_sim.pictures.stage import sky

SUNSHINE = np.array([0.80, 0.74, 0.64])  # on a face that looks into the sun, linear RGB
FROM_ABOVE = np.array([0.40, 0.46, 0.54])  # light of the sky on a level face
FROM_BELOW = np.array([0.12, 0.16, 0.18])  # light that the water throws back
MIRRORED = np.array([0.30, 0.42, 0.56])  # of the sky, in panes


def painted_light(normals: np.ndarray, paint: np.ndarray, gloss: np.ndarray) -> np.ndarray:
    """Linear RGB (n, 3) of paint in sun and sky; panes show the sky above instead."""
    sun = np.clip(normals @ sky.SUN, 0.0, 1.0)[:, None]
    above = 0.5 + 0.5 * normals[:, 1:2]
    ambient = FROM_BELOW + (FROM_ABOVE - FROM_BELOW) * above
    facing = 0.35 + 0.65 * np.clip(1.0 - np.abs(normals @ sky.SUN), 0.0, 1.0)[:, None]
    return paint * (SUNSHINE * sun + ambient) + 0.12 * gloss * MIRRORED * facing
