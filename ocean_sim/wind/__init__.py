"""Moving air: each module of this folder is a kind that a scene may name; `shared` holds their common modules."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from ocean_sim.kernel_library import ti, tm
from ocean_sim.runtime import in_kernels

Target = Literal["fluid", "ship"]

CLOCK_RESTART_TIME = 1.0  # [s] how long the clock runs: up to here single precision is right to 0.1 us


class Clock:
    """Clock of a wind, for kernels: simulated time and length of the step. It stays at 0 for a wind that needs none."""

    def __init__(self) -> None:
        self.time = 0.0  # [s] since the beginning
        self.since = 0.0  # [s] since the last restart
        self.step = 0.0  # [s] length of the step

    def advance(self, dt: float) -> None:
        self.time, self.since, self.step = self.time + dt, self.since + dt, dt

    def is_due(self) -> bool:
        """True if the clock must be restarted, lest `since` lose its precision in single precision."""
        return self.since > CLOCK_RESTART_TIME

    def restart(self) -> None:
        """Set `since`, the time since the last restart, to 0; `time` goes on."""
        self.since = 0.0


class DeviceRow:
    """Array of numbers in device memory, read by kernels, 0 at first; a number is copied there only when it changes."""

    def __init__(self, size: int) -> None:
        self.field, self.values = ti.field(float, shape=size), [0.0] * size

    def set(self, column: int, number: float) -> None:
        """Write a number into an element (`column`) of the array, for kernels launched from now on."""
        if number != self.values[column]:
            self.values[column] = number
            self.field[column] = float(number)


@dataclass(frozen=True, eq=False)
class Drawing:
    """Lines and arrows by which pictures show a wind: its outline and its direction."""

    lines: np.ndarray  # (n, 2, 3) ends of the lines that show where it blows [m]
    tails: np.ndarray  # (m, 3) where arrows begin [m]
    arrows: np.ndarray  # (m, 3) along what the wind does there; length 1 is the strongest that the scene has
    strongest: float = 0.0  # that, in its unit; 0 where arrows show nothing, or not all the same
    unit: str = ""  # of what arrows show


NO_DRAWING = Drawing(np.zeros((0, 2, 3)), np.zeros((0, 3)), np.zeros((0, 3)))


@in_kernels
class Wind(ABC):
    """Base class of moving air. A kind implements `force`, and overrides those other methods that it needs. A kernel
    takes `since` and `step` (time since the clock's restart, time step) [s], calls `set_clock(since, step)` before its
    loop over particles or voxels, and then `force` for each of them."""

    blows: bool = True  # False: `force` is always zero, and kernels leave it out
    needs_area: bool  # True if `force` reads `area`: the fluid then finds the exposed area of its particles
    needs_bend: bool  # True if `force` reads `bend`: the fluid then finds how its surface bends
    real_velocity: tuple[float, float] = (0.0, 0.0)  # [m/s] along x and z, of a real wind that is the same everywhere

    def __init__(self, config: Any, clock: Clock | None = None) -> None:
        """`config`: the kind's Config; `clock`: simulated time and step; given if this is a part of another wind."""
        self.config, self.gain = config, 1.0
        self.needs_area, self.needs_bend = config.needs_area, config.needs_bend
        self.clock = Clock() if clock is None else clock

    def on(self, target: Target) -> "Wind":
        """Wind as felt by a kind of body, `fluid` or `ship`: this one, or still air if it does not act on that."""
        return self if target in self.config.acts_on else StillAir()

    def follow(self, middle: np.ndarray) -> None:  # noqa: B027
        """Store the middle x, z (2,) [m], in the world, of the patch of open sea under the wind; called as it follows
        ships. A wind with a position passes it to its axes (`shared.place.Patch`); a uniform wind ignores it."""

    def advance(self, dt: float) -> None:  # noqa: B027
        """Advance the wind to its state in the next time step, of dt [s]; called before each step of the water."""

    def strengthen(self, factor: float) -> None:
        """Set a factor on the strength given in the scene, from the next step on, without compiling a kernel again."""
        self.gain = factor

    def drawing(self) -> Drawing:
        """Lines and arrows that show the present wind in pictures; none for a wind that draws nothing."""
        return NO_DRAWING

    @ti.func  # noqa: B027
    def set_clock(self, since, step):
        """Begin a kernel: compute the wind in a step of `step` [s] that ends `since` [s] after the clock's restart."""

    @abstractmethod
    def force(self, key, position, velocity, area, bend, mass):
        """ti.func -> vec3: force [N] on a particle or a voxel of a hull.

        `key` is the particle's or voxel's number, from which random forces are drawn; `position` [m] and `velocity`
        [m/s] are its own; `area`: exposed area times outward normal [m2], zero inside the water; `bend`: curvature (xx,
        xz, zz) of the surface times depth of exposed areas (`fluid/bodies/exposure.py`); `mass` [kg]."""


@in_kernels
class StillAir(Wind):
    """Air at rest: it gives no force, and kernels leave out the force of the wind."""

    blows = False
    needs_area = needs_bend = False

    def __init__(self) -> None:
        self.clock = Clock()

    def on(self, target: Target) -> Wind:
        return self

    @ti.func
    def force(self, key, position, velocity, area, bend, mass):
        return tm.vec3(0.0)
