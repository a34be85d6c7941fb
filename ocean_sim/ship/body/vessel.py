"""Base of every kind of ship: its keys, its propeller and rudder with the crew that orders them, and its motion step by
step."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from math import radians, sqrt
from typing import ClassVar, Literal, get_args

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.basin.solids.shape import SolidShape
from ocean_sim.conventions import Diverged, Motions
from ocean_sim.fluid import Fluid, Limits
from ocean_sim.model import Faults, Name, Point, Vector2, Vector3, quantity
from ocean_sim.parts import SceneFacts, ShipConfig, called
from ocean_sim.ship import Load, Outline, Ship
from ocean_sim.ship.body import rigid_body, small_linalg
from ocean_sim.ship.body.rigid_body import RigidBody
from ocean_sim.ship.forces.moorings import Mooring, Moorings
from ocean_sim.ship.forces.propulsion import Crew, Helm, Helmsman, Person, Pilot, Propeller, Rudder, rate_limited
from ocean_sim.ship.hull.shapes import convex_corners, drawn_mesh
from ocean_sim.ship.naval.hydrostatics import Matter
from ocean_sim.ship.water.wall_contact import Sides
from ocean_sim.ship.water.wave_contact import WaveContact

SPEED_ROUNDING = 1e-9  # [m/s], [rad/s] of rounding
MAX_SPEED = 1.0e3  # [m/s] no ship moves like this
Free = Literal["sway", "heave", "surge", "pitch", "yaw", "roll"]  # Motions, in their order


class VesselConfig(Helm, ShipConfig):
    """Base config of every kind of ship: initial state, motions held fixed, named points, and orders of the crew."""

    slices: ClassVar[bool] = False  # whether it also floats in 2-D

    position: Point = quantity("m", (0.0, 0.0))
    """Position of the centre of mass: [x, z] afloat, or [x, y, z]."""
    heading_deg: float = quantity("deg", 0.0)
    """Heading: 0 is along +z, 90 along +x."""
    attitude_deg: Vector3 = quantity("deg", (0.0, 0.0, 0.0))
    """Pitch (bow down), a further yaw (to port) and roll (starboard down) at the beginning."""
    velocity: Vector3 = quantity("m/s", (0.0, 0.0, 0.0))
    """Velocity at the beginning, in world axes; in closed-form waves a floating hull has that of the water around
    it, too."""
    rates: Vector3 = quantity("rad/s", (0.0, 0.0, 0.0))
    """Pitch, yaw and roll rate at the beginning."""
    free: list[Free] = list(get_args(Free))
    """Motions that are not held; surge and sway along and across the heading."""
    points: dict[Name, Vector3] = {}
    """Named points, from the hull's origin [m]: x to port, y up from the keel, z to the bow from amidships."""

    def basin_problems(self, basin: Basin) -> Faults:
        """Yield faults of keys that contradict the basin: path below `ship`, and sentence."""
        if basin.dimension == 2 and not self.slices:
            yield ("kind",), "a ship needs a basin with a width; in a slice of particles take kind pressure"
        if basin.gravity[0] or basin.gravity[2] or not basin.gravity[1] < 0.0:
            yield ("kind",), f"a ship needs gravity straight down, here it is {list(basin.gravity)} m/s2"
        if basin.config.motion is not None:
            moved = "the motion of the tank is an acceleration of its water, which a ship does not feel"
            yield ("kind",), f"{moved}; leave basin.motion or the ship out"
        for axis, value in zip((0, 2), (self.position[0], 0.0 if basin.dimension == 2 else self.position[-1])):
            low, high = basin.lower[axis], basin.upper[axis]
            if not low <= value <= high:
                where = f"{'xyz'[axis]} = {value:g} m is outside the basin, which reaches from {low:g} to {high:g} m"
                yield ("position",), where

    def warnings(self, preflight: SceneFacts) -> Iterator[str]:
        yield from self.ignored_velocity_warnings()
        yield from self.late_orders(preflight.duration)

    def ignored_velocity_warnings(self) -> Iterator[str]:
        """Warn of initial velocities and rates in motions that are not free, which are ignored."""
        heading = rigid_body.axis_rotation(1, radians(self.heading_deg + self.attitude_deg[1]))
        motion = dict(zip(Motions._fields, [*(heading.T @ np.array(self.velocity)), *self.rates], strict=True))
        for key, names in (("velocity", Motions._fields[:3]), ("rates", Motions._fields[3:])):
            lost = [name for name in names if name not in self.free and abs(motion[name]) > SPEED_ROUNDING]
            if lost:
                them = " and ".join(lost)
                cure = f"so the ship does not begin with it; add {them} to `free`, or leave it out"
                yield f"{key}: {them} held, {cure}"

    @property
    def afloat_at_first(self) -> bool:
        """True if the ship begins at its floating height, not at a given one."""
        return len(self.position) == 2

    def body_at_start(self, matter: Matter, height: float, trim: np.ndarray) -> RigidBody:
        """Rigid body at the start, with mass and inertia of `matter`. `height` of the centre of mass [m] and `trim`, a
        quaternion, both of the ship afloat, are used where the config gives no height or attitude."""
        pitch, yaw, roll = (radians(angle) for angle in self.attitude_deg)
        turn = rigid_body.euler_quaternion(pitch, yaw + radians(self.heading_deg), roll)
        if not (pitch or roll):
            turn = rigid_body.quaternion_product(turn, trim)
        x, z = self.position[0], self.position[-1]
        y = height if self.afloat_at_first else self.position[1]
        body = RigidBody(matter.mass, matter.inertia, np.array([x, y, z]), turn, np.array(self.velocity), np.zeros(3))
        return rigid_body.with_spin(body, rigid_body.rotate_vector(turn, np.array(self.rates)))

    def settled_body(self, body: RigidBody, fluid: Fluid) -> RigidBody:
        """Copy of the initial body in settled water: if afloat, lowered with the surface, else at its given height."""
        x, y, z = body.position
        level = y - fluid.surface_drop if self.afloat_at_first else self.position[1]
        return replace(body, position=np.array([x, level, z]))


