"""The run of one scene as a task of a study: its whole run folder, its row in a table, and the cost of its steps."""

from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np

from ocean_sim.conventions import Diverged, Motions, Refused
from ocean_sim.fluid import with_particles
from ocean_sim.reading.scene import SceneConfig, load
from ocean_sim.result import Result
from ocean_sim.simulation import Simulation
from ocean_sim.waves.record import Unmeasurable, measure_record

WARM_UP_STEPS = 3  # steps in which kernels are still compiled or loaded
FRAME_SECONDS = 1.0 / 60.0  # [s]
TIMED_PARTS, BLOCK_STEPS = 3, 7  # parts in which a run is timed; steps of the blocks that are dealt to them in turn
ENERGY_COLUMNS = ("kinetic_energy_J", "potential_energy_J", "internal_energy_J", "energy_residual_J")
MOTION_UNITS = 3 * ("m",) + 3 * ("rad",)  # of `Motions`
CLOCK_COLUMNS = ("wall_per_s", "cpu_per_s", "wall_s", "cpu_s")  # what changes from call to call
PICTURE_OBSERVERS = ("render", "frames", "report")  # a study makes none unless it is asked to


class Clocked(Simulation):
    """Simulation that records the simulated, wall and processor time of each step, without the work of observers."""

    def __init__(self, *given: Any) -> None:
        self.spent: list[tuple[float, float, float]] = []
        super().__init__(*given)

    def step(self) -> None:
        """Advance by one time step, and record its simulated, wall and processor time [s]."""
        dt, wall, cpu = float(self.next_dt), perf_counter(), process_time()
        super().step()
        self.spent.append((dt, perf_counter() - wall, process_time() - cpu))

    def frame(self) -> None:
        """Advance the drawn water surface by 1/60 s and triangulate it; recorded like a step."""
        surface = self.surface
        assert surface is not None
        wall, cpu = perf_counter(), process_time()
        surface.follow(with_particles(self.fluid).particles, FRAME_SECONDS)
        surface.mesh()
        self.spent.append((FRAME_SECONDS, perf_counter() - wall, process_time() - cpu))

    def costs(self) -> list[dict[str, float]]:
        """Costs (`mean_cost`) of TIMED_PARTS groups of steps: successive blocks of steps go to the groups by turns, so
        that a disturbance of the machine rarely hits two groups."""
        parts = [
            [step for k, step in enumerate(self.spent[WARM_UP_STEPS:]) if k // BLOCK_STEPS % TIMED_PARTS == n]
            for n in range(TIMED_PARTS)
        ]
        return [mean_cost(steps) for steps in parts if steps]

    def cost(self) -> dict[str, float | None]:
        """`wall_per_s`, `cpu_per_s`, `time_step_s` (as `mean_cost`) after WARM_UP_STEPS; None each without steps."""
        steps = self.spent[WARM_UP_STEPS:]
        return mean_cost(steps) if steps else dict.fromkeys(("wall_per_s", "cpu_per_s", "time_step_s"))  # type: ignore[return-value]


def mean_cost(steps: list[tuple[float, float, float]]) -> dict[str, float]:
    """Wall and processor time per simulated second, mean step [s]; `steps`: (simulated, wall, processor time) [s]."""
    simulated, wall, cpu = (sum(column) for column in zip(*steps))
    return {"wall_per_s": wall / simulated, "cpu_per_s": cpu / simulated, "time_step_s": simulated / len(steps)}


def run_order(config: SceneConfig, threads: int | None = None) -> dict[str, Any]:
    """Order (job description as plain data) to run a scene; `threads`: number of threads if the scene sets none."""
    return {"task": __name__, "scene": config.resolved(), "inputs": config.inputs(), "machine": {"threads": threads}}


def answer(order: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Run the scene of an order (job description); returns outcome (`stopped`: diverged), reason, costs, measures."""
    began, processor, reason = perf_counter(), process_time(), ""
    asked = order["machine"]["threads"]
    more = {"runtime.threads": asked} if asked and not order["scene"]["runtime"]["threads"] else {}
    config = load(order["scene"], more)
    if config.inputs() != order["inputs"]:
        raise Refused("a file that the scene names has changed since this run was planned")
    with Clocked(config, folder) as simulation:
        try:
            simulation.run(config.duration)
        except Diverged as failure:
            reason = str(failure)
        particles = simulation.fluid.particles
        facts = {
            "outcome": simulation.outcome,
            "reason": reason,
            "simulated_s": simulation.time,
            "steps": simulation.steps,
            "particles": 0 if particles is None else int(particles.count.now),
            "threads": simulation.backend.threads,
            "precision": simulation.backend.precision,
        } | simulation.cost()
    whole = {"wall_s": perf_counter() - began, "cpu_s": process_time() - processor}
    return facts | whole | plain_values(run_measures(Result(folder)))


def run_measures(result: Result) -> dict[str, float | None]:
    """Measures of a run from its files, by name: waves at gauges, compression, energies, motions, leg lengths."""
    found: dict[str, float | None] = {}
    gauges = unwrapped_table(result, "gauges")
    for name, height in gauges.items():
        if name != "time_s" and name.endswith("_m"):
            found |= wave_heights(name.removesuffix("_m"), gauges["time_s"], height)
    accuracy = unwrapped_table(result, "accuracy")
    if len(accuracy.get("compression_max", ())):
        found["compression_max"] = float(accuracy["compression_max"].max())
    found |= {name: float(accuracy[name][-1]) for name in ENERGY_COLUMNS if len(accuracy.get(name, ()))}
    platform = unwrapped_table(result, "platform")
    for table, prefix in motion_tables(result).items():
        motion = unwrapped_table(result, table)
        for name, unit in zip(Motions._fields, MOTION_UNITS):
            if len(values := motion.get(f"{name}_{unit}", np.empty(0))):
                found[f"{prefix}{name}_rms_{unit}"] = float(values.std())
    legs = [platform[f"leg{k}_m"] for k in range(1, 7) if len(platform.get(f"leg{k}_m", ()))]
    if legs:
        found |= {"leg_min_m": float(np.min(legs)), "leg_max_m": float(np.max(legs))}
    return found


def motion_tables(result: Result) -> dict[str, str]:
    """Names of a run's motion logs, each with the prefix of its measures: the ship's name, or empty if she is alone."""
    logs = sorted(path.stem for path in result.folder.glob("motion_*.csv"))
    return {"motion": ""} | {log: f"{log.removeprefix('motion_')}_" for log in logs}


def unwrapped_table(result: Result, name: str) -> dict[str, np.ndarray]:
    """Columns of a run's table by name, with angles [rad] unwrapped; empty if the run wrote no such table."""
    table = result.table(name) if (result.folder / f"{name}.csv").is_file() else {}
    return {key: np.unwrap(values) if key.endswith("_rad") else values for key, values in table.items()}


def wave_heights(gauge: str, time: np.ndarray, height: np.ndarray) -> dict[str, float | None]:
    """Heights hs, hm0 [m], period tz [s] of waves `height` (n,) [m] at `time` (n,), as <gauge>_hs_m; None if calm."""
    try:
        sea = measure_record(time, height)
    except Unmeasurable:
        return {f"{gauge}_{name}": None for name in ("hs_m", "hm0_m", "tz_s")}
    return {f"{gauge}_hs_m": sea.hs_m, f"{gauge}_hm0_m": sea.hm0_m, f"{gauge}_tz_s": sea.tz_s}


def plain_values(facts: dict[str, float | None]) -> dict[str, float | None]:
    """Copy with None in place of NaN and infinity, which JSON cannot express."""
    return {key: value if value is not None and np.isfinite(value) else None for key, value in facts.items()}
