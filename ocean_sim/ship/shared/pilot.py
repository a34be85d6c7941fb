"""A pilot who holds a heading or sails a route at a speed: line of sight, and PID on rudder and throttle.

Along a leg from one waypoint to the next the pilot steers at a point of it that lies the look-ahead D before the ship:
the heading is that of the leg less atan((e + s) / D), with e the distance from the leg and s what a steady drift has
come to (integral line of sight: Fossen 2021, Handbook of Marine Craft Hydrodynamics, 12.5; Borhaug et al. 2008, IEEE
CDC). The rudder is K (error + integral of it / T_i - T_d times the yaw rate), the throttle a PI of the speed ahead.
"""

from itertools import groupby
from math import atan, atan2, cos, hypot, pi, radians, remainder, sin
from typing import Annotated, Self

from pydantic import Field, model_validator

from ocean_sim.model import Model, Vector2, quantity
from ocean_sim.ship.shared.rigid_body import RigidBody

AHEAD = 6.0  # [s] of way: how far a pilot looks ahead
DRIFT = 0.2  # [m/s] twice the rate at which what a steady drift has come to grows, at most
HERE = 1.0e-6  # [m] a first waypoint so near is where the ship begins: she goes on as she heads
PULL, SLOW = 0.4, 12.0  # [s/m] throttle over the error of the speed, [s] its integral time
BENT = 0.35  # [rad] the most that the integral of the heading's error may steer


class Pilot(Model):
    """A pilot who steers the ship."""

    route: Annotated[list[Vector2], Field(min_length=1)] | None = quantity("m", None)
    """Waypoints [x, z] one after the other, from where the ship begins; after the last the ship goes on as on the last
    leg. A ship that begins at her only waypoint goes on as she heads."""
    heading_deg: float | None = quantity("deg", None)
    """A heading to hold, in place of a route: 0 heads along +z, 90 along +x."""
    speed: float = quantity("m/s", gt=0.0)
    """Speed ahead, over the ground."""
    look_ahead: float | None = quantity("m", None, gt=0.0)
    """How far ahead on a leg the pilot steers; null: six seconds of way."""
    arrival: float | None = quantity("m", None, gt=0.0)
    """How near to a waypoint the next leg begins; null: as far as the look-ahead."""
    gain: float = quantity("1", 1.5, gt=0.0)
    """Rudder angle over the error of the heading."""
    integral_time: float | None = quantity("s", 20.0, gt=0.0)
    """Time in which a steady error of the heading doubles the rudder angle; null: never."""
    rate_time: float = quantity("s", 2.0, ge=0.0)
    """Rudder angle over gain and the yaw rate."""

    @model_validator(mode="after")
    def _somewhere(self) -> Self:
        if (self.route is None) == (self.heading_deg is None):
            raise ValueError("helm: give either a route or a heading_deg to hold")
        return self

    def crew(self) -> "Helmsman":
        return Helmsman(self)


class Helmsman:
    """The pilot at work."""

    start: tuple[float, float] | None

    def __init__(self, config: Pilot) -> None:
        self.config = config
        self.route = [place for place, _ in groupby(config.route or [])]  # a place twice in a row is no leg
        self.reach = config.look_ahead or AHEAD * config.speed  # [m]
        self.near = config.arrival or self.reach  # [m]
        self.time = 0.0
        self.leg = 0  # number of the waypoint ahead
        self.start = None  # of the leg [m]
        self.drifted = 0.0  # what a steady drift has come to [m]
        self.bent, self.driven = 0.0, 0.0  # the integrals: of the heading's error [rad], and throttle

    def order(self, time: float, body: RigidBody) -> tuple[float, float]:
        """Throttle and rudder [rad] that are asked for."""
        config, dt = self.config, time - self.time
        self.time = time
        error = remainder(self.heading(body, dt) - float(body.angles[1]), 2.0 * pi)
        if config.integral_time is not None and abs(error) < BENT:
            self.bent = min(max(self.bent + dt * error / config.integral_time, -BENT), BENT)
        rudder = config.gain * (error + self.bent - config.rate_time * float(body.angular_velocity[1]))
        missing = config.speed - float(body.velocity @ body.matrix[:, 2])
        wanted = PULL * missing + self.driven
        if abs(wanted) < 1.0:
            self.driven += dt * PULL * missing / SLOW
        return min(max(wanted, -1.0), 1.0), rudder

    def heading(self, body: RigidBody, dt: float) -> float:
        """Where to head [rad]."""
        if not self.route:
            return radians(self.config.heading_deg or 0.0)
        route, x, z = self.route, float(body.position[0]), float(body.position[2])
        if self.start is None:
            here = hypot(route[0][0] - x, route[0][1] - z) < HERE
            back, course = self.reach if here else 0.0, float(body.angles[1])
            self.start = (x - back * sin(course), z - back * cos(course))
        along, ahead, aside = self.place(x, z)
        while ahead < self.near and self.leg < len(route) - 1:
            self.start, self.leg, self.drifted = route[self.leg], self.leg + 1, 0.0
            along, ahead, aside = self.place(x, z)
        off = aside + self.drifted
        if abs(aside) < 0.25 * self.reach:  # not while the ship turns onto the leg
            self.drifted += dt * DRIFT * self.reach * aside / (self.reach**2 + off**2)
        return along - atan(off / self.reach)

    @property
    def ahead(self) -> list[Vector2]:
        """The waypoints that are not passed yet."""
        return self.route[self.leg :]

    def arrived(self, body: RigidBody) -> bool:
        """Whether the last waypoint is reached; from there the ship goes on as on the last leg."""
        if self.start is None or len(self.ahead) > 1:
            return False
        return self.place(float(body.position[0]), float(body.position[2]))[1] < self.near

    def place(self, x: float, z: float) -> tuple[float, float, float]:
        """Heading of the leg [rad], how far ahead its end is, and how far to port of it the ship is [m]."""
        assert self.start is not None
        (x_0, z_0), (x_1, z_1) = self.start, self.route[self.leg]
        along = atan2(x_1 - x_0, z_1 - z_0)
        ahead = (x_1 - x) * sin(along) + (z_1 - z) * cos(along)
        return along, ahead, (x - x_0) * cos(along) - (z - z_0) * sin(along)
