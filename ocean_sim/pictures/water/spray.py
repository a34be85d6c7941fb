"""Drops that breaking water throws: how many, how they fly, and where they fall back as foam. They are only drawn, and
take nothing from the water. Mass thrown per time = EJECTED_SHARE * power of breaking / (half the squared speed at which
waters meet). One parcel stands for many equal drops where there are too many."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ocean_sim.conventions import AIR_DENSITY, GRAVITY, WATER_DENSITY
from ocean_sim.pictures.water.foam import FADE_SECONDS
from ocean_sim.pictures.water.waterline import CREST_WIDTH, ENTRANCE_LENGTH, Bow
from ocean_sim.random_numbers import numpy_uniform, numpy_uniform3

Heights = Callable[[np.ndarray], np.ndarray]  # of the water [m] at x, z (n, 2) [m]
Openness = Callable[[np.ndarray], np.ndarray]  # (n,) True at points (n, 3) [m] in the basin and in no solid body
BREAKING_STRENGTH = 1.0e-3  # power of a metre of breaking crest over rho c^5 / g (Phillips et al. 2001, J. P. O. 31)
CREST_STEEPNESS = 0.44  # orbital over phase speed of the highest wave on deep water (Michell 1893, Phil. Mag. 36)
BREAKER_SPEED_SHARE = 0.5  # phase speed of crests that break over that of the sea (Melville & Matusov 2002, Nature 417)
# Volume thrown from white water [m/s]: integral of the drops of Fairall, Kepert & Holland (1994, Global Atmos. Ocean
# Syst. 2) in a wind of 11 m/s over Monahan's cover; at crests of such a speed [m/s] it calibrates the ejected share
WHITE_WATER_FLUX, CALIBRATION_SPEED = 5.0e-6, 3.0
EJECTED_SHARE = WHITE_WATER_FLUX * FADE_SECONDS * GRAVITY * CREST_STEEPNESS**2 / (2e-3 * CALIBRATION_SPEED**2)  # 1.8e-3
SURFACE_TENSION = 0.073  # [N/m] of water
# [m/s] speed of the slowest wave: what is slower throws no drops (Brocchini & Peregrine 2001, J. Fluid Mech. 449)
MIN_MEETING_SPEED = float((4.0 * GRAVITY * SURFACE_TENSION / WATER_DENSITY) ** 0.25)
# Weber number of the largest drop that turbulence leaves whole (Hinze 1955, AIChE J. 1); turbulent over meeting speed
CRITICAL_WEBER, TURBULENT_SHARE = 1.2, 0.04
MAX_RADIUS = 0.5 * float(np.sqrt(SURFACE_TENSION / (WATER_DENSITY * GRAVITY)))  # [m] half the capillary length
SPUME_RADIUS = 1.5e-4  # [m] median of drops that wind tears, 20 to 500 um (Andreas 1998, J. Phys. Oceanogr. 28)
RADIUS_DEVIATION = 0.5  # standard deviation of the logarithm of the radius
SPINDRIFT_WIND = 10.0  # [m/s] above which wind tears foam (Monahan, Spiel & Davidson 1986, Oceanic Whitecaps)
AIR_ROUGHNESS = 2.0e-4  # [m] of the sea, for the logarithmic wind profile
BOW_FLARE, BOW_POINTS = 0.5, 8  # outward over upward slope of a bow, which rising water meets; points on each side
SHEDDING_SECONDS, AIRBORNE_SCATTER = 0.8, 0.25  # [s] in which flying particles would be drops; of their speed
# [spacings] breadth of a column, and of air in it below a particle that flies
COLUMN_BREADTH, FLYING_GAPS = 2.0, (2.2, 3.5)
# [spacings], neighbours in it on a lattice in 2-D and 3-D, and shares of them at which water comes apart, or begins to
NEIGHBOUR_REACH, LATTICE_NEIGHBOURS, TEARING_SHARES = 1.6, (8, 18), (1 / 3, 2 / 3)
POOL_PARCELS, FLIGHT_SECONDS = 8192, 1.0  # parcels in the air at most, and [s] for which these are all that are thrown
DIRECTION_SCATTER, MAX_SPEED_FACTOR = 0.6, 1.8  # of the direction of throwing; of the root mean square of its speed
# Radius of a parcel as it is thrown over that at which its drops cover it; of its speed, at which the radius grows
PARCEL_SPACING, PARCEL_WIDENING = 3.0, 0.06
UP, KEYS_PER_PLACE, SPRAY_STREAM = np.array([0.0, 1.0, 0.0]), 256, 0x5_0003  # of random numbers, with four streams


class Source(NamedTuple):
    """Positions from which drops are thrown, with speed, radius and mass flow of the drops."""

    key: np.ndarray  # (n,) of random numbers
    place: np.ndarray  # (n, 3) [m]
    extent: float  # [m] half the side of the square around each
    flow: np.ndarray  # (n, 3) [m/s] of the water there
    towards: np.ndarray  # (n, 3) or (3,): direction of throwing
    speed: np.ndarray  # (n,) [m/s] at which waters meet
    radius: np.ndarray | float  # (n,) [m] median of the drops
    mass: np.ndarray  # (n,) [kg/s] thrown


def drop_radius(speed: np.ndarray) -> np.ndarray:
    """Median radius (n,) [m] of the drops thrown where bodies of water collide at a relative speed (n,) [m/s]."""
    pressure = WATER_DENSITY * np.square(TURBULENT_SHARE * np.maximum(speed, MIN_MEETING_SPEED))
    return np.minimum(0.5 * CRITICAL_WEBER * SURFACE_TENSION / pressure, MAX_RADIUS)


def thrown_mass(power: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """Mass thrown [kg/s] (n,) by a power [W] (n,) of breaking, where waters collide at a relative speed (n,) [m/s]."""
    return np.where(speed > MIN_MEETING_SPEED, EJECTED_SHARE * power / np.maximum(0.5 * speed**2, 1e-9), 0.0)


class Spray:
    """Drops in the air, as parcels (n, 9): position (3) [m], velocity (3) [m/s], radius of a drop [m], number of drops,
    radius of the parcel [m]. Beyond POOL_PARCELS the oldest are dropped."""

    def __init__(self, seed: int, dimension: int) -> None:
        self.seed, self.frame, self.time, self.parcels = seed, 0, 0.0, np.zeros((0, 9))
        self.axes = np.array([1.0, 1.0, dimension - 2.0])  # along which drops are thrown

    def advance(
        self, time: float, sources: list[Source], wind: np.ndarray, heights_at: Heights, is_open: Openness
    ) -> np.ndarray:
        """Throw drops and let them fly until a time [s], in a wind x, z [m/s] at 10 m. Returns the parcels (n, 9) that
        fell into the water; those that `is_open` finds beyond the sides or in a solid body are dropped."""
        step, self.time = time - self.time, time
        active = [source for source in sources if source.mass.any() and step > 0.0]
        most = POOL_PARCELS * min(step / FLIGHT_SECONDS, 1.0) / max(len(active), 1)
        thrown = [self.throw_parcels(source, step, most, wind) for source in active]
        self.frame += 1
        parcels = np.concatenate([fly_parcels(self.parcels, step, wind), *thrown])
        parcels = parcels[is_open(parcels[:, :3])]
        flying = parcels[:, 1] > heights_at(parcels[:, [0, 2]])
        self.parcels = parcels[flying][-POOL_PARCELS:]
        return parcels[~flying]

    def throw_parcels(self, source: Source, step: float, most: float, wind: np.ndarray) -> np.ndarray:
        """Parcels (n, 9), columns as in `Spray`, that a source throws within `step` [s], moved to its end in a `wind`
        x, z [m/s] at 10 m. So many drops share a parcel that there are about `most` parcels or fewer."""
        volume = 4.0 / 3.0 * np.pi * source.radius**3 * np.exp(4.5 * RADIUS_DEVIATION**2)  # mean of a drop [m3]
        number = source.mass * step / (WATER_DENSITY * volume)
        each = max(float(number.sum()) / most, 1.0)  # drops of a parcel
        many = np.floor(number / each + numpy_uniform(self.seed, SPRAY_STREAM, source.key, self.frame)).astype(int)
        which = np.repeat(np.arange(len(many)), many)
        rank = np.arange(len(which)) - (np.cumsum(many) - many)[which]
        key = KEYS_PER_PLACE * source.key[which] + np.minimum(rank, KEYS_PER_PLACE - 1)
        a, b, c = (numpy_uniform3(self.seed, SPRAY_STREAM + k, key, self.frame) for k in (1, 2, 3))
        share = 0.5 + 0.5 * c
        bell = np.sqrt(-2.0 * np.log(share[:, 0])) * np.cos(np.pi * c[:, 1])  # Box & Muller (1958)
        radius = (source.radius + 0.0 * source.speed)[which] * np.exp(RADIUS_DEVIATION * bell)
        towards = np.broadcast_to(source.towards, source.place.shape)[which] + DIRECTION_SCATTER * b * self.axes
        fast = source.speed[which] * np.minimum(np.sqrt(-np.log(share[:, 2])), MAX_SPEED_FACTOR)
        velocity = source.flow[which] + (fast / np.linalg.norm(towards, axis=1))[:, None] * towards
        since = 0.5 * (1.0 + a[:, 1]) * step
        place = source.place[which] + source.extent * a * self.axes * [1.0, 0.0, 1.0]
        place = place - since[:, None] * source.flow[which]
        spread = radius * (PARCEL_SPACING * np.sqrt(each) if each > 1.0 else 1.0)
        return fly_parcels(np.column_stack([place, velocity, radius, np.full(len(key), each), spread]), since, wind)


def fly_parcels(parcels: np.ndarray, seconds: np.ndarray | float, wind: np.ndarray) -> np.ndarray:
    """Parcels (n, 9: position, velocity, radius of a drop, number of drops, radius of the parcel) after `seconds` of
    weight and linear drag: terminal speed of Atlas et al. (1973, Rev. Geophys. 11). `wind`: x, z [m/s] at 10 m."""
    place, velocity, many = parcels[:, :3], parcels[:, 3:6], parcels[:, 7]
    falling = np.maximum(9.65 - 10.3 * np.exp(-1200.0 * parcels[:, 6]), 0.1)
    left = np.exp(-GRAVITY * seconds / falling)[:, None]
    share = np.log(np.clip(place[:, 1], 0.1, 10.0) / AIR_ROUGHNESS) / np.log(10.0 / AIR_ROUGHNESS)
    final = np.column_stack([share * wind[0], -falling, share * wind[1]])
    way = final * np.reshape(seconds, (-1, 1)) + (velocity - final) * (1.0 - left) * (falling / GRAVITY)[:, None]
    wider = parcels[:, 8] + PARCEL_WIDENING * np.linalg.norm(velocity, axis=1) * seconds * (many > 1.0)
    return np.column_stack([place + way, final + (velocity - final) * left, parcels[:, 6:8], wider])


def cross_section(parcels: np.ndarray) -> np.ndarray:
    """Total cross-section (n,) [m2] of a parcel's drops; columns 6 and 7 of (n, 9) are their radius [m] and number."""
    return np.asarray(parcels[:, 7] * np.pi * parcels[:, 6] ** 2)