class Actuators:
    """Propeller and rudder of one ship, and the crew that gives them orders."""

    def __init__(self, config: Helm, propeller: Propeller | None, rudder: Rudder | None, centre: np.ndarray) -> None:
        """`config`: keys of the crew's orders or pilot; `centre`: centre of mass from the hull's origin [m]."""
        self.crew: Crew | Helmsman | Person = config.crew()
        self.propeller, self.rudder_blade, self.centre = propeller, rudder, centre
        pushing = np.zeros(3) if propeller is None or propeller.position is None else propeller.position - centre
        steering = np.zeros(3) if rudder is None else rudder.position - centre
        self.pushing, self.steering = pushing.tolist(), steering.tolist()  # from there [m]
        self.time, self.throttle, self.rudder = 0.0, 0.0, 0.0

    @property
    def rudder_limit(self) -> float:
        """Largest angle of the rudder to either side [rad]; a right angle without a rudder."""
        return self.rudder_blade.limit if self.rudder_blade else radians(90.0)

    def steer(self, body: RigidBody, dt: float, ahead: float = 0.0) -> None:
        """Move throttle and rudder, as fast as they can, for dt [s] (0: at once) towards the crew's orders for a time
        `ahead` [s] from now, the beginning of the step: 0, or dt for its end."""
        throttle, rudder = self.crew.order(self.time + ahead, body)
        blade, screw = self.rudder_blade, self.propeller
        self.throttle = rate_limited(self.throttle, throttle, screw.rate if screw and dt else None, dt, 1.0)
        self.rudder = rate_limited(self.rudder, rudder, blade.rate if blade and dt else None, dt, self.rudder_limit)
        self.time += dt

    def load(self, motion: np.ndarray, density: float, wet: float) -> dict[str, np.ndarray]:
        """Force [N], torque [N m] (2, 3) of propeller and rudder by name, body axes, at a velocity `motion` (6,) in
        water of a `density` [kg/m3]; `wet`: factor from 0 to 1 for a hull that is partly out of the water."""
        found, thrust = {}, 0.0
        velocity, rates = motion[:3].tolist(), motion[3:].tolist()
        if self.propeller is not None:
            thrust = self.propeller.thrust_at(self.throttle, velocity[2])
            found["propeller"] = force_at(self.pushing, (0.0, 0.0, wet * thrust))
        if self.rudder_blade is not None:
            across, _, ahead = small_linalg.plus(velocity, small_linalg.cross(rates, self.steering))
            if self.propeller is not None:
                stream = self.propeller.slipstream_speed(thrust, ahead, density)
                ahead = self.rudder_blade.mean_inflow(self.propeller, stream, ahead)
            force = self.rudder_blade.blade_force(self.rudder, across, ahead, density)
            found["rudder"] = force_at(self.steering, small_linalg.times(wet, force))
        return found


