"""Where the eye of the preview is: around the ship or the basin, at the helm, above, beside."""

from math import cos, radians, sin, tan
from typing import Any, NamedTuple

import numpy as np

from ocean_sim.pictures.sky import unit

OUTSIDE, HELM = 35.0, 60.0  # [deg] vertical angles of view
FAR = 6.0  # lengths of a ship; in a longer basin the camera follows it
SHIPS = 2.5  # lengths of a ship that a camera which follows it sees


class Eye(NamedTuple):
    place: np.ndarray  # [m]
    target: np.ndarray  # [m]
    up: np.ndarray
    angle: float  # [deg], vertical
    near: float  # [m] nothing nearer is drawn
    far: float  # [m]


def seen(
    camera: str, orbit: tuple[float, float, float], box: Any, ship: Any, length: float, free: Any, aspect: float
) -> Eye:
    """The eye of a camera of _panel.CAMERAS; `orbit`: azimuth, height [rad] and distance; `box`: corners of the water
    [m]; `length` of the ship [m], 0 where none is drawn; `free`: (x, y, width, height) of the picture that no panel
    covers, y upwards."""
    lower, upper = (np.array(corner, dtype=float) for corner in box)
    body = None if ship is None else ship.body
    if camera == "helm" and body is not None:
        return at_helm(ship, length)
    middle, size = 0.5 * (lower + upper), upper - lower
    if body is not None and length and max(size[0], size[2]) > FAR * length:
        middle, size = np.array([body.position[0], 0.0, body.position[2]]), np.full(3, SHIPS * length)
    azimuth, height, distance = orbit
    if camera == "top":
        towards, up = np.array([0.0, -1.0, 0.0]), np.array([0.0, 0.0, -1.0])
    elif camera == "side":
        towards, up = np.array([0.0, 0.0, -1.0]), np.array([0.0, 1.0, 0.0])
    else:
        flat = cos(height)
        towards = -np.array([flat * sin(azimuth), sin(height), flat * cos(azimuth)])
        up = np.array([0.0, 1.0, 0.0])
    right = unit(np.cross(towards, up))
    high = np.cross(right, towards)
    corners = middle + 0.5 * size * (2.0 * np.array(list(np.ndindex(2, 2, 2))) - 1.0)
    x, y, away = corners @ right, corners @ high, corners @ towards
    half = tan(radians(OUTSIDE / 2))
    # Planes through the eye bound the free part of the picture: each corner limits how far forward the eye may stand.
    bounds, shifts = [], []
    for place, t, begin, part in ((x, half * aspect, free[0], free[2]), (y, half, free[1], free[3])):
        shift, t = t * (2.0 * begin + part - 1.0), t * part
        leaning = place - shift * away
        bounds.append(((leaning - t * away).max(), (leaning + t * away).min(), t))
        shifts.append(shift)
    ahead = min((inner - outer) / (2.0 * t) for outer, inner, t in bounds)
    reach = distance * (float(middle @ towards) - ahead)
    ahead = float(middle @ towards) - reach
    eye_x, eye_y = (0.5 * (outer + inner) + shift * ahead for (outer, inner, _), shift in zip(bounds, shifts))
    eye = eye_x * right + eye_y * high + ahead * towards
    far = 40.0 * max(reach, float(size.max()))
    return Eye(eye, eye + reach * towards, up, OUTSIDE, 0.02 * reach, far)


def at_helm(ship: Any, length: float) -> Eye:
    """From the place named helm, else from above the middle of the ship, towards the bow and a little down."""
    body, turn = ship.body, ship.body.matrix
    place = ship.points.get("helm", np.array([0.0, 0.25 * (length or 4.0), 0.0]))
    eye = body.position + turn @ place
    return Eye(eye, eye + turn @ np.array([0.0, -0.12, 1.0]), turn @ np.array([0.0, 1.0, 0.0]), HELM, 0.2, 4000.0)
