"""A ship in water that moves along with it: `hydrostatic` with added mass, its Coriolis term, and damping by waves.

In a sea in closed form every cube feels the pressure at its own depth, so short waves lose their grip on a deep hull
(Smith's factor), and added mass feels the water's acceleration. With a surface over particles both are those of long
waves.
"""

from typing import Any, Literal

import numpy as np
from pydantic import field_validator

from ocean_sim.basin import Basin
from ocean_sim.conventions import Motions
from ocean_sim.files.input_file import FileName
from ocean_sim.fluid import Limits
from ocean_sim.ship import Load, loaded
from ocean_sim.ship.shared.added_mass import AddedMass, reaction
from ocean_sim.ship.shared.afloat import Afloat, FloatingConfig
from ocean_sim.ship.shared.damping import Damping, Resistance
from ocean_sim.ship.shared.placed import Voyage
from ocean_sim.ship.shared.radiation import Memory, Radiation
from ocean_sim.ship.shared.rigid_body import advanced


class Config(FloatingConfig):
    """Buoyancy and weight, added mass, wind, propeller, rudder and damping."""

    kind: Literal["dynamic"] = "dynamic"
    added_mass: AddedMass = AddedMass()
    damping: Damping = Damping()
    radiation: FileName | None = None
    """A CSV file of added mass and damping over frequency: `omega_rad_s`, `heave_added_kg`, `heave_damping_kg_s`,
    `pitch_added_kg_m2`, `pitch_damping_kg_m2_s`, or of any other motion. These motions remember the waves that they
    made; `damping` is then only what else damps them, by default nothing. Null: added mass and damping are constant."""

    @field_validator("radiation")
    @classmethod
    def _told(cls, file: str | None) -> str | None:
        if file is not None:
            Radiation(file)
        return file

    def build(self, basin: Basin, fluid: Any) -> "Dynamic":
        return Dynamic(self, basin, fluid)

    def warnings(self, scene: Any) -> list[str]:
        deep = "the surface alone says nothing of the water below it: short waves hold the hull too hard"
        return super().warnings(scene) + ([deep] if scene.surface is not None else [])


class Dynamic(Voyage):
    """A hull of cubes, and the water that it moves."""

    def __init__(self, config: Config, basin: Basin, fluid: Any) -> None:
        self.afloat = Afloat(config, basin, fluid, below=True)
        super().__init__(config, self.afloat.body, self.afloat.machine, basin.lower[1])
        self.contact, self.sides = self.afloat.contact, self.afloat.sides
        self.added, radiated = config.added_mass.diagonal(self.afloat.still), []
        self.memory: Memory | None = None
        if config.radiation is not None:
            radiation = Radiation(config.radiation)
            self.memory, self.added[radiation.numbers] = Memory(radiation), radiation.response.added
            radiated = [Motions._fields[k] for k in radiation.numbers]
        self.resistance = Resistance(config.damping, self.afloat.still, self.added, radiated)
        self.relative = np.zeros(6)  # velocity relative to the water, of the last load
        self.longest = self.afloat.limits(Motions(*self.added)._asdict())

    def load(self, wind: Any, fluid: Any, surface: Any) -> Load:
        """(4.27); the water's answer to the hull's own acceleration is part of `damping`."""
        afloat, body, r = self.afloat, self.body, self.body.matrix
        wet = afloat.wetted(body, wind, surface)
        share, motion = afloat.share(wet), afloat.motion(body, wet)
        resisted = self.resistance.load(motion)
        if self.memory is not None:
            resisted = resisted + self.memory.load(self.machine.time, motion)
        self.relative, damping = motion, share * resisted @ r.T
        driven = self.machine.load(motion, afloat.still.density, share)
        driven = {part: load @ r.T for part, load in driven.items()}
        force, torque = sum(
            (wet.buoyancy, wet.wave, wet.wind_drag, wet.wind_lift, damping, *driven.values()), afloat.weight
        )
        moved, carried = reaction(body, share * self.added, force, torque, wet.velocity, wet.acceleration)
        return loaded(
            gravity=afloat.weight,
            buoyancy=wet.buoyancy,
            wave=wet.wave + carried,
            wind_drag=wet.wind_drag,
            wind_lift=wet.wind_lift,
            damping=damping + moved,
            **driven,
        )

    def advance(self, load: Load, dt: float) -> None:
        if self.memory is not None:
            self.memory.keep(self.machine.time, self.relative)
        self.moved(advanced, load, dt)

    def limits(self) -> Limits:
        return self.longest
