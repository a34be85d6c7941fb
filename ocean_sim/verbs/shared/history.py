"""Earlier speeds on this machine, in the user's cache: of `bench`, and of the last run of each kind of water."""

import json
import platform
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from statistics import median
from typing import Any

from ocean_sim import machine
from ocean_sim.files.atomic_file import atomic_write, write_facts
from ocean_sim.reading.scene import SceneConfig

ASSUMED_STEP_SECONDS, ASSUMED_PARTICLE_SECONDS = 1e-3, 1e-6  # wall time [s] of a step until one has been measured
MAX_LINES = 1000  # of the file of `bench`; the newest are kept
MAX_COMPARED = 10  # measurements that a new one is compared with
MIN_COMPARED = 3  # the median of fewer says nothing
STATED_SLOWDOWN = 1.1  # times the step time of before, from which on it is said
SPEED_KEY = "particle_steps_per_cpu_s"


def bench_file() -> Path:
    """File of the measurements of `bench`, one line each."""
    return machine.cache_directory() / "bench.jsonl"


def processor_name() -> str:
    """Name of the processor, and how many cores this process may use."""
    named = machine.processor_facts().get("model name") or platform.processor() or platform.machine()
    return f"{named}, {machine.available_cores()} cores"


def bench_conditions(order: dict[str, Any], row: dict[str, Any]) -> dict[str, Any]:
    """Facts that two measurements must share to be compared: machine, library, scene, all that was set, and threads."""
    of_order = {key: order[key] for key in ("scene", "profile", "sets")}
    return {
        "machine": processor_name(),
        "library": row["library"],
        **of_order,
        "particles": row["particles"],
        "threads": row["threads"],
    }


def usual_speed(conditions: dict[str, Any]) -> float | None:
    """Particle-steps in a second of processor time: the median of the last measurements under these conditions, None
    where there are too few."""
    speeds = [
        line[SPEED_KEY]
        for line in bench_lines()
        if line.get("way") == conditions and isinstance(line.get(SPEED_KEY), float)
    ]
    return median(speeds[-MAX_COMPARED:]) if len(speeds) >= MIN_COMPARED else None


def bench_lines() -> Iterator[dict[str, Any]]:
    """All measurements of `bench`, the oldest first, without lines that cannot be read."""
    with suppress(OSError, UnicodeDecodeError):
        for line in bench_file().read_text(encoding="utf-8").splitlines():
            with suppress(ValueError):
                read = json.loads(line)
                if isinstance(read, dict):
                    yield read


def keep_measurement(conditions: dict[str, Any], row: dict[str, Any]) -> None:
    """Add a measurement; a cache that cannot be written is no reason to fail."""
    with suppress(OSError):
        path = bench_file()
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("a", encoding="utf-8") as file:
            file.write(
                json.dumps({"way": conditions, SPEED_KEY: row[SPEED_KEY], "ms_per_step": row["ms_per_step"]}) + "\n"
            )
        lines = list(bench_lines())
        if len(lines) > MAX_LINES:
            with atomic_write(path) as draft:
                draft.write_text("".join(f"{json.dumps(line)}\n" for line in lines[-MAX_LINES:]), encoding="utf-8")


def slowdown(order: dict[str, Any], row: dict[str, Any]) -> float | None:
    """Processor time of a step over the median of the last measurements under the same conditions; None where there are
    too few. The measurement is kept."""
    conditions = bench_conditions(order, row)
    usual = usual_speed(conditions)
    keep_measurement(conditions, row)
    return None if usual is None else usual / row[SPEED_KEY]


def slowdown_warning(scene: str, times: float) -> str | None:
    """Warning where a step takes notably longer than before, else None."""
    if times <= STATED_SLOWDOWN:
        return None
    return (
        f"{scene}: {100.0 * (times - 1.0):.0f} % slower in processor time than before on this machine, by the "
        f"median of at most {MAX_COMPARED} measurements in {bench_file()}"
    )


def rate_file() -> Path:
    """File of the rates of steps, beside the compiled kernels."""
    return machine.cache_directory() / "step_rates.json"


def rate_conditions(config: SceneConfig) -> str:
    """Facts that two runs must share to take about the same time per particle and step."""
    from ocean_sim import kernel_library

    runtime = config.runtime
    threads = f"{runtime.threads or machine.available_cores()} threads"
    library = runtime.library or kernel_library.LIBRARY_NAME
    water = f"{config.fluid.kind} in {config.preflight.tank.dimension}-D"
    return ", ".join((water, runtime.arch, runtime.precision, library, threads, processor_name()))


def known_rates() -> dict[str, Any]:
    """Wall time [s] per particle and step, by conditions; of water without particles, per step."""
    with suppress(OSError, ValueError):
        rates = json.loads(rate_file().read_text(encoding="utf-8"))
        if isinstance(rates, dict):
            return rates
    return {}


def step_time(config: SceneConfig) -> tuple[float, bool]:
    """Estimated wall time of a step [s], and True if a run under the same conditions has measured it."""
    rate = known_rates().get(rate_conditions(config))
    if isinstance(rate, float):
        return rate * max(config.preflight.particles, 1), True
    return ASSUMED_STEP_SECONDS + ASSUMED_PARTICLE_SECONDS * config.preflight.particles, False


def keep_step_time(config: SceneConfig, seconds: float) -> None:
    """Keep the mean wall time of a step [s] for estimates; a cache that cannot be written is no reason to fail."""
    with suppress(OSError):
        rate_file().parent.mkdir(parents=True, exist_ok=True)
        rate = seconds / max(config.preflight.particles, 1)
        write_facts(rate_file(), known_rates() | {rate_conditions(config): rate})
