"""Speed against accuracy over the validation cases: every scheme, coarse and fine, and one setting changed at a time.

Speed is wall time of the steps per simulated second, of a surface that of 60 frames, compilation left out, on one
thread; accuracy is each case's own error in its own unit, and no score is made of several. What failed stays in the
table and in the pictures.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from ocean_sim.files.yaml_file import SceneError
from ocean_sim.parts import compared
from ocean_sim.result import Result
from ocean_sim.studies import reads_key
from ocean_sim.studies.shared.case_run import problem_of, run_order

# By what a scheme is a kind of; the default of a scheme is run in any case.
SETTING_AXES: dict[str, dict[str, tuple]] = {
    "fluid": {
        "fluid.support_ratio": (2.0, 2.5, 3.0, 4.0),
        "time_step.courant_number": (0.3, 1.0),
        "fluid.compression": (0.0025, 0.04),
        "runtime.precision": ("f64",),
    },
    "ship": {"ship.cells_per_draught": (2, 4, 8, 16), "time_step.dt": (0.01, 0.02, 0.08)},
    "surface": {"surface.spacing": (0.05, 0.1, 0.2, 0.4)},
}
RESOLVED_SLOTS = ("fluid", "surface")  # slots whose cases are run coarse and fine
RESOLUTION_LEVELS = ((True, 1.0), (True, 0.5), (False, 1.0), (False, 0.5))  # coarse set-up or not; resolution over it
QUICK_LEVELS = 2
QUICK_VARIED = ("standing_wave", "taylor_green", "ship_rao", "surface_slab")
QUICK_VALUES: dict[str, tuple] = {
    "fluid.support_ratio": (2.0, 3.0),
    "time_step.courant_number": (1.0,),
    "fluid.compression": (0.04,),
    "runtime.precision": ("f64",),
    "ship.cells_per_draught": (2, 8),
    "surface.spacing": (0.1, 0.2),
}
MAX_TIMED_SECONDS = {True: 4.0, False: 120.0}  # quick or not: processor time [s] after which a run is not timed again
BUSY_CLOCK_RATIO = 1.3  # wall over processor time of one thread beyond which the machine was busy


@dataclass(frozen=True)
class Trial:
    """A validation case, and the one of its errors that pictures show; the table of the study holds all of them."""

    case: str
    quantity: str
    set_up: str = ""
    slot: str = "fluid"
    only: tuple[str, ...] = ()  # kinds of the slot that the case fits; by default all that are compared
    scatter: float | None = None  # scatter of experiments: a smaller error earns no credit
    quick: bool = True
    work: str = ""  # work that is timed, if not the steps

    @property
    def schemes(self) -> tuple[str, ...]:
        """Names of the schemes, kinds of the slot `slot`, with which the case is run."""
        return self.only or compared(self.slot)


TRIAL_CASES = (
    Trial("hydrostatic", "pressure, L2 over rho g H"),
    Trial("standing_wave", "Re 250: decay rate [1/s]", "Re 250"),
    Trial("dam_break_front", "mean distance of the front, Martin & Moyce, a = 2.25 in [a]", scatter=8.0),
    Trial("elliptical_drop", "minor semi-axis [m]"),
    Trial("taylor_green", "L1 of the speed at t = 1"),
    Trial("square_patch", "largest void [spacings]"),
    Trial("sloshing", "period of the first mode [s]", quick=False),
    Trial("wall_impact", "impulse p* t* to t* = 5.5, Buchner 2002", quick=False),
    Trial("ship_rao", "barge20, head sea, 0.8 rad/s: heave [m/m]", "barge20, head sea", "ship"),
    Trial("surface_slab", "height of the wave [m]", "", "surface", work="60 frames of the surface"),
    Trial("ship_periods", "by rule: heave period [s]", "by rule", "ship", ("dynamic",), quick=False),
    Trial("ship_drop", "constant: rms of heave [m]", "constant", "ship", ("dynamic",), scatter=0.033, quick=False),
    Trial("ship_drop", "memory: rms of heave [m]", "memory", "ship", ("dynamic",), scatter=0.033, quick=False),
)


@dataclass(frozen=True)
class Point:
    """One run of the study: a case under a scheme, at a resolution, with at most one other setting changed."""

    trial: Trial
    scheme: str
    coarse: bool
    settings: dict[str, Any]
    patience: float

    def order(self) -> dict[str, Any]:
        given = (self.trial.case, self.trial.set_up, self.coarse, self.scheme, self.settings, self.patience)
        return run_order(*given)

    def rows(self, answer: dict[str, Any], run: Result) -> list[dict[str, Any]]:
        """One row for each error of the case; a single row without an error if the run gave none."""
        names = {"case": self.trial.case, "set_up": self.trial.set_up, "scheme": self.scheme, "changed": self.changed}
        keys = ("resolution", *(key for axes in SETTING_AXES.values() for key in axes))
        head = names | {"coarse": self.coarse} | {key: self.settings.get(key) for key in keys}
        facts = {key: value for key, value in answer.items() if key != "errors"}
        errors = answer.get("errors") or [{"quantity": self.trial.quantity, "error": None}]
        return [head | facts | error for error in errors]

    @property
    def changed(self) -> str:
        """Setting other than resolution that differs from the default, as text `key=value`; empty if none does."""
        rest = {key: value for key, value in self.settings.items() if key != "resolution"}
        return ", ".join(f"{key}={value}" for key, value in rest.items())


def study_points(quick: bool) -> list[Point]:
    """All runs of the study, the cheap ones of all cases first."""
    found = [point for trial in TRIAL_CASES if trial.quick or not quick for point in _of_trial(trial, quick)]
    return sorted(found, key=lambda point: (not point.coarse, point.settings.get("resolution", 1.0) < 1.0))


def _of_trial(trial: Trial, quick: bool) -> Iterator[Point]:
    """Yield the runs of one case: every scheme, at each resolution, and with each other setting changed."""
    for scheme in trial.schemes:
        slot = problem_of(trial.case, trial.set_up, True, scheme).slot
        for coarse, factor in _case_levels(trial, quick) if slot in RESOLVED_SLOTS else [(True, 1.0)]:
            settings = {} if factor == 1.0 else {"resolution": factor}
            yield Point(trial, scheme, coarse, settings, MAX_TIMED_SECONDS[quick])
        if trial.case in QUICK_VARIED or not quick:
            for key, values in SETTING_AXES[slot].items():
                for value in QUICK_VALUES.get(key, ()) if quick else values:
                    point = Point(trial, scheme, True, {key: value}, MAX_TIMED_SECONDS[quick])
                    if _is_other_setting(point):
                        yield point


def _case_levels(trial: Trial, quick: bool) -> list[tuple[bool, float]]:
    """Resolutions of a case, (coarse set-up or not, factor on its spacing), from coarse to fine, each spacing once."""
    spacings: dict[float, tuple[bool, float]] = {}
    for coarse, factor in RESOLUTION_LEVELS[:QUICK_LEVELS] if quick else RESOLUTION_LEVELS:
        spacing = problem_of(trial.case, trial.set_up, coarse, trial.schemes[0]).scene["fluid"]["spacing"] * factor
        spacings.setdefault(round(spacing, 9), (coarse, factor))
    return list(spacings.values())


def _is_other_setting(point: Point) -> bool:
    """True if the scheme reads the settings of the point, and they differ from its defaults."""
    if not all(reads_key(point.scheme, key) for key in point.settings):
        return False
    problem = problem_of(point.trial.case, point.trial.set_up, point.coarse, point.scheme)
    try:
        return problem.load(point.scheme, point.settings).resolved() != problem.load(point.scheme).resolved()
    except SceneError:
        return False


def clock_column(rows: list[dict[str, Any]]) -> str:
    """Name of the column by which speed is compared: wall time, or processor time if the machine was busy."""
    done = [row for row in rows if row.get("wall_per_s") and row.get("cpu_per_s")]
    shares = sorted(row["wall_per_s"] / row["cpu_per_s"] for row in done)
    return "cpu_per_s" if shares and shares[len(shares) // 2] > BUSY_CLOCK_RATIO else "wall_per_s"


def pareto_front(pairs: list[tuple[float, float]]) -> list[int]:
    """Indices of pairs (cost, error) on the Pareto front: no other is as good in both and better in one."""
    order = sorted(range(len(pairs)), key=lambda k: pairs[k])
    kept: list[int] = []
    for k in order:
        if not kept or pairs[k][1] < pairs[kept[-1]][1]:
            kept.append(k)
    return kept


def equal_cost_rows(rows: list[dict[str, Any]], speed: str) -> list[dict[str, Any]]:
    """Best row of each scheme in each case, at equal time (column `speed`) and at equal numbers of particles.

    Equal time is that of the slowest scheme's cheapest run; equal numbers are compared with default settings only.
    """
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
