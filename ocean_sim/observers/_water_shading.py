"""The colour of water seen from an eye: exact Fresnel, the mirrored sky, sun glint, light from inside (3.6 to 3.16)."""

import numpy as np

from ocean_sim.observers import _sky
from ocean_sim.observers._sky import HORIZON, SUN, SUNLIGHT, unit

REFRACTIVE_INDEX = 1.333
ROUGHNESS = 0.004  # variance of slopes finer than the mesh
DEEP = np.array([0.004, 0.030, 0.050])  # light that returns from the depth, linear RGB
CREST = np.array([0.020, 0.160, 0.150])  # light through thin water
GLASS = np.array([0.020, 0.210, 0.260])  # the cut side of the water, at the top


def fresnel(cos_incident: np.ndarray, n: float = REFRACTIVE_INDEX) -> np.ndarray:
    """Reflected share of unpolarised light (3.8), in cosines: no division of zero by zero at normal incidence."""
    cos_refracted = np.sqrt(1.0 - (1.0 - cos_incident**2) / n**2)
    across = (cos_incident - n * cos_refracted) / (cos_incident + n * cos_refracted)
    along = (n * cos_incident - cos_refracted) / (n * cos_incident + cos_refracted)
    return 0.5 * (across**2 + along**2)


def surface(position: np.ndarray, normal: np.ndarray, height: np.ndarray, eye: np.ndarray) -> np.ndarray:
    """Linear RGB (n, 3) of points of the surface; `height` is -1 in a trough, 0 at rest, 1 on a crest."""
    to_eye = unit(eye - position)
    facing = np.maximum((to_eye * normal).sum(axis=1), 0.0)
    cosine = np.sqrt(facing**2 + ROUGHNESS)  # ripples keep a rough sea from mirroring fully at grazing angles
    share = fresnel(np.minimum(cosine, 1.0))[:, None]
    mirrored = 2.0 * facing[:, None] * normal - to_eye
    mirrored[:, 1] = np.abs(mirrored[:, 1]) + 0.02
    reflected = np.minimum(_sky.colour(unit(mirrored)), 1.5)
    lit = np.clip(normal @ SUN, 0.0, 1.0)[:, None]
    thin = np.clip(0.5 + 0.5 * height, 0.0, 1.0)[:, None] ** 1.5
    inside = DEEP * (0.7 + 0.9 * lit) + CREST * thin * (0.15 + 0.85 * lit)
    return inside * (1.0 - share) + reflected * share + SUNLIGHT * glint(normal, to_eye, cosine)[:, None]


def glint(normal: np.ndarray, to_eye: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    """The sun mirrored by facets with normally distributed slopes (Beckmann)."""
    half = unit(SUN + to_eye)
    c2 = np.maximum((half * normal).sum(axis=1), 1.0e-3) ** 2
    facets = np.exp(-(1.0 - c2) / (c2 * 2.0 * ROUGHNESS)) / (2.0 * np.pi * ROUGHNESS * c2**2)
    share = fresnel(np.clip((half * to_eye).sum(axis=1), 0.0, 1.0))
    return np.minimum(0.6 * facets * share / (4.0 * np.maximum(cosine, 0.12)), 3.0)


def side(position: np.ndarray, normal: np.ndarray, depth: np.ndarray, eye: np.ndarray) -> np.ndarray:
    """Linear RGB (n, 3) of the cut side of the water, as through glass; `depth` is 0 at the surface, 1 at the bed."""
    to_eye = unit(eye - position)
    facing = np.clip((to_eye * normal).sum(axis=1), 0.0, 1.0)
    share = fresnel(facing)[:, None]
    lit = 0.55 + 0.45 * np.clip(normal @ unit(SUN * [1.0, 0.0, 1.0]), -0.4, 1.0)[:, None]
    inside = DEEP * 0.5 + GLASS * np.exp(-3.2 * depth[:, None]) * lit
    return inside * (1.0 - share) + 0.35 * HORIZON * share


def display(radiance: np.ndarray, exposure: float = 1.15) -> np.ndarray:
    """Linear RGB -> 8-bit sRGB-like colour: a filmic curve (Narkowicz 2015, fit to ACES), then gamma 2.2."""
    c = np.maximum(radiance, 0.0) * exposure
    curve = c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14)
    return (255.0 * np.clip(curve, 0.0, 1.0) ** (1.0 / 2.2) + 0.5).astype(np.uint8)
