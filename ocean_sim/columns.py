"""Names for the columns of a row of numbers, such as the inputs of a pair interaction or a table on the device."""

from ocean_sim.kernel_library import ti, tm


class Columns:
    """Layout of a row of numbers: index of each named column, in the order given. After `row = Columns(position=3,
    velocity=3, pressure=1)`, `row.pressure` is the index of a column, 6 here, or of the first of several; `row.size` is
    the number of all columns. A kernel reads a number as `own[row.pressure]`, and a vector as `vec3(own,
    row.position)`, at no cost when it runs."""

    def __init__(self, **widths: int) -> None:
        """`widths`: number of adjacent columns of each name."""
        self.size = 0
        for name, width in widths.items():
            setattr(self, name, self.size)
            self.size += width

    def __getattr__(self, name: str) -> int:
        """Raise AttributeError that lists the column names; Python calls it only for a name that is not a column."""
        raise AttributeError(f"there is no column {name!r} in this row; there are {', '.join(vars(self))}")


@ti.func
def vec3(row, first):
    """Vector (row[first], row[first + 1], row[first + 2]) of an array `row`."""
    return tm.vec3(row[first], row[first + 1], row[first + 2])
