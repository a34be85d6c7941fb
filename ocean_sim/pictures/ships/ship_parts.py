"""Parts of which a ship is drawn: triangles with a colour each, lofted, turned and cut in pure NumPy.

Axes of a ship: x to port, y up, z to the bow.
"""

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

Triple = Sequence[float] | np.ndarray  # a point [m] or a colour, linear RGB
CREASE = np.cos(np.radians(38.0))  # faces that meet at a sharper edge are shaded apart
UP = np.array([0.0, 1.0, 0.0])


class Mesh(NamedTuple):
    """Triangles that share nothing."""

    corners: np.ndarray  # (m, 3, 3) [m]
    normals: np.ndarray  # (m, 3, 3) unit vectors at the corners
    colour: np.ndarray  # (m, 3) share of light that is given back, linear RGB
    gloss: np.ndarray  # (m,) 1: a pane that mirrors the sky, 0: paint


def merged(parts: Iterable[Mesh]) -> Mesh:
    """All parts as one."""
    return Mesh(*(np.concatenate(arrays) for arrays in zip(*parts)))


def faceted(corners: np.ndarray, colour: Triple, gloss: float = 0.0, middle: np.ndarray | None = None) -> Mesh:
    """Flat triangles (m, 3, 3); with `middle` each is turned to face away from it."""
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


