"""`ocean-sim tradeoff`: the cost of a setting, and the accuracy it gives."""

from pathlib import Path
from typing import Annotated, Any

import typer

from ocean_sim.machine import cores
from ocean_sim.studies.shared import pareto
from ocean_sim.studies.shared import table as table_module
from ocean_sim.studies.tradeoff import TRIALS, clock, equals, front, points
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.options import Json, Profile, Sets
from ocean_sim.verbs.shared.scene_tradeoff import of_scene
from ocean_sim.verbs.sweep import shown, text

LEFT = ("tradeoff.csv", "runs")  # in its folder; tables and pictures come later
SHOWN = ("scheme", "particles", "neighbours", "wall_per_s", "cpu_per_s", "error", "unit", "changed", "")


def tradeoff(
    scene: Annotated[str | None, typer.Argument(help="A scene; without one, the validation cases.")] = None,
    vary: Annotated[
        list[str] | None,
        typer.Option(help="KEY=A,B,C; given several times: every combination. By default profile=ci,..."),
    ] = None,
    budget: Annotated[
        str | None,
        typer.Option(help="16ms: wall time per 1/60 s simulated; realtime; 30s: wall time of the whole run."),
    ] = None,
    by: Annotated[str | None, typer.Option(help="The error that decides: a column of the table.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Fewer runs and seeds: minutes instead of hours.")] = False,
    profile: Profile = None,
    sets: Sets = None,
    workers: Annotated[int | None, typer.Option(min=1, help="Cases at a time; by default one per core.")] = None,
    out: Annotated[Path | None, typer.Option(help="Where tables, pictures and runs go.")] = None,
    as_json: Json = False,
) -> None:
    """The study over the validation cases, or that of a scene."""
    vary, sets = vary or [], sets or []
    if scene is not None:
        folder = out or Path("runs") / "tradeoff" / Path(scene).stem
        with console.claim(folder, *LEFT):
            of_scene(scene, profile, sets, vary, budget, by, quick, folder, as_json)
        return
    for name, given in (("vary", vary), ("budget", budget), ("by", by), ("profile", profile), ("set", sets)):
        if given:
            raise console.Refused(f"--{name} needs a scene, as in ocean-sim tradeoff SCENE --{name} ...")
    beside = () if out else ("*",)  # studies of scenes
    with console.claim(out or Path("runs/tradeoff"), *LEFT, *beside) as folder:
        of_cases(quick, workers, folder, as_json)


def of_cases(quick: bool, workers: int | None, out: Path, as_json: bool) -> None:
    """The study over the validation cases: tradeoff.csv, equal.csv and a picture a case."""
    plan = points(quick)
    if not as_json:
        console.say(f"{len(plan)} runs of {len({point.trial.case for point in plan})} cases, each on one thread")
    rows: dict[int, list[dict[str, Any]]] = {}
    for k, answer in shown([point.order() for point in plan], out / "runs", workers or cores(), None, as_json):
        rows[k] = plan[k].rows(answer)
        table_module.write(out / "tradeoff.csv", [row for n in sorted(rows) for row in rows[n]])
    table = [row for n in sorted(rows) for row in rows[n]]
    drawn = {
        trial.case: [row for row in table if (row["case"], row["quantity"]) == (trial.case, trial.quantity)]
        for trial in TRIALS
    }
    speed = clock(table)
    fair = equals([row for here in drawn.values() for row in here], speed)
    table_module.write(out / "equal.csv", fair)
    for trial in TRIALS:
        if drawn[trial.case]:
            console.drawn(pareto.draw, out / f"tradeoff_{trial.case}.png", trial, drawn[trial.case], speed)
            if not as_json:
                show(f"{trial.case}: {trial.quantity}", drawn[trial.case], speed)
    if as_json:
        console.answer(table)
        return
    keys = ("case", "at equal", "scheme", "error", "unit", speed, "changed")
    lines = [[text(row[key]) for key in keys] for row in fair]
    console.table("\nat equal time, and at equal number", list(keys), lines)
    if speed != "wall_per_s":
        console.say("the cores were busy, so processor time is compared; run it again on an idle machine")
    console.say(f"{out / 'tradeoff.csv'}, equal.csv, pictures; wall_per_s: wall seconds of steps per simulated second")


def show(title: str, rows: list[dict[str, Any]], speed: str) -> None:
    """The runs of a case, the cheapest first; a star is on the Pareto front."""
    done = [row for row in rows if row.get("error") is not None and row.get(speed)]
    best = {id(done[k]) for k in front([(row[speed], abs(row["error"])) for row in done])}
    lost = [row for row in rows if row.get("error") is None]
    lines = [
        [*(text(row.get(key)) for key in SHOWN[:-1]), "*" if id(row) in best else row.get("reason", "")[:60]]
        for row in [*sorted(done, key=lambda row: row[speed]), *lost]
    ]
    console.table(f"\n{title}", list(SHOWN), lines)
