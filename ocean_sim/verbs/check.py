"""`ocean-sim check`: validity, wall time, memory and warnings of a scene, before anything is allocated."""

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
from ocean_sim.verbs.shared.history import keep_run_times, picture_ratio, run_times
from ocean_sim.verbs.shared.options import Profile, Scene, Sets
from ocean_sim.verbs.shared.progress import Progress, kernel_notice

WATER_FACTS = ("particles", "memory_mb", "pictures_mb", "bytes_a_particle", "most_particles", "time_step", "limited_by")
UNKNOWN_FACTS = dict.fromkeys((*WATER_FACTS, "estimated_wall_s"))
CARD_BYTES = 16e9  # memory of a graphics card, which cannot be asked for its own before it is started
STABLE_COURANT = 0.8  # the courant number of the profiles `ci` and `interactive`, up to which steps were found stable


def check(
    scene: Scene,
    profile: Profile = None,
    sets: Sets = None,
    time: bool = typer.Option(False, "--time", help="Take some steps first, to estimate the wall time."),
    ledger: bool = typer.Option(False, "--ledger", help="Also print the table of memory and kernels, part by part."),
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
        progress = Progress(config.duration, quiet=True)
        with Simulation(config) as simulation:
            while progress.step_time is None:
                simulation.step()
                progress.observe(simulation)
        keep_run_times(config, progress)
    found = preflight(config)
    rows = ledger_rows(found, config) if ledger or console.json_asked else []
    console.answer(found | {"ledger": rows})
    told = [*(f"warning: {each}" for each in found["warnings"]), *(f"note: {each}" for each in found["notes"])]
    console.say("\n".join([preflight_lines(found, config), *told, *ship_lines(found), *found["statements"]]))
    if ledger:
        print_ledger(found, rows, config)


def preflight(config: SceneConfig) -> dict[str, Any]:
    """Report on a scene as JSON data: particles, memory, times, ships, warnings; problems in `urgent` may end a run."""
    known, rows, urgent = config.preflight, config.ledger(), []
    particles = known.particles
    memory = runtime.base_memory(particles) + sum(row.bytes for row in rows)
    time_step = config.time_step.build()
    still = config.fluid.still_limits(known)
    dt = time_step.next(still)
    stable, limit = Courant().longest_step(still)
    longest, ruling = Courant(courant_number=STABLE_COURANT).longest_step(still)
    room = particle_room(config, rows, particles)
    if dt > 1.05 * longest:
        over = f"{dt / longest:.2g} times the {longest:.3g} s that stayed stable in still water ({ruling} limit)"
        urgent.append(f"the time step of {dt:.3g} s is {over}")
    if memory > 0.9 * machine.memory_limit():
        urgent.append(f"needs {memory / 1e9:.1f} GB of memory; this machine has {machine.memory_limit() / 1e9:.1f} GB")
        if most := room["most_particles"]:
            fits = 1.01 * (known.spacing or 0.0) * (particles / most) ** (1.0 / known.tank.dimension)
            urgent[-1] += f"; fluid.spacing from {fits:.3g} m on fits"
    start, each, is_measured = run_times(config)
    parts = {"start_s": start, "steps_s": each * config.duration / dt, "pictures_s": picture_time(config)}
    return {
        "ok": True,
        "problems": [],
        "warnings": [*urgent, *config.warnings()],
        "urgent": urgent,
        "notes": config.notes,
        "statements": list(config.fluid.statements(known)),
        "particles": particles,
        "memory_mb": memory / 1e6,
        "pictures_mb": sum(row.bytes for row in rows if row.part in config.observers) / 1e6,
        **room,
        "time_step": dt,
        "limited_by": time_step.limited_by,
        "stable_time_step": stable,
        "stable_limited_by": limit,
        "estimated_wall_s": sum(parts.values()),
        "estimate_is_measured": is_measured,
        "estimated_by_part": parts,
        "ships": ship_facts(config),
        "ledger": rows,
    }


def picture_time(config: SceneConfig) -> float:
    """Estimated wall time [s] to draw all pictures of a run, by the last film on this machine, else as if idle."""
    return picture_ratio(config) * sum(part.picture_time(config.preflight) for part in config.observers.values())


def particle_room(config: SceneConfig, rows: list[LedgerRow], particles: int) -> dict[str, int | None]:
    """Bytes per particle, and number of particles that fit into memory, by ledger `rows`; None without particles."""
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
        for name, ship in config.ships.items()
        if (each := ship.floats(config.preflight)) is not None
    }


