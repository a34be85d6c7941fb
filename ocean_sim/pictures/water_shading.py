"""The colour of water seen from an eye: each term of (3.6) to (3.16) a function, and their sum as Algorithm 6 has it.

NumPy is the reference; `water_glsl.py` is the same for a graphics processor and is tested against it. Directions are
unit vectors (n, 3), y up; colours are linear RGB (n, 3); cosines and shares are (n,).
"""

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from ocean_sim.pictures import sky as sky_module
from ocean_sim.pictures.ripples import tilted
from ocean_sim.pictures.sky import HORIZON, SUN, SUNLIGHT, Sky, unit

REFRACTIVE_INDEX = 1.333
ROUGHNESS = 0.004  # variance of slopes finer than the mesh
DEEP = np.array([0.004, 0.030, 0.050])  # light that returns from the depth, linear RGB
CREST = np.array([0.020, 0.160, 0.150])  # light through thin water
GLASS = np.array([0.020, 0.210, 0.260])  # the cut side of the water, at the top

TROUGH, REST, PEAK = np.array([[0.004, 0.030, 0.075], [0.030, 0.150, 0.230], [0.420, 0.620, 0.620]])  # of the map
MAP_LIGHT, MAP_SLOPE = unit(np.array([-0.55, 0.62, -0.55])), 0.35  # where its light is; deviation of its slopes
MAP_STEEPEST = 0.45  # slope that none of them reaches

BODY = np.array([0.0036, 0.0200, 0.0350])  # light from the depth of the sea under a sky of radiance 1
THIN = np.array([0.010, 0.085, 0.088])  # light that comes through crests
BUBBLES = np.array([0.024, 0.120, 0.132])  # light that comes back from water full of bubbles, below and between foam
FOAM = np.array([0.70, 0.75, 0.78])  # reflectance of foam
THIN_FOAM = np.array([0.30, 0.43, 0.50])  # of a film of bubbles, through which the water shows
BLURS, MOST_BLURRED = 26.0, 5.5  # smaller copies of the sky over the roughness of water that mirrors it, and at most
BRIGHTEST = 12.0  # to which the mirrored sky is cut: no single pixel burns
HDR_THRESHOLD, HDR_EXCESS, HDR_FACTOR = 0.9, 0.6, 3.0  # of (3.16); the thesis's 100 is meant for a sky of at most 1
SHININESS = 120.0
AMBIENT = 1.0  # share of DEEP that Algorithm 6 sees everywhere: ours, the thesis gives none
SUN_STRENGTH = 1.6  # of the drawn sun over its colour
EXPOSURE = 0.60
FOG = 6000.0  # [m] in which the air takes 1 - 1/e of a colour
LEVEL = np.array([[0.0, 0.0, 1.0]])  # foam without heaps
END = 1.2, 2.2  # [of that] between which the sea ends in the horizon's colour
FOAM_HEIGHT, FOAM_GAIN = 0.8, 1.5  # [m] and the factor of the thesis's foam (5.2.3)