def foam_sources(
    place: np.ndarray, flow: np.ndarray, shares: np.ndarray, cell: np.ndarray, crest_speed: float, wind: np.ndarray
) -> list[Source]:
    """Two sources of spray on cells of a sea with sides `cell` [m]: crests that break, at a share of the phase speed
    `crest_speed` [m/s], and foam torn by a wind x, z [m/s] at 10 m. `shares` (2, n): share of each cell that turns
    white per second [1/s], and that is white; `place`, `flow` (n, 3): position [m] and velocity [m/s] of the water."""
    slow, u10, ahead = BREAKER_SPEED_SHARE * crest_speed, float(np.hypot(*wind)), np.insert(wind, 1, np.hypot(*wind))
    drag = 0.0  # [Pa] of a wind that tears foam
    if u10 > SPINDRIFT_WIND:
        from ocean_sim.wind.shared.air_load import stress

        drag = stress(u10)
    speeds = CREST_STEEPNESS * slow, (drag / AIR_DENSITY) ** 0.5
    powers = BREAKING_STRENGTH * WATER_DENSITY * slow**4 / GRAVITY, drag * u10  # [W/m2]
    sources = []
    for k, (share, speed, power) in enumerate(zip(shares, speeds, powers, strict=True)):
        some = np.flatnonzero(share * power)
        fast = np.full(len(some), speed)
        mass, radius = thrown_mass(share[some] * power * cell.prod(), fast), SPUME_RADIUS if k else drop_radius(fast)
        there = k * len(share) + some, place[some], 0.5 * float(cell.max()), flow[some]
        sources.append(Source(*there, ahead if k else UP, fast, radius, mass))
    return sources


