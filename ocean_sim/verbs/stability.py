"""`ocean-sim stability`: where water becomes unstable, and how the run ends there."""

from pathlib import Path
from typing import Any

import typer

from ocean_sim.files.atomic_file import save_figure
from ocean_sim.machine import available_cores
from ocean_sim.studies.shared.pareto import PICTURE_DPI
from ocean_sim.studies.shared.study import Study, write_table
from ocean_sim.studies.stability import EXTREME_AXES, MAX_RUN_SECONDS, VERDICT_WORDS, draw_map, grid_points, map_summary
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.bar import rows_of
from ocean_sim.verbs.shared.console import cell


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
        study = Study(plan, out / "runs", runs, table_file, limit=MAX_RUN_SECONDS[quick])
        table = rows_of(study)
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
