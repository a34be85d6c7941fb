"""Speed against accuracy of one scene: every setting compared with the finest, by what a user sees, with several seeds.

An error is the distance from the run with the finest setting and the same seed: of heights and periods of the waves at
each gauge, and the rms of elevations, of the six motions and of leg lengths over time. The seeds show its spread, and a
setting is better than another only beyond that.
"""

import json
import re
from dataclasses import dataclass
from itertools import product
from math import prod
from shlex import quote
from statistics import mean, median, stdev
from typing import Any

import numpy as np

from ocean_sim.conventions import Motions, Unsuited
from ocean_sim.files.yaml_file import Location, Node, Problem, SceneError, node_of, parse_yaml, problem_at
from ocean_sim.parts import ALONE, SLOTS, from_coarse, slot_of
from ocean_sim.reading.scene import SceneConfig, load
from ocean_sim.result import Result
from ocean_sim.studies.shared import scene_run

PROFILE_NAMES = ("ci", "interactive", "thesis", "reference")
SEED_COUNTS = {True: 2, False: 5}  # quick or not
MOST_SETTINGS = 200
CLOCKS_APART = 1.5  # ratio of wall and processor time from which on it is told
MORE_IS_FINER = (
    "particles cells order support_ratio cells_per_draught max_density_iterations max_divergence_iterations"
).split()
FROM_COARSE = {  # what can be named, from the coarsest to the finest
    "profile": PROFILE_NAMES,
    "runtime.precision": ("f32", "f64"),
}
ERROR_WORDS = {  # by the end of a name
    "rms": "rms error",
    "hs": "error of H1/3",
    "hm0": "error of 4 sqrt m0",
    "tz": "error of the mean period",
}
WAVE_MEASURES = ("rms_m", "hs_m", "hm0_m", "tz_s")  # at a gauge
Varied = dict[str, list[Node]]


@dataclass(frozen=True)
class Budget:
    """Time limit of a run: per frame of 1/60 s simulated [ms], per simulated second [s], or for the whole run [s]."""

    name: str
    most: float

    @classmethod
    def of(cls, text: str) -> "Budget":
        """Budget from a text: `realtime`, `16ms` (per frame) or `30s` (whole run). Raises Unsuited for other texts."""
        found = re.fullmatch(r"(\d+(?:\.\d+)?)(ms|s)|realtime", text.strip())
        if found is None or (found[1] and float(found[1]) <= 0.0):
            takes = "give realtime, or a time as in 16ms (of 1/60 s simulated) or 30s (in all)"
            raise Unsuited(f"--budget {text}: {takes}")
        return cls(text.strip(), float(found[1]) if found[1] else 1.0)

    def seconds(self, row: dict[str, Any]) -> float | None:
        """Time [s] per simulated second, or of the whole run if that is limited, from `row` of a study's table: the
        smaller of wall and processor time (waiting raises the one, several cores the other). None without both."""
        unit = "per_s" if self.name == "realtime" or self.name.endswith("ms") else "s"
        return min(filter(None, (row.get(f"wall_{unit}"), row.get(f"cpu_{unit}"))), default=None)

    def spent(self, row: dict[str, Any]) -> float | None:
        """Time of the run in `row` of a study's table, in [ms] a frame or [s] as limited; None if unknown."""
        cost = self.seconds(row)
        return 1e3 * cost / 60.0 if cost is not None and self.name.endswith("ms") else cost


@dataclass(frozen=True)
class Setting:
    """One combination of values of the varied keys, with a scene for each seed; `finest` marks the reference."""

    values: dict[str, Any]
    scenes: tuple[SceneConfig, ...]
    finest: bool

    def line(self) -> str:
        """Command-line options of `ocean-sim run SCENE` that select this setting."""
        words = [f"--profile {self.values['profile']}"] if "profile" in self.values else []
        for key, value in self.values.items():
            if key != "profile":
                text = value if isinstance(value, str) else json.dumps(value)  # which YAML reads
                words.append(f"--set {quote(f'{key}={text}')}")
        return " ".join(words)


def vary_setting(texts: list[str]) -> Varied:
    """Parse texts KEY=A,B,C into the values to try, by key; raises SceneError if one is malformed."""
    found: Varied = {}
    for text in texts:
        key, equals, values = text.partition("=")
        location = Location(f"--vary {text}")
        if not equals or not key.strip() or not values.strip():
            raise SceneError([problem_at(location, "", "expected KEY=A,B,C, as in fluid.spacing=1.0,0.8,0.6")])
        nodes = node_of(parse_yaml(f"[{values}]", location).plain(), location).data
        if not isinstance(nodes, list) or not nodes:
            raise SceneError([problem_at(location, key, "there are no values")])
        found[key.strip()] = nodes
    return found


