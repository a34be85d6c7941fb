"""The hull of a drawn ship: the same triangles as in the physics, painted by their height over the still water."""

from typing import Any

import numpy as np

from ocean_sim.pictures.ships.ship_parts import (
    Mesh,
    banded,
    both,
    cut,
    faceted,
    merged,
    path,
    refined,
    smooth_normals,
    tube,
)

DECK = 0.7  # the least upward share of the normal of a deck


class Hull:
    """The physical hull in body axes from its centre of mass, its waterline at rest, and the edge of its deck."""

    def __init__(self, vertices: np.ndarray, triangles: np.ndarray, share: float) -> None:
        """`share` of its volume is under water at rest."""
        self.vertices, self.triangles = vertices, triangles
        self.lower, self.upper = vertices.min(axis=0), vertices.max(axis=0)
        self.breadth, self.depth, self.length = self.upper - self.lower  # [m]
        self.up, self.level = settled(vertices[triangles], share)
        normals = smooth_normals(vertices, triangles)
        a, b, c = (vertices[triangles[:, k]] for k in range(3))
        across = np.cross(b - a, c - a)
        flat = across[:, 1] / np.maximum(np.linalg.norm(across, axis=1), 1e-30)
        high = vertices[triangles][:, :, 1].min(axis=1) > self.lower[1] + 0.6 * self.depth
        self.is_deck = (flat > DECK) & high
        self.values = np.concatenate([vertices[triangles], normals], axis=2)

    def over_water(self, points: np.ndarray) -> np.ndarray:
        """Height of points (..., 3) over the still water at rest [m]."""
        return points @ self.up + self.level

    @property
    def freeboard(self) -> float:
        """Of the top of the hull [m], not below a tenth of its depth."""
        return max(float(self.over_water(self.upper * [0.0, 1.0, 0.0])), 0.1 * self.depth)

    @property
    def has_deck(self) -> bool:
        """Whether something can stand on it: a deck from end to end, more or less level."""
        deck = self.values[self.is_deck][:, :, :3].reshape(-1, 3)
        if not len(deck):
            return False
        _, rise, run = np.ptp(deck, axis=0)
        return bool(run > 0.8 * self.length and rise < 0.4 * self.depth)

    def painted(self, antifouling: Any, boot_top: Any, topsides: Any, deck: Any) -> Mesh:
        """Antifouling up to the waterline at rest and a little above, boot top, topsides; the deck apart."""
        low, high = 0.04 * self.freeboard, 0.14 * self.freeboard
        sides = refined(self.values[~self.is_deck], self.length / 12.0)
        hull = self.banded(sides, [(low, antifouling), (high, boot_top), (np.inf, topsides)])
        if not self.is_deck.any():
            return hull
        return merged([hull, faceted(self.values[self.is_deck][:, :, :3], deck)])

    def banded(self, values: np.ndarray, bands: Any) -> Mesh:
        """Paint triangles (m, 3, 6) of points and normals by their height over the still water, as `ship_parts.banded`
        does."""
        return banded(values[:, :, :3], values[:, :, 3:], self.over_water(values[:, :, :3]), bands)

    def side(self, y: float, z: float) -> tuple[np.ndarray, np.ndarray]:
        """Point of the port side at a height and a distance along the ship [m], and its normal."""
        a, b, c = (self.values[:, k, :3] for k in range(3))
        u, v, w = (b - a)[:, 1:], (c - a)[:, 1:], np.array([y, z]) - a[:, 1:]
        area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
        area = np.where(np.abs(area) > 1e-12, area, np.inf)
        s, t = (w[:, 0] * v[:, 1] - w[:, 1] * v[:, 0]) / area, (u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0]) / area
        x = a[:, 0] + s * (b - a)[:, 0] + t * (c - a)[:, 0]
        hit = (s >= -1e-9) & (t >= -1e-9) & (s + t <= 1.0 + 1e-9) & np.isfinite(area)
        k = int(np.where(hit, x, -np.inf).argmax())
        normal = np.cross(b[k] - a[k], c[k] - a[k])
        return np.array([x[k], y, z]), normal / np.linalg.norm(normal)

    def edge(self) -> np.ndarray:
        """(n, 3) the edge of the deck on port from stern to bow [m]."""
        points = self.vertices[np.unique(self.triangles[self.is_deck])]
        tiny = 1e-4 * self.breadth
        stations = []
        for z in np.unique(np.round(points[:, 2], 6)):
            there = points[np.abs(points[:, 2] - z) < 1e-5]
            stations.append(there[there[:, 0].argmax()])
        port = np.array(stations)
        return port[port[:, 0] > -tiny]


