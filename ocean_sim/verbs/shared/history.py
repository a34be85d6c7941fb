"""Earlier measurements of `bench` on this machine: one line each in the user's cache, the newest kept."""

import json
import platform
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from statistics import median
from typing import Any

from ocean_sim import machine
from ocean_sim.files.atomic_file import atomic_write

KEPT = 1000  # lines of the file
LAST = 10  # measurements that a new one is compared with, at most
LEAST = 3  # and at least: the median of fewer says nothing
SLOWER = 1.1  # times that of before: more is told
SPEED = "particle_steps_per_cpu_s"


def path() -> Path:
    """The file."""
    return machine.cache_directory() / "bench.jsonl"


def processor() -> str:
    """The name of the processor, and how many cores this process may use."""
    named = machine.processor_facts().get("model name") or platform.processor() or platform.machine()
    return f"{named}, {machine.available_cores()} cores"


def way(order: dict[str, Any], row: dict[str, Any]) -> dict[str, Any]:
    """Facts that two measurements must share to be compared: machine, library, scene, all that was set, and threads."""
    of_order = {key: order[key] for key in ("scene", "profile", "sets")}
    return {
        "machine": processor(),
        "library": row["library"],
        **of_order,
        "particles": row["particles"],
        "threads": row["threads"],
    }


def before(of: dict[str, Any]) -> float | None:
    """Particle-steps in a second of processor time: the median of the last measurements of this way, None where there
    are too few."""
    found = [line[SPEED] for line in lines() if line.get("way") == of and isinstance(line.get(SPEED), float)]
    return median(found[-LAST:]) if len(found) >= LEAST else None


def lines() -> Iterator[dict[str, Any]]:
    """All measurements, the oldest first; what cannot be read is left out."""
    with suppress(OSError, UnicodeDecodeError):
        for line in path().read_text(encoding="utf-8").splitlines():
            with suppress(ValueError):
                read = json.loads(line)
                if isinstance(read, dict):
                    yield read


def keep(of: dict[str, Any], row: dict[str, Any]) -> None:
    """Add a measurement; a cache that cannot be written is no reason to fail."""
    with suppress(OSError):
        there = path()
        there.parent.mkdir(parents=True, exist_ok=True)
        with there.open("a", encoding="utf-8") as file:
            file.write(json.dumps({"way": of, SPEED: row[SPEED], "ms_per_step": row["ms_per_step"]}) + "\n")
        kept = list(lines())
        if len(kept) > KEPT:
            with atomic_write(there) as draft:
                draft.write_text("".join(f"{json.dumps(line)}\n" for line in kept[-KEPT:]), encoding="utf-8")


def compared(order: dict[str, Any], row: dict[str, Any]) -> float | None:
    """Processor time of a step over the median of the last measurements of the same way; None where there are too few.
    Keeps this one, too."""
    of = way(order, row)
    usual = before(of)
    keep(of, row)
    return None if usual is None else usual / row[SPEED]


def sentence(scene: str, times: float) -> str | None:
    """A warning where it takes notably longer."""
    if times <= SLOWER:
        return None
    return (
        f"{scene}: {100.0 * (times - 1.0):.0f} % slower in processor time than before on this machine, by the "
        f"median of at most {LAST} measurements in {path()}"
    )
