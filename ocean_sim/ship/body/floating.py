"""Ships that float by their volume: keys and checks of their kinds, the pose of a hull at rest, and the ship: her
cubes in the water of a scene, and the sum of her forces (thesis 4.27).

A kind adds a force by naming it in `parts` and extending `forces`.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache
from math import cos, inf, isinf, pi, radians, sin, sqrt
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple

import numpy as np
from pydantic import ValidationInfo, field_validator

from ocean_sim.basin import Basin
from ocean_sim.basin.solids.voxels import MAX_LATTICE_NODES, Distance, lattice_memory
from ocean_sim.conventions import WATER_DENSITY, Diverged
from ocean_sim.files.input_file import FileName, relative_to_scene
from ocean_sim.fluid import ClosedForm, Contact, Fluid, Limits
from ocean_sim.model import Faults, Model, Vector3, quantity
from ocean_sim.parts import LedgerRow, SceneFacts, called, named
from ocean_sim.ship import Afloat, Load, Look, Outline
from ocean_sim.ship.body import small_linalg
from ocean_sim.ship.body.rigid_body import RigidBody, euler_quaternion, quaternion_product, rotation_matrix, to_world
from ocean_sim.ship.body.vessel import Actuators, Vessel, VesselConfig, placed_outline
from ocean_sim.ship.forces.added_mass import Slamming
from ocean_sim.ship.forces.damping import Resistance
from ocean_sim.ship.forces.moorings import Mooring
from ocean_sim.ship.forces.propulsion import Autopilot, Crew, Propeller, Rudder
from ocean_sim.ship.hull.cubes import Cubes, Wetted
from ocean_sim.ship.hull.hull import Hull, Inertia, error_sentence, hull_of
from ocean_sim.ship.hull.shapes import convex_corners
from ocean_sim.ship.naval.hydrostatics import Hydrostatics, bow_squat
from ocean_sim.ship.water import wave_contact
from ocean_sim.ship.water.solid import Solid
from ocean_sim.ship.water.wall_contact import Sides
from ocean_sim.ship.water.water_samples import DEPTH_LEVELS, NODES_ACROSS, NODES_ALONG, SurroundingSea, SurroundingWater
from ocean_sim.ship.water.wave_contact import CUBES_A_SPACING, SAG_RIM, WaveContact
from ocean_sim.surface import Surface
from ocean_sim.wind import Wind

if TYPE_CHECKING:
    from ocean_sim.ship.forces.drift import Drift

RESOLVED_SPACINGS = 4.0  # spacings in a draught
SHALLOW_DRAUGHTS = 4.0  # draughts of water from which on the bed is hardly felt
GM_TOLERANCE = 0.05  # of GM by which that of the cubes may differ from that of the hull without a warning
MAX_LEAN = 30.0  # [deg] of trim or heel, within which a pose at rest is looked for
STEPS_A_PERIOD = 50  # of the fastest natural motion
HEAVIEST_MATTER = 2.3e4  # [kg/m3] osmium
FORCE_NUMBER = 0.25  # share of a limit that the time step `courant` takes


class DriftFile(Model):
    """Drift forces of a hull from a table."""

    table: FileName
    """A CSV file with a row for each frequency and heading: `omega_rad_s`, `heading_deg` to which the waves go from the
    ship's heading (0 astern, 90 to port, 180 head sea), `surge_N_m2`, `sway_N_m2` [N/m2] to bow and port and
    `yaw_Nm_m2` [N m/m2] to port, per amplitude squared, about the centre of mass."""

    @field_validator("table")
    @classmethod
    def _whole_table(cls, file: str) -> str:
        """Check that the file holds a readable table of drift forces; raises ValueError if not."""
        from ocean_sim.ship.forces.drift import read_table

        read_table(file)
        return file


class FloatingConfig(VesselConfig):
    """Base config of ships that float by the volume of a hull: keys, checks, and data of the hull at rest."""

    example: ClassVar[dict[str, Any]] = {"hull": "wigley"}
    feels_wind: ClassVar[bool] = True

    hull: str | Hull
    """A name in configs/hull/, a mesh file (STL, OBJ, PLY), or a mapping with `shape`."""
    mass: float | None = quantity("kg", None, gt=0.0)
    """Mass of the whole ship; null: that of the hull."""
    centre_of_mass: Vector3 | None = quantity("m", None)
    """Centre of mass, from the hull's origin amidships at the keel; null: that of the hull."""
    inertia: Inertia | None = quantity("kg m2", None)
    """Moments of inertia of pitch, yaw and roll about the centre of mass; null: those of the hull."""
    cells_per_draught: float = quantity("1", 8.0, ge=1.0, le=64.0)
    """Cubes over the draught: 8 for motions, 16 for stability curves."""
    contact: wave_contact.Contact | None = wave_contact.Contact()
    """Push between particles and the hull; null: they pass through each other, and the hull feels the surface alone."""
    propeller: Propeller | None = None
    rudder: Rudder | None = None
    moorings: list[Mooring] = []
    """Lines that hold the ship, and fenders."""
    drift: Literal["rule"] | DriftFile | None = None
    """Second-order forces of waves in closed form on her, mean and slow (Newman 1974): by `rule`, from her waterline
    (Faltinsen et al. 1980, Maruo 1960), for waves shorter than 0.8 lengths ahead and twice her breadth abeam, or from a
    `table`; horizontal wave forces are then those on the hull at rest. Null: none."""

    @field_validator("hull")
    @classmethod
    def _existing_hull(cls, hull: str | Hull, info: ValidationInfo) -> str | Hull:
        """Check that the hull exists, and resolve a mesh path relative to the scene; raises ValueError."""
        if not isinstance(hull, str) or hull in named("hull"):
            return hull
        hull_of(hull)
        return relative_to_scene(hull, info)

    @cached_property
    def whole_hull(self) -> Hull:
        """Hull of the ship; mass, centre of mass and inertia given in this config replace the hull's own."""
        hull = hull_of(self.hull) if isinstance(self.hull, str) else self.hull
        own = {"mass": self.mass, "centre_of_mass": self.centre_of_mass, "inertia": self.inertia}
        return hull.model_copy(update={key: value for key, value in own.items() if value is not None})

    @cached_property
    def still_water_cache(self) -> dict[tuple[float, float], Hydrostatics]:
        """Cache of hydrostatics by (gravity, density), filled by `in_still_water`."""
        return {}

    def in_still_water(self, gravity: float, density: float) -> Hydrostatics:
        """Hydrostatics at a gravity [m/s2] and a water density [kg/m3]; raises ValueError for an unusable hull."""
        asked = gravity, density
        if asked not in self.still_water_cache:
            self.still_water_cache[asked] = self.whole_hull.in_still_water(self.cells_per_draught, density, gravity)
        return self.still_water_cache[asked]

    def hydrostatics_of(self, preflight: SceneFacts) -> Hydrostatics:
        """Hydrostatics of the hull in the still water of a scene; raises ValueError as `in_still_water` does."""
        return self.in_still_water(-preflight.tank.gravity[1], preflight.fluid.rest_density)

    def added_mass_diagonal(self, still: Hydrostatics) -> np.ndarray:
        """(6,) added mass [kg], [kg m2] in the equation of motion, by `Motions`; default 0. `still`: hydrostatics."""
        return np.zeros(6)

    def resistance(self, still: Hydrostatics) -> Resistance | None:
        """Damping law of the hull, by her hydrostatics `still`; None (the default) if only particles slow it down."""
        return None

    def floats(self, preflight: SceneFacts) -> Afloat:
        still = self.hydrostatics_of(preflight)
        if isinf(still.draught):
            return Afloat(still.matter.mass, still.draught, 0.0, 0.0, {})
        across, along = still.metacentric_height(), still.metacentric_height(0)
        periods = still.periods(self.added_mass_diagonal(still))
        return Afloat(still.matter.mass, still.draught, across, along, periods, still.gm_of_faces)

    def look(self, preflight: SceneFacts) -> Look:
        still = self.hydrostatics_of(preflight)
        name = self.hull if isinstance(self.hull, str) else ""
        lower, upper = self.whole_hull.shape.bounds()
        height, turn = afloat_pose(still)
        still_water = np.append(rotation_matrix(turn)[1], height)
        return Look(f"{name} {self.whole_hull.shape.kind}", still_water, float(upper[0] - lower[0]))

    def outline(self, preflight: SceneFacts) -> Outline:
        still = self.hydrostatics_of(preflight)
        corners = convex_corners(self.whole_hull.shape) - still.matter.centre
        return placed_outline(corners, self.resting_body(still))

    def resting_body(self, still: Hydrostatics) -> RigidBody:
        """Rigid body at the start; by the hydrostatics `still` afloat where no height or attitude is given."""
        return self.body_at_start(still.matter, *afloat_pose(still))

    @property
    def drift_law(self) -> tuple[str, float, float]:
        if self.drift is None or isinstance(self.drift, str):
            return self.drift or "", 0.0, inf
        from ocean_sim.ship.forces.drift import read_table

        longest, shortest = (2.0 * pi / read_table(self.drift.table).omega[[0, -1]]).tolist()
        return f"a table of waves of {shortest:.3g} to {longest:.3g} s", shortest, longest

    def drift_force(self, still: Hydrostatics, sea: ClosedForm, body: RigidBody) -> "Drift | None":
        """Mean and slow second-order force of the waves of `sea` on this ship, with hydrostatics `still` and the first
        pose `body`; None without the key `drift`, or if she cannot float."""
        if self.drift is None or isinf(still.draught):
            return None
        from ocean_sim.ship.forces import drift

        if isinstance(self.drift, str):
            return drift.Drift(drift.waterline_law(still), sea, body)
        return drift.Drift(drift.read_table(self.drift.table).coefficients, sea, body)

    def solid(self, preflight: SceneFacts) -> Solid | None:
        if self.contact is None or preflight.spacing is None:
            return None
        still = self.hydrostatics_of(preflight)
        body = self.above_unsettled_water(self.resting_body(still), preflight)
        reach = max(SAG_RIM, preflight.fluid.support_asked or SAG_RIM) * preflight.spacing
        place = still.matter.centre, body.position, body.matrix
        return Solid(self.whole_hull.shape, *place, False, False, body=body, reach=reach)

    def above_unsettled_water(self, body: RigidBody, preflight: SceneFacts) -> RigidBody:
        """Copy of the initial `body`; if its height is given, it is raised as far as the particles will settle."""
        rise = 0.0 if self.afloat_at_first else preflight.fluid.settling(preflight)
        return replace(body, position=body.position + [0.0, rise, 0.0])

    def oversize(self, basin: Basin) -> str:
        """Sentence on a hull that is longer or broader than the basin; empty if it fits."""
        beam, _, length = np.ptp(self.whole_hull.shape.bounds(), axis=0)
        ahead, abeam = abs(cos(radians(self.heading_deg))), abs(sin(radians(self.heading_deg)))
        spans = {"x": max(length * abeam, beam * ahead), "z": max(length * ahead, beam * abeam)}
        sizes = dict(zip("xyz", np.subtract(basin.upper, basin.lower)))
        beyond = [axis for axis in ("x", "z") if basin.dimension == 3 and spans[axis] > sizes[axis]]
        sides = [f"{spans[axis]:.3g} m along {axis}, the basin {sizes[axis]:.3g} m" for axis in beyond]
        return f"the hull takes {' and '.join(sides)}" if sides else ""

    def mismatches(self, preflight: SceneFacts) -> Faults:
        basin, spacing = preflight.tank, preflight.spacing or 0.0
        if self.drift is not None and preflight.fluid.made_of_particles:
            twice = "particles carry the waves that drift her, and would count them twice; leave it out"
            yield ("drift",), f"{twice}, or take water in closed form"
        solid = self.solid(preflight)
        if preflight.fluid.made_of_particles and (large := self.oversize(basin)):
            yield ("hull",), large
            return
        still = self.hydrostatics_of(preflight)
        if solid is not None:
            reach = max(solid.reach, SAG_RIM * spacing)
            if lattice_memory(solid.shape, spacing / CUBES_A_SPACING, reach, 8)[0] > MAX_LATTICE_NODES:
                size = " x ".join(f"{x:.3g}" for x in np.ptp(solid.shape.bounds(), axis=0))
                message = f"a hull of {size} m is too small for particles {spacing:g} m apart"
                yield ("hull",), f"{message}; take a smaller fluid.spacing"
                return
            sides, body = Sides(solid.shape, solid.centre, basin), solid.body
        elif not preflight.fluid.made_of_particles and not isinf(still.draught):
            sides = Sides(self.whole_hull.shape, still.matter.centre, basin, axes=(1,))
            body = self.resting_body(still)
        else:
            return
        for axis, _, depth in sides.penetrations(body):
            if depth.max() > 1e-6:
                side = "the bed" if axis == 1 else f"a wall across {'xyz'[axis]}"
                yield ("position",), f"the hull reaches {depth.max():.3g} m through {side}"

    def unfollowable_orders(self) -> Faults:
        """Yield faults (key, sentence) of orders to a propeller or a rudder that the ship does not have."""
        pilot, autopilot = self.helm, isinstance(self.controls, Autopilot)
        if pilot is not None and (self.propeller is None or "surge" not in self.free):
            lacks = "she has no propeller" if self.propeller is None else "her surge is held"
            cure = "give her one (thrust [N])" if self.propeller is None else "add surge to `free`"
            yield ("helm",), f"asks for {pilot.speed:g} m/s, but {lacks}; {cure}, or leave helm out"
        if (pilot is not None or autopilot) and self.rudder is None and "yaw" in self.free:
            key, order = ("controls", "a heading") if autopilot else ("helm", "a heading or a route")
            cure = f"give her one (area, position), or leave {key} out"
            yield (key,), f"asks for {order}, but she has no rudder; {cure}"

    def problems(self, preflight: SceneFacts) -> Faults:
        basin = preflight.tank
        found = [*self.basin_problems(basin), *self.unfollowable_orders()]
        for k, mooring in enumerate(self.moorings):
            if isinstance(mooring.fairlead, str) and mooring.fairlead not in self.points:
                there = f"there are {', '.join(self.points)}" if self.points else "it names none"
                found.append((("moorings", k, "from"), f"the ship has no point {mooring.fairlead!r}; {there}"))
        if found:
            yield from found
            return
        try:
            hull = self.in_still_water(-basin.gravity[1], WATER_DENSITY)
        except ValueError as error:
            yield ("hull",), error_sentence(error)
            return
        if hull.matter.mass > HEAVIEST_MATTER * hull.voxels.volume:
            what = f"a hull of {hull.voxels.volume:.3g} m3 that weighs {hull.matter.mass:.3g} kg"
            yield ("mass",), f"{what} would be denser than any metal: is it in kg?"
        if not isinf(hull.draught) and hull.draught > basin.depth:
            yield ("hull",), f"the ship draws {hull.draught:.3g} m, the water is {basin.depth:g} m deep"

    def missing_water(self, preflight: SceneFacts) -> Iterator[str]:
        """Warn if there is no water under the ship, or none that bears her."""
        fluid, (x, z) = preflight.fluid, (self.position[0], self.position[-1])
        if not fluid.made_of_particles:
            large = self.oversize(preflight.tank)
            if large:
                yield f"{large}: pictures show only the basin; a sea in closed form continues beyond it"
            return
        if not fluid.bears:
            yield f"water of kind {fluid.kind} has no pressure: only a bed carries the ship"
        boxes = preflight.untouched.boxes if preflight.untouched is not None else []
        wet = any(low[0] <= x <= up[0] and low[2] <= z <= up[2] for low, up in boxes)
        if preflight.tank.dimension == 3 and not wet:
            yield f"there is no water under the ship at x = {x:g}, z = {z:g} m at first: it falls"

    def start_height_warnings(self, hull: Hydrostatics, preflight: SceneFacts) -> Iterator[str]:
        """Warn of a ship that starts more than a draught above her height afloat, or wholly under water."""
        if self.afloat_at_first:
            return
        above = self.position[1] - afloat_pose(hull)[0]
        freeboard = float(np.ptp(self.whole_hull.shape.bounds(), axis=0)[1]) - hull.draught
        if -above > freeboard:
            under = f"{-above:.3g} m below where it floats, with its whole hull under water"
            yield f"the ship begins {under}: it shoots up"
        elif above > hull.draught:
            speed = sqrt(2.0 * -preflight.tank.gravity[1] * (above - hull.draught))
            fall = f"the ship begins {above:.3g} m above where it floats, more than its draught of {hull.draught:.3g} m"
            rule = "slamming follows a rule of its waterplane, not the pressures"
            yield f"{fall}: it falls on the water at {speed:.2g} m/s, and {rule}"

    def feels_bed(self, depth: float) -> bool:
        """True if added mass and damping of the ship account for a bed at this depth [m]."""
        return False

    def shallow_water_warning(self, hull: Hydrostatics, depth: float) -> str:
        """Warning that effects of shallow water, such as squat, are not modelled, for water of a depth [m]."""
        bed = "squat is" if self.feels_bed(depth) else "squat, and the bed's part in added mass and damping, are"
        message = f"the water is {depth / hull.draught:.3g} draughts deep: {bed} not modelled"
        speed = max(float(np.linalg.norm(self.velocity)), self.helm.speed if self.helm is not None else 0.0)
        if speed == 0.0:
            return message
        sunk = bow_squat(hull.needed_volume, hull.length, speed, depth)
        if isinf(sunk):
            return f"{message}; {speed:.3g} m/s are faster than the fastest wave there, sqrt(g h)"
        touches = ", and touch the bed" if hull.draught + sunk >= depth else ""
        return f"{message}; at {speed:.3g} m/s her bow would lie {sunk:.2g} m deeper{touches} (ICORELS 1980)"

    def cube_gm_warnings(self, still: Hydrostatics) -> Iterator[str]:
        """Warn if GM by cubes, in the hydrostatics `still`, and by faces differs by more than GM_TOLERANCE."""
        gm, own = still.metacentric_height(), still.gm_of_faces
        if self.carried_as_body or own is None or abs(gm - own) <= GM_TOLERANCE * abs(own):
            return
        than = f"GM of the ship's cubes is {gm:.3g} m, that of her hull {own:.3g} m"
        rows = f"{still.draught / float(still.voxels.size[1]):.2f} rows of cubes are under water"
        cure = f"{rows}: try another cells_per_draught; half a row dry suits best"
        if min(gm, own) <= 0.0:
            yield f"{than}; {cure}"
            return
        slower = sqrt(gm / own) - 1.0
        rolls = f"she rolls {abs(slower):.1%} {'faster' if slower > 0.0 else 'slower'} than her hull would"
        yield f"{than}: {rolls}; {cure}"

    def warnings(self, preflight: SceneFacts) -> Iterator[str]:
        hull, mesh = self.hydrostatics_of(preflight), self.whole_hull.shape.closed_mesh()
        if mesh is not None:
            yield from (f"the hull's mesh: {remark}" for remark in mesh.remarks)
        if isinf(hull.draught):
            yield f"the ship weighs {hull.matter.mass:.4g} kg, more than its hull can carry: it sinks"
            return
        if mesh is not None:
            yield from mesh.unlike_a_ship(hull.draught, hull.kb)
        yield from super().warnings(preflight)
        yield from self.missing_water(preflight)
        yield from self.start_height_warnings(hull, preflight)
        crew = Crew(self.controls)
        if self.propeller is None and (isinstance(self.controls, Autopilot) or crew.throttle.any()):
            yield "controls: the throttle that they ask for has no effect: she has no propeller"
        if self.rudder is None and crew.rudder.any():
            yield "controls: the rudder that they ask for has no effect: she has no rudder"
        helm, screw = self.helm, self.propeller
        if helm is not None and screw is not None and screw.thrust_at(1.0, helm.speed) <= 0.0:
            yield f"helm: asks for {helm.speed:g} m/s, at which her propeller gives no thrust"
        logged = [part.model_dump()["point"] for key, part in preflight.parts.items() if key == "motion"]
        if unasked := self.points.keys() - {"helm", *logged, *(mooring.fairlead for mooring in self.moorings)}:
            yield f"points: neither a mooring nor motion.point asks for {' or '.join(sorted(unasked))}"
        if any(preflight.fluid.steady_force):
            effect = "which it makes heavier or drives; the ship does not feel it"
            yield f"fluid.body_force acts on the water alone, {effect}"
        cells = hull.draught / float(hull.voxels.size[1])
        if cells < 0.9 * self.cells_per_draught:
            few = f"the hull has {cells:.2g} cubes over its draught"
            yield f"{few}, because only a little of its height is under water"
        if hull.metacentric_height() <= 0.0:
            yield f"the ship is unstable upright: GM = {hull.metacentric_height():.3g} m; it will heel"
        elif rest_angles(hull) is None:
            far = "her centre of mass lies too far from that of her buoyancy"
            yield f"within {MAX_LEAN:g} degrees of trim and heel the ship has no pose at rest: {far}"
        yield from self.cube_gm_warnings(hull)
        if not preflight.fluid.made_of_particles and preflight.tank.depth < SHALLOW_DRAUGHTS * hull.draught:
            yield self.shallow_water_warning(hull, preflight.tank.depth)
        resistance = self.resistance(hull)
        if resistance is not None:
            yield from resistance.warnings
            yield from resistance.undamped_warnings(self.free)
        spacing = preflight.spacing
        if spacing and hull.draught < RESOLVED_SPACINGS * spacing:
            message = f"the draught of {hull.draught:.3g} m is {hull.draught / spacing:.2g} spacings"
            yield f"{message}; below {RESOLVED_SPACINGS:g} the water does not resolve the ship"

    def ledger(self, preflight: SceneFacts) -> Iterable[LedgerRow]:
        basin, word = preflight.tank, preflight.word
        n = len(self.in_still_water(-basin.gravity[1], WATER_DENSITY).voxels.share)
        lattice = preflight.fluid.window_bytes(preflight, (NODES_ALONG, NODES_ACROSS), DEPTH_LEVELS)
        size = Cubes.bytes(n, word) + (2 if self.drift else 1) * (SurroundingSea.bytes(word) + lattice)
        why = f"{self.cells_per_draught:g} cells_per_draught"
        yield LedgerRow("ship", f"{n} cubes of the hull", size, why)
        solid = self.solid(preflight)
        if solid is not None:
            count, size = lattice_memory(solid.shape, solid.reach / SAG_RIM / CUBES_A_SPACING, solid.reach, word)
            yield LedgerRow("ship", f"{count} distances from the hull", size, "ship.contact with particles")


