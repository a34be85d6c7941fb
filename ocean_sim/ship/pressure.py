"""A ship that floats by the pressure of the particles and nothing else: no law gives the height of the water.

The hull is sampled as any solid body in the water; the water's laws push it as strongly as it pushes them. The water
near an accelerated body reacts at once, with an added mass that can exceed the body's own. With the body's acceleration
of the step before, an explicit step would overshoot. So the water is given an acceleration that follows by the body's
share of both masses, the value at which both agree (under-relaxation as in Kuttler & Wall 2008, Comput. Mech. 43).
"""

from collections.abc import Iterator
from math import isinf
from typing import ClassVar, Literal

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.fluid import Fluid, with_particles
from ocean_sim.parts import LedgerRow, SceneFacts
from ocean_sim.ship import Load, Ship
from ocean_sim.ship.body.floating import FloatingConfig, afloat_pose
from ocean_sim.ship.body.rigid_body import hold_motions, to_world
from ocean_sim.ship.body.vessel import Actuators, Vessel
from ocean_sim.ship.forces.added_mass import by_rule
from ocean_sim.ship.naval.hydrostatics import Hydrostatics, Matter
from ocean_sim.ship.water.solid import Solid
from ocean_sim.surface import Surface
from ocean_sim.wind import Wind

SLICE_MOTIONS = np.array([True, True, False, False, False, True])  # sway, heave and roll
MIN_SPACINGS = 2.0  # spacings across a hull
REST_SWING = 0.13  # [spacings] of heave in still water at most, measured with boxes in delta_sph at draughts from 2 on
STATED_SWING = 0.02  # of the draught, from which on it is said


class Config(FloatingConfig):
    """Ship under her weight, the water's pressure, propeller and rudder; in 2-D a metre of the section amidships."""

    needs_surface: ClassVar[bool] = False
    slices: ClassVar[bool] = True
    carried_as_body: ClassVar[bool] = True
    fineness: ClassVar[int] = 3
    feels_wind: ClassVar[bool] = False
    kind: Literal["pressure"] = "pressure"
    contact: None = None
    """The laws of the water itself act between particles and this hull."""
    drift: None = None
    """The waves that particles carry drift this hull themselves."""

    def solid(self, preflight: SceneFacts) -> Solid:
        still, flat = self.hydrostatics_of(preflight), preflight.tank.dimension == 2
        matter = still.matter
        if flat:  # a metre of the hull
            share = 1.0 / float(np.ptp(self.whole_hull.shape.bounds(), axis=0)[2])
            matter = Matter(share * matter.mass, matter.centre, share * matter.inertia)
        body = self.above_unsettled_water(self.body_at_start(matter, *afloat_pose(still)), preflight)
        return Solid(self.whole_hull.shape, still.matter.centre, body.position, body.matrix, flat, body=body)

    def added_mass_diagonal(self, still: Hydrostatics) -> np.ndarray:
        """(6,) added mass [kg], [kg m2] by hull sections, for natural periods alone; in a run the particles react."""
        return by_rule(still)

    def warnings(self, preflight: SceneFacts) -> Iterator[str]:
        yield from super().warnings(preflight)
        spacing = preflight.spacing
        if not preflight.wind.still:
            yield "a ship of kind pressure feels only the water; wind does not act on it"
        lower, upper = self.whole_hull.shape.bounds()
        if spacing is not None and (upper - lower).min() < MIN_SPACINGS * spacing:
            thin = (upper - lower).min() / spacing
            yield f"the hull is {thin:.2g} spacings thin: water on either side acts on that on the other"

    def statements(self, preflight: SceneFacts) -> list[str]:
        """Sentence for the user on the ship's heave while particles leave their lattice; empty if that is little."""
        draught, spacing = self.hydrostatics_of(preflight).draught, preflight.spacing
        if spacing is None or isinf(draught) or REST_SWING * spacing < STATED_SWING * draught:
            return []
        swing = REST_SWING * spacing / draught
        return [
            f"the hull draws {draught / spacing:.2g} spacings: in still water she heaves by up to about {swing:.2g} of "
            "her draught within her first periods, as rows of particles along her sides settle"
        ]

    def ledger(self, preflight: SceneFacts) -> tuple[LedgerRow, ...]:
        """No rows of the memory estimate: the hull's boundary particles are in the fluid's row."""
        return ()

    def build(self, name: str, basin: Basin, fluid: Fluid) -> Ship:
        return Pressure(name, self, basin, fluid)


class Pressure(Vessel):
    """A ship moved by the pressure of particles on her hull, which is one of the fluid's solid boundary bodies."""

    def __init__(self, name: str, config: Config, basin: Basin, fluid: Fluid) -> None:
        solid, water = basin.afloat[name], with_particles(fluid)
        assert isinstance(solid, Solid) and water.boundary is not None
        felt = [ship for ship, other in basin.afloat.items() if other.is_sampled]
        self.boundary, self.number = water.boundary, water.boundary.given + felt.index(name)
        actuators = Actuators(config, config.propeller, config.rudder, solid.centre)
        super().__init__(name, config, config.settled_body(solid.body, fluid), actuators, basin.lower[1])
        self.shape = solid.shape
        self.moor(config.moorings, config.points)
        if solid.flat:
            self.free &= SLICE_MOTIONS
        self.density = float(water.particles.rest_density)
        self.weight = np.array([[0.0, self.body.mass * basin.gravity[1], 0.0], [0.0, 0.0, 0.0]])
        near = self.density * float(self.boundary.bodies[self.number].volume.sum())  # [kg] of water near it, at most
        self.share = self.body.mass / (self.body.mass + near)
        self.known = np.zeros((2, 3))  # acceleration and turning that the water knows [m/s2], [rad/s2]
        self.place_hull()

    def load(self, wind: Wind, fluid: Fluid, surface: Surface | Fluid) -> Load:
        """Compute all forces and torques on the ship (thesis 4.27). All that particles do, friction too, is `buoyancy`;
        `wind` and `surface` are not used."""
        forces, torques = self.boundary.forces()
        body = self.body
        motion = np.array([*body.own_velocity, *body.own_spin])
        driven = self.actuators.load(motion, self.density, 1.0)
        pressed = np.stack([forces[self.number], torques[self.number]])
        forces_of = {"gravity": self.weight, "buoyancy": pressed}
        if self.moorings is not None:
            forces_of["mooring"] = self.moorings.load(body)
        return Load.of(forces_of | {part: to_world(force, body) for part, force in driven.items()}, self.parts)

    def advance(self, load: Load, dt: float) -> None:
        """Take a step of dt [s] under a load by cause, then give the water the hull's new pose and an acceleration that
        follows hers by a share of the difference a step (under-relaxation)."""
        super().advance(load, dt)
        self.known += self.share * (np.stack([self.acceleration, self.turning]) - self.known)
        self.place_hull()

    def place_hull(self) -> None:
        """Give the fluid pose, velocity and under-relaxed acceleration (`advance`) of its boundary body, the hull."""
        body = hold_motions(self.body, self.free)
        linear, turning = self.known
        moving = body.velocity, body.angular_velocity, linear, turning
        self.boundary.place(self.number, body.position, body.matrix, *moving)
