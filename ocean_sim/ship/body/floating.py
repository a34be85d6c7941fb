"""Keys of the kinds that float by their own volume, their checks, and the pose of a hull at rest."""

from dataclasses import replace
from functools import cached_property, lru_cache
from math import cos, isinf, radians, sin, sqrt
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from pydantic import ValidationInfo, field_validator

from ocean_sim.basin import Basin
from ocean_sim.basin.solids.voxels import MAX_LATTICE_NODES, lattice_memory
from ocean_sim.conventions import WATER_DENSITY
from ocean_sim.files.input_file import FileName, relative_to_scene
from ocean_sim.fluid import ClosedForm
from ocean_sim.model import Model, Vector3, quantity
from ocean_sim.parts import LedgerRow, Preflight, Problems, named
from ocean_sim.ship import Afloat, Look, Outline
from ocean_sim.ship.body.rigid_body import RigidBody, euler_quaternion, rotation_matrix
from ocean_sim.ship.body.vessel import VesselConfig, placed_outline
from ocean_sim.ship.forces.damping import Resistance
from ocean_sim.ship.forces.moorings import Mooring
from ocean_sim.ship.forces.propulsion import Autopilot, Crew, Propeller, Rudder
from ocean_sim.ship.hull.cubes import Cubes
from ocean_sim.ship.hull.hull import Hull, Inertia, error_sentence, hull_of
from ocean_sim.ship.hull.shapes import convex_corners
from ocean_sim.ship.naval.hydrostatics import Hydrostatics, bow_squat, metacentric_heights
from ocean_sim.ship.water.solid import Solid
from ocean_sim.ship.water.wall_contact import Sides
from ocean_sim.ship.water.water_samples import DEPTH_LEVELS, NODES_ACROSS, NODES_ALONG, SurroundingSea
from ocean_sim.ship.water.wave_contact import CUBES_A_SPACING, SAG_RIM, Contact

if TYPE_CHECKING:  # imported only where a ship has drift forces
    from ocean_sim.ship.forces.drift import Drift

RESOLVED_SPACINGS = 4.0  # spacings in a draught
SHALLOW_DRAUGHTS = 4.0  # draughts of water from which on the bed is hardly felt
GM_TOLERANCE = 0.05  # of GM by which that of the cubes may differ from that of the hull without a warning
MAX_LEAN = 30.0  # [deg] of trim or heel, within which a pose at rest is looked for


class DriftFile(Model):
    """Drift forces of a hull from a table."""

    table: FileName
    """A CSV file with a row for each frequency and heading: `omega_rad_s`, `heading_deg` to which the waves go from the
    ship's heading (0 astern, 90 to port, 180 head sea), `surge_N_m2`, `sway_N_m2` [N/m2] to bow and port and
    `yaw_Nm_m2` [N m/m2] to port, per amplitude squared, about the centre of mass."""

    @field_validator("table")
    @classmethod
    def _whole_table(cls, file: str) -> str:
        """Validate the file by reading it; raises ValueError if that fails."""
        from ocean_sim.ship.forces.drift import read_table

        read_table(file)
        return file


