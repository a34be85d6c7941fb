"""Reference tables of `data/`; the comment lines at the head of each give its source."""

from pathlib import Path

import numpy as np

from ocean_sim.files import csv_file


def table_path(name: str) -> Path:
    """The file of a table."""
    return Path(__file__).parents[1] / "data" / f"{name}.csv"


def table(name: str) -> dict[str, np.ndarray]:
    """The columns of data/<name>.csv."""
    return csv_file.Table(table_path(name))
