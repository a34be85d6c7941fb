"""A basin that is a patch of open sea: its sides are periodic, and opposite the ship its water is that of the sea."""

from fractions import Fraction
from typing import NamedTuple, Protocol

from ocean_sim import waves
from ocean_sim.model import Model, Vector2, quantity

MOST_PARTS = 64  # of a side of a patch, of which the other is a whole number


class Rim(Model):
    """The band in which the water of the patch is relaxed towards the sea; the ship is in the middle of what it leaves
    free."""

    width: float | None = quantity("m", None, gt=0.0)
    """Width of the band on either side of the seam; null: three quarters of the highest waves' length, at most a
    quarter of the patch; in calm water a quarter of the patch."""
    rate: float | None = quantity("1/s", None, ge=0.0)
    """Rate of the relaxation at the seam, falling to 0 at the edge of the band; null: 1.5 times the frequency
    [rad/s] of the highest waves, in calm water of waves as long as 4/3 of the width; 0: the water is
    only fed, and what the ship makes goes round the patch."""
    velocity: Vector2 = quantity("m/s", (0.0, 0.0))
    """Velocity along x and z of the point opposite which the band lies, where there is no ship; it starts at the
    origin."""


class Nonlinear(NamedTuple):
    """How a sea is nonlinear."""

    onset: float  # [s] in which what is not linear sets in
    breaking: bool  # whether its crests break


class OpenSea(Protocol):
    """The sea that a patch is part of."""

    rim: Rim
    feed: float | None
    """Rate [1/s] at which its velocity is added to that of all water; None: what holds the waves up in a scheme."""
    ramp: float | None
    """In which it grows from calm water [s]; None: two periods of the highest waves where a ship is in the water, else
    it is there at once."""

    @property
    def significant_height(self) -> float:
        """Of the sea [m]; 0 in calm water."""

    @property
    def nonlinear(self) -> Nonlinear | None:
        """How it is nonlinear; None: it is the sum of its plane waves."""

    def plane_waves(self, basin: waves.Tank) -> waves.Components | None:
        """The sea by linear theory, before it is fitted to the patch; None in calm water."""


def width_over_length(periods: tuple[float, float, float]) -> Fraction | None:
    """Of a patch with these periods [m], as a ratio of whole numbers, 1 in 2-D; None where there is none of up to
    MOST_PARTS."""
    if not periods[2]:
        return Fraction(1)
    share = periods[2] / periods[0]
    found = Fraction(share).limit_denominator(MOST_PARTS)
    return found if abs(found / share - 1.0) < 1e-9 else None
