"""A ship that floats by its volume: cubes in the water's pressure, along the normal of its surface; no added mass.

The push along the surface's normal, not straight up, keeps long waves from turning the hull further than their slope.
Without water that moves along, heave and pitch are a third too quick for a broad hull: `dynamic` has it.
"""

from typing import Any, ClassVar, Literal

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.fluid import Limits
from ocean_sim.ship import Load, loaded
from ocean_sim.ship.shared.afloat import Afloat, FloatingConfig
from ocean_sim.ship.shared.damping import Damping, Resistance
from ocean_sim.ship.shared.placed import Voyage
from ocean_sim.ship.shared.rigid_body import advanced


class Config(FloatingConfig):
    """Buoyancy and weight, wind, propeller, rudder and damping."""

    compared: ClassVar[bool] = True
    fineness: ClassVar[int] = 1
    kind: Literal["hydrostatic"] = "hydrostatic"
    damping: Damping = Damping(heave=0.05, pitch=0.05, roll=0.05)

    def build(self, basin: Basin, fluid: Any) -> "Hydrostatic":
        return Hydrostatic(self, basin, fluid)


class Hydrostatic(Voyage):
    """A hull of cubes."""

    def __init__(self, config: Config, basin: Basin, fluid: Any) -> None:
        self.afloat = Afloat(config, basin, fluid, below=False)
        super().__init__(config, self.afloat.body, self.afloat.machine, basin.lower[1])
        self.contact, self.sides = self.afloat.contact, self.afloat.sides
        self.resistance = Resistance(config.damping, self.afloat.still, np.zeros(6))
        self.longest = self.afloat.limits()

    def load(self, wind: Any, fluid: Any, surface: Any) -> Load:
        """(4.27)."""
        afloat, body, r = self.afloat, self.body, self.body.matrix
        wet = afloat.wetted(body, wind, surface)
        share, motion = afloat.share(wet), afloat.motion(body, wet)
        driven = self.machine.load(motion, afloat.still.density, share)
        return loaded(
            gravity=afloat.weight,
            buoyancy=wet.buoyancy,
            wave=wet.wave,
            wind_drag=wet.wind_drag,
            wind_lift=wet.wind_lift,
            damping=share * self.resistance.load(motion) @ r.T,
            **{part: load @ r.T for part, load in driven.items()},
        )

    def advance(self, load: Load, dt: float) -> None:
        self.moved(advanced, load, dt)

    def limits(self) -> Limits:
        return self.longest
