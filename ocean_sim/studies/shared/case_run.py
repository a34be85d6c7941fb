"""The run of a validation case as a task of a study: its errors, in the case's own units, and its cost."""

from pathlib import Path
from statistics import median
from time import perf_counter, process_time
from typing import Any

import numpy as np

from ocean_sim.conventions import Diverged
from ocean_sim.fluid import Fluid
from ocean_sim.studies.shared.scene_run import BLOCK_STEPS, TIMED_PARTS, WARM_UP_STEPS, Clocked, plain_values
from ocean_sim.validation import problems
from ocean_sim.validation.shared.case import Number, Problem, Promise

MAX_REPEATS = 3  # runs at most; the median time of their parts counts
SURFACE_FRAMES = WARM_UP_STEPS + 3 * BLOCK_STEPS * TIMED_PARTS  # by which a surface is timed
# By slot, what is laid over a set-up: a run of particles that leaves the physical world is a failure.
WATCHED_SCENES: dict[str, dict[str, Any]] = {"fluid": {"health": {}}}


def run_order(case: str, set_up: str, coarse: bool, scheme: str, settings: dict[str, Any], patience: float) -> dict:
    """Order (job description as plain data) to run and time a set-up of a case; `settings`: scene settings by key;
    `patience`: processor time [s] after which no repetition starts."""
    order = {"task": __name__, "case": case, "set_up": set_up, "coarse": coarse, "scheme": scheme}
    return order | {"set": settings, "machine": {"patience": patience}}


def problem_of(case: str, set_up: str, coarse: bool, scheme: str) -> Problem:
    """Set-up `set_up` of a validation case, slow or not; if several have this name, the first that fits the scheme."""
    found = [problem for problem in problems(case, slow=True, coarse=coarse) if problem.name == set_up]
    return next(problem for problem in found if problem.schemes_for([scheme]))


def answer(order: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Run the set-up of an order on one thread, several times; outcome, errors (equal in all runs) and median costs."""
    problem = problem_of(order["case"], order["set_up"], order["coarse"], order["scheme"])
    watched = {"runtime.threads": 1} | WATCHED_SCENES.get(problem.slot, {})
    scene = problem.load(order["scheme"], watched | dict(order["set"]))
    began = perf_counter()
    run = measure_run(problem, order, scene)
    costs, repeats = run.pop("costs"), 1
    while run["outcome"] == "done" and repeats < MAX_REPEATS and process_time() < order["machine"]["patience"]:
        costs, repeats = costs + measure_run(problem, order, scene)["costs"], repeats + 1
    spent, cpu = ([cost[key] for cost in costs] for key in ("wall_per_s", "cpu_per_s"))
    clock = {"wall_per_s": median(spent), "wall_per_s_min": min(spent), "wall_per_s_max": max(spent)} if spent else {}
    clock |= {"cpu_per_s": median(cpu)} if cpu else {}
    clock |= {"repeats": repeats, "timings": len(costs)}
    return run | clock | {"wall_s": perf_counter() - began, "processor_s": process_time()}


def measure_run(problem: Problem, order: dict[str, Any], scene: Any) -> dict[str, Any]:
    """Run a set-up once with a scene; returns outcome, errors by quantity, particles, time step and costs."""
    with Clocked(scene) as simulation:
        try:
            found, reason = problem.measure(simulation).numbers, ""
        except Diverged as failure:
            found, reason = [(None, None, None)] * len(problem.promises), str(failure)
        for _ in range(SURFACE_FRAMES if problem.slot == "surface" else 0):
            simulation.frame()
        fluid = simulation.fluid
        return {
            "outcome": "stopped" if reason else "done",
            "reason": reason,
            "particles": 0 if fluid.particles is None else int(fluid.particles.count.now),
            "spacing_m": None if fluid.particles is None else float(fluid.particles.spacing),
            "neighbours": neighbour_count(fluid),
            "time_step_s": simulation.cost()["time_step_s"],
            "threads": simulation.backend.threads,
            "errors": [error_row(order, *each) for each in zip(problem.promises, found, strict=True)],
            "costs": simulation.costs(),
        }


def error_row(order: dict[str, Any], promise: Promise, number: Number) -> dict[str, Any]:
    """Row of a promised quantity: value, reference, error, unit, tolerance, and `ok` if it is within tolerance."""
    found = promise.row(order["case"], order["scheme"], *number)
    kept = ("quantity", "value", "reference", "error", "unit", "tolerance", "ok")
    numbers = plain_values({key: found[key] for key in ("value", "reference", "error")})
    return {key: found[key] for key in kept} | numbers


def neighbour_count(fluid: Fluid) -> float | None:
    """Mean number of neighbours of a particle at present; None for water without particles, or after it diverged."""
    water = fluid.of_particles
    if water is None:
        return None
    from scipy.spatial import cKDTree

    x = water.positions()
    if not np.isfinite(x).all():
        return None
    tree = cKDTree(x)
    return float(tree.count_neighbors(tree, water.grid.support)) / len(x) - 1.0
