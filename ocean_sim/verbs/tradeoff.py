"""`ocean-sim tradeoff`: computing cost and accuracy of settings, compared."""

import shutil
from pathlib import Path
from typing import Any

import typer

from ocean_sim.machine import available_cores
from ocean_sim.reading.translation import choice_sentence
from ocean_sim.studies import scene_tradeoff as scenes
from ocean_sim.studies.scene_tradeoff import Budget, Setting
from ocean_sim.studies.shared import pareto
from ocean_sim.studies.shared.scene_run import CLOCK_COLUMNS, run_order
from ocean_sim.studies.shared.study import Point, Study, write_table
from ocean_sim.studies.tradeoff import TRIAL_CASES, clock_column, equal_cost_rows, pareto_front, study_points
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.bar import rows_of
from ocean_sim.verbs.shared.console import cell
from ocean_sim.verbs.shared.options import Profile, Sets

EVERY_PROFILE = f"profile={','.join(scenes.PROFILE_NAMES)}"
STUDY_FILES = ("tradeoff.csv", "runs")  # in its folder; tables and pictures come later
CASE_COLUMNS = ("scheme", "particles", "neighbours", "wall_per_s", "cpu_per_s", "error", "unit", "changed", "")


def tradeoff(
    scene: str | None = typer.Argument(None, help="A scene; without one, the validation cases."),
    vary: list[str] | None = typer.Option(
        None, help="KEY=A,B,C; given several times: every combination. By default profile=ci,..."
    ),
    budget: str | None = typer.Option(
        None, help="16ms: wall time per 1/60 s simulated; realtime; 30s: wall time of the whole run."
    ),
    by: str | None = typer.Option(None, help="The error that decides: a column of tradeoff.csv, as heave_rms_m."),
    quick: bool = typer.Option(False, "--quick", help="Fewer runs and seeds: minutes instead of hours."),
    profile: Profile = None,
    sets: Sets = None,
    workers: int | None = typer.Option(None, min=1, help="Cases at a time; by default one per core."),
    out: Path | None = typer.Option(None, help="Where tables, pictures and runs go."),
) -> None:
    """Study cost and accuracy of the validation cases, or of a scene."""
    vary, sets = vary or [], sets or []
    if scene is not None:
        folder = out or Path("runs") / "tradeoff" / Path(scene).stem
        with console.claim(folder, *STUDY_FILES):
            limit, varied = None if budget is None else Budget.of(budget), scenes.vary_setting(vary or [EVERY_PROFILE])
            plan = scenes.setting_grid(scene, profile, console.set_values(sets), varied, quick)
            study_scene(plan, limit, by, quick, folder)
        return
    for name, given in (("vary", vary), ("budget", budget), ("by", by), ("profile", profile), ("set", sets)):
        if given:
            raise console.Refused(f"--{name} needs a scene, as in ocean-sim tradeoff SCENE --{name} ...")
    beside = () if out else ("*",)  # studies of scenes
    with console.claim(out or Path("runs/tradeoff"), *STUDY_FILES, *beside) as folder:
        study_cases(quick, workers, folder)


def study_cases(quick: bool, workers: int | None, out: Path) -> None:
    """Study validation cases (`quick`: fewer): tradeoff.csv, equal.csv (see `equal_cost_rows`), pictures in `out`."""
    plan = study_points(quick)
    console.say(f"{len(plan)} runs of {len({point.trial.case for point in plan})} cases, each on one thread")
    table = rows_of(Study(plan, out / "runs", workers or available_cores(), out / "tradeoff.csv"))
    shown = {trial.case: (trial.case, trial.quantity) for trial in TRIAL_CASES}
    drawn = {name: [row for row in table if (row["case"], row["quantity"]) == both] for name, both in shown.items()}
    speed = clock_column(table)
    fair = equal_cost_rows([row for here in drawn.values() for row in here], speed)
    write_table(out / "equal.csv", fair)
    for trial in TRIAL_CASES:
        if drawn[trial.case]:
            picture = out / f"tradeoff_{trial.case}.png"
            console.draw_if_able(pareto.draw_pareto, picture, trial, drawn[trial.case], speed)
            print_settings(f"{trial.case}: {trial.quantity}", drawn[trial.case], speed)
    console.answer(table)
    keys = ("case", "at equal", "scheme", "error", "unit", speed, "changed")
    lines = [[cell(row[key]) for key in keys] for row in fair]
    console.table("\nat equal time, and at equal number", list(keys), lines)
    if speed != "wall_per_s":
        console.say("the cores were busy, so processor time is compared; run it again on an idle machine")
    console.say(f"{out / 'tradeoff.csv'}, equal.csv, pictures; wall_per_s: wall seconds of steps per simulated second")


