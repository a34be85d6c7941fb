"""Eye of the preview: around the ship or the basin, at the helm, above, at the side."""

from math import cos, radians, sin, tan
from typing import NamedTuple

import numpy as np

from ocean_sim.pictures.stage.sky import unit
from ocean_sim.ship import Ship

OUTSIDE, HELM = 35.0, 60.0  # [deg] vertical angles of view
FAR = 6.0  # lengths of a ship; in a longer basin the camera follows it
SHIPS = 2.5  # lengths of a ship that a camera which follows it sees
FILLED = 0.95  # share of the free part of the picture that the box fills along one side


class Eye(NamedTuple):
    position: np.ndarray  # [m]
    target: np.ndarray  # [m]
    up: np.ndarray
    angle: float  # [deg], vertical
    near: float  # [m] nothing nearer is drawn
    far: float  # [m]


class Frame(NamedTuple):
    """The picture that an eye fills."""

    aspect: float  # width over height
    covered: float  # share of the width, from the left, where the panel is


class Orbit(NamedTuple):
    """Position of the eye around its target."""

    azimuth: float  # [rad]
    height: float  # [rad] above the horizon
    distance: float  # over that at which everything is in the picture


def seen(
    camera: str, orbit: Orbit, box: tuple[np.ndarray, np.ndarray], frame: Frame, ship: Ship | None, length: float
) -> Eye:
    """Eye of a camera of panel.CAMERAS around a box, its lowest and highest corner [m]; `length` of the ship [m], 0
    where none is drawn."""
    if camera == "helm" and ship is not None:
        return at_helm(ship, length)
    middle, size = subject(box, ship, length)
    towards, up = direction(camera, orbit)
    return framed(middle, size, towards, up, frame, orbit.distance)


def subject(box: tuple[np.ndarray, np.ndarray], ship: Ship | None, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Middle and size [m] of what the picture is of: the water, or the ship in one that is many times as long."""
    lower, upper = (np.array(corner, dtype=float) for corner in box)
    middle, size = 0.5 * (lower + upper), upper - lower
    if ship is not None and length and max(size[0], size[2]) > FAR * length:
        position = ship.body.position
        return np.array([position[0], 0.0, position[2]]), np.full(3, SHIPS * length)
    return middle, size


def direction(camera: str, orbit: Orbit) -> tuple[np.ndarray, np.ndarray]:
    """The direction of view, and what is up in the picture."""
    if camera == "top":
        return np.array([0.0, -1.0, 0.0]), np.array([0.0, 0.0, -1.0])
    if camera == "side":
        return np.array([0.0, 0.0, -1.0]), np.array([0.0, 1.0, 0.0])
    flat = cos(orbit.height)
    towards = -np.array([flat * sin(orbit.azimuth), sin(orbit.height), flat * cos(orbit.azimuth)])
    return towards, np.array([0.0, 1.0, 0.0])


def framed(
    middle: np.ndarray, size: np.ndarray, towards: np.ndarray, up: np.ndarray, frame: Frame, distance: float
) -> Eye:
    """Eye that sees a box of this middle and size [m] in the free part of the picture."""
    right = unit(np.cross(towards, up))
    high = np.cross(right, towards)
    corners = middle + 0.5 * size * (2.0 * np.array(list(np.ndindex(2, 2, 2))) - 1.0)
    x, y, away = corners @ right, corners @ high, corners @ towards
    steep = tan(radians(OUTSIDE / 2))
    aside = steep * frame.aspect * frame.covered  # tangent at which the middle of the free part lies
    slopes = FILLED * steep * frame.aspect * (1.0 - frame.covered), FILLED * steep
    # Planes through the eye bound the free part of the picture: each corner limits how far forward the eye may stand.
    bounds = [
        ((along - slope * away).max(), (along + slope * away).min())
        for along, slope in zip((x - aside * away, y), slopes, strict=True)
    ]
    ahead = min((inner - outer) / (2.0 * slope) for (outer, inner), slope in zip(bounds, slopes, strict=True))
    reach = distance * (float(middle @ towards) - ahead)
    ahead = float(middle @ towards) - reach
    eye_x, eye_y = (0.5 * (outer + inner) for outer, inner in bounds)
    eye = (eye_x + aside * ahead) * right + eye_y * high + ahead * towards
    far = 40.0 * max(reach, float(size.max()))
    return Eye(eye, eye + reach * towards, up, OUTSIDE, 0.02 * reach, far)


def at_helm(ship: Ship, length: float) -> Eye:
    """From the point named helm, else from above the middle of the ship, towards the bow and a little down."""
    body, turn = ship.body, ship.body.matrix
    helm = ship.points.get("helm", np.array([0.0, 0.25 * (length or 4.0), 0.0]))
    eye = body.position + turn @ helm
    return Eye(eye, eye + turn @ np.array([0.0, -0.12, 1.0]), turn @ np.array([0.0, 1.0, 0.0]), HELM, 0.2, 4000.0)
