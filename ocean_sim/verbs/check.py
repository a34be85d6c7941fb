"""`ocean-sim check`: memory, time step and time of a scene, before anything is allocated."""

from math import isinf
from typing import Any

import typer

from ocean_sim import machine, runtime
from ocean_sim.conventions import figures
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.parts import LedgerRow, called
from ocean_sim.reading.scene import SceneConfig, load
from ocean_sim.simulation import Simulation
from ocean_sim.time_step.courant import Config as Courant
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.history import keep_step_time, step_time
from ocean_sim.verbs.shared.options import Profile, Scene, Sets
from ocean_sim.verbs.shared.progress import kernel_notice

WATER_FACTS = ("particles", "memory_mb", "pictures_mb", "bytes_a_particle", "most_particles", "time_step", "limited_by")
UNKNOWN_FACTS = dict.fromkeys((*WATER_FACTS, "estimated_wall_s"))
CARD_BYTES = 16e9  # memory of a graphics card, which cannot be asked for its own before it is started
FEW_PARTICLES = 20_000  # below which most memory of the water does not go with their number
STABLE_COURANT = 0.8  # the courant number of the profiles `ci` and `interactive`, up to which steps were found stable


def check(
    scene: Scene,
    profile: Profile = None,
    sets: Sets = None,
    time: bool = typer.Option(False, "--time", help="Take some steps first, to estimate the wall time."),
) -> None:
    """Report the memory, time step and wall time that a scene needs, and its problems."""
    try:
        config = load(scene, console.set_values(sets), profile)
    except SceneError as error:
        if not console.json_asked:
            raise
        problems = [problem._asdict() for problem in error.problems]
        wrong = {"ok": False, "error": console.problem_count(problems), "problems": problems, "warnings": []}
        console.answer(wrong | UNKNOWN_FACTS | {"ledger": []})
        raise typer.Exit(2) from None
    if time:
        console.must_compute_with(config.runtime.library)
        console.say(kernel_notice())
        from ocean_sim.observers.timings import synchronization
        from ocean_sim.verbs.bench import time_block

        with Simulation(config) as simulation:
            simulation.step()  # it compiles kernels
            steps, wall, _, _ = time_block(simulation, synchronization(simulation.backend.arch))
        keep_step_time(config, wall / steps)
    found = preflight(config)
    console.answer(found | {"ledger": ledger_rows(found, config)})
    print_preflight(found, config)


def preflight(config: SceneConfig) -> dict[str, Any]:
    """Facts of a scene as JSON data: particles, memory, time step, wall time, ships, warnings."""
    known, rows, warnings = config.preflight, config.ledger(), config.warnings()
    particles = known.particles
    memory = runtime.base_memory(particles) + sum(row.bytes for row in rows)
    time_step = config.time_step.build()
    still = config.fluid.still_limits(known)
    dt = time_step.next(still)
    stable, limit = Courant().longest_step(still)
    longest, ruling = Courant(courant_number=STABLE_COURANT).longest_step(still)
    if dt > 1.05 * longest:
        over = f"{dt / longest:.2g} times the {longest:.3g} s that stayed stable in still water ({ruling} limit)"
        warnings.append(f"the time step of {dt:.3g} s is {over}")
    if memory > 0.9 * machine.memory_limit():
        has = f"this machine has {machine.memory_limit() / 1e9:.1f} GB"
        warnings.append(f"needs {memory / 1e9:.1f} GB of memory; {has}")
    (each, is_measured), pictures = step_time(config), picture_time(config)
    steps = each * config.duration / dt
    return {
        "ok": True,
        "problems": [],
        "warnings": warnings,
        "notes": config.notes,
        "statements": config.fluid.statements(known),
        "particles": particles,
        "memory_mb": memory / 1e6,
        "pictures_mb": sum(row.bytes for row in rows if row.part in config.observers) / 1e6,
        **particle_room(config, rows, particles),
        "time_step": dt,
        "limited_by": time_step.limited_by,
        "stable_time_step": stable,
        "stable_limited_by": limit,
        "estimated_wall_s": steps + pictures,
        "estimate_is_measured": is_measured,
        "estimated_by_part": {"steps_s": steps, "pictures_s": pictures},
        "ships": ship_facts(config),
        "ledger": rows,
    }


