"""Hulls in the water of pictures and of exported files: waves at their bows and behind them, and foam along them. They
are drawn where the water of the run is too coarse for them or knows nothing of its ships, without effect on the run."""

from collections.abc import Callable
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np

from ocean_sim.conventions import GRAVITY
from ocean_sim.pictures.stage.camera import Vessel

# [m] around a hull in which it is white, and before the end of that in which her bow's ends
FOAM_REACH, FOAM_FADE_WIDTH = 4.0, 1.5
# Share of foam along a hull that lies still, and [m] in which it falls to a third
RESTING_FOAM, CONTACT_WIDTH = 0.30, 0.55
HULL_CELLS = 16, 16, 48  # of a hull across, up and along, by which drops find it
POINTS_PER_BATCH = 512  # whose distances to a line are found together: they stay in the processor's cache
ENTRANCE_LENGTH = 0.35  # lengths of a ship abaft her stem in which she reaches her breadth
DRAUGHT_SHARE = 0.25  # of her breadth
CREST_RISE, CREST_DISTANCE = 2.2, 1.1  # of V^2 / g: height and place of the crest
MAX_CREST = 0.2  # of the breadth: a higher one is spray
CREST_SLOPE = 0.33  # slope of the crest's line against the hull, as it leaves it
CREST_DECAY = 0.5, 2.0  # lengths of a ship, and V^2 / g, along that line in which the crest falls to a third
CREST_WIDTH, CREST_WIDENING = 0.10, 0.10  # [breadths] of the crest at the stem, and what it gains for each it goes aft
BREAKING_HEIGHT, WHITE_HEIGHT = 0.03, 0.22  # [m] height from which the crest breaks, and is wholly white
FOAM_TRAIL = 0.9  # [breadths] behind the crest in which its white falls to a third
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


