"""Parts of drawn ships: meshes of triangles with a colour each, lofted, turned and cut in pure NumPy.

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
    normals = area_vectors(corners)
    if middle is not None:
        inwards = (normals * (corners.mean(axis=1) - middle)).sum(axis=1) < 0.0
        corners[inwards] = corners[inwards][:, ::-1]
        normals[inwards] *= -1.0
    size = np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    return plain_mesh(corners, np.repeat((normals / size)[:, None], 3, axis=1), colour, gloss)


def plain_mesh(corners: np.ndarray, normals: np.ndarray, colour: Triple, gloss: float = 0.0) -> Mesh:
    """Mesh of triangles (m, 3, 3) [m] with normals (m, 3, 3), of one colour and gloss, without those of no area."""
    kept = area_vectors(corners).any(axis=1)
    m = int(kept.sum())
    return Mesh(corners[kept], normals[kept], np.tile(colour, (m, 1)), np.full(m, gloss))


def area_vectors(corners: np.ndarray) -> np.ndarray:
    """Normals (m, 3) of triangles (m, 3, 3) [m], as long as twice their areas [m2]."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


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
    """Unit normals (m, 3, 3) at triangle corners: area-weighted means of faces around a vertex, not across creases."""
    faces = area_vectors(vertices[triangles])
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


def paint_bands(values: np.ndarray, up: np.ndarray, level: float, bands: Sequence[tuple[float, Triple]]) -> Mesh:
    """Mesh of triangles (m, 3, 6) of points [m] and normals, coloured by height and cut where colours meet. The height
    of a point x is up . x + level [m]; `bands`: (upper limit [m], colour) from below, the last without limit."""
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