def airborne_source(position: np.ndarray, velocity: np.ndarray, floor: np.ndarray, spacing: float) -> Source:
    """Source of spray at particles of the run, at `position` (n, 3) [m] with `velocity` (n, 3) [m/s] and `spacing` [m],
    that fly apart over a floor at heights `floor` (n,) [m]."""
    from scipy.spatial import cKDTree

    up = flying_share(position, floor, spacing)
    some = np.flatnonzero(up)
    x, v = position[some], velocity[some]
    near = cKDTree(x).query_ball_point(x, NEIGHBOUR_REACH * spacing, return_length=True) if len(x) else up[some]
    share = (near - 1.0) / LATTICE_NEIGHBOURS[int(position[:, 2].any())]
    speed, torn = np.linalg.norm(v, axis=1), up[some] * np.interp(share, TEARING_SHARES, (1.0, 0.0))
    mass = (speed > MIN_MEETING_SPEED) * torn * WATER_DENSITY * spacing**3 / SHEDDING_SECONDS
    return Source(some, x, 0.5 * spacing, v, UP, AIRBORNE_SCATTER * speed, drop_radius(speed), mass)


def flying_share(position: np.ndarray, floor: np.ndarray, spacing: float) -> np.ndarray:
    """Share (n,), 0 to 1, by which particles (n, 3) [m] count as flying: by the widest vertical gap in the water below
    each, down to the `floor` at heights (n,) [m]. `spacing`: of particles [m]."""
    low, size = position.min(axis=0)[[0, 2]] - 0.5 * spacing, np.ptp(position, axis=0)[[0, 2]] + spacing
    many = np.maximum(np.round(size / (COLUMN_BREADTH * spacing)), 1.0)  # of whole breadths: none is half behind a side
    x, z = np.floor((position[:, [0, 2]] - low) * (many / size)).astype(np.int64).T
    number = x * int(many[1] + 1) + z
    order = np.lexsort((position[:, 1], number))
    height, column = position[order, 1] / spacing, number[order]
    lowest = np.diff(column, prepend=-1) > 0
    below = np.where(lowest, floor[order] / spacing - 0.5, np.roll(height, 1))
    gap = np.clip(height - below, 0.0, 2.0 * FLYING_GAPS[1]) / (2.0 * FLYING_GAPS[1])
    widest = np.empty(len(position))
    widest[order] = np.maximum.accumulate(2.0 * column + gap) - 2.0 * column
    return np.interp(2.0 * FLYING_GAPS[1] * widest, FLYING_GAPS, (0.0, 1.0))


