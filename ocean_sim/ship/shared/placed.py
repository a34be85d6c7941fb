"""Where a ship begins, what may move, who steers: keys of every kind of ship, and the state that they become."""

from math import radians, sqrt
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import Field

from ocean_sim.basin import Basin
from ocean_sim.conventions import Diverged, Motions
from ocean_sim.model import Vector3, quantity
from ocean_sim.parts import Problems, ShipConfig
from ocean_sim.ship import Load, loaded
from ocean_sim.ship.shared.hydrostatics import Matter
from ocean_sim.ship.shared.propulsion import Crew, Helm, Person, Propeller, Rudder, towards
from ocean_sim.ship.shared.rigid_body import RigidBody, cross, guided, oriented, product, rotated, spinning

FASTEST = 1.0e3  # [m/s] no ship moves like this
Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")]
Motion = Annotated[str, Field(pattern=f"^({'|'.join(Motions._fields)})$")]
Place = Annotated[tuple[float, ...], Field(strict=False, min_length=2, max_length=3)]


class Placed(Helm, ShipConfig):
    """Keys of every kind of ship."""

    slices: ClassVar[bool] = False  # whether it also floats in a slice

    position: Place = quantity("m", (0.0, 0.0))
    """Of the centre of mass: [x, z] afloat, or [x, y, z]."""
    heading_deg: float = quantity("deg", 0.0)
    """0 heads along +z, 90 along +x."""
    attitude_deg: Vector3 = quantity("deg", (0.0, 0.0, 0.0))
    """Pitch (bow down), a further yaw (to port) and roll (starboard down) at the beginning."""
    velocity: Vector3 = quantity("m/s", (0.0, 0.0, 0.0))
    """At the beginning, world axes."""
    rates: Vector3 = quantity("rad/s", (0.0, 0.0, 0.0))
    """Pitch, yaw and roll rate at the beginning."""
    free: list[Motion] = list(Motions._fields)
    """Motions that are not held; surge and sway along and across the heading."""
    points: dict[Name, Vector3] = {}
    """Named places, from the hull's origin [m]: x to port, y up from the keel, z to the bow from amidships."""

    def misplaced(self, basin: Basin) -> Problems:
        """What contradicts the basin: (path below `ship`, sentence)."""
        found: Problems = []
        if basin.dimension == 2 and not self.slices:
            found.append((("kind",), "a ship needs a basin with a width"))
        if basin.gravity[0] or basin.gravity[2] or not basin.gravity[1] < 0.0:
            found.append((("kind",), f"a ship needs gravity straight down, here it is {list(basin.gravity)} m/s2"))
        for axis, value in zip((0, 2), (self.position[0], 0.0 if basin.dimension == 2 else self.position[-1])):
            low, high = basin.lower[axis], basin.upper[axis]
            if not low <= value <= high:
                where = f"{'xyz'[axis]} = {value:g} m is outside the basin, which reaches from {low:g} to {high:g} m"
                found.append((("position",), where))
        return found

    @property
    def afloat_at_first(self) -> bool:
        """Whether it begins at the height at which it floats, not at one that is given."""
        return len(self.position) == 2

    def body(self, matter: Matter, height: float, trim: np.ndarray) -> RigidBody:
        """The body at the beginning; `height` of the centre of mass afloat [m], `trim` (4,) quaternion afloat."""
        pitch, yaw, roll = (radians(angle) for angle in self.attitude_deg)
        turn = oriented(pitch, yaw + radians(self.heading_deg), roll)
        if not (pitch or roll):
            turn = product(turn, trim)
        x, z = self.position[0], self.position[-1]
        y = height if self.afloat_at_first else self.position[1]
        body = RigidBody(matter.mass, matter.inertia, np.array([x, y, z]), turn, np.array(self.velocity), np.zeros(3))
        return spinning(body, rotated(turn, np.array(self.rates)))


