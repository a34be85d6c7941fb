"""Wake of a ship in water that does not resolve it: foam along the track of its stern, and Kelvin's waves. Both are
drawn without effect on the run."""

from functools import lru_cache

import numpy as np

from ocean_sim.conventions import GRAVITY
from ocean_sim.pictures.stage.camera import Vessel
from ocean_sim.pictures.water.waterline import ship_coordinates

FADE_SECONDS = 7.0  # [s] in which it falls to a third
MAX_AGE = 22.0  # [s] after which it is not drawn
TRACK_STEPS = 48  # positions of the stern that are kept
WHITEST_SPEED = 4.0  # [m/s] from which a wake is as white as it gets
MAX_WHITENESS = 0.8
KELVIN_HEIGHT = 0.13  # of V^2 / g: the greatest height of Kelvin's waves
# Lengths of a ship that they are drawn behind her bow and aside; and fade in
KELVIN_ASTERN, KELVIN_ABEAM, KELVIN_FADE_LENGTH = 9.0, 3.5, 5.0
# Depth of the water behind a transom over V^2 / g, and its greatest over the breadth
HOLLOW_DEPTH, MAX_HOLLOW = 0.15, 0.10
PATTERN_STEP = 0.5  # lengths of a node of their pattern, over the beam
MIN_SPEED = 1.0  # [m/s] under which there are none
WAVE_ANGLES = 360  # of the waves that they are made of
STERN_DISTANCE = 0.46  # lengths of a ship from its middle to its stern
WAKE_SPREADING = 0.22  # [half breadths at s^-1/2] by which it widens
# Share of the white in the middle that goes soonest, in so many seconds: a smooth path
SLICK_SHARE, SLICK_SECONDS = 0.75, 2.0
MAX_TRACK_DISTANCE = 2.0  # squared half widths from the track at which the white is gone
SLICK_WIDTH = 0.6  # [half breadths] is left between two lines of foam
MIN_ANSWER = 0.025  # lengths of a ship: the height to which the waves at a ship that lies still may rise
# Lengths of a ship before and abaft her middle and breadths aside, within which they are limited
LIMITED_REACH = (1.3, 1.2)


class Wake:
    """Wake of foam along the track of a ship's stern. The laws of its width and fading are ours."""

    def __init__(self, vessel: Vessel, breadth: float, x: np.ndarray, z: np.ndarray) -> None:
        """`breadth` of the ship [m]; `x`, `z`: coordinates [m] of the nodes of the grid."""
        self.vessel, self.half, self.x, self.z = vessel, 0.5 * breadth, x, z

    def share(self, time: float, origin: np.ndarray) -> np.ndarray:
        """Share (nx, nz) of foam at a time [s], at the nodes of the grid around an origin x, z [m]."""
        share = np.zeros((len(self.x), len(self.z)))
        track = self.vessel.track
        if time <= track.time[0]:
            return share
        stern = track.position - STERN_DISTANCE * self.vessel.length * track.turn[:, :, 2]
        moments = np.linspace(max(track.time[0], time - MAX_AGE), time, TRACK_STEPS)
        position = np.stack([np.interp(moments, track.time, stern[:, k]) for k in (0, 2)], axis=1) - origin
        along = np.diff(position, axis=0)
        length2 = np.maximum((along**2).sum(axis=1), 1e-9)
        seconds = max(float(moments[-1] - moments[0]), 1e-9) / (TRACK_STEPS - 1)
        speed = np.sqrt(length2) / seconds
        reach = 4.0 * self.half
        near = [
            np.flatnonzero((nodes > position[:, k].min() - reach) & (nodes < position[:, k].max() + reach))
            for k, nodes in enumerate((self.x, self.z))
        ]
        if not (len(near[0]) and len(near[1])):
            return share
        x, z = self.x[near[0]], self.z[near[1]]
        found, nearest = np.zeros((len(x), len(z))), np.full((len(x), len(z)), np.inf)
        for k in range(TRACK_STEPS - 1):
            low, high = position[k : k + 2].min(axis=0) - reach, position[k : k + 2].max(axis=0) + reach
            here = tuple(slice(*np.searchsorted(nodes, ends)) for nodes, ends in zip((x, z), zip(low, high)))
            (to_x, to_z), (on_x, on_z) = (x[here[0], None] - position[k, 0], z[here[1]] - position[k, 1]), along[k]
            part = np.clip((to_x * on_x + to_z * on_z) / length2[k], 0.0, 1.0)
            age = np.maximum(time - moments[k] - part * seconds, 0.0)
            width = self.half * (0.75 + WAKE_SPREADING * np.sqrt(age))
            away2 = (np.square(to_x - part * on_x) + np.square(to_z - part * on_z)) / np.square(width)
            nearer = (away2 < nearest[here]) & (away2 < MAX_TRACK_DISTANCE)
            age, away2 = age[nearer], away2[nearer]
            slick = SLICK_SHARE * (1.0 - np.exp(-age / SLICK_SECONDS)) * np.exp(-away2 / SLICK_WIDTH**2)
            white = MAX_WHITENESS * min(speed[k] / WHITEST_SPEED, 1.0) * (1.0 - slick)
            white *= np.exp(-age / FADE_SECONDS - away2**2)
            found[here][nearer], nearest[here][nearer] = white, away2
        share[np.ix_(*near)] = np.where(found > 0.02, found, 0.0)
        return share