def picture_time(config: SceneConfig) -> float:
    """Estimated wall time [s] to draw all pictures of a run on an idle machine."""
    return sum(part.picture_time(config.preflight) for part in config.observers.values())


def particle_room(config: SceneConfig, rows: list[LedgerRow], particles: int) -> dict[str, int | None]:
    """Bytes per particle, and number of particles that fits into memory, by ledger `rows`; None without particles."""
    if not particles:
        return {"bytes_a_particle": None, "most_particles": None}
    water = sum(row.bytes for row in rows if row.part == "fluid")
    watched = sum(row.bytes for row in rows if row.part in config.observers)
    others = sum(row.bytes for row in rows) - water - watched
    each = -(-water // particles)
    free, taken = CARD_BYTES - others, each
    if config.runtime.arch not in runtime.GRAPHICS_CARD_CHOICES:
        seen = sum(part.bytes_a_particle(config.preflight) for part in config.observers.values())
        free = 0.9 * machine.memory_limit() - others - (watched - seen * particles) - runtime.BASE_MEMORY
        taken = each + runtime.COPY_BYTES_PER_PARTICLE + seen
    most = min(int(free / taken), config.fluid.most_particles(config.preflight))
    return {"bytes_a_particle": each, "most_particles": max(0, most)}


def ship_facts(config: SceneConfig) -> dict[str, dict[str, Any]]:
    """Displacement, draught, metacentric heights and natural periods of each ship with a hull, by her name."""
    found = {name: ship.floats(config.preflight) for name, ship in config.ships.items()}
    spacing = config.preflight.spacing
    return {
        name: {
            "displacement_kg": each.displacement,
            "draught_m": None if isinf(each.draught) else each.draught,
            "draught_spacings": None if isinf(each.draught) or not spacing else each.draught / spacing,
            "gm_m": each.gm,
            "gm_longitudinal_m": each.gm_longitudinal,
            "gm_of_faces_m": each.gm_of_faces,
            "periods_s": each.periods,
        }
        for name, each in found.items()
        if each is not None
    }


def resolves(spacings: float) -> str:
    """Say whether water of particles resolves a ship with so many spacings in her draught."""
    from ocean_sim.ship.body.floating import RESOLVED_SPACINGS

    return "the water resolves her" if spacings >= RESOLVED_SPACINGS else "the water does not resolve her"


def ledger_rows(found: dict[str, Any], config: SceneConfig) -> list[dict[str, Any]]:
    """Memory ledger of `preflight` (`found`) as dicts; the first row of a part lists the kernels of the whole part."""
    parts, listed, rows = {"basin": config.basin} | config.parts(), set(), []
    for row in found["ledger"]:
        kernels = None if row.part in listed else runtime.kernels_in(type(parts[row.part]).__module__)
        listed.add(row.part)
        rows.append(row._asdict() | {"kernels": kernels})
    return rows


def wall_time(found: dict[str, Any], config: SceneConfig) -> str:
    """Estimated wall time of a run in words, and its basis: a guess, or the last run of such water on this machine."""
    parts = found["estimated_by_part"]
    shown = {"steps": parts["steps_s"], "pictures": parts["pictures_s"]}
    terms = ", ".join(f"{name} {console.duration(seconds)}" for name, seconds in shown.items() if seconds)
    about = f"about {console.duration(found['estimated_wall_s'])} for {config.duration:g} s ({terms})"
    water = f"{config.fluid.kind} in {config.preflight.tank.dimension}-D"
    if not found["estimate_is_measured"]:
        return f"{about}: a guess until {water} has run on this machine, or `check --time` takes some steps"
    return f"{about}, by the last run of {water} on this machine"


def memory_taken(found: dict[str, Any]) -> str:
    """Memory of a run in words, from the facts `found` of `preflight`, with the part of it that pictures take."""
    pictures = f" ({found['pictures_mb']:.0f} of them for pictures)" if found["pictures_mb"] else ""
    return f"{found['memory_mb']:.0f} MB{pictures}"


def room_sentence(found: dict[str, Any], config: SceneConfig) -> str:
    """Memory per particle and the number of particles that fits, in words, from the facts `found` of `preflight`."""
    if found["bytes_a_particle"] is None:
        return "no particles"
    where = f"the {machine.memory_limit() / 1e9:.1f} GB of this machine"
    if config.runtime.arch in runtime.GRAPHICS_CARD_CHOICES:
        where = f"{CARD_BYTES / 1e9:.0f} GB of a graphics card"
    fit = f"{found['most_particles'] / 1e6:.2g} million particles fit into {where}"
    if found["particles"] < FEW_PARTICLES:
        return f"at least {fit}"
    return f"{found['bytes_a_particle']} bytes a particle: {fit}"


def preflight_lines(found: dict[str, Any], config: SceneConfig) -> str:
    """Main facts, notes and warnings of `preflight` (`found`), as the text that `run` prints first."""
    lines = [
        f"{config.title or 'untitled'}: {found['particles']} particles, {memory_taken(found)}, "
        f"time step {found['time_step']:.3g} s in still water ({found['limited_by']}), "
        f"wall time {wall_time(found, config)}"
    ]
    lines += [f"note: {note}" for note in found["notes"]]
    return "\n".join([*lines, *(f"warning: {warning}" for warning in found["warnings"])])


def print_preflight(found: dict[str, Any], config: SceneConfig) -> None:
    console.say(config.title or "untitled")
    console.table(
        "",
        ["", ""],
        [
            ["particles", f"{found['particles']}"],
            ["memory", f"about {memory_taken(found)} at the peak"],
            ["room", room_sentence(found, config)],
            ["time step", f"{found['time_step']:.4g} s in still water, limited by: {found['limited_by']}"],
            ["stable", f"{found['stable_time_step']:.4g} s in still water, limited by: {found['stable_limited_by']}"],
            ["wall time", wall_time(found, config)],
        ],
    )
    rows = []
    for row in ledger_rows(found, config):
        kernels = "" if row["kernels"] is None else f"{len(row['kernels'])}"
        rows.append([row["part"], row["what"], f"{row['bytes'] / 1e6:.2f}", kernels, row["why"]])
    heads = ["part", "fields", "MB", "kernels", "why"]
    console.table("\nwhat is allocated and compiled (kernels: at most), and why", heads, rows)
    console.say()
    for name, ship in found["ships"].items():
        if ship["draught_m"] is not None:
            periods = ", ".join(f"{motion} {t:.3g} s" for motion, t in ship["periods_s"].items() if t is not None)
            own = ship["gm_of_faces_m"]
            faces = "" if own is None else f" (by the faces of her hull {own:.3g} m)"
            across = ship["draught_spacings"]
            draught = f"draught {ship['draught_m']:.3g} m"
            if across is not None:
                draught += f" ({across:.3g} spacings: {resolves(across)})"
            console.say(
                f"{called(name)}: {figures(ship['displacement_kg'])} kg, {draught}, "
                f"GM {ship['gm_m']:.3g} m{faces}, longitudinal GM {ship['gm_longitudinal_m']:.3g} m; "
                f"natural periods: {periods}"
            )
    for sentence in found["statements"]:
        console.say(sentence)
    for note in found["notes"]:
        console.say(f"note: {note}")
    for warning in found["warnings"]:
        console.say(f"warning: {warning}")
    console.say("the scene is in order")