def floor_heights(position: np.ndarray, bed: float | np.ndarray, obstacles: np.ndarray) -> np.ndarray:
    """Heights (n,) [m] of the bed (one or (n,)) or of obstacles, boxes (m, 2, 3) [m], below particles (n, 3) [m]."""
    (x, y, z), (low, up) = position.T[..., None], np.moveaxis(obstacles, 1, 0)
    over = (x > low[:, 0]) & (x < up[:, 0]) & (z > low[:, 2]) & (z < up[:, 2]) & (y > up[:, 1])
    return np.maximum(bed, np.where(over, up[:, 1], -np.inf).max(axis=1, initial=-np.inf))


def bow_source(
    number: int, size: np.ndarray, foot: np.ndarray, meets: np.ndarray, ahead: np.ndarray, heights_at: Heights
) -> Source:
    """Source of spray at the bow of ship `number`, by the energy in her bow crest. `size`: breadth, length [m]; `foot`
    (3,): of her stem [m]; `meets` (3,): its velocity through the water [m/s]; `ahead` (3,): level unit vector."""
    plunging = max(-float(meets[1]), 0.0) * (foot[1] < heights_at(foot[None, [0, 2]])[0])
    onward, wedge = max(float(meets @ ahead), 0.0), Bow(float(size[1]), float(size[0]), 1.0).wedge
    bow = Bow(float(size[1]), float(size[0]), float(onward + plunging * BOW_FLARE / wedge))
    (crest, back), abaft = bow.crest, np.tile((np.arange(BOW_POINTS) + 0.5) / BOW_POINTS * ENTRANCE_LENGTH * size[1], 2)
    width, out = CREST_WIDTH * size[0] + 0.25 * back, np.repeat([[1.0], [-1.0]], BOW_POINTS, 0) * np.cross(UP, ahead)
    place = foot - abaft[:, None] * ahead + (bow.half_breadth(abaft) + 0.5 * width)[:, None] * out
    place[:, 1] = heights_at(place[:, [0, 2]]) + 0.7 * crest
    share = np.exp(-abaft / (back + CREST_WIDTH * size[0]))
    power = bow.breaks * WATER_DENSITY * GRAVITY * bow.rise**2 * bow.speed * width * share / share.sum()
    speed, key = np.full(len(place), np.sqrt(2.0 * GRAVITY * bow.rise)), number * 2 * BOW_POINTS + np.arange(len(place))
    flow, towards = 0.3 * onward * ahead + 0.0 * place, UP + 0.7 * out + 0.2 * ahead
    return Source(key, place, 0.25 * width, flow, towards, speed, drop_radius(speed), thrown_mass(power, speed))
