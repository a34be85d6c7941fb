"""Tables of `data/`: references, and tolerances at coarse resolution. The comments at the head of each name its source.

Coarse set-ups are for a gate that shows changes within a minute or two.
"""

from functools import cache
from pathlib import Path

import numpy as np

from ocean_sim.files import csv_file


def table_path(name: str) -> Path:
    return Path(__file__).parents[1] / "data" / f"{name}.csv"


def table(name: str) -> dict[str, np.ndarray]:
    """Table validation/data/<name>.csv: arrays by column name."""
    return csv_file.Table(table_path(name))


@cache
def coarse_tolerances() -> dict[tuple[str, str], dict[str, float]]:
    """Tolerances of coarse set-ups, by (case, quantity), then scheme; only of those that miss the normal tolerance."""
    found: dict[tuple[str, str], dict[str, float]] = {}
    for row in csv_file.read_records(table_path("coarse").read_text(encoding="utf-8")):
        found.setdefault((row["case"], row["quantity"]), {})[row["scheme"]] = float(row["tolerance"])
    return found


@cache
def too_long_for_gate() -> dict[tuple[str, str], float]:
    """Set-ups too long for a regression gate: processor time [s], compiling excluded, by (case, set-up)."""
    rows = csv_file.read_records(table_path("too_long_for_a_gate").read_text(encoding="utf-8"))
    return {(row["case"], row["set-up"]): float(row["processor_s"]) for row in rows}
