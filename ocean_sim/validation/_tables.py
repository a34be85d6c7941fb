"""Reference tables of `data/`; each says in its first comment lines where it comes from."""

from importlib.resources import files

import numpy as np


def table(name: str) -> dict[str, np.ndarray]:
    """The columns of data/<name>.csv."""
    text = (files("ocean_sim.validation") / "data" / f"{name}.csv").read_text(encoding="utf-8")
    names, *rows = [line.split(",") for line in text.splitlines() if line and not line.startswith("#")]
    return {column: np.array(values, dtype=float) for column, values in zip(names, zip(*rows))}
