"""The clock of a wind that moves, and the numbers that its kernels read.

Kernels find where a moving wind is from two numbers that they are handed: the time since its clock was last restarted,
and the length of the step. So nothing is written to the device in a step unless what blows has changed. The clock is
restarted after RESTART because kernels may run in single precision, in which a time is the coarser the longer it is;
with each restart the wind writes where it is then, worked out in double precision.
"""

from ocean_sim.kernel_library import ti

RESTART = 1.0  # [s] how long the clock runs: up to here single precision is right to 0.1 us


class Clock:
    """Time of a wind at the end of its step; one that needs no clock leaves it at 0."""

    def __init__(self) -> None:
        self.time = 0.0  # [s] since the beginning
        self.since = 0.0  # [s] since the last restart
        self.step = 0.0  # [s] length of the step

    def advance(self, dt: float) -> None:
        """Add a step of dt [s]."""
        self.time, self.since, self.step = self.time + dt, self.since + dt, dt

    def is_due(self) -> bool:
        """True if it has to be restarted."""
        return self.since > RESTART

    def restart(self) -> None:
        """Count from now on."""
        self.since = 0.0


class DeviceRow:
    """A row of numbers that kernels read, 0 at first; a column is written only where its number changes."""

    def __init__(self, size: int) -> None:
        self.field, self.values = ti.field(float, shape=size), [0.0] * size

    def set(self, column: int, number: float) -> None:
        """Write a number into a column, for kernels that are launched from now on."""
        if number != self.values[column]:
            self.values[column] = number
            self.field[column] = float(number)
