"""Hull of a drawn ship: the triangles of the physical hull, painted by their height over the still water."""

import numpy as np

from ocean_sim.pictures.ships.ship_parts import (
    Mesh,
    Triple,
    area_vectors,
    flat_mesh,
    merge_meshes,
    mirrored_pair,
    paint_bands,
    path_mesh,
    plain_mesh,
    quad_triangles,
    smooth_normals,
)
from ocean_sim.pictures.stage.sky import unit_vector

MIN_DECK_NORMAL = 0.7  # upward share of the normal of a deck
MIN_DECK_HEIGHT = 0.6  # of the hull's depth
MIN_DECK_LENGTH, MAX_DECK_RISE = 0.8, 0.4  # of the hull's length and depth: a deck to stand on
BOOT_TOP = 0.04, 0.14  # of the freeboard: lower and upper edge of the boot top over the still water
BULWARK_STATIONS = 49


class Hull:
    """Physical hull of a ship in body axes from her centre of mass, and the plane of the still water at rest."""

    def __init__(self, vertices: np.ndarray, triangles: np.ndarray, share: float) -> None:
        """`share`: share of the hull's volume that is under water at rest."""
        self.vertices, self.triangles = vertices, triangles
        self.lower, self.upper = vertices.min(axis=0), vertices.max(axis=0)
        self.breadth, self.depth, self.length = self.upper - self.lower  # [m]
        corners = vertices[triangles]
        self.up, self.level = rest_plane(corners, share)
        across = area_vectors(corners)
        upward = across[:, 1] / np.maximum(np.linalg.norm(across, axis=1), 1e-30)
        high = corners[:, :, 1].min(axis=1) > self.lower[1] + MIN_DECK_HEIGHT * self.depth
        self.is_deck = (upward > MIN_DECK_NORMAL) & high
        self.values = np.concatenate([corners, smooth_normals(vertices, triangles)], axis=2)

    def over_water(self, points: np.ndarray) -> np.ndarray:
        """Heights (...) [m] of points (..., 3) [m] in body axes over the still water at rest."""
        return points @ self.up + self.level

    @property
    def freeboard(self) -> float:
        """Height of the top of the hull over the still water [m], not below a tenth of its depth."""
        return max(float(self.over_water(self.upper * [0.0, 1.0, 0.0])), 0.1 * self.depth)

    @property
    def has_deck(self) -> bool:
        """True if the hull has a deck for a superstructure: from end to end and more or less level."""
        deck = self.values[self.is_deck][:, :, :3].reshape(-1, 3)
        if not len(deck):
            return False
        _, rise, run = np.ptp(deck, axis=0)
        return bool(run > MIN_DECK_LENGTH * self.length and rise < MAX_DECK_RISE * self.depth)

    def painted(self, antifouling: Triple, boot_top: Triple, topsides: Triple, deck: Triple) -> Mesh:
        """Mesh of the hull painted by height: antifouling, boot top, topsides; the deck, if any, in its own colour."""
        low, high = (share * self.freeboard for share in BOOT_TOP)
        sides = self.values[~self.is_deck] if self.has_deck else self.values
        bands = [(low, antifouling), (high, boot_top), (np.inf, topsides)]
        hull = paint_bands(sides, self.up, self.level, bands)
        return merge_meshes([hull, flat_mesh(self.values[self.is_deck][:, :, :3], deck)]) if self.has_deck else hull

    def deck_edge(self) -> np.ndarray:
        """Points (n, 3) [m] of the port edge of the deck, from stern to bow."""
        points = self.vertices[np.unique(self.triangles[self.is_deck])]
        stations = [points[np.abs(points[:, 2] - z) < 1e-5] for z in np.unique(np.round(points[:, 2], 6))]
        port = np.array([there[there[:, 0].argmax()] for there in stations])
        return port[port[:, 0] > -1e-4 * self.breadth]


