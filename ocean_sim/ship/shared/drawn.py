"""A hull as triangles, to be drawn."""

import numpy as np

from ocean_sim.files.cache_file import kept
from ocean_sim.ship.shared.shapes import HullShape

STATIONS, WATERLINES, HALVINGS = 41, 25, 24


def drawn(shape: HullShape) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) vertices [m] in the hull's axes and (m, 3) triangles that face outwards: of a mesh its own, of another
    shape the convex hull of its sections."""
    mesh = shape.closed()
    if mesh is not None:
        return mesh.vertices, mesh.faces
    found = kept("drawn", content(shape), lambda: spanned(shape))
    return found["vertices"], found["triangles"]


def content(shape: HullShape) -> bytes:
    """What the form depends on that a shape is drawn in."""
    return shape.content() + f" {STATIONS} {WATERLINES} {HALVINGS}".encode()


def spanned(shape: HullShape) -> dict[str, np.ndarray]:
    """The convex hull of the sections of a shape: all their points, and the triangles."""
    from scipy.spatial import ConvexHull

    vertices = shape.vertices()
    points = sections(shape) if vertices is None else vertices
    hull = ConvexHull(points)
    a, b, c = (points[hull.simplices[:, k]] for k in range(3))
    inwards = (np.cross(b - a, c - a) * hull.equations[:, :3]).sum(axis=1) < 0.0
    return {"vertices": points, "triangles": np.where(inwards[:, None], hull.simplices[:, ::-1], hull.simplices)}


def sections(shape: HullShape) -> np.ndarray:
    """(n, 3) points of the sides [m], where halving finds them."""
    lower, upper = shape.bounds()
    tiny = 1e-6 * (upper - lower)
    y, z = (
        0.5 * (lower[k] + upper[k]) - (0.5 * (upper[k] - lower[k]) - tiny[k]) * np.cos(np.linspace(0.0, np.pi, count))
        for k, count in ((1, WATERLINES), (2, STATIONS))
    )  # close together at the ends, where a hull is round
    y, z = (grid.ravel() for grid in np.meshgrid(y, z, indexing="ij"))
    least, most = np.zeros(len(y)), np.full(len(y), upper[0])
    for _ in range(HALVINGS):
        middle = 0.5 * (least + most)
        within = shape.inside(np.stack([middle, y, z], axis=1))
        least, most = np.where(within, middle, least), np.where(within, most, middle)
    there = shape.inside(np.stack([np.zeros(len(y)), y, z], axis=1))
    port = np.stack([most, y, z], axis=1)[there]
    return np.concatenate([port, port * [-1.0, 1.0, 1.0]])