def print_settings(title: str, rows: list[dict[str, Any]], speed: str) -> None:
    """Print a case's runs, one a setting, by rising cost (column `speed`); stars: Pareto front of cost and error."""
    done = [row for row in rows if row.get("error") is not None and row.get(speed)]
    best = {id(done[k]) for k in pareto_front([(row[speed], abs(row["error"])) for row in done])}
    lost = [row for row in rows if row.get("error") is None]
    lines = [
        [*(cell(row.get(key)) for key in CASE_COLUMNS[:-1]), "*" if id(row) in best else row.get("reason", "")[:60]]
        for row in [*sorted(done, key=lambda row: row[speed]), *lost]
    ]
    console.table(f"\n{title}", list(CASE_COLUMNS), lines)


def study_scene(plan: list[Setting], limit: Budget | None, by: str | None, quick: bool, out: Path) -> None:
    """Run a scene with every setting of `plan` and every seed (`quick`: fewer), one at a time; write tradeoff.csv,
    seeds.csv and a picture into `out`. `by`: the error that decides (None: the first); `limit`: of time."""
    check_judge(by, scenes.possible_measures(plan[0].scenes[0]))
    seeds = scenes.SEED_COUNTS[quick] if any(setting.scenes[0].wind.is_random for setting in plan) else 1
    if not console.json_asked:
        finest = next(setting for setting in plan if setting.finest).line()
        each = f"{seeds} seeds each" if seeds > 1 else "one seed each, as nothing is drawn from it"
        console.say(f"{len(plan)} settings with {each}, one run at a time; the reference is {finest}")
    repeats = [Point(run_order(scene)) for setting in plan for scene in setting.scenes[:seeds]]
    found = rows_of(Study(repeats, out / "runs", 1))  # one at a time, for their time is measured
    rows, single = compare_with_finest(plan, seeds, found)
    write_table(out / "seeds.csv", single)
    write_table(out / "tradeoff.csv", rows)
    known = scenes.measure_names(rows)
    if not known:
        reason = next((row["reason"] for row in rows if row["reason"]), "nothing is logged that could be compared")
        raise console.Failed(f"there is nothing to compare: {reason}; {out / 'tradeoff.csv'}")
    check_judge(by, known)
    judge = by or known[0]
    known = [judge, *(name for name in known if name != judge)]
    console.draw_if_able(pareto.draw_scene, out / "tradeoff.png", rows, known[:6], limit)
    best_row = None if limit is None else confirmed_setting(plan, rows, judge, limit, seeds, out)
    console.answer({"judged_by": judge, "rows": rows, "answer": best_row, "clocks": scenes.clock_note(rows)})
    names = ["setting", *CLOCK_COLUMNS[:3], judge, f"{judge}_spread", *known[1:4]]
    lines = [
        [*(cell(row.get(name)) for name in names), "reference" if row["reference"] else row["reason"][:50]]
        for row in sorted(rows, key=lambda row: row["wall_per_s"] or 0.0)
    ]
    labels = [*map(scenes.measure_label, known)]
    console.table("", ["setting", *CLOCK_COLUMNS[:3], labels[0], "its spread", *labels[1:4], ""], lines)
    if told := scenes.clock_note(rows):
        console.say(f"warning: {told}")
    if limit is not None:
        console.say(budget_verdict(best_row, rows, judge, limit))
    console.say(f"{out / 'tradeoff.csv'}, seeds.csv and tradeoff.png")