class Sheer:
    """The edge of a deck as functions of the distance along the ship, and the bulwark on it."""

    def __init__(self, hull: Hull, height: tuple[float, float], rake: float) -> None:
        """`height` of the bulwark amidships and at the bow [m]; `rake`: how far its top leans forward there [m]."""
        from scipy.interpolate import PchipInterpolator

        edge = hull.edge()
        self.z, self.height, self.rake = edge[:, 2], height, rake
        self.stern, self.bow = float(edge[0, 2]), float(edge[-1, 2])
        self.edge_x, self.edge_y, self.smooth = edge[:, 0], edge[:, 1], PchipInterpolator(edge[:, 2], edge[:, 0])

    def half(self, z: Any) -> np.ndarray:
        """Half the breadth of the deck [m]."""
        return np.interp(z, self.z, self.edge_x)

    def deck(self, z: Any) -> np.ndarray:
        """Height of the deck at its edge [m], body axes."""
        return np.interp(z, self.z, self.edge_y)

    def rise(self, z: np.ndarray) -> np.ndarray:
        """Height of the bulwark [m]: a parabola towards the bow, a little at the stern."""
        s = (np.asarray(z) - self.stern) / (self.bow - self.stern)
        forward, aft = np.clip((s - 0.35) / 0.65, 0.0, 1.0), np.clip((0.25 - s) / 0.25, 0.0, 1.0)
        low, high = self.height
        return low + (high - low) * (forward**2 + 0.25 * aft**2)

    def foot(self, z: np.ndarray) -> np.ndarray:
        """(n, 3) of the bulwark on port, on the edge of the physical hull."""
        return np.stack([self.half(z), self.deck(z), z], axis=1)

    def top(self, z: np.ndarray, inwards: float = 0.0, above: Any = 0.0) -> np.ndarray:
        """(n, 3) of the bulwark on port; never inside of its foot."""
        s = np.clip((z - self.stern) / (self.bow - self.stern), 0.0, 1.0)
        round_half = np.maximum(self.smooth(z), self.half(z)) + 0.06 * self.rise(z) * np.sin(np.pi * s**2) ** 2
        x = np.maximum(round_half - inwards, 0.0)
        return np.stack([x, self.deck(z) + self.rise(z) + above, z + self.rake * s**6 - 0.7 * inwards * s**6], axis=1)

    def bulwark(self, colour: Any, inside: Any, cap: Any, thick: float) -> Mesh:
        """Its skins and its cap on both sides, and across ends that are not sharp."""
        z = self.stations
        foot, top, inner = self.foot(z), self.top(z), self.top(z, thick)
        inner_foot = np.column_stack([np.maximum(foot[:, 0] - thick, 0.0), foot[:, 1:]])
        strips = ((foot, top, colour), (inner, inner_foot, inside), (top, inner, cap))
        parts = [both(smooth_strip(low, high, paint)) for low, high, paint in strips]
        for end, sense in ((0, 1.0), (-1, -1.0)):
            if foot[end, 0] < thick:
                continue
            x = np.linspace(sense, -sense, 9)[:, None] * [1.0, 0.0, 0.0] + [0.0, 1.0, 1.0]
            low, high = foot[end] * x, top[end] * x
            ahead = np.array([0.0, 0.0, sense * thick])
            strips = ((high, low, colour), (low + ahead, high + ahead, inside), (high + ahead, high, cap))
            parts += [smooth_strip(a, b, paint) for a, b, paint in strips]
        return merged(parts)

    @property
    def stations(self) -> np.ndarray:
        """Distances along the ship [m] at which lines along the deck are drawn."""
        return np.unique(np.concatenate([np.linspace(self.stern, self.bow, 49), self.z]))

    def rail(
        self, start: float, end: float, height: float, apart: float, radius: float, colour: Any, inwards: float
    ) -> Mesh:
        """Posts `apart` [m] and two bars along them on both sides, on the bulwark from `start` to `end`."""
        z = np.linspace(start, end, 33)
        parts = [path(self.top(z, inwards, share * height), radius, colour) for share in (0.55, 1.0)]
        count = max(2, round((end - start) / apart) + 1)
        posts = np.linspace(start, end, count)
        if end > self.bow - 0.02 * (self.bow - self.stern):
            line = self.top(z[-1:], inwards)
            parts += [
                path(np.array([a, a * [0.0, 1.0, 1.0]]) + [0.0, s * height, 0.0], radius, colour)
                for a in line
                for s in (0.55, 1.0)
                if a[0]
            ]
        parts += [
            tube(a, b, radius, colour, 6) for a, b in zip(self.top(posts, inwards), self.top(posts, inwards, height))
        ]
        return both(merged(parts))


