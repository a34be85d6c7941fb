"""Metacentric heights from the faces of a hull, without cubes: KB + I / V - KG, by integrals over its wet faces.

Over a closed surface the integral of f(x, z) n_y is 0, so that over the waterplane, where n_y = 1, it is that over the
wet faces with the other sign; with heights from the waterplane, volume and its moment are the integrals of y n_y and
y^2 n_y / 2 (Gauss).
"""

from typing import NamedTuple

import numpy as np

from ocean_sim.ship.shared.drawn import drawn
from ocean_sim.ship.shared.hydrostatics import Hydrostatics
from ocean_sim.ship.shared.mesh import ClosedMesh, gauss_points, stretches
from ocean_sim.ship.shared.shapes import HullShape

MAX_STEPS = 60  # to the height of the water, by Newton's method between bounds
ROUNDING = 1e-13  # of that height, or of the volume


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
    faces, mesh = vertices[triangles], shape.closed()
    overlapping = mesh if mesh is not None and mesh.overlaps else None

    def wet_under(level: float) -> Wet:
        return under(faces, level) if overlapping is None else columns_under(overlapping, level)

    low, high = float(faces[..., 1].min()), float(faces[..., 1].max())
    if still.wanted >= wet_under(high).volume:
        return None
    level = 0.5 * (low + high)
    for _ in range(MAX_STEPS):
        wet = wet_under(level)
        low, high = (level, high) if wet.volume < still.wanted else (low, level)
        if high - low < ROUNDING * abs(high) or abs(wet.volume - still.wanted) < ROUNDING * still.wanted:
            break
        newton = level + (still.wanted - wet.volume) / wet.area if wet.area > 0.0 else low
        level = newton if low < newton < high else 0.5 * (low + high)
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
    """As `under`, of a mesh whose faces pass through each other, by its columns and lines across its waterplane."""
    low, high, area = mesh.columns
    low, high = np.minimum(low, level) - level, np.minimum(high, level) - level
    volume, below = float(area @ (high - low)), 0.5 * float(area @ (high**2 - low**2))
    positions, along = gauss_points(mesh.vertices[:, 2])
    line, port, starboard = stretches(mesh.triangles[..., [2, 0, 1]], positions, np.array([level]))
    z, dz = positions[line], along[line]
    powers = [dz * (starboard**n - port**n) / n for n in (1, 2, 3)]
    moments = [powers[1].sum(), z @ powers[0], powers[2].sum(), z**2 @ powers[0]]
    return Wet(volume, below, float(powers[0].sum()), np.array(moments[:2]), np.array(moments[2:]))


def parts(faces: np.ndarray) -> np.ndarray:
    """(m, 3, 3) triangles: the part of faces (n, 3, 3) under y = 0."""
    under = faces[..., 1] <= 0.0
    found = [faces[under.all(axis=1)]]
    for number, alone in ((1, under), (2, ~under)):  # the corner by itself comes first, in the order of the face
        cut = np.flatnonzero(np.count_nonzero(under, axis=1) == number)
        first = np.argmax(alone[cut], axis=1)[:, None]
        a, b, c = np.moveaxis(np.take_along_axis(faces[cut], ((first + range(3)) % 3)[..., None], axis=1), 1, 0)
        ab, ac = (a + (a[:, 1] / (a[:, 1] - end[:, 1]))[:, None] * (end - a) for end in (b, c))
        corners = [(a, ab, ac)] if number == 1 else [(ab, b, c), (ab, c, ac)]
        found += [np.stack(triangle, axis=1) for triangle in corners]
    return np.concatenate(found)
