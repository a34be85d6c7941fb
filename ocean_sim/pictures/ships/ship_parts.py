"""Parts of drawn ships: meshes of triangles with a colour each, lofted, turned and cut in pure NumPy.

Axes of a ship: x to port, y up, z to the bow.
"""

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

Triple = Sequence[float] | np.ndarray  # a point [m] or a colour, linear RGB
CREASE_COSINE = np.cos(np.radians(38.0))  # faces that meet at a sharper edge are shaded apart
UPWARD = np.array([0.0, 1.0, 0.0])
PANE_LIFT = 0.008  # of a wall's height: distance of its panes from it


class Mesh(NamedTuple):
    """Triangles that share no corners, with normals, colours and gloss."""

    corners: np.ndarray  # (m, 3, 3) [m]
    normals: np.ndarray  # (m, 3, 3) unit vectors at the corners
    colour: np.ndarray  # (m, 3) reflected share of light, linear RGB
    gloss: np.ndarray  # (m,) 1: a pane that mirrors the sky, 0: paint


def merge_meshes(parts: Iterable[Mesh]) -> Mesh:
    return Mesh(*(np.concatenate(arrays) for arrays in zip(*parts)))


def mirrored_pair(mesh: Mesh) -> Mesh:
    """Mesh of a part on the port side and its mirror image on the starboard side."""
    mirror = np.array([-1.0, 1.0, 1.0])
    other = Mesh((mesh.corners * mirror)[:, ::-1], (mesh.normals * mirror)[:, ::-1], mesh.colour, mesh.gloss)
    return merge_meshes([mesh, other])


def flat_mesh(corners: np.ndarray, colour: Triple, gloss: float = 0.0, middle: np.ndarray | None = None) -> Mesh:
    """Mesh of flat triangles (m, 3, 3) of a colour and gloss; if the point `middle` is given, all face away from it."""
    corners = np.array(corners, dtype=float).reshape(-1, 3, 3)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    if middle is not None:
        inwards = (normals * (corners.mean(axis=1) - middle)).sum(axis=1) < 0.0
        corners[inwards] = corners[inwards][:, ::-1]
        normals[inwards] *= -1.0
    size = np.linalg.norm(normals, axis=1)
    corners, normals = corners[size > 0.0], normals[size > 0.0] / size[size > 0.0, None]
    m = len(corners)
    return Mesh(corners, np.repeat(normals[:, None], 3, axis=1), np.tile(colour, (m, 1)), np.full(m, gloss))


