"""`ocean-sim sweep`: many runs from a plan, in a table that keeps failures, too."""

from pathlib import Path

import typer

from ocean_sim.machine import available_cores
from ocean_sim.studies.shared.study import ADDRESS_PATTERN, Study
from ocean_sim.studies.sweep import read_plan
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.bar import rows_of
from ocean_sim.verbs.shared.console import cell

FACT_COLUMNS = ("outcome", "simulated_s", "particles", "wall_s", "reason")


def sweep(
    plan: Path = typer.Argument(help="A YAML file: scene, profile, set, list, grid, seeds."),
    scheduler: str | None = typer.Option(
        None, help="A Dask cluster, as in tcp://127.0.0.1:8786, that sees the same files."
    ),
    workers: int | None = typer.Option(None, min=1, help="Runs at a time on this machine; by default one per core."),
    out: Path | None = typer.Option(None, help="Where run folders and results.csv go; by default runs/<plan>."),
) -> None:
    """Run all runs of a plan that have not been run yet; the table is complete after every run."""
    at_once = workers or available_cores()
    runs = read_plan(plan, max(1, available_cores() // at_once))
    folder = Path("runs") / plan.stem if out is None else out
    with console.claim(folder, "results.csv", ADDRESS_PATTERN):
        table = rows_of(Study(runs, folder, at_once, folder / "results.csv", scheduler))
    console.answer(table)
    names = ["run", *dict.fromkeys(key for run in runs for key in run.settings), *FACT_COLUMNS]
    console.table("", names, [[cell(row.get(name)) for name in names] for row in table])
    counts = {name: sum(row["outcome"] == name for row in table) for name in ("done", "stopped", "failed")}
    sentence = f"{counts['done']} of {len(table)} runs done"
    if counts["stopped"]:
        sentence += f", {counts['stopped']} stopped where they left the physical world"
    if counts["failed"]:
        sentence += f", {counts['failed']} failed (the same command tries them again)"
    console.say(f"{sentence}; {folder / 'results.csv'}")
