"""Colour of water as seen from an eye, at nodes of its surface, and the constants of equations (3.6) to (3.16), which
`water_glsl.py` evaluates at each pixel. Directions are unit vectors (n, 3), y up; colours are linear RGB (n, 3);
cosines and shares are (n,)."""

import numpy as np

from ocean_sim.pictures.stage import sky as sky_module
from ocean_sim.pictures.stage.sky import HORIZON_COLOUR, SUN_DIRECTION, SUNLIGHT_COLOUR, unit_vector

REFRACTIVE_INDEX = 1.333
NODE_ROUGHNESS = 0.004  # variance of slopes finer than the mesh
DEEP_LIGHT = np.array([0.004, 0.030, 0.050])  # light that returns from the depth, linear RGB
CREST_LIGHT = np.array([0.020, 0.160, 0.150])  # light through thin water
SIDE_LIGHT = np.array([0.020, 0.210, 0.260])  # the cut side of the water, at the top

MAP_COLOURS = np.array([[0.004, 0.030, 0.075], [0.030, 0.150, 0.230], [0.420, 0.620, 0.620]])  # trough, rest, peak
MAP_LIGHT, MAP_SLOPE = unit_vector(np.array([-0.55, 0.62, -0.55])), 0.35  # where its light is; deviation of its slopes
MAP_STEEPEST = 0.45  # slope that none of them reaches

BODY_LIGHT = np.array([0.0036, 0.0200, 0.0350])  # light from the depth of the sea under a sky of radiance 1
THIN_LIGHT = np.array([0.010, 0.085, 0.088])  # light that comes through crests
# Light that comes back from water full of bubbles, below and between foam
BUBBLE_LIGHT = np.array([0.024, 0.120, 0.132])
FOAM_REFLECTANCE = np.array([0.70, 0.75, 0.78])  # reflectance of foam
THIN_FOAM_REFLECTANCE = np.array([0.30, 0.43, 0.50])  # of a film of bubbles, through which the water shows
# Smaller copies of the sky over the roughness of water that mirrors it, and at most
BLUR_LEVELS, MAX_BLUR_LEVEL = 26.0, 5.5
MAX_MIRRORED = 12.0  # to which the mirrored sky is cut: no single pixel burns
HDR_THRESHOLD, HDR_EXCESS, HDR_FACTOR = 0.9, 0.6, 3.0  # of (3.16); the thesis's 100 is meant for a sky of at most 1
SUN_STRENGTH = 1.6  # of the drawn sun over its colour
SEA_EXPOSURE = 0.60
TANK_EXPOSURE = 1.15  # of water in a tank, as of what is drawn with plain colours
FOG_DISTANCE = 6000.0  # [m] in which the air takes 1 - 1/e of a colour
FOG_END = 1.2, 2.2  # [of that] between which the sea ends in the horizon's colour
# Ripples, finer than the drawn mesh: octaves of noise tilt normals, run with the wind, and fade with distance; the
# variance of faded slopes widens the sun's glint.
OCTAVE_COUNT = 5
OCTAVE_RATIO, CREST_STRETCH = 0.40, 0.62  # wavelength to wavelength; crests are longer than wavelengths
# Placement of the second noise in an octave, and shift between octaves
NOISE_TURN, NOISE_STRETCH, NOISE_SHIFT, OCTAVE_SHIFT = (0.8, 0.6), 1.13, 5.1, 13.7
PHASE_SPEED = 1.2  # [m^0.5/s] phase speed over the root of the wavelength: 1.25 in deep water
UNRESOLVED_SHARE = 0.25  # share of the variance that no octave holds
MIN_SLOPE_VARIANCE, MAX_SLOPE_VARIANCE = 0.0008, 0.035  # variances of slopes between which the drawn ones stay
MIN_VIEW_COSINE = 0.06  # cosine to the normal below which water is seen no flatter
GRADIENT_VARIANCE = 0.4204  # of the slopes of an octave of unit height and wavelength, along and across together


def refracted_cosine(cos_incident: np.ndarray, n: float = REFRACTIVE_INDEX) -> np.ndarray:
    """Cosine (n,) of the refraction angle in water for this cosine of the angle of incidence, by Snell's law (3.7)."""
    return np.sqrt(1.0 - (1.0 - np.asarray(cos_incident) ** 2) / n**2)


def fresnel(cos_incident: np.ndarray, n: float = REFRACTIVE_INDEX) -> np.ndarray:
    """Share (n,) of unpolarised light that water reflects (3.8), for this cosine of the angle of incidence."""
    cos_refracted = refracted_cosine(cos_incident, n)
    across = (cos_incident - n * cos_refracted) / (cos_incident + n * cos_refracted)
    along = (n * cos_incident - cos_refracted) / (n * cos_incident + cos_refracted)
    return 0.5 * (across**2 + along**2)


def beckmann(cos_half: np.ndarray, variance: np.ndarray) -> np.ndarray:
    """Density of facets that mirror the sun into the eye, for normally distributed slopes of this variance along each
    axis (Beckmann & Spizzichino 1963); `cos_half`: cosine between normal and the direction halfway from sun to eye."""
    c2 = np.maximum(cos_half, 1.0e-3) ** 2
    return np.exp(-(1.0 - c2) / (c2 * 2.0 * variance)) / (2.0 * np.pi * variance * c2**2)


