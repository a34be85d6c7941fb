"""`ocean-sim sweep`: many runs from a plan, in a table that keeps failures, too."""

from collections.abc import Iterator
from pathlib import Path
from time import perf_counter
from typing import Annotated, Any

import typer

from ocean_sim.machine import cores
from ocean_sim.studies.shared import runs as runs_module
from ocean_sim.studies.shared import table as table_module
from ocean_sim.studies.sweep import planned
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.bar import Bar
from ocean_sim.verbs.shared.options import Json

SHOWN = ("outcome", "simulated_s", "particles", "wall_s", "reason")


def sweep(
    plan: Annotated[Path, typer.Argument(help="A YAML file: scene, profile, set, list, grid, seeds.")],
    scheduler: Annotated[
        str | None, typer.Option(help="A Dask cluster, as in tcp://127.0.0.1:8786, that sees the same files.")
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="Runs at a time on this machine; by default one per core.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Where run folders and results.csv go; by default runs/<plan>.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Run what a plan asks for and has not been run yet; the table is whole after every run."""
    runs = planned(plan)
    folder = Path("runs") / plan.stem if out is None else out
    at_once = workers or cores()
    orders = [run.order(max(1, cores() // at_once)) for run in runs]
    rows: dict[int, dict[str, Any]] = {}
    with console.claim(folder, "results.csv", runs_module.ADDRESSES):
        for k, answer in shown(orders, folder, at_once, scheduler, as_json):
            rows[k] = runs[k].row(answer)
            table_module.write(folder / "results.csv", [rows[k] for k in sorted(rows)])
    table = [rows[k] for k in sorted(rows)]
    if as_json:
        console.answer(table)
    else:
        show(table, list(dict.fromkeys(key for run in runs for key in run.settings)))
        console.say(summary(table, folder))


def shown(
    orders: list[dict[str, Any]], folder: Path, workers: int, scheduler: str | None, quiet: bool, **more: Any
) -> Iterator[tuple[int, dict[str, Any]]]:
    """The answers of orders as they come, with their progress shown."""
    bar, began, done = Bar(max(1.0, len(orders)), quiet), perf_counter(), 0
    try:
        for k, answer in runs_module.answers(orders, folder, workers, scheduler, **more):
            done += 1
            if not quiet:
                bar.show(done, f"{done} of {len(orders)} runs, {console.duration(perf_counter() - began)}")
            yield k, answer
    except KeyboardInterrupt:
        message = f"stopped after {done} of {len(orders)} runs; the same command continues from there"
        raise console.Stopped(message) from None
    finally:
        bar.close()


def show(rows: list[dict[str, Any]], keys: list[str]) -> None:
    """The table for people: what was set, and how it went."""
    names = ["run", *keys, *SHOWN]
    console.table("", names, [[text(row.get(name)) for name in names] for row in rows])


def text(value: Any) -> str:
    """A cell for people."""
    return "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)


def summary(rows: list[dict[str, Any]], folder: Path) -> str:
    """How many runs went how."""
    counts = {name: sum(row["outcome"] == name for row in rows) for name in ("done", "stopped", "failed")}
    sentence = f"{counts['done']} of {len(rows)} runs done"
    if counts["stopped"]:
        sentence += f", {counts['stopped']} stopped where they left the physical world"
    if counts["failed"]:
        sentence += f", {counts['failed']} failed (the same command tries them again)"
    return f"{sentence}; {folder / 'results.csv'}"
