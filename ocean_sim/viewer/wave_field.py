"""A wave field that other programs ask over the socket: elevation, normal, velocity, and a square that repeats itself.

Water that is no more than its plane waves answers for any time, and so does the square, which is always of plane waves.
Other water, particles or a sea with wakes and breakers, answers for now, as its gauges read it.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from ocean_sim.conventions import Refused
from ocean_sim.viewer.protocol import Waves
from ocean_sim.waves.field import WaveField

if TYPE_CHECKING:
    from ocean_sim.fluid import Fluid

APART = 0.5  # spacings of the water, over which a slope is taken on either side


def answer(fluid: "Fluid", now: float, asked: Waves) -> dict[str, Any]:
    """What is told of the waves: the time [s] it holds for, and `values`, a row a point, NaN where there is no water as
    null. Raises Refused."""
    time, sea = now if asked.time is None else asked.time, fluid.plane_waves
    if asked.verb == "field":
        if sea is None:
            raise Refused("this water is not a sum of plane waves: it has no square that repeats itself")
        return {"time": time, "values": plain(WaveField(sea).field(asked.cells, asked.side, time))}
    length = 3 if asked.verb == "velocity" else 2
    if any(len(point) != length for point in asked.points):
        raise Refused(f"{asked.verb} is asked at points of {'x, y, z' if length == 3 else 'x, z'} [m]")
    points = np.array(asked.points, dtype=float).reshape(-1, length)
    if sea is not None and fluid.in_closed_form is not None and not fluid.answers:
        whole = WaveField(sea)
        verbs = {"elevation": whole.elevation, "normal": whole.normal, "velocity": whole.velocity}
        return {"time": time, "values": plain(verbs[asked.verb](points, time))}
    if asked.time is not None:
        raise Refused(
            "this water is more than its plane waves: it is known only at the present time, leave the time out"
        )
    if asked.verb == "normal":
        return {"time": now, "values": plain(normals(fluid, points))}
    found = fluid.elevations(points) if asked.verb == "elevation" else fluid.velocities(points)
    return {"time": now, "values": plain(found)}


def normals(fluid: "Fluid", points: np.ndarray) -> np.ndarray:
    """(n, 3) upward unit normals of the water's surface at points x, z (n, 2) [m], by differences."""
    step = APART * fluid.spacing
    slopes = [
        (fluid.elevations(points + step * along) - fluid.elevations(points - step * along)) / (2.0 * step)
        for along in np.eye(2)
    ]
    found = np.stack([-slopes[0], np.ones(len(points)), -slopes[1]], axis=1)
    return found / np.linalg.norm(found, axis=1, keepdims=True)


def plain(values: np.ndarray) -> list[Any]:
    """Numbers with six digits, as JSON has them."""
    rows = np.round(np.asarray(values, dtype=float), 6)
    whole = rows.astype(object)
    whole[~np.isfinite(rows)] = None
    return list(whole.tolist())
