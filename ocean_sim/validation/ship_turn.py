"""Turning circle and zig-zag of the yacht, and the circle of the tug, that are shipped, within the limits of IMO
MSC.137(76).

There is no measurement of these ships, so they promise what is asked of any ship: an advance of 4.5 lengths and a
tactical diameter of 5 at most, and, as its length over its speed is below 10 s, overshoots of 10 and 25 degrees in the
10/10 zig-zag and of 25 in the 20/20. A turn of less than 1.5 lengths, or without heel outwards, is no ship's either.

Full ahead for 30 s, then 35 degrees of rudder to port; advance, transfer and tactical diameter as in IMO MSC.137(76):
from where the rudder is ordered, at 90 and 180 degrees of turn. In the zig-zag the rudder is put over by 20 (10)
degrees each time that the ship has turned as far; how much further she turns is the overshoot.
"""

from collections.abc import Callable, Iterator
from functools import partial
from itertools import pairwise
from math import degrees, radians
from typing import Any

import numpy as np

from ocean_sim.files import yaml_file
from ocean_sim.parts import library
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise
from ocean_sim.validation.shared.ship import OF_WATER, at_sea, ship_of

AHEAD, TURN, ZIGZAG, STEP = 30.0, 150.0, 100.0, 0.05  # [s]
RUDDER = 35.0  # [deg]
LENGTHS = {"yacht": 14.2, "tug": 21.3}  # [m] at the still water
CIRCLE = {  # quantity: the least and the most that is allowed, in its unit
    "speed ahead [m/s]": None,
    "advance [lengths]": (0.0, 4.5),
    "transfer [lengths]": None,
    "tactical diameter [lengths]": (1.5, 5.0),
    "radius at last [lengths]": None,
    "speed in the turn [m/s]": None,
    "drift angle [deg]": None,
    "outward heel [deg]": (0.5, 10.0),
}
OVERSHOOTS = {10.0: (10.0, 25.0), 20.0: (25.0, None)}  # [deg] the most of the first and the second
SOURCE = "IMO MSC.137(76), 5.3"


def shipped(name: str) -> dict[str, Any]:
    """Keys of a ship in configs/ship, coarser."""
    keys = yaml_file.read_mapping(library("configs") / "ship" / f"{name}.yaml").plain()
    return {key: value for key, value in keys.items() if key != "kind"} | {"cells_per_draught": 4}


def problems(coarse: bool) -> list[Problem]:
    scene = at_sea(shipped("yacht"), 15.0, STEP, AHEAD + TURN)
    found = [turning("yacht", scene, CIRCLE)]
    for angle in (20.0,) if coarse else (10.0, 20.0):
        names = tuple(promise(name, limits) for name, limits in zigzags(angle).items())
        look = lambda simulation, angle=angle: zigzag(simulation, angle)
        found.append(Problem(scene, names, look, f"zig-zag {angle:g}", slot="ship", schemes=OF_WATER))
    if not coarse:
        tug = at_sea(shipped("tug"), 15.0, STEP, AHEAD + TURN)
        found.append(turning("tug", tug, {f"tug: {name}": limits for name, limits in CIRCLE.items()}))
    return found


def turning(name: str, scene: dict[str, Any], limits: dict[str, tuple[float, float] | None]) -> Problem:
    """The turning circle of a ship; `limits` by what is measured."""
    promises = tuple(promise(quantity, within) for quantity, within in limits.items())
    look = partial(circle, length=LENGTHS[name], limits=limits)
    return Problem(scene, promises, look, f"circle of the {name}", slot="ship", schemes=OF_WATER)


def promise(name: str, limits: tuple[float, float] | None) -> Promise:
    """That a quantity lies between two limits; without them it is only reported. Its unit ends its name."""
    unit = name[name.index("[") + 1 : -1]
    if limits is None:
        return Promise(name, unit, "reported")
    return Promise(name, unit, SOURCE, dict.fromkeys(OF_WATER, 0.5 * (limits[1] - limits[0])))


def between(value: float | None, limits: tuple[float, float] | None) -> tuple[float | None, float | None, float | None]:
    """A value, the middle of its limits, and how far it is from there."""
    if limits is None or value is None:
        return value, None, None
    middle = 0.5 * (limits[0] + limits[1])
    return value, middle, value - middle


def zigzags(angle: float) -> dict[str, tuple[float, float] | None]:
    """What is measured of a zig-zag by an angle [deg], and its limits."""
    name = f"zig-zag {angle:g}/{angle:g}: "
    first, second = ((0.0, most) if most is not None else None for most in OVERSHOOTS[angle])
    return {
        name + "first overshoot [deg]": first,
        name + "second overshoot [deg]": second,
        name + "first execute to second [s]": None,
    }


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


def circle(simulation: Simulation, length: float, limits: dict[str, tuple[float, float] | None]) -> Finding:
    """A turn to port of a ship of a length [m]."""
    rows = np.array(list(sailed(simulation, lambda time, yaw: radians(RUDDER), TURN)))
    t, x, z, yaw, heel, vx, vz = rows.T
    turned = np.abs(np.unwrap(yaw))
    last = t > TURN - 10.0
    speed, rate = np.hypot(vx, vz), np.polyfit(t[last], turned[last], 1)[0]
    drift = np.unwrap(np.arctan2(vx, vz)) - np.unwrap(yaw)

    def at(angle: float, y: np.ndarray) -> float | None:
        return float(np.interp(radians(angle), turned, np.abs(y))) if turned[-1] > radians(angle) else None

    lengths = [at(90.0, z), at(90.0, x), at(180.0, x), speed[last].mean() / rate]
    found = [speed[0], *(None if way is None else way / length for way in lengths), speed[last].mean()]
    found += [degrees(abs(drift[last].mean())), degrees(heel[last].mean())]
    numbers = {name: between(value, within) for (name, within), value in zip(limits.items(), found, strict=True)}
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
    numbers = {
        name: between(value, limits) for (name, limits), value in zip(zigzags(angle).items(), values, strict=True)
    }
    return Finding(numbers, [Curve("heading", t, np.degrees(yaw))], [], ("t [s]", "heading [deg]"))
