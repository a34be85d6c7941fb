"""Speed against accuracy over the validation cases: every scheme, coarse and fine, and one setting changed at a time.

Speed is wall time of the steps per simulated second, of a surface that of 60 frames, compilation left out, on one
thread; accuracy is each case's own error in its own unit, and no score is made of several. What failed stays in the
table and in the pictures.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from time import perf_counter, process_time
from typing import Any

import numpy as np

from ocean_sim.conventions import Diverged
from ocean_sim.files.yaml_file import SceneError, read_mapping
from ocean_sim.fluid import Fluid
from ocean_sim.model import Model
from ocean_sim.parts import compared
from ocean_sim.result import Result
from ocean_sim.studies import reads_key
from ocean_sim.studies.shared.scene_run import BLOCK_STEPS, TIMED_PARTS, WARM_UP_STEPS, Clocked, plain_values
from ocean_sim.studies.shared.study import Point
from ocean_sim.validation import problems
from ocean_sim.validation.shared.case import Number, Problem, Promise

PLAN: dict[str, Any] = read_mapping(Path(__file__).with_suffix(".yaml")).plain()
RESOLVED_SLOTS = ("fluid", "surface")  # slots whose cases are run coarse and fine
RESOLUTION_LEVELS = ((True, 1.0), (True, 0.5), (False, 1.0), (False, 0.5))  # coarse set-up or not; resolution over it
QUICK_LEVELS = 2
MAX_TIMED_SECONDS = {True: 4.0, False: 120.0}  # quick or not: processor time [s] after which a run is not timed again
BUSY_CLOCK_RATIO = 1.3  # wall over processor time of one thread beyond which the machine was busy
MAX_REPEATS = 3  # runs at most; the median time of their parts counts
SURFACE_FRAMES = WARM_UP_STEPS + 3 * BLOCK_STEPS * TIMED_PARTS  # by which a surface is timed


class Trial(Model):
    """A validation case and the `quantity` whose error pictures show; the study's table has all its quantities."""

    case: str
    quantity: str
    set_up: str = ""
    slot: str = "fluid"
    only: list[str] = []  # kinds of the slot that the case fits; by default all that are compared
    scatter: float | None = None  # scatter of experiments: a smaller error earns no credit
    quick: bool = True
    work: str = ""  # work that is timed, if not the steps

    @property
    def schemes(self) -> Sequence[str]:
        """Names of the schemes with which the case is run: kinds of a scene's part `slot`, as `mueller` of `fluid`."""
        return self.only or compared(self.slot)


TRIAL_CASES = tuple(Trial(**keys) for keys in PLAN["trials"])


@dataclass(frozen=True)
class CasePoint(Point):
    """One run: a validation case with a scheme and a resolution, and at most one other setting changed."""

    trial: Trial
    scheme: str
    coarse: bool
    settings: dict[str, Any]

    def rows(self, answer: dict[str, Any], run: Result) -> list[dict[str, Any]]:
        """Table rows of this run, one per error in its results `answer`; just one, without error, if it gave none."""
        names = {"case": self.trial.case, "set_up": self.trial.set_up, "scheme": self.scheme, "changed": self.changed}
        keys = ("resolution", *(key for axes in PLAN["axes"].values() for key in axes))
        head = names | {"coarse": self.coarse} | {key: self.settings.get(key) for key in keys}
        facts = {key: value for key, value in answer.items() if key != "errors"}
        errors = answer.get("errors") or [{"quantity": self.trial.quantity, "error": None}]
        return [head | facts | error for error in errors]

    @property
    def changed(self) -> str:
        """Changed setting other than the resolution, as text `key=value`; empty if there is none."""
        rest = {key: value for key, value in self.settings.items() if key != "resolution"}
        return ", ".join(f"{key}={value}" for key, value in rest.items())


def study_points(quick: bool) -> list[CasePoint]:
    """All runs of the study of validation cases, fewer if `quick`; the cheap (coarse) ones of all cases first."""
    found = [point for trial in TRIAL_CASES if trial.quick or not quick for point in _trial_points(trial, quick)]
    return sorted(found, key=lambda point: (not point.coarse, point.settings.get("resolution", 1.0) < 1.0))


def _trial_points(trial: Trial, quick: bool) -> Iterator[CasePoint]:
    """Yield a case's runs: each scheme at each resolution, and with each other setting changed; fewer if `quick`."""

    def point(scheme: str, coarse: bool, settings: dict[str, Any]) -> CasePoint:
        names = {"task": __name__, "case": trial.case, "set_up": trial.set_up, "coarse": coarse, "scheme": scheme}
        order = names | {"set": settings, "machine": {"patience": MAX_TIMED_SECONDS[quick]}}
        return CasePoint(order, trial, scheme, coarse, settings)

    for scheme in trial.schemes:
        slot = find_problem(trial.case, trial.set_up, True, scheme).slot
        for coarse, factor in _case_levels(trial, quick) if slot in RESOLVED_SLOTS else [(True, 1.0)]:
            yield point(scheme, coarse, {} if factor == 1.0 else {"resolution": factor})
        if trial.case in PLAN["quick"]["cases"] or not quick:
            for key, values in PLAN["axes"][slot].items():
                for value in PLAN["quick"]["values"].get(key, ()) if quick else values:
                    if _is_other_setting(other := point(scheme, True, {key: value})):
                        yield other