@lru_cache(maxsize=64)
def kelvin_pattern(speed: float, breadth: float, length: float) -> np.ndarray:
    """Height (n, m) [m] of the steady waves that a pressure patch as wide as a ship makes in deep water (Havelock 1908,
    Proc. R. Soc. A 81; Darmon, Benzaquen & Raphael 2014, J. Fluid Mech. 738, equation 2.9), at nodes PATTERN_STEP
    breadths apart, n behind the bow and m to the side."""
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


class Kelvin:
    """Kelvin wave pattern behind a ship, and the hollow behind her transom."""

    def __init__(self, vessel: Vessel, breadth: float) -> None:
        self.vessel, self.breadth = vessel, breadth

    def height(self, time: float, places: np.ndarray) -> np.ndarray:
        """Height (n,) [m] of the waves at places x, z (n, 2) [m] at a time [s]; 0 if the ship is too slow for any."""
        from scipy.ndimage import map_coordinates

        track, length = self.vessel.track, self.vessel.length
        k = int(np.abs(track.time - time).argmin())
        speed = round(self.vessel.speed(time), 1)
        if speed < MIN_SPEED:
            return np.zeros(len(places))
        along, aside = ship_coordinates(places[:, 0], places[:, 1], track.position[k], track.turn[k])
        behind, aside = STERN_DISTANCE * length - along, np.abs(aside)
        at = np.stack([behind, aside]) / (PATTERN_STEP * self.breadth)
        waves = map_coordinates(kelvin_pattern(speed, self.breadth, length), at, order=1, mode="constant")
        return waves - transom_hollow(behind - 2.0 * STERN_DISTANCE * length, aside, speed, self.breadth)


def transom_hollow(astern: np.ndarray, aside: np.ndarray, speed: float, breadth: float) -> np.ndarray:
    """Depth (n,) [m] of the water surface behind a transom of a breadth [m]; it rises again into a wave as for the
    ship's speed [m/s]. `astern`, `aside`: distances (n,) from the transom [m]. The law is ours."""
    depth = min(HOLLOW_DEPTH * speed**2 / GRAVITY, MAX_HOLLOW * breadth)
    k = GRAVITY / speed**2
    along = np.where(astern > 0.0, np.cos(k * astern) * np.exp(-0.3 * k * np.maximum(astern, 0.0)), 0.0)
    under = np.clip(1.0 + astern / breadth, 0.0, 1.0) * (astern <= 0.0)  # the hull lies there
    return depth * (along + under) * np.exp(-((aside / (0.5 * breadth)) ** 4))


def limited_answer(
    answer: np.ndarray, vessel: Vessel, breadth: float, x: np.ndarray, z: np.ndarray, time: float
) -> np.ndarray:
    """Response `answer` (nx, nz) [m] of the water to a ship at nodes x, z [m], limited around her to the stagnation
    height V^2 / 2 g: linear waves do not break, and would leave a hole of the hull's shape."""
    track = vessel.track
    k = int(np.abs(track.time - time).argmin())
    along, aside = ship_coordinates(x[:, None], z[None, :], track.position[k], track.turn[k])
    near = np.exp(-((along / (LIMITED_REACH[0] * vessel.length)) ** 4) - (aside / (LIMITED_REACH[1] * breadth)) ** 4)
    most = max(vessel.speed(time) ** 2 / (2.0 * GRAVITY), MIN_ANSWER * vessel.length)
    return answer + near * (most * np.tanh(answer / most) - answer)
