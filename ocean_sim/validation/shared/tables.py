"""Reference tables of `data/`; each says in its first comment lines where it comes from."""

from pathlib import Path

import numpy as np

from ocean_sim.files import csv_file


def table_path(name: str) -> Path:
    """The file of a table."""
    return Path(__file__).parents[1] / "data" / f"{name}.csv"


def table(name: str) -> dict[str, np.ndarray]:
    """The columns of data/<name>.csv."""
    return csv_file.numbers(table_path(name))
