"""`ocean-sim hull`: watertightness, volume, draught, stability and natural periods of a hull, and a picture."""

import json
from collections.abc import Sequence
from dataclasses import replace
from math import asin, degrees, isinf, sqrt
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import typer

from ocean_sim.basin.solids.mesh import BadMesh
from ocean_sim.basin.solids.voxels import MISSED_SHARE, voxels
from ocean_sim.conventions import GRAVITY, WATER_DENSITY, AxisName, figures
from ocean_sim.files.atomic_file import new_figure, save_figure
from ocean_sim.files.yaml_file import read_mapping
from ocean_sim.parts import library, named
from ocean_sim.reading.scene import load, packaged_scenes
from ocean_sim.reading.translation import checked, likeliest
from ocean_sim.ship.body.floating import MAX_LEAN, FloatingConfig, lean_matrix, rest_angles
from ocean_sim.ship.forces.added_mass import by_rule
from ocean_sim.ship.forces.roll_damping import BilgeKeels, Ikeda, RollDamping
from ocean_sim.ship.hull.hull import CUBE_BUDGET, FIRST_GUESS_CUBES, MESH_ENDINGS, Hull, error_sentence, hull_of
from ocean_sim.ship.hull.shapes import MeshFile, drawn_mesh
from ocean_sim.ship.naval import hydrostatics
from ocean_sim.ship.naval.stability import CROSS_HEELS, LAST_HEEL, Loading, Stability
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.options import number_list

ASSUMED_DENSITY_RATIO = 0.5  # of the water's density: what a hull without a mass is taken to weigh
ROLL_AMPLITUDES_DEG = (5.0, 10.0, 20.0)  # [deg] amplitudes of roll
PICTURE_SUFFIXES = (".png", ".svg", ".pdf")  # as what a picture is written
SQUAT_FROUDE_NUMBERS = (0.2, 0.3, 0.4, 0.5, 0.6, 0.7)  # speeds over that of the fastest wave, for squat
BLOCK_FROUDE = 0.3  # speed over sqrt(g L) at full throttle of a ship to paste
GM_TITLES = {
    "gm": "GM in roll, by cubes",
    "gm_of_faces": "GM in roll, by faces",
    "gm_longitudinal": "GM in pitch, by cubes",
}
EMPTY_ANSWER = dict.fromkeys(("volume_m3", "displacement_kg", "draught_m", "kb_m", "bm_m", "gm_m"))


class HullOptions(NamedTuple):
    """Options of `ocean-sim hull`: mass, centre, density and others that change the hull or its description."""

    mass: float | None = None  # [kg]
    draught: float | None = None  # [m], in place of the mass
    kg: float | None = None  # [m] over the keel
    cg: Sequence[float] | None = None  # (3,) [m] from the hull's origin
    density: float = 0.0  # of the water [kg/m3]; 0 until the hull is found, with the water of its scene
    cells: float = 16.0  # cubes over the draught
    cross: bool = False  # cross curves, too
    bilge_keels: Sequence[float] | None = None  # length and breadth of each [m]
    depth: float | None = None  # of the water, for squat [m]
    up: AxisName | None = None  # axis of a mesh file that points up
    bow: AxisName | None = None  # axis of a mesh file that points to the bow
    scale: float | None = None  # metres per unit of a mesh file

    def require_consistent(self, loading: Path | None) -> None:
        """Raise Refused if an option is not finite, or mass or centre is given twice; `loading`: file of --loading."""
        for name, value in self._asdict().items():
            if name not in ("up", "bow") and not np.isfinite([] if value is None else value).all():
                raise console.Refused(f"--{name.replace('_', '-')}: expected finite numbers")
        weighs = {"--loading": loading, "--mass": self.mass, "--draught": self.draught}
        centred = {"--loading": loading, "--kg": self.kg, "--cg": self.cg}
        for what, options in (("what she weighs", weighs), ("where her centre of mass is", centred)):
            given = [name for name, value in options.items() if value is not None]
            if len(given) > 1:
                raise console.Refused(f"{' and '.join(given)} each say {what}; give one of them")


