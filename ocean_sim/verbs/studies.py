"""`ocean-sim sweep` and `stability`: many runs from a plan, and where water becomes unstable, in tables that keep
failures, too."""

from pathlib import Path
from typing import Any

import typer

from ocean_sim.files.atomic_file import save_figure
from ocean_sim.machine import available_cores
from ocean_sim.studies.shared.pareto import PICTURE_DPI
from ocean_sim.studies.shared.study import ADDRESS_PATTERN, Study, write_table
from ocean_sim.studies.stability import EXTREME_AXES, MAX_RUN_SECONDS, VERDICT_WORDS, draw_map, grid_points, map_summary
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


def stability(
    scene: str | None = typer.Argument(None, help="A scene; without one, a collapsing column."),
    quick: bool = typer.Option(False, "--quick", help="Fewer points: minutes instead of hours."),
    workers: int | None = typer.Option(None, min=1, help="Runs at a time; by default one per core."),
    out: Path = typer.Option(Path("runs/stability"), help="Where tables, pictures and runs go."),
) -> int:
    """Map stable settings of water; writes stability.csv, limits.csv, pictures; exit code 1 if a run gave no answer."""
    with console.claim(out, "stability.csv", "runs"):
        plan = grid_points(quick, scene)
        if not plan:
            raise console.Refused(f"{scene}: this scene has no setting to take to an extreme")
        console.say(f"{len(plan)} runs, each on one thread")
        runs, table_file = workers or available_cores(), out / "stability.csv"
        table = rows_of(Study(plan, out / "runs", runs, table_file, limit=MAX_RUN_SECONDS[quick]))
        lines = map_summary(table)
        write_table(out / "limits.csv", lines)
        for axis in EXTREME_AXES:
            here = [row for row in table if row["map"] == axis.name]
            if here:
                picture = out / f"stability_{axis.name.replace(' ', '_')}.png"
                draw = lambda: save_figure(draw_map(f"{axis.name} [{axis.unit}]", here), picture, PICTURE_DPI)
                console.draw_if_able(draw)
        console.answer(table)
        print_map(lines, table, out)
        return 1 if any(row["verdict"] == "none" for row in table) else 0


def print_map(lines: list[dict[str, Any]], table: list[dict[str, Any]], out: Path) -> None:
    """Print limits of stability (`lines`), points of `table` that are degraded (too much energy or compression) or lack
    a verdict (the run gave no answer), and counts."""
    names = list(lines[0])
    title = (
        "steps over courant's own in still water; numbers: the longest stable step over h / c, h^2 / nu, sqrt(h / a)"
    )
    console.table(title, names, [[cell(line[name]) for name in names] for line in lines])
    for row in table:
        if row["verdict"] in ("degraded", "none"):
            where = f"{row['map']} {row['value']:g}, {row['scheme']}, {row['dt_over_courant']:g} x the step"
            console.say(f"{'no verdict' if row['verdict'] == 'none' else row['verdict']}: {where}: {row['reason']}")
    counts = {name: sum(row["verdict"] == name for row in table) for name in VERDICT_WORDS}
    outcomes = ", ".join(f"{count} {name}" for name, count in counts.items() if name != "none")
    console.say(f"{outcomes}; {counts['none']} without a verdict; {out / 'stability.csv'}, limits.csv and pictures")
