"""What a wind is now: numbers that Python tells kernels, and a clock that the kernels are handed."""

import taichi as ti

RUN = 1.0  # [s] how long the clock runs before it begins anew: in single precision it is then right to 0.1 us


class Now:
    """Numbers in one field, 0 at first; only what has changed is told."""

    def __init__(self, size: int) -> None:
        self.field, self.told = ti.field(float, shape=size), [0.0] * size

    def tell(self, column: int, number: float) -> None:
        """Put a number into its column."""
        if number != self.told[column]:
            self.told[column] = number
            self.field[column] = float(number)
