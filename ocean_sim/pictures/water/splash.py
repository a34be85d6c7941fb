"""Splashes in a tank: aerated water, its rough and torn surface, and drops that fly from it, at the vertices of the
surface mesh. Spray over a sea: drops around particles that have left the water. Both are only drawn, since they are
finer than particles."""

from typing import NamedTuple

import numpy as np

from ocean_sim.conventions import GRAVITY
from ocean_sim.pictures.stage.plotter import Stage
from ocean_sim.pictures.water.far_sea import SEA_RADIUS
from ocean_sim.random_numbers import numpy_uniform
from ocean_sim.surface import Mesh

# Squares of the speeds from which water is stirred, and is wholly so, over g times the depth of a tank
STIRRING_SPEEDS = (0.15, 0.80)
STIRRING_DEVIATIONS = 0.12, 0.60  # of the speed of its neighbours: how far a particle's own is off theirs, likewise
STIRRING_NEIGHBOURS = 24  # of a particle, itself among them
# [spacings], and neighbours in it below which water comes apart, and wholly so
NEIGHBOURHOOD, TEARING_NEIGHBOURS = 1.6, (12.0, 6.0)
# [spacings] breadth of a column, and of air in it below a particle that flies
COLUMN_BREADTH, FLYING_GAPS = 2.0, (2.2, 3.5)
# [spacings] over the mean height of the water so far around it, at which it splashes
SPLASH_RISES, MEAN_WIDTH = (1.5, 5.0), 6.0
# [spacings] from where the first picture had it: from where water may splash up, and wholly may
SETTING_OFF_WAYS = (0.5, 2.0)
LACKING_NEIGHBOURS = 5  # neighbours that a particle lacks at a side
# Particles that a vertex asks, and how far away [spacings] they have nothing to say
VERTEX_PARTICLES, VERTEX_REACH = 8, 2.5
# Drops that fly around a particle of water wholly torn, and particles that have any
PARTICLE_DROPS, MAX_TORN_PARTICLES = 20, 500
DROP_SIZES = 0.060, 0.50  # [spacings] median radius of a drop, and standard deviation of its logarithm
AIR_SHARES = 0.5, 0.3  # share of air in water wholly torn, and where it splashes up
MAX_DROP_RADIUS, MIN_DROPS = 0.20, 2  # [spacings]; and drops below which none fly
DROP_SPREAD, DROP_TRAIL = 0.9, 1.2  # [spacings] of drops from their particle, and how much farther along its way
DROP_STREAM = 0x5_0004  # of random numbers
# Spray over a sea.
MAX_SPRAY_NEIGHBOURS = 3  # within the neighbourhood of a particle that has left a sea
MIN_SPRAY_HEIGHT = 0.6  # [spacings] over the water
PUFF_RADIUS, PUFF_DROP_RADIUS = 0.30, 0.009  # [spacings]
PUFF_DROPS, PUFF_KINDS = 24, 64  # drops that fly in a puff, and different puffs
MAX_PUFFS = 1500  # in a picture
PUFF_STREAM = 0x5_0003  # stream of random numbers


def bell_numbers(uniform: np.ndarray) -> np.ndarray:
    """Normally distributed numbers (n, 3) of variance 1/4 from uniform ones (n, 6) in 0 to 1 (Box & Muller 1958)."""
    radius, angle = np.sqrt(-2.0 * np.log(1.0 - uniform[:, :3])), 2.0 * np.pi * uniform[:, 3:]
    return 0.5 * radius * np.cos(angle)


class Splash(NamedTuple):
    """Look of splashing water around each particle: share of air, tearing and roughness."""

    air: np.ndarray  # (n,) share, 0 to 1, of air in their water
    torn: np.ndarray  # (n,) 0 to 1, how far their water has come apart
    rough: np.ndarray  # (n,) 0 to 1, how wrinkled its skin is


