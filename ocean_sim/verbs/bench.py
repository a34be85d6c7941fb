"""`ocean-sim bench`: speed alone, each scene in a process of its own, with a clock as the only observer."""

import json
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from statistics import median
from time import monotonic, perf_counter, process_time
from typing import TYPE_CHECKING, Any

import typer

from ocean_sim.files.yaml_file import Problem, SceneError
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.options import Profile, Sets

if TYPE_CHECKING:
    from ocean_sim.simulation import Simulation

DEFAULT_SCENES = ("bench/dam_break_6k", "bench/dam_break_50k")
WARM_UP_STEPS = 20  # steps
MIN_BLOCK_SECONDS = 0.5  # wall time of a block of steps, at least [s]


def bench(
    scenes: list[str] | None = typer.Argument(None, help="By default bench/dam_break_6k and bench/dam_break_50k."),
    profile: Profile = None,
    sets: Sets = None,
    threads: int | None = typer.Option(None, min=1, help="Worker threads; by default all cores."),
    repeats: int = typer.Option(5, min=1, help="Number of blocks, each of at least half a second; the median counts."),
    cold: bool = typer.Option(False, help="Start with an empty kernel cache, as on a first run."),
    peers: bool = typer.Option(
        False, "--peers", help="Also time pysplashsurf and Capytaine on the same tasks, where installed."
    ),
    peer_python: list[Path] | None = typer.Option(
        None,
        help="With --peers: the Python of an environment that has pysplishsplash, pysph or both, for dam breaks; "
        "may be given several times.",
    ),
) -> None:
    """Measure the speed of scenes one after the other; with --peers and no scene, time other programs alone."""
    from ocean_sim.verbs.shared import history

    if peer_python and not peers:
        raise typer.BadParameter("--peer-python goes with --peers")
    pythons = peer_python or []
    console.set_values(sets)
    programs = "--peers: the programs that run others are"
    others = console.checkout_module("benchmarks.peers", programs) if peers else None
    if others is not None:
        others.must_have_one(pythons)
    rows = []
    for scene in scenes or (() if others else DEFAULT_SCENES):
        order = {"scene": scene, "profile": profile, "sets": sets or [], "threads": threads, "repeats": repeats}
        row = measure_in_child(order, cold)
        times = history.slowdown(order, row)
        rows.append(row | {"times_before": times})
        slower = history.slowdown_warning(scene, times) if times is not None else None
        console.say(measurement_lines(row))
        if slower is not None:
            console.complain(slower)
    if others is not None:
        for row in others.peers(pythons, threads):
            rows.append(row)
            console.say(others.sentence(row))
    console.answer(rows)
    if any(row.get("failed") for row in rows):
        raise typer.Exit(console.Lacking.exit_code)


def measure_in_child(order: dict[str, Any], cold: bool) -> dict[str, Any]:
    """Measure `order` (scene, options) by `bench-one` in a child process; `cold`: with an empty kernel cache."""
    with tempfile.TemporaryDirectory() as empty:
        environment = os.environ | ({"XDG_CACHE_HOME": empty} if cold else {})
        command = [sys.executable, "-m", "ocean_sim", "bench-one", "--json"]
        spawned = json.dumps(order | {"spawned": monotonic()})
        child = subprocess.run([*command, spawned], env=environment, stdout=subprocess.PIPE, text=True, check=False)
    if child.returncode == 0:
        return json.loads(child.stdout)
    try:
        failure = json.loads(child.stdout)
    except ValueError:
        raise console.Failed(f"{order['scene']}: the process that measures it died ({child.returncode})") from None
    if failure["problems"]:
        raise SceneError([Problem(**problem) for problem in failure["problems"]])
    kind = {2: console.Refused, 3: console.Lacking}.get(child.returncode, console.Failed)
    raise kind(f"{order['scene']}: {failure['error']}")


def bench_one(order: str) -> None:
    """Measure the scene of an order (job description, JSON text) in this process, and print the results as JSON."""
    from ocean_sim import kernel_library
    from ocean_sim.observers.timings import Timings
    from ocean_sim.reading.scene import load, observer_names
    from ocean_sim.simulation import Simulation

    asked = json.loads(order)
    quiet: dict[str, Any] = {name: None for name in observer_names() if name not in ("manifest", "timings")}
    limited = {"runtime.threads": asked["threads"]} if asked["threads"] else {}
    machine: dict[str, Any] = {"runtime.pin": True} | limited
    config = load(asked["scene"], {**quiet, **machine, **console.set_values(asked["sets"])}, asked["profile"])
    console.must_compute_with(config.runtime.library)
    with Simulation(config) as simulation:
        simulation.step()
        first_step = monotonic() - asked["spawned"]
        clock = next(observer for observer in simulation.observers if isinstance(observer, Timings))
        for _ in range(WARM_UP_STEPS):
            simulation.step()
        clock.sync()
        before = clock.take_mark(perf_counter())
        blocks = [time_block(simulation, clock.sync) for _ in range(asked["repeats"])]
        stages = clock.stage_means(before, clock.take_mark(perf_counter()))[1]
        particles = simulation.fluid.count
        threads = simulation.backend.threads
    per_step = [1e3 * wall / steps for steps, wall, _, _ in blocks]
    console.answer(
        {
            "scene": asked["scene"],
            "library": kernel_library.LIBRARY_NAME,
            "particles": particles,
            "threads": threads,
            "ms_per_step": median(per_step),
            "ms_per_step_min": min(per_step),
            "ms_per_step_max": max(per_step),
            "particle_steps_per_s": particles / (median(per_step) / 1e3),
            "particle_steps_per_cpu_s": median(particles * steps / cpu for steps, _, cpu, _ in blocks),
            "real_time_factor": median(simulated / wall for _, wall, _, simulated in blocks),
            "first_step_s": first_step,
            "peak_memory_mb": 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6,
            "stages": stages,
        }
    )


def time_block(simulation: "Simulation", sync: Callable[[], None]) -> tuple[int, float, float, float]:
    """Step for MIN_BLOCK_SECONDS, each followed by `sync()`; number of steps, wall, processor, simulated time [s]."""
    steps, wall, cpu, simulated = 0, perf_counter(), process_time(), simulation.time
    while perf_counter() - wall < MIN_BLOCK_SECONDS:
        simulation.step()
        sync()
        steps += 1
    return steps, perf_counter() - wall, process_time() - cpu, simulation.time - simulated


def measurement_lines(row: dict[str, Any]) -> str:
    """Readable text, in two lines, on the measured speed of a scene; `row`: results of `bench_one`."""
    stages = ", ".join(f"{name} {ms:.3g}" for name, ms in row["stages"].items())
    return (
        f"{row['scene']}: {row['particles']} particles, {row['threads']} threads, {row['library']}: "
        f"{row['ms_per_step']:.3g} ms a step ({row['ms_per_step_min']:.3g} to {row['ms_per_step_max']:.3g}), "
        f"{row['particle_steps_per_s'] / 1e6:.3g} million particle-steps per second, "
        f"{row['particle_steps_per_cpu_s'] / 1e6:.3g} per CPU-second, {row['real_time_factor']:.3g} x real time\n"
        f"  first step after {row['first_step_s']:.2f} s, at most {row['peak_memory_mb']:.0f} MB; ms a step: {stages}"
    )