def hull(
    name: str = typer.Argument(help="The name of a hull, a ship or a scene; a scene file; or an STL, OBJ or PLY file."),
    mass: float | None = typer.Option(
        None, min=0.001, help="Mass of the whole ship [kg]; by default that of the hull."
    ),
    draught: float | None = typer.Option(None, min=0.0001, help="Draught [m], upright, instead of a mass."),
    kg: float | None = typer.Option(None, help="Height of the centre of mass above the keel [m]."),
    cg: str | None = typer.Option(None, help="Centre of mass X,Y,Z [m] from the keel amidships: to port, up, forward."),
    loading: Path | None = typer.Option(
        None,
        help="A loading condition (YAML): light: {mass: 250000, at: [0, 2.5, 0]}; weights, tanks, openings by name.",
    ),
    density: float | None = typer.Option(None, min=1.0, help="Density of the water [kg/m3]; by default 1000."),
    ship: str | None = typer.Option(None, help="Which ship, where a scene has several."),
    cross: bool = typer.Option(False, "--cross", help="Also print cross curves of stability."),
    bilge_keels: str | None = typer.Option(
        None, help="LENGTH,BREADTH of each bilge keel [m]: also print the damping of roll."
    ),
    depth: float | None = typer.Option(None, min=0.001, help="Depth of the water [m]: also print squat over speed."),
    cells: float = typer.Option(16.0, min=1.0, max=64.0, help="Number of cubes over the draught."),
    up: AxisName | None = typer.Option(
        None, help="Axis of a mesh file that points up, -z where z points down; else guessed."
    ),
    bow: AxisName | None = typer.Option(
        None, help="Axis of a mesh file that points to the bow; by default the longest."
    ),
    scale: float | None = typer.Option(
        None, min=1e-9, help="Metres per unit of a mesh file: 0.001 for millimetres; else guessed."
    ),
    out: Path | None = typer.Option(None, help="The picture; by default runs/hull/<name>.png, with --json none."),
) -> int:
    """Describe a hull; the exit code is 2 where it is not one."""
    at, keels = number_list("--cg", cg, "0,1.2,-0.3"), number_list("--bilge-keels", bilge_keels, "12,0.3")
    if keels is not None and min(keels) <= 0.0:
        raise console.Refused(f"--bilge-keels: {bilge_keels!r} is not like 12,0.3")
    asked = HullOptions(mass, draught, kg, at, density or 0.0, cells, cross, keels, depth, up, bow, scale)
    asked.require_consistent(loading)
    if out is not None and out.suffix.lower() not in PICTURE_SUFFIXES:
        ends = f"{', '.join(PICTURE_SUFFIXES[:-1])} or {PICTURE_SUFFIXES[-1]}"
        raise console.Refused(f"--out: {out} is no picture's name: end it in {ends}")
    condition = None if loading is None else checked(Loading, read_mapping(loading))
    try:
        shape, of_water, fitted = find_hull(name, ship, asked)
        asked = asked._replace(density=asked.density or of_water, bilge_keels=asked.bilge_keels or fitted)
        found, notes = hull_report(shape, asked, condition, name)
    except ValueError as error:
        if isinstance(error, console.Refused):
            raise
        problems = error.problems if isinstance(error, BadMesh) else [f"{name}: {error_sentence(error)}"]
        if not console.json_asked:
            raise console.Refused("\n".join(problems)) from None
        console.answer({"error": problems[0], **EMPTY_ANSWER, "gz": [], "periods_s": {}, "problems": problems})
        return 2
    picture = out or Path("runs/hull") / f"{Path(name).stem}.png" if out or not console.json_asked else None
    if picture is not None:
        picture = picture if console.draw_if_able(draw_hull, picture, shape, found) else None
    console.answer(found)
    print_report(name, found, notes, picture)
    return 0