def clipped_ramp(value: np.ndarray, bounds: tuple[float, float]) -> np.ndarray:
    """Linear ramp of a value: 0 at the first bound, 1 at the second, constant beyond both."""
    return np.clip((value - bounds[0]) / (bounds[1] - bounds[0]), 0.0, 1.0)


def stirred_air(position: np.ndarray, velocity: np.ndarray, depth: float) -> np.ndarray:
    """Share (n,) of air, 0 to 1, in the water around particles at positions (n, 3) [m] with velocities (n, 3) [m/s], in
    a tank of a depth [m]: large where particles are fast and move unlike their neighbours (Ihmsen, Akinci, Akinci &
    Teschner 2012, Vis. Comput. 28). The bounds are ours."""
    from scipy.spatial import cKDTree

    air = clipped_ramp((velocity**2).sum(axis=1) / (GRAVITY * depth), STIRRING_SPEEDS)
    fast = np.flatnonzero(air > 0.0)
    if not len(fast) or len(position) < 2:
        return np.zeros(len(position))
    _, near = cKDTree(position).query(position[fast], k=min(STIRRING_NEIGHBOURS, len(position)), workers=1)
    around = velocity[near]
    off = np.linalg.norm(around - around.mean(axis=1, keepdims=True), axis=2).mean(axis=1)
    air[fast] *= clipped_ramp(off / np.linalg.norm(velocity[fast], axis=1), STIRRING_DEVIATIONS)
    return air


def flying_share(position: np.ndarray, floor: np.ndarray, spacing: float) -> np.ndarray:
    """Degree (n,), 0 to 1, to which particles (n, 3) [m] are in the air: by the widest gap without particles between
    each and the floor at heights (n,) [m] below it; `spacing` of particles [m]."""
    low, size = position.min(axis=0)[[0, 2]] - 0.5 * spacing, np.ptp(position, axis=0)[[0, 2]] + spacing
    broad = size / np.maximum(np.round(size / (COLUMN_BREADTH * spacing)), 1.0)  # so that none is half behind a side
    column = np.floor((position[:, [0, 2]] - low) / broad).astype(np.int64)
    _, number = np.unique(column, axis=0, return_inverse=True)
    number = number.ravel()
    order = np.lexsort((position[:, 1], number))
    height, column = position[order, 1] / spacing, number[order]
    lowest = np.diff(column, prepend=-1) > 0
    below = np.where(lowest, floor[order] / spacing - 0.5, np.roll(height, 1))
    gap = np.clip(height - below, 0.0, 2.0 * FLYING_GAPS[1]) / (2.0 * FLYING_GAPS[1])
    widest = np.empty(len(position))
    widest[order] = np.maximum.accumulate(2.0 * column + gap) - 2.0 * column
    return clipped_ramp(2.0 * FLYING_GAPS[1] * widest, FLYING_GAPS)


def floor_heights(position: np.ndarray, bed: float | np.ndarray, obstacles: np.ndarray) -> np.ndarray:
    """Heights (n,) [m] of the floor below particles (n, 3) [m]: that of the bed [m], one or (n,), or of obstacles
    (m, 2, 3) [m]."""
    floor = np.full(len(position), bed)
    for low, up in obstacles:
        over = np.all((position[:, [0, 2]] > low[[0, 2]]) & (position[:, [0, 2]] < up[[0, 2]]), axis=1)
        floor = np.where(over & (position[:, 1] > up[1]), np.maximum(floor, up[1]), floor)
    return floor


def risen_share(
    position: np.ndarray, elevation: np.ndarray, lower: np.ndarray, cell: np.ndarray, spacing: float
) -> np.ndarray:
    """Degree (n,), 0 to 1, to which particles (n, 3) [m] are above the mean water height around them, from heights (nx,
    nz) [m] on a grid with its corner at `lower` x, z and cells of sides `cell` [m]."""
    from scipy.ndimage import gaussian_filter, map_coordinates

    mean = gaussian_filter(elevation, MEAN_WIDTH * spacing / cell, mode="nearest")
    at = ((position[:, [0, 2]] - lower) / cell - 0.5).T
    over = position[:, 1] - map_coordinates(mean, at, order=1, mode="nearest")
    return clipped_ramp(over / spacing, SPLASH_RISES)


