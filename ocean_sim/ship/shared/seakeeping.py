"""The law of a ship with added mass, its Coriolis term, and damping by waves; a kind may add forces of its own.

In a sea in closed form every cube feels the pressure at its own depth, so short waves lose their grip on a deep hull
(Smith's factor), and added mass feels the water's acceleration. With a surface over particles both are those of long
waves.
"""

from functools import cached_property
from typing import ClassVar

import numpy as np
from pydantic import field_validator

from ocean_sim.basin import Basin
from ocean_sim.conventions import Motions
from ocean_sim.files.input_file import FileName
from ocean_sim.fluid import ClosedForm, Fluid
from ocean_sim.parts import Preflight, Problems
from ocean_sim.ship import Load
from ocean_sim.ship.shared.added_mass import AddedMass, reaction
from ocean_sim.ship.shared.bem_table import Scattering
from ocean_sim.ship.shared.damping import Damping, Resistance
from ocean_sim.ship.shared.floating import FloatingConfig
from ocean_sim.ship.shared.floating_ship import FloatingShip, Immersion
from ocean_sim.ship.shared.hydrostatics import Hydrostatics
from ocean_sim.ship.shared.radiation import Memory, Radiation
from ocean_sim.ship.shared.slamming import Slamming


class SeakeepingConfig(FloatingConfig):
    """Keys of a ship with added mass."""

    added_mass: AddedMass = AddedMass()
    damping: Damping = Damping()
    radiation: FileName | None = None
    """A CSV file of added mass and damping over frequency: `omega_rad_s`, `heave_added_kg`, `heave_damping_kg_s`,
    `pitch_added_kg_m2`, `pitch_damping_kg_m2_s`, or of any other motion; or a NetCDF file (.nc) that Capytaine wrote.
    These motions remember the waves that they made; `damping` is then only what else damps them, by default nothing.
    Where the file has the force of scattered waves (`heave_scattered_90_re`, `_im` in N/m, waves that go to port; of
    Capytaine its diffraction force), that takes the place of added mass and damping in the water's own motion. Null:
    added mass and damping are constant."""

    @field_validator("radiation")
    @classmethod
    def _complete(cls, file: str | None) -> str | None:
        if file is not None:
            Radiation(file)
        return file

    @cached_property
    def table(self) -> Radiation | None:
        """What the file of `radiation` gives."""
        return None if self.radiation is None else Radiation(self.radiation)

    def moved_along(self, still: Hydrostatics) -> np.ndarray:
        return self.added_mass.diagonal(still)

    def moved_at_once(self, still: Hydrostatics) -> np.ndarray:
        """(6,) added mass [kg] and inertia [kg m2] without the memory of waves, in the order of `Motions`."""
        added = self.moved_along(still)
        if self.table is not None:
            added[self.table.numbers] = self.table.response.added
        return added

    def resistance(self, still: Hydrostatics) -> Resistance:
        radiated = [] if self.table is None else [Motions._fields[k] for k in self.table.numbers]
        return Resistance(self.damping, still, self.moved_at_once(still), radiated)

    def problems(self, preflight: Preflight) -> Problems:
        found = super().problems(preflight)
        if self.radiation is not None and preflight.fluid.made_of_particles:
            twice = "particles carry the waves that a hull makes, and a table of radiation would count them once more"
            found.append((("radiation",), f"{twice}; leave it out, or take water in closed form"))
        return found

    def warnings(self, preflight: Preflight) -> list[str]:
        deep = "the surface alone says nothing of the water below it: short waves hold the hull too hard"
        return super().warnings(preflight) + ([deep] if preflight.surface is not None else [])


class SeakeepingShip(FloatingShip):
    """A hull of cubes, and the water that it moves."""

    below: ClassVar[bool] = True

    def __init__(self, name: str, config: SeakeepingConfig, basin: Basin, fluid: Fluid) -> None:
        super().__init__(name, config, basin, fluid)
        self.added = config.moved_at_once(self.hull.still)
        self.memory: Memory | None = None
        self.scattering: Scattering | None = None  # where a table has it
        self.sea: ClosedForm | None = None  # whose waves the hull scatters
        self.through = np.ones(6)  # of each motion: 1 where it is one through the water, 0 where one of its own
        self.made = np.zeros(6)  # (6,) the motion that makes waves
        if config.table is not None:
            self.memory, self.scattering = Memory(config.table), config.table.scattering
        if self.scattering is not None:
            self.sea, self.through[self.scattering.numbers] = fluid.in_closed_form, 0.0
        self.resistance = config.resistance(self.hull.still)
        if self.contact is None:
            self.slamming = Slamming(self.hull.still, float(self.added[1]))
        self.longest = self.hull.limits(Motions(*self.added)._asdict())

    def damping(self, now: Immersion) -> np.ndarray:
        resisted = self.resistance.load(now.motion)
        if self.memory is not None:
            self.made = now.motion + (1.0 - self.through) * now.wet.velocity
            resisted = resisted + self.memory.load(self.actuators.time, self.made)
        return now.share * resisted @ now.body.matrix.T

    def answered(self, now: Immersion, forces: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        """The water's answer to the hull's own acceleration is part of `damping`, what its own acceleration does, of
        `wave`."""
        force, torque = sum(forces.values(), np.zeros((2, 3)))
        wet = now.wet
        if self.scattering is not None and self.sea is not None:
            (x, _, z), (_, yaw, _) = now.body.position, now.body.angles
            scattered = now.share * self.scattering.load(self.sea.arriving(float(x), float(z)), float(yaw))
            forces = forces | {"wave": forces["wave"] + scattered}
            force, torque = force + scattered[0], torque + scattered[1]
        drift, surge = self.through * wet.velocity, self.through * wet.acceleration
        moved, carried = reaction(now.body, now.share * self.added, force, torque, drift, surge)
        return forces | {"wave": forces["wave"] + carried, "damping": forces["damping"] + moved}

    def advance(self, load: Load, dt: float) -> None:
        if self.memory is not None:
            self.memory.keep(self.actuators.time, self.made)
        super().advance(load, dt)