def find_hull(name: str, ship: str | None, asked: HullOptions) -> tuple[Hull, float, tuple[float, float] | None]:
    """Hull called `name` (in configs/hull/ or configs/ship/, a mesh file, or of `ship` in a scene), density of its
    water [kg/m3], and length and breadth of its bilge keels [m] or None. Raises ValueError, SceneError or Refused."""
    scene = Path(name).suffix in (".yaml", ".yml") or (library("scenes") / f"{name}.yaml").is_file()
    if ship is not None and not scene:
        raise console.Refused(f"--ship names one of the ships of a scene, and {name} is none")
    is_file = Path(name).suffix.lower() in MESH_ENDINGS
    given = [f"--{key}" for key in ("up", "bow", "scale") if getattr(asked, key) is not None]
    if given and not is_file:
        raise console.Refused(f"{', '.join(given)} say how a mesh file is read, and {name} is none")
    if name in named("hull") or is_file:
        return hull_of(name, asked.up, asked.bow, asked.scale), WATER_DENSITY, None

    if not scene and name not in named("ship"):
        hulls, ships = ", ".join(named("hull")), ", ".join(named("ship"))
        meant = likeliest(name, dict.fromkeys([*named("hull"), *named("ship"), *packaged_scenes()]))
        there = f"; there are the hulls {hulls}, and those of the ships {ships}"
        begin = f"there is no hull {name!r}, and it is neither a scene nor a {', '.join(MESH_ENDINGS)} file"
        raise console.Refused(f"{begin}{there if meant is None else f'; did you mean {meant!r}?'}")
    if scene:
        config = load(name)
    else:
        flat: dict[str, Any] = {"kind": "linear_waves", "height": 0.0, "period": 10.0}
        config = load({"basin": {"length": 1e4, "width": 1e4, "depth": 1e3}, "fluid": flat, "ship": name})
    floating = {key: part for key, part in config.ships.items() if isinstance(part, FloatingConfig)}
    if not floating:
        raise console.Refused(f"{name} has no ship that floats by the volume of a hull")
    if ship is None and len(floating) > 1:
        raise console.Refused(f"{name} has several ships; name one with --ship: {', '.join(floating)}")
    if ship is not None and ship not in floating:
        raise console.Refused(f"--ship: there is no {ship!r} with a hull; there are {', '.join(floating)}")
    chosen = floating[ship] if ship is not None else next(iter(floating.values()))
    resistance = chosen.resistance(chosen.in_still_water(GRAVITY, config.fluid.rest_density))
    keels = None if resistance is None or resistance.rolling is None else resistance.rolling.keels
    return chosen.whole_hull, config.fluid.rest_density, None if keels is None else (keels.length, keels.breadth)


def load_ship(shape: Hull, asked: HullOptions, condition: Loading | None, notes: list[str]) -> Hull:
    """Copy of a hull with mass and centre of mass by options or loading condition; `notes` gets those assumed."""
    mass, centre = asked.mass or shape.mass, shape.centre_of_mass
    lower, upper = shape.shape.bounds()
    keel, height = float(lower[1]), float(upper[1] - lower[1])
    if condition is not None:
        mass, at = condition.matter
        centre = (float(at[0]), float(at[1]), float(at[2]))
    if asked.draught is not None:
        mass = mass_at_draught(shape, asked)
        notes.append(f"at a draught of {asked.draught:g} m it carries {mass:.5g} kg")
    if mass is None:
        mass = ASSUMED_DENSITY_RATIO * asked.density * voxels(shape.shape, height / FIRST_GUESS_CUBES).volume
        assumed = f"{ASSUMED_DENSITY_RATIO:g} of the water's density"
        notes.append(f"no mass is given: taken as {assumed} (--mass sets another)")
    if asked.cg is not None:
        centre = asked.cg[0], asked.cg[1], asked.cg[2]
    if asked.kg is not None:
        x, _, z = centre or voxels(shape.shape, height / 24.0).centroid.tolist()
        centre = (x, keel + asked.kg, z)
    if centre is None:
        notes.append("no centre of mass is given: that of a hull of uniform density (--kg or --cg set another)")
    return shape.model_copy(update={"mass": mass, "centre_of_mass": centre})


def mass_at_draught(shape: Hull, asked: HullOptions) -> float:
    """Mass [kg] of the water displaced by the upright hull at the draught in the options; raises Refused."""
    assert asked.draught is not None
    height = float(np.ptp(shape.shape.bounds(), axis=0)[1])
    if not asked.draught < height:
        raise console.Refused(f"--draught: the hull is {height:g} m high, less than the draught")
    some = shape.model_copy(update={"mass": 1.0})
    still = some.in_cubes(max(asked.draught / asked.cells, some.smallest_side), asked.density, GRAVITY, 1.0)
    return asked.density * float(still.wet_volumes(hydrostatics.UPRIGHT, still.keel + asked.draught).sum())


