"""Metacentric heights from the faces of a hull, without cubes: KB + I / V - KG, by integrals over its wet faces.

Over a closed surface the integral of f(x, z) n_y is 0, so that over the waterplane, where n_y = 1, it is that over the
wet faces with the other sign; with heights from the waterplane, volume and its moment are the integrals of y n_y and
y^2 n_y / 2 (Gauss).
"""

from functools import partial
from typing import NamedTuple

import numpy as np

from ocean_sim.ship.shared.drawn import drawn
from ocean_sim.ship.shared.hydrostatics import Hydrostatics
from ocean_sim.ship.shared.mesh import ClosedMesh, gauss_points, lone_corner_first, stretches
from ocean_sim.ship.shared.shapes import HullShape

ROUNDING = 1e-13  # of a hull's height


class Wet(NamedTuple):
    """What lies under a level, from integrals over its faces."""

    volume: float  # [m3]
    below: float  # moment of the volume about the level, negative [m4]
    area: float  # of the waterplane [m2]
    first: np.ndarray  # (2,) its moments along x and z [m3]
    second: np.ndarray  # (2,) the same, second [m4]


def metacentric_heights(shape: HullShape, still: Hydrostatics) -> tuple[float, float] | None:
    """GM across and along [m] of a hull upright in still water; None where its faces only approach it, or it sinks."""
    from scipy.optimize import brentq

    if shape.rounded:
        return None
    vertices, triangles = drawn(shape)
    faces, mesh = vertices[triangles], shape.closed()
    wet_under = partial(under, faces) if mesh is None or not mesh.overlaps else partial(columns_under, mesh)
    low, high = float(faces[..., 1].min()), float(faces[..., 1].max())
    if still.wanted >= wet_under(high).volume:
        return None
    level = brentq(lambda y: wet_under(y).volume - still.wanted, low, high, xtol=ROUNDING * (high - low))
    wet = wet_under(level)
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


def columns_under(mesh: ClosedMesh, level: float) -> Wet:
    """Wet part of a mesh whose faces pass through each other, by its columns and the lines across its waterplane."""
    volume, below = (mesh.integral(lambda y: np.minimum(y - level, 0.0) ** n / n) for n in (1, 2))
    positions, along = gauss_points(mesh.vertices[:, 2])
    line, port, starboard = stretches(mesh.triangles[..., [2, 0, 1]], positions, np.array([level]))
    z, dz = positions[line], along[line]
    area, first, second = (dz * (starboard**n - port**n) / n for n in (1, 2, 3))
    moments = np.array([first.sum(), z @ area]), np.array([second.sum(), z**2 @ area])
    return Wet(volume, below, float(area.sum()), *moments)


def parts(faces: np.ndarray) -> np.ndarray:
    """(m, 3, 3) triangles that sum up to the part of faces (n, 3, 3) under y = 0: the faces of which most is there, and
    tips that are cut off, turned round where they are to be taken away."""
    over = faces[..., 1] > 0.0
    number = np.count_nonzero(over, axis=1)
    cut = number % 3 > 0
    a, b, c, above = lone_corner_first(faces[cut], over[cut])
    ab, ac = (a + (a[:, 1] / (a[:, 1] - end[:, 1]))[:, None] * (end - a) for end in (b, c))
    tips = np.where(above[:, None, None], np.stack([a, ac, ab], axis=1), np.stack([a, ab, ac], axis=1))
    return np.concatenate([faces[number <= 1], tips])
