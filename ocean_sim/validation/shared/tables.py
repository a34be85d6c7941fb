"""Reference tables of `data/`; each says in its first comment lines where it comes from."""

from pathlib import Path

import numpy as np


def place(name: str) -> Path:
    """The file of a table."""
    return Path(__file__).parents[1] / "data" / f"{name}.csv"


def table(name: str) -> dict[str, np.ndarray]:
    """The columns of data/<name>.csv."""
    text = place(name).read_text(encoding="utf-8")
    names, *rows = [line.split(",") for line in text.splitlines() if line and not line.startswith("#")]
    return {column: np.array(values, dtype=float) for column, values in zip(names, zip(*rows))}