def slope_variance(wind_speed: float) -> float:
    """Slope variance of the sea, along plus across the wind, for a wind speed [m/s] at 12.5 m (Cox & Munk 1954, J. Opt.
    Soc. Am. 44, clean surface)."""
    return 0.003 + 0.00512 * wind_speed


def surface_light(position: np.ndarray, normal: np.ndarray, height: np.ndarray, eye: np.ndarray) -> np.ndarray:
    """Linear RGB (n, 3) of surface points (n, 3) [m] with normals (n, 3) for an eye (3,) [m]; `height` (n,): -1 in a
    trough, 0 at rest, 1 on a crest."""
    to_eye = unit_vector(eye - position)
    facing = np.maximum((to_eye * normal).sum(axis=1), 0.0)
    cosine = np.sqrt(facing**2 + NODE_ROUGHNESS)  # ripples keep a rough sea from mirroring fully at grazing angles
    share = fresnel(np.minimum(cosine, 1.0))[:, None]
    mirrored = 2.0 * facing[:, None] * normal - to_eye
    mirrored[:, 1] = np.abs(mirrored[:, 1]) + 0.02
    sky = np.minimum(sky_module.clear_sky(unit_vector(mirrored)), 1.5)
    lit = np.clip(normal @ SUN_DIRECTION, 0.0, 1.0)[:, None]
    thin = np.clip(0.5 + 0.5 * height, 0.0, 1.0)[:, None] ** 1.5
    inside = DEEP_LIGHT * (0.7 + 0.9 * lit) + CREST_LIGHT * thin * (0.15 + 0.85 * lit)
    return inside * (1.0 - share) + sky * share + SUNLIGHT_COLOUR * sun_glint(normal, to_eye, cosine)[:, None]


def sun_glint(normal: np.ndarray, to_eye: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    """Brightness (n,) of the sun's glint, relative to the sun, from facets with normally distributed slopes. `to_eye`:
    unit directions; `cosine` (n,): between normal and `to_eye`, softened by roughness."""
    half = unit_vector(SUN_DIRECTION + to_eye)
    share = fresnel(np.clip((half * to_eye).sum(axis=1), 0.0, 1.0))
    facets = beckmann((half * normal).sum(axis=1), np.full(len(half), NODE_ROUGHNESS))
    return np.minimum(0.6 * facets * share / (4.0 * np.maximum(cosine, 0.12)), 3.0)


def side_light(position: np.ndarray, normal: np.ndarray, depth: np.ndarray, eye: np.ndarray) -> np.ndarray:
    """Linear RGB (n, 3) of points on a cut side, arguments as in `surface_light`; `depth` (n,): 0 at top, 1 at bed."""
    to_eye = unit_vector(eye - position)
    facing = np.clip((to_eye * normal).sum(axis=1), 0.0, 1.0)
    share = fresnel(facing)[:, None]
    lit = 0.55 + 0.45 * np.clip(normal @ unit_vector(SUN_DIRECTION * [1.0, 0.0, 1.0]), -0.4, 1.0)[:, None]
    inside = DEEP_LIGHT * 0.5 + SIDE_LIGHT * np.exp(-3.2 * depth[:, None]) * lit
    return inside * (1.0 - share) + 0.35 * HORIZON_COLOUR * share


def relief_light(normal: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Linear RGB (n, 3) of a surface with normals (n, 3) as a relief map: dark troughs, pale crests, lit from the upper
    left. Slopes are exaggerated, up to a limit; `height` (n,): -1 in a trough, 0 at rest, 1 on a crest."""
    slope = -normal[:, [0, 2]] / normal[:, 1:2]
    slope *= MAP_SLOPE / max(float(slope.std()), 1e-3 * MAP_SLOPE)
    slope /= np.hypot(1.0, np.linalg.norm(slope, axis=1, keepdims=True) / MAP_STEEPEST)
    tilted = unit_vector(np.stack([-slope[:, 0], np.ones(len(slope)), -slope[:, 1]], axis=1))
    lit = np.clip(tilted @ MAP_LIGHT, 0.0, 1.0)[:, None]
    return colour_scale(0.5 + 0.5 * height, MAP_COLOURS) * (0.25 + 1.1 * lit)


def colour_scale(share: np.ndarray, colours: np.ndarray) -> np.ndarray:
    """Colours (n, 3) at each `share` (n,), 0 to 1, of a scale of evenly spaced colours (k, 3), linear between them."""
    at = np.linspace(0.0, 1.0, len(colours))
    return np.stack([np.interp(share, at, channel) for channel in colours.T], axis=1)


def filmic_curve(radiance: np.ndarray, exposure: float = 1.15) -> np.ndarray:
    """Display RGB, 0 to 1, of linear RGB `radiance` times `exposure` (Narkowicz 2015, fit to ACES; gamma 2.2)."""
    c = np.maximum(radiance, 0.0) * exposure
    curve = c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14)
    return np.clip(curve, 0.0, 1.0) ** (1.0 / 2.2)


def display_colours(radiance: np.ndarray, exposure: float = 1.15) -> np.ndarray:
    """Display RGB, 8-bit, of linear RGB `radiance` times `exposure` (see `filmic_curve`)."""
    return (255.0 * filmic_curve(radiance, exposure) + 0.5).astype(np.uint8)