def hull_report(
    shape: Hull, asked: HullOptions, condition: Loading | None, name: str
) -> tuple[dict[str, Any], list[str]]:
    """Facts of the hull `name` in its loading condition as JSON data, and the notes among them, a list of sentences."""
    notes: list[str] = []
    problems: list[str] = []
    solid = shape.shape.closed_mesh()
    if solid is not None:
        notes += [solid.size_sentence(), *solid.remarks]
    afloat = load_ship(shape, asked, condition, notes).in_still_water(asked.cells, asked.density, GRAVITY)
    notes += outlying_parts(shape, afloat, condition)
    cubes, weight = afloat.voxels, afloat.matter.mass
    if solid is not None:
        off = cubes.volume / solid.volume - 1.0
        notes.append(f"{len(cubes.share)} cubes of {cubes.size[1]:.3g} m differ from the mesh's volume by {off:+.2%}")
        if abs(off) > MISSED_SHARE:
            problems.append(f"cubes of {cubes.size[1]:.3g} m miss the mesh's volume by {off:+.1%}; take more --cells")
    facts: dict[str, Any] = {"volume_m3": cubes.volume, "displacement_kg": weight}
    if isinf(afloat.draught):
        problems.append(f"{figures(weight)} kg is more than {figures(cubes.volume)} m3 can carry: it sinks")
        return facts | {**EMPTY_ANSWER, **facts, "gz": [], "periods_s": {}, "notes": notes, "problems": problems}, notes
    resolved = afloat.draught / float(cubes.size[1])
    if resolved < 0.9 * asked.cells:
        most = f"no more than {CUBE_BUDGET:g} cubes are made"
        notes.append(f"{resolved:.3g} cubes over the draught, not {asked.cells:g}: {most}")
    if condition is not None:
        afloat = replace(afloat, free_surface_loss=condition.free_surface_loss)
    notes += [] if solid is None else solid.unlike_a_ship(afloat.draught, afloat.kb)
    stability = Stability(afloat, None if condition is None else condition.openings)
    problems += stability_problems(stability)
    damped, beyond = roll_damping_rows(afloat, asked)
    sunk, blunt = squat_rows(afloat, asked.depth)
    notes += [*beyond, *blunt]
    found = balance_facts(afloat, stability, asked.cross) | {"roll_damping": damped, "squat": sunk}
    found["scene"] = ship_block(name, shape, afloat, asked)
    return facts | found | {"notes": notes, "problems": problems}, notes


def ship_block(name: str, shape: Hull, afloat: hydrostatics.Hydrostatics, asked: HullOptions) -> str:
    """YAML of a ship with this hull, called `name`, with propeller and rudder by rule; empty if a scene has her.

    The propeller at full throttle reaches a Froude number of BLOCK_FROUDE against the resistance by rule. The rudder is
    half as large again as the least area of DNV (1975), T L / 100 (1 + 25 (B / L)^2)."""
    solid = shape.shape
    if not isinstance(solid, MeshFile) and name not in named("hull"):
        return ""
    length, draught, (stern, _) = afloat.length, afloat.draught, afloat.waterline_ends
    speed, breadth = BLOCK_FROUDE * sqrt(GRAVITY * length), afloat.waterplane / length
    thrust = 0.05 * afloat.density * float(afloat.section_areas.max()) * speed**2
    area = 0.015 * draught * length * (1.0 + 25.0 * (breadth / length) ** 2)
    keels = asked.bilge_keels
    ikeda = "{}" if keels is None else f"{{bilge_keels: {{length: {keels[0]:g}, breadth: {keels[1]:g}}}}}"
    read = solid.model_dump(exclude_none=True) if isinstance(solid, MeshFile) else {}
    mesh = ", ".join(f"{key}: {json.dumps(value)}" for key, value in read.items())
    centre = ", ".join(f"{round(value, 4) + 0.0:g}" for value in afloat.matter.centre.tolist())
    return f"""ship:
  kind: dynamic
  hull: {f"{{shape: {{{mesh}}}}}" if mesh else name}
  mass: {afloat.matter.mass:.6g}  # [kg]
  centre_of_mass: [{centre}]  # [m] from the keel amidships: to port, up, forward
  damping: {{ikeda: {ikeda}}}  # roll by the form of her hull; heave and pitch by rule
  propeller: {{thrust: {thrust:.4g}, diameter: {0.6 * draught:.3g}}}  # by rule, for {speed:.3g} m/s at full throttle
  rudder: {{area: {area:.3g}, position: [0.0, {0.4 * draught:.3g}, {stern:.3g}]}}  # by rule
  controls: [{{time: 0.0, throttle: 0.6}}]"""


