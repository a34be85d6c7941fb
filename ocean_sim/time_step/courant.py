"""The longest step that sound, viscosity and force allow (Monaghan 1992; Morris, Fox & Zhu 1997, eqs. 30-32)."""

from typing import Literal

from ocean_sim.fluid import Limits
from ocean_sim.model import quantity
from ocean_sim.parts import TimeStepConfig
from ocean_sim.time_step import TimeStep


class Config(TimeStepConfig):
    """Fractions of the limits that a step may take; with h half the support of the smoothing kernels."""

    kind: Literal["courant"] = "courant"
    courant_number: float = quantity("1", 0.6, gt=0.0)
    """The CFL number, a fraction of h / (c + |v|): how far sound and water may travel in a step; h is 0.4 or 0.5 of
    the kernel support radius, depending on the kernel."""
    viscous_number: float = quantity("1", 0.125, gt=0.0)
    """Fraction of h^2 / nu: how far shear may spread in a step."""
    force_number: float = quantity("1", 0.25, gt=0.0)
    """Fraction of sqrt(h / |a|): how far a force may move a particle in a step."""
    longest: float = quantity("s", 0.05, gt=0.0)
    """The longest time step allowed."""

    def advice(self, limit: str, shortest: float) -> str:
        return "try a smaller time_step.courant_number, a smaller fluid.compression (stiffer water), or a weaker wind"

    def build(self) -> TimeStep:
        return TimeStep(self, "courant_number", "1")

    def longest_step(self, limits: Limits) -> tuple[float, str]:
        """Longest time step [s] that these limits allow, and the name of the limit that sets it."""
        shortest, ruling = self.longest, "longest"
        for step, name in (
            (self.force_number * limits.force, "force"),
            (self.viscous_number * limits.viscous, "viscous"),
            (self.courant_number * limits.acoustic, "acoustic"),
        ):
            if step <= shortest:  # of equal ones the last named rules, and what is not a number never does
                shortest, ruling = step, name
        return shortest, ruling
