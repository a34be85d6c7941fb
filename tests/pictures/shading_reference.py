"""NumPy reference of the shaders of water, ripples and foam: each term of (3.6) to (3.16) a function, and their sum as
Algorithm 6 has it. Directions are unit vectors, y up; colours are linear RGB (n, 3); cosines and shares are (n,).
"""

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from ocean_sim.pictures.stage.sky import Sky, hashed_number, unit_vector
from ocean_sim.pictures.water.foam import (
    EDGE_SOFTNESS,
    GRAIN_BEND,
    GRAIN_SCALE,
    HEAP_SCALES,
    HEAP_SLOPE,
    HOLLOW_SHADES,
    MAX_FOOTPRINT,
    MIN_SHARE,
    MIN_WHITENESS,
    OCTAVE_TURN,
    PATCH_MEAN,
    PATCH_VARIANCE,
    RIDGE_MEAN,
    RIDGE_VARIANCE,
    WHOLE_SHARE,
)
from ocean_sim.pictures.water.water_glsl import CONSTANT_REFLECTANCE, GLINTS
from ocean_sim.pictures.water.water_shading import (
    BLUR_LEVELS,
    BODY_LIGHT,
    BUBBLE_LIGHT,
    CREST_LIGHT,
    CREST_STRETCH,
    DEEP_LIGHT,
    FOAM_REFLECTANCE,
    FOG_DISTANCE,
    FOG_END,
    GRADIENT_VARIANCE,
    HDR_EXCESS,
    HDR_FACTOR,
    HDR_THRESHOLD,
    MAX_BLUR_LEVEL,
    MAX_MIRRORED,
    MIN_VIEW_COSINE,
    NOISE_SHIFT,
    NOISE_STRETCH,
    NOISE_TURN,
    OCTAVE_COUNT,
    OCTAVE_RATIO,
    OCTAVE_SHIFT,
    PHASE_SPEED,
    REFRACTIVE_INDEX,
    SUN_STRENGTH,
    THIN_FOAM_REFLECTANCE,
    THIN_LIGHT,
    UNRESOLVED_SHARE,
    beckmann,
    fresnel,
    refracted_cosine,
)

SHININESS = 120.0
AMBIENT = 1.0  # share of DEEP that Algorithm 6 sees everywhere: ours, the thesis gives none
LEVEL = np.array([[0.0, 0.0, 1.0]])  # foam without heaps
FOAM_HEIGHT, FOAM_GAIN = 0.8, 1.5  # [m] and the factor of the thesis's foam (5.2.3)


@dataclass(frozen=True)
class ShadingTerms:
    """Terms of the colour; without Fresnel's the sky takes a constant share."""

    fresnel: bool = True
    reflection: bool = True
    body: bool = True
    glint: Literal["none", "physical", "thesis"] = "physical"
    foam: bool = True
    fog: bool = True
    constant: float = CONSTANT_REFLECTANCE

    @property
    def uniforms(self) -> dict[str, float]:
        """Uniforms of the shader that choose these terms."""
        switches = {"Fresnel": self.fresnel, "Reflection": self.reflection, "Body": self.body, "Foam": self.foam}
        switches["Fog"] = self.fog
        chosen = {f"use{name}": float(there) for name, there in switches.items()}
        return chosen | {"constantShare": self.constant, "glintKind": GLINTS[self.glint]}


def hazy(sky: Sky, away: np.ndarray) -> np.ndarray:
    """(n, 3) radiance of fog in unit directions (n, 3): the sky's just above the horizon there."""
    ahead = away[:, 0] / np.maximum(np.abs(away[:, 0]) + np.abs(away[:, 2]), 1e-6)
    at = np.where(away[:, 2] < 0.0, 3.0 + ahead, 1.0 - ahead)
    haze = sky.haze.reshape(-1, 3)
    return haze[(len(haze) / 4 * at).astype(int) % len(haze)]


