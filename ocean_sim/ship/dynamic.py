"""A ship in water that moves along with it: `hydrostatic` with added mass, its Coriolis term, and damping by waves.

In a sea in closed form every cube feels the pressure at its own depth, so short waves lose their grip on a deep hull
(Smith's factor), and added mass feels the water's acceleration. With a surface over particles both are those of long
waves. A kind may derive from `SeakeepingShip` and add forces of its own.
"""

from collections.abc import Iterator
from functools import cached_property
from math import isinf, pi
from typing import ClassVar, Literal

import numpy as np
from pydantic import field_validator

from ocean_sim import waves
from ocean_sim.basin import Basin
from ocean_sim.conventions import Motions
from ocean_sim.files.input_file import FileName
from ocean_sim.fluid import ClosedForm, Fluid
from ocean_sim.model import Faults
from ocean_sim.parts import SceneFacts
from ocean_sim.ship import Load
from ocean_sim.ship.body.floating import FloatingConfig, FloatingShip, Immersion
from ocean_sim.ship.body.rigid_body import to_world
from ocean_sim.ship.forces.added_mass import AddedMass, Slamming, water_reaction
from ocean_sim.ship.forces.damping import Damping, Resistance
from ocean_sim.ship.forces.radiation import BemTable, Memory, Scattering, checked_table, columns_of, heading_gap
from ocean_sim.ship.naval.hydrostatics import Hydrostatics

WAVENUMBER_TOLERANCE = 0.02  # of a wavenumber, by which the water of a table may differ without a word
AXIS_TOLERANCE = 0.05  # of a draught, by which the axis of a table may lie off the centre of mass
DEEP_WATER = 1.0e5  # [m] as deep as any water
END_TOLERANCE = 0.02  # share of breadth, draught and length by which both ends of a hull may differ and count as alike
COUPLED_MOTIONS = (("sway", "roll"), ("surge", "pitch"))  # of any hull that is alike on both sides
COUPLED_BY_ENDS = (("heave", "pitch"), ("sway", "yaw"), ("yaw", "roll"), ("heave", "surge"))  # unless they are alike


