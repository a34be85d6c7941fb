"""Warnings about a wind: how much stronger than a real one it is, and its effect on the water."""

from collections.abc import Iterator
from math import hypot, isinf

from ocean_sim.conventions import figures
from ocean_sim.model import Vector3
from ocean_sim.parts import SceneFacts, called
from ocean_sim.wind.shared.air_load import U10, stress

REAL_DRAG_RATIO = "15 to 70"  # over the drag here: yacht, tug and barge in a wind of 15 m/s from ahead and abeam


def stylised(name: str, acceleration: float, preflight: SceneFacts) -> str:
    """Sentence that compares the acceleration [m/s2] of force field `name` with a real wind's stress on a layer."""
    thick = preflight.spacing or 1.0  # [m] one layer of particles; 1 where the water has none
    real = stress(U10) / (preflight.fluid.rest_density * thick)
    begin = f"{name}: a stylised force field, not a physical stress: {acceleration:.3g} m/s2 is"
    return f"{begin} {figures(acceleration / real, 2)} times what a wind of {U10:g} m/s does to a layer of {thick:g} m"


def velocity_change(name: str, acceleration: Vector3, passing_time: float, preflight: SceneFacts) -> Iterator[str]:
    """Yield a sentence on a particle's change of velocity in the force field `name`, of an acceleration [m/s2], during
    its passing time [s], and a warning if that would throw water out of the basin."""
    if isinf(passing_time):
        yield f"{name}: does not drift: it keeps accelerating what it holds by {hypot(*acceleration):.3g} m/s2"
        return
    along, up = hypot(acceleration[0], acceleration[2]) * passing_time, acceleration[1] * passing_time
    speed, g, depth = hypot(along, up), hypot(*preflight.tank.gravity), preflight.tank.depth
    yield f"{name}: one passage changes the velocity by {speed:.2g} m/s ({along:.2g} along, {up:.2g} up)"
    if speed**2 > 2.0 * g * depth:
        height = f"{speed**2 / (2.0 * g):.1f} m high, above the depth of {depth:g} m" if g else "away, without gravity"
        yield f"{name}: throws the water {height}: not a sea; make it weaker, thinner or faster"


def ship_drag_warnings(preflight: SceneFacts) -> Iterator[str]:
    """Warn that the drag (2.22) on the scene's ships that have a shape is far from that of real ships."""
    afloat = [called(name) for name, ship in preflight.ships.items() if ship.look(preflight) is not None]
    law = f"wind: its drag on {' and '.join(afloat)} is that of the sea's surface, on all of the hull that is dry"
    real = "a real ship has a coefficient of about 0.9 on the area that she turns to the wind (Blendermann 1994)"
    if afloat:
        yield f"{law}; {real}, {REAL_DRAG_RATIO} times as much: she drifts and heels too little"
