"""White water: where crests converge, at a wanted cover; along a hull; and how a share of foam breaks into patches."""

import numpy as np

from ocean_sim.pictures.ripples import noise
from ocean_sim.waves.orbits import falling

# Convergence of a linear wave, its downward acceleration over gravity, at which crests turn white: ours; Snyder and
# Kennedy (1983, J. Phys. Oceanogr. 13) take 0.4 for the points where breaking begins.
BREAKING = 0.30
MOST = 0.10  # share of the sea that may be white where none is asked for
MIDDLE, SPREAD = 0.521, 0.137  # mean and standard deviation of `patches`
SCALE = 1.6  # of the grain of foam [1/m]
SOFT = 0.28  # of a share: how far the edges of foam fade


def convergence(elevation: np.ndarray, spacing_x: float, spacing_z: float) -> np.ndarray:
    """(nx, nz) how far water near the surface is drawn together, minus the divergence of its displacement.

    By linear theory on deep water: the elevation times its wavenumber. Waves stand level at the sides of the grid.
    """
    return falling(elevation, spacing_x, spacing_z)


def cover(drawn_together: np.ndarray) -> float:
    """The share of the sea that is white where none is asked for: where crests fall faster than they can."""
    return float(min((drawn_together > BREAKING).mean(), MOST))


def shares(drawn_together: np.ndarray, wanted: float, among: np.ndarray | None = None) -> np.ndarray:
    """How white each point is, 0 to 1, so that the mean is the wanted cover: 1 on the strongest convergence.

    `among`: values among which the ranks are counted, by default the points themselves.
    """
    known = np.sort(np.ravel(drawn_together if among is None else among))
    if wanted <= 0.0 or known[0] == known[-1]:
        return np.zeros(np.shape(drawn_together))
    upper = 1.0 - np.searchsorted(known, drawn_together, side="right") / len(known)
    return np.clip(1.0 - upper / (2.0 * min(wanted, 0.5)), 0.0, 1.0)


def patches(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """The grain of foam at positions [m], about 0 to 1: blobs and threads."""

    def at(scale: float, shift: float) -> np.ndarray:
        return noise(x * SCALE * scale + shift, z * SCALE * scale + shift)[0]

    blobs = 0.5 * at(1.7, 3.0) + 0.3 * at(4.1, 0.0) + 0.2 * at(9.7, 0.0)
    thick, thin = 1.0 - np.abs(2.0 * at(2.6, 9.0) - 1.0), 1.0 - np.abs(2.0 * at(6.3, 2.0) - 1.0)
    return 0.55 * blobs + 0.30 * thick**2 + 0.25 * thin**2


def white(share: np.ndarray, x: np.ndarray, z: np.ndarray, footprint: np.ndarray) -> np.ndarray:
    """How white a pixel is: the share broken into patches where they are wider than its footprint [m]. The mean over
    an area stays the share's, as patches are thresholded by their own distribution."""
    rank = 1.0 / (1.0 + np.exp(-1.702 * (patches(x, z) - MIDDLE) / SPREAD))
    low = np.maximum(rank - SOFT, 0.0)
    edge = np.clip((share - low) / (2.0 * SOFT), 0.0, 1.0)
    fine = np.clip(1.0 - footprint / 0.3, 0.0, 1.0)
    return np.where(share > 0.0, share + (edge * edge * (3.0 - 2.0 * edge) - share) * fine, 0.0)


def waterline(vertices: np.ndarray, triangles: np.ndarray, above: np.ndarray) -> np.ndarray:
    """(m, 2, 2) segments x, z at which a hull (n, 3) meets the water; `above`: (n,) height over it [m]."""
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


def distance(points: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """(n,) from points (n, 2) to the nearest segment [m], negative inside the closed line that they make."""
    start, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    offset = points[:, None] - start
    share = np.clip((offset * along).sum(axis=2) / np.maximum((along**2).sum(axis=1), 1e-12), 0.0, 1.0)
    away = np.sqrt(((offset - share[..., None] * along) ** 2).sum(axis=2).min(axis=1))
    low, high = segments[:, 0, 1], segments[:, 1, 1]
    z = points[:, None, 1]
    spans = (low > z) != (high > z)
    slope = along[:, 0] / np.where(along[:, 1] == 0.0, 1.0, along[:, 1])
    inside = (spans & (points[:, None, 0] < start[:, 0] + (z - low) * slope)).sum(axis=1) % 2 == 1
    return np.where(inside, -away, away)
