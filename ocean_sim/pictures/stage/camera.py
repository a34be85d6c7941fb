"""Cameras: fixed ones that see the whole basin, and ones that move with the ship."""

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np

from ocean_sim.pictures.stage.sky import unit_vector

CameraName = Literal["third_person", "follow", "orbit", "fixed", "first_person", "top", "side"]
SHIP_CAMERAS = ("follow", "first_person")  # that need a ship
VIEW_ANGLE = 35.0  # [deg], vertical
WIDE_ANGLE = 50.0  # [deg], vertical, from the helm
FRAME_MARGIN = 1.1  # of what must be seen
SIDE_BAND = 1.3  # room above and below the water for words, in the picture from the side
SKY_HEADROOM = 0.24  # of the basin's length: sky above the water in perspective pictures
SIDE_EYE_HEIGHT = 0.05  # height of the camera beside an open sea, over its distance
SIDE_REACH = 1.5  # lengths of a ship that it sees each way of her middle
VIEW_DIRECTIONS = {  # direction of view, and what is up in the picture
    "third_person": ((0.30, -0.27, -0.92), (0.0, 1.0, 0.0)),  # the sun shines from the left
    "top": ((0.0, -1.0, 0.0), (0.0, 0.0, -1.0)),
    "side": ((0.0, 0.0, -1.0), (0.0, 1.0, 0.0)),
}


LONG_BASIN = 2.5  # lengths of a ship; in a longer basin `third_person` follows it
FOLLOWED_REACH = 0.62  # lengths of a ship that it sees each way then, from the still water up
HEAVE_ROOM = 0.16  # lengths of a ship over her top at rest that stay in the picture, too: she rises with the waves
# Lengths of a ship and [deg] to starboard, from which `follow` looks at it
FOLLOW_DISTANCE, FOLLOW_HEIGHT, FOLLOW_ANGLE = 1.9, 0.5, 22.0
FOLLOW_LAGS = 0.9, 1.6  # [s] in which `follow` makes up for 1 - 1/e of a change of position and of heading
ORBIT_RADIUS, ORBIT_HEIGHT = 2.2, 0.55  # lengths of a ship: radius and height of `orbit`
HELM_PITCH = 5.0  # [deg] below straight ahead, from the helm
MAP_DIRECTION = -0.97  # vertical part of the direction of view, from which a picture is a map
NEAR_SHARE = 0.012  # lengths of a ship: what is nearer to the eye is not drawn


