"""Set-ups at coarse resolution, for a gate that tells of changes in a minute or two: their tolerances, and which ones
take longer than it has time for."""

from dataclasses import replace
from functools import cache

from ocean_sim.files import csv_file
from ocean_sim.validation.shared.case import Problem, Promise
from ocean_sim.validation.shared.tables import table_path

BASIS = "coarse: the measured error plus a quarter"


@cache
def tolerances() -> dict[tuple[str, str], dict[str, float]]:
    """By case and quantity: the tolerance of each scheme whose fine one does not hold at coarse resolution."""
    found: dict[tuple[str, str], dict[str, float]] = {}
    for row in csv_file.read_records(table_path("coarse").read_text(encoding="utf-8")):
        found.setdefault((row["case"], row["quantity"]), {})[row["scheme"]] = float(row["tolerance"])
    return found


@cache
def too_long() -> dict[tuple[str, str], float]:
    """By case and set-up: the processor time [s] of those that a gate has no time for, kernels in the cache."""
    rows = csv_file.read_records(table_path("too_long_for_a_gate").read_text(encoding="utf-8"))
    return {(row["case"], row["set-up"]): float(row["processor_s"]) for row in rows}


def coarse(case: str, problem: Problem) -> Problem:
    """A coarse set-up with tolerances of its own; slow where a gate has no time for it, or nothing to judge."""
    promises = tuple(promised(case, promise) for promise in problem.promises)
    judged = any(scheme in promise.tolerance for promise in promises for scheme in problem.schemes)
    slow = problem.slow or not judged or (case, problem.name) in too_long()
    return replace(problem, promises=promises, slow=slow)


def promised(case: str, promise: Promise) -> Promise:
    """What is promised at coarse resolution; what no row of the table names is promised as at the fine one."""
    own = tolerances().get((case, promise.quantity))
    if own is None:
        return promise
    return replace(promise, tolerance={**promise.tolerance, **own}, source=f"{promise.source}; {BASIS}")
