"""A sea that goes on beyond the basin: (a) sides with a zone that absorbs waves, and (b) a basin that is a patch of
open sea, with periodic sides and a band around the ship in which the water is relaxed towards the sea."""

from dataclasses import replace
from fractions import Fraction
from math import radians
from typing import Literal, NamedTuple, Protocol

from ocean_sim import waves
from ocean_sim.model import Faults, Model, Vector2, Vector3, below, quantity

MOST_PARTS = 64  # largest denominator of the ratio of the sides of a patch


class Sea(waves.HeadedTrain):
    """Waves by linear theory, without beginning or end."""

    phase_deg: float = quantity("deg", 0.0)
    """Phase added to that of each wave; without it regular waves have a crest at the origin at time 0."""

    def sea(self, basin: waves.Tank, count: int = waves.SPECTRUM_WAVES) -> waves.Components:
        """Plane waves of this train in a basin, `phase_deg` added to their phases; a spectrum becomes `count` waves."""
        sea = super().sea(basin, count)
        return replace(sea, phase=sea.phase + radians(self.phase_deg))


class Target(Model):
    """Motion of the water that an absorbing zone does not damp: a current and waves, either or both."""

    current: Vector3 = quantity("m/s", (0.0, 0.0, 0.0))
    """A current, the same everywhere and horizontal."""
    waves: Sea | None = None
    """Regular waves by `height` and `period`, or random ones by a `spectrum`; they must fit periodic sides, as waves
    that the water starts from must."""


class Absorbing(Model):
    """A wall with a zone before it that damps the motion of the water, ever faster up to the wall."""

    kind: Literal["absorbing"] = "absorbing"
    length: float | None = quantity("m", None, gt=0.0)
    """Length of the zone; null: from the waves of the scene, one wavelength where they are regular and two where
    they are random, at most half the basin; a quarter of the basin where the scene names no waves."""
    rate: float | None = quantity("1/s", None, gt=0.0)
    """Rate of the damping at the wall; null: the one that returns least of these waves; without waves 2.5 sqrt(g /
    depth)."""
    target: Target | None = None
    """The motion that the zone leaves alone; null: rest."""

    def problems(self, basin: waves.Tank, size: float) -> Faults:
        """Yield faults of this absorbing side in a basin that is `size` [m] long along the side's axis."""
        if self.length is not None and self.length > size:
            yield ("length",), f"a zone of {self.length:g} m is longer than the basin, {size:g} m"
        if self.target is None:
            return
        u, sea = self.target.current, self.target.waves
        if u[1] != 0.0 or (basin.dimension == 2 and u[2] != 0.0):
            level = "along x" if basin.dimension == 2 else "along x and z"
            yield ("target", "current"), f"a current of this basin is {level}, got {list(u)}"
        if sea is not None:
            yield from below("target", "waves", faults=sea.faults(basin))


class Rim(Model):
    """The band in which the patch's water is relaxed towards the sea; the ship is in the middle of the free water."""

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
    """Settings of a nonlinear sea: time in which its nonlinear terms set in, and whether crests break."""

    onset: float  # [s] time in which the nonlinear terms set in
    breaking: bool  # True: its crests break


class OpenSea(Protocol):
    """Interface of the sea around a patch of particles."""

    rim: Rim
    feed: float | None
    """Rate [1/s] at which its velocity is added to that of all water; None: the rate that holds the waves up in a
    scheme."""
    ramp: float | None
    """Time in which it grows from calm water [s]; None: two periods of the highest waves where a ship is in the water,
    else it is there at once."""

    @property
    def significant_height(self) -> float:
        """Significant height of the sea [m]; 0 in calm water."""

    @property
    def nonlinear(self) -> Nonlinear | None:
        """Settings of a nonlinear sea; None if the sea is the sum of its plane waves."""

    def plane_waves(self, basin: waves.Tank) -> waves.Components | None:
        """Plane waves of the sea by linear theory, of wavelengths that need not fit the basin; None in calm water."""


def width_over_length(periods: tuple[float, float, float]) -> Fraction | None:
    """Width over length, as a fraction, by a patch's periods [m]; 1 in 2-D, None for a denominator above MOST_PARTS."""
    if not periods[2]:
        return Fraction(1)
    share = periods[2] / periods[0]
    found = Fraction(share).limit_denominator(MOST_PARTS)
    return found if abs(found / share - 1.0) < 1e-9 else None