class SeakeepingConfig(FloatingConfig):
    """Config keys of a ship with added mass and, if a file `radiation` is given, with radiated and scattered waves."""

    added_mass: AddedMass = AddedMass()
    damping: Damping = Damping()
    radiation: FileName | None = None
    """A CSV file of added mass and damping over frequency: `omega_rad_s`, `heave_added_kg`, `heave_damping_kg_s`,
    `pitch_added_kg_m2`, `pitch_damping_kg_m2_s`, or of any other motion, and of two that act on each other
    `heave_pitch_added_kg_m`, `heave_pitch_damping_kg_m_s`; or a NetCDF file (.nc) that Capytaine wrote, six by six.
    These motions remember the waves that they made; `damping` is then only what else damps them, by default nothing.
    Where the file has the force of scattered waves (`heave_scattered_90_re`, `_im` in N/m, waves that go to port; of
    Capytaine its diffraction force), that takes the place of added mass and damping in the water's own motion. Null:
    added mass and damping are constant."""

    @field_validator("radiation")
    @classmethod
    def _enough_for_radiation(cls, file: str | None) -> str | None:
        """Validate the file `radiation` by reading its table; raises ValueError if that fails."""
        if file is not None:
            checked_table(file)
        return file

    @cached_property
    def table(self) -> BemTable | None:
        """Radiation table in the file `radiation`; None without one."""
        return None if self.radiation is None else checked_table(self.radiation)

    def added_mass_diagonal(self, still: Hydrostatics) -> np.ndarray:
        return self.added_mass.diagonal(still)

    def added_mass_at_infinity(self, still: Hydrostatics) -> np.ndarray:
        """(6,) added mass [kg], [kg m2] at infinite frequency by the radiation table, else `added_mass_diagonal`."""
        added = self.added_mass_diagonal(still)
        if self.table is not None:
            added[self.table.numbers] = np.diag(self.table.impulse_response.added)
        return added

    def added_mass_coupling(self) -> np.ndarray | None:
        """(6, 6) added mass [kg], [kg m], [kg m2] that couples two `Motions`, 0 on the diagonal; None if none does."""
        if self.table is None:
            return None
        own, found = self.table.impulse_response.added, np.zeros((6, 6))
        found[np.ix_(self.table.numbers, self.table.numbers)] = own - np.diag(np.diag(own))
        return found if found.any() else None

    def resistance(self, still: Hydrostatics) -> Resistance:
        """Damping law of the hull (hydrostatics `still`), with no rule for motions that the radiation table damps."""
        radiated = [] if self.table is None else [Motions._fields[k] for k in self.table.numbers]
        return Resistance(self.damping, still, self.added_mass_at_infinity(still), radiated)

    def mismatches(self, preflight: SceneFacts) -> Faults:
        yield from super().mismatches(preflight)
        if self.table is not None:
            still = self.hydrostatics_of(preflight)
            own = [still.matter.mass] * 3 + np.diag(still.matter.inertia).tolist()
            for motion, mass, water in zip(Motions._fields, own, self.added_mass_at_infinity(still)):
                if mass + water <= 0.0:
                    sentence = f"water of {water:.3g} in {motion} leaves her less than no mass, she has {mass:.3g}"
                    yield ("radiation",), f"{sentence}; check the sign and the unit of {motion}_added"
        if self.radiation is not None and preflight.fluid.made_of_particles:
            twice = "particles carry the waves that a hull makes, and a table of radiation would count them twice"
            yield ("radiation",), f"{twice}; leave it out, or take water in closed form"

    def warnings(self, preflight: SceneFacts) -> Iterator[str]:
        yield from super().warnings(preflight)
        if preflight.surface is not None:
            yield "waves shorter than her hull lift her too much: she feels their height, not how they fade with depth"
        still, table = self.hydrostatics_of(preflight), self.table
        if table is not None and not isinf(still.draught):
            differs, covers = self.table_differences(table, preflight.tank, still), self.coverage_warnings(table, still)
            yield from (f"radiation: {said}" for said in (*differs, *table.unphysical_entries, *covers))

    def coverage_warnings(self, table: BemTable, still: Hydrostatics) -> Iterator[str]:
        """Yield warnings of couplings, natural periods and wave forces of free motions that the table lacks."""
        names = [Motions._fields[k] for k in table.numbers if Motions._fields[k] in self.free]
        _, breadth, draught = still.stations
        ends = max(float(np.abs(row - row[::-1]).max() / row.max()) for row in (breadth, draught))
        ends = max(ends, abs(float(still.matter.centre[2] - still.voxels.centre[:, 2].mean())) / still.length)
        for a, b in COUPLED_MOTIONS + (COUPLED_BY_ENDS if ends > END_TOLERANCE else ()):
            if a in names and b in names and not table.has_coupling(a, b):
                neither = f"the table has {a} and {b}, and nothing of what they do to each other"
                yield f"{neither}: neither feels the other; add {' and '.join(columns_of(a, b))}"
        periods = still.periods(self.added_mass_at_infinity(still))
        for name in names:
            period = periods.get(name)
            if period is not None and not table.omega[0] <= 2.0 * pi / period <= table.omega[-1]:
                reach = f"{2.0 * pi / table.omega[-1]:.3g} to {2.0 * pi / table.omega[0]:.3g} s"
                yield f"the natural period of {name}, {period:.3g} s, lies beyond the table, which has {reach}"
        if table.scattered is not None:
            headings, force = table.scattered
            mute = [name for name in names if not force[Motions._fields.index(name)].any()]
            if mute:
                lacks = f"not what they do in {', '.join(mute)}: no wave moves her there"
                yield f"the table has scattered waves, but {lacks}"
            if only := heading_gap(headings):
                nearest = "those nearest are taken for those of any waves"
                yield f"the scattered forces of the table are of waves that go to {only} from her heading: {nearest}"

    def feels_bed(self, depth: float) -> bool:
        return self.table is not None and self.table.depth == depth

    def table_differences(self, table: BemTable, tank: Basin, still: Hydrostatics) -> Iterator[str]:
        """Warn where speed, water depth or axis of rotation of the table differ from those of this scene."""
        if self.propeller is not None or any(self.velocity):
            opening = "the table is of a hull without forward speed; under way it counts at the frequency of encounter,"
            yield f"{opening} with strip theory's terms of speed, which are those of a slender hull without a transom"
        if table.depth is not None and table.depth != tank.depth:
            here, there = (
                waves.wavenumber(float(table.omega[0]), min(depth, DEEP_WATER), -tank.gravity[1])
                for depth in (tank.depth, table.depth)
            )
            if abs(there / here - 1.0) > WAVENUMBER_TOLERANCE:
                deep = "deep water" if isinf(table.depth) else f"water {table.depth:g} m deep"
                begin = f"the table is of {deep}, here it is {tank.depth:g} m: its longest waves, of"
                middle = f"{2.0 * pi / table.omega[0]:.3g} s, are {abs(there / here - 1.0):.0%}"
                yield f"{begin} {middle} {'shorter' if there < here else 'longer'} here; forces are those of the table"
        if table.axis is not None:
            centre = float(still.matter.centre[1]) - still.keel - still.draught
            if abs(table.axis - centre) > AXIS_TOLERANCE * still.draught:
                about = f"the table turns about a point {table.axis:.3g} m over the still water"
                yield f"{about}, the centre of mass lies at {centre:.3g} m"


