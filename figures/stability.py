"""Stability of water: time steps and one more setting taken to extremes, next to theoretical limits: CSV and PNGs.

python figures/stability.py [--fast] [--study runs/stability/stability.csv] [--out DIR]
"""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from _options import options, progress
from _paper import save_figure

from ocean_sim.machine import available_cores
from ocean_sim.studies.shared.study import Study, read_table, write_table
from ocean_sim.studies.stability import EXTREME_AXES, MAX_RUN_SECONDS, draw_map, grid_points

FAST, STEPS = ("compression", 0.04), (1.0, 4.0)  # in haste: the map, its row, and the steps over courant's own


def study_rows(fast: bool, folder: Path) -> list[dict[str, Any]]:
    """Rows of the quick stability study; with `--fast` only one row of one map."""
    plan = [
        spot
        for spot in grid_points(quick=True)
        if not fast or ((spot.axis.name, spot.value) == FAST and spot.factor in STEPS)
    ]
    study = Study(plan, folder, available_cores(), limit=MAX_RUN_SECONDS[True])
    for done in study.run():
        progress(done / len(plan), f"{done} of {len(plan)} runs")
    return study.rows


def main() -> None:
    study = "stability.csv of a study; without it the quick one is run"
    asked = options(__doc__, "one row of one map, at two time steps", study=study)
    with TemporaryDirectory(prefix=".study-", dir=asked.out) as folder:
        rows = read_table(asked.study) if asked.study else study_rows(asked.fast, Path(folder))
    write_table(asked.out / "stability.csv", rows)
    for axis in EXTREME_AXES:
        here = [row for row in rows if row["map"] == axis.name]
        if here:
            name = f"{axis.name} [{axis.unit}]"
            path = asked.out / f"stability_{axis.name.replace(' ', '_')}.png"
            save_figure(draw_map(name, here), path, f"Here: {name} over the time step, in {len(here)} runs")


if __name__ == "__main__":
    main()
