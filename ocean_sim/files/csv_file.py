"""CSV files that a scene names: columns of numbers under one heading; lines that begin with # are comments."""

from pathlib import Path

import numpy as np

from ocean_sim.files import input_file


def columns(path: str | Path) -> dict[str, np.ndarray]:
    """Each column, (n,), by its name; what is no number is NaN. Raises Unreadable, a ValueError."""
    lines = [line for line in input_file.text(path).splitlines() if line.strip() and line[0] != "#"]
    if len(lines) < 2:
        raise input_file.Unreadable(path, "it has no rows under a heading")
    names = [name.strip() for name in lines[0].split(",")]
    uneven = next((line for line in lines[1:] if line.count(",") != len(names) - 1), None)
    if uneven is not None:
        cells = uneven.count(",") + 1
        raise input_file.Unreadable(path, f"it has {len(names)} names and a row of {cells}, {described(uneven)}")
    if (name := twice(names)) is not None:
        raise input_file.Unreadable(path, f"it has two columns {described(name)}")
    table = np.genfromtxt(lines[1:], delimiter=",", ndmin=2, comments=None)  # type: ignore[call-overload]
    return dict(zip(names, table.T))


def twice(names: list[str]) -> str | None:
    """The first name that is there a second time."""
    return next((name for k, name in enumerate(names) if name in names[:k]), None)


def described(text: str) -> str:
    """A piece of a file, cut short: for messages."""
    return repr(text if len(text) <= 40 else f"{text[:37]}...")


class Growing:
    """A CSV file that is still being written: its whole rows, each seen once."""

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self.head: dict[str, str] = {}
        self.names: list[str] = []
        self.read, self.rest = 0, ""  # bytes read, and the part of a line at their end

    def rows(self) -> dict[str, np.ndarray]:
        """The columns, (n,), of the rows that were written since the last call; what is no number is NaN."""
        with self.path.open("rb") as file:
            file.seek(self.read)
            new = file.read()
        self.read += len(new)
        *lines, self.rest = (self.rest + new.decode("utf-8")).split("\n")
        comments = [line[1:].partition(":") for line in lines if line.startswith("#")]
        self.head |= {key.strip(): value.strip() for key, _, value in comments}
        lines = [line for line in lines if line.strip() and line[0] != "#"]
        if not self.names and lines:
            self.names = [name.strip() for name in lines.pop(0).split(",")]
        table = np.genfromtxt(lines, delimiter=",", ndmin=2) if lines else np.zeros((0, len(self.names)))
        return dict(zip(self.names, table.T))
