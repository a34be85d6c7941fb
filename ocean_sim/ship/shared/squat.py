"""How much deeper a ship lies under way over a bed near her keel: said before a run, never simulated."""

from math import inf, sqrt

from ocean_sim.conventions import GRAVITY

SINKAGE = 2.4  # of the bow, for merchant ships in open shallow water


def squat(volume: float, length: float, speed: float, depth: float) -> float:
    """Sinkage of the bow [m] of a ship of a volume under water [m3] and length [m] at a speed [m/s] over a bed at a
    depth [m]: 2.4 V / L^2 F^2 / sqrt(1 - F^2) with F^2 = U^2 / (g h) (Tuck 1966, J. Fluid Mech. 26; as PIANC's ICORELS
    1980 has it); infinite from F = 1 on, where the law ends."""
    froude_2 = speed**2 / (GRAVITY * depth)
    return SINKAGE * volume / length**2 * froude_2 / sqrt(1.0 - froude_2) if froude_2 < 1.0 else inf