def check_judge(by: str | None, known: list[str]) -> None:
    """Raise Refused if `by`, the error that decides, is not among the names `known`."""
    if by is not None and by not in known:
        raise console.Refused(f"--by {by}: there is no such error{choice_sentence(by, known)[0]}")


def compare_with_finest(plan: list[Setting], seeds: int, runs: list[dict[str, Any]]) -> tuple[list, list]:
    """Table rows of settings (`tradeoff_summary`) and of single runs, with errors against the run with the finest
    setting and equal seed. `runs`: their results, `seeds` for each setting of `plan`."""
    groups = [runs[n * seeds : (n + 1) * seeds] for n in range(len(plan))]
    finest = next(group for setting, group in zip(plan, groups) if setting.finest)
    rows, single = [], []
    for setting, group in zip(plan, groups):
        pairs = [(run["run"], best["run"], run["outcome"] == "done") for run, best in zip(group, finest)]
        gaps = [scenes.errors_against(run, best) if done else {} for run, best, done in pairs]
        for scene, run, gap in zip(setting.scenes, group, gaps):
            facts = {key: run.get(key) for key in ("outcome", "reason", *CLOCK_COLUMNS)}
            single.append(dict(setting.values) | {"seed": scene.seed} | facts | gap)
        rows.append(scenes.tradeoff_summary(setting, group, gaps))
    return rows, single


def confirmed_setting(
    plan: list[Setting], rows: list[dict[str, Any]], judge: str, limit: Budget, seeds: int, out: Path
) -> dict[str, Any] | None:
    """Best row within the budget `limit`, by the error `judge`, of `rows`, one for each setting of `plan`; None unless
    a run with a new seed, beyond the `seeds` used, confirms it. `out`: folder of the study."""
    left, again = list(rows), out / "runs" / "again"
    shutil.rmtree(again, ignore_errors=True)  # an earlier study's
    reference = next(setting for setting in plan if setting.finest)
    while (row := scenes.best_setting(left, judge, limit)) is not None:
        setting = plan[next(n for n, one in enumerate(rows) if one is row)]
        points = [Point(run_order(one.scenes[seeds])) for one in (setting, reference)]
        own, finest = rows_of(Study(points, again, 1))
        done = own["outcome"] == finest["outcome"] == "done"
        spent, error = limit.spent(own), scenes.errors_against(own["run"], finest["run"]).get(judge) if done else None
        bound = row[judge] + 3.0 * (row[f"{judge}_spread"] or 0.0)
        fits = spent is not None and spent <= limit.most
        if fits and error is not None and error <= bound * (1.0 + 1e-6):
            return {"setting": setting.line(), "spent": spent, "error": error, "bound": bound}
        row["reason"] = f"run again it spent {cell(spent)} and missed by {cell(error)} (bound {bound:.4g})"
        left = [one for one in left if one is not row]
    return None


def budget_verdict(found: dict[str, Any] | None, rows: list[dict[str, Any]], judge: str, limit: Budget) -> str:
    """Text on `found`, the best setting within `limit` by error `judge`; if None, on why none of `rows` fits."""
    if found is not None:
        begin = f"most accurate within {limit.name}, by the {scenes.measure_label(judge)}: {found['setting']}\n"
        middle = f"  run again with another seed: {found['spent']:.3g} of {limit.most:g},"
        return f"{begin}{middle} error {found['error']:.3g} (at most {found['bound']:.3g} expected)"
    tried = [row["reason"] for row in rows if row["reason"].startswith("run again")]
    spent = [cost for row in rows if row["outcome"] == "done" and (cost := limit.spent(row)) is not None]
    cheapest = f"the cheapest takes {min(spent):.3g} of {limit.most:g}" if spent else "no setting ran to its end"
    return f"nothing fits {limit.name}: {'; '.join([cheapest, *tried])}"
