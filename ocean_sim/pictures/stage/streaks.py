"""Drops in the air, as streaks as long as they fly while a picture is exposed, lit from behind."""

import sys

import numpy as np

from ocean_sim.pictures.stage.plotter import Stage
from ocean_sim.pictures.stage.sky import Sky
from ocean_sim.pictures.water import water_glsl
from ocean_sim.pictures.water.spray import cross_section

EXPOSURE_SECONDS = 0.02  # [s] of a picture: half of a 24th, as in films
MIN_WIDTH_PIXELS = 0.6  # half the width of the finest streak: finer drops are as wide, and fainter
# Place in a streak, half its straight length, in half widths; optical depth, seed and evenness, size of its pattern
STREAK_TRAITS = "uvl", "opa"
PATTERN_RADII, PATTERN_PIXELS = 6.0, 2.5  # side of a cell of that pattern, in radii of a drop and, at least, in pixels
FAR_SHARE = 0.25  # of the least side of a cell, below which the cells that drops call for fade into their mean
FORWARD_SHARE = 0.7  # asymmetry of the light that drops scatter (Henyey & Greenstein 1941, Astrophys. J. 93)
MAX_FORWARD_LIGHT = 5.0  # of the sun's through drops, over light that goes to all sides alike
CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


class Streaks:
    """All spray parcels of a picture, as one mesh of rectangles that face the eye."""

    def __init__(self, stage: Stage, sky: Sky, exposure: float) -> None:
        """Add the mesh of the spray to a `stage`. `sky`: whose light drops scatter; `exposure`: factor on light."""
        self.stage = stage
        program = water_glsl.shader("streaks", sys.modules[__name__])
        self.shaded = water_glsl.Shaded(stage.pyvista.PolyData(), program, "", {}, STREAK_TRAITS)
        self.shaded.set(exposure=exposure, **water_glsl.sky_uniforms(sky))
        self.shaded.actor.ForceTranslucentOn()
        stage.plotter.add_actor(self.shaded.actor, reset_camera=False, render=False)

    def show(self, parcels: np.ndarray) -> None:
        """Draw parcels (n, 9, see `Spray`): position, velocity, radius of a drop, number of drops, parcel's radius."""
        parcels = parcels[(parcels[:, :3] - self.stage.camera.eye) @ self.stage.camera.forward > 0.0]
        self.shaded.actor.SetVisibility(len(parcels) > 0)
        if not len(parcels):
            return
        camera = self.stage.camera
        place, velocity, radius, spread = parcels[:, :3], parcels[:, 3:6], parcels[:, 6:7], parcels[:, 8:]
        away = np.linalg.norm(towards := camera.eye - place, axis=1, keepdims=True)
        towards = towards / np.maximum(away, 1e-9) if camera.parallel_height is None else -camera.forward + 0.0 * place
        half = camera.parallel_height or away * np.tan(np.radians(0.5 * camera.angle))
        pixel = 2.0 * half / (self.stage.samples * self.stage.size[1])
        wide, size = np.maximum(spread, MIN_WIDTH_PIXELS * pixel), PATTERN_RADII * radius
        across = velocity - (velocity * towards).sum(axis=1, keepdims=True) * towards
        fast = np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-9)
        straight, side = 0.5 * EXPOSURE_SECONDS * fast / wide, np.cross(across / fast, towards)
        depth = 2.0 * cross_section(parcels)[:, None] / ((np.pi + 4.0 * straight) * wide**2)
        seen = np.maximum(size, PATTERN_PIXELS * pixel)
        even = np.clip(1.0 - size / (FAR_SHARE * seen), 0.0, 1.0)
        u, v = CORNERS[:, 0] * (1.0 + straight), CORNERS[:, 1] + 0.0 * straight
        aside = (u * wide)[..., None] * (across / fast)[:, None] + (v * wide)[..., None] * side[:, None]
        points, seed = place[:, None] + aside, np.floor(np.mod(1e7 * radius, 97.0)) + 0.01
        drops = np.repeat(np.hstack([depth, seed + 0.98 * even, seen / wide]), 4, axis=0)
        traits = np.stack([u, v, straight + 0.0 * v], axis=-1), drops
        vectors = {name: of.reshape(-1, 3) for name, of in zip(STREAK_TRAITS, traits, strict=True)}
        faces = np.arange(4 * len(parcels)).reshape(-1, 4)
        self.shaded.mesh.DeepCopy(self.stage.mesh(points.reshape(-1, 3), faces, **vectors))
        self.shaded.set(eyeW=camera.eye)