def afloat_pose(still: Hydrostatics) -> tuple[float, np.ndarray]:
    """Height of the centre of mass [m], quaternion (4,) of a ship at rest; upright if she sinks or has no balance."""
    if isinf(still.draught):
        return float(still.matter.centre[1] - still.voxels.centre[:, 1].max()), euler_quaternion(0.0, 0.0, 0.0)
    found = rest_angles(still)
    angle = np.zeros(2) if found is None else found
    turn = lean_matrix(angle)
    level = still.water_level(turn[1])
    return float((turn @ still.matter.centre)[1] - level), euler_quaternion(angle[0], 0.0, angle[1])


@lru_cache(maxsize=4)
def rest_angles(still: Hydrostatics) -> np.ndarray | None:
    """(2,) pitch and roll [rad] at which a hull (`still`) balances, upright if it can; None if beyond MAX_LEAN."""

    def levers(angle: np.ndarray) -> np.ndarray:
        """(2,) [m] ahead, to port from centre of mass to buoyancy of the floating hull, at (2,) pitch, roll [rad]."""
        return still.buoyancy_offset(lean_matrix(angle))[::-1]

    upright = np.zeros(2)
    size = float(np.ptp(still.voxels.centre[:, 2]))
    if np.abs(levers(upright)).max() <= 1e-6 * size:
        return upright
    found, small = upright, 1e-4
    for _ in range(20):  # Newton's steps
        here = levers(found)
        slope = np.column_stack([(levers(found + turn) - here) / small for turn in small * np.eye(2)])
        step = np.clip(-np.linalg.lstsq(slope, here)[0], -0.1, 0.1)
        found = found + step
        if np.abs(step).max() < 1e-10:
            break
    return found if np.abs(levers(found)).max() < 1e-3 * size and np.abs(found).max() < radians(MAX_LEAN) else None


