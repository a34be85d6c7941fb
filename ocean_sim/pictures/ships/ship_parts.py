"""Meshes of drawn ships: a hull painted in bands, with its bulwark, and the parts on her deck, of triangles with a
colour each, lofted, turned and cut in pure NumPy.

Axes of a ship: x to port, y up, z to the bow.
"""

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ocean_sim.pictures.stage.sky import unit_vector

Triple = Sequence[float] | np.ndarray  # a point [m] or a colour, linear RGB
CREASE_COSINE = np.cos(np.radians(38.0))  # faces that meet at a sharper edge are shaded apart
PANE_LIFT = 0.008  # of a wall's height: distance of its panes from it
MIN_DECK_NORMAL = 0.7  # upward share of the normal of a deck
MIN_DECK_HEIGHT = 0.6  # of the hull's depth
MIN_DECK_LENGTH, MAX_DECK_RISE = 0.8, 0.4  # of the hull's length and depth: a deck to stand on
BOOT_TOP = 0.04, 0.14  # of the freeboard: lower and upper edge of the boot top over the still water
BULWARK_STATIONS = 49


class Mesh(NamedTuple):
    """Triangle mesh whose triangles share no corners, each with normals, colour and gloss."""

    corners: np.ndarray  # (m, 3, 3) [m]
    normals: np.ndarray  # (m, 3, 3) unit vectors at the corners
    colour: np.ndarray  # (m, 3) reflected share of light, linear RGB
    gloss: np.ndarray  # (m,) 1: a pane that mirrors the sky, 0: paint


def merge_meshes(parts: Iterable[Mesh]) -> Mesh:
    return Mesh(*(np.concatenate(arrays) for arrays in zip(*parts)))


def mirrored_pair(mesh: Mesh) -> Mesh:
    """Mesh of a piece of a ship on the port side, together with its mirror image on the starboard side."""
    mirror = np.array([-1.0, 1.0, 1.0])
    other = Mesh((mesh.corners * mirror)[:, ::-1], (mesh.normals * mirror)[:, ::-1], mesh.colour, mesh.gloss)
    return merge_meshes([mesh, other])


def flat_mesh(corners: np.ndarray, colour: Triple, gloss: float = 0.0, middle: np.ndarray | None = None) -> Mesh:
    """Mesh of flat triangles (m, 3, 3) [m] of one colour and gloss; all face away from `middle`, if given [m]."""
    corners = np.array(corners, dtype=float).reshape(-1, 3, 3)
    normals = area_vectors(corners)
    if middle is not None:
        inwards = (normals * (corners.mean(axis=1) - middle)).sum(axis=1) < 0.0
        corners[inwards] = corners[inwards][:, ::-1]
        normals[inwards] *= -1.0
    size = np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    return plain_mesh(corners, np.repeat((normals / size)[:, None], 3, axis=1), colour, gloss)


def plain_mesh(corners: np.ndarray, normals: np.ndarray, colour: Triple, gloss: float = 0.0) -> Mesh:
    """Mesh of triangles (m, 3, 3) [m] with normals (m, 3, 3), in one colour and gloss; drops those of zero area."""
    kept = area_vectors(corners).any(axis=1)
    m = int(kept.sum())
    return Mesh(corners[kept], normals[kept], np.tile(colour, (m, 1)), np.full(m, gloss))


