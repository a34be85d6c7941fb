"""Turning circle and zig-zag of the yacht: reported only, as there is no measurement of this one.

Full ahead for 30 s, then 35 degrees of rudder to port; advance, transfer and tactical diameter as in IMO MSC.137(76):
from where the rudder is ordered, at 90 and 180 degrees of turn. In the zig-zag the rudder is put over by 20 (10)
degrees each time that the ship has turned as far; how much further she turns is the overshoot.
"""

from collections.abc import Callable, Iterator
from itertools import pairwise
from math import degrees, radians

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise
from ocean_sim.validation.shared.ship import OF_WATER, at_sea, ship_of

AHEAD, TURN, ZIGZAG, STEP = 30.0, 150.0, 100.0, 0.05  # [s]
RUDDER = 35.0  # [deg]
YACHT = {
    "hull": "yacht",
    "cells_per_draught": 4,
    "damping": {"heave": 0.15, "pitch": 0.15, "roll": 0.08, "surge": 400.0},
    "propeller": {"thrust": 14400.0, "position": [0.0, 0.4, -6.3]},
    "rudder": {"area": 0.8, "aspect_ratio": 1.5, "position": [0.0, 0.5, -6.8]},
}
CIRCLE = (
    "speed ahead [m/s]",
    "advance [m]",
    "transfer [m]",
    "tactical diameter [m]",
    "radius at last [m]",
    "speed in the turn [m/s]",
    "drift angle [deg]",
    "outward heel [deg]",
)


def problems(coarse: bool) -> list[Problem]:
    scene = at_sea(YACHT, 15.0, STEP, AHEAD + TURN)
    promises = tuple(reported(name) for name in CIRCLE)
    found = [Problem(scene, promises, circle, "circle", slot="ship", schemes=OF_WATER)]
    for angle in (20.0,) if coarse else (10.0, 20.0):
        names = tuple(reported(name) for name in zigzags(angle))
        look = lambda simulation, angle=angle: zigzag(simulation, angle)
        found.append(Problem(scene, names, look, f"zig-zag {angle:g}", slot="ship", schemes=OF_WATER))
    return found


def reported(name: str) -> Promise:
    """What is only reported, in the unit that its name ends with."""
    return Promise(name, name[name.index("[") + 1 : -1], "reported")


def zigzags(angle: float) -> list[str]:
    """What is reported of a zig-zag by an angle [deg]."""
    name = f"zig-zag {angle:g}/{angle:g}: "
    return [
        name + quantity
        for quantity in ("first overshoot [deg]", "second overshoot [deg]", "first execute to second [s]")
    ]


def sailed(
    simulation: Simulation, orders: Callable[[float, float], float], lasts: float
) -> Iterator[tuple[float, ...]]:
    """Time, x, z, yaw [rad], heel [rad], velocity along x and z after every step, from the moment when the ship has
    gathered way; `orders`: the rudder [rad] at a time and a yaw."""
    ship = ship_of(simulation)
    helm = ship.hand_over()
    helm.give(1.0, 0.0)
    while simulation.time < AHEAD:
        simulation.step()
    begin = simulation.time
    start, yaw = ship.body.position.copy(), float(ship.body.angles[1])
    while simulation.time < begin + lasts:
        helm.give(1.0, orders(simulation.time - begin, float(ship.body.angles[1]) - yaw))
        simulation.step()
        body = ship.body
        x, _, z = body.position - start
        yield simulation.time - begin, x, z, body.angles[1] - yaw, body.angles[2], body.velocity[0], body.velocity[2]


def circle(simulation: Simulation) -> Finding:
    """A turn to port."""
    rows = np.array(list(sailed(simulation, lambda time, yaw: radians(RUDDER), TURN)))
    t, x, z, yaw, heel, vx, vz = rows.T
    turned = np.abs(np.unwrap(yaw))
    last = t > TURN - 10.0
    speed, rate = np.hypot(vx, vz), np.polyfit(t[last], turned[last], 1)[0]
    drift = np.unwrap(np.arctan2(vx, vz)) - np.unwrap(yaw)

    def at(angle: float, y: np.ndarray) -> float | None:
        return float(np.interp(radians(angle), turned, np.abs(y))) if turned[-1] > radians(angle) else None

    found = [speed[0], at(90.0, z), at(90.0, x), at(180.0, x), speed[last].mean() / rate, speed[last].mean()]
    found += [degrees(abs(drift[last].mean())), degrees(heel[last].mean())]
    numbers = {name: (value, None, None) for name, value in zip(CIRCLE, found, strict=True)}
    return Finding(numbers, [Curve("track", x, z)], [], ("x, to port [m]", "z, ahead [m]"))


def zigzag(simulation: Simulation, angle: float) -> Finding:
    """Rudder to port, to starboard, to port."""
    way, executed = [1.0], []

    def orders(time: float, yaw: float) -> float:
        if way[0] * yaw >= radians(angle):
            way[0] = -way[0]
            executed.append(time)
        return way[0] * radians(angle)

    t, _, _, yaw, _, _, _ = np.array(list(sailed(simulation, orders, ZIGZAG))).T
    values: list[float | None] = [None] * 3
    if len(executed) > 2:
        spans = [(t >= a) & (t <= b) for a, b in pairwise(executed)]
        values = [*(degrees(np.abs(yaw[span]).max()) - angle for span in spans[:2]), executed[1] - executed[0]]
    numbers = {name: (value, None, None) for name, value in zip(zigzags(angle), values, strict=True)}
    return Finding(numbers, [Curve("heading", t, np.degrees(yaw))], [], ("t [s]", "heading [deg]"))
