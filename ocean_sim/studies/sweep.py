"""Many runs of one scene from a plan: settings in lists and grids, and seeds.

    scene: ship_linear_sea          # a file, or the name of a packaged scene
    profile: ci                     # as in `run`; may be left out, like all that follows
    set: {duration: 5.0}            # for every run
    list: [{fluid.period: 4.0}, {fluid.period: 6.0, fluid.height: 0.5}]   # each entry is a group of runs
    grid: {ship.kind: [hydrostatic, dynamic], ship.heading_deg: [0, 45]}  # every combination, in each group
    seeds: [1, 2, 3]                # each of these again with every seed

What stands further down takes precedence. Pictures and frames are made only where the plan asks for them.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from math import prod
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from ocean_sim.files.yaml_file import Location, Node, Problem, SceneError, node_of, problem_at, read_mapping
from ocean_sim.model import Model
from ocean_sim.reading.scene import SceneConfig, load
from ocean_sim.reading.translation import checked
from ocean_sim.result import Result
from ocean_sim.studies.shared.scene_run import CLOCK_COLUMNS, PICTURE_OBSERVERS, run_order
from ocean_sim.studies.shared.study import Point

MOST_RUNS = 10_000
Settings = dict[str, Node]
Groups = Annotated[list[dict[str, Any]], Field(min_length=1)]
Values = Annotated[list[Any], Field(min_length=1)]


class PlanConfig(Model):
    """Keys of the plan file of a sweep."""

    scene: str
    """A scene file, next to the plan or in the working folder, or the name of a packaged scene."""
    profile: str | None = None
    """A profile, which says what the machine can afford: a name in configs/run/."""
    set: dict[str, Any] = {}
    """Settings of every run."""
    list: Groups = []
    """Settings of a group of runs each."""
    grid: dict[str, Values] = {}
    """Values by key; every combination is run."""
    seeds: Values = []
    """Seeds with which everything is run again."""


@dataclass(frozen=True)
class Planned(Point):
    """One run of a plan, with its own settings and its scene as they were when the plan was read."""

    settings: dict[str, Any]
    scene: SceneConfig

    def rows(self, answer: dict[str, Any], run: Result) -> list[dict[str, Any]]:
        """Table row of this run, in a list: settings, results `answer`, last clock times, which differ if repeated."""
        head = {"run": run.folder.name} | self.settings
        facts = {key: value for key, value in answer.items() if key not in CLOCK_COLUMNS}
        return [head | facts | {key: answer.get(key) for key in CLOCK_COLUMNS}]


def read_plan(path: Path, threads: int | None = None) -> list[Planned]:
    """Runs in a plan file; `threads`: for scenes that set none. Raises SceneError with all problems."""
    node = read_mapping(path)
    plan, problems = checked(PlanConfig, node), list[Problem]()
    count = max(1, len(plan.list)) * prod(map(len, plan.grid.values())) * max(1, len(plan.seeds))
    if count > MOST_RUNS:
        raise SceneError([problem_at(node.location, "", f"this plan has {count} runs; {MOST_RUNS} are the most")])
    shared = node.data["set"].data if "set" in node.data else {}
    runs, beside = [], path.parent / plan.scene
    for settings in _grid_settings(node):
        try:
            laid = shared | settings
            named = {key.split(".")[0] for key in laid}  # pictures are made only where the plan asks for them
            quiet = {name: node_of(None, Location("sweep")) for name in PICTURE_OBSERVERS if name not in named}
            scene = load(beside if beside.is_file() else plan.scene, quiet | laid, plan.profile)
            plain = {key: value.plain() for key, value in settings.items()}
            runs.append(Planned(run_order(scene, threads), plain, scene))
        except SceneError as error:
            problems += [_locate_problem(node, laid, found) for found in error.problems]
    if problems:
        raise SceneError(problems)
    return runs


def _grid_settings(node: Node) -> Iterator[Settings]:
    """Yield the settings of each run of a plan, by key; each value is a node that knows its line in the file."""
    listed, grid, seeds = (node.child(key) for key in ("list", "grid", "seeds"))
    groups = [group.data for group in listed.data] if listed is not None else [{}]
    keys = list(grid.data) if grid is not None else []
    values = [grid.data[key].data for key in keys] if grid is not None else []
    again = [{"seed": seed} for seed in seeds.data] if seeds is not None else [{}]
    for group, combination, seed in product(groups, product(*values), again):
        yield {**group, **dict(zip(keys, combination)), **seed}


def _locate_problem(plan: Node, settings: Settings, found: Problem) -> Problem:
    """Copy of the problem `found` in a run's scene, moved to the line of the plan file that caused it; unchanged if it
    has a line of its own and the plan does not set its key."""
    touched = [value for key, value in settings.items() if key.split(".")[0] == found.key.split(".")[0]]
    if found.line is not None and found.file != plan.location.file and touched:
        message = f"{found.message} (together with {found.file}:{found.line})"
        return problem_at(touched[-1].location, found.key, message, found.suggestion)
    if found.line is not None:
        return found
    key = "profile" if found.file.startswith("--profile") else "scene"
    message = f"{found.file}: {found.message}" if key == "scene" else found.message
    if key == "scene" and not Path(found.file).exists():
        message += f" (looked for next to the plan and in {Path.cwd()})"
    return problem_at(plan.data[key].location, found.key or key, message, found.suggestion)