def reflected(to_eye: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Where the mirrored light comes from (3.6): 2 (E.N) N - E, with E towards the eye."""
    return 2.0 * (to_eye * normal).sum(axis=-1, keepdims=True) * normal - to_eye


def refracted(cos_incident: np.ndarray, n: float = REFRACTIVE_INDEX) -> np.ndarray:
    """Cosine of the angle in the water by Snell's law (3.7): at most 48.6 degrees for n = 1.333."""
    return np.sqrt(1.0 - (1.0 - np.asarray(cos_incident) ** 2) / n**2)


def fresnel(cos_incident: np.ndarray, n: float = REFRACTIVE_INDEX) -> np.ndarray:
    """Reflected share of unpolarised light (3.8), in cosines: no division of zero by zero at normal incidence."""
    cos_refracted = refracted(cos_incident, n)
    across = (cos_incident - n * cos_refracted) / (cos_incident + n * cos_refracted)
    along = (n * cos_incident - cos_refracted) / (n * cos_incident + cos_refracted)
    return 0.5 * (across**2 + along**2)


def transmitted(cos_incident: np.ndarray, n: float = REFRACTIVE_INDEX) -> np.ndarray:
    """The share that goes into the water (3.10)."""
    return 1.0 - fresnel(cos_incident, n)


def cosine(to_eye: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Of the angle of incidence (3.9)."""
    return (to_eye * normal).sum(axis=-1)


def emissive(strength: np.ndarray) -> np.ndarray:
    """Light of the surface's own (3.12): of water, what comes out of it."""
    return strength


def ambient(reflectance: np.ndarray | float, light: np.ndarray) -> np.ndarray:
    """Light from everywhere (3.13)."""
    return reflectance * light


def diffuse(reflectance: np.ndarray, light: np.ndarray, normal: np.ndarray, to_light: np.ndarray) -> np.ndarray:
    """Light scattered equally to all sides (3.14)."""
    return reflectance * light * np.maximum(normal @ to_light, 0.0)[:, None]


def specular(
    strength: float, light: np.ndarray, normal: np.ndarray, to_eye: np.ndarray, to_light: np.ndarray, shininess: float
) -> np.ndarray:
    """A highlight (3.15), with the half vector normalised, which the listing leaves out."""
    half = unit(to_light + to_eye)
    facing = (normal @ to_light > 0.0).astype(float)
    shine = facing * np.maximum((normal * half).sum(axis=1), 0.0) ** shininess
    return strength * light * shine[:, None]


def hdr(colour: np.ndarray, factor: float = HDR_FACTOR) -> np.ndarray:
    """The imitative high dynamic range (3.16): what is brighter than the threshold becomes brighter still."""
    return colour * (1.0 + factor * np.clip(colour[:, :1] - HDR_THRESHOLD, 0.0, HDR_EXCESS))


def beckmann(cos_half: np.ndarray, variance: np.ndarray) -> np.ndarray:
    """Density of facets that mirror the sun into the eye, their slopes normally distributed with this variance along
    each axis (Beckmann & Spizzichino 1963)."""
    c2 = np.maximum(cos_half, 1.0e-3) ** 2
    return np.exp(-(1.0 - c2) / (c2 * 2.0 * variance)) / (2.0 * np.pi * variance * c2**2)


def sun_glint(
    normal: np.ndarray, to_eye: np.ndarray, variance: np.ndarray, sun: np.ndarray, sunlight: np.ndarray
) -> np.ndarray:
    """The sun mirrored by facets finer than a pixel (Cook & Torrance 1982, without shadowing)."""
    half = unit(sun + to_eye)
    share = fresnel(np.clip((half * to_eye).sum(axis=1), 0.0, 1.0))
    facets = beckmann((half * normal).sum(axis=1), variance)
    seen = share * facets / (4.0 * np.maximum((normal * to_eye).sum(axis=1), 0.12))
    return SUN_STRENGTH * sunlight * seen[:, None]


def slope_variance(wind_speed: float) -> float:
    """Variance of the slopes of the sea along and across the wind together, of the speed [m/s] at 12.5 m (Cox & Munk
    1954, J. Opt. Soc. Am. 44, clean surface)."""
    return 0.003 + 0.00512 * wind_speed


def from_within(
    height: np.ndarray,
    normal: np.ndarray,
    to_eye: np.ndarray,
    cos_water: np.ndarray,
    light: "Light",
    bubbles: np.ndarray | float = 0.0,
) -> np.ndarray:
    """Light that comes out of the water: the colour of the depth (there is no bed to see), of crests, brighter the
    thinner they are and the more the sun stands behind them, and of bubbles, a share 0 to 1. `height` is 0 at rest, 1
    on a crest."""
    up = 2.2 * light.sky[1]
    thin = np.clip(0.25 + 0.5 * height, 0.0, 1.0)
    level = light.sun * [1.0, 0.0, 1.0]
    behind = np.maximum(-(to_eye @ level), 0.0) ** 2
    tilt = 3.0 * np.clip(1.0 - normal[:, 1] ** 2, 0.0, 0.3)
    through = 0.25 * up + 1.9 * light.sunlight[1] * (0.30 + 1.3 * behind) * thin * (0.25 + tilt)
    milky = np.broadcast_to(bubbles, np.shape(through))[:, None] * BUBBLES * (up + light.sunlight[1])
    return 2.0 * up * BODY + THIN * (through * (0.55 + 0.45 * cos_water))[:, None] + milky


def foam_by_height(height: np.ndarray, texture: np.ndarray | float = 1.0) -> np.ndarray:
    """The thesis's foam (5.2.3): saturate(height [m] / 0.8) times the foam's texture times 1.5."""
    return np.clip(np.clip(height / FOAM_HEIGHT, 0.0, 1.0) * texture * FOAM_GAIN, 0.0, 1.0)


def foam_colour(normal: np.ndarray, white: np.ndarray, heap: np.ndarray, light: "Light") -> np.ndarray:
    """White under the sun and the sky, grey-blue where foam is thin, and in heaps where it is thick."""
    heaped = tilted(normal, *(white * heap[:, :2]).T)
    sunny = np.maximum(0.7 * (heaped @ light.sun) + 0.3 * light.sun[1] + 0.06, 0.0)[:, None]
    bright = 1.0 + white * (heap[:, 2:] - 1.0)
    return bright * (THIN_FOAM + (FOAM - THIN_FOAM) * white) * (1.25 * light.sky + 1.75 * light.sunlight * sunny)


def foggy(colour: np.ndarray, horizon: np.ndarray, distance: np.ndarray, reach: float = FOG) -> np.ndarray:
    """A colour behind so many metres of air, which takes on that of the horizon."""
    lost = (1.0 - np.exp(-distance / reach))[:, None]
    lost = lost * (0.5 + 0.5 * lost * (3.0 - 2.0 * lost))
    end = np.clip((distance[:, None] / reach - END[0]) / (END[1] - END[0]), 0.0, 1.0)
    lost = lost + (1.0 - lost) * end * end * (3.0 - 2.0 * end)
    return colour * (1.0 - lost) + horizon * lost


class Light(NamedTuple):
    """What shines on the water."""

    sun: np.ndarray  # (3,) unit direction to it
    sunlight: np.ndarray  # (3,)
    sky: np.ndarray  # (3,) mean radiance from above


@dataclass(frozen=True)
class Terms:
    """Which terms the colour is made of; without Fresnel's the sky takes a constant share, as before it was there."""

    fresnel: bool = True
    reflection: bool = True
    body: bool = True
    glint: Literal["physical", "thesis"] | None = "physical"
    foam: bool = True
    fog: bool = True
    constant: float = 0.4
    """Share of the mirrored sky where Fresnel's is switched off."""


class Water(NamedTuple):
    """Points of the surface as an eye sees them."""

    normal: np.ndarray  # (n, 3) with ripples
    to_eye: np.ndarray  # (n, 3)
    distance: np.ndarray  # (n,) [m] from the eye
    height: np.ndarray  # (n,) 0 at rest, 1 on a crest
    variance: np.ndarray  # (n,) of slopes finer than the normals
    foam: np.ndarray  # (n,) share of the surface that is white
    bubbles: np.ndarray | float = 0.0  # (n,) share of white water before it is broken into patches
    heap: np.ndarray = LEVEL  # (n, 3) slopes of foam along x and z, and how bright it is, as `foam.heaps`; or (1, 3)


def final_colour(water: Water, sky: Sky, terms: Terms = Terms(), fog: float = FOG) -> np.ndarray:
    """Algorithm 6: ambient and emissive light from within, the mirrored sky in Fresnel's share, the sun's glint, and
    foam laid over them; then the air between the water and the eye."""
    light = Light(sky.sun, sky.sunlight, sky.ambient)
    normal, to_eye = facing(water.normal, water.to_eye)
    cos_eye = np.maximum(cosine(to_eye, normal), 0.02)
    blur = np.sqrt(water.variance)
    share = fresnel(np.minimum(np.sqrt(cos_eye**2 + 0.55 * water.variance), 1.0))
    if not terms.fresnel:
        share = np.full(len(normal), terms.constant)
    mirrored = sky_reflection(to_eye, normal, cos_eye, blur, sky)
    if terms.glint == "thesis":
        mirrored = hdr(mirrored)
    colour = np.zeros((len(normal), 3))
    if terms.body:
        bubbles = water.bubbles if terms.foam else 0.0
        within = from_within(water.height, normal, to_eye, refracted(cos_eye), light, bubbles)
        colour += (1.0 - share)[:, None] * within
    if terms.reflection:
        colour += share[:, None] * mirrored
    if terms.glint == "physical":
        colour += sun_glint(normal, to_eye, water.variance, sky.sun, sky.sunlight)
    if terms.foam:
        white = np.clip(water.foam, 0.0, 1.0)[:, None]
        colour = colour * (1.0 - white) + foam_colour(normal, white, water.heap, light) * white
    return foggy(colour, sky.hazy(-to_eye), water.distance, fog) if terms.fog else colour


def algorithm_6(water: Water, sky: Sky, terms: Terms = Terms(glint="thesis")) -> np.ndarray:
    """The thesis's own sum (5.2.3), its eye turned towards the eye, its half vector normalised and Fresnel's share
    exact: the plain terms of (3.11) in place of those of `final_colour`. Foam by height is `foam_by_height`."""
    share = fresnel(np.clip(cosine(water.to_eye, water.normal), 0.0, 1.0))[:, None]
    if not terms.fresnel:
        share = np.full_like(share, terms.constant)
    mirrored = sky.sample(reflected(water.to_eye, water.normal))
    colour = np.broadcast_to(ambient(AMBIENT, DEEP), mirrored.shape).copy()
    if terms.body:
        colour += emissive((1.0 - share) * CREST)
    if terms.reflection:
        colour += share * (hdr(mirrored) if terms.glint == "thesis" else mirrored)
    if terms.glint is not None:
        colour += specular(1.0, sky.sunlight, water.normal, water.to_eye, sky.sun, SHININESS)
    if terms.foam:
        white = np.clip(water.foam, 0.0, 1.0)[:, None]
        colour = colour * (1.0 - white) + FOAM * white
    return colour


def facing(normal: np.ndarray, to_eye: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Normals that do not look away from the eye: a rippled one may, where the surface itself does not."""
    away = 0.03 - cosine(to_eye, normal)
    turned = unit(normal + to_eye * away[:, None])
    return np.where((away > 0.01)[:, None], turned, normal), to_eye


def sky_reflection(
    to_eye: np.ndarray, normal: np.ndarray, cos_eye: np.ndarray, blur: np.ndarray, sky: Sky
) -> np.ndarray:
    """The sky where (3.6) points, the more blurred the rougher the water; rays that go down meet the sea again and are
    bent up."""
    ray = reflected(to_eye, normal)
    ray[:, 1] = np.where(ray[:, 1] < 0.0, 0.01 - 0.6 * ray[:, 1], ray[:, 1])
    ray[:, 1] += 0.35 * blur * (1.0 - cos_eye)
    return np.minimum(sky.sample(unit(ray), np.minimum(BLURS * blur, MOST_BLURRED)), BRIGHTEST)


def surface(position: np.ndarray, normal: np.ndarray, height: np.ndarray, eye: np.ndarray) -> np.ndarray:
    """Linear RGB (n, 3) of points of the surface; `height` is -1 in a trough, 0 at rest, 1 on a crest."""
    to_eye = unit(eye - position)
    facing = np.maximum((to_eye * normal).sum(axis=1), 0.0)
    cosine = np.sqrt(facing**2 + ROUGHNESS)  # ripples keep a rough sea from mirroring fully at grazing angles
    share = fresnel(np.minimum(cosine, 1.0))[:, None]
    mirrored = 2.0 * facing[:, None] * normal - to_eye
    mirrored[:, 1] = np.abs(mirrored[:, 1]) + 0.02
    sky = np.minimum(sky_module.colour(unit(mirrored)), 1.5)
    lit = np.clip(normal @ SUN, 0.0, 1.0)[:, None]
    thin = np.clip(0.5 + 0.5 * height, 0.0, 1.0)[:, None] ** 1.5
    inside = DEEP * (0.7 + 0.9 * lit) + CREST * thin * (0.15 + 0.85 * lit)
    return inside * (1.0 - share) + sky * share + SUNLIGHT * glint(normal, to_eye, cosine)[:, None]


def glint(normal: np.ndarray, to_eye: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    """The sun mirrored by facets with normally distributed slopes, for colours at nodes."""
    half = unit(SUN + to_eye)
    share = fresnel(np.clip((half * to_eye).sum(axis=1), 0.0, 1.0))
    facets = beckmann((half * normal).sum(axis=1), np.full(len(half), ROUGHNESS))
    return np.minimum(0.6 * facets * share / (4.0 * np.maximum(cosine, 0.12)), 3.0)


def side(position: np.ndarray, normal: np.ndarray, depth: np.ndarray, eye: np.ndarray) -> np.ndarray:
    """Linear RGB (n, 3) of the cut side of the water, as through glass; `depth` is 0 at the surface, 1 at the bed."""
    to_eye = unit(eye - position)
    facing = np.clip((to_eye * normal).sum(axis=1), 0.0, 1.0)
    share = fresnel(facing)[:, None]
    lit = 0.55 + 0.45 * np.clip(normal @ unit(SUN * [1.0, 0.0, 1.0]), -0.4, 1.0)[:, None]
    inside = DEEP * 0.5 + GLASS * np.exp(-3.2 * depth[:, None]) * lit
    return inside * (1.0 - share) + 0.35 * HORIZON * share


def relief(normal: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Linear RGB (n, 3) of the surface as a map, seen from straight above: dark troughs, pale crests, lit from the
    upper left, its slopes made steeper until they are seen, and none so steep that it is black; `height` as in
    `surface`."""
    slope = -normal[:, [0, 2]] / normal[:, 1:2]
    slope *= MAP_SLOPE / max(float(slope.std()), 1e-3 * MAP_SLOPE)
    slope /= np.hypot(1.0, np.linalg.norm(slope, axis=1, keepdims=True) / MAP_STEEPEST)
    tilted = unit(np.stack([-slope[:, 0], np.ones(len(slope)), -slope[:, 1]], axis=1))
    lit = np.clip(tilted @ MAP_LIGHT, 0.0, 1.0)[:, None]
    share = np.clip(0.5 + 0.5 * height, 0.0, 1.0)[:, None]
    paint = np.where(share < 0.5, TROUGH + 2.0 * share * (REST - TROUGH), REST + (2.0 * share - 1.0) * (PEAK - REST))
    return paint * (0.25 + 1.1 * lit)


def filmic(radiance: np.ndarray, exposure: float = 1.15) -> np.ndarray:
    """Linear RGB -> 0 to 1 for a screen: a filmic curve (Narkowicz 2015, fit to ACES), then gamma 2.2."""
    c = np.maximum(radiance, 0.0) * exposure
    curve = c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14)
    return np.clip(curve, 0.0, 1.0) ** (1.0 / 2.2)


def display(radiance: np.ndarray, exposure: float = 1.15) -> np.ndarray:
    """Linear RGB -> 8-bit colour."""
    return (255.0 * filmic(radiance, exposure) + 0.5).astype(np.uint8)