def reflected(to_eye: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Where the mirrored light comes from (3.6): 2 (E.N) N - E, with E towards the eye."""
    return 2.0 * (to_eye * normal).sum(axis=-1, keepdims=True) * normal - to_eye


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
    half = unit_vector(to_light + to_eye)
    facing = (normal @ to_light > 0.0).astype(float)
    shine = facing * np.maximum((normal * half).sum(axis=1), 0.0) ** shininess
    return strength * light * shine[:, None]


def hdr(colour: np.ndarray, factor: float = HDR_FACTOR) -> np.ndarray:
    """The imitative high dynamic range (3.16): what is brighter than the threshold becomes brighter still."""
    return colour * (1.0 + factor * np.clip(colour[:, :1] - HDR_THRESHOLD, 0.0, HDR_EXCESS))


def sun_glint(
    normal: np.ndarray, to_eye: np.ndarray, variance: np.ndarray, sun: np.ndarray, sunlight: np.ndarray
) -> np.ndarray:
    """The sun mirrored by facets finer than a pixel (Cook & Torrance 1982, without shadowing)."""
    half = unit_vector(sun + to_eye)
    share = fresnel(np.clip((half * to_eye).sum(axis=1), 0.0, 1.0))
    facets = beckmann((half * normal).sum(axis=1), variance)
    seen = share * facets / (4.0 * np.maximum((normal * to_eye).sum(axis=1), 0.12))
    return SUN_STRENGTH * sunlight * seen[:, None]


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
    milky = np.broadcast_to(bubbles, np.shape(through))[:, None] * BUBBLE_LIGHT * (up + light.sunlight[1])
    return 2.0 * up * BODY_LIGHT + THIN_LIGHT * (through * (0.55 + 0.45 * cos_water))[:, None] + milky


def foam_by_height(height: np.ndarray, texture: np.ndarray | float = 1.0) -> np.ndarray:
    """The thesis's foam (5.2.3): saturate(height [m] / 0.8) times the foam's texture times 1.5."""
    return np.clip(np.clip(height / FOAM_HEIGHT, 0.0, 1.0) * texture * FOAM_GAIN, 0.0, 1.0)


def foam_colour(normal: np.ndarray, white: np.ndarray, heap: np.ndarray, light: "Light") -> np.ndarray:
    """White under the sun and the sky, grey-blue where foam is thin, and in heaps where it is thick."""
    heaped = tilted(normal, *(white * heap[:, :2]).T)
    sunny = np.maximum(0.7 * (heaped @ light.sun) + 0.3 * light.sun[1] + 0.06, 0.0)[:, None]
    bright = 1.0 + white * (heap[:, 2:] - 1.0)
    return (
        bright
        * (THIN_FOAM_REFLECTANCE + (FOAM_REFLECTANCE - THIN_FOAM_REFLECTANCE) * white)
        * (1.25 * light.sky + 1.75 * light.sunlight * sunny)
    )


def foggy(colour: np.ndarray, horizon: np.ndarray, distance: np.ndarray, reach: float = FOG_DISTANCE) -> np.ndarray:
    """A colour behind so many metres of air, which takes on that of the horizon."""
    lost = (1.0 - np.exp(-distance / reach))[:, None]
    lost = lost * (0.5 + 0.5 * lost * (3.0 - 2.0 * lost))
    end = np.clip((distance[:, None] / reach - FOG_END[0]) / (FOG_END[1] - FOG_END[0]), 0.0, 1.0)
    lost = lost + (1.0 - lost) * end * end * (3.0 - 2.0 * end)
    return colour * (1.0 - lost) + horizon * lost


class Light(NamedTuple):
    """What shines on the water."""

    sun: np.ndarray  # (3,) unit direction to it
    sunlight: np.ndarray  # (3,)
    sky: np.ndarray  # (3,) mean radiance from above


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


def final_colour(water: Water, sky: Sky, terms: ShadingTerms = ShadingTerms(), fog: float = FOG_DISTANCE) -> np.ndarray:
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
        within = from_within(water.height, normal, to_eye, refracted_cosine(cos_eye), light, bubbles)
        colour += (1.0 - share)[:, None] * within
    if terms.reflection:
        colour += share[:, None] * mirrored
    if terms.glint == "physical":
        colour += sun_glint(normal, to_eye, water.variance, sky.sun, sky.sunlight)
    if terms.foam:
        white = np.clip(water.foam, 0.0, 1.0)[:, None]
        colour = colour * (1.0 - white) + foam_colour(normal, white, water.heap, light) * white
    return foggy(colour, hazy(sky, -to_eye), water.distance, fog) if terms.fog else colour


def algorithm_6(water: Water, sky: Sky, terms: ShadingTerms = ShadingTerms(glint="thesis")) -> np.ndarray:
    """The thesis's own sum (5.2.3), its eye turned towards the eye, its half vector normalised and Fresnel's share
    exact: the plain terms of (3.11) in place of those of `final_colour`. Foam by height is `foam_by_height`."""
    share = fresnel(np.clip(cosine(water.to_eye, water.normal), 0.0, 1.0))[:, None]
    if not terms.fresnel:
        share = np.full_like(share, terms.constant)
    mirrored = sky.sample(reflected(water.to_eye, water.normal))
    colour = np.broadcast_to(ambient(AMBIENT, DEEP_LIGHT), mirrored.shape).copy()
    if terms.body:
        colour += emissive((1.0 - share) * CREST_LIGHT)
    if terms.reflection:
        colour += share * (hdr(mirrored) if terms.glint == "thesis" else mirrored)
    if terms.glint != "none":
        colour += specular(1.0, sky.sunlight, water.normal, water.to_eye, sky.sun, SHININESS)
    if terms.foam:
        white = np.clip(water.foam, 0.0, 1.0)[:, None]
        colour = colour * (1.0 - white) + FOAM_REFLECTANCE * white
    return colour


def facing(normal: np.ndarray, to_eye: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Normals that do not look away from the eye: a rippled one may, where the surface itself does not."""
    away = 0.03 - cosine(to_eye, normal)
    turned = unit_vector(normal + to_eye * away[:, None])
    return np.where((away > 0.01)[:, None], turned, normal), to_eye


def sky_reflection(
    to_eye: np.ndarray, normal: np.ndarray, cos_eye: np.ndarray, blur: np.ndarray, sky: Sky
) -> np.ndarray:
    """The sky where (3.6) points, the more blurred the rougher the water; rays that go down meet the sea again and are
    bent up."""
    ray = reflected(to_eye, normal)
    ray[:, 1] = np.where(ray[:, 1] < 0.0, 0.01 - 0.6 * ray[:, 1], ray[:, 1])
    ray[:, 1] += 0.35 * blur * (1.0 - cos_eye)
    return np.minimum(sky.sample(unit_vector(ray), np.minimum(BLUR_LEVELS * blur, MAX_BLUR_LEVEL)), MAX_MIRRORED)


def value_noise(x: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Noise at points x, z, smooth between random values at integer points, and its two derivatives."""
    i, j = np.floor(x), np.floor(z)
    f, g = x - i, z - j
    i, j = i.astype(np.int64), j.astype(np.int64)
    a, b, c, d = hashed_number(i, j), hashed_number(i + 1, j), hashed_number(i, j + 1), hashed_number(i + 1, j + 1)
    u, v = f**3 * (f * (f * 6.0 - 15.0) + 10.0), g**3 * (g * (g * 6.0 - 15.0) + 10.0)
    du, dv = 30.0 * f**2 * (f * (f - 2.0) + 1.0), 30.0 * g**2 * (g * (g - 2.0) + 1.0)
    k = a - b - c + d
    return a + (b - a) * u + (c - a) * v + k * u * v, du * (b - a + k * v), dv * (c - a + k * u)


def slopes(
    x: np.ndarray, z: np.ndarray, time: float, footprint: np.ndarray, angle: float, longest: float, variance: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Slopes along x and z, and the variance along each axis of those that are finer than the footprint [m] of a pixel.

    `angle`: towards which the wind blows [rad]; `longest`: wavelength of the first octave [m]; `variance`: of all
    slopes, both axes together.
    """
    cos, sin = np.cos(angle), np.sin(angle)
    steep = np.sqrt((1.0 - UNRESOLVED_SHARE) * variance / (OCTAVE_COUNT * GRADIENT_VARIANCE))
    slope_x, slope_z = np.zeros(np.shape(x)), np.zeros(np.shape(x))
    lost = np.full(np.shape(x), UNRESOLVED_SHARE * variance)
    for octave in range(OCTAVE_COUNT):
        wave = longest * OCTAVE_RATIO**octave
        fade = np.clip((wave / footprint - 2.0) / 4.0, 0.0, 1.0)
        along = (x * cos + z * sin) / wave + OCTAVE_SHIFT * octave - time * PHASE_SPEED / np.sqrt(wave)
        across = CREST_STRETCH * (z * cos - x * sin) / wave + OCTAVE_SHIFT * octave
        _, a, b = value_noise(along, across)
        turned = NOISE_TURN[0] * along - NOISE_TURN[1] * across, NOISE_TURN[1] * along + NOISE_TURN[0] * across
        _, c, d = value_noise(NOISE_STRETCH * turned[0] + NOISE_SHIFT, NOISE_STRETCH * turned[1] + NOISE_SHIFT)
        down = a + 0.8 * (NOISE_TURN[0] * c + NOISE_TURN[1] * d)
        across = CREST_STRETCH * (b + 0.8 * (NOISE_TURN[0] * d - NOISE_TURN[1] * c))
        slope_x += fade * steep * (down * cos - across * sin)
        slope_z += fade * steep * (down * sin + across * cos)
        lost += (1.0 - fade**2) * (1.0 - UNRESOLVED_SHARE) * variance / OCTAVE_COUNT
    return slope_x, slope_z, 0.5 * lost


def lengthened(footprint: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    """The footprint [m] by which ripples fade, of pixels whose sides are that long in the geometric mean: water that is
    seen flat, by its cosine to the normal, is longer in a pixel than it is broad, and ripples across the view would
    leave streaks and grain on the crests of waves."""
    return footprint * np.maximum(cosine, MIN_VIEW_COSINE) ** -0.25


def tilted(normal: np.ndarray, slope_x: np.ndarray, slope_z: np.ndarray) -> np.ndarray:
    """Normals (n, 3) of a surface with these slopes on top of its own."""
    up = np.maximum(normal[:, 1], 0.1)
    steeper = np.stack([normal[:, 0] / up - slope_x, np.ones(len(up)), normal[:, 2] / up - slope_z], axis=1)
    return steeper / np.linalg.norm(steeper, axis=1, keepdims=True)


def patches(x: np.ndarray, z: np.ndarray, footprint: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The grain of foam at positions [m], about 0 to 1: lace of threads around bubbles, in clumps; and its variance.
    Octaves that the footprint [m] of a pixel hides are their mean."""
    x, z = GRAIN_SCALE * x, GRAIN_SCALE * z
    bend_x, bend_z = (
        value_noise(0.6 * x + 3.0, 0.6 * z + 7.0)[0] - 0.5,
        value_noise(0.6 * x + 23.0, 0.6 * z + 11.0)[0] - 0.5,
    )
    x, z = x + GRAIN_BEND * bend_x, z + GRAIN_BEND * bend_z
    clumps = value_noise(0.45 * x, 0.45 * z)[0]
    grain, variance, scale = 0.42 * clumps, np.full(np.shape(x), PATCH_VARIANCE), 1.3
    for share in (0.30, 0.26, 0.20):
        x, z = OCTAVE_TURN[0] * x - OCTAVE_TURN[1] * z, OCTAVE_TURN[1] * x + OCTAVE_TURN[0] * z
        ridge = 1.0 - np.abs(2.0 * value_noise(scale * x + 9.0, scale * z + 9.0)[0] - 1.0)
        fine = np.clip(2.0 - 4.0 * footprint * GRAIN_SCALE * scale, 0.0, 1.0)
        grain = grain + share * (RIDGE_MEAN + fine * (ridge * ridge - RIDGE_MEAN))
        variance, scale = variance + (fine * share) ** 2 * RIDGE_VARIANCE, 2.1 * scale
    return grain, variance


def white(share: np.ndarray, x: np.ndarray, z: np.ndarray, footprint: np.ndarray) -> np.ndarray:
    """How white a pixel is: the share broken into patches where they are wider than its footprint [m].

    The mean over an area stays the share's: patches are thresholded by their own distribution, the threads first and
    the bubbles last, and foam that is thin covers the more of the water, the less white it is.
    """
    grain, variance = patches(x, z, footprint)
    rank = 1.0 / (1.0 + np.exp(1.702 * (grain - PATCH_MEAN) / np.sqrt(variance)))
    thick = np.minimum(MIN_WHITENESS + (1.0 - MIN_WHITENESS) * share / WHOLE_SHARE, 1.0)
    covered = share / thick
    soft = np.maximum(np.minimum(np.minimum(covered, 1.0 - covered), EDGE_SOFTNESS), 1e-3)
    edge = np.clip((covered + soft - rank) / (2.0 * soft), 0.0, 1.0)
    fine = np.clip(1.0 - footprint / MAX_FOOTPRINT, 0.0, 1.0)
    return np.where(share > MIN_SHARE, share + (thick * edge * edge * (3.0 - 2.0 * edge) - share) * fine, 0.0)


def heaps(x: np.ndarray, z: np.ndarray, footprint: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """How thick foam lies at positions [m], as fine as a pixel of a footprint [m] shows: slopes of its heaps along x
    and z, and how bright they are, 1 in the mean: darker in hollows."""
    slope_x, slope_z, bright = np.zeros(np.shape(x)), np.zeros(np.shape(x)), np.ones(np.shape(x))
    cos, sin = OCTAVE_TURN
    for scale, depth in zip(HEAP_SCALES, HOLLOW_SHADES, strict=True):
        fine = np.clip(1.5 - 3.0 * footprint * scale, 0.0, 1.0)
        value, u, v = value_noise(scale * (cos * x - sin * z) + 5.0, scale * (sin * x + cos * z) + 5.0)
        slope_x += HEAP_SLOPE * fine * (cos * u + sin * v)
        slope_z += HEAP_SLOPE * fine * (cos * v - sin * u)
        bright += depth * fine * (value - 0.5)
        cos, sin = cos * OCTAVE_TURN[0] - sin * OCTAVE_TURN[1], sin * OCTAVE_TURN[0] + cos * OCTAVE_TURN[1]
    return slope_x, slope_z, bright