def outlying_parts(shape: Hull, afloat: hydrostatics.Hydrostatics, condition: Loading | None) -> list[str]:
    """Sentences on weights, openings (of a loading condition) and centre of mass that lie outside the hull."""
    lower, upper = (np.array(corner) for corner in shape.shape.bounds())
    centre, found = afloat.matter.centre, [] if condition is None else [*condition.outside_hull(lower, upper)]
    if (np.maximum(lower - centre, centre - upper) > 0.0).any():
        box = ", ".join(f"{a + 0.0:.3g} to {b:.3g}" for a, b in zip(lower, upper))
        at = ", ".join(f"{value:.3g}" for value in centre)
        found.append(f"her centre of mass, ({at}) m, lies outside the hull, which takes {box} m along x, y and z")
    return found


def stability_problems(stability: Stability) -> list[str]:
    """Sentences on why a ship does not float upright at rest: unstable, no equilibrium, flooded. Empty if she does."""
    found = []
    if stability.gm <= 0.0:
        ends = "no lever rights her" if stability.rest_heel is None else f"she lolls to {stability.rest_heel:.1f} deg"
        found.append(f"unstable upright: GM = {stability.gm:.3g} m; {ends}")
    elif rest_angles(stability.still) is None:
        never = f"within {MAX_LEAN:g} degrees of trim and heel she has no pose at rest"
        found.append(f"{never}: her centre of mass is too far out")
    angle, opening = stability.flooding_heel
    if angle == 0.0:
        found.append(f"water comes in upright: openings.{opening} lies under the water")
    return found


def roll_damping_rows(
    afloat: hydrostatics.Hydrostatics, asked: HullOptions
) -> tuple[list[dict[str, float]], list[str]]:
    """Roll damping by Ikeda's components as shares of critical, a row per amplitude; warnings if out of its range."""
    keels = None if asked.bilge_keels is None else BilgeKeels(length=asked.bilge_keels[0], breadth=asked.bilge_keels[1])
    if keels is not None and keels.length > afloat.length:
        long = f"{keels.length:g} m are longer than her waterline of {afloat.length:.3g} m"
        raise console.Refused(f"--bilge-keels: {long}")
    found = RollDamping(Ikeda(bilge_keels=keels), afloat, float(by_rule(afloat)[5]), True)
    if not found.parts:
        return [], []
    scale = found.scale / found.critical
    rows = []
    for a in ROLL_AMPLITUDES_DEG:
        shares = {part: scale * b for part, b in found.parts[a]._asdict().items()}
        rows.append({"amplitude_deg": a, **shares, "sum": found.critical_share(a)})
    return rows, found.warnings


def squat_rows(afloat: hydrostatics.Hydrostatics, depth: float | None) -> tuple[list[dict[str, float]], list[str]]:
    """Squat in water of `depth` [m], a row per Froude number, and warnings; empty without a depth. Raises Refused."""
    if depth is None:
        return [], []
    if depth <= afloat.draught:
        raise console.Refused(f"--depth: she draws {afloat.draught:.3g} m, more than the water has")
    law, rows = hydrostatics.slender_squat(afloat), []
    names = ("froude", "speed_m_s", "sinkage_m", "trim_deg", "bow_m", "under_keel_m")
    for froude in SQUAT_FROUDE_NUMBERS:
        speed = froude * sqrt(GRAVITY * depth)
        at = law.at_speed(speed, depth)
        bow = hydrostatics.bow_squat(afloat.needed_volume, afloat.length, speed, depth)
        under_keel = depth - afloat.draught - max(bow, at.end_sinkage)
        rows.append(dict(zip(names, (froude, speed, at.sinkage, degrees(at.trim), bow, under_keel))))
    blunt = "squat: sinkage and trim are of a slender hull; her ends are blunt, and they grow slowly with --cells"
    return rows, [blunt] if law.blunt else []


