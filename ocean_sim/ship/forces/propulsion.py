"""Propeller and rudder, and their orders: rows, a file, an autopilot, a pilot or a person (thesis 6.1, F_ship of 4.27).

A pilot holds a heading or sails a route at a speed: line of sight, and PID on rudder and throttle. Along a leg from one
waypoint to the next the pilot steers at a point of it that lies the look-ahead D before the ship: the heading is that
of the leg less atan((e + s) / D), with e the distance from the leg and s the integral that cancels a steady drift
(integral line of sight: Fossen 2021, Handbook of Marine Craft Hydrodynamics, 12.5; Borhaug et al. 2008, IEEE CDC). The
rudder is K (error + integral of it / T_i - T_d times the yaw rate), the throttle a PI of the speed ahead.
"""

from collections.abc import Iterator
from itertools import groupby, pairwise
from math import atan, atan2, cos, hypot, pi, radians, remainder, sin, sqrt
from typing import Annotated

import numpy as np
from pydantic import Field, field_validator

from ocean_sim.files import csv_file
from ocean_sim.files.input_file import Checked, FileName, Rule
from ocean_sim.model import Model, Vector2, Vector3, quantity
from ocean_sim.ship.body.rigid_body import RigidBody
from ocean_sim.ship.body.small_linalg import Three

ORDER_COLUMNS = ("throttle", "rudder_rad")
MAX_ORDERS = (1.0, pi / 2)  # to either side
ORDER_RULE = Rule("throttle lies between -1 and 1, rudder_rad between -pi/2 and pi/2 (radians)")
CHECKS = (Checked("Orders to a ship, `ship.controls.file`: a table over time", (ORDER_RULE,)),)
SLIPSTREAM_SHARE = 0.6  # of a slipstream's speed at the rudder (kappa of Yasukawa & Yoshimura 2015: 0.5 to 0.6)
LOOK_AHEAD_TIME = 6.0  # [s] of way: how far a pilot looks ahead
DRIFT_RATE = 0.2  # [m/s] twice the greatest rate of the integral of a steady drift
START_RADIUS = 1.0e-6  # [m] a first waypoint so near is where the ship begins: she goes on as she heads
SPEED_GAIN, SPEED_INTEGRAL_TIME = 0.4, 12.0  # [s/m] throttle over the error of the speed, [s] its integral time
MAX_INTEGRAL_RUDDER = 0.35  # [rad] by the integral of the heading's error


class Propeller(Model):
    """T = K (n |n| - |n| (1 - w) u / u0): throttle n, bollard pull K, wake w, speed u, and u0 where full throttle gives
    no thrust; alpha_0 n|n| + alpha_1 n V_a / D of Blanke (1981) in these terms."""

    thrust: float = quantity("N", gt=0.0)
    """Thrust at rest and full throttle ahead, less the thrust deduction."""
    astern: float = quantity("1", 0.5, gt=0.0, le=1.0)
    """Share of `thrust` that it gives astern."""
    zero_thrust_speed: float | None = quantity("m/s", None, gt=0.0)
    """Speed of the water through it at which full throttle gives no thrust; null: thrust does not fall with speed."""
    wake: float = quantity("1", 0.0, ge=0.0, lt=1.0)
    """Share of the ship's speed by which the water behind the hull follows it."""
    position: Vector3 | None = quantity("m", None)
    """Position, from the hull's origin; null: under the centre of mass at the height that does not trim the ship."""
    rate: float | None = quantity("1/s", None, gt=0.0)
    """Greatest rate of change of the throttle; null: it changes at once."""
    diameter: float | None = quantity("m", None, gt=0.0)
    """Diameter of a propeller ahead of the rudder, which then lies in its slipstream; null: the rudder feels no
    slipstream."""

    def thrust_at(self, throttle: float, speed: float) -> float:
        """Thrust [N] at a throttle (-1 to 1) and a speed of the ship ahead [m/s]."""
        slip = (1.0 - self.wake) * speed / self.zero_thrust_speed if self.zero_thrust_speed else 0.0
        bare = self.thrust * (throttle * abs(throttle) - abs(throttle) * slip)
        return bare if throttle >= 0.0 else self.astern * bare

    def slipstream_speed(self, thrust: float, speed: float, density: float) -> float:
        """Flow [m/s] at the rudder: the ship's `speed` ahead, and SLIPSTREAM_SHARE of the gain by an actuator disc
        that gives this `thrust` [N]."""
        if self.diameter is None or thrust <= 0.0 or speed < 0.0:
            return speed
        far = sqrt(speed**2 + 8.0 * thrust / (pi * density * self.diameter**2))
        return speed + SLIPSTREAM_SHARE * (far - speed)


