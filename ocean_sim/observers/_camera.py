"""Where the eye is: the named cameras, each placed so that the whole basin is in the picture."""

from typing import Literal, NamedTuple

import numpy as np

Name = Literal["third_person", "top", "side"]
VIEW_ANGLE = 35.0  # [deg], vertical
MARGIN = 1.05
BAND = 1.3  # room above and below the water for words, in the picture from the side
HEADROOM = 0.24  # of the basin's length: sky above the water in perspective pictures
TOWARDS = {  # direction of view, and what is up in the picture
    "third_person": ((-0.60, -0.27, -0.77), (0.0, 1.0, 0.0)),
    "top": ((0.0, -1.0, 0.0), (0.0, 0.0, -1.0)),
    "side": ((0.0, 0.0, -1.0), (0.0, 1.0, 0.0)),
}


class Camera(NamedTuple):
    eye: np.ndarray  # [m]
    forward: np.ndarray
    up: np.ndarray
    parallel_height: float | None  # [m] half the height of the picture in parallel projection; None: perspective


def placed(name: Name, lower: np.ndarray, upper: np.ndarray, aspect: float) -> Camera:
    """The camera that sees the box from `lower` to `upper` [m] in a picture `aspect` times as wide as high."""
    forward, up = (np.array(v) / np.linalg.norm(v) for v in TOWARDS[name])
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    headroom = HEADROOM * (upper - lower).max() if name == "third_person" else 0.0
    top = upper + [0.0, headroom, 0.0]
    corners = np.array([[(lower, top)[b][a] for a, b in enumerate(k)] for k in np.ndindex(2, 2, 2)])
    x, y, away = corners @ right, corners @ up, corners @ forward
    if name == "side":
        middle = 0.5 * (x.min() + x.max()) * right + 0.5 * (y.min() + y.max()) * up
        half = 0.5 * max(BAND * np.ptp(y), MARGIN * np.ptp(x) / aspect)
        return Camera(middle + (away.min() - 4.0 * np.linalg.norm(upper - lower)) * forward, forward, up, half)
    tangent = np.tan(np.radians(VIEW_ANGLE / 2)) / MARGIN
    # Planes through the eye bound the picture: each corner limits how far forward the eye may stand.
    bounds = [((c - t * away).max(), (c + t * away).min(), t) for c, t in ((x, tangent * aspect), (y, tangent))]
    ahead = min((high - low) / (2.0 * t) for low, high, t in bounds)
    eye_x, eye_y = (0.5 * (low + high) for low, high, _ in bounds)
    return Camera(eye_x * right + eye_y * up + ahead * forward, forward, up, None)
