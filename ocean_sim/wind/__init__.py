"""Moving air: every module of this folder without a leading underscore is a kind a scene may name."""

from typing import Literal, Protocol

from ocean_sim.wind.shared.air import Air


class Wind(Protocol):
    """Moving air. `hear` and `force` are callable from a Taichi kernel."""

    needs_area: bool  # whether `force` reads `area`: the fluid then finds the exposed area of its particles
    since: float  # [s] since its clock began, at the end of this step
    step: float  # [s]

    blows: bool  # whether `force` is ever anything

    def on(self, target: Literal["fluid", "ship"]) -> "Wind":
        """The wind that a target feels: this one, or still air where it is no target."""
        ...

    def advance(self, dt: float) -> None: ...

    def strengthen(self, factor: float) -> None:
        """Blow so many times as strongly as the scene says; nothing is compiled for it."""
        ...

    def shown(self) -> Air:
        """Lines and arrows that show it as it is now."""
        ...

    def hear(self, since, step):
        """ti.func that a kernel calls before all particles, with these two as they are now [s]."""
        ...

    def force(self, key, position, velocity, area, mass):
        """ti.func -> vec3 [N]. `key`: particle or voxel number; `area`: exposed area times outward normal [m2],
        zero inside the water; `mass` [kg]."""
        ...