def balance_facts(afloat: hydrostatics.Hydrostatics, stability: Stability, cross: bool) -> dict[str, Any]:
    """Draught, GM, trim, righting levers, criteria and natural periods as JSON data; `cross`: also cross curves."""
    kb = afloat.kb
    kg = float(afloat.matter.centre[1]) - afloat.keel
    heels = [0.0, *hydrostatics.LEVER_HEELS]
    by_heel = dict(zip(stability.heels.tolist(), stability.levers.tolist()))
    levers = [by_heel[heel] for heel in heels]
    angle, opening = stability.flooding_heel
    found: dict[str, Any] = {
        "draught_m": afloat.draught,
        **balance_at_rest(afloat),
        "kb_m": kb,
        "bm_m": stability.gm + afloat.free_surface_loss[0] + kg - kb,
        "gm_m": stability.gm,
        "gm_of_faces_m": afloat.gm_of_faces,
        "gm_longitudinal_m": afloat.metacentric_height(0),
        "kg_m": kg,
        "free_surface_m": afloat.free_surface_loss[0],
        "waterplane_m2": afloat.waterplane,
        "gz_to": "port" if stability.heeling_side < 0.0 else "starboard",
        "gz": [{"heel_deg": heel, "gz_m": lever} for heel, lever in zip(heels, levers)],
        "vanishing_deg": stability.vanishing_heel,
        "flooding_deg": None if isinf(angle) else angle,
        "flooding_at": opening or None,
        "criteria": [{**row._asdict(), "ok": row.ok} for row in stability.criteria],
        "periods_s": afloat.periods(by_rule(afloat)),
        "dry_periods_s": afloat.periods(np.zeros(6)),
    }
    if cross:
        found["cross"] = [
            {"displacement_kg": mass, "kn": [{"heel_deg": h, "kn_m": kn} for h, kn in zip(CROSS_HEELS, levers)]}
            for mass, levers in stability.cross_curves().items()
        ]
    return found


def balance_at_rest(afloat: hydrostatics.Hydrostatics) -> dict[str, float | None]:
    """Draughts fore, aft [m], trim (bow down > 0), heel (starboard down > 0) [deg]; None without equilibrium."""
    angles, names = rest_angles(afloat), ("draught_fore_m", "draught_aft_m", "trim_deg", "heel_deg")
    if angles is None:
        return dict.fromkeys(names)
    up = lean_matrix(angles)[1]
    level, (stern, bow) = afloat.water_level(up), afloat.waterline_ends
    ends = [(level - up[2] * end) / up[1] - afloat.keel for end in (bow, stern)]
    trim, heel = (round(degrees(asin(float(tilt))), 9) + 0.0 for tilt in (-up[2], up[0]))
    return dict(zip(names, [*map(float, ends), trim, heel]))  # bow down, starboard down


def print_report(name: str, found: dict[str, Any], notes: list[str], picture: Path | None) -> None:
    console.say(name)
    for note in notes:
        console.say(note)
    sides = {"trim_deg": ("by the stern", "by the bow"), "heel_deg": ("to port", "to starboard")}
    rows = []
    for key, value in found.items():
        stem, _, unit = key.rpartition("_")
        if isinstance(value, float) and unit in ("m3", "kg", "m2", "m", "deg"):
            where = f", {found['flooding_at']}" if key == "flooding_deg" else ""
            where += " or more" if key == "vanishing_deg" and value == LAST_HEEL else ""
            if key in sides and value != 0.0:
                where, value = f" {sides[key][value > 0.0]}", abs(value)
            rows.append([GM_TITLES.get(stem, stem.replace("_", " ")), f"{figures(value)} {unit}{where}"])
    for motion, period in found["periods_s"].items():
        shown = "none" if period is None else f"{period:.3g} s ({found['dry_periods_s'][motion]:.3g} s without water)"
        rows.append([f"{motion} period", shown])
    console.table("", ["", ""], rows)
    if found["gz"]:
        levers = [[f"{row['heel_deg']:g}", f"{round(row['gz_m'], 4) + 0.0:.4f}"] for row in found["gz"]]
        heads = [f"heel to {found['gz_to']} [deg]", "GZ [m]"]
        console.table("\nrighting lever, on even keel", heads, levers)
        asked = [
            [row["name"], f"{row['value']:.4g} {row['unit']}", f"{row['least']:g}", "yes" if row["ok"] else "no"]
            for row in found["criteria"]
        ]
        console.table("\nIMO A.749(18), 3.1.2", ["", "", "at least", "met"], asked)
    if found.get("roll_damping"):
        heads = ["amplitude [deg]", *(part.replace("_", " ") for part in list(found["roll_damping"][0])[1:])]
        rows = [
            [f"{angle:g}", *(f"{100.0 * share:.3f}" for share in shares)]
            for angle, *shares in (row.values() for row in found["roll_damping"])
        ]
        console.table("\nroll damping at rest, % of critical (Kawahara, Maekawa & Ikeda 2012)", heads, rows)
    if found.get("squat"):
        heads = ["U / sqrt(g h)", "speed [m/s]", "sinkage [m]", "trim, bow down [deg]", "bow [m]", "under the keel [m]"]
        rows = [[f"{round(value, 5) + 0.0:.3g}" for value in row.values()] for row in found["squat"]]
        title = "\nsquat: sinkage and trim of a slender hull (Tuck 1966); bow at most (ICORELS 1980)"
        console.table(title, heads, rows)
    if found.get("cross"):
        heads = ["kg", *(f"{row['heel_deg']:g} deg" for row in found["cross"][0]["kn"])]
        rows = [[f"{c['displacement_kg']:.5g}", *(f"{row['kn_m']:.4f}" for row in c["kn"])] for c in found["cross"]]
        console.table("\ncross curves KN [m]", heads, rows)
    for problem in found["problems"]:
        console.say(f"problem: {problem}")
    if found.get("scene"):
        console.say(f"\nto paste into a scene:\n\n{found['scene']}\n")
    if picture is not None:
        console.say(str(picture))