class FloatingConfig(VesselConfig):
    """Base config of ships that float by the volume of a hull: keys, checks, and data of the hull at rest."""

    example: ClassVar[dict[str, Any]] = {"hull": "wigley"}

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
    contact: Contact | None = Contact()
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
        """Hull of the ship, with mass, centre of mass and inertia of this config, where given, in place of its own."""
        hull = hull_of(self.hull) if isinstance(self.hull, str) else self.hull
        own = {"mass": self.mass, "centre_of_mass": self.centre_of_mass, "inertia": self.inertia}
        return hull.model_copy(update={key: value for key, value in own.items() if value is not None})

    @cached_property
    def still_water_cache(self) -> dict[tuple[float, float], Hydrostatics]:
        """Cache of hydrostatics by (gravity, density), filled by `in_still_water`."""
        return {}

    @cached_property
    def face_gms(self) -> dict[Hydrostatics, float | None]:
        """Cache of GM [m] from the hull's faces, filled by `gm_of_faces`."""
        return {}

    def in_still_water(self, gravity: float, density: float) -> Hydrostatics:
        """Hydrostatics at a gravity [m/s2] and a water density [kg/m3]; raises ValueError for an unusable hull."""
        asked = gravity, density
        if asked not in self.still_water_cache:
            self.still_water_cache[asked] = self.whole_hull.in_still_water(self.cells_per_draught, density, gravity)
        return self.still_water_cache[asked]

    def hydrostatics_of(self, preflight: Preflight) -> Hydrostatics:
        """Hydrostatics of the hull in the still water of a scene; raises ValueError as `in_still_water` does."""
        return self.in_still_water(-preflight.tank.gravity[1], preflight.fluid.rest_density)

    def added_mass_diagonal(self, still: Hydrostatics) -> np.ndarray:
        """(6,) added mass [kg] and inertia [kg m2] of the law of motion, in the order of `Motions`; default 0."""
        return np.zeros(6)

    def resistance(self, still: Hydrostatics) -> Resistance | None:
        """Damping law of the hull; None (the default) if nothing but particles slows it down."""
        return None

    def floats(self, preflight: Preflight) -> Afloat:
        still = self.hydrostatics_of(preflight)
        if isinf(still.draught):
            return Afloat(still.matter.mass, still.draught, 0.0, 0.0, {})
        across, along = still.metacentric_height(), still.metacentric_height(0)
        periods = still.periods(self.added_mass_diagonal(still))
        return Afloat(still.matter.mass, still.draught, across, along, periods, self.gm_of_faces(still))

    def gm_of_faces(self, still: Hydrostatics) -> float | None:
        """GM [m] from the hull's faces, not from its cubes; None where they only approximate its shape or it sinks."""
        if still not in self.face_gms:
            heights = metacentric_heights(self.whole_hull.shape, still)
            self.face_gms[still] = None if heights is None else heights[0]
        return self.face_gms[still]

    def look(self, preflight: Preflight) -> Look:
        still = self.hydrostatics_of(preflight)
        name = self.hull if isinstance(self.hull, str) else ""
        lower, upper = self.whole_hull.shape.bounds()
        submerged = min(1.0, still.needed_volume / still.voxels.volume)
        return Look(f"{name} {self.whole_hull.shape.kind}", submerged, float(upper[0] - lower[0]))

    def outline(self, preflight: Preflight) -> Outline:
        still = self.hydrostatics_of(preflight)
        corners = convex_corners(self.whole_hull.shape) - still.matter.centre
        return placed_outline(corners, self.resting_body(still))

    def resting_body(self, still: Hydrostatics) -> RigidBody:
        """Rigid body at the start; afloat at rest where the config gives no height or attitude."""
        return self.body_at_start(still.matter, *afloat_pose(still))

    @property
    def feels_wind(self) -> bool:
        return True

    @property
    def drift_law(self) -> str:
        return "" if self.drift is None else self.drift if isinstance(self.drift, str) else "table"

    def drift_force(self, still: Hydrostatics, sea: ClosedForm, body: RigidBody) -> "Drift | None":
        """Drift of a hull, a `body`, in a sea in closed form; None without the key `drift`, or if she cannot float."""
        if self.drift is None or isinf(still.draught):
            return None
        from ocean_sim.ship.forces import drift

        if isinstance(self.drift, str):
            return drift.Drift(drift.waterline_law(still), sea, body)
        return drift.Drift(drift.read_table(self.drift.table).coefficients, sea, body)

    def solid(self, preflight: Preflight) -> Solid | None:
        if self.contact is None or preflight.spacing is None:
            return None
        still = self.hydrostatics_of(preflight)
        body = self.above_unsettled_water(self.resting_body(still), preflight)
        reach = max(SAG_RIM, preflight.fluid.support_asked or SAG_RIM) * preflight.spacing
        place = still.matter.centre, body.position, body.matrix
        return Solid(self.whole_hull.shape, *place, False, False, body=body, reach=reach)

    def above_unsettled_water(self, body: RigidBody, preflight: Preflight) -> RigidBody:
        """A body with a given height, raised by as much as the water will settle, so no gap opens; others unchanged."""
        rise = 0.0 if self.afloat_at_first else preflight.fluid.settling(preflight)
        return replace(body, position=body.position + [0.0, rise, 0.0])

    def oversize(self, basin: Basin) -> str:
        """Message on a hull that is longer or broader than the basin; empty if it is not."""
        beam, _, length = np.ptp(self.whole_hull.shape.bounds(), axis=0)
        ahead, abeam = abs(cos(radians(self.heading_deg))), abs(sin(radians(self.heading_deg)))
        spans = {"x": max(length * abeam, beam * ahead), "z": max(length * ahead, beam * abeam)}
        sizes = dict(zip("xyz", np.subtract(basin.upper, basin.lower)))
        beyond = [axis for axis in ("x", "z") if basin.dimension == 3 and spans[axis] > sizes[axis]]
        sides = [f"{spans[axis]:.3g} m along {axis}, the basin {sizes[axis]:.3g} m" for axis in beyond]
        return f"the hull takes {' and '.join(sides)}" if sides else ""

    def mismatches(self, preflight: Preflight) -> Problems:
        found, basin, spacing = Problems(), preflight.tank, preflight.spacing or 0.0
        if self.drift is not None and preflight.fluid.made_of_particles:
            twice = "particles carry the waves that drift her, and would count them twice; leave it out"
            found.append((("drift",), f"{twice}, or take water in closed form"))
        solid = self.solid(preflight)
        large = self.oversize(basin) if preflight.fluid.made_of_particles else ""
        if large:
            return [*found, (("hull",), large)]
        still = self.hydrostatics_of(preflight)
        if solid is not None:
            reach = max(solid.reach, SAG_RIM * spacing)
            if lattice_memory(solid.shape, spacing / CUBES_A_SPACING, reach, 8)[0] > MAX_LATTICE_NODES:
                size = " x ".join(f"{x:.3g}" for x in np.ptp(solid.shape.bounds(), axis=0))
                message = f"a hull of {size} m is too small for particles {spacing:g} m apart"
                return [(("hull",), f"{message}; take a smaller fluid.spacing")]
            sides, body = Sides(solid.shape, solid.centre, basin), solid.body
        elif not preflight.fluid.made_of_particles and not isinf(still.draught):
            sides = Sides(self.whole_hull.shape, still.matter.centre, basin, axes=(1,))
            body = self.resting_body(still)
        else:
            return found
        for axis, _, depth in sides.penetrations(body):
            if depth.max() > 1e-6:
                side = "the bed" if axis == 1 else f"a wall across {'xyz'[axis]}"
                found.append((("position",), f"the hull reaches {depth.max():.3g} m through {side}"))
        return found

    def unfollowable_orders(self) -> Problems:
        """Faults (key, sentence) of orders for which the ship has no propeller or rudder."""
        found, pilot, autopilot = Problems(), self.helm, isinstance(self.controls, Autopilot)
        if pilot is not None and (self.propeller is None or "surge" not in self.free):
            lacks = "she has no propeller" if self.propeller is None else "her surge is held"
            cure = "give her one (thrust [N])" if self.propeller is None else "add surge to `free`"
            found.append((("helm",), f"asks for {pilot.speed:g} m/s, but {lacks}; {cure}, or leave helm out"))
        if (pilot is not None or autopilot) and self.rudder is None and "yaw" in self.free:
            key, order = ("controls", "a heading") if autopilot else ("helm", "a heading or a route")
            cure = f"give her one (area, position), or leave {key} out"
            found.append(((key,), f"asks for {order}, but she has no rudder; {cure}"))
        return found

    def problems(self, preflight: Preflight) -> Problems:
        basin = preflight.tank
        found = self.basin_problems(basin) + self.unfollowable_orders()
        for k, mooring in enumerate(self.moorings):
            if isinstance(mooring.fairlead, str) and mooring.fairlead not in self.points:
                there = f"there are {', '.join(self.points)}" if self.points else "it names none"
                found.append((("moorings", k, "from"), f"the ship has no point {mooring.fairlead!r}; {there}"))
        if found:
            return found
        try:
            hull = self.in_still_water(-basin.gravity[1], WATER_DENSITY)
        except ValueError as error:
            return [*found, (("hull",), error_sentence(error))]
        if not isinf(hull.draught) and hull.draught > basin.depth:
            message = f"the ship draws {hull.draught:.3g} m, the water is {basin.depth:g} m deep"
            found.append((("hull",), message))
        return found

    def missing_water(self, preflight: Preflight) -> list[str]:
        """Warnings of water that is missing under the ship, or that does not bear her."""
        fluid, (x, z) = preflight.fluid, (self.position[0], self.position[-1])
        if not fluid.made_of_particles:
            large = self.oversize(preflight.tank)
            return [f"{large}: pictures show only the basin; a sea in closed form continues beyond it"] if large else []
        found = [] if fluid.bears else [f"water of kind {fluid.kind} has no pressure: only a bed carries the ship"]
        boxes = preflight.untouched.boxes if preflight.untouched is not None else []
        wet = any(low[0] <= x <= up[0] and low[2] <= z <= up[2] for low, up in boxes)
        if preflight.tank.dimension == 3 and not wet:
            found.append(f"there is no water under the ship at x = {x:g}, z = {z:g} m at first: it falls")
        return found

    def start_height_warnings(self, hull: Hydrostatics, preflight: Preflight) -> list[str]:
        """Warnings of a ship that begins more than a draught above its floating height, or wholly under water."""
        if self.afloat_at_first:
            return []
        above = self.position[1] - afloat_pose(hull)[0]
        freeboard = float(np.ptp(self.whole_hull.shape.bounds(), axis=0)[1]) - hull.draught
        if -above > freeboard:
            under = f"{-above:.3g} m below where it floats, with its whole hull under water"
            return [f"the ship begins {under}: it shoots up"]
        if above <= hull.draught:
            return []
        speed = sqrt(2.0 * -preflight.tank.gravity[1] * (above - hull.draught))
        fall = f"the ship begins {above:.3g} m above where it floats, more than its draught of {hull.draught:.3g} m"
        rule = "slamming follows a rule of its waterplane, not the pressures"
        return [f"{fall}: it falls on the water at {speed:.2g} m/s, and {rule}"]

    def feels_bed(self, depth: float) -> bool:
        """True if the ship's added mass and damping are those over a bed at this depth [m]."""
        return False

    def shallow_water_warning(self, hull: Hydrostatics, depth: float) -> str:
        """Warning of effects of water of a depth [m], such as squat, that are not modelled."""
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

    def cube_gm_warnings(self, still: Hydrostatics) -> list[str]:
        """Warning if GM of the cubes differs from GM of the hull's faces by more than GM_TOLERANCE."""
        gm, own = still.metacentric_height(), self.gm_of_faces(still)
        if self.carried_as_body or own is None or abs(gm - own) <= GM_TOLERANCE * abs(own):
            return []
        than = f"GM of the ship's cubes is {gm:.3g} m, that of her hull {own:.3g} m"
        rows = f"{still.draught / float(still.voxels.size[1]):.2f} rows of cubes are under water"
        cure = f"{rows}: cells_per_draught that leave half a row dry may bring them together"
        if min(gm, own) <= 0.0:
            return [f"{than}; {cure}"]
        slower = sqrt(gm / own) - 1.0
        rolls = f"she rolls {abs(slower):.1%} {'faster' if slower > 0.0 else 'slower'} than it would"
        return [f"{than}: {rolls}; {cure}"]

    def warnings(self, preflight: Preflight) -> list[str]:
        hull = self.hydrostatics_of(preflight)
        mesh = self.whole_hull.shape.closed_mesh()
        remarks = [] if mesh is None else [f"the hull's mesh: {remark}" for remark in mesh.remarks]
        if mesh is not None and not isinf(hull.draught):
            remarks += mesh.unlike_a_ship(hull.draught, hull.kb)
        if isinf(hull.draught):
            return [*remarks, f"the ship weighs {hull.matter.mass:.4g} kg, more than its hull can carry: it sinks"]
        found = (
            remarks
            + super().warnings(preflight)
            + self.missing_water(preflight)
            + self.start_height_warnings(hull, preflight)
        )
        crew = Crew(self.controls)
        if self.propeller is None and (isinstance(self.controls, Autopilot) or crew.throttle.any()):
            found.append("controls: the throttle that they ask for has no effect: she has no propeller")
        if self.rudder is None and crew.rudder.any():
            found.append("controls: the rudder that they ask for has no effect: she has no rudder")
        if (
            self.helm is not None
            and self.propeller is not None
            and self.propeller.thrust_at(1.0, self.helm.speed) <= 0.0
        ):
            found.append(f"helm: asks for {self.helm.speed:g} m/s, at which her propeller gives no thrust")
        logged = [part.model_dump()["point"] for key, part in preflight.parts.items() if key == "motion"]
        if unasked := self.points.keys() - {"helm", *logged, *(mooring.fairlead for mooring in self.moorings)}:
            found.append(f"points: neither a mooring nor motion.point asks for {' or '.join(sorted(unasked))}")
        if any(preflight.fluid.steady_force):
            effect = "which it makes heavier or drives; the ship does not feel it"
            found.append(f"fluid.body_force acts on the water alone, {effect}")
        cells = hull.draught / float(hull.voxels.size[1])
        if cells < 0.9 * self.cells_per_draught:
            few = f"the hull has {cells:.2g} cubes over its draught"
            found.append(f"{few}, because only a little of its height is under water")
        if hull.metacentric_height() <= 0.0:
            found.append(f"the ship is unstable upright: GM = {hull.metacentric_height():.3g} m; it will heel")
        elif rest_angles(hull) is None:
            far = "her centre of mass lies too far from that of her buoyancy"
            found.append(f"within {MAX_LEAN:g} degrees of trim and heel the ship has no pose at rest: {far}")
        found += self.cube_gm_warnings(hull)
        if not preflight.fluid.made_of_particles and preflight.tank.depth < SHALLOW_DRAUGHTS * hull.draught:
            found.append(self.shallow_water_warning(hull, preflight.tank.depth))
        resistance = self.resistance(hull)
        if resistance is not None:
            found += [*resistance.warnings, *resistance.undamped_warnings(self.free)]
        spacing = preflight.spacing
        if spacing and hull.draught < RESOLVED_SPACINGS * spacing:
            message = f"the draught of {hull.draught:.3g} m is {hull.draught / spacing:.2g} spacings"
            found.append(f"{message}; below {RESOLVED_SPACINGS:g} the water does not resolve the ship")
        return found

    def ledger(self, preflight: Preflight) -> list[LedgerRow]:
        basin, word = preflight.tank, preflight.word
        n = len(self.in_still_water(-basin.gravity[1], WATER_DENSITY).voxels.share)
        lattice = preflight.fluid.window_bytes(preflight, (NODES_ALONG, NODES_ACROSS), DEPTH_LEVELS)
        size = Cubes.bytes(n, word) + (2 if self.drift else 1) * (SurroundingSea.bytes(word) + lattice)
        why = f"{self.cells_per_draught:g} cells_per_draught"
        rows = [LedgerRow("ship", f"{n} cubes of the hull", size, why)]
        solid = self.solid(preflight)
        if solid is not None:
            count, size = lattice_memory(solid.shape, solid.reach / SAG_RIM / CUBES_A_SPACING, solid.reach, word)
            rows.append(LedgerRow("ship", f"{count} distances from the hull", size, "ship.contact with particles"))
        return rows


def afloat_pose(still: Hydrostatics) -> tuple[float, np.ndarray]:
    """Height of the centre of mass [m] and quaternion (4,) of a ship at rest; upright without a balance, or awash."""
    if isinf(still.draught):
        return float(still.matter.centre[1] - still.voxels.centre[:, 1].max()), euler_quaternion(0.0, 0.0, 0.0)
    found = rest_angles(still)
    angle = np.zeros(2) if found is None else found
    turn = lean_matrix(angle)
    level = still.water_level(turn[1])
    return float((turn @ still.matter.centre)[1] - level), euler_quaternion(angle[0], 0.0, angle[1])


@lru_cache(maxsize=4)
def rest_angles(still: Hydrostatics) -> np.ndarray | None:
    """(2,) pitch and roll [rad] at which a floating hull balances, upright if it can; None if beyond MAX_LEAN."""

    def levers(angle: np.ndarray) -> np.ndarray:
        """(2,) distances [m] ahead and to port of buoyancy from the centre of mass; `angle`: pitch and roll [rad]."""
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