class Rudder(Model):
    """Normal force N = 1/2 rho A U^2 6.13 L / (L + 2.25) sin(angle to the flow), L the aspect ratio (Fujii & Tuda 1961;
    Kose 1982): -N cos(rudder) across the ship, -N sin(rudder) along her."""

    area: float = quantity("m2", gt=0.0)
    """A: area of one side of the blade."""
    aspect_ratio: float = quantity("1", 1.5, gt=0.0)
    """Height over mean chord."""
    position: Vector3 = quantity("m")
    """Position, from the hull's origin."""
    limit: float = quantity("rad", radians(35.0), gt=0.0, le=pi / 2)
    """Largest angle."""
    rate: float | None = quantity("rad/s", radians(5.0), gt=0.0)
    """Greatest turning rate; null: it turns at once."""

    def mean_inflow(self, propeller: Propeller, stream: float, speed: float) -> float:
        """Root mean square speed [m/s] over the rudder: the `stream` over the propeller's diameter, the ship's speed
        beside it (Yasukawa & Yoshimura 2015, J. Mar. Sci. Technol. 20)."""
        if propeller.diameter is None or stream <= speed:
            return speed
        share = min(1.0, propeller.diameter / sqrt(self.area * self.aspect_ratio))
        return sqrt(share * stream**2 + (1.0 - share) * speed**2)

    def blade_force(self, angle: float, across: float, ahead: float, density: float) -> Three:
        """Force of the rudder [N], body axes, at an angle [rad] and speeds across and ahead through the water [m/s]."""
        speed = hypot(ahead, across)
        incidence = angle + atan2(across, abs(ahead)) if speed > 0.0 else 0.0
        slope = 6.13 * self.aspect_ratio / (self.aspect_ratio + 2.25)
        normal = 0.5 * density * self.area * speed**2 * slope * sin(incidence)
        normal *= 1.0 if ahead >= 0.0 else -1.0
        return -normal * cos(angle), 0.0, -normal * sin(angle)


class Row(Model):
    """Throttle and rudder ordered at one time; between such rows they change linearly."""

    time: float = quantity("s", ge=0.0)
    """Time at which these orders hold; before the first row and after the last, that row holds."""
    throttle: float = quantity("1", 0.0, ge=-1.0, le=1.0)
    """Throttle; 1 is full ahead."""
    rudder: float = quantity("rad", 0.0, ge=-pi / 2, le=pi / 2)
    """Positive turns to port."""


class Track(Model):
    """Throttle and rudder ordered over time, from a file."""

    file: FileName
    """A CSV file with columns time_s, throttle, rudder_rad."""

    @field_validator("file")
    @classmethod
    def _orders_in_range(cls, file: str) -> str:
        """Check that all orders in the file are within MAX_ORDERS; raises Unreadable."""
        _, *orders = csv_file.Table(file).series(*ORDER_COLUMNS)
        for name, values, most in zip(ORDER_COLUMNS, orders, MAX_ORDERS, strict=True):
            row = int(np.abs(values).argmax())
            if abs(values[row]) > most:
                raise ORDER_RULE.broken(file, f"{name} is {values[row]:g} in row {row + 1}")
        return file


class Course(Model):
    """A heading to hold, by proportional and differential steering."""

    heading_deg: float = quantity("deg")
    """Heading: 0 is along +z, 90 along +x."""
    throttle: float = quantity("1", 0.6, ge=-1.0, le=1.0)
    """Throttle; 1 is full ahead."""
    gain: float = quantity("1", 1.0, gt=0.0)
    """Rudder angle over the error of the heading."""
    rate_time: float = quantity("s", 2.0, ge=0.0)
    """Rudder angle over gain and the yaw rate."""


class Autopilot(Model):
    """An autopilot that holds a heading."""

    autopilot: Course


