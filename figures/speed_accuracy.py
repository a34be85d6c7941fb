"""Speed against accuracy: the error of every case of `tradeoff` over what it took, by scheme: CSV and PNG.

python figures/speed_accuracy.py [--fast] [--study runs/tradeoff/tradeoff.csv] [--out DIR]
"""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from _options import options, progress
from _paper import paper, save_figure

from ocean_sim.machine import available_cores
from ocean_sim.studies.shared.pareto import COST_LABELS, draw_panel
from ocean_sim.studies.shared.study import Study, read_table, write_table
from ocean_sim.studies.tradeoff import TRIAL_CASES, clock_column, study_points

FAST = ("hydrostatic", "surface_slab")
ACROSS = 3  # panels


def study_rows(fast: bool, folder: Path) -> list[dict[str, Any]]:
    """Rows of the quick tradeoff study; with `--fast` two cases only, coarse, each scheme as it comes."""
    plan = [
        point for point in study_points(quick=True) if not fast or (point.trial.case in FAST and not point.settings)
    ]
    study = Study(plan, folder, available_cores())
    for done in study.run():
        progress(done / len(plan), f"{done} of {len(plan)} runs")
    return study.rows


def draw_figure(rows: list[dict[str, Any]], path: Path) -> None:
    """Draw a panel for each case."""
    speed = clock_column(rows)
    trials = [(t, [r for r in rows if (r["case"], r["quantity"]) == (t.case, t.quantity)]) for t in TRIAL_CASES]
    trials = [(trial, here) for trial, here in trials if here]
    down = -(-len(trials) // ACROSS)
    figure = paper(5.2 * min(ACROSS, len(trials)), 4.3 * down)
    for k, (trial, here) in enumerate(trials):
        axes = figure.add_subplot(down, min(ACROSS, len(trials)), k + 1)
        draw_panel(axes, speed, trial, here)
        axes.set_title(f"{trial.case}: {trial.quantity}", fontsize=8)
        axes.legend(fontsize="x-small", loc="best")
    save_figure(figure, path, f"Across: {COST_LABELS[speed]} per simulated second, one thread (surfaces: 60 frames)")


def main() -> None:
    asked = options(__doc__, "two cases, coarse", study="tradeoff.csv of a study; without it the quick one is run")
    with TemporaryDirectory(prefix=".study-", dir=asked.out) as folder:
        rows = read_table(asked.study) if asked.study else study_rows(asked.fast, Path(folder))
    write_table(asked.out / "speed_accuracy.csv", rows)
    draw_figure(rows, asked.out / "speed_accuracy.png")


if __name__ == "__main__":
    main()