def travel_share(
    position: np.ndarray, number: np.ndarray, birth: np.ndarray, first: np.ndarray, spacing: float
) -> np.ndarray:
    """Degree (n,), 0 to 1, to which particles (n, 3) [m] have left their first positions `birth` (n, 3) [m]; 1 for ids
    `number` not in `first`. Particles at the edge of a column that still stands have not splashed."""
    gone = clipped_ramp(np.linalg.norm(position - birth, axis=1) / spacing, SETTING_OFF_WAYS)
    return np.where(np.isin(number, first), gone, 1.0)


def particle_splash(
    position: np.ndarray, velocity: np.ndarray, up: np.ndarray, sides: np.ndarray, spacing: float, depth: float
) -> Splash:
    """Splash of particles (n, 3) [m] with velocities (n, 3) [m/s]. Water is torn if it is fast, or `up` in the air
    (n,), 0 to 1, and has few neighbours; `sides` (n,): number of walls beside each, behind which there are none."""
    from scipy.spatial import cKDTree

    rough = np.maximum(clipped_ramp((velocity**2).sum(axis=1) / (GRAVITY * depth), STIRRING_SPEEDS), up)
    torn, some = np.zeros(len(position)), np.flatnonzero(rough > 0.0)
    if len(some):
        near = cKDTree(position).query_ball_point(position[some], NEIGHBOURHOOD * spacing, return_length=True) - 1
        torn[some] = rough[some] * clipped_ramp(near + LACKING_NEIGHBOURS * sides[some], TEARING_NEIGHBOURS)
    air = np.maximum(stirred_air(position, velocity, depth), np.maximum(AIR_SHARES[0] * torn, AIR_SHARES[1] * up))
    return Splash(air, torn, rough)


def values_at_vertices(vertices: np.ndarray, position: np.ndarray, values: np.ndarray, spacing: float) -> np.ndarray:
    """Values (m, k) at vertices (m, 3) [m]: distance-weighted means of the `values` (n, k) of nearby particles."""
    from scipy.spatial import cKDTree

    away, near = cKDTree(position).query(vertices, k=min(VERTEX_PARTICLES, len(position)), workers=1)
    away, near = away.reshape(len(vertices), -1), near.reshape(len(vertices), -1)
    weight = np.square(np.maximum(1.0 - np.square(away / (VERTEX_REACH * spacing)), 1e-6))
    return np.einsum("mj,mjk->mk", weight / weight.sum(axis=1, keepdims=True), values[near])


def birth_places(position: np.ndarray, number: np.ndarray, first_position: np.ndarray, first: np.ndarray) -> np.ndarray:
    """Positions (n, 3) [m] in the first picture of particles of ids `number` (n,), where foam patterns are drawn, so
    that they move and stretch with the water; the present positions of particles that are new."""
    if not len(first):
        return position
    order = np.argsort(first)
    found = order[np.minimum(np.searchsorted(first[order], number), len(first) - 1)]
    return np.where((first[found] == number)[:, None], first_position[found], position)