class Pilot(Model):
    """A pilot who sails a route or holds a heading, at a speed."""

    route: Annotated[list[Vector2], Field(min_length=1)] | None = quantity("m", None)
    """Waypoints [x, z] one after the other, from where the ship begins; after the last the ship goes on as on the last
    leg. A ship that begins at her only waypoint goes on as she heads."""
    heading_deg: float | None = quantity("deg", None)
    """A heading to hold, in place of a route: 0 heads along +z, 90 along +x."""
    speed: float = quantity("m/s", gt=0.0)
    """Speed ahead, over the ground."""
    look_ahead: float | None = quantity("m", None, gt=0.0)
    """Distance ahead on a leg of the point that the pilot steers at; null: six seconds of way."""
    arrival: float | None = quantity("m", None, gt=0.0)
    """Distance from a waypoint at which the next leg begins; null: the look-ahead."""
    gain: float = quantity("1", 1.5, gt=0.0)
    """Rudder angle over the error of the heading."""
    integral_time: float | None = quantity("s", 20.0, gt=0.0)
    """Time in which a steady error of the heading doubles the rudder angle; null: never."""
    rate_time: float = quantity("s", 2.0, ge=0.0)
    """Rudder angle over gain and the yaw rate."""

    def contradictions(self) -> Iterator[str]:
        if (self.route is None) == (self.heading_deg is None):
            yield "helm: give either a route or a heading_deg to hold"

    def crew(self) -> "Helmsman":
        """Helmsman that steers by these keys."""
        return Helmsman(self)


Controls = list[Row] | Track | Autopilot


class Helm(Model):
    """Keys of every steered ship: orders, or a pilot."""

    controls: Controls = []
    """Rows of time, throttle and rudder, `{file: ...}` or `{autopilot: {heading_deg: ...}}`."""
    helm: Pilot | None = None
    """A pilot, in place of `controls`: `{route: [[x, z], ...], speed: ...}`."""

    def contradictions(self) -> Iterator[str]:
        if self.helm is not None and self.controls != []:
            yield "helm: the ship has controls, too; leave one of them out"
        if isinstance(self.controls, list):
            times = [row.time for row in self.controls]
            if any(later <= earlier for earlier, later in pairwise(times)):
                yield "controls: the times of the rows must increase"

    def late_orders(self, duration: float) -> list[str]:
        """Warnings of orders that come after the end of a run of this duration [s]."""
        if self.helm is not None or isinstance(self.controls, Autopilot) or self.controls == []:
            return []
        times = Crew(self.controls).time
        return csv_file.unreached_times_warning("controls", times, duration, "only its {} row holds")

    def crew(self) -> "Crew | Helmsman":
        """Crew that gives the scene's orders, or the helmsman who steers by the key `helm`."""
        return Crew(self.controls) if self.helm is None else self.helm.crew()


class Crew:
    """Crew that gives a scene's orders: throttle and rudder [rad] as given over time, or the rudder by an autopilot."""

    def __init__(self, controls: Controls) -> None:
        self.course = controls.autopilot if isinstance(controls, Autopilot) else None
        self.time, self.throttle, self.rudder = np.zeros((3, 1))  # (n,) each [s], [rad]
        if isinstance(controls, Track):
            self.time, self.throttle, self.rudder = csv_file.Table(controls.file).series(*ORDER_COLUMNS)
        elif isinstance(controls, list) and controls:
            self.time, self.throttle, self.rudder = np.array([[r.time, r.throttle, r.rudder] for r in controls]).T

    def order(self, time: float, body: RigidBody) -> tuple[float, float]:
        """Throttle (-1 to 1) and rudder [rad] ordered at a time [s]: interpolated, or rudder by the autopilot."""
        if self.course is None:
            return float(np.interp(time, self.time, self.throttle)), float(np.interp(time, self.time, self.rudder))
        error = remainder(radians(self.course.heading_deg) - body.angles[1], 2.0 * pi)
        rudder = self.course.gain * (error - self.course.rate_time * float(body.angular_velocity[1]))
        return self.course.throttle, rudder


