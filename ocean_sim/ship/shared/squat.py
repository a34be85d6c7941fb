"""How much deeper a ship lies under way over a bed near her keel: said before a run, never simulated."""

from math import inf, pi, sqrt
from typing import NamedTuple

import numpy as np

from ocean_sim.conventions import GRAVITY
from ocean_sim.ship.shared.hydrostatics import Hydrostatics

BLUNT = 0.1  # of the greatest area, of a slice at an end
SINKAGE = 2.4  # of the bow, for merchant ships in open shallow water


def squat(volume: float, length: float, speed: float, depth: float) -> float:
    """Sinkage of the bow [m] of a ship of a volume under water [m3] and length [m] at a speed [m/s] over a bed at a
    depth [m]: 2.4 V / L^2 F^2 / sqrt(1 - F^2) with F^2 = U^2 / (g h) (Tuck 1966, J. Fluid Mech. 26; as PIANC's ICORELS
    1980 has it); infinite from F = 1 on, where the law ends."""
    return SINKAGE * volume / length**2 * of_speed(speed, depth)


def of_speed(speed: float, depth: float) -> float:
    """F^2 / sqrt(1 - F^2), infinite from F = 1 on."""
    froude_2 = speed**2 / (GRAVITY * depth)
    return froude_2 / sqrt(1.0 - froude_2) if froude_2 < 1.0 else inf


class Slender(NamedTuple):
    """Squat of a slender hull in shallow open water, per F^2 / sqrt(1 - F^2) (Tuck 1966)."""

    sinkage: float  # of the centre of her waterplane [m]
    trim: float  # bow down [rad]
    levers: tuple[float, float]  # from there to the stern and to the bow [m]
    blunt: bool = False  # whether she ends in more than a tenth of her greatest area, which the theory does not allow

    @property
    def deepest(self) -> float:
        """How much deeper the lower of her ends lies [m]."""
        return self.sinkage + self.trim * (self.levers[1] if self.trim > 0.0 else -self.levers[0])

    def at(self, speed: float, depth: float) -> "Slender":
        """That at a speed [m/s] over a bed at a depth [m]; infinite from F = 1 on."""
        factor = of_speed(speed, depth)
        return self._replace(sinkage=factor * self.sinkage, trim=factor * self.trim)


def slender(hull: Hydrostatics) -> Slender:
    """Of a hull by its breadth B and its area S under water along its length: the pressure of the flow past S pulls at
    the waterplane by rho g F^2 / (2 pi sqrt(1 - F^2)) times the double integral of B'(x) S'(y) log|x - y|, and turns it
    by that with the lever of B in place of B (Tuck 1966, J. Fluid Mech. 26, 81)."""
    along, breadth, _ = hull.stations
    half = 0.5 * hull.voxels.size[2]
    wet = np.flatnonzero(breadth > 0.0)
    inside = slice(wet[0], wet[-1] + 1)
    x = np.concatenate([[along[inside][0] - half], along[inside], [along[inside][-1] + half]])
    b, s = (np.pad(values[inside], 1) for values in (breadth, hull.sections))
    centre = float((along * breadth).sum() / breadth.sum())
    apart = np.abs(x[:, None] - x)
    kernel = 0.5 * apart**2 * np.log(np.where(apart > 0.0, apart, 1.0)) - 0.75 * apart**2  # log, integrated twice

    def bends(values: np.ndarray) -> np.ndarray:
        """Of straight lines between the nodes, at each of them."""
        return np.diff(np.diff(values) / np.diff(x), prepend=0.0, append=0.0)

    def pulled(values: np.ndarray) -> float:
        return -float(bends(values) @ kernel @ bends(s)) * hull.density * hull.gravity / (2.0 * pi)

    stiff = hull.stiffness
    blunt = bool(max(s[1], s[-2]) > BLUNT * s.max())
    levers = (centre - float(x[0]), float(x[-1]) - centre)
    return Slender(-pulled(b) / stiff["heave"], -pulled((x - centre) * b) / stiff["pitch"], levers, blunt)
