"""Spray and bubbles: white drops around particles that have left the water, or that are fast among others that go
elsewhere. What of them is under water is seen through it."""

import numpy as np

from ocean_sim.conventions import GRAVITY
from ocean_sim.pictures.far_sea import OUT
from ocean_sim.pictures.stage import Stage
from ocean_sim.random_numbers import numpy_uniform

NEIGHBOURHOOD, FEW = 1.6, 3  # [spacings], and the most neighbours that a isolated particle has in it
ABOVE = 0.6  # [spacings] over the water
FINE, COARSE = (0.30, 0.009), (0.65, 0.018)  # [spacings] radius of a puff and of a drop: on a sea, in a tank
DROPS, KINDS = 24, 64  # that fly in a puff; and of how many kinds puffs are
NEIGHBOURS = 24  # of a particle, itself among them
MOST = 1500  # puffs in a picture
FAST = 0.12, 0.60  # of g times the depth of a tank: square of the speed from which water is stirred, and is wholly so
STIRRED = 0.08, 0.30  # of the speed of its neighbours: how far a particle's own is off theirs, likewise
OFFSETS = 0x5_0003  # stream of random numbers


def isolated(position: np.ndarray, spacing: float, high: np.ndarray) -> np.ndarray:
    """(m,) which of the high ones (m, 3) among particles (n, 3) have left the water, by how few others are near."""
    from scipy.spatial import cKDTree

    if not len(high):
        return np.zeros(0, bool)
    near = cKDTree(position).query_ball_point(high, NEIGHBOURHOOD * spacing, return_length=True)
    return near - 1 <= FEW


def normal(uniform: np.ndarray) -> np.ndarray:
    """(n, 3) normally distributed numbers of variance 1/4 from (n, 6) evenly distributed ones (Box & Muller 1958)."""
    radius, angle = np.sqrt(-2.0 * np.log(1.0 - uniform[:, :3])), 2.0 * np.pi * uniform[:, 3:]
    return 0.5 * radius * np.cos(angle)


def stirred(position: np.ndarray, velocity: np.ndarray, depth: float) -> np.ndarray:
    """(n,) share, 0 to 1, of air in the water of particles (n, 3) [m] with velocities (n, 3) [m/s], in a tank of this
    depth [m]: where they are fast and go otherwise than their neighbours, after the potentials of Ihmsen, Akinci,
    Akinci & Teschner (2012, Vis. Comput. 28). The bounds are ours."""
    from scipy.spatial import cKDTree

    air = ramp((velocity**2).sum(axis=1) / (GRAVITY * depth), FAST)
    fast = np.flatnonzero(air > 0.0)
    if not len(fast) or len(position) < 2:
        return np.zeros(len(position))
    _, near = cKDTree(position).query(position[fast], k=min(NEIGHBOURS, len(position)), workers=1)
    around = velocity[near]
    off = np.linalg.norm(around - around.mean(axis=1, keepdims=True), axis=2).mean(axis=1)
    air[fast] *= ramp(off / np.linalg.norm(velocity[fast], axis=1), STIRRED)
    return air


def ramp(value: np.ndarray, bounds: tuple[float, float]) -> np.ndarray:
    """0 below the first bound, 1 from the second."""
    return np.clip((value - bounds[0]) / (bounds[1] - bounds[0]), 0.0, 1.0)


class Spray:
    """A fixed number of puffs; those not needed wait below the sea."""

    def __init__(self, stage: Stage, spacing: float, sizes: tuple[float, float] = FINE) -> None:
        """`sizes`: radius of a puff and of a drop [spacings]."""
        self.spacing, (puff, drop) = spacing, sizes
        self.positions = np.tile(np.array([0.0, -OUT, 0.0], np.float32), (MOST * DROPS, 1))
        n = np.arange(KINDS * DROPS)
        offsets = puff * spacing * normal(np.stack([numpy_uniform(0, OFFSETS, n, k) for k in range(6)], axis=1))
        self.offsets = offsets.reshape(KINDS, DROPS, 3)
        self.cloud = stage.pyvista.PolyData(self.positions)
        drops = stage.plotter.add_mesh(
            self.cloud, color="white", style="points_gaussian", render_points_as_spheres=False, lighting=False
        )
        drops.mapper.scale_factor = drop * spacing
        self.drawn = drops.mapper.dataset

    def show(self, position: np.ndarray, heights: np.ndarray) -> None:
        """Particles (n, 3) and the heights (n,) of the water below them [m]."""
        high = position[position[:, 1] > heights + ABOVE * self.spacing]
        flying = high[isolated(position, self.spacing, high)]
        self.place(flying, np.arange(len(flying)), np.ones(len(flying)))

    def place(self, centres: np.ndarray, numbers: np.ndarray, shares: np.ndarray) -> None:
        """Puffs around centres (n, 3) [m], each with its share, 0 to 1, of the drops; `numbers` (n,): by which each
        finds its kind of puff in every picture."""
        kept = np.argsort(-shares, kind="stable")[:MOST]
        drops = centres[kept, None] + self.offsets[numbers[kept] % KINDS]
        flying = drops[np.arange(DROPS) < np.ceil(DROPS * shares[kept])[:, None]]
        positions = self.positions.copy()
        positions[: len(flying)] = flying
        self.drawn.points = positions