def lean_matrix(angle: np.ndarray) -> np.ndarray:
    """(3, 3) rotation matrix, body to world, of `angle`, (2,) pitch and roll [rad], without yaw."""
    return rotation_matrix(euler_quaternion(angle[0], 0.0, angle[1]))


class Immersion(NamedTuple):
    """State of a hull in the water at one time: loads of water and wind, velocity through the water, and pose."""

    wet: Wetted
    share: float  # of added mass, damping and thrust that is left, 0 to 1
    motion: np.ndarray  # (6,) velocity relative to the water, body axes [m/s], [rad/s]
    surface: Surface | Fluid
    body: RigidBody
    axes: RigidBody  # along which damping acts and where waves arrive: `body`, or with drift that of `level_body`


def linear_across(wet: Wetted, flat: Wetted, turn: np.ndarray) -> Wetted:
    """Copy of the loads `wet` on a hull, in which horizontal wave force, yaw moment and water motion are those of
    `flat`, the loads on the same hull in her rest position. Their mean is zero, so that all mean force is the drift
    force. `turn`: (3, 3) matrix from the body axes of `flat` to those of the hull."""
    wave = wet.wave.copy()
    wave[0, [0, 2]], wave[1, 1] = flat.wave[0, [0, 2]], flat.wave[1, 1]
    velocity, acceleration = ((moved.reshape(2, 3) @ turn.T).ravel() for moved in (flat.velocity, flat.acceleration))
    return wet._replace(wave=wave, velocity=velocity, acceleration=acceleration)


