"""The sky above the water: a clear gradient, quick to compute, and an image of scattered light with clouds and sun.

Directions are unit vectors, y up; colours are linear RGB.
"""

import numpy as np

from ocean_sim.basin.points import middles_of
from ocean_sim.files.cache_file import cached_arrays


def unit_vector(vectors: np.ndarray) -> np.ndarray:
    """Vectors (..., 3) scaled to length 1."""
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


SUN_DIRECTION = unit_vector(np.array([-0.86, 0.32, -0.36]))  # direction to the sun
SUNLIGHT_COLOUR = np.array([1.0, 0.86, 0.66])
ZENITH_COLOUR = np.array([0.035, 0.14, 0.42])
HORIZON_COLOUR = np.array([0.42, 0.66, 0.92])
HAZE_COLOUR = np.array([0.72, 0.74, 0.74])  # at the horizon below the sun
GROUND_COLOUR = np.array([0.13, 0.16, 0.19])  # what lies around the basin, straight down
SUNSHINE = np.array([0.80, 0.74, 0.64])  # on a face that looks into the sun, linear RGB
FROM_ABOVE = np.array([0.40, 0.46, 0.54])  # light of the sky on a level face
FROM_BELOW = np.array([0.12, 0.16, 0.18])  # light that the water throws back
MIRRORED = np.array([0.30, 0.42, 0.56])  # of the sky, in panes

MIN_SKY_HEIGHT = 0.004  # height of a direction at which the sky is read for any lower one
# Rows and columns of the colours of fog that are kept, one direction around the horizon after another
HAZE_SIZE = (64, 128)
HAZE_LEVEL, MAX_HAZE = 3.5, 3.0  # smaller copy of the sky that it comes from, and to which radiance it is cut
# [m] of the Earth and of its air (Nishita et al. 1993, Bruneton & Neyret 2008)
GROUND_RADIUS, TOP_RADIUS = 6360e3, 6420e3
RAYLEIGH_SCATTERING, RAYLEIGH_HEIGHT = np.array([5.8e-6, 13.5e-6, 33.1e-6]), 8000.0  # [1/m] at sea level, [m]
MIE_SCATTERING, MIE_HEIGHT, MIE_FORWARD = np.full(3, 5.0e-6), 1200.0, 0.76  # [1/m], [m], Henyey-Greenstein's g
# Share of light taken off at the horizon: light scattered often is whiter than once (ours)
MULTIPLE_SCATTERING = np.array([0.02, 0.09, -0.75])
CLOUD_COVER, CLOUD_SEED = 0.5, 3  # share of the sky, and seed of their noise
CLEAR_SIDE = 128  # pixels along a side of the image of the clear gradient
SUN_RADIANCE = 22.0  # radiance of the sun before the air, in the units of these pictures
SUN_COSINE = np.cos(np.radians(0.6))  # of the drawn sun, wider than the true 0.27 degrees


def clear_sky(direction: np.ndarray) -> np.ndarray:
    """Radiance (n, 3) of a clear sky in unit directions (n, 3); a direction below the horizon gets the horizon's."""
    up = np.clip(direction[:, 1], 0.0, 1.0)[:, None]
    towards = np.clip(direction @ SUN_DIRECTION, 0.0, 1.0)[:, None]
    low = (1.0 - up) ** 20
    clear = ZENITH_COLOUR + (HORIZON_COLOUR - ZENITH_COLOUR) * (0.3 * (1.0 - up) ** 3 + 0.7 * low)
    clear += (HAZE_COLOUR - HORIZON_COLOUR) * low * towards**3
    return clear + SUNLIGHT_COLOUR * (0.22 * towards**12 + 0.5 * towards**220)


def sky_and_ground(direction: np.ndarray) -> np.ndarray:
    """Radiance (n, 3) in unit directions (n, 3) of a clear sky, and below it of a ground that darkens downwards."""
    down = np.clip(-direction[:, 1], 0.0, 1.0)[:, None]
    flat = unit_vector(direction * [1.0, 0.0, 1.0] + [1e-12, 0.0, 0.0])  # not (0, 0, 0)
    ground = GROUND_COLOUR + (0.72 * clear_sky(flat) - GROUND_COLOUR) * np.exp(-down / 0.22)
    return np.where(direction[:, 1:2] >= 0.0, clear_sky(direction), ground)