class SeakeepingShip(FloatingShip):
    """Ship of cubes with added mass and, if she has a radiation table, forces of radiated and scattered waves."""

    samples_depth: ClassVar[bool] = True

    def __init__(self, name: str, config: SeakeepingConfig, basin: Basin, fluid: Fluid) -> None:
        super().__init__(name, config, basin, fluid)
        self.added, self.between = config.added_mass_at_infinity(self.hydrostatics), config.added_mass_coupling()
        self.memory: Memory | None = None
        self.scattering: Scattering | None = None  # where a table has it
        self.sea: ClosedForm | None = None  # whose waves the hull scatters
        self.through = np.ones(6)  # of each motion: 1 where it is one through the water, 0 where one of its own
        self.made = np.zeros(6)  # (6,) the motion that makes waves
        self.stream = np.zeros(3)  # velocity of a current [m/s]
        if config.table is not None:
            self.memory = Memory(config.table)
        if config.table is not None and config.table.scattered is not None:
            self.scattering = Scattering(config.table)
            self.sea, self.through[self.scattering.numbers] = fluid.in_closed_form, 0.0
        if self.sea is not None:
            self.stream[[0, 2]] = self.sea.current
        self.resistance = config.resistance(self.hydrostatics)
        if self.contact is None:
            self.slamming = Slamming(self.hydrostatics, float(self.added[1]))
        self.motion_limits = self.limits_of_motion(self.added)

    def damping(self, now: Immersion) -> np.ndarray:
        resisted = self.resistance.load(now.motion)
        if self.memory is not None:
            self.made = now.motion + (now.wet.velocity - self.drift_velocity(now))
            resisted = resisted + self.memory.load(self.actuators.time, self.made)
        return now.share * to_world(resisted, now.axes)

    def drift_velocity(self, now: Immersion) -> np.ndarray:
        """(6,) velocity [m/s], [rad/s], body axes, of the water through which the hull's added mass moves: of current
        and waves, but of current alone in degrees of freedom whose scattering force the file `radiation` has."""
        if self.scattering is None:
            return now.wet.velocity
        stream = np.concatenate([now.body.matrix.T @ self.stream, np.zeros(3)])
        return self.through * now.wet.velocity + (1.0 - self.through) * stream

    def with_added_mass(self, now: Immersion, forces: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        """Copy of `forces` by cause. The key `damping` gains the reaction of added mass to the hull's motion, the key
        `wave` that to the water's motion, and the force of scattered waves."""
        force, torque = np.concatenate(list(forces.values())).reshape(-1, 2, 3).sum(axis=0)
        wet = now.wet
        if self.scattering is not None and self.sea is not None:
            (x, _, z), (_, yaw, _) = now.axes.position, now.axes.angles
            through = now.axes.velocity - self.stream
            scattered = now.share * self.scattering.load(self.sea.arriving(float(x), float(z)), float(yaw), through)
            forces = forces | {"wave": forces["wave"] + scattered}
            force, torque = force + scattered[0], torque + scattered[1]
        drift, surge = self.drift_velocity(now), self.through * wet.acceleration
        between = None if self.between is None else now.share * self.between
        added = now.share * self.added
        moved, carried = water_reaction(now.body, added, between, force, torque, drift, surge, self.free)
        return forces | {"wave": forces["wave"] + carried, "damping": forces["damping"] + moved}

    def advance(self, load: Load, dt: float) -> None:
        if self.memory is not None:
            self.memory.remember(self.actuators.time, self.made)
        super().advance(load, dt)


class Config(SeakeepingConfig):
    """Ship under buoyancy and weight, added mass, wind, propeller, rudder and damping."""

    compared: ClassVar[bool] = True
    fineness: ClassVar[int] = 2
    kind: Literal["dynamic"] = "dynamic"

    def build(self, name: str, basin: Basin, fluid: Fluid) -> SeakeepingShip:
        return SeakeepingShip(name, self, basin, fluid)