def strake(port: np.ndarray, radius: float, colour: Any) -> Mesh:
    """A round bar along a line (n, 3) on port, from the stern on, its mirror image, and across the stern."""
    across = port[[0]] * np.array([[1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]])
    return merged([both(path(port, radius, colour, 8)), path(across, radius, colour, 8)])


def smooth_strip(low: np.ndarray, high: np.ndarray, colour: Any) -> Mesh:
    """A band of quadrilaterals between two lines (n, 3), shaded smoothly along them."""
    n = len(low)
    vertices = np.concatenate([low, high])
    k = np.arange(n - 1)
    triangles = np.concatenate([np.stack([k, k + n, k + n + 1], axis=1), np.stack([k, k + n + 1, k + 1], axis=1)])
    corners = vertices[triangles]
    size = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    kept = triangles[size > 1e-12]
    return Mesh(vertices[kept], smooth_normals(vertices, kept), np.tile(colour, (len(kept), 1)), np.zeros(len(kept)))


def settled(corners: np.ndarray, share: float) -> tuple[np.ndarray, float]:
    """The still water at rest in body axes: (3,) its normal n and d [m], so that n . x + d is the height of x over it.

    A `share` of the volume is under water, its centre of buoyancy under the centre of mass, the origin; a hull that
    finds no such position within 30 degrees is taken as upright, awash at most.
    """
    from scipy.optimize import brentq, root

    def under(up: np.ndarray, level: float) -> np.ndarray:
        return submerged(corners, up, level)

    upright = np.array([0.0, 1.0, 0.0])
    top, keel = -corners[:, :, 1].max(), -corners[:, :, 1].min()
    if share >= 1.0:
        return upright, float(top)
    displaced = share * float(under(upright, top)[0])
    level = float(brentq(lambda d: under(upright, d)[0] - displaced, top, keel, xtol=1e-10 * (keel - top)))
    size = np.ptp(corners.reshape(-1, 3), axis=0).max()

    def residual(state: np.ndarray) -> np.ndarray:
        up = tilted(state[1], state[2])
        volume, *moment = under(up, size * state[0])
        arm = np.array(moment) / max(volume, 1e-12)
        arm = arm - (arm @ up) * up
        return np.array([volume / displaced - 1.0, arm[2] / size, arm[0] / size])

    found = root(residual, np.array([level / size, 0.0, 0.0]), tol=1e-10)
    if found.success and np.abs(found.x[1:]).max() < 0.5:
        return tilted(found.x[1], found.x[2]), float(size * found.x[0])
    return upright, level


def tilted(pitch: float, roll: float) -> np.ndarray:
    """(3,) a vertical that leans."""
    up = np.array([np.sin(roll), 1.0, np.sin(pitch)])
    return up / np.linalg.norm(up)


def submerged(corners: np.ndarray, up: np.ndarray, level: float) -> np.ndarray:
    """(4,) volume [m3] and first moments [m4] of what lies below n . x + d = 0 in closed triangles (m, 3, 3)."""
    apex = -level * up  # on the plane, so that the cut surface adds nothing
    pieces, height = cut(corners, corners @ up + level, 0.0)
    wet = pieces[height.max(axis=1) <= 1e-12 * max(1.0, float(np.abs(corners).max()))]
    a, b, c = (wet[:, k] - apex for k in range(3))
    volume = (a * np.cross(b, c)).sum(axis=1) / 6.0
    return np.concatenate([[volume.sum()], (volume[:, None] * ((a + b + c) / 4.0 + apex)).sum(axis=0)])