def _case_levels(trial: Trial, quick: bool) -> list[tuple[bool, float]]:
    """Resolutions of a case, coarse to fine (`quick`: fewer): (coarse set-up?, factor on its spacing), none twice."""
    spacings: dict[float, tuple[bool, float]] = {}
    for coarse, factor in RESOLUTION_LEVELS[:QUICK_LEVELS] if quick else RESOLUTION_LEVELS:
        spacing = find_problem(trial.case, trial.set_up, coarse, trial.schemes[0]).scene["fluid"]["spacing"] * factor
        spacings.setdefault(round(spacing, 9), (coarse, factor))
    return list(spacings.values())


def _is_other_setting(point: CasePoint) -> bool:
    """True if the scheme of a run reads the settings that the study changes, and they differ from its defaults."""
    if not all(reads_key(point.scheme, key) for key in point.settings):
        return False
    problem = find_problem(point.trial.case, point.trial.set_up, point.coarse, point.scheme)
    try:
        return problem.load(point.scheme, point.settings).resolved() != problem.load(point.scheme).resolved()
    except SceneError:
        return False


def clock_column(rows: list[dict[str, Any]]) -> str:
    """Name of the column of `rows` for speed: wall time, or processor time if other work kept the machine busy."""
    done = [row for row in rows if row.get("wall_per_s") and row.get("cpu_per_s")]
    shares = sorted(row["wall_per_s"] / row["cpu_per_s"] for row in done)
    return "cpu_per_s" if shares and shares[len(shares) // 2] > BUSY_CLOCK_RATIO else "wall_per_s"


def pareto_front(pairs: list[tuple[float, float]]) -> list[int]:
    """Indices of the pairs (cost, error) for which no other pair is as good in both and better in one."""
    kept: list[int] = []
    for k in sorted(range(len(pairs)), key=lambda k: pairs[k]):
        if not kept or pairs[k][1] < pairs[kept[-1]][1]:
            kept.append(k)
    return kept


def equal_cost_rows(rows: list[dict[str, Any]], speed: str) -> list[dict[str, Any]]:
    """Best run of each scheme in each case, a row each, at equal time or equal number of particles.

    Equal time, in the column that `speed` names, per simulated second, is that of the slowest scheme's cheapest run;
    equal numbers are compared for default settings only."""
    done = [row for row in rows if row.get("error") is not None and row.get(speed)]
    found = []
    for case in dict.fromkeys(row["case"] for row in done):
        here = [row for row in done if row["case"] == case]
        schemes = list(dict.fromkeys(row["scheme"] for row in here))
        time = max(min(row[speed] for row in here if row["scheme"] == scheme) for scheme in schemes)
        groups = {f"time up to {time:.3g} s/s": [row for row in here if row[speed] <= time]}
        plain = [row for row in here if not row["changed"] and row["particles"]]
        for n in sorted({row["particles"] for row in plain}):
            groups[f"{n} particles"] = [row for row in plain if row["particles"] == n]
        for name, group in groups.items():
            for scheme in schemes:
                own = [row for row in group if row["scheme"] == scheme]
                best = min(own, key=lambda row: abs(row["error"]), default=None)
                group_of = {"case": case, "at equal": name, "scheme": scheme}
                keys = ("error", "unit", speed, "particles", "changed")
                found.append(group_of | {key: None if best is None else best[key] for key in keys})
    return found


def find_problem(case: str, set_up: str, coarse: bool, scheme: str) -> Problem:
    """Set-up (`coarse` or not) of a case by its name `set_up`; of several, the first that allows the scheme."""
    found = [problem for problem in problems(case, slow=True, coarse=coarse) if problem.name == set_up]
    return next(problem for problem in found if problem.schemes_for([scheme]))


def answer(order: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Run the validation set-up that an order (job description) names, repeatedly, on one thread. Returns outcome,
    errors, which are equal in all runs, and median costs."""
    problem = find_problem(order["case"], order["set_up"], order["coarse"], order["scheme"])
    watched: dict[str, Any] = {"runtime.threads": 1}
    if problem.slot == "fluid":
        watched["health"] = {}  # a run of particles that leaves the physical world is a failure
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
    """Run the set-up `problem` of an order (job description) once; returns outcome, errors by quantity, number of
    particles, time step and costs."""
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
    """Table row of one quantity (`promise`) in the run of `order` (job description): value, reference and error from
    `number`, unit, tolerance, and `ok` if within tolerance."""
    found = promise.row(order["case"], order["scheme"], *number)
    kept = ("quantity", "value", "reference", "error", "unit", "tolerance", "ok")
    numbers = plain_values({key: found[key] for key in ("value", "reference", "error")})
    return {key: found[key] for key in kept} | numbers


def neighbour_count(fluid: Fluid) -> float | None:
    """Mean number of neighbours of a particle now; None for water without particles, or after it diverged."""
    water = fluid.of_particles
    if water is None:
        return None
    from scipy.spatial import cKDTree

    x = water.positions()
    if not np.isfinite(x).all():
        return None
    tree = cKDTree(x)
    return float(tree.count_neighbors(tree, water.grid.support)) / len(x) - 1.0