class Bow(NamedTuple):
    """Bow wave of a ship at a steady speed, and the foam into which it breaks.

    Height and position of the crest are those of a wedge of half angle a and draught D (Noblesse, Delhommeau, Guilbaud,
    Hendrix & Yang 2008, J. Fluid Mech. 600); the crest's line and the white are our own. The height is V^2 / 2 g where
    V / sqrt(g D) = 4.4 tan a / cos a - 1 (Delhommeau, Guilbaud, David, Yang & Noblesse 2009, J. Fluid Mech. 620,
    abstract); CREST_DISTANCE was not checked against the paper."""

    length: float  # [m]
    breadth: float  # [m]
    speed: float  # [m/s]

    @property
    def wedge(self) -> float:
        """Tangent of half the entrance angle of the waterline."""
        return 0.5 * self.breadth / (ENTRANCE_LENGTH * self.length)

    @property
    def slowed_head(self) -> float:
        """Scale [m] of the crest's height and distance: V^2 / g over 1 + V / sqrt(g D), speed V and draught D."""
        return float(self.speed**2 / GRAVITY / (1.0 + self.speed / np.sqrt(GRAVITY * DRAUGHT_SHARE * self.breadth)))

    @property
    def rise(self) -> float:
        """Height [m] over the water around to which the bow throws water; above the crest it is spray."""
        return float(CREST_RISE * self.wedge * np.hypot(1.0, self.wedge) * self.slowed_head)

    @property
    def crest(self) -> tuple[float, float]:
        """Height of the crest over the water around [m], and its distance behind the stem [m]."""
        return min(self.rise, MAX_CREST * self.breadth), CREST_DISTANCE * self.slowed_head

    @property
    def breaks(self) -> float:
        """Whiteness, 0 to 1, of the bow wave's crest: 0 while it is too low to break."""
        return float(np.clip((self.crest[0] - BREAKING_HEIGHT) / (WHITE_HEIGHT - BREAKING_HEIGHT), 0.0, 1.0))

    def across(self, abaft: np.ndarray, gap: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distance of points outward from the line of the bow wave's crest, in widths of the crest, and factor on the
        crest's height there. `abaft`: distance behind the stem [m]; `gap`: distance off the hull [m]."""
        back = self.crest[1]
        aft = np.maximum(abaft - back, 0.0)
        width = self.breadth * CREST_WIDTH + CREST_WIDENING * aft + 0.25 * back
        left = np.exp(-aft / (CREST_DECAY[0] * self.length + CREST_DECAY[1] * self.speed**2 / GRAVITY))
        ahead = np.exp(-np.square(np.minimum(abaft - back, 0.0) / (back + self.breadth * CREST_WIDTH)))
        return (gap - CREST_SLOPE * aft) / width, left * ahead

    def height(self, abaft: np.ndarray, gap: np.ndarray) -> np.ndarray:
        """Height [m] of the bow wave at distances `abaft` behind the stem and `gap` off the hull [m]."""
        off, left = self.across(abaft, gap)
        return self.crest[0] * left * np.exp(-np.square(np.where(off > 0.0, off, 0.6 * off)))

    def white(self, abaft: np.ndarray, gap: np.ndarray) -> np.ndarray:
        """Share of foam, 0 to 1, on the bow wave at distances `abaft` behind the stem and `gap` off the hull [m]."""
        off, left = self.across(abaft, gap)
        behind = np.exp(np.minimum(off, 0.0) * self.breadth * CREST_WIDTH / (FOAM_TRAIL * self.breadth) * 3.0)
        face = np.exp(-np.square(np.maximum(off, 0.0) / 0.8))
        return self.breaks * np.square(left) * np.where(off > 0.0, face, behind) * (gap > -1.0)

    def half_breadth(self, abaft: np.ndarray) -> np.ndarray:
        """Half breadth [m] of the wedge that stands for the bow, at distances `abaft` behind the stem [m]."""
        return np.clip(self.wedge * abaft, 0.0, 0.5 * self.breadth)


class WettedHull(NamedTuple):
    """Hull of a ship at one time, with the waterline along which it meets the water."""

    line: np.ndarray  # (m, 2, 2) segments x, z [m] at which it meets the water
    position: np.ndarray  # (3,) [m]
    turn: np.ndarray  # (3, 3) from body to world
    bow: Bow

    @property
    def wet(self) -> bool:
        """True if the hull touches the water."""
        return len(self.line) > 2

    def foam_area(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper corner x, z (2,) [m] of the area in which the hull can whiten the water."""
        return self.line.min(axis=(0, 1)) - FOAM_REACH, self.line.max(axis=(0, 1)) + FOAM_REACH

    def stem_coordinates(self, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distances (n,) [m] of points x, z (n, 2) [m] behind the stem, and to starboard of the ship's centre line."""
        ends = self.line.reshape(-1, 2)
        stem = ship_coordinates(ends[:, 0], ends[:, 1], self.position, self.turn)[0].max()
        along, aside = ship_coordinates(at[:, 0], at[:, 1], self.position, self.turn)
        return stem - along, aside

    def bow_wave_height(self, at: np.ndarray) -> np.ndarray:
        """Height (n,) [m] of the ship's bow wave at points x, z (n, 2) [m]."""
        abaft, aside = self.stem_coordinates(at)
        return self.bow.height(abaft, np.abs(aside) - self.bow.half_breadth(abaft))

    def breaking(self, at: np.ndarray, gap: np.ndarray) -> np.ndarray:
        """Share (n,) of foam on the bow wave at points x, z (n, 2) [m] that are `gap` (n,) [m] off the hull."""
        near = np.clip((FOAM_REACH - gap) / FOAM_FADE_WIDTH, 0.0, 1.0)
        return self.bow.white(self.stem_coordinates(at)[0], gap) * near

    def white(self, at: np.ndarray) -> np.ndarray:
        """Share (n,) of foam at points x, z (n, 2) [m]: the larger of that on the bow wave and that along the hull."""
        gap = distance_to_line(at, self.line)
        return np.maximum(self.breaking(at, gap), RESTING_FOAM * np.exp(-np.maximum(gap, 0.0) / CONTACT_WIDTH))


class Hull:
    """Surface mesh of a ship's hull, from which water cuts a waterline."""

    def __init__(self, grid: Any, key: str) -> None:
        """Read the hull of the ship with this key from the arrays in the run's grid.npz (`grid`)."""
        self.vertices, self.triangles = grid[f"{key}_vertices"].astype(float), grid[f"{key}_triangles"].astype(int)
        self.bounds = np.stack([self.vertices.min(axis=0), self.vertices.max(axis=0)])  # lower, upper corner [m]
        self.beam, _, self.length = np.ptp(self.bounds, axis=0).tolist()  # [m]

    @cached_property
    def cells(self) -> np.ndarray:
        """Share of the hull in each of HULL_CELLS within its bounds, body axes."""
        from ocean_sim.basin.solids.mesh import column_shares

        x, y, z = (np.linspace(self.bounds[0, k], self.bounds[1, k], 2 * n + 1) for k, n in enumerate(HULL_CELLS))
        return column_shares(self.vertices[self.triangles], x[1::2], z[1::2], y[::2])

    def encloses(self, points: np.ndarray, position: np.ndarray, turn: np.ndarray) -> np.ndarray:
        """True for `points` (n, 3) [m] inside the hull, whose pose is as in `wetted_hull`."""
        from scipy.ndimage import map_coordinates

        cells = ((points - position) @ turn - self.bounds[0]) / np.ptp(self.bounds, axis=0) * HULL_CELLS - 0.5
        return np.asarray(map_coordinates(self.cells, cells.T, order=0, mode="grid-constant") > 0.5)

    def wetted_hull(
        self, position: np.ndarray, turn: np.ndarray, speed: float, heights_at: Callable[[np.ndarray], np.ndarray]
    ) -> WettedHull:
        """Hull in the water with its centre of mass at `position` (3,) [m], `turn` (3, 3) from body to world, and a
        speed [m/s]; `heights_at`: function of x, z (n, 2) [m], water heights (n,) [m]."""
        vertices = self.vertices @ turn.T + position
        above = vertices[:, 1] - heights_at(vertices[:, [0, 2]])
        line = waterline_segments(vertices, self.triangles, above)
        return WettedHull(line, position, turn, Bow(self.length, self.beam, speed))


def ship_coordinates(
    x: np.ndarray, z: np.ndarray, position: np.ndarray, turn: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Distances [m] of points x, z ahead of a ship at `position` and to starboard; `turn`: (3, 3), body to world."""
    ahead = turn[[0, 2], 2] / np.linalg.norm(turn[[0, 2], 2])
    to_x, to_z = x - position[0], z - position[2]
    return to_x * ahead[0] + to_z * ahead[1], to_z * ahead[0] - to_x * ahead[1]


def waterline_segments(vertices: np.ndarray, triangles: np.ndarray, above: np.ndarray) -> np.ndarray:
    """Segments x, z (m, 2, 2) [m] in which water cuts a hull of vertices (n, 3) [m], in world axes, and triangles (k,
    3); `above` (n,): heights of its vertices over water [m]."""
    a = above[triangles]
    cut = triangles[(a.min(axis=1) < 0.0) & (a.max(axis=1) >= 0.0)]
    ends = []
    for i, j in ((0, 1), (1, 2), (2, 0)):
        p, q = cut[:, i], cut[:, j]
        crossed = (above[p] < 0.0) != (above[q] < 0.0)
        share = np.where(crossed, above[p] / np.where(crossed, above[p] - above[q], 1.0), np.nan)[:, None]
        ends.append(np.where(crossed[:, None], vertices[p] + share * (vertices[q] - vertices[p]), np.nan)[:, [0, 2]])
    both = np.stack(ends, axis=1)  # one of the three is not a number
    missing = np.isnan(both[:, :, 0]).argmax(axis=1)
    kept = np.array([[1, 2], [0, 2], [0, 1]])[missing]
    return both[np.arange(len(both))[:, None], kept].reshape(-1, 2, 2)


def distance_to_line(points: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """Distance (n,) [m] of points x, z (n, 2) [m] from a closed line of segments (m, 2, 2) [m]; negative inside."""
    if len(points) > POINTS_PER_BATCH:
        batches = np.split(points, range(POINTS_PER_BATCH, len(points), POINTS_PER_BATCH))
        return np.concatenate([distance_to_line(batch, segments) for batch in batches])
    (x, z), (along_x, along_z) = segments[:, 0].T, (segments[:, 1] - segments[:, 0]).T
    to_x, to_z = points[:, 0, None] - x, points[:, 1, None] - z
    share = np.clip((to_x * along_x + to_z * along_z) / np.maximum(along_x**2 + along_z**2, 1e-12), 0.0, 1.0)
    away = np.sqrt(((to_x - share * along_x) ** 2 + (to_z - share * along_z) ** 2).min(axis=1))
    spans = (to_z < 0.0) != (to_z < along_z)
    left_of = to_x < to_z * (along_x / np.where(along_z == 0.0, 1.0, along_z))
    inside = (spans & left_of).sum(axis=1) % 2 == 1
    return np.where(inside, -away, away)


@lru_cache(maxsize=64)
def kelvin_pattern(speed: float, breadth: float, length: float) -> np.ndarray:
    """Height (n, m) [m] of the steady waves behind a pressure patch as wide as a ship of this `speed` [m/s], `breadth`
    and `length` [m] on deep water (Havelock 1908, Proc. R. Soc. A 81; Darmon, Benzaquen & Raphael 2014, J. Fluid Mech.
    738, eq. 2.9), at nodes PATTERN_STEP breadths apart: n behind the bow, m to the side."""
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
    """Height (n,) [m] of the Kelvin waves and transom hollow of a ship of a `breadth` [m] at a time [s], at x, z
    `places` (n, 2) [m]; 0 for a slow ship."""
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