class Sheer:
    """Edge of a ship's deck and the bulwark on it, as functions of the position z along the ship [m]."""

    def __init__(self, hull: Hull, height: tuple[float, float], rake: float) -> None:
        """`height`: of the bulwark amidships and at the bow [m]; `rake`: forward lean of its top at the bow [m]."""
        from scipy.interpolate import PchipInterpolator

        edge = hull.deck_edge()
        self.edge, self.height, self.rake = edge, height, rake
        self.stern, self.bow = float(edge[0, 2]), float(edge[-1, 2])
        self.smooth = PchipInterpolator(edge[:, 2], edge[:, 0])
        self.stations = np.unique(np.concatenate([np.linspace(self.stern, self.bow, BULWARK_STATIONS), edge[:, 2]]))

    def half_breadth(self, z: float | np.ndarray) -> np.ndarray:
        """Half the breadth of the deck [m] at positions z (n,) [m] along the ship."""
        return np.interp(z, self.edge[:, 2], self.edge[:, 0])

    def deck_height(self, z: float | np.ndarray) -> np.ndarray:
        """Height of the deck's edge in body axes [m] at positions z (n,) [m]."""
        return np.interp(z, self.edge[:, 2], self.edge[:, 1])

    def bulwark_height(self, z: np.ndarray) -> np.ndarray:
        """Height (n,) [m] of the bulwark over the deck at positions z (n,) [m], greatest at the bow."""
        s = (z - self.stern) / (self.bow - self.stern)
        forward, aft = np.clip((s - 0.35) / 0.65, 0.0, 1.0), np.clip((0.25 - s) / 0.25, 0.0, 1.0)
        low, high = self.height
        return low + (high - low) * (forward**2 + 0.25 * aft**2)

    def bulwark_top(self, z: np.ndarray, inwards: float = 0.0, share: float = 1.0) -> np.ndarray:
        """Line (n, 3) [m] on the port bulwark at z (n,) [m], at a share of its height, shifted `inwards` [m]."""
        s = np.clip((z - self.stern) / (self.bow - self.stern), 0.0, 1.0)
        rise = self.bulwark_height(z)
        round_half = np.maximum(self.smooth(z), self.half_breadth(z)) + 0.06 * rise * np.sin(np.pi * s**2) ** 2
        x = np.maximum(round_half - inwards, 0.0)
        return np.stack([x, self.deck_height(z) + share * rise, z + (share * self.rake - 0.7 * inwards) * s**6], axis=1)

    def bulwark(self, colour: Triple, inside: Triple, cap: Triple, thick: float) -> Mesh:
        """Mesh of the bulwark, its walls `thick` [m] apart and its cap, on both sides and across blunt ends."""
        z = self.stations
        foot = np.stack([self.half_breadth(z), self.deck_height(z), z], axis=1)
        top, inner = self.bulwark_top(z), self.bulwark_top(z, thick)
        inner_foot = np.column_stack([np.maximum(foot[:, 0] - thick, 0.0), foot[:, 1:]])
        strips = ((foot, top, colour), (inner, inner_foot, inside), (top, inner, cap))
        parts = [mirrored_pair(smooth_strip(low, high, paint)) for low, high, paint in strips]
        for end, sense in ((0, 1.0), (-1, -1.0)):
            if foot[end, 0] < thick:
                continue
            x = np.linspace(sense, -sense, 9)[:, None] * [1.0, 0.0, 0.0] + [0.0, 1.0, 1.0]
            low, high = foot[end] * x, top[end] * x
            ahead = np.array([0.0, 0.0, sense * thick])
            strips = ((high, low, colour), (low + ahead, high + ahead, inside), (high + ahead, high, cap))
            parts += [smooth_strip(a, b, paint) for a, b, paint in strips]
        return merge_meshes(parts)

    def strake(self, share: float, out: float, radius: float, colour: Triple) -> Mesh:
        """Mesh of a round bar of a radius [m] along sides and stern, `out` [m] off a share of the bulwark's height."""
        port = self.bulwark_top(self.stations, share=share) + [out, 0.0, 0.0]
        port[-1] = port[-1] * [0.0, 1.0, 1.0] + [0.0, 0.0, out]
        across = port[[0]] * np.array([[1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]])
        return merge_meshes([mirrored_pair(path_mesh(port, radius, colour)), path_mesh(across, radius, colour)])


def smooth_strip(low: np.ndarray, high: np.ndarray, colour: Triple) -> Mesh:
    """Mesh of quadrilaterals between two lines (n, 3) [m], with smooth normals along them."""
    vertices, (a, b) = np.concatenate([low, high]), np.arange(2 * len(low)).reshape(2, -1)
    triangles = quad_triangles(a[:-1], b[:-1], b[1:], a[1:])
    kept = triangles[np.linalg.norm(area_vectors(vertices[triangles]), axis=1) > 1e-12]
    return plain_mesh(vertices[kept], smooth_normals(vertices, kept), colour)


def rest_plane(corners: np.ndarray, share: float) -> tuple[np.ndarray, float]:
    """Plane of the still water at rest in body axes: normal n (3,) and d [m]; n . x + d is the height of x above it.
    The `share` of the volume under water is given, and its centre of buoyancy lies below the centre of mass, the
    origin. A hull without such a position within 30 degrees is taken as upright, awash at most."""
    from scipy.optimize import brentq, root

    upright = np.array([0.0, 1.0, 0.0])
    top, keel = -corners[:, :, 1].max(), -corners[:, :, 1].min()
    if share >= 1.0:
        return upright, float(top)
    displaced = share * float(submerged_moments(corners, upright, top)[0])
    rounding = 1e-10 * (keel - top)
    level = float(brentq(lambda d: submerged_moments(corners, upright, d)[0] - displaced, top, keel, xtol=rounding))
    size = np.ptp(corners.reshape(-1, 3), axis=0).max()

    def tilted(pitch: float, roll: float) -> np.ndarray:
        return unit_vector(np.array([np.sin(roll), 1.0, np.sin(pitch)]))

    def residual(state: np.ndarray) -> np.ndarray:
        """Relative errors (3,) of volume and of the centre of buoyancy; `state`: level over hull size, two slopes."""
        up = tilted(*state[1:])
        volume, *moment = submerged_moments(corners, up, size * state[0])
        arm = np.array(moment) / max(volume, 1e-12)
        arm = arm - (arm @ up) * up
        return np.array([volume / displaced - 1.0, arm[2] / size, arm[0] / size])

    found = root(residual, np.array([level / size, 0.0, 0.0]), tol=1e-10)
    if found.success and np.abs(found.x[1:]).max() < 0.5:
        return tilted(*found.x[1:]), float(size * found.x[0])
    return upright, level


def submerged_moments(corners: np.ndarray, up: np.ndarray, level: float) -> np.ndarray:
    """Volume [m3] and first moments [m4] (4,) of closed triangles (m, 3, 3) [m] below n . x + d = 0 (`up`, `level`)."""
    from trimesh.intersections import slice_faces_plane

    apex = -level * up  # on the plane, so that the cut surface adds nothing
    vertices = corners.reshape(-1, 3)
    wet, faces, _ = slice_faces_plane(vertices, np.arange(len(vertices)).reshape(-1, 3), -up, apex)
    a, b, c = (wet[faces[:, k]] - apex for k in range(3))
    volume = (a * np.cross(b, c)).sum(axis=1) / 6.0
    return np.concatenate([[volume.sum()], (volume[:, None] * ((a + b + c) / 4.0 + apex)).sum(axis=0)])