class Camera(NamedTuple):
    """Camera of a picture: position of the eye, directions and projection."""

    eye: np.ndarray  # [m]
    forward: np.ndarray
    up: np.ndarray
    parallel_height: float | None  # [m] half the height of the picture in parallel projection; None: perspective
    angle: float = VIEW_ANGLE  # [deg], vertical
    near: float | None = None  # [m] the least distance that is drawn; None: as befits a picture of the whole basin

    @property
    def from_above(self) -> bool:
        """True if the camera looks straight down, or nearly so: its picture is a map."""
        return bool(self.forward[1] < MAP_DIRECTION)

    def rays(self, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Directions (k, 3) through all places of the picture at `u` to the right and `v` up, 1 at its upper edge."""
        up, right = (part.reshape(-1, 1) for part in np.meshgrid(v, u, indexing="ij"))
        across = up * self.up + right * np.cross(self.forward, self.up)
        return self.forward + np.tan(np.radians(self.angle) / 2.0) * across

    def spread(self, aspect: float) -> tuple[float, float]:
        """Largest angles [rad] seen beside the heading and below the horizon; `aspect`: picture's width over height."""
        ends = np.linspace(-1.0, 1.0, 9)
        rays = unit_vector(self.rays(aspect * ends, ends))
        level = np.hypot(rays[:, 0], rays[:, 2])
        lowest = float(np.arcsin(np.clip(-rays[:, 1], 0.0, 1.0)).max())
        if level.min() < 0.3:
            return np.pi, lowest
        heading = np.arctan2(self.forward[2], self.forward[0])
        aside = np.mod(np.arctan2(rays[:, 2], rays[:, 0]) - heading + np.pi, 2.0 * np.pi) - np.pi
        return float(np.abs(aside).max()), lowest


@dataclass
class Track:
    """Poses of a ship at the times of all frames so far; the arrays are replaced while the run continues."""

    time: np.ndarray  # (n,) [s]
    position: np.ndarray  # (n, 3) [m]
    turn: np.ndarray  # (n, 3, 3) body to world


class Vessel(NamedTuple):
    """Ship as cameras and wakes know her: size, eye of her helmsman, and track (poses over time)."""

    length: float  # [m]
    helm: np.ndarray  # (3,) body axes from the centre of mass [m]
    track: Track
    height: float = 0.0  # [m] of the top of her mast over the centre of mass, upright

    def pose(self, time: float) -> tuple[np.ndarray, np.ndarray]:
        """Position (3,) [m] and turn (3, 3), body to world, in the frame nearest to a time [s]."""
        k = int(np.abs(self.track.time - time).argmin())
        return self.track.position[k], self.track.turn[k]

    def speed(self, time: float) -> float:
        """Speed over the ground [m/s] at a time [s], from the positions in the frames before and after."""
        track = self.track
        if len(track.time) < 2:
            return 0.0
        k = int(np.clip(np.searchsorted(track.time, time), 1, len(track.time) - 1))
        way = np.linalg.norm((track.position[k] - track.position[k - 1])[[0, 2]])
        return float(way / (track.time[k] - track.time[k - 1]))


class Operator:
    """Moving camera of a film: gives the `Camera` for each time from the ship's track until then."""

    def __init__(
        self,
        name: CameraName,
        lower: np.ndarray,
        upper: np.ndarray,
        aspect: float,
        span: tuple[float, float],
        **given: Any,
    ) -> None:
        """`lower`, `upper`: corners of the basin [m]; `aspect`: width over height of the picture; `span`: first and
        last time of the film [s]; `given`: `vessel` to follow; True for `away` (ships may leave the basin), `at_sea`,
        `whole` (show all of the basin); `eye`, `target` [m] of the camera `fixed`."""
        self.name, self.lower, self.upper, self.aspect, self.span = name, lower, upper, aspect, span
        self.vessel: Vessel | None = given.get("vessel")
        self.away, self.whole = bool(given.get("away")), bool(given.get("whole"))
        if name == "fixed":
            self.standing = camera_looking(np.array(given["eye"], dtype=float), np.array(given["target"], dtype=float))
        elif name == "side" and given.get("at_sea"):
            middle, reach = 0.5 * (lower + upper) * [1.0, 0.0, 1.0], 0.5 * (upper[0] - lower[0])
            self.standing = camera_abeam(middle, np.array(VIEW_DIRECTIONS["side"][0]), reach, aspect)
        else:
            self.standing = camera_on_box(name if name in VIEW_DIRECTIONS else "third_person", lower, upper, aspect)
        self.trail = np.zeros((0, 3)), np.zeros(0)

    def at(self, time: float) -> Camera:
        """Camera at a time [s] of the film."""
        if self.name == "orbit":
            return self.orbit(time)
        vessel = self.vessel
        fixed = self.name in ("fixed", "top") or (self.whole and self.name == "third_person")
        if vessel is None or fixed or self.standing.parallel_height is not None:
            return self.standing
        k = int(np.abs(vessel.track.time - time).argmin())
        position, turn = vessel.track.position[k], vessel.track.turn[k]
        if self.name == "third_person":
            top = position * [1.0, 0.0, 1.0] + [0.0, vessel.height + HEAVE_ROOM * vessel.length, 0.0]
            camera = self.near_ship(position, vessel.length)
            away = top - camera.eye
            seen = np.tan(np.radians(camera.angle / 2.0)) / FRAME_MARGIN * (away @ camera.forward)
            over = float(away @ camera.up - seen)  # of her mast beyond the picture
            return camera if over <= 0.0 else camera._replace(eye=camera.eye + over * camera.up)
        if self.name in ("follow", "side"):
            if len(self.trail[0]) < len(vessel.track.time):
                self.trail = damped_track(vessel.track)
            centre, heading = self.trail[0][k], self.trail[1][k]
            if self.name == "side":
                beam = np.array([np.cos(heading), 0.0, -np.sin(heading)])
                return camera_abeam(centre, beam, SIDE_REACH * vessel.length, self.aspect)
            towards = heading + np.radians(FOLLOW_ANGLE)
            ahead = np.array([np.sin(towards), 0.0, np.cos(towards)])
            eye = centre - FOLLOW_DISTANCE * vessel.length * ahead + [0.0, FOLLOW_HEIGHT * vessel.length, 0.0]
            return camera_looking(eye, centre + [0.0, 0.08 * vessel.length, 0.0], NEAR_SHARE * vessel.length)
        return helm_camera(position, turn, vessel.helm, 0.5 * NEAR_SHARE * vessel.length)

    def near_ship(self, position: np.ndarray, length: float) -> Camera:
        """Camera `third_person` at a ship's position [m]; moves with her if the basin is long or she may leave it."""
        reach = FOLLOWED_REACH * length * np.array([1.0, 0.0, 1.0])
        lower, upper = position - reach, position + reach
        if not self.away:
            lower, upper = np.maximum(self.lower, lower), np.minimum(self.upper, upper)
            if (self.upper - self.lower).max() <= LONG_BASIN * length:
                return self.standing
        lower[1], upper[1] = 0.0, self.upper[1]
        return camera_on_box("third_person", lower, upper, self.aspect)

    def orbit(self, time: float) -> Camera:
        """Camera at a time [s] of the film, in which it goes once around the ship or the basin."""
        start, end = self.span
        forward = self.standing.forward
        turned = np.arctan2(-forward[0], -forward[2]) + 2.0 * np.pi * (time - start) / max(end - start, 1e-9)
        around = np.array([np.sin(turned), 0.0, np.cos(turned)])
        if self.vessel is not None and not self.whole:
            length, track = self.vessel.length, self.vessel.track
            middle = np.array([np.interp(time, track.time, track.position[:, axis]) for axis in range(3)]) * [1, 0, 1]
            eye = middle + length * (ORBIT_RADIUS * around + [0.0, ORBIT_HEIGHT, 0.0])
            return camera_looking(eye, middle, NEAR_SHARE * length)
        middle = 0.5 * (self.lower + self.upper)
        away = self.standing.eye - middle
        return camera_looking(middle + np.hypot(away[0], away[2]) * around + [0.0, away[1], 0.0], middle)


def camera_looking(eye: np.ndarray, target: np.ndarray, near: float | None = None) -> Camera:
    """Camera at `eye` that looks at `target` [m], with a level horizon; `near`: smallest distance that is drawn [m]."""
    forward = unit_vector(target - eye)
    right = unit_vector(np.cross(forward, [0.0, 1.0, 0.0] if abs(forward[1]) < 0.999 else [0.0, 0.0, -1.0]))
    return Camera(eye, forward, np.cross(right, forward), None, near=near)


def helm_camera(position: np.ndarray, turn: np.ndarray, helm: np.ndarray, near: float) -> Camera:
    """Camera at the eye of a ship's helmsman, `helm` (3,) [m] in body axes, looking ahead and a little down. `position`
    [m] and `turn` (3, 3), from body to world: of the ship; `near`: smallest distance that is drawn [m]."""
    angle = np.radians(HELM_PITCH)
    forward, up = np.array([0.0, -np.sin(angle), np.cos(angle)]), np.array([0.0, np.cos(angle), np.sin(angle)])
    return Camera(position + turn @ helm, turn @ forward, turn @ up, None, WIDE_ANGLE, near)


def damped_track(track: Track) -> tuple[np.ndarray, np.ndarray]:
    """Positions (n, 3) [m] at water level and headings (n,) [rad] of a ship's track after a first-order low-pass."""
    heading = np.unwrap(np.arctan2(track.turn[:, 0, 2], track.turn[:, 2, 2]))
    centre = track.position * [1.0, 0.0, 1.0]
    for k in range(1, len(track.time)):
        step = track.time[k] - track.time[k - 1]
        near, slow = (1.0 - np.exp(-step / lag) for lag in FOLLOW_LAGS)
        centre[k] = centre[k - 1] + near * (centre[k] - centre[k - 1])
        heading[k] = heading[k - 1] + slow * (heading[k] - heading[k - 1])
    return centre, heading


def camera_abeam(middle: np.ndarray, forward: np.ndarray, reach: float, aspect: float) -> Camera:
    """Perspective camera low over an open sea, in place of a parallel side view. It looks along the level direction
    `forward` at `middle` [m] and shows `reach` [m] to either side; `aspect`: width over height of the picture."""
    away = FRAME_MARGIN * reach / (np.tan(np.radians(VIEW_ANGLE / 2.0)) * aspect)
    return camera_looking(middle + away * (np.array([0.0, SIDE_EYE_HEIGHT, 0.0]) - forward), middle)


def camera_on_box(name: CameraName, lower: np.ndarray, upper: np.ndarray, aspect: float) -> Camera:
    """Camera of this name that sees the box from `lower` to `upper` [m]; `aspect`: width over height of the picture."""
    forward, up = (unit_vector(np.array(v)) for v in VIEW_DIRECTIONS[name])
    right = unit_vector(np.cross(forward, up))
    up = np.cross(right, forward)
    headroom = SKY_HEADROOM * (upper - lower).max() if name == "third_person" else 0.0
    top = upper + [0.0, headroom, 0.0]
    corners = np.array([[(lower, top)[b][a] for a, b in enumerate(k)] for k in np.ndindex(2, 2, 2)])
    if name in ("side", "top"):  # plans: nothing is larger for being nearer
        x, y, away = corners @ right, corners @ up, corners @ forward
        middle = 0.5 * (x.min() + x.max()) * right + 0.5 * (y.min() + y.max()) * up
        half = 0.5 * max((SIDE_BAND if name == "side" else FRAME_MARGIN) * np.ptp(y), FRAME_MARGIN * np.ptp(x) / aspect)
        return Camera(middle + (away.min() - 4.0 * np.linalg.norm(upper - lower)) * forward, forward, up, half)
    tangent = np.tan(np.radians(VIEW_ANGLE / 2)) / FRAME_MARGIN
    return Camera(eye_before(corners, (right, up, forward), (tangent * aspect, tangent)), forward, up, None)


def eye_before(
    corners: np.ndarray,
    axes: tuple[np.ndarray, np.ndarray, np.ndarray],
    tangents: tuple[float, float],
    aside: float = 0.0,
) -> np.ndarray:
    """Foremost position (3,) [m] from which an eye sees all `corners` (n, 3) [m]. `axes`: its right, up, forward;
    `tangents`: of half the angles of view; `aside`: tangent by which the view is shifted to the right."""
    right, up, forward = axes
    x, y, away = corners @ right, corners @ up, corners @ forward
    # Planes through the eye bound the picture: each corner limits how far forward the eye may stand.
    pairs = zip((x - aside * away, y), tangents, strict=True)
    bounds = [((c - t * away).max(), (c + t * away).min(), t) for c, t in pairs]
    ahead = min((high - low) / (2.0 * t) for low, high, t in bounds)
    eye_x, eye_y = (0.5 * (low + high) for low, high, _ in bounds)
    return (eye_x + aside * ahead) * right + eye_y * up + ahead * forward