def painted_light(normals: np.ndarray, paint: np.ndarray, gloss: np.ndarray | float = 0.0) -> np.ndarray:
    """Linear RGB (n, 3) of surfaces with unit `normals` (n, 3) and linear RGB `paint` in sun and sky; `gloss` (n, 1): 1
    for panes that mirror."""
    sun = np.clip(normals @ SUN_DIRECTION, 0.0, 1.0)[:, None]
    above = 0.5 + 0.5 * normals[:, 1:2]
    ambient = FROM_BELOW + (FROM_ABOVE - FROM_BELOW) * above
    facing = 0.35 + 0.65 * np.clip(1.0 - np.abs(normals @ SUN_DIRECTION), 0.0, 1.0)[:, None]
    return paint * (SUNSHINE * sun + ambient) + 0.12 * gloss * MIRRORED * facing


class Sky:
    """Image (side, side, 3) of the sky's radiance with mipmaps, in stereographic projection from the nadir: the zenith
    is in the middle, the horizon touches the sides and repeats beyond; x runs along columns, z along rows. A look-up
    takes one division. `side` is a power of two."""

    def __init__(
        self, image: np.ndarray, sun: np.ndarray = SUN_DIRECTION, sunlight: np.ndarray = SUNLIGHT_COLOUR
    ) -> None:
        """Compute mipmaps, mean light and haze of `image`; `sun`: unit vector to it; `sunlight`: its linear RGB."""
        self.image, self.sun, self.sunlight = np.asarray(image, np.float32), sun, np.asarray(sunlight, float)
        levels = [self.image.astype(float)]
        while len(levels[-1]) > 1:
            a = levels[-1]
            levels.append(0.25 * (a[::2, ::2] + a[1::2, ::2] + a[::2, 1::2] + a[1::2, 1::2]))
        self.levels = levels
        square = np.add.outer(*2 * [middles_of(-1.0, 1.0, len(self.image)) ** 2])  # of the way from the zenith
        weight = np.where(square < 1.0, (1.0 + square) ** -2.0, 0.0)  # solid angle of a pixel, but for a factor
        self.ambient = np.tensordot(weight, np.minimum(self.image, 4.0), axes=2) / weight.sum()  # mean from above
        many = HAZE_SIZE[0] * HAZE_SIZE[1]
        at = 4.0 * (np.arange(many) + 0.5) / many
        x = np.where(at < 2.0, 1.0 - at, at - 3.0)  # as the shader finds them
        z = np.where(at < 2.0, 1.0, -1.0) * (1.0 - np.abs(x))
        around = self.sample(unit_vector(np.stack([x, np.zeros(many), z], axis=1)), HAZE_LEVEL)
        self.haze = np.minimum(around, MAX_HAZE).astype(np.float32).reshape(*HAZE_SIZE, 3)

    def sample(self, direction: np.ndarray, level: np.ndarray | float = 0.0) -> np.ndarray:
        """Radiance (n, 3) in unit directions, between mipmap `level` and the next; below the horizon as just above."""
        d = unit_vector(np.maximum(direction, [-1.0, MIN_SKY_HEIGHT, -1.0]))
        at = 0.5 + 0.5 * d[:, [0, 2]] / (1.0 + d[:, 1:2])
        levels = np.clip(np.broadcast_to(level, len(d)), 0.0, len(self.levels) - 1.0)
        low = np.floor(levels).astype(int)
        result = np.empty((len(d), 3))
        for k in np.unique(low):
            here = low == k
            share = (levels[here] - k)[:, None]
            nearest = self.levels[k], self.levels[min(k + 1, len(self.levels) - 1)]
            fine, coarse = (bilinear_values(image, at[here]) for image in nearest)
            result[here] = (1.0 - share) * fine + share * coarse
        return result