def quad_triangles(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
    """Triangles (2 m, 3, 3) of m quadrilaterals, given by their corners a, b, c, d (m, 3) in order."""
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def fan_triangles(outline: np.ndarray) -> np.ndarray:
    """Triangles (k, 3, 3) that fill a convex polygon (k, 3) from its middle."""
    return np.stack([np.tile(outline.mean(axis=0), (len(outline), 1)), outline, np.roll(outline, -1, axis=0)], axis=1)


class Block:
    """Convex body between two outlines (k, 3) of equally many points: a cabin, a funnel, a container."""

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
        """Mesh of `count` window panes in a row on wall number `wall`, between shares `low` and `high` of its height;
        `post`: gap between panes, as a share of their pitch."""
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
    """Outline (k, 3) [m] at a height y, along port and back along starboard, from corners (half breadth, z)."""
    port = np.insert(np.array(corners, dtype=float), 1, y, axis=1)
    starboard = (port * [-1.0, 1.0, 1.0])[::-1]
    return np.concatenate([port, starboard])


def tube_mesh(start: Triple, end: Triple, radii: tuple[float, float], colour: Triple, sides: int = 8) -> Mesh:
    """Mesh of a bar or cone with a number of sides between two points [m], with a radius [m] at each."""
    a, b = np.array(start, dtype=float), np.array(end, dtype=float)
    along = (b - a) / np.linalg.norm(b - a)
    across = np.cross(along, UPWARD if abs(along[1]) < 0.9 else [1.0, 0.0, 0.0])
    across /= np.linalg.norm(across)
    angle = 2.0 * np.pi * np.arange(sides) / sides
    ring = np.cos(angle)[:, None] * across + np.sin(angle)[:, None] * np.cross(along, across)
    mesh = Block(a + radii[0] * ring, b + radii[1] * ring).mesh(colour, colour)
    wall = np.arange(len(mesh.corners)) < 2 * sides
    from_axis = mesh.corners - a
    from_axis -= (from_axis @ along)[..., None] * along
    size = np.linalg.norm(from_axis, axis=2, keepdims=True)
    mesh.normals[wall] = (from_axis / np.maximum(size, 1e-12))[wall]
    return mesh


def path_mesh(points: np.ndarray, radius: float, colour: Triple) -> Mesh:
    """Mesh of round bars of a radius [m] that connect points (n, 3) [m] in order."""
    return merge_meshes(tube_mesh(a, b, (radius, radius), colour) for a, b in pairwise(points))


def smooth_normals(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Unit normals (m, 3, 3) at triangle corners: area-weighted means of faces around a vertex, not across creases."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    faces = np.cross(b - a, c - a)
    flat = faces / np.maximum(np.linalg.norm(faces, axis=1, keepdims=True), 1e-30)
    order = np.argsort(triangles.ravel(), kind="stable")
    owner, face = triangles.ravel()[order], order // 3
    normals = np.empty((len(order), 3))
    for corners in np.split(np.arange(len(order)), np.flatnonzero(np.diff(owner)) + 1):
        around = face[corners]
        alike = (flat[around] @ flat[around].T > CREASE_COSINE).astype(float)
        normals[order[corners]] = alike @ faces[around]
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    return normals.reshape(-1, 3, 3)


def cut_triangles(values: np.ndarray, height: np.ndarray, level: float) -> tuple[np.ndarray, np.ndarray]:
    """Cut triangles with values (m, 3, k) and heights (m, 3) at their corners along the height `level`, into values (n,
    3, k) and heights (n, 3) of triangles that each lie on one side, with interpolated corners."""
    packed = np.concatenate([values, height[:, :, None]], axis=2)
    over = height > level
    crossed = over.any(axis=1) & ~over.all(axis=1)
    whole, packed, over = packed[~crossed], packed[crossed], over[crossed]
    if not len(packed):
        return whole[:, :, :-1], whole[:, :, -1]
    # One corner lies alone on its side of the level: p; both edges from it are cut.
    lone = np.where(over.sum(axis=1) == 1, over.argmax(axis=1), (~over).argmax(axis=1))
    p, q, r = (packed[np.arange(len(packed)), (lone + k) % 3] for k in range(3))

    def at_level(s: np.ndarray, e: np.ndarray) -> np.ndarray:
        """Point (n, k + 1) at the height `level` on the edges from s to e, both (n, k + 1) with the height last."""
        point = s + (level - s[:, -1:]) / (e[:, -1:] - s[:, -1:]) * (e - s)
        point[:, -1] = level
        return point

    pq, pr = at_level(p, q), at_level(p, r)
    pieces = np.concatenate([whole, *(np.stack(t, axis=1) for t in ((p, pq, pr), (pq, q, r), (pq, r, pr)))])
    return pieces[:, :, :-1], pieces[:, :, -1]


def paint_bands(values: np.ndarray, height: np.ndarray, bands: Sequence[tuple[float, Triple]]) -> Mesh:
    """Mesh of triangles (m, 3, 6) of points and normals, coloured by height (m, 3) and cut where colours meet; `bands`:
    (upper limit, colour) from below, the last without limit."""
    limits = [limit for limit, _ in bands[:-1]]
    for limit in limits:
        values, height = cut_triangles(values, height, limit)
    number = np.searchsorted(limits, height.mean(axis=1))
    size = np.linalg.norm(np.cross(values[:, 1, :3] - values[:, 0, :3], values[:, 2, :3] - values[:, 0, :3]), axis=1)
    values, number = values[size > 0.0], number[size > 0.0]
    colour = np.array([paint for _, paint in bands], dtype=float)[number]
    normals = values[:, :, 3:] / np.linalg.norm(values[:, :, 3:], axis=2, keepdims=True)
    return Mesh(values[:, :, :3], normals, colour, np.zeros(len(colour)))
