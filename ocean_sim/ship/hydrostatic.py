"""A ship that floats by its volume: water pressure on cubes; no added mass.

In a sea in closed form the pressure is that at each cube's own depth, and damping acts on the hull's motion relative to
the water. Over particles the push is along the normal of the surface, not straight up, which keeps long waves from
turning the hull further than their slope. Without added mass, heave and pitch of a broad hull are too quick; `dynamic`
has it.
"""

from typing import ClassVar, Literal

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.fluid import Fluid
from ocean_sim.ship import Ship
from ocean_sim.ship.body.floating import FloatingConfig, FloatingShip, Immersion
from ocean_sim.ship.body.rigid_body import to_world
from ocean_sim.ship.forces.added_mass import Slamming, by_rule
from ocean_sim.ship.forces.damping import Damping, Resistance
from ocean_sim.ship.naval.hydrostatics import Hydrostatics


class Config(FloatingConfig):
    """Ship under buoyancy and weight, wind, propeller, rudder and damping."""

    compared: ClassVar[bool] = True
    fineness: ClassVar[int] = 1
    kind: Literal["hydrostatic"] = "hydrostatic"
    damping: Damping = Damping(heave=0.05, pitch=0.05, roll=0.05)

    def resistance(self, still: Hydrostatics) -> Resistance:
        """Damping law of the hull (hydrostatics `still`), with Munk's moment, which other kinds have by added mass."""
        sway, _, surge = by_rule(still)[:3]
        return Resistance(self.damping, still, np.zeros(6), munk=sway - surge)

    def build(self, name: str, basin: Basin, fluid: Fluid) -> Ship:
        return Hydrostatic(name, self, basin, fluid)


class Hydrostatic(FloatingShip):
    """A ship of cubes under water pressure, with damping but without added mass."""

    samples_depth: ClassVar[bool] = True

    def __init__(self, name: str, config: Config, basin: Basin, fluid: Fluid) -> None:
        super().__init__(name, config, basin, fluid)
        self.resistance = config.resistance(self.hydrostatics)
        if self.contact is None:
            self.slamming = Slamming(self.hydrostatics, float(by_rule(self.hydrostatics)[1]))

    def damping(self, now: Immersion) -> np.ndarray:
        return now.share * to_world(self.resistance.load(now.motion), now.axes)
