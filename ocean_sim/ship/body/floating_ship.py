"""A ship that floats by its volume: the sum of its forces (4.27), with a method for each that a kind may replace.

A kind adds a force by naming it in `parts` and extending `forces`.
"""

from typing import ClassVar, NamedTuple

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.conventions import Diverged
from ocean_sim.fluid import Fluid, Limits
from ocean_sim.parts import called
from ocean_sim.ship import Load
from ocean_sim.ship.body import small_linalg
from ocean_sim.ship.body.floating import FloatingConfig, FloatingHull
from ocean_sim.ship.body.rigid_body import RigidBody, to_world
from ocean_sim.ship.body.vessel import Vessel
from ocean_sim.ship.forces.added_mass import Slamming
from ocean_sim.ship.hull.cubes import Wetted
from ocean_sim.surface import Surface
from ocean_sim.wind import Wind


class Immersion(NamedTuple):
    """How the hull lies in the water now."""

    wet: Wetted
    share: float  # of added mass, damping and thrust that is left, 0 to 1
    motion: np.ndarray  # (6,) velocity relative to the water, body axes [m/s], [rad/s]
    surface: Surface | Fluid
    body: RigidBody


class FloatingShip(Vessel):
    """A hull of cubes; without a kind's own methods nothing damps it."""

    below: ClassVar[bool] = False  # whether it asks the water under its surface, which a closed form answers
    slamming: Slamming | None = None  # of a hull that falls into the water; particles push one themselves

    def __init__(self, name: str, config: FloatingConfig, basin: Basin, fluid: Fluid) -> None:
        self.hull = hull = FloatingHull(config, basin, fluid, self.below)
        super().__init__(name, config, hull.body, hull.actuators, basin.lower[1])
        if hull.moorings is not None:
            self.parts = (*self.parts, "mooring")
            self.last = Load.of({}, self.parts)
        self.shape, self.contact, self.sides = config.whole_hull.shape, hull.contact, hull.sides
        self.longest = hull.limits()
        # Of the last load: velocity relative to the water, volume under water [m3], and for slamming its speed upwards
        # relative to the water [m/s], and what a force upwards at its centre of buoyancy is as a load, (2, 3).
        self.relative, self.wet, self.rising, self.upwards = np.zeros(6), 0.0, 0.0, np.zeros((2, 3))

    def load(self, wind: Wind, fluid: Fluid, surface: Surface | Fluid) -> Load:
        hull, body = self.hull, self.centred if self.hull.water.below else self.body
        wet = hull.wetted(body, wind, surface)
        now = Immersion(wet, hull.share(wet), hull.motion(body, wet), surface, body)
        self.relative, self.wet = now.motion, wet.volume
        self.airborne = not wet.volume > 0.0
        if self.slamming is not None:
            self.rising = small_linalg.dot(body.rows[1], now.motion[:3].tolist())
            self.upwards = wet.buoyancy / max(float(wet.buoyancy[0, 1]), 1e-9)
        return Load.of(self.answered(now, self.forces(now)), self.parts)

    def forces(self, now: Immersion) -> dict[str, np.ndarray]:
        """(2, 3) force [N] and torque about the centre of mass [N m] of each part, world axes, without what the water
        does back."""
        wet, density = now.wet, self.hull.still.density
        driven = self.actuators.load(now.motion, density, now.share)
        moored = self.hull.moorings
        return {
            "gravity": self.hull.weight,
            "buoyancy": wet.buoyancy,
            "wave": wet.wave,
            "wind_drag": wet.wind_drag,
            "wind_lift": wet.wind_lift,
            "damping": self.damped(now),
            **({"mooring": moored.load(now.body)} if moored is not None else {}),
            **{part: to_world(force, now.body) for part, force in driven.items()},
        }

    def damping(self, now: Immersion) -> np.ndarray:
        """(2, 3) what slows it down, world axes [N], [N m]."""
        return np.zeros((2, 3))

    def damped(self, now: Immersion) -> np.ndarray:
        """(2, 3) the same, with what slows down in heave a hull that lies far from its draught."""
        if self.slamming is None:
            return self.damping(now)
        return self.damping(now) + self.slamming.held_back(self.wet, self.rising) * self.upwards

    def answered(self, now: Immersion, forces: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        """The forces with what the water that is moved along does back, which depends on all of them."""
        return forces

    def advance(self, load: Load, dt: float) -> None:
        if self.slamming is not None:
            push = self.slamming.push(self.wet, self.rising, dt)
            if push > 0.0:
                load = load.plus("damping", push * self.upwards, self.parts)
        super().advance(load, dt)
        if self.aground and self.contact is None and not self.hull.floats:
            x, _, z = self.body.position
            raise Diverged(f"{called(self.name)} has sunk to the bed, {-self.bed:g} m down, at ({x:.4g}, {z:.4g}) m")

    def displaced(self) -> tuple[np.ndarray, np.ndarray]:
        return self.hull.cubes.displaced(self.body, self.hull.water)

    def limits(self) -> Limits:
        return self.longest
