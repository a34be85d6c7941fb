"""A ship that floats by what the particles press on it, and nothing else: no law says how high the water stands.

The hull is sampled as any solid body in the water; the water's laws push it as strongly as it pushes them. To a body
that speeds up, water near it answers at once, with a mass that can exceed the body's own; told its acceleration of the
step before, an explicit step would overshoot. So the water is told an acceleration that follows by the share that the
body has of both masses, which is where the two meet (under-relaxation as in Kuttler & Wall 2008, Comput. Mech. 43).
"""

from dataclasses import replace
from typing import Any, ClassVar, Literal

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.fluid import Limits
from ocean_sim.parts import LedgerRow, Preflight
from ocean_sim.ship import Load, loaded
from ocean_sim.ship.shared.afloat import FloatingConfig, afloat_pose
from ocean_sim.ship.shared.hydrostatics import Hydrostatics, Matter
from ocean_sim.ship.shared.placed import Machine, Voyage
from ocean_sim.ship.shared.rigid_body import RigidBody, advanced, held
from ocean_sim.ship.shared.solid import Solid

IN_A_SLICE = np.array([True, True, False, False, False, True])  # sway, heave and roll
FEWEST = 2.0  # spacings across a hull


class Config(FloatingConfig):
    """Weight, the water's pressure, propeller and rudder; in a slice a metre of the section amidships."""

    needs_surface: ClassVar[bool] = False
    slices: ClassVar[bool] = True
    carried_as_body: ClassVar[bool] = True
    fineness: ClassVar[int] = 3
    kind: Literal["pressure"] = "pressure"
    contact: None = None
    """The water's own laws meet this hull."""

    def solids(self, preflight: Preflight) -> tuple[Solid, ...]:
        still = self.afloat(-preflight.tank.gravity[1], preflight.fluid.rest_density)
        flat = preflight.tank.dimension == 2
        return (Solid(self.whole_hull.shape, still.matter.centre, self.start(still, flat), flat),)

    def start(self, still: Hydrostatics, flat: bool) -> RigidBody:
        """The body at the beginning; in a slice a metre of it."""
        matter = still.matter
        if flat:
            share = 1.0 / float(np.ptp(self.whole_hull.shape.bounds(), axis=0)[2])
            matter = Matter(share * matter.mass, matter.centre, share * matter.inertia)
        return self.body(matter, *afloat_pose(still))

    def warnings(self, preflight: Preflight) -> list[str]:
        found, spacing = super().warnings(preflight), preflight.spacing
        if not preflight.wind.still:
            found.append("a ship of kind pressure feels the water alone; wind does not reach it")
        lower, upper = self.whole_hull.shape.bounds()
        if spacing is not None and (upper - lower).min() < FEWEST * spacing:
            found.append(f"the hull is {(upper - lower).min() / spacing:.2g} spacings thin: water feels through it")
        return found

    def ledger(self, preflight: Preflight) -> list[LedgerRow]:
        """Nothing of its own: the water keeps the samples."""
        return []

    def build(self, basin: Basin, fluid: Any) -> "Pressure":
        return Pressure(self, basin, fluid)


class Pressure(Voyage):
    """A hull among the solid bodies of the water."""

    def __init__(self, config: Config, basin: Basin, fluid: Any) -> None:
        solid: Solid = basin.afloat[0]
        self.boundary, self.number = fluid.boundary, len(basin.obstacles)
        body = solid.body
        if config.afloat_at_first:  # on water that gave way under its own weight since it made room
            body = replace(body, position=body.position - [0.0, fluid.sunk, 0.0])
        super().__init__(config, body, Machine(config, config.propeller, config.rudder, solid.centre), basin.lower[1])
        if solid.flat:
            self.free &= IN_A_SLICE
        self.density = float(fluid.particles.rest_density)
        self.weight = np.array([[0.0, self.body.mass * basin.gravity[1], 0.0], [0.0, 0.0, 0.0]])
        beside = self.density * float(self.boundary.bodies[self.number].volume.sum())  # [kg] of water near it, at most
        self.share = self.body.mass / (self.body.mass + beside)
        self.told = np.zeros((2, 3))  # acceleration and turning that the water knows [m/s2], [rad/s2]
        self.place()

    def load(self, wind: Any, fluid: Any, surface: Any) -> Load:
        """(4.27); all that the water does is under `buoyancy`."""
        forces, torques = self.boundary.forces()
        r, body = self.body.matrix, self.body
        motion = np.concatenate([r.T @ body.velocity, body.rates])
        driven = self.machine.load(motion, self.density, 1.0)
        pressed = np.stack([forces[self.number], torques[self.number]])
        return loaded(gravity=self.weight, buoyancy=pressed, **{part: load @ r.T for part, load in driven.items()})

    def advance(self, load: Load, dt: float) -> None:
        self.moved(advanced, load, dt)
        self.told += self.share * (np.stack([self.acceleration, self.turning]) - self.told)
        self.place()

    def place(self) -> None:
        """Say to the water where the hull is and how it moves."""
        body = held(self.body, self.free)
        linear, turning = self.told
        self.boundary.place(
            self.number, body.position, body.matrix, body.velocity, body.angular_velocity, linear, turning
        )

    def limits(self) -> Limits:
        return Limits()
