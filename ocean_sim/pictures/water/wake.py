"""Kelvin waves behind ships, drawn where the run's own water does not respond to them; without effect on the run."""

from functools import lru_cache

import numpy as np

from ocean_sim.conventions import GRAVITY
from ocean_sim.pictures.stage.camera import Vessel
from ocean_sim.pictures.water.waterline import ship_coordinates

KELVIN_HEIGHT = 0.13  # of V^2 / g: the greatest height of Kelvin's waves
# Lengths of a ship that they are drawn behind her bow and aside; and fade in
KELVIN_ASTERN, KELVIN_ABEAM, KELVIN_FADE_LENGTH = 9.0, 3.5, 5.0
# Depth of the water behind a transom over V^2 / g, and its greatest over the breadth
HOLLOW_DEPTH, MAX_HOLLOW = 0.15, 0.10
PATTERN_STEP = 0.5  # lengths of a node of their pattern, over the beam
MIN_SPEED = 1.0  # [m/s] under which there are none
WAVE_ANGLES = 360  # of the waves that they are made of
STERN_DISTANCE = 0.46  # lengths of a ship from its middle to its stern
MIN_ANSWER = 0.025  # lengths of a ship: the height to which the waves at a ship that lies still may rise
# Lengths of a ship before and abaft her middle and breadths aside, within which they are limited
LIMITED_REACH = (1.3, 1.2)


@lru_cache(maxsize=64)
def kelvin_pattern(speed: float, breadth: float, length: float) -> np.ndarray:
    """Height (n, m) [m] of the steady waves behind a pressure patch as wide as a ship on deep water (Havelock 1908,
    Proc. R. Soc. A 81; Darmon, Benzaquen & Raphael 2014, J. Fluid Mech. 738, eq. 2.9), at nodes PATTERN_STEP breadths
    apart: n behind the bow, m to the side."""
    step = PATTERN_STEP * breadth
    x, y = np.arange(0.0, KELVIN_ASTERN * length, step), np.arange(0.0, KELVIN_ABEAM * length, step)
    k0, froude = GRAVITY / speed**2, speed / np.sqrt(GRAVITY * breadth)
    angle = (np.arange(WAVE_ANGLES) + 0.5) / WAVE_ANGLES * np.pi - 0.5 * np.pi
    secant = 1.0 / np.cos(angle)
    weight = secant**4 * np.exp(-(secant**4) / (4.0 * np.pi**2 * froude**4))
    heard = weight > 1e-4 * weight.max()
    k = k0 * secant[heard] ** 2
    along, across = np.outer(x, k * np.cos(angle[heard])), np.outer(y, k * np.sin(angle[heard]))
    height = (weight[heard] * np.sin(along)) @ np.cos(across).T
    begins = np.clip(x / (0.6 * length), 0.0, 1.0)
    height *= (begins * begins * (3.0 - 2.0 * begins) * np.exp(-x / (KELVIN_FADE_LENGTH * length)))[:, None]
    return KELVIN_HEIGHT * speed**2 / GRAVITY * height / max(float(np.abs(height).max()), 1e-12)


def kelvin_height(vessel: Vessel, breadth: float, time: float, places: np.ndarray) -> np.ndarray:
    """Height (n,) [m] of a ship's Kelvin waves and transom hollow at positions x, z (n, 2) [m]; 0 for a slow ship."""
    from scipy.ndimage import map_coordinates

    speed = round(vessel.speed(time), 1)
    if speed < MIN_SPEED:
        return np.zeros(len(places))
    along, aside = ship_coordinates(places[:, 0], places[:, 1], *vessel.pose(time))
    behind, aside = STERN_DISTANCE * vessel.length - along, np.abs(aside)
    at = np.stack([behind, aside]) / (PATTERN_STEP * breadth)
    waves = map_coordinates(kelvin_pattern(speed, breadth, vessel.length), at, order=1, mode="constant")
    return waves - transom_hollow(behind - 2.0 * STERN_DISTANCE * vessel.length, aside, speed, breadth)


def transom_hollow(astern: np.ndarray, aside: np.ndarray, speed: float, breadth: float) -> np.ndarray:
    """Depth (n,) [m] of the hollow in the water behind a transom of a breadth [m], which a wave at the ship's speed
    [m/s] follows. `astern`, `aside`: distances (n,) from the transom [m]. The law is our own."""
    depth = min(HOLLOW_DEPTH * speed**2 / GRAVITY, MAX_HOLLOW * breadth)
    k = GRAVITY / speed**2
    along = np.where(astern > 0.0, np.cos(k * astern) * np.exp(-0.3 * k * np.maximum(astern, 0.0)), 0.0)
    under = np.clip(1.0 + astern / breadth, 0.0, 1.0) * (astern <= 0.0)  # the hull lies there
    return depth * (along + under) * np.exp(-((aside / (0.5 * breadth)) ** 4))


def limited_answer(
    answer: np.ndarray, vessel: Vessel, breadth: float, x: np.ndarray, z: np.ndarray, time: float
) -> np.ndarray:
    """Heights `answer` (nx, nz) [m] that a run adds to plane waves, limited near a ship of `breadth` [m] at `time` [s]
    to the stagnation height V^2 / 2 g: linear waves do not break, and leave a hole there. `x`, `z`: nodes [m]."""
    along, aside = ship_coordinates(x[:, None], z[None, :], *vessel.pose(time))
    near = np.exp(-((along / (LIMITED_REACH[0] * vessel.length)) ** 4) - (aside / (LIMITED_REACH[1] * breadth)) ** 4)
    most = max(vessel.speed(time) ** 2 / (2.0 * GRAVITY), MIN_ANSWER * vessel.length)
    return answer + near * (most * np.tanh(answer / most) - answer)