def area_vectors(corners: np.ndarray) -> np.ndarray:
    """Normals (m, 3) [m2] of triangles (m, 3, 3) [m]; their length is twice the area."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def quad_triangles(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
    """Triangles (2 m, 3, 3) that split m quadrilaterals with corners a, b, c, d (m, 3), in order around each."""
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def fan_triangles(outline: np.ndarray) -> np.ndarray:
    """Triangles (k, 3, 3) that fill a convex polygon, `outline` (k, 3), from its middle."""
    return np.stack([np.tile(outline.mean(axis=0), (len(outline), 1)), outline, np.roll(outline, -1, axis=0)], axis=1)


class Block:
    """Convex body between a lower and an upper outline (k, 3) [m] of equally many points, such as a cabin or funnel."""

    def __init__(self, bottom: np.ndarray, top: np.ndarray) -> None:
        self.bottom, self.top = np.array(bottom, dtype=float), np.array(top, dtype=float)
        self.middle = np.concatenate([self.bottom, self.top]).mean(axis=0)

    def mesh(self, walls: Triple, lid: Triple) -> Mesh:
        """Mesh of the block, its side walls in the colour `walls` and both ends in the colour `lid`."""
        ahead = [np.roll(outline, -1, axis=0) for outline in (self.bottom, self.top)]
        sides = quad_triangles(self.bottom, ahead[0], ahead[1], self.top)
        ends = np.concatenate([fan_triangles(self.top), fan_triangles(self.bottom)])
        return merge_meshes([flat_mesh(sides, walls, middle=self.middle), flat_mesh(ends, lid, middle=self.middle)])

    def panes(self, wall: int, count: int, low: float, high: float, post: float, colour: Triple) -> Mesh:
        """Mesh of `count` window panes in a row on wall number `wall`, between the shares `low` and `high` of its
        height; `post`: width of the gaps, as a share of the panes' pitch."""
        k = (wall + 1) % len(self.bottom)
        a, b, c, d = self.bottom[wall], self.bottom[k], self.top[k], self.top[wall]
        out = np.cross(b - a, d - a)
        out *= np.sign(out @ (0.25 * (a + b + c + d) - self.middle)) / np.linalg.norm(out)
        lift = PANE_LIFT * float(np.linalg.norm(d - a)) * out

        def place(u: np.ndarray, v: float) -> np.ndarray:
            u = u[:, None]
            return (1.0 - v) * ((1.0 - u) * a + u * b) + v * ((1.0 - u) * d + u * c) + lift

        left = (np.arange(count) + 0.5 * post) / count
        right = (np.arange(count) + 1.0 - 0.5 * post) / count
        corners = quad_triangles(place(left, low), place(right, low), place(right, high), place(left, high))
        return flat_mesh(corners, colour, 1.0, self.middle)


def level_outline(corners: list[list[float]], y: float) -> np.ndarray:
    """Outline (k, 3) [m] at a height y, along port and back along starboard; `corners`: (half breadth, z) [m]."""
    port = np.insert(np.array(corners, dtype=float), 1, y, axis=1)
    starboard = (port * [-1.0, 1.0, 1.0])[::-1]
    return np.concatenate([port, starboard])


def tube_mesh(start: Triple, end: Triple, radii: tuple[float, float], colour: Triple, sides: int = 8) -> Mesh:
    """Mesh of a bar or cone from `start` to `end` [m], with `radii` [m] at these and `sides` flat sides."""
    a, b = np.array(start, dtype=float), np.array(end, dtype=float)
    along = unit_vector(b - a)
    across = unit_vector(np.cross(along, [0.0, 1.0, 0.0] if abs(along[1]) < 0.9 else [1.0, 0.0, 0.0]))
    angle = 2.0 * np.pi * np.arange(sides) / sides
    ring = np.cos(angle)[:, None] * across + np.sin(angle)[:, None] * np.cross(along, across)
    mesh = Block(a + radii[0] * ring, b + radii[1] * ring).mesh(colour, colour)
    wall = np.arange(len(mesh.corners)) < 2 * sides
    from_axis = mesh.corners[wall] - a
    from_axis -= (from_axis @ along)[..., None] * along
    mesh.normals[wall] = from_axis / np.maximum(np.linalg.norm(from_axis, axis=2, keepdims=True), 1e-12)
    return mesh


def path_mesh(points: np.ndarray, radius: float, colour: Triple) -> Mesh:
    """Mesh of round bars of a radius [m] that connect points (n, 3) [m] in order."""
    return merge_meshes(tube_mesh(a, b, (radius, radius), colour) for a, b in pairwise(points))


