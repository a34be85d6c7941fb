"""Metacentric heights from the faces of a hull, without cubes: KB + I / V - KG, by integrals over its wet faces.

Over a closed surface the integral of f(x, z) n_y is 0, so that over the waterplane, where n_y = 1, it is that over the
wet faces with the other sign; with heights from the waterplane, volume and its moment are the integrals of y n_y and
y^2 n_y / 2 (Gauss).
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ocean_sim.ship.shared.drawn import drawn
from ocean_sim.ship.shared.hydrostatics import Hydrostatics
from ocean_sim.ship.shared.shapes import HullShape

HALVED = 60  # times that the height of the water is looked for


class Wet(NamedTuple):
    """What lies under a level, from integrals over its faces."""

    volume: float  # [m3]
    below: float  # moment of the volume about the level, negative [m4]
    area: float  # of the waterplane [m2]
    first: np.ndarray  # (2,) its moments along x and z [m3]
    second: np.ndarray  # (2,) the same, second [m4]


def metacentric_heights(shape: HullShape, still: Hydrostatics) -> tuple[float, float] | None:
    """GM across and along [m] of a hull upright in still water; None where its faces only approach it, or it sinks."""
    if shape.rounded:
        return None
    vertices, triangles = drawn(shape)
    faces = vertices[triangles]
    low, high = float(faces[..., 1].min()), float(faces[..., 1].max())
    if still.wanted >= under(faces, high).volume:
        return None
    for _ in range(HALVED):
        level = 0.5 * (low + high)
        low, high = (level, high) if under(faces, level).volume < still.wanted else (low, level)
    wet = under(faces, level)
    about_middle = wet.second - wet.first**2 / wet.area
    km = level + (wet.below + about_middle) / wet.volume
    across, along = km - still.matter.centre[1] - np.array(still.lost)
    return float(across), float(along)


def under(faces: np.ndarray, level: float) -> Wet:
    """Of closed faces (n, 3, 3) [m] that look outwards, under a level [m]."""
    cut = parts(faces - [0.0, level, 0.0])
    upwards = 0.5 * np.cross(cut[:, 1] - cut[:, 0], cut[:, 2] - cut[:, 0])[:, 1]  # area times n_y [m2]
    x, y, z = np.moveaxis(0.5 * (cut + np.roll(cut, -1, axis=1)), 2, 0)  # middles of the edges: exact to second order

    def over(values: np.ndarray) -> float:
        return float(upwards @ values.mean(axis=1))

    plane = [np.ones_like(x), x, z, x * x, z * z]
    area, *moments = (-over(values) for values in plane)
    return Wet(over(y), 0.5 * over(y * y), area, np.array(moments[:2]), np.array(moments[2:]))


def parts(faces: np.ndarray) -> np.ndarray:
    """(m, 3, 3) triangles: what of faces (n, 3, 3) lies under y = 0."""
    highest, lowest = faces[..., 1].max(axis=1), faces[..., 1].min(axis=1)
    found = [faces[highest <= 0.0]]
    for face in faces[(highest > 0.0) & (lowest < 0.0)]:
        first, *others = below(face)
        found.append(np.array([(first, b, c) for b, c in pairwise(others)]).reshape(-1, 3, 3))
    return np.concatenate(found)


def below(face: np.ndarray) -> list[np.ndarray]:
    """Corners of the part of a triangle (3, 3) that lies under y = 0, in its order."""
    corners = []
    for a, b in zip(face, np.roll(face, -1, axis=0)):
        if a[1] <= 0.0:
            corners.append(a)
        if min(a[1], b[1]) < 0.0 < max(a[1], b[1]):
            corners.append(a + a[1] / (a[1] - b[1]) * (b - a))
    return corners
