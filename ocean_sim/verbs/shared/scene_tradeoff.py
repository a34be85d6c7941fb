"""`ocean-sim tradeoff SCENE`: settings of one scene compared with the finest, and the best that a budget allows."""

import shutil
from pathlib import Path
from typing import Any

from ocean_sim.reading.translation import choice_sentence
from ocean_sim.result import Result
from ocean_sim.studies.scene_tradeoff import (
    PROFILES,
    SEEDS,
    Budget,
    Setting,
    best,
    clocks_differ,
    errors,
    folder_of,
    measures,
    settings,
    summary,
    varied,
)
from ocean_sim.studies.shared import pareto, table
from ocean_sim.studies.shared.scene_run import CLOCKS
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.sweep import shown, text

EVERY_PROFILE = f"profile={','.join(PROFILES)}"


def of_scene(
    scene: str,
    profile: str | None,
    sets: list[str],
    vary: list[str],
    budget: str | None,
    by: str | None,
    quick: bool,
    out: Path,
    as_json: bool,
) -> None:
    """Runs every setting with every seed, one run at a time; leaves tradeoff.csv, seeds.csv and a picture."""
    limit = asked(budget)
    plan = settings(scene, profile, console.settings(sets), varied(vary or [EVERY_PROFILE]), quick)
    seeds = SEEDS[quick] if any(setting.scenes[0].wind.is_random for setting in plan) else 1
    if not as_json:
        finest = next(setting for setting in plan if setting.finest).line()
        each = f"{seeds} seeds each" if seeds > 1 else "one seed each, as nothing is drawn from it"
        console.say(f"{len(plan)} settings with {each}, one run at a time; the reference is {finest}")
    pairs = [(setting, k) for setting in plan for k in range(seeds)]
    answers = made([setting.order(k) for setting, k in pairs], out, as_json)
    rows, single = compared(plan, seeds, answers, out)
    table.write(out / "seeds.csv", single)
    table.write(out / "tradeoff.csv", rows)
    known = measures(rows)
    if not known:
        reason = next((row["reason"] for row in rows if row["reason"]), "nothing is logged that could be compared")
        raise console.Failed(f"there is nothing to compare: {reason}; {out / 'tradeoff.csv'}")
    if by is not None and by not in known:
        raise console.Refused(f"--by {by}: there is no such error{choice_sentence(by, known)[0]}")
    judge = by or known[0]
    known = [judge, *(name for name in known if name != judge)]
    console.drawn(pareto.draw_scene, out / "tradeoff.png", rows, known[:6], limit)
    found = None if limit is None else answer(plan, rows, judge, limit, seeds, out, as_json)
    if as_json:
        console.answer({"judged_by": judge, "rows": rows, "answer": found, "clocks": clocks_differ(rows)})
        return
    show(rows, known)
    if limit is not None:
        console.say(verdict(found, rows, judge, limit))
        if told := clocks_differ(rows):
            console.say(told)
    console.say(f"{out / 'tradeoff.csv'}, seeds.csv and tradeoff.png")


def asked(budget: str | None) -> Budget | None:
    """The budget that was asked for."""
    try:
        return None if budget is None else Budget.of(budget)
    except ValueError as why:
        raise console.Refused(str(why)) from None


def made(orders: list[dict[str, Any]], out: Path, quiet: bool) -> list[dict[str, Any]]:
    """The answers of orders, in their order; one at a time, for their time is measured."""
    found = dict(shown(orders, out / "runs", 1, None, quiet))
    return [found[k] for k in range(len(orders))]


def compared(plan: list[Setting], seeds: int, answers: list[dict[str, Any]], out: Path) -> tuple[list, list]:
    """The rows of all settings, and those of all runs."""
    reference = next(setting for setting in plan if setting.finest)
    rows, single = [], []
    for n, setting in enumerate(plan):
        own, apart = answers[n * seeds : (n + 1) * seeds], []
        for k, run in enumerate(own):
            gap = distance(setting, reference, k, out) if run["outcome"] == "done" else {}
            apart.append(gap)
            facts = {key: run.get(key) for key in ("outcome", "reason", *CLOCKS)}
            single.append(dict(setting.values) | {"seed": setting.scenes[k].seed} | facts | gap)
        rows.append(summary(setting, own, apart))
    return rows, single


def distance(setting: Setting, reference: Setting, k: int, out: Path, again: bool = False) -> dict[str, float | None]:
    """Errors of a finished run against the reference with the same seed."""
    own, other = (Result(folder_of(out, one.order(k, again))) for one in (setting, reference))
    return errors(own, other)


def answer(
    plan: list[Setting], rows: list[dict[str, Any]], judge: str, limit: Budget, seeds: int, out: Path, quiet: bool
) -> dict[str, Any] | None:
    """The best setting within the budget that also holds it, and its error, with a seed that was not used before."""
    left = list(rows)
    reference = next(setting for setting in plan if setting.finest)
    while (row := best(left, judge, limit)) is not None:
        setting = plan[next(n for n, one in enumerate(rows) if one is row)]
        orders = [one.order(seeds, again=True) for one in (setting, reference)]
        for order in orders:
            shutil.rmtree(folder_of(out, order), ignore_errors=True)  # run again, whatever lies there
        runs = made(orders, out, quiet)
        done = all(run["outcome"] == "done" for run in runs)
        spent, error = limit.spent(runs[0]), distance(setting, reference, seeds, out, True).get(judge) if done else None
        bound = row[judge] + 3.0 * (row[f"{judge}_spread"] or 0.0)
        fits = spent is not None and spent <= limit.most
        if fits and error is not None and error <= bound * (1.0 + 1e-6):
            return {"setting": setting.line(), "spent": spent, "error": error, "bound": bound}
        row["reason"] = f"run again it spent {text(spent)} and missed by {text(error)} (bound {bound:.4g})"
        left = [one for one in left if one is not row]
    return None


def show(rows: list[dict[str, Any]], known: list[str]) -> None:
    """The settings for people, the cheapest first."""
    names = ["setting", *CLOCKS[:3], known[0], f"{known[0]}_spread", *known[1:4]]
    lines = [
        [*(text(row.get(name)) for name in names), "reference" if row["reference"] else row["reason"][:50]]
        for row in sorted(rows, key=lambda row: row["wall_per_s"] or 0.0)
    ]
    console.table("", [*names, ""], lines)


def verdict(found: dict[str, Any] | None, rows: list[dict[str, Any]], judge: str, limit: Budget) -> str:
    """The answer for people."""
    if found is not None:
        return (
            f"most accurate within {limit.name}, by {judge}: {found['setting']}\n"
            f"  run again with another seed: {found['spent']:.3g} of {limit.most:g}, "
            f"error {found['error']:.3g} (at most {found['bound']:.3g} expected)"
        )
    tried = [row["reason"] for row in rows if row["reason"].startswith("run again")]
    spent = [cost for row in rows if row["outcome"] == "done" and (cost := limit.spent(row)) is not None]
    cheapest = f"the cheapest takes {min(spent):.3g} of {limit.most:g}" if spent else "no setting ran to its end"
    return f"nothing fits {limit.name}: {'; '.join([cheapest, *tried])}"
