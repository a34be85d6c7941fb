"""Moving air: every module of this folder is a kind that a scene may name; what they share lies in `shared`."""

from typing import Literal, Protocol

import numpy as np

from ocean_sim.wind.shared.drawing import Drawing


class Wind(Protocol):
    """Moving air. `set_clock` and `force` are callable from a Taichi kernel.

    A kernel calls `set_clock(since, step)` before its loop over particles or voxels, with `since` and `step` as they
    are handed to it from Python; a wind that needs no clock leaves both 0 and does nothing (see `shared/clock.py`).
    """

    @property
    def needs_area(self) -> bool:
        """Whether `force` reads `area`: the fluid then finds the exposed area of its particles."""
        ...

    @property
    def needs_bend(self) -> bool:
        """Whether `force` reads `bend`: the fluid then finds how its surface bends."""
        ...

    @property
    def blows(self) -> bool:
        """Whether `force` is ever anything but zero; where not, kernels leave it out."""
        ...

    @property
    def since(self) -> float:
        """From the last restart of its clock to the end of this step [s]."""
        ...

    @property
    def step(self) -> float:
        """Length of this step [s]."""
        ...

    def on(self, target: Literal["fluid", "ship"]) -> "Wind":
        """The wind that a target feels: this one, or still air where it is no target."""
        ...

    def follow(self, middle: np.ndarray) -> None:
        """The patch of open sea that it blows over now lies around x, z (2,) [m] in the world."""
        ...

    def advance(self, dt: float) -> None:
        """Move on to the step of dt [s] that comes next."""
        ...

    def strengthen(self, factor: float) -> None:
        """Blow so many times as strongly as the scene says; nothing is compiled for it."""
        ...

    def drawing(self) -> Drawing:
        """Lines and arrows that show it as it is now."""
        ...

    def set_clock(self, since, step):
        """ti.func: find what blows in this step, from the two numbers above [s]."""
        ...

    def force(self, key, position, velocity, area, bend, mass):
        """ti.func -> vec3 [N]. `key`: particle or voxel number; `area`: exposed area times outward normal [m2],
        zero inside the water; `bend`: what the slope of the surface changes by in going as far as exposed
        areas lie below it, see `fluid/shared/exposure.py`; `mass` [kg]."""
        ...