def bilinear_values(image: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Values (n, 3) of an image at positions (n, 2), 0 to 1 across it, by bilinear interpolation; constant outside."""
    from scipy.ndimage import map_coordinates

    place = at.T[::-1] * len(image) - 0.5
    return np.stack([map_coordinates(of, place, order=1, mode="nearest") for of in np.moveaxis(image, -1, 0)], axis=1)


def sky_directions(side: int) -> np.ndarray:
    """Unit directions (side, side, 3) of a sky image's pixels; those beyond the horizon are moved onto it."""
    x, z = np.meshgrid(*2 * [middles_of(-1.0, 1.0, side)])
    beyond = np.maximum(np.hypot(x, z), 1.0)
    x, z = x / beyond, z / beyond
    square = x * x + z * z
    return np.stack([2.0 * x, 1.0 - square, 2.0 * z], axis=-1) / (1.0 + square)[..., None]


def cloudy_sky(side: int = 1024) -> Sky:
    """Sky of scattered light with clouds, from the user's cache if it is there; `side`: of its image [pixels]."""
    arrays = cached_arrays("sky", str(side).encode(), lambda: make_sky(side))
    return Sky(arrays["image"], SUN_DIRECTION, arrays["sunlight"])


def clear_sky_image() -> Sky:
    """Sky with the gradient of `clear_sky` and no clouds."""
    return Sky(clear_sky(sky_directions(CLEAR_SIDE).reshape(-1, 3)).reshape(CLEAR_SIDE, CLEAR_SIDE, 3))


def make_sky(side: int) -> dict[str, np.ndarray]:
    """Compute the image (side, side, 3) of a cloudy sky and the colour (3,) of sunlight, as arrays for the cache."""
    from scipy.ndimage import zoom

    sun, coarse = SUN_DIRECTION, sky_directions(128)
    coarse[..., 1] = np.maximum(coarse[..., 1], 0.003)
    light = scattered_light(unit_vector(coarse), sun)[0]
    image = zoom(light, (side / 128, side / 128, 1), order=1, grid_mode=True, mode="nearest")
    sunlight = scattered_light(sun[None], sun)[1][0]
    d = sky_directions(side)
    image = image * (1.0 - np.clip(1.0 - np.abs(d[..., 1:2]) / 0.25, 0.0, 1.0) * MULTIPLE_SCATTERING)
    towards = d @ sun
    image, veil = add_clouds(d, image, sunlight)
    glow = 7.0 * np.exp(-(1.0 - towards) / 0.0007) + 0.7 * np.exp(-(1.0 - towards) / 0.010)
    glow += 45.0 * np.clip((towards - SUN_COSINE) / (0.15 * (1.0 - SUN_COSINE)) + 0.5, 0.0, 1.0)
    image = image + glow[..., None] * sunlight * (1.0 - 0.6 * veil)
    return {"image": image.astype(np.float32), "sunlight": sunlight / sunlight.max()}


def scattered_light(d: np.ndarray, sun: np.ndarray, steps: int = 24, inner: int = 8) -> tuple[np.ndarray, np.ndarray]:
    """Radiance (..., 3) of sunlight scattered once, towards an eye at sea level from unit directions d (..., 3), and
    the share transmitted (Rayleigh and Mie; Nishita et al. 1993); `steps`, `inner`: samples of view and sun rays."""
    eye = np.array([0.0, GROUND_RADIUS + 2.0, 0.0])
    segment = distance_to_top(eye, d) / steps
    mu = d @ sun
    g = MIE_FORWARD
    rayleigh_phase = 3.0 / (16.0 * np.pi) * (1.0 + mu**2)
    mie_phase = 3.0 / (8.0 * np.pi) * (1 - g * g) * (1.0 + mu**2) / ((2 + g * g) * (1 + g * g - 2.0 * g * mu) ** 1.5)
    thick_r, thick_m = np.zeros(mu.shape), np.zeros(mu.shape)
    light_r, light_m = np.zeros(d.shape), np.zeros(d.shape)

    def veil(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Share of light (..., 3) that passes air equivalent to `a` (Rayleigh) and `b` (Mie) metres at sea level."""
        return np.exp(-(RAYLEIGH_SCATTERING * a[..., None] + 1.1 * MIE_SCATTERING * b[..., None]))

    for i in range(steps):
        point = eye + d * (segment * (i + 0.5))[..., None]
        high = np.linalg.norm(point, axis=-1) - GROUND_RADIUS
        here_r, here_m = np.exp(-high / RAYLEIGH_HEIGHT) * segment, np.exp(-high / MIE_HEIGHT) * segment
        thick_r += here_r
        thick_m += here_m
        step = distance_to_top(point, sun) / inner
        sun_r, sun_m = np.zeros(mu.shape), np.zeros(mu.shape)
        for j in range(inner):
            there = np.linalg.norm(point + sun * (step * (j + 0.5))[..., None], axis=-1) - GROUND_RADIUS
            there = np.maximum(there, 0.0)
            sun_r += np.exp(-there / RAYLEIGH_HEIGHT) * step
            sun_m += np.exp(-there / MIE_HEIGHT) * step
        through = veil(thick_r + sun_r, thick_m + sun_m)
        light_r += through * here_r[..., None]
        light_m += through * here_m[..., None]
    rayleigh, mie = RAYLEIGH_SCATTERING * rayleigh_phase[..., None], MIE_SCATTERING * mie_phase[..., None]
    return SUN_RADIANCE * (light_r * rayleigh + light_m * mie), veil(thick_r, thick_m)


def distance_to_top(point: np.ndarray, d: np.ndarray) -> np.ndarray:
    """Distance [m] from points (..., 3) in the atmosphere to its top, along unit directions d (..., 3)."""
    along, excess = (point * d).sum(axis=-1), (point * point).sum(axis=-1) - TOP_RADIUS**2
    return -along + np.sqrt(np.maximum(along**2 - excess, 0.0))


def add_clouds(d: np.ndarray, clear: np.ndarray, sunlight: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Add clouds (warped fractal noise) to the radiance `clear` (..., 3) of a sky in unit directions d (..., 3).
    Returns the radiance (..., 3) and the share (..., 1) of it that clouds hide; `sunlight`: linear RGB."""
    cover, seed = CLOUD_COVER, CLOUD_SEED
    up = np.maximum(d[..., 1], 1e-3)
    layer = d[..., [0, 2]] / (up + 0.08)[..., None] * 1.15 + [3.1 * seed, 0.7]
    warps = [fractal_noise(1.3 * layer + shift, 4, seed + stream) for shift, stream in ((5.0, 20), (9.0, 30))]
    where = layer * [0.8, 1.0] + 1.2 * (np.stack(warps, axis=-1) - 0.5)
    raw = np.clip((fractal_noise(where, 7, seed) - (0.62 - 0.22 * cover)) / 0.22, 0.0, 1.0)
    hidden = raw * raw * (3.0 - 2.0 * raw) * np.clip((d[..., 1] - 0.015) / 0.12, 0.0, 1.0) * 0.92
    sunward = fractal_noise(where + 0.12 * SUN_DIRECTION[[0, 2]], 5, seed)
    thick = np.clip((sunward - (0.60 - 0.22 * cover)) / 0.25, 0.0, 1.0)
    near = np.clip(d @ SUN_DIRECTION, 0.0, 1.0)
    bright = np.exp(-2.2 * thick) * (0.35 + 1.6 * near**12 + 0.6 * near**3)
    lit = sunlight * [1.0, 0.93, 0.85] * (2.2 * bright)[..., None] + 0.55 * clear + [0.015, 0.018, 0.024]
    veil = hidden[..., None]
    return clear * (1.0 - veil) + lit * veil, veil


def fractal_noise(p: np.ndarray, octaves: int, seed: int) -> np.ndarray:
    """Noise (...), 0 to 1, at points `p` (..., 2): `octaves` of value noise, each half as strong; `seed` shifts it."""
    total, weight, amplitude = np.zeros(p.shape[:-1]), 0.0, 1.0
    for k in range(octaves):
        total += amplitude * value_noise(*np.moveaxis(p * 2.03**k + 34.3 * k + 17.0 * seed, -1, 0))
        weight += amplitude
        amplitude *= 0.5
    return total / weight


def value_noise(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Noise (...) at points x, z (...), smooth between random values at integer points."""
    i, j = np.floor(x), np.floor(z)
    f, g = x - i, z - j
    i, j = i.astype(np.int64), j.astype(np.int64)
    a, b, c, d = hashed_number(i, j), hashed_number(i + 1, j), hashed_number(i, j + 1), hashed_number(i + 1, j + 1)
    u, v = f**3 * (f * (f * 6.0 - 15.0) + 10.0), g**3 * (g * (g * 6.0 - 15.0) + 10.0)
    return a + (b - a) * u + (c - a) * v + (a - b - c + d) * u * v


def hashed_number(i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """Pseudorandom numbers, 0 to 1, for integers i, j, by an integer hash that gives the same on every processor."""
    n = (i * 374761393 + j * 668265263) & 0xFFFFFFFF
    n = ((n ^ (n >> 13)) * 1274126177) & 0xFFFFFFFF
    return (n >> 16) / 65535.0
