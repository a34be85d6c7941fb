"""Camera of the preview: around the ship or the basin, at the helm, above, at the side."""

from math import cos, radians, sin, tan

import numpy as np

from ocean_sim.pictures.stage.camera import VIEW_ANGLE, Camera, eye_before
from ocean_sim.pictures.stage.sky import unit_vector
from ocean_sim.ship import Ship

HELM_ANGLE = 60.0  # [deg] vertical angle of view at the helm
HELM_NEAR = 0.2  # [m] the least distance that is drawn at the helm
LONG_BASIN = 6.0  # lengths of a ship; in a longer basin the camera follows it
FOLLOWED_SIZE = 2.5  # lengths of a ship that a camera which follows it sees
FILLED_SHARE = 0.95  # of the free part of the picture that the box fills along one side


def preview_camera(
    name: str,
    azimuth: float,
    height: float,
    distance: float,
    box: tuple[np.ndarray, np.ndarray],
    aspect: float,
    covered: float,
    ship: Ship | None,
    length: float,
) -> Camera:
    """Camera `name`, one of panel.CAMERA_NAMES, that sees a box, given by its lower and upper corner [m], in a picture
    `aspect` times as wide as high, of which a panel covers the left share `covered`. `azimuth`, `height` [rad] and
    `distance` of the eye as in Panel; `length` of the ship [m], 0 if none is drawn."""
    if name == "helm" and ship is not None:
        return helm_camera(ship, length)
    lower, upper = (np.array(corner, dtype=float) for corner in box)
    middle, size = 0.5 * (lower + upper), upper - lower
    if ship is not None and length and max(size[0], size[2]) > LONG_BASIN * length:
        middle, size = ship.body.position * [1.0, 0.0, 1.0], np.full(3, FOLLOWED_SIZE * length)
    if name == "top":
        forward, up = np.array([0.0, -1.0, 0.0]), np.array([0.0, 0.0, -1.0])
    else:
        azimuth, height = (0.0, 0.0) if name == "side" else (azimuth, height)
        level = cos(height)
        forward = -np.array([level * sin(azimuth), sin(height), level * cos(azimuth)])
        up = np.array([0.0, 1.0, 0.0])
    right = unit_vector(np.cross(forward, up))
    up = np.cross(right, forward)
    corners = middle + 0.5 * size * (2.0 * np.array(list(np.ndindex(2, 2, 2))) - 1.0)
    tangent = tan(radians(VIEW_ANGLE / 2))
    free = FILLED_SHARE * tangent * aspect * (1.0 - covered), FILLED_SHARE * tangent
    aside = tangent * aspect * covered  # tangent at which the middle of the free part lies
    eye = eye_before(corners, (right, up, forward), free, aside)
    reach = float((middle - eye) @ forward)
    eye -= (distance - 1.0) * reach * (forward + aside * right)
    return Camera(eye, forward, up, None, near=0.02 * distance * reach)


def helm_camera(ship: Ship, length: float) -> Camera:
    """Camera at the ship's point named helm, or else above her middle, that looks at the bow and a little down."""
    body, turn = ship.body, ship.body.matrix
    helm = ship.points.get("helm", np.array([0.0, 0.25 * (length or 4.0), 0.0]))
    forward = turn @ unit_vector(np.array([0.0, -0.12, 1.0]))
    return Camera(body.position + turn @ helm, forward, turn @ np.array([0.0, 1.0, 0.0]), None, HELM_ANGLE, HELM_NEAR)