def force_at(arm: small_linalg.Vector, force: small_linalg.Three) -> np.ndarray:
    """(2, 3) force [N] that acts at `arm` from the centre of mass [m], and its torque [N m]."""
    return np.array((force, small_linalg.cross(arm, force)))


def placed_outline(corners: np.ndarray, body: RigidBody) -> Outline:
    """Outline, at the pose of a body, of a hull whose (m, 3) corners from the centre of mass [m] are in body axes."""
    from scipy.spatial import ConvexHull

    at = np.einsum("ij,kj->ik", corners, body.matrix) + body.position
    plan = at[:, [0, 2]]
    return Outline(plan[ConvexHull(plan).vertices], float(at[:, 1].min()), float(at[:, 1].max()))


class Vessel(Ship):
    """Base class of ships: rigid body, actuators, last load, named points, and time step. Kinds implement `load`."""

    left_out: ClassVar[tuple[str, ...]] = ("outline_corners",)  # of its shape, made again when asked for
    prompt: ClassVar[bool] = False  # whether a step ends with the orders of its end, not of its beginning

    def __init__(self, name: str, config: VesselConfig, body: RigidBody, actuators: Actuators, bed: float) -> None:
        """`name` in the scene; `body` at the start; `bed`: height y of a flat bed [m], the only bed she can touch."""
        self.name, self.bed, self.body, self.actuators, self.last = name, bed, body, actuators, Load.of({}, self.parts)
        self.shape: SolidShape | None = None  # what it looks like
        self.free = np.array([motion in config.free for motion in Motions._fields])
        self.points = {name: np.array(point) - actuators.centre for name, point in config.points.items()}
        self.sides: Sides | None = None  # walls and bed that stop it
        self.moorings: Moorings | None = None
        self.aground, self.groundings = False, 0
        self.airborne = False  # whether none of its hull was under water in the last load
        self.contact: WaveContact | None = None  # where the hull and particles push each other
        # A body, and what half a step has added to its velocity [m/s] and angular momentum [kg m2/s].
        self.gained = body, np.zeros(3), np.zeros(3)
        self.acceleration, self.turning = np.zeros(3), np.zeros(3)  # of the last step, world axes [m/s2], [rad/s2]
        self.added = np.zeros(6)  # mass [kg] and inertia [kg m2] of water that moves along
        actuators.steer(body, 0.0)

    def moor(self, lines: list[Mooring], points: Mapping[str, tuple[float, ...]]) -> None:
        """Moor the ship by lines and fenders at her named `points`; her load then has their force under `mooring`."""
        if lines:
            self.moorings = Moorings(lines, points, self.actuators.centre, self.body)
            self.add_part("mooring")

    def add_part(self, name: str) -> None:
        """Add `name`, such as `drift`, to the causes of force in the ship's load."""
        self.parts = (*self.parts, name)
        self.last = Load.of({}, self.parts)

    @property
    def orders(self) -> tuple[float, float]:
        return self.actuators.throttle, self.actuators.rudder

    def hand_over(self) -> Person:
        person = Person(*self.orders, self.actuators.rudder_limit)
        self.actuators.crew = person
        return person

    def sail(self, route: list[Vector2], speed: float) -> Helmsman:
        shape = self.drawn()
        length = None if shape is None else float(np.ptp(shape[0][:, 2]))
        pilot = Pilot(route=route, speed=speed, arrival=length).crew()
        pilot.time = self.actuators.time
        self.actuators.crew = pilot
        return pilot

    def drawn(self) -> tuple[np.ndarray, np.ndarray] | None:
        if self.shape is None:
            return None
        vertices, triangles = drawn_mesh(self.shape)
        return vertices - self.actuators.centre, triangles

    @cached_property
    def outline_corners(self) -> np.ndarray | None:
        """(n, 3) corners of the shape's convex hull, from the centre of mass, body axes [m]; None without a shape."""
        return None if self.shape is None else convex_corners(self.shape) - self.actuators.centre

    def outline(self) -> Outline | None:
        return None if self.outline_corners is None else placed_outline(self.outline_corners, self.body)

    @property
    def centred_body(self) -> RigidBody:
        """Copy of the body with velocities at the time of its position, not half a step before (leapfrog)."""
        body, (of, faster, more) = self.body, self.gained
        if of is not body:
            return body
        return replace(body, velocity=body.velocity + faster, angular_momentum=body.angular_momentum + more)

    def limits(self) -> Limits:
        return Limits()

    def free_step(self, body: RigidBody, load: Load, dt: float) -> RigidBody:
        """The body a step dt [s] later by the equation of motion of this kind of ship, with no held motion or wall."""
        force, torque = load.total
        return rigid_body.advance_body(body, force, torque, dt)

    def advance(self, load: Load, dt: float) -> None:
        """Take a step of dt [s]; raises Diverged if the ship exceeds MAX_SPEED or sinks below the bed."""
        before, sides = self.body, self.sides
        if sides is not None and not sides.may_touch(before, dt):
            sides = None

        def guided_step(load: Load) -> RigidBody:
            """The body at the end of the step under `load`, moved only in motions that the config calls `free`."""
            return rigid_body.guide_step(before, self.free_step(before, load, dt), self.free, dt)

        def walled_step(load: Load) -> RigidBody:
            """Body after the step under `load`, in `free` motions alone, shifted, not slowed, out of walls and bed."""
            return guided_step(load) if sides is None else sides.moved_inside(guided_step(load))

        touched = False
        if sides is not None:
            load = sides.with_impulses(load, guided_step, dt)
            touched = sides.bed
        self.groundings += touched and not self.aground
        self.aground = touched
        if self.contact is None:
            after = walled_step(load)
        else:
            load, after = self.contact.collide_step(load, walled_step, dt)
        velocity = after.velocity.tolist()
        speed = sqrt(small_linalg.dot(velocity, velocity))
        if not speed <= MAX_SPEED:
            x, y, z = before.position
            fast = f"{called(self.name)} at ({x:.4g}, {y:.4g}, {z:.4g}) m reached {speed:.4g} m/s"
            raise Diverged(f"{fast} (bound {MAX_SPEED:g} m/s); try a smaller time step")
        if after.position[1] < self.bed:
            x, _, z = after.position
            raise Diverged(f"{called(self.name)} has sunk to the bed, {-self.bed:g} m down, at ({x:.4g}, {z:.4g}) m")
        faster, more = after.velocity - before.velocity, after.angular_momentum - before.angular_momentum
        self.acceleration = faster / dt
        self.turning = (after.angular_velocity - before.angular_velocity) / dt
        self.body, self.last = after, load
        self.gained = after, 0.5 * faster, 0.5 * more
        self.actuators.steer(after, dt, dt if self.prompt else 0.0)