def quads(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
    """(2 m, 3, 3) triangles of m quadrilaterals with corners (m, 3) in order."""
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def fan(outline: np.ndarray) -> np.ndarray:
    """(k, 3, 3) triangles of a convex polygon (k, 3) around its middle."""
    return np.stack([np.tile(outline.mean(axis=0), (len(outline), 1)), outline, np.roll(outline, -1, axis=0)], axis=1)


class Block:
    """A convex body between two outlines (k, 3) of equal number: a cabin, a funnel, a container."""

    def __init__(self, bottom: np.ndarray, top: np.ndarray) -> None:
        self.bottom, self.top = np.array(bottom, dtype=float), np.array(top, dtype=float)
        self.middle = np.concatenate([self.bottom, self.top]).mean(axis=0)

    def mesh(self, walls: Triple, lid: Triple | None = None) -> Mesh:
        """Its walls and its lid; the floor is never seen, but for one in the air."""
        ahead = [np.roll(outline, -1, axis=0) for outline in (self.bottom, self.top)]
        sides = quads(self.bottom, ahead[0], ahead[1], self.top)
        ends = np.concatenate([fan(self.top), fan(self.bottom)])
        return merged(
            [
                faceted(sides, walls, middle=self.middle),
                faceted(ends, walls if lid is None else lid, middle=self.middle),
            ]
        )

    def panes(
        self, wall: int, count: int, low: float, high: float, colour: Triple, post: float = 0.22, gloss: float = 1.0
    ) -> Mesh:
        """`count` windows in a row on one wall, between shares `low` and `high` of its height; `post`: the share of the
        wall between them."""
        k = (wall + 1) % len(self.bottom)
        a, b, c, d = self.bottom[wall], self.bottom[k], self.top[k], self.top[wall]
        out = np.cross(b - a, d - a)
        out *= np.sign(out @ (0.25 * (a + b + c + d) - self.middle)) / np.linalg.norm(out)
        lift = 0.008 * float(np.linalg.norm(d - a)) * out

        def point(u: np.ndarray, v: float) -> np.ndarray:
            u = u[:, None]
            return (1.0 - v) * ((1.0 - u) * a + u * b) + v * ((1.0 - u) * d + u * c) + lift

        left = (np.arange(count) + 0.5 * post) / count
        right = (np.arange(count) + 1.0 - 0.5 * post) / count
        shape = quads(point(left, low), point(right, low), point(right, high), point(left, high))
        return faceted(shape, colour, gloss, self.middle)


def outline(half: Triple, z: Triple, y: float) -> np.ndarray:
    """(k, 3): a level outline from half breadths at stations along the ship, port and then back along starboard."""
    half, z = np.array(half), np.array(z)
    port = np.stack([half, np.full(len(z), y), z], axis=1)
    starboard = (port * [-1.0, 1.0, 1.0])[::-1]
    keep = np.abs(starboard[:, 0]) > 0.0
    return np.concatenate([port, starboard[keep]])


def box(lower: Triple, upper: Triple, walls: Triple, lid: Triple | None = None) -> Mesh:
    """A box along the axes."""
    (x0, y0, z0), (x1, y1, z1) = lower, upper
    plan = np.array([[x0, 0.0, z0], [x1, 0.0, z0], [x1, 0.0, z1], [x0, 0.0, z1]])
    return Block(plan + y0 * UP, plan + y1 * UP).mesh(walls, lid)


def tube(start: Triple, end: Triple, radius: float | tuple[float, float], colour: Triple, sides: int = 8) -> Mesh:
    """A round bar between two points; two radii make a cone."""
    a, b = np.array(start, dtype=float), np.array(end, dtype=float)
    r = radius if isinstance(radius, tuple) else (radius, radius)
    along = (b - a) / np.linalg.norm(b - a)
    across = np.cross(along, UP if abs(along[1]) < 0.9 else [1.0, 0.0, 0.0])
    across /= np.linalg.norm(across)
    angle = 2.0 * np.pi * np.arange(sides) / sides
    ring = np.cos(angle)[:, None] * across + np.sin(angle)[:, None] * np.cross(along, across)
    block = Block(a + r[0] * ring, b + r[1] * ring)
    mesh = block.mesh(colour)
    wall = np.arange(len(mesh.corners)) < 2 * sides
    from_axis = mesh.corners - a
    from_axis -= (from_axis @ along)[..., None] * along
    size = np.linalg.norm(from_axis, axis=2, keepdims=True)
    mesh.normals[wall] = (from_axis / np.maximum(size, 1e-12))[wall]
    return mesh


def path(points: np.ndarray, radius: float, colour: Triple, sides: int = 6) -> Mesh:
    """Bars from point to point."""
    return merged(tube(a, b, radius, colour, sides) for a, b in pairwise(points))


def both(mesh: Mesh) -> Mesh:
    """A part on port and its mirror image on starboard."""
    mirror = np.array([-1.0, 1.0, 1.0])
    other = Mesh((mesh.corners * mirror)[:, ::-1], (mesh.normals * mirror)[:, ::-1], mesh.colour, mesh.gloss)
    return merged([mesh, other])


def smooth_normals(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(m, 3, 3) normals at corners: of the faces around a vertex that meet in no crease, weighted by their areas."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    faces = np.cross(b - a, c - a)
    size = np.linalg.norm(faces, axis=1, keepdims=True)
    flat = faces / np.maximum(size, 1e-30)
    order = np.argsort(triangles.ravel(), kind="stable")
    owner, face = triangles.ravel()[order], order // 3
    normals = np.empty((len(order), 3))
    for corners in np.split(np.arange(len(order)), np.flatnonzero(np.diff(owner)) + 1):
        around = face[corners]
        alike = (flat[around] @ flat[around].T > CREASE).astype(float)
        normals[order[corners]] = alike @ faces[around]
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    return normals.reshape(-1, 3, 3)


def cut(values: np.ndarray, height: np.ndarray, level: float) -> tuple[np.ndarray, np.ndarray]:
    """Triangles (m, 3, k), with a height (m, 3) at each corner, cut where the height is `level`: (n, 3, k) values and
    (n, 3) heights of triangles that lie on one side each. Values are interpolated."""
    packed = np.concatenate([values, height[:, :, None]], axis=2)
    over = height > level
    crossed = over.any(axis=1) & ~over.all(axis=1)
    whole, packed, over = packed[~crossed], packed[crossed], over[crossed]
    if not len(packed):
        return whole[:, :, :-1], whole[:, :, -1]
    lone = np.where(over.sum(axis=1) == 1, over.argmax(axis=1), (~over).argmax(axis=1))
    rows = np.arange(len(packed))
    p, q, r = (packed[rows, (lone + k) % 3] for k in range(3))

    def between(s: np.ndarray, e: np.ndarray) -> np.ndarray:
        share = (level - s[:, -1:]) / (e[:, -1:] - s[:, -1:])
        found = s + share * (e - s)
        found[:, -1] = level
        return found

    pq, pr = between(p, q), between(p, r)
    pieces = np.concatenate([whole, *(np.stack(t, axis=1) for t in ((p, pq, pr), (pq, q, r), (pq, r, pr)))])
    return pieces[:, :, :-1], pieces[:, :, -1]


def banded(corners: np.ndarray, normals: np.ndarray, height: np.ndarray, bands: Sequence[tuple[float, Triple]]) -> Mesh:
    """Paint by height: `bands` are (upper limit, colour) from below, the last without limit; triangles are cut at the
    limits."""
    values = np.concatenate([corners, normals], axis=2)
    for limit, _ in bands[:-1]:
        values, height = cut(values, height, limit)
    limits = [limit for limit, _ in bands[:-1]]
    which = np.searchsorted(limits, height.mean(axis=1))
    size = np.linalg.norm(np.cross(values[:, 1, :3] - values[:, 0, :3], values[:, 2, :3] - values[:, 0, :3]), axis=1)
    values, which = values[size > 0.0], which[size > 0.0]
    colour = np.array([paint for _, paint in bands], dtype=float)[which]
    between = values[:, :, 3:] / np.linalg.norm(values[:, :, 3:], axis=2, keepdims=True)
    return Mesh(values[:, :, :3], between, colour, np.zeros(len(colour)))


def refined(values: np.ndarray, longest: float) -> np.ndarray:
    """Triangles (m, 3, k), points first, quartered, six times at most, until no edge is longer than `longest` [m]."""
    for _ in range(6):
        edges = np.linalg.norm(values[:, :, :3] - np.roll(values[:, :, :3], -1, axis=1), axis=2).max(axis=1)
        large = edges > longest
        if not large.any():
            break
        p, q, r = (values[large][:, k] for k in range(3))
        pq, qr, rp = 0.5 * (p + q), 0.5 * (q + r), 0.5 * (r + p)
        quarters = [np.stack(t, axis=1) for t in ((p, pq, rp), (pq, q, qr), (rp, qr, r), (pq, qr, rp))]
        values = np.concatenate([values[~large], *quarters])
    return values
