"""A ship that floats by its volume: its cubes in the water of a scene, and the sum of its forces (4.27).

A kind adds a force by naming it in `parts` and extending `forces`.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import isinf, pi, sqrt
from typing import ClassVar, NamedTuple

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.basin.solids.voxels import Distance
from ocean_sim.conventions import Diverged
from ocean_sim.fluid import Contact, Fluid, Limits
from ocean_sim.parts import called
from ocean_sim.ship import Load
from ocean_sim.ship.body import small_linalg
from ocean_sim.ship.body.floating import FloatingConfig, afloat_pose
from ocean_sim.ship.body.rigid_body import RigidBody, euler_quaternion, quaternion_product, to_world
from ocean_sim.ship.body.vessel import Actuators, Vessel
from ocean_sim.ship.forces.added_mass import Slamming
from ocean_sim.ship.hull.cubes import Cubes, Wetted
from ocean_sim.ship.water.wall_contact import Sides
from ocean_sim.ship.water.water_samples import SurroundingSea, SurroundingWater
from ocean_sim.ship.water.wave_contact import WaveContact
from ocean_sim.surface import Surface
from ocean_sim.wind import Wind

STEPS_A_PERIOD = 50  # of the fastest natural motion
FORCE_NUMBER = 0.25  # share of a limit that the time step `courant` takes


class Immersion(NamedTuple):
    """State of a hull in the water at one time: loads of water and wind, relative velocity, and pose."""

    wet: Wetted
    share: float  # of added mass, damping and thrust that is left, 0 to 1
    motion: np.ndarray  # (6,) velocity relative to the water, body axes [m/s], [rad/s]
    surface: Surface | Fluid
    body: RigidBody
    axes: RigidBody  # along which damping acts and where waves arrive: `body`, or with drift that of `level_body`


def linear_across(wet: Wetted, flat: Wetted, turn: np.ndarray) -> Wetted:
    """Sums `wet` of a hull whose horizontal wave force and whose water's motion are those of the hull at rest, `flat`:
    linear in the waves, so that their mean force is not counted twice. `turn`: (3, 3) from the axes of `flat`."""
    wave = wet.wave.copy()
    wave[0, [0, 2]], wave[1, 1] = flat.wave[0, [0, 2]], flat.wave[1, 1]
    velocity, acceleration = ((moved.reshape(2, 3) @ turn.T).ravel() for moved in (flat.velocity, flat.acceleration))
    return wet._replace(wave=wave, velocity=velocity, acceleration=acceleration)


class FloatingShip(Vessel):
    """Base of ships whose hull is cubes in the water, with all forces but damping, which derived kinds add."""

    samples_depth: ClassVar[bool] = False  # True if it asks the water under its surface, which a closed form answers
    slamming: Slamming | None = None  # of a hull that falls into the water; particles push one themselves

    def __init__(self, name: str, config: FloatingConfig, basin: Basin, fluid: Fluid) -> None:
        particles = fluid.of_particles
        self.hydrostatics = still = config.in_still_water(-basin.gravity[1], fluid.rest_density)
        self.cubes = Cubes(still)
        shape, matter = config.whole_hull.shape, still.matter
        width, height, length = np.subtract(*shape.bounds()[::-1])
        contact = sides = None
        if config.contact is not None and particles is not None:
            contact = WaveContact(config.contact, shape, matter.centre, basin, particles, still.gravity)
            sides = Sides(shape, matter.centre, basin, particles.walls.gap + contact.margin)
        if particles is None:
            # Waves pass walls, and so do ships.
            sides = Sides(shape, matter.centre, basin, axes=(1,))
        self.water: SurroundingWater | SurroundingSea
        closed = fluid.in_closed_form
        if self.samples_depth and closed is not None:
            draught = height if isinf(still.draught) else still.draught
            self.water = SurroundingSea(length, width, height, draught, still.gravity, closed)
        else:
            hollow: tuple[Distance | None, float, Sequence[Contact]] = (None, 0.0, ())
            if contact is not None and particles is not None:
                hollow = (contact.hull.distance, contact.rim, particles.contacts)
            self.water = SurroundingWater(length, width, height, *hollow)
        body = config.settled_body(config.resting_body(still), fluid)
        if particles is None:  # it has the mean velocity of the water around it, too
            turn = body.matrix
            wet = still.wet_volumes(turn[1], -float(body.position[1] - turn[1] @ matter.centre))
            moved = fluid.velocities((still.voxels.centre - matter.centre) @ turn.T + body.position)
            flow = (wet[:, None] * moved).sum(axis=0) / max(float(wet.sum()), 1e-9)
            body = replace(body, velocity=body.velocity + flow)
        self.first_body = body  # at the beginning
        if contact is not None and particles is not None:
            contact.hull.water = self.water
            contact.begin(body)
            particles.add_contact(contact)
        actuators = Actuators(config, config.propeller, config.rudder, matter.centre)
        super().__init__(name, config, body, actuators, basin.lower[1])
        self.shape, self.contact, self.sides = shape, contact, sides
        self.moor(config.moorings, config.points)
        self.rest, self.drift = afloat_pose(still), None if closed is None else config.drift_force(still, closed, body)
        if self.drift is not None and closed is not None:
            self.slow_water = SurroundingSea(length, width, height, still.draught, still.gravity, closed)
            self.add_part("drift")
        self.usual_volume = min(still.needed_volume, still.voxels.volume)  # under water [m3]
        self.weight = np.array([[0.0, -matter.mass * still.gravity, 0.0], [0.0, 0.0, 0.0]])
        self.motion_limits = self.limits_of_motion(self.added)
        # Of the last load: velocity relative to the water, volume under water [m3], and for slamming its speed upwards
        # relative to the water [m/s], and what a force upwards at its centre of buoyancy is as a load, (2, 3).
        self.relative, self.wet, self.rising, self.upwards = np.zeros(6), 0.0, 0.0, np.zeros((2, 3))

    def load(self, wind: Wind, fluid: Fluid, surface: Surface | Fluid) -> Load:
        body = self.centred_body if self.water.samples_depth else self.body
        wet, axes = self.cubes.sum_forces(body, self.water, surface, wind), body
        if self.drift is not None:
            axes = self.level_body(body, *self.drift.slow[:2])
            flat = self.cubes.sum_forces(axes, self.slow_water, surface, wind)
            wet = linear_across(wet, flat, body.matrix.T @ axes.matrix)
        # Added mass, damping and thrust are whole until half the usual volume is out of the water.
        share = min(1.0, 2.0 * wet.volume / self.usual_volume)
        motion = np.array([*body.own_velocity, *body.own_spin]) - wet.velocity
        now = Immersion(wet, share, motion, surface, body, axes)
        self.relative, self.wet = motion, wet.volume
        self.airborne = not wet.volume > 0.0
        if self.slamming is not None:
            self.rising = small_linalg.dot(body.rows[1], motion[:3].tolist())
            self.upwards = wet.buoyancy / max(float(wet.buoyancy[0, 1]), 1e-9)
        return Load.of(self.answered(now, self.forces(now)), self.parts)

    def level_body(self, body: RigidBody, place: np.ndarray, velocity: np.ndarray) -> RigidBody:
        """The body as it floats at rest at a place [m], with a velocity [m/s] and the same heading."""
        height, trim = self.rest
        turn = quaternion_product(euler_quaternion(0.0, body.angles[1], 0.0), trim)
        return replace(body, position=np.array([place[0], height, place[2]]), velocity=velocity, orientation=turn)

    def forces(self, now: Immersion) -> dict[str, np.ndarray]:
        """(2, 3) force [N], torque [N m] of each part, world axes, without the reaction of added mass."""
        wet, density, damping = now.wet, self.hydrostatics.density, self.damping(now)
        if self.slamming is not None:
            damping = damping + self.slamming.heave_drag(self.wet, self.rising) * self.upwards
        driven = self.actuators.load(now.motion, density, now.share)
        return {
            "gravity": self.weight,
            "buoyancy": wet.buoyancy,
            "wave": wet.wave,
            "wind_drag": wet.wind_drag,
            "wind_lift": wet.wind_lift,
            "damping": damping,
            **({"mooring": self.moorings.load(now.body)} if self.moorings is not None else {}),
            **({"drift": now.share * self.drift.load(now.axes)} if self.drift is not None else {}),
            **{part: to_world(force, now.body) for part, force in driven.items()},
        }

    def damping(self, now: Immersion) -> np.ndarray:
        """(2, 3) damping force [N] and torque [N m], world axes; zero unless a kind overrides it."""
        return np.zeros((2, 3))

    def answered(self, now: Immersion, forces: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        """The `forces` by part, and the reaction of added mass to them; unchanged in kinds without added mass."""
        return forces

    def advance(self, load: Load, dt: float) -> None:
        """Take a step of dt [s] with slamming; raises Diverged if a ship heavier than her volume reaches the bed."""
        if self.slamming is not None:
            push = self.slamming.push(self.wet, self.rising, dt)
            if push > 0.0:
                load = load.plus("damping", push * self.upwards)
        super().advance(load, dt)
        if self.drift is not None:
            self.drift.follow(self.body, dt)
        if self.aground and self.contact is None and isinf(self.hydrostatics.draught):
            x, _, z = self.body.position
            raise Diverged(f"{called(self.name)} has sunk to the bed, {-self.bed:g} m down, at ({x:.4g}, {z:.4g}) m")

    def displaced(self) -> tuple[np.ndarray, np.ndarray]:
        return self.cubes.displaced_water(self.body, self.water)

    def limits_of_motion(self, added: np.ndarray) -> Limits:
        """Limit of the time step: STEPS_A_PERIOD steps in the shortest natural period, with (6,) added mass."""
        still = self.hydrostatics
        periods = [] if isinf(still.draught) else [period for period in still.periods(added).values() if period]
        if self.moorings is not None:
            periods.append(2.0 * pi * sqrt(still.matter.mass / float(self.moorings.stiffness.sum())))
        return Limits(force=min(periods) / STEPS_A_PERIOD / FORCE_NUMBER) if periods else Limits()

    def limits(self) -> Limits:
        return self.motion_limits
