"""`ocean-sim check`: what a scene would take, before anything is allocated."""

from math import isinf
from typing import Any

import typer

from ocean_sim import machine
from ocean_sim.conventions import figures
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.parts import LedgerRow, called
from ocean_sim.reading.scene import SceneConfig, load
from ocean_sim.time_step import Known
from ocean_sim.time_step.courant import Config as Courant
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.options import Json, Profile, Scene, Sets

NOTHING = dict.fromkeys(
    (
        *("particles", "memory_mb", "pictures_mb", "bytes_a_particle", "most_particles", "time_step", "limited_by"),
        *("estimated_wall_s", "estimated_processor_s"),
    )
)
CARD = 16e9  # [bytes] of a graphics card, which cannot be asked for its own before it is started
FEW = 20_000  # particles, below which most memory of the water does not go with their number
LONGEST = 0.8  # the courant number of the profiles `ci` and `interactive`, up to which steps were found stable
ON_ALL_THREADS = ("wind", "fluid", "surface")  # whose work among particles all threads share; one does the rest
START, START_OF_PARTICLES = 2.2, 0.8  # [s] imports and kernels out of their cache, and what particles add; measured


def check(scene: Scene, profile: Profile = None, sets: Sets = None, as_json: Json = False) -> None:
    """Report what a scene would take, and what is wrong with it."""
    try:
        config = load(scene, console.settings(sets), profile)
    except SceneError as error:
        if not as_json:
            raise
        problems = [problem._asdict() for problem in error.problems]
        console.answer(
            {
                "ok": False,
                "error": console.counted(problems),
                "problems": problems,
                "warnings": [],
                **NOTHING,
                "ledger": [],
            }
        )
        raise typer.Exit(2) from None
    found = preflight(config)
    if as_json:
        console.answer(found | {"ledger": ledger(found, config)})
    else:
        long(found, config)


def preflight(config: SceneConfig) -> dict[str, Any]:
    """Answer of `check`."""
    from ocean_sim.runtime import GRAPHICS_CARD_CHOICES, base_memory

    known, rows, warnings = config.preflight, config.ledger(), config.warnings()
    particles = known.particles
    memory = base_memory(particles) + sum(row.bytes for row in rows)
    time_step = config.time_step.build()
    still = config.fluid.still_limits(known)
    dt = time_step.next(Known(still))
    stable, limit = Courant().shortest(still)
    longest, ruling = Courant(courant_number=LONGEST).shortest(still)
    if dt > 1.05 * longest:
        over = f"{dt / longest:.2g} times the {longest:.3g} s that stayed stable in still water ({ruling} limit)"
        warnings.append(f"the time step of {dt:.3g} s is {over}")
    threads, card = config.runtime.threads or machine.available_cores(), config.runtime.arch in GRAPHICS_CARD_CHOICES
    if memory > 0.9 * machine.memory_limit():
        warnings.append(
            f"needs {memory / 1e9:.1f} GB of memory; this machine has {machine.memory_limit() / 1e9:.1f} GB"
        )
    steps = config.duration / dt
    shared = sum(row.a_step(dt) for row in rows if particles and row.part in ON_ALL_THREADS)
    alone = sum(row.a_step(dt) for row in rows) - shared
    start, (pictures, drawn) = START + (START_OF_PARTICLES if particles else 0.0), picture_time(config)
    parts = {
        "start_s": start,
        "steps_s": None if card else steps * (shared / threads + alone),  # that of cards was not measured
        "pictures_s": drawn,
    }
    return {
        "ok": True,
        "problems": [],
        "warnings": warnings,
        "notes": config.notes,
        "statements": config.fluid.statements(known),
        "particles": particles,
        "memory_mb": memory / 1e6,
        "pictures_mb": sum(row.bytes for row in rows if row.part in config.observers) / 1e6,
        **room(config, rows, particles),
        "time_step": dt,
        "limited_by": time_step.limited_by,
        "stable_time_step": stable,
        "stable_limited_by": limit,
        "estimated_wall_s": None if parts["steps_s"] is None else sum(filter(None, parts.values())),
        "estimated_by_part": parts,
        "estimated_processor_s": None if card else start + steps * (shared + alone) + pictures,
        "ships": ships(config),
        "ledger": rows,
    }


