"""Earlier speeds on this machine, in the user's cache: of `bench`, and of the last run for each kind of water."""

import json
import platform
from contextlib import suppress
from math import log
from pathlib import Path
from statistics import median
from typing import Any

from ocean_sim import kernel_library, machine
from ocean_sim.files.atomic_file import write_facts
from ocean_sim.files.input_file import read_json_object
from ocean_sim.reading.scene import SceneConfig
from ocean_sim.verbs.shared.progress import Progress

ASSUMED_START_SECONDS = 10.0  # wall time until the first step has been taken, of a run that compiles all kernels
ASSUMED_STEP_SECONDS, ASSUMED_PARTICLE_SECONDS = 3e-4, 1e-6  # wall time [s] of a step, and of each particle in it
MAX_COMPARED = 10  # measurements that a new one is compared with
MIN_COMPARED = 3  # the median of fewer says nothing
STATED_SLOWDOWN = 1.1  # times the step time of before, from which on it is said
SPEED_KEY = "particle_steps_per_cpu_s"


def bench_file() -> Path:
    """Path of the JSON file with the speeds that `bench` has measured, by conditions such as scene and processor."""
    return machine.cache_directory() / "bench_speeds.json"


def rate_file() -> Path:
    """Path of the JSON file with [particles, start, step] of past runs (times in s), by `rate_conditions` and size."""
    return machine.cache_directory() / "step_rates.json"


def keep_measurement(path: Path, conditions: str, measured: float | list[float]) -> None:
    """Store a measurement in a JSON file under the key `conditions`; a file that cannot be written is ignored."""
    with suppress(OSError):
        write_facts(path, read_json_object(path) | {conditions: measured})


def processor_name() -> str:
    """Name of the processor, with the number of cores that this process may use."""
    named = machine.processor_facts().get("model name") or platform.processor() or platform.machine()
    return f"{named}, {machine.available_cores()} cores"


def slowdown(order: dict[str, Any], row: dict[str, Any]) -> float | None:
    """Processor time per step in a result `row` of `bench`, run by a job description `order`, over the median of
    earlier ones in equal conditions (processor, scene ...); None if these are too few. Stores the new measurement."""
    of_row = [row[key] for key in ("library", "particles", "threads")]
    conditions = json.dumps([processor_name(), *of_row, *(order[key] for key in ("scene", "profile", "sets"))])
    known = read_json_object(bench_file()).get(conditions)
    before = [speed for speed in known if isinstance(speed, float)] if isinstance(known, list) else []
    keep_measurement(bench_file(), conditions, [*before, row[SPEED_KEY]][-MAX_COMPARED:])
    return median(before) / row[SPEED_KEY] if len(before) >= MIN_COMPARED else None


def slowdown_warning(scene: str, times: float) -> str | None:
    """Warning if a step takes `times` as long as before, and `times` exceeds STATED_SLOWDOWN; else None."""
    if times <= STATED_SLOWDOWN:
        return None
    begin = f"{scene}: {100.0 * (times - 1.0):.0f} % slower in processor time than before on this machine, by the"
    return f"{begin} median of at most {MAX_COMPARED} measurements in {bench_file()}"


def rate_conditions(config: SceneConfig) -> str:
    """Key under which runs of similar speed are stored: water, backend, precision, library, threads and processor."""
    runtime = config.runtime
    threads = f"{runtime.threads or machine.available_cores()} threads"
    library = runtime.library or kernel_library.LIBRARY_NAME
    water = f"{config.fluid.kind} in {config.preflight.tank.dimension}-D"
    return ", ".join((water, runtime.arch, runtime.precision, library, threads, processor_name()))


def run_times(config: SceneConfig) -> tuple[float, float, bool]:
    """Wall times [s] of the start and of each later step, estimated by the run nearest in size; False without one."""
    conditions, assumed = f"{rate_conditions(config)}, below", assumed_step(config.preflight.particles)
    rows = [row for key, row in read_json_object(rate_file()).items() if key.startswith(conditions)]
    if not rows:
        return ASSUMED_START_SECONDS, assumed, False
    particles, start, step = min(rows, key=lambda row: abs(log(assumed_step(row[0]) / assumed)))
    return start, step * assumed / assumed_step(particles), True


def assumed_step(particles: float) -> float:
    """Wall time [s] of a step of so many particles until one has been measured, and how it grows with them."""
    return ASSUMED_STEP_SECONDS + ASSUMED_PARTICLE_SECONDS * particles


def keep_run_times(config: SceneConfig, progress: Progress) -> None:
    """Store the wall times of a run's start and of its later steps, for `run_times` of runs of about this size."""
    if progress.step_time is not None:
        particles, start = config.preflight.particles, progress.summary()["wall_s"]["start"]
        conditions = f"{rate_conditions(config)}, below {1 << particles.bit_length()} particles"
        keep_measurement(rate_file(), conditions, [particles, start, progress.step_time])


def picture_key(config: SceneConfig) -> str:
    return f"pictures in {config.preflight.tank.dimension}-D, {processor_name()}"


def picture_ratio(config: SceneConfig) -> float:
    """Wall time of the last film on this machine over its estimate; 1 without one."""
    return float(read_json_object(rate_file()).get(picture_key(config), 1.0))


def keep_picture_ratio(config: SceneConfig, film_time: float | None) -> None:
    """Store the wall time [s] of a run's film, unless None, over its estimate, for `picture_ratio`."""
    part, facts = config.observers.get("render"), config.preflight
    if part is not None and film_time is not None:
        estimate = part.picture_time(facts) - part.model_copy(update={"film": False}).picture_time(facts)
        keep_measurement(rate_file(), picture_key(config), film_time / estimate)
