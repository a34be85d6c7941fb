"""Water: every module of this folder without a leading underscore is a kind a scene may name."""

from dataclasses import dataclass
from math import inf
from typing import Any, Protocol

import numpy as np


@dataclass(frozen=True)
class Limits:
    """What the time step must stay a fraction of [s]; infinite where there is no such limit.

    With h the smoothing length: acoustic h / (c + |v|), viscous h^2 / nu, force sqrt(h / |a|)
    (Monaghan 1992, Annu. Rev. Astron. Astrophys. 30; Morris, Fox & Zhu 1997, J. Comput. Phys. 136, eqs. 30-32).
    """

    acoustic: float = inf
    viscous: float = inf
    force: float = inf

    def and_of(self, other: "Limits") -> "Limits":
        """The shorter of each."""
        viscous, force = min(self.viscous, other.viscous), min(self.force, other.force)
        return Limits(min(self.acoustic, other.acoustic), viscous, force)


@dataclass(frozen=True)
class Status:
    """What the last step looked like, over all particles."""

    max_speed: float  # [m/s]
    max_acceleration: float  # [m/s2]
    min_density: float  # [kg/m3]
    max_density: float  # [kg/m3]
    clipped: int  # particles held back by `motion_limit`, since the start
    finite: bool  # no particle has a velocity or density that is not a number


class Lattice(Protocol):
    """Where the particles of a water are at first, counted but not yet made."""

    @property
    def n(self) -> int:
        """Number of particles; where there is an emitter, the most there will be."""
        ...

    @property
    def spacing(self) -> float:
        """Distance between particles [m]."""
        ...

    @property
    def height(self) -> float:
        """Height of the tallest box of water [m]."""
        ...

    def positions(self) -> np.ndarray:
        """(n, 3) positions of the particles [m]."""
        ...


class Fluid(Protocol):
    """Water. `elevation` is callable from a Taichi kernel; between steps everything is current and in cell order."""

    particles: Any  # None where the water has none: a closed form
    around: Any  # sums over the water within a support of a point (`shared/around.py`); only where there are particles
    sound_speed: float  # [m/s]
    reference_speed: float  # [m/s]
    status: Status
    impulse: dict[str, np.ndarray]  # (3,) per term, since the start [N s]
    work: dict[str, float]  # per term, since the start [J]; gravity with body force, diffusion by what it compresses

    def advance(self, dt: float) -> None:
        """One step of dt [s] under the wind it was built with; raises Diverged when a neighbour list overflows."""
        ...

    def elevation(self, x, z):
        """ti.func: height of the water [m] above the still surface; the bed where it is dry."""
        ...

    def elevations(self, points: np.ndarray) -> np.ndarray:
        """The same from Python: (m, 2) points x, z [m] -> (m,) heights [m]."""
        ...

    def pressures(self, points: np.ndarray) -> np.ndarray:
        """(m, 3) points [m], also on sides and bed -> (m,) pressures [Pa]; 0 where it is dry."""
        ...

    def velocities(self, points: np.ndarray) -> np.ndarray:
        """(m, 3) points [m] -> (m, 3) velocities [m/s]; 0 where it is dry."""
        ...

    def limits(self) -> Limits: ...

    def internal_energy(self) -> float:
        """Energy of compression [J]."""
        ...
