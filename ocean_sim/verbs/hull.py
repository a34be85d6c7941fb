"""`ocean-sim hull`: is this a ship: watertight, volume, draught, stability, natural periods, and a picture."""

from math import isinf
from pathlib import Path
from typing import Any

from ocean_sim.conventions import GRAVITY, WATER_DENSITY
from ocean_sim.verbs.shared import console

HALF = 0.5  # of the water's density: what a hull without a mass is taken to weigh
EMPTY = dict.fromkeys(("volume_m3", "displacement_kg", "draught_m", "kb_m", "bm_m", "gm_m"))


def hull(name: str, mass: float | None, cells: float, out: Path | None, as_json: bool) -> int:
    """Describe a hull; the exit code is 2 where it is not one."""
    from ocean_sim.ship.shared.hull import explained, hull_of
    from ocean_sim.ship.shared.mesh import BadMesh

    try:
        shape = hull_of(name)
        found, notes = report(shape, mass, cells)
    except ValueError as error:
        problems = error.problems if isinstance(error, BadMesh) else [f"{name}: {explained(error)}"]
        if not as_json:
            raise console.Refused("\n".join(problems)) from None
        console.answer({"error": problems[0], **EMPTY, "gz": [], "periods_s": {}, "problems": problems})
        return 2
    picture = out or Path("runs/hull") / f"{Path(name).stem}.png" if out or not as_json else None
    if picture is not None:
        picture = picture if console.drawn(draw, picture, shape, found) else None
    if as_json:
        console.answer(found)
    else:
        show(name, found, notes, picture)
    return 0


def report(shape: Any, mass: float | None, cells: float) -> tuple[dict[str, Any], list[str]]:
    """What `hull` answers, and sentences for people."""
    from ocean_sim.ship.shared.added_mass import by_rule
    from ocean_sim.ship.shared.hull import COARSE
    from ocean_sim.ship.shared.hydrostatics import HEELS
    from ocean_sim.ship.shared.voxels import voxels

    notes, problems = [], []
    solid = shape.shape.closed() if shape.shape.is_mesh else None
    if solid is not None:
        from ocean_sim.ship.shared.mesh import guessed, read

        guess = guessed(read(Path(shape.shape.file)), shape.shape)
        notes.append(f"watertight, {len(solid.faces)} faces; {guess.sentence()}")
    weight = mass or shape.mass
    if weight is None:
        lower, upper = shape.shape.bounds()
        weight = HALF * WATER_DENSITY * voxels(shape.shape, float(upper[1] - lower[1]) / COARSE).volume
        notes.append(f"no mass is given: taken as {HALF:g} of the water's density (--mass sets another)")
    afloat = shape.model_copy(update={"mass": weight}).afloat(cells, WATER_DENSITY, GRAVITY)
    cubes = afloat.voxels
    if solid is not None:
        off = cubes.volume / solid.volume - 1.0
        notes.append(f"{len(cubes.share)} cubes of {cubes.size[1]:.3g} m hold {off:+.2%} of the mesh's volume more")
        if abs(off) > 0.02:
            problems.append(f"cubes of {cubes.size[1]:.3g} m miss the mesh's volume by {off:+.1%}; take more --cells")
    facts: dict[str, Any] = {"volume_m3": cubes.volume, "displacement_kg": weight}
    if isinf(afloat.draught):
        problems.append(
            f"{console.figures(weight)} kg is more than {console.figures(cubes.volume)} m3 can carry: it sinks"
        )
        return facts | {**EMPTY, **facts, "gz": [], "periods_s": {}, "problems": problems}, notes
    gm, kb = afloat.metacentric_height(), afloat.kb
    if gm <= 0.0:
        problems.append(f"unstable upright: GM = {gm:.3g} m")
    added = by_rule(afloat)
    extra = {"heave": added[1], "pitch": added[3], "roll": added[5]}
    kg = float(afloat.matter.centre[1]) - afloat.keel
    return facts | {
        "draught_m": afloat.draught,
        "kb_m": kb,
        "bm_m": gm + kg - kb,
        "gm_m": gm,
        "gm_longitudinal_m": afloat.metacentric_height(0),
        "kg_m": kg,
        "waterplane_m2": afloat.waterplane,
        "gz": [{"heel_deg": heel, "gz_m": afloat.gz(heel)} for heel in (0.0, *HEELS)],
        "periods_s": afloat.periods(extra),
        "dry_periods_s": afloat.periods(),
        "notes": notes,
        "problems": problems,
    }, notes


def show(name: str, found: dict[str, Any], notes: list[str], picture: Path | None) -> None:
    """What `hull` answers, for people."""
    console.say(name)
    for note in notes:
        console.say(note)
    units = {"m3": "m3", "kg": "kg", "m2": "m2", "m": "m"}
    rows = []
    for key, value in found.items():
        stem, _, unit = key.rpartition("_")
        if isinstance(value, float) and unit in units:
            rows.append([stem.replace("_", " "), f"{console.figures(value)} {units[unit]}"])
    for motion, period in found["periods_s"].items():
        shown = "none" if period is None else f"{period:.3g} s ({found['dry_periods_s'][motion]:.3g} s without water)"
        rows.append([f"{motion} period", shown])
    console.table("", ["", ""], rows)
    if found["gz"]:
        levers = [[f"{row['heel_deg']:g}", f"{round(row['gz_m'], 4) + 0.0:.4f}"] for row in found["gz"]]
        console.table("\nrighting lever", ["heel [deg]", "GZ [m]"], levers)
    for problem in found["problems"]:
        console.say(f"problem: {problem}")
    if picture is not None:
        console.say(str(picture))


def draw(path: Path, shape: Any, found: dict[str, Any]) -> None:
    """Three views of the hull with its waterline, and its righting lever."""
    import numpy as np
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    from ocean_sim.ship.shared.voxels import voxels

    lower, upper = shape.shape.bounds()
    cubes = voxels(shape.shape, float((upper - lower)[1]) / 24.0)
    figure = Figure(figsize=(11.0, 6.5), layout="constrained")
    FigureCanvasAgg(figure)
    names = ("x to port [m]", "y up [m]", "z to the bow [m]")
    for number, (across, up) in enumerate(((2, 1), (0, 1), (2, 0))):
        axes = figure.add_subplot(2, 2, number + 1)
        edges = [
            lower[a] + cubes.size[a] * np.arange(-1, (upper - lower)[a] / cubes.size[a] + 1.5) for a in (across, up)
        ]
        positions = cubes.centre[:, across], cubes.centre[:, up]
        image, *_ = np.histogram2d(*positions, bins=edges, weights=cubes.share)
        shown = np.where(image.T > 0.0, image.T, np.nan)
        axes.imshow(
            shown, origin="lower", extent=(*edges[0][[0, -1]], *edges[1][[0, -1]]), cmap="Greys", aspect="equal"
        )
        if up == 1 and found["draught_m"] is not None:
            axes.axhline(lower[1] + found["draught_m"], color="C0", linewidth=1.0)
        axes.set_xlabel(names[across])
        axes.set_ylabel(names[up])
    axes = figure.add_subplot(2, 2, 4)
    axes.plot([row["heel_deg"] for row in found["gz"]], [row["gz_m"] for row in found["gz"]], ".-")
    axes.axhline(0.0, color="black", linewidth=0.6)
    axes.set_xlabel("heel [deg]")
    axes.set_ylabel("GZ [m]")
    axes.grid(alpha=0.3)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=100)