def picture_time(config: SceneConfig) -> tuple[float, float]:
    """Processor time [s] of all pictures of a run, and the wall time [s] that they take where all cores are idle."""
    times = [part.picture_time(config.preflight) for part in config.observers.values()]
    return sum(processor for processor, _ in times), sum(wall for _, wall in times)


def room(config: SceneConfig, rows: list[LedgerRow], particles: int) -> dict[str, int | None]:
    """Bytes that a particle takes of the memory where the water lies, and how many particles fit there: on a processor
    into nine tenths of this machine's, with the copies of them that observers make; on a card, where observers have
    nothing, into CARD."""
    from ocean_sim.runtime import BASE_MEMORY, COPY_BYTES_PER_PARTICLE, GRAPHICS_CARD_CHOICES

    if not particles:
        return {"bytes_a_particle": None, "most_particles": None}
    water = sum(row.bytes for row in rows if row.part == "fluid")
    watched = sum(row.bytes for row in rows if row.part in config.observers)
    others = sum(row.bytes for row in rows) - water - watched
    each = -(-water // particles)
    free, taken = CARD - others, each
    if config.runtime.arch not in GRAPHICS_CARD_CHOICES:
        seen = sum(part.bytes_a_particle(config.preflight) for part in config.observers.values())
        free = 0.9 * machine.memory_limit() - others - (watched - seen * particles) - BASE_MEMORY
        taken = each + COPY_BYTES_PER_PARTICLE + seen
    most = min(int(free / taken), config.fluid.most_particles(config.preflight))
    return {"bytes_a_particle": each, "most_particles": max(0, most)}


def ships(config: SceneConfig) -> dict[str, dict[str, Any]]:
    """Draught, metacentric heights and natural periods of every ship that a hull carries, by its name."""
    found = {name: ship.floats(config.preflight) for name, ship in config.ships.items()}
    return {
        name: {
            "displacement_kg": each.displacement,
            "draught_m": None if isinf(each.draught) else each.draught,
            "gm_m": each.gm,
            "gm_longitudinal_m": each.gm_longitudinal,
            "gm_of_faces_m": each.gm_of_faces,
            "periods_s": each.periods,
        }
        for name, each in found.items()
        if each is not None
    }


def ledger(found: dict[str, Any], config: SceneConfig) -> list[dict[str, Any]]:
    """The ledger by rows; kernels, and the share of a step's processor time, belong to a whole part and stand in its
    first row. A part that takes no time of a step has no share."""
    from ocean_sim.runtime import kernels_in

    parts, dt = {"basin": config.basin} | config.parts(), found["time_step"]
    total = sum(row.a_step(dt) for row in found["ledger"])
    listed, rows = set(), []
    for row in found["ledger"]:
        cells: dict[str, Any] = {key: getattr(row, key) for key in ("part", "what", "bytes", "why")}
        first, own = row.part not in listed, [other for other in found["ledger"] if other.part == row.part]
        cells["kernels"] = kernels_in(type(parts[row.part]).__module__) if first else None
        cells["share"] = (sum(other.a_step(dt) for other in own) / total or None) if first and total else None
        listed.add(row.part)
        rows.append(cells)
    return rows


def wall_time(found: dict[str, Any], config: SceneConfig) -> str:
    """An estimate from what each part was measured to take on an idle machine, with all kernels in the cache."""
    parts, whole = found["estimated_by_part"], found["estimated_wall_s"]
    shown = {"start": parts["start_s"], "steps": parts["steps_s"], "pictures": parts["pictures_s"]}
    terms = ", ".join(f"{name} {console.duration(seconds)}" for name, seconds in shown.items() if seconds)
    if whole is None:
        return f"no estimate of the wall time of the steps ({terms}) for {config.duration:g} s"
    busy = console.duration(found["estimated_processor_s"])
    return (
        f"about {console.duration(whole)} for {config.duration:g} s on an idle machine ({terms}); "
        f"{busy} of processor time"
    )


def memory_taken(found: dict[str, Any]) -> str:
    """Memory of a run with the processes that draw its pictures."""
    pictures = f" ({found['pictures_mb']:.0f} of them for pictures)" if found["pictures_mb"] else ""
    return f"{found['memory_mb']:.0f} MB{pictures}"


def fitting(found: dict[str, Any], config: SceneConfig) -> str:
    """Memory of a particle, and the number that fits."""
    from ocean_sim.runtime import GRAPHICS_CARD_CHOICES

    if found["bytes_a_particle"] is None:
        return "no particles"
    where = f"the {machine.memory_limit() / 1e9:.1f} GB of this machine"
    if config.runtime.arch in GRAPHICS_CARD_CHOICES:
        where = f"{CARD / 1e9:.0f} GB of a graphics card"
    fit = f"{found['most_particles'] / 1e6:.2g} million particles fit into {where}"
    if found["particles"] < FEW:
        return f"at least {fit}"
    return f"{found['bytes_a_particle']} bytes a particle: {fit}"


def short(found: dict[str, Any], config: SceneConfig) -> str:
    """The preflight in a few lines, for `run`."""
    lines = [
        f"{config.title or 'untitled'}: {found['particles']} particles, {memory_taken(found)}, "
        f"time step {found['time_step']:.3g} s in still water ({found['limited_by']}), "
        f"{wall_time(found, config)}"
    ]
    return "\n".join(
        [*lines, *(f"note: {note}" for note in found["notes"]), *(f"warning: {w}" for w in found["warnings"])]
    )


def long(found: dict[str, Any], config: SceneConfig) -> None:
    """The preflight in full, for people."""
    console.say(config.title or "untitled")
    console.table(
        "",
        ["", ""],
        [
            ["particles", f"{found['particles']}"],
            ["memory", f"about {memory_taken(found)} at the peak"],
            ["room", fitting(found, config)],
            ["time step", f"{found['time_step']:.4g} s in still water, limited by: {found['limited_by']}"],
            ["stable", f"{found['stable_time_step']:.4g} s in still water, limited by: {found['stable_limited_by']}"],
            [
                "wall time",
                wall_time(found, config),
            ],
        ],
    )
    rows = [
        [
            row["part"],
            row["what"],
            f"{row['bytes'] / 1e6:.2f}",
            "" if row["kernels"] is None else f"{len(row['kernels'])}",
            "" if row["share"] is None else f"{row['share']:.0%}",
            row["why"],
        ]
        for row in ledger(found, config)
    ]
    heads = ["part", "fields", "MB", "kernels", "of a step", "why"]
    console.table("\nwhat is allocated and compiled (kernels: at most), and why", heads, rows)
    console.say()
    for name, ship in found["ships"].items():
        if ship["draught_m"] is not None:
            periods = ", ".join(f"{motion} {t:.3g} s" for motion, t in ship["periods_s"].items() if t is not None)
            own = ship["gm_of_faces_m"]
            faces = "" if own is None else f" (by the faces of her hull {own:.3g} m)"
            console.say(
                f"{called(name)}: {figures(ship['displacement_kg'])} kg, draught {ship['draught_m']:.3g} m, GM "
                f"{ship['gm_m']:.3g} m{faces}, longitudinal "
                f"GM {ship['gm_longitudinal_m']:.3g} m; natural periods: {periods}"
            )
    for sentence in found["statements"]:
        console.say(sentence)
    for note in found["notes"]:
        console.say(f"note: {note}")
    for warning in found["warnings"]:
        console.say(f"warning: {warning}")
    console.say("the scene is in order")
