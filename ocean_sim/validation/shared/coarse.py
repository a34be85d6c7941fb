"""Tolerances of set-ups at coarse resolution, for a gate of minutes that tells of changes."""

from dataclasses import replace
from functools import cache

from ocean_sim.files import csv_file
from ocean_sim.validation.shared.case import Problem, Promise
from ocean_sim.validation.shared.tables import table_path

BASIS = "coarse: what was measured and a quarter more"


@cache
def tolerances() -> dict[tuple[str, str], dict[str, float]]:
    """By case and quantity: the tolerance of each scheme whose fine one does not hold at coarse resolution."""
    found: dict[tuple[str, str], dict[str, float]] = {}
    for row in csv_file.records(table_path("coarse").read_text(encoding="utf-8")):
        found.setdefault((row["case"], row["quantity"]), {})[row["scheme"]] = float(row["tolerance"])
    return found


def coarse(case: str, problem: Problem) -> Problem:
    """A coarse set-up with tolerances of its own."""
    return replace(problem, promises=tuple(promised(case, promise) for promise in problem.promises))


def promised(case: str, promise: Promise) -> Promise:
    """What is promised at coarse resolution; what no row of the table names is promised as at the fine one."""
    own = tolerances().get((case, promise.quantity))
    if own is None:
        return promise
    return replace(promise, tolerance={**promise.tolerance, **own}, source=f"{promise.source}; {BASIS}")