class Machine:
    """Propeller and rudder of one ship, and what they do."""

    def __init__(self, config: Helm, propeller: Propeller | None, rudder: Rudder | None, centre: np.ndarray) -> None:
        """`centre`: the centre of mass from the hull's origin [m]."""
        self.crew: Crew | Person = config.crew()
        self.propeller, self.rudder_blade, self.centre = propeller, rudder, centre
        self.pushing = np.zeros(3) if propeller is None or propeller.position is None else propeller.position - centre
        self.steering = np.zeros(3) if rudder is None else rudder.position - centre  # places from there [m]
        self.time, self.throttle, self.rudder = 0.0, 0.0, 0.0

    @property
    def limit(self) -> float:
        """The largest angle of the rudder [rad]."""
        return self.rudder_blade.limit if self.rudder_blade else radians(90.0)

    def steer(self, body: RigidBody, dt: float) -> None:
        """What the crew orders, as fast as the machines follow; dt 0 is the first time."""
        throttle, rudder = self.crew.order(self.time, body)
        blade, screw = self.rudder_blade, self.propeller
        self.throttle = towards(self.throttle, throttle, screw.rate if screw and dt else None, dt, 1.0)
        self.rudder = towards(self.rudder, rudder, blade.rate if blade and dt else None, dt, self.limit)
        self.time += dt

    def load(self, motion: np.ndarray, density: float, wet: float) -> dict[str, np.ndarray]:
        """(2, 3) of propeller and rudder in body axes, at a velocity relative to the water (6,), `wet` from 0 to 1."""
        found = {}
        if self.propeller is not None:
            force = np.array([0.0, 0.0, wet * self.propeller.force(self.throttle, float(motion[2]))])
            found["propeller"] = np.array([force, cross(self.pushing, force)])
        if self.rudder_blade is not None:
            arm = self.steering
            force = wet * self.rudder_blade.load(self.rudder, motion[:3] + cross(motion[3:], arm), density)
            found["rudder"] = np.array([force, cross(arm, force)])
        return found


class Voyage:
    """A body on its way: its pose, its machine, what acted last, and what is named on it."""

    def __init__(self, config: Placed, body: RigidBody, machine: Machine, bed: float) -> None:
        """`bed`: its height [m]; what lies on it is not modelled."""
        self.bed, self.body, self.machine, self.last = bed, body, machine, loaded()
        self.hull = getattr(config, "whole_hull", None)  # what it looks like
        self.free = np.array([motion in config.free for motion in Motions._fields])
        self.points = {name: np.array(place) - machine.centre for name, place in config.points.items()}
        self.sides: Any = None  # walls and bed that stop it
        self.contact: Any = None  # where the hull and particles push each other
        self.acceleration, self.turning = np.zeros(3), np.zeros(3)  # of the last step, world axes [m/s2], [rad/s2]
        machine.steer(body, 0.0)

    @property
    def orders(self) -> tuple[float, float]:
        """Throttle and rudder [rad] as they stand."""
        return self.machine.throttle, self.machine.rudder

    def hand_over(self) -> Person:
        """From now on a person gives the orders, beginning with those that stand; the machines follow as fast as they
        do for any crew."""
        person = Person(*self.orders, self.machine.limit)
        self.machine.crew = person
        return person

    def drawn(self) -> tuple[np.ndarray, np.ndarray] | None:
        """Vertices from the centre of mass, body axes (n, 3) [m], and triangles (m, 3); None where only a law of motion
        is known."""
        if self.hull is None:
            return None
        from ocean_sim.ship.shared.drawn import drawn

        vertices, triangles = drawn(self.hull.shape)
        return vertices - self.machine.centre, triangles

    def moved(self, step: Any, load: Load, dt: float) -> None:
        """Take a step of a law of motion; raises Diverged where the ship has left the physical world."""
        before = self.body

        beside = self.sides is not None and self.sides.near(before, dt)

        def free(load: Load) -> RigidBody:
            return guided(before, step(before, load.force, load.torque, dt), self.free, dt)

        def under(load: Load) -> RigidBody:
            return self.sides.off(free(load)) if beside else free(load)

        if beside:
            load = self.sides.met(load, free, dt)
        if self.contact is None:
            after = under(load)
        else:
            load, after = self.contact.met(load, under, dt)
        speed = sqrt(float(after.velocity @ after.velocity))
        if not speed <= FASTEST:
            x, y, z = before.position
            raise Diverged(
                f"the ship at ({x:.4g}, {y:.4g}, {z:.4g}) m reached {speed:.4g} m/s (bound {FASTEST:g} m/s); "
                "try a smaller time step"
            )
        if after.position[1] < self.bed:
            x, _, z = after.position
            raise Diverged(f"the ship has sunk to the bed, {-self.bed:g} m down, at ({x:.4g}, {z:.4g}) m")
        self.acceleration = (after.velocity - before.velocity) / dt
        self.turning = (after.angular_velocity - before.angular_velocity) / dt
        self.body, self.last = after, load
        self.machine.steer(after, dt)
