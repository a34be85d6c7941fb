"""Shaders of a ship's paint and panes in sun and sky: diffuse light, the shadow that she casts on herself, a mirrored
sky, the sun's highlight, and haze between her and the eye. Colours are as in `sky.painted_light`."""

import sys

import numpy as np

from ocean_sim.pictures.stage import sky
from ocean_sim.pictures.water.water_glsl import FOG_FUNCTIONS, shader
from ocean_sim.pictures.water.water_shading import SEA_EXPOSURE

SHIP_TRAITS = "nrm", "col", "att"  # normal, paint, (gloss, share of the sky that is seen, 0)
SHADOW_PIXELS = 512  # of the shadow's map along a side
SHADOW_SOFTNESS = 2.0  # pixels of the map by which the edge of a shadow is soft
UNLIT_DEPTH = -1e3  # depth where the sun sees none of her [m]
SHADOW_BIAS = 0.009  # of her length: less than that lies in no shadow of its own
SKY_DIRECTIONS, SKY_REACHES = 16, (0.6, 1.2, 2.0, 3.2)  # of rays to the sky, and how far they are followed [m]
SKY_CELL = 0.3  # [m] of the blocks that hide the sky
PAINT_GAIN = 1.15 / SEA_EXPOSURE  # of paint's light for the exposure of the sea
PAINT_ROUGHNESS = 0.012  # variance of the slopes of paint
COAT_REFLECTANCE = 0.05  # reflectance of paint and panes at normal incidence

SHADOW_FUNCTIONS = shader("shadow", sys.modules[__name__])
SHIP_FUNCTIONS = FOG_FUNCTIONS + SHADOW_FUNCTIONS + shader("ship_functions", sys.modules[__name__])
SHIP_PROGRAM = shader("ship", sky, sys.modules[__name__])


class ShadowMap:
    """Shadow map of a ship: how far each of her sunlit points lies towards the sun, as an image seen from the sun."""

    def __init__(self, points: np.ndarray, length: float) -> None:
        """`points`: (n, 3) on the ship, body axes [m], a map pixel apart or less; `length`: half the map's side [m]."""
        self.length, self.points = length, np.ascontiguousarray(points.T)

    def map(self, turn: np.ndarray, sun: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Compute the map: distances (SHADOW_PIXELS, SHADOW_PIXELS, 3) [m] of the sunlit surface from the ship's centre
        towards `sun`, in three equal channels; and unit vectors of its columns and rows. `turn`: from body to world."""
        from scipy.ndimage import maximum_filter

        right = sky.unit_vector(np.cross([0.0, 1.0, 0.0], sun))
        up = np.cross(sun, right)
        seen = (np.stack([right, up, sun]) @ turn).astype(np.float32) @ self.points
        pixel = (seen[:2] * (0.5 * SHADOW_PIXELS / self.length) + 0.5 * SHADOW_PIXELS).astype(np.int32)
        column, row = np.clip(pixel, 0, SHADOW_PIXELS - 1)
        depth = np.full(SHADOW_PIXELS * SHADOW_PIXELS, UNLIT_DEPTH, np.float32)
        np.maximum.at(depth, row * SHADOW_PIXELS + column, seen[2])
        depth = maximum_filter(depth.reshape(SHADOW_PIXELS, SHADOW_PIXELS), 3)
        return np.repeat(depth[..., None], 3, axis=2), right, up


def shadow_bounds(depth: np.ndarray, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper bounds (3,) of the shadow in a shadow map `depth` [m]: columns and rows as shares of the map's
    side, then 0 and the greatest depth in shadow [m]. `length`: half the map's side [m]."""
    row, column = np.nonzero(depth > UNLIT_DEPTH)
    low = np.array([column.min(), row.min()]) - SHADOW_SOFTNESS
    high = np.array([column.max(), row.max()]) + 1.0 + SHADOW_SOFTNESS
    farthest = float(depth.max()) - SHADOW_BIAS * length
    return np.append(low / SHADOW_PIXELS, 0.0), np.append(high / SHADOW_PIXELS, farthest)


def sky_shares(corners: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Share (n,) of the sky visible past the ship's own parts from triangle `corners` (n, 3) [m] with `normals`."""
    low = corners.min(axis=0) - SKY_CELL
    shape = np.ceil((corners.max(axis=0) - low) / SKY_CELL).astype(int) + 2
    full = np.zeros(shape, dtype=bool)
    triangles = corners.reshape(-1, 3, 3)
    for weights in np.random.default_rng(2).dirichlet(np.ones(3), 24):
        full[tuple(((np.einsum("k,mkx->mx", weights, triangles) - low) / SKY_CELL).astype(int).T)] = True
    turn = 2.0 * np.pi * np.arange(SKY_DIRECTIONS) * 0.381966
    rise = (np.arange(SKY_DIRECTIONS) + 0.5) / SKY_DIRECTIONS
    rays = np.stack([np.sqrt(1 - rise**2) * np.cos(turn), rise, np.sqrt(1 - rise**2) * np.sin(turn)], axis=-1)
    start = corners + 1.2 * SKY_CELL * normals
    seen, weight = np.zeros(len(corners)), np.zeros(len(corners))
    for ray in rays:
        facing = np.maximum(normals @ ray, 0.0) + 0.15
        open_air = np.ones(len(corners), dtype=bool)
        for reach in SKY_REACHES:
            at = np.clip(((start + reach * ray - low) / SKY_CELL).astype(int), 0, shape - 1)
            open_air &= ~full[tuple(at.T)]
        seen, weight = seen + facing * open_air, weight + facing
    return 0.25 + 0.75 * seen / weight