def finest_setting(key: str, values: list[Any]) -> Any:
    """Finest value of a key: the last in a known order, the greatest for keys in MORE_IS_FINER, else the least."""
    place, _, name = key.rpartition(".")
    if key in FROM_COARSE or (slot_of(place) in SLOTS and name == "kind"):
        order = FROM_COARSE.get(key) or from_coarse(slot_of(place))
        return max(values, key=lambda value: order.index(value) if value in order else -1)
    if all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
        return max(values) if key.split(".")[-1] in MORE_IS_FINER else min(values)
    return values[-1]


def setting_grid(scene: str, profile: str | None, sets: dict[str, Node], vary: Varied, quick: bool) -> list[Setting]:
    """Settings of a scene under `profile` and `sets` for all combinations of values in `vary`, the finest marked. Each
    has SEED_COUNTS scenes (fewer if `quick`) of unlike seed, and one to confirm it if best. Raises SceneError."""
    count = prod(map(len, vary.values()))
    if not 2 <= count <= MOST_SETTINGS:
        message = f"there are {count} settings; 2 to {MOST_SETTINGS} can be compared"
        raise SceneError([problem_at(Location("--vary"), "", message)])
    best = {key: finest_setting(key, [node.plain() for node in nodes]) for key, nodes in vary.items()}
    found: list[Setting] = []
    problems: list[Problem] = []
    for nodes in product(*vary.values()):
        chosen = dict(zip(vary, nodes))
        values = {key: node.plain() for key, node in chosen.items()}
        own = str(values["profile"]) if "profile" in values else profile
        laid = sets | {key: node for key, node in chosen.items() if key != "profile"}
        try:
            found.append(Setting(values, _with_seed(scene, own, laid, SEED_COUNTS[quick] + 1), values == best))
        except SceneError as error:
            problems += error.problems
    if problems:
        raise SceneError(problems)
    return found


def _with_seed(scene: str, profile: str | None, sets: dict[str, Node], count: int) -> tuple[SceneConfig, ...]:
    """Load a scene (see `load`) with `count` successive seeds, no pictures; without ship and gauge it gets a gauge."""
    quiet: dict[str, Any] = dict.fromkeys(scene_run.PICTURE_OBSERVERS) | sets
    first = load(scene, quiet, profile)
    if not first.ships and "gauges" not in first.observers:
        middle = [0.0, 0.0] if first.basin.width is not None else [0.0]
        quiet = {"gauges.elevation": {"centre": middle}} | quiet
    return tuple(load(scene, quiet | {"seed": first.seed + k}, profile) for k in range(count))


def errors_against(result: Result, reference: Result) -> dict[str, float | None]:
    """Errors of a run against a reference run, by quantity: rms over time, wave heights, wave periods [m, rad, s]."""
    found: dict[str, float | None] = {}
    legs = []
    motions = [f"{name}_{unit}" for name, unit in zip(Motions._fields, scene_run.MOTION_UNITS)]
    afloat = scene_run.motion_tables(reference)
    tables = {"gauges": None, **dict.fromkeys(afloat, motions), "platform": [f"leg{k}_m" for k in range(1, 7)]}
    for table, columns in tables.items():
        own, other = scene_run.unwrapped_table(result, table), scene_run.unwrapped_table(reference, table)
        for name in columns or [key for key in other if key.endswith("_m")]:
            if not (len(own.get(name, ())) and len(other.get(name, ()))):
                continue
            whole = 2.0 * np.pi if name.endswith("_rad") else np.inf
            apart = rms_difference(own["time_s"], own[name], other["time_s"], other[name], whole)
            if table == "platform":
                legs.append(apart)
            else:
                stem, unit = name.rsplit("_", 1)
                found[f"{afloat.get(table, '')}{stem}_rms_{unit}"] = apart
            if table == "gauges":
                found |= _wave_errors(name.removesuffix("_m"), own, other)
    return found | ({"legs_rms_m": float(np.sqrt(np.mean(np.square(legs))))} if legs else {})


def possible_measures(scene: SceneConfig) -> list[str]:
    """Names of the errors that runs of a scene can have, as `errors_against` gives them."""
    gauges = scene.observers["gauges"].model_dump() if "gauges" in scene.observers else {}
    names = [name for key in ("elevation", "runup") for name in gauges.get(key, ())]
    found = [f"{name}_{kind}" for name in names for kind in WAVE_MEASURES]
    motions = [f"{name}_rms_{unit}" for name, unit in zip(Motions._fields, scene_run.MOTION_UNITS)]
    found += [motion if ship == ALONE else f"{ship}_{motion}" for ship in scene.ships for motion in motions]
    return found + ["legs_rms_m"] * (scene.platform is not None)