def draw_hull(path: Path, shape: Hull, found: dict[str, Any]) -> None:
    """Draw righting levers, from the facts `found` of a hull, and her lines with the waterline, into a picture file."""
    from matplotlib.collections import LineCollection
    from trimesh import Trimesh
    from trimesh.intersections import mesh_plane

    (lower, upper), solid = shape.shape.bounds(), Trimesh(*drawn_mesh(shape.shape), process=False)
    figure = new_figure(11.7, 7.6)
    grid = figure.add_gridspec(2, 2, width_ratios=(3, 2), height_ratios=(5, 2))
    curve, body, profile, plan = (figure.add_subplot(grid[place]) for place in np.ndindex(2, 2))
    heels, levers = ([row[key] for row in found["gz"]] for key in ("heel_deg", "gz_m"))
    curve.plot(heels, levers, ".-", linewidth=1.8, label="GZ on even keel")
    top = 1.15 * max([*levers, 0.01])
    if heels:
        curve.plot([0.0, degrees(1.0)], [0.0, found["gm_m"]], "--", linewidth=0.9, label=f"GM {found['gm_m']:.3g} m")
        top = max(top, min(1.05 * found["gm_m"], 1.5 * top))
        curve.legend()
    curve.axhline(0.0, color="black", linewidth=0.6)
    at = f"draught {found['draught_m']:.3g} m, KG {found['kg_m']:.3g} m" if heels else "she sinks"
    curve.set(xlabel=f"heel to {found.get('gz_to', 'a side')} [deg]", ylabel="GZ [m]")
    curve.set_title(f"{figures(found['displacement_kg'])} kg, {at}")
    curve.set(xlim=(0.0, LAST_HEEL), ylim=(min([*levers, 0.0]), top))
    curve.grid(alpha=0.3)
    names = ("x to port [m]", "y up [m]", "z to the bow [m]")
    views = (plan, "waterlines", 1, 7), (body, "body plan: bow right, stern left", 2, 21), (profile, "buttocks", 0, 6)
    for axes, title, normal, count in views:
        across, up = (2, 0) if normal == 1 else (0, 1) if normal == 2 else (2, 1)
        first = 0.0 if normal == 0 else lower[normal]
        cuts = first + (upper[normal] - first) * np.arange(1e-3 if normal else 0.0, 1.0, 1.0 / (count - 1))
        for cut in cuts:
            lines = mesh_plane(solid, np.eye(3)[normal], cut * np.eye(3)[normal])[:, :, [across, up]]
            if normal == 2:  # half of each section
                side = -1.0 if cut < 0.5 * (lower + upper)[2] else 1.0
                lines = np.maximum(lines[lines[:, :, 0].max(axis=1) > 0.0], [0.0, -np.inf]) * [side, 1.0]
            axes.add_collection(LineCollection(list(lines), colors="0.35", linewidths=0.7))
        if up == 1 and found["draught_m"] is not None:
            axes.axhline(lower[1] + found["draught_m"], color="C0", linewidth=1.0)
        label = names[across] if normal != 2 else "half breadth [m]"
        axes.set(title=title, xlabel=label, ylabel=names[up], aspect="equal")
        axes.autoscale_view()
    save_figure(figure, path)
