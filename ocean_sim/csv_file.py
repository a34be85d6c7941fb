"""CSV files that a scene names: columns of numbers under one heading; lines that begin with # are comments."""

from pathlib import Path

import numpy as np


def columns(path: str | Path) -> dict[str, np.ndarray]:
    """Each column, (n,), by its name; what is no number is NaN. Raises OSError or ValueError."""
    lines = [line for line in Path(path).read_text(encoding="utf-8").splitlines() if line.strip() and line[0] != "#"]
    if len(lines) < 2:
        raise ValueError(f"{path} has no rows under a heading")
    names = [name.strip() for name in lines[0].split(",")]
    table = np.genfromtxt(lines[1:], delimiter=",", ndmin=2)
    if table.shape[1] != len(names):
        raise ValueError(f"{path} has {len(names)} names and {table.shape[1]} columns")
    return dict(zip(names, table.T))