def torn_drops(
    position: np.ndarray, velocity: np.ndarray, number: np.ndarray, torn: np.ndarray, spacing: float
) -> tuple[np.ndarray, np.ndarray]:
    """Middles (m, 3) and radii (m,) [m] of drops around particles (n, 3) [m]: more of them the larger `torn` (n,), 0 to
    1, and spread along velocities (n, 3). `number` (n,): ids, which choose the same drops in every picture."""
    some = np.argsort(-torn, kind="stable")[:MAX_TORN_PARTICLES]
    some = some[torn[some] > 0.0]
    which = np.arange(PARTICLE_DROPS)
    seed = (number[some, None] * PARTICLE_DROPS + which).ravel()
    uniform = np.stack([numpy_uniform(0, DROP_STREAM, seed, k) for k in range(8)], axis=1)
    offset = DROP_SPREAD * spacing * 2.0 * bell_numbers(uniform[:, :6]).reshape(len(some), PARTICLE_DROPS, 3)
    way = velocity[some] / np.maximum(np.linalg.norm(velocity[some], axis=1, keepdims=True), 1e-9)
    offset += DROP_TRAIL * (offset * way[:, None]).sum(axis=2, keepdims=True) * way[:, None]
    bell = np.sqrt(-2.0 * np.log(1.0 - uniform[:, 6])) * np.cos(2.0 * np.pi * uniform[:, 7])
    radius = np.minimum(DROP_SIZES[0] * np.exp(DROP_SIZES[1] * bell), MAX_DROP_RADIUS) * spacing
    radius = radius.reshape(len(some), PARTICLE_DROPS)
    flying = which < (PARTICLE_DROPS * torn[some] - MIN_DROPS)[:, None]
    return (position[some, None] + offset)[flying], radius[flying]


def sphere_mesh(middles: np.ndarray, radii: np.ndarray, ball: Mesh) -> Mesh:
    """Mesh of spheres with middles (m, 3) and radii (m,) [m]; `ball`: mesh of radius 1 that is copied."""
    n, k = len(middles), len(ball.vertices)
    vertices = middles[:, None] + radii[:, None, None] * ball.vertices
    triangles = ball.triangles + k * np.arange(n)[:, None, None]
    return Mesh(vertices.reshape(-1, 3), triangles.reshape(-1, 3), np.tile(ball.normals, (n, 1)))


def has_left_water(position: np.ndarray, spacing: float, high: np.ndarray) -> np.ndarray:
    """Mask (m,): True for points `high` (m, 3) [m] that have few neighbours among particles `position` (n, 3) [m]."""
    from scipy.spatial import cKDTree

    if not len(high):
        return np.zeros(0, bool)
    near = cKDTree(position).query_ball_point(high, NEIGHBOURHOOD * spacing, return_length=True)
    return near - 1 <= MAX_SPRAY_NEIGHBOURS


class Spray:
    """Spray above a sea: puffs of drops in a fixed number, of which unused ones are hidden far below."""

    def __init__(self, stage: Stage, spacing: float) -> None:
        self.spacing = spacing
        self.positions = np.tile(np.array([0.0, -SEA_RADIUS, 0.0], np.float32), (MAX_PUFFS * PUFF_DROPS, 1))
        n = np.arange(PUFF_KINDS * PUFF_DROPS)
        uniform = np.stack([numpy_uniform(0, PUFF_STREAM, n, k) for k in range(6)], axis=1)
        self.offsets = (PUFF_RADIUS * spacing * bell_numbers(uniform)).reshape(PUFF_KINDS, PUFF_DROPS, 3)
        self.cloud = stage.pyvista.PolyData(self.positions)
        shown = {"color": "white", "style": "points_gaussian", "render_points_as_spheres": False, "lighting": False}
        drops = stage.plotter.add_mesh(self.cloud, **shown)
        drops.mapper.scale_factor = PUFF_DROP_RADIUS * spacing
        self.drawn = drops.mapper.dataset

    def show(self, position: np.ndarray, heights: np.ndarray) -> None:
        """Draw puffs at particles (n, 3) [m] that have left the water; `heights` (n,): of the water below them [m]."""
        high = position[position[:, 1] > heights + MIN_SPRAY_HEIGHT * self.spacing]
        centres = high[has_left_water(position, self.spacing, high)][:MAX_PUFFS]
        drops = (centres[:, None] + self.offsets[np.arange(len(centres)) % PUFF_KINDS]).reshape(-1, 3)
        positions = self.positions.copy()
        positions[: len(drops)] = drops
        self.drawn.points = positions
