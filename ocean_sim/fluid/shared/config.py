"""What every kind of water says about itself, so that nobody keeps lists of kinds."""

from typing import ClassVar

from ocean_sim.parts import PartConfig


class FluidConfig(PartConfig):
    """What studies, validation, ships and winds ask of a kind of water; a kind that differs says so."""

    made_of_particles: ClassVar[bool] = False
    """Whether it is made of particles, which start on a `lattice`; else it is a closed form."""
    compared: ClassVar[bool] = False
    """Whether `validate`, `tradeoff` and `stability` compare it with other schemes."""
    conserves_momentum: ClassVar[bool] = False
    """Whether what its particles exchange keeps momentum and angular momentum to rounding."""
    carries_bodies: ClassVar[bool] = False
    """Whether it answers to a body within a step, so that a ship of kind `pressure` may float on it."""
    fineness: ClassVar[int] = 0
    """Its rank where kinds of water are ordered from the coarsest to the finest."""
    added_viscosity: ClassVar[tuple[tuple[float, float], ...]] = ()
    """Viscosity that the scheme adds to a wave so many spacings long, over h c (half its support, its sound speed);
    empty where it has not been measured. Measured by the decay of small waves in a slice, in the validation cases
    wind_growth (still air; 32 and 64 spacings) and standing_wave (50 and 100). Steeper seas lose more (imposed_sea)."""
    unheeded: ClassVar[tuple[str, ...]] = ()
    """Keys that change no number of a run."""