def _wave_errors(gauge: str, own: dict[str, np.ndarray], other: dict[str, np.ndarray]) -> dict[str, float | None]:
    """Differences of wave heights [m] and period [s] at a gauge, by name, between the gauge records (columns by name)
    of a run, `own`, and of the reference, `other`; None without waves."""
    a, b = (scene_run.wave_heights(gauge, table["time_s"], table[f"{gauge}_m"]) for table in (own, other))
    return {key: abs(a[key] - b[key]) if a[key] is not None and b[key] is not None else None for key in b}  # type: ignore[operator]


def rms_difference(
    time: np.ndarray, values: np.ndarray, other_time: np.ndarray, others: np.ndarray, whole: float = np.inf
) -> float:
    """Rms difference of `values` (n,) and `others` (m,) at shared times, or NaN; `whole`: full turn [rad] of angles."""
    shared = other_time[(other_time >= time[0]) & (other_time <= time[-1])]
    gap = np.interp(shared, time, values) - np.interp(shared, other_time, others)
    if np.isfinite(whole):
        gap = gap - whole * np.round(gap / whole)
    return float(np.sqrt(np.mean(gap**2))) if len(shared) else float("nan")


def tradeoff_summary(
    setting: Setting, answers: list[dict[str, Any]], apart: list[dict[str, float | None]]
) -> dict[str, Any]:
    """Table row of a setting: medians of the costs in `answers` (results of its runs, one per seed), mean and spread of
    `apart`, their errors against the finest setting by quantity; errors are None if a run failed."""
    lost = next((answer for answer in answers if answer["outcome"] != "done"), None)
    row: dict[str, Any] = dict(setting.values) | {
        "setting": setting.line(),
        "reference": setting.finest,
        "outcome": "done" if lost is None else lost["outcome"],
        "reason": "" if lost is None else lost["reason"],
    }
    for key in (*scene_run.CLOCK_COLUMNS, "particles", "threads"):
        known = [answer[key] for answer in answers if answer.get(key) is not None]
        row[key] = median(known) if known else None
    for name in dict.fromkeys(name for found in apart for name in found):
        known = [found[name] for found in apart if found.get(name) is not None]
        row[name] = mean(known) if known and lost is None else None
        row[f"{name}_spread"] = stdev(known) if len(known) > 1 and lost is None else None
    return row


def measure_names(rows: list[dict[str, Any]]) -> list[str]:
    """Names of all errors in the rows, ordered: leg lengths, motions, elevations, wave heights, periods."""
    names = [name.removesuffix("_spread") for row in rows for name in row if name.endswith("_spread")]
    motions = [f"{name}_rms" for name in ("heave", "pitch", "roll", "surge", "sway", "yaw")]
    order = ["legs_rms", *motions, "_rms_", "_hs_", "_hm0_", "_tz_"]
    return sorted(dict.fromkeys(names), key=lambda name: next((k for k, word in enumerate(order) if word in name), 99))


def measure_label(name: str) -> str:
    """Label of an error named by `errors_against`: "rms error of gauge `end` [m]" for `end_rms_m`."""
    stem, unit = name.rsplit("_", 1)
    of, _, kind = stem.rpartition("_")
    moves = of.rpartition("_")[2] in (*Motions._fields, "legs")
    return f"{ERROR_WORDS[kind]} of {of.replace('_', ' ') if moves else f'gauge `{of}`'} [{unit}]"


def best_setting(rows: list[dict[str, Any]], by: str, budget: Budget) -> dict[str, Any] | None:
    """Cheapest row within the budget whose error, column `by`, is least to within the spread over seeds; or None."""
    able = [row for row in rows if row.get(by) is not None and (budget.spent(row) or np.inf) <= budget.most]
    if not able:
        return None
    least = min(able, key=lambda row: row[by])

    def alike(row: dict[str, Any]) -> bool:
        return row[by] - least[by] <= max(one[f"{by}_spread"] or 0.0 for one in (row, least))

    return min(filter(alike, able), key=lambda row: budget.spent(row) or np.inf)


def clock_note(rows: list[dict[str, Any]]) -> str:
    """Sentence for the user if wall and processor time in `rows` differ by CLOCKS_APART times or more; else empty."""
    shares = [row["wall_per_s"] / row["cpu_per_s"] for row in rows if row["wall_per_s"] and row["cpu_per_s"]]
    share = median(shares) if shares else 1.0
    if 1.0 / CLOCKS_APART <= share <= CLOCKS_APART:
        return ""
    why = "the machine was busy" if share > 1.0 else "several cores worked at once"
    return f"{why}: wall time is {share:.3g} times processor time; the less of the two counts"