class Helmsman:
    """Pilot at the helm, and the state of steering: present leg, and integrals of drift, heading and speed errors."""

    start: tuple[float, float] | None

    def __init__(self, config: Pilot) -> None:
        self.config = config
        self.route = [place for place, _ in groupby(config.route or [])]  # a place twice in a row is no leg
        self.reach = config.look_ahead or LOOK_AHEAD_TIME * config.speed  # [m]
        self.near = config.arrival or self.reach  # [m]
        self.time = 0.0
        self.leg = 0  # number of the waypoint ahead
        self.start = None  # of the leg [m]
        self.drifted = 0.0  # what a steady drift has come to [m]
        self.bent, self.driven = 0.0, 0.0  # the integrals: of the heading's error [rad], and throttle

    def order(self, time: float, body: RigidBody) -> tuple[float, float]:
        """Throttle (-1 to 1) and rudder [rad] that the pilot orders at a time [s]."""
        config, dt = self.config, time - self.time
        self.time = time
        error = remainder(self.wanted_heading(body, dt) - float(body.angles[1]), 2.0 * pi)
        if config.integral_time is not None and abs(error) < MAX_INTEGRAL_RUDDER:
            bent = self.bent + dt * error / config.integral_time
            self.bent = min(max(bent, -MAX_INTEGRAL_RUDDER), MAX_INTEGRAL_RUDDER)
        rudder = config.gain * (error + self.bent - config.rate_time * float(body.angular_velocity[1]))
        missing = config.speed - float(body.velocity @ body.matrix[:, 2])
        wanted = SPEED_GAIN * missing + self.driven
        if abs(wanted) < 1.0:
            self.driven += dt * SPEED_GAIN * missing / SPEED_INTEGRAL_TIME
        return min(max(wanted, -1.0), 1.0), rudder

    def wanted_heading(self, body: RigidBody, dt: float) -> float:
        """Heading [rad] to steer: along the route by line of sight, or the one given; dt [s] since the last order."""
        if not self.route:
            return radians(self.config.heading_deg or 0.0)
        route, x, z = self.route, float(body.position[0]), float(body.position[2])
        if self.start is None:
            here = hypot(route[0][0] - x, route[0][1] - z) < START_RADIUS
            back, course = self.reach if here else 0.0, float(body.angles[1])
            self.start = (x - back * sin(course), z - back * cos(course))
        along, ahead, aside = self.leg_position(x, z)
        while ahead < self.near and self.leg < len(route) - 1:
            self.start, self.leg, self.drifted = route[self.leg], self.leg + 1, 0.0
            along, ahead, aside = self.leg_position(x, z)
        off = aside + self.drifted
        if abs(aside) < 0.25 * self.reach:  # not while the ship turns onto the leg
            self.drifted += dt * DRIFT_RATE * self.reach * aside / (self.reach**2 + off**2)
        return along - atan(off / self.reach)

    @property
    def ahead(self) -> list[Vector2]:
        """Waypoints x, z [m] that are not passed yet."""
        return self.route[self.leg :]

    def has_arrived(self, body: RigidBody) -> bool:
        """True if the last waypoint has been reached; the ship then goes on along the last leg."""
        if self.start is None or len(self.ahead) > 1:
            return False
        return self.leg_position(float(body.position[0]), float(body.position[2]))[1] < self.near

    def leg_position(self, x: float, z: float) -> tuple[float, float, float]:
        """Present leg seen from x, z [m]: heading [rad], distance along it to its end [m], offset to its port [m]."""
        assert self.start is not None
        (x_0, z_0), (x_1, z_1) = self.start, self.route[self.leg]
        along = atan2(x_1 - x_0, z_1 - z_0)
        ahead = (x_1 - x) * sin(along) + (z_1 - z) * cos(along)
        return along, ahead, (x - x_0) * cos(along) - (z - z_0) * sin(along)


class Person:
    """Person at the helm; an order given by `give` holds until the next."""

    def __init__(self, throttle: float, rudder: float, limit: float) -> None:
        """`throttle` and `rudder` [rad] until the first order; `limit`: largest rudder angle [rad]."""
        self.throttle, self.rudder, self.limit = throttle, rudder, limit

    def give(self, throttle: float, rudder: float) -> None:
        """Order a throttle, -1 to 1, and a rudder [rad]; values beyond the limits are clipped."""
        self.throttle = min(max(throttle, -1.0), 1.0)
        self.rudder = min(max(rudder, -self.limit), self.limit)

    def order(self, time: float, body: RigidBody) -> tuple[float, float]:
        """Throttle (-1 to 1) and rudder [rad] of the last order, at any time."""
        return self.throttle, self.rudder


def rate_limited(now: float, wanted: float, rate: float | None, dt: float, limit: float) -> float:
    """Position of an actuator dt [s] after `now`: moved to `wanted` by at most `rate` a second, within +-`limit`."""
    wanted = min(max(wanted, -limit), limit)
    return wanted if rate is None else now + min(max(wanted - now, -rate * dt), rate * dt)