def smooth_normals(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Unit normals (m, 3, 3) at triangle corners: means of faces around a vertex, not across creases, by the weights of
    Max (1999), J. Graphics Tools 4(2), which are exact on a sphere."""
    points = vertices[triangles]
    ahead, back = np.roll(points, -1, axis=1) - points, np.roll(points, 1, axis=1) - points  # edges from each corner
    sizes = (ahead**2).sum(axis=2) * (back**2).sum(axis=2)
    weighted = (np.cross(ahead, back) / np.maximum(sizes, 1e-300)[..., None]).reshape(-1, 3)
    faces = area_vectors(points)
    flat = faces / np.maximum(np.linalg.norm(faces, axis=1, keepdims=True), 1e-30)
    order = np.argsort(triangles.ravel(), kind="stable")
    owner, face = triangles.ravel()[order], order // 3
    normals = np.empty((len(order), 3))
    for corners in np.split(np.arange(len(order)), np.flatnonzero(np.diff(owner)) + 1):
        around = face[corners]
        alike = (flat[around] @ flat[around].T > CREASE_COSINE).astype(float)
        normals[order[corners]] = alike @ weighted[order[corners]]
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    return normals.reshape(-1, 3, 3)


def paint_bands(values: np.ndarray, up: np.ndarray, level: float, bands: Sequence[tuple[float, Triple]]) -> Mesh:
    """Mesh of triangles coloured in bands by height and cut where colours meet. `values` (m, 3, 6): points [m] and
    normals of corners; height of a point x: up . x + level [m]; `bands`: (upper limit [m], colour), from below."""
    from trimesh.intersections import slice_faces_plane

    vertices, normals = values.reshape(-1, 6)[:, :3], values.reshape(-1, 6)[:, 3:]
    whole, lower, parts = np.arange(len(vertices)).reshape(-1, 3), -np.inf, []
    for upper, colour in bands:
        x, faces, n = vertices, whole, normals
        for sense, limit in ((1.0, lower), (-1.0, upper)):
            if np.isfinite(limit):
                x, faces, n = slice_faces_plane(x, faces, sense * up, (limit - level) * up, uv=n)
        if len(faces):
            parts.append(plain_mesh(x[faces], unit_vector(n[faces]), colour))
        lower = upper
    return merge_meshes(parts)


class Hull:
    """Physical hull of a ship in body axes from her centre of mass, and the plane of the still water at rest."""

    def __init__(self, vertices: np.ndarray, triangles: np.ndarray, still_water: np.ndarray) -> None:
        """`vertices` (n, 3) [m], `triangles` (m, 3): of the hull; `still_water` (4,): upward normal of that plane, and
        height of the centre of mass over it [m]."""
        self.vertices, self.triangles = vertices, triangles
        self.lower, self.upper = vertices.min(axis=0), vertices.max(axis=0)
        self.breadth, self.depth, self.length = self.upper - self.lower  # [m]
        corners = vertices[triangles]
        self.up, self.level = still_water[:3], float(still_water[3])
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
        """True if the hull has a deck on which a superstructure can stand: from end to end and about level."""
        deck = self.values[self.is_deck][:, :, :3].reshape(-1, 3)
        if not len(deck):
            return False
        _, rise, run = np.ptp(deck, axis=0)
        return bool(run > MIN_DECK_LENGTH * self.length and rise < MAX_DECK_RISE * self.depth)

    def painted(self, antifouling: Triple, boot_top: Triple, topsides: Triple, deck: Triple) -> Mesh:
        """Mesh of the hull painted by height: antifouling, boot top, topsides; a deck, if any, has its own colour."""
        low, high = (share * self.freeboard for share in BOOT_TOP)
        sides = self.values[~self.is_deck] if self.has_deck else self.values
        bands = [(low, antifouling), (high, boot_top), (np.inf, topsides)]  # of one paint there is nothing to cut
        hull = paint_bands(sides, self.up, self.level, bands[2 * (antifouling == topsides) :])
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
        """Line (n, 3) [m] on the port bulwark at z (n,) [m], at a `share` of its height, moved `inwards` [m]."""
        s = np.clip((z - self.stern) / (self.bow - self.stern), 0.0, 1.0)
        rise = self.bulwark_height(z)
        round_half = np.maximum(self.smooth(z), self.half_breadth(z)) + 0.06 * rise * np.sin(np.pi * s**2) ** 2
        x = np.maximum(round_half - inwards, 0.0)
        return np.stack([x, self.deck_height(z) + share * rise, z + (share * self.rake - 0.7 * inwards) * s**6], axis=1)

    def bulwark(self, colour: Triple, inside: Triple, cap: Triple, thick: float) -> Mesh:
        """Mesh of the bulwark on both sides and blunt ends: two walls, `thick` [m] apart, and a cap."""
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
        """Mesh of a round bar of `radius` [m] on sides and stern, at a share of bulwark height, `out` [m] off it."""
        port = self.bulwark_top(self.stations, share=share) + [out, 0.0, 0.0]
        port[-1] = port[-1] * [0.0, 1.0, 1.0] + [0.0, 0.0, out]
        across = port[[0]] * np.array([[1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]])
        return merge_meshes([mirrored_pair(path_mesh(port, radius, colour)), path_mesh(across, radius, colour)])


def smooth_strip(low: np.ndarray, high: np.ndarray, colour: Triple) -> Mesh:
    """Mesh of quadrilaterals between two lines, `low` and `high` (n, 3) [m], with smooth normals along them."""
    vertices, (a, b) = np.concatenate([low, high]), np.arange(2 * len(low)).reshape(2, -1)
    triangles = quad_triangles(a[:-1], b[:-1], b[1:], a[1:])
    kept = triangles[np.linalg.norm(area_vectors(vertices[triangles]), axis=1) > 1e-12]
    return plain_mesh(vertices[kept], smooth_normals(vertices, kept), colour)