def ledger_rows(found: dict[str, Any], config: SceneConfig) -> list[dict[str, Any]]:
    """Memory ledger of the facts `found` as dicts; the first row of each part, such as `fluid`, lists its kernels."""
    parts, listed, rows = {"basin": config.basin} | config.parts(), set(), []
    for row in found["ledger"]:
        kernels = None if row.part in listed else runtime.kernels_in(type(parts[row.part]).__module__)
        listed.add(row.part)
        rows.append(row._asdict() | {"kernels": kernels})
    return rows


def wall_time(found: dict[str, Any], config: SceneConfig) -> str:
    """Text on the wall time in facts `found` of `preflight`, and its basis: a guess, or a run of such water."""
    parts = found["estimated_by_part"]
    terms = ", ".join(f"{name.removesuffix('_s')} {console.duration(took)}" for name, took in parts.items() if took)
    terms += ", which --set render=null saves" if parts["pictures_s"] else ""
    about = f"about {console.duration(found['estimated_wall_s'])} for {config.duration:g} s ({terms})"
    water = f"{config.fluid.kind} in {config.preflight.tank.dimension}-D"
    if not found["estimate_is_measured"]:
        return f"{about}: a guess, for an idle machine, until {water} has run on it, or `check --time` takes some steps"
    return f"{about}, by the run of {water} nearest in size on this machine"


def memory_text(found: dict[str, Any]) -> str:
    """Text on the memory of a run, and how much of it pictures take, from `found`, the facts of `preflight`."""
    pictures = f" ({found['pictures_mb']:.0f} of them for pictures)" if found["pictures_mb"] else ""
    return f"{found['memory_mb']:.0f} MB{pictures}"


def preflight_lines(found: dict[str, Any], config: SceneConfig, listed: str = "") -> str:
    """Verdict, wall time, memory, steps and files, of the facts `found`; `listed`: where the warnings are listed."""
    count = len(found["warnings"])
    steps = f"{found['particles']} particles in steps of {found['time_step']:.3g} s in still water"
    lines = [
        config.title or "untitled",
        "valid" + (f"; {count} warning{'s' if count > 1 else ''}{listed}" if count else ""),
        f"takes {wall_time(found, config)}",
        f"needs {memory_text(found)} of memory: {steps} (limit: {found['limited_by']})",
        f"writes {' '.join(config.files())}",
    ]
    return "\n".join(lines)


def ship_lines(found: dict[str, Any]) -> list[str]:
    """Lines on displacement, draught, metacentric heights and periods of each ship, by facts `found` of `preflight`."""
    from ocean_sim.ship.body.floating import RESOLVED_SPACINGS

    lines = []
    for name, ship in found["ships"].items():
        if ship["draught_m"] is None:
            continue
        periods = ", ".join(f"{motion} {t:.3g} s" for motion, t in ship["periods_s"].items() if t is not None)
        own, across = ship["gm_of_faces_m"], ship["draught_spacings"]
        faces = "" if own is None else f" ({own:.3g} m by the faces of her hull)"
        does = "resolves" if (across or 0.0) >= RESOLVED_SPACINGS else "does not resolve"
        resolved = "" if across is None else f" ({across:.3g} spacings: the water {does} her)"
        begin = f"{called(name)}: {figures(ship['displacement_kg'])} kg,"
        opening = f"draught {ship['draught_m']:.3g} m{resolved}, GM by her cubes {ship['gm_m']:.3g} m in roll{faces},"
        lines.append(f"{begin} {opening} {ship['gm_longitudinal_m']:.3g} m in pitch; natural periods: {periods}")
    return lines


def print_ledger(found: dict[str, Any], ledger: list[dict[str, Any]], config: SceneConfig) -> None:
    """Print capacity, stable time step (of the facts `found`), and the table `ledger` by part of the scene."""
    stable = f"{found['stable_time_step']:.4g} s in still water, limited by: {found['stable_limited_by']}"
    on_card = config.runtime.arch in runtime.GRAPHICS_CARD_CHOICES
    room = f"{(CARD_BYTES if on_card else machine.memory_limit()) / 1e9:.1f} GB of {'a card' if on_card else 'memory'}"
    if each := found["bytes_a_particle"]:
        console.say(f"room for {found['most_particles'] / 1e6:.2g} million particles of {each} bytes in {room}")
    console.say(f"stable time step: {stable}")
    rows = []
    for row in ledger:
        kernels = "" if row["kernels"] is None else f"{len(row['kernels'])}"
        rows.append([row["part"], row["what"], f"{row['bytes'] / 1e6:.2f}", kernels, row["why"]])
    heads = ["part", "fields", "MB", "kernels", "why"]
    console.table("\nwhat is allocated and compiled (kernels: at most), and why", heads, rows)