class FloatingShip(Vessel):
    """Base class of ships whose hull is divided into cubes; it sums all forces but damping, which derived kinds add."""

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
        return Load.of(self.with_added_mass(now, self.forces(now)), self.parts)

    def level_body(self, body: RigidBody, place: np.ndarray, velocity: np.ndarray) -> RigidBody:
        """Copy of `body` at rest afloat with the same heading, at x, z of `place` [m] and with a `velocity` [m/s]."""
        height, trim = self.rest
        turn = quaternion_product(euler_quaternion(0.0, body.angles[1], 0.0), trim)
        return replace(body, position=np.array([place[0], height, place[2]]), velocity=velocity, orientation=turn)

    def forces(self, now: Immersion) -> dict[str, np.ndarray]:
        """Force [N] and torque [N m], (2, 3), by cause, world axes, without the reaction of added mass."""
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

    def with_added_mass(self, now: Immersion, forces: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        """Forces with the reaction of added mass; this base class has none and returns `forces` unchanged."""
        return forces

    def advance(self, load: Load, dt: float) -> None:
        """Move the ship by a step dt [s], with slamming; raises Diverged if one too heavy to float reaches the bed."""
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
        """Limit of the time step: STEPS_A_PERIOD steps in the shortest natural period, with (6,) `added` mass."""
        still = self.hydrostatics
        periods = [] if isinf(still.draught) else [period for period in still.periods(added).values() if period]
        if self.moorings is not None:
            periods.append(2.0 * pi * sqrt(still.matter.mass / float(self.moorings.stiffness.sum())))
        return Limits(force=min(periods) / STEPS_A_PERIOD / FORCE_NUMBER) if periods else Limits()

    def limits(self) -> Limits:
        return self.motion_limits
