"""How many particles water has, and how far apart what shows it is: water in closed form has none."""

from typing import Any


def count(fluid: Any) -> int:
    """Number of particles now, 0 of a closed form."""
    return 0 if fluid.particles is None else int(fluid.particles.count.now)


def spacing(fluid: Any) -> float:
    """Distance [m] between particles at rest; of a closed form between points that show its waves."""
    return float(fluid.spacing if fluid.particles is None else fluid.particles.spacing)


def described(fluid: Any) -> str:
    """For people: how many particles, and how far apart."""
    n = count(fluid)
    return f"{n} particles, {spacing(fluid):.4g} m apart" if n else "in closed form, without particles"
