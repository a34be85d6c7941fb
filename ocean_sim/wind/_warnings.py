"""What `check` says of a force field: how much stronger than a real wind it is, and what it will do to the water."""

from math import hypot, isinf
from typing import Any

from ocean_sim.conventions import WATER_DENSITY
from ocean_sim.parts import Vector3
from ocean_sim.wind._air_load import stress

U10 = 10.0  # [m/s] the real wind that force fields are compared with


def stylised(name: str, acceleration: float, scene: Any) -> str:
    """How a force field of this size [m/s2] compares with the stress of a wind on one layer of particles."""
    lattice = getattr(scene.fluid, "lattice", None)
    layer = lattice(scene.basin.build()).spacing if lattice else 1.0  # [m]
    real = stress(U10) / (getattr(scene.fluid, "rest_density", WATER_DENSITY) * layer)
    return (
        f"{name}: a stylised force field, not a physical stress: {acceleration:.3g} m/s2 is {acceleration / real:.1e} "
        f"times what a wind of {U10:g} m/s does to a layer of {layer:g} m"
    )


def kick(name: str, acceleration: Vector3, passing_time: float, scene: Any) -> list[str]:
    """What one passage does to a particle, and whether that throws the water out of the basin."""
    if isinf(passing_time):
        return [f"{name}: does not drift: it goes on accelerating what it holds by {hypot(*acceleration):.3g} m/s2"]
    along, up = hypot(acceleration[0], acceleration[2]) * passing_time, acceleration[1] * passing_time
    speed, g, depth = hypot(along, up), hypot(*scene.basin.gravity), scene.basin.depth
    sentences = [f"{name}: the kick of one passage is {speed:.2g} m/s ({along:.2g} along, {up:.2g} up)"]
    if speed**2 > 2.0 * g * depth:
        height = f"{speed**2 / (2.0 * g):.1f} m high, above the depth of {depth:g} m" if g else "away, without gravity"
        sentences.append(f"{name}: throws the water {height}: not a sea; make it weaker, thinner or faster")
    return sentences
