"""Turning circle and zig-zag of the yacht, and the circle of the tug, that are shipped, within the limits of IMO
MSC.137(76).

No measurement of these ships exists, so their limits are those of any ship: an advance of 4.5 lengths and a tactical
diameter of 5 at most, and, as the length over the speed is below 10 s, overshoots of 10 and 25 degrees in the 10/10
zig-zag and of 25 in the 20/20. A turn of less than 1.5 lengths, or without heel outwards, is no ship's either.

Full ahead for 30 s, then 35 degrees of rudder to port; advance, transfer and tactical diameter as in IMO MSC.137(76):
from the position of the rudder order, at 90 and 180 degrees of turn. In the zig-zag the rudder is put over by 20 (10)
degrees each time that the ship has turned as far; her further turn is the overshoot.
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
from ocean_sim.validation.shared.case import Curve, Finding, Number, Problem, Promise
from ocean_sim.validation.shared.ship import COMPARED_SHIPS, at_sea, ship_of

APPROACH_TIME, TURN_TIME, ZIGZAG_TIME, TIME_STEP = 30.0, 150.0, 100.0, 0.05  # [s]
RUDDER_ANGLE, COARSE_CUBES = 35.0, {"cells_per_draught": 4}  # [deg]
SHIP_LENGTHS = {"yacht": 14.2, "tug": 21.3}  # [m] at the still water
CIRCLE_LIMITS: dict[str, tuple[float, float] | None] = {  # lowest and highest allowed value, in the unit of the name
    "speed ahead [m/s]": None,
    "advance [lengths]": (0.0, 4.5),
    "transfer [lengths]": None,
    "tactical diameter [lengths]": (1.5, 5.0),
    "radius at last [lengths]": None,
    "speed in the turn [m/s]": None,
    "drift angle [deg]": None,
    "outward heel [deg]": (0.5, 10.0),
}
MAX_OVERSHOOTS = {10.0: (10.0, 25.0), 20.0: (25.0, None)}  # [deg] first and second, by angle [deg]
SOURCE_TEXT = "IMO MSC.137(76), 5.3"
Orders = Callable[[float, float], float]  # rudder [rad] by time [s] and yaw [rad]


def preset_keys(name: str) -> dict[str, Any]:
    """Scene keys of a ship from her preset configs/ship/<name>.yaml, without its kind."""
    keys = yaml_file.read_mapping(library("configs") / "ship" / f"{name}.yaml").plain()
    return {key: value for key, value in keys.items() if key != "kind"}


def problems(coarse: bool) -> list[Problem]:
    """Set-ups to run: circles of yacht and tug, zig-zags by 10 and 20 degrees; coarse: without the tug and 10."""
    scene = at_sea(preset_keys("yacht") | COARSE_CUBES, 15.0, TIME_STEP, APPROACH_TIME + TURN_TIME)
    found = [circle_problem("yacht", scene)]
    for angle in (20.0,) if coarse else (10.0, 20.0):
        promises = tuple(bounded_promise(name, limits) for name, limits in zigzag_limits(angle).items())
        look = partial(measure_zigzag, angle=angle)
        found.append(Problem(scene, promises, look, f"zig-zag {angle:g}", slot="ship", schemes=COMPARED_SHIPS))
    if not coarse:
        tug = at_sea(preset_keys("tug") | COARSE_CUBES, 15.0, TIME_STEP, APPROACH_TIME + TURN_TIME)
        found.append(circle_problem("tug", tug, "tug: "))
    return found


def circle_problem(name: str, scene: dict[str, Any], prefix: str = "") -> Problem:
    """Set-up of the turning circle of a ship of SHIP_LENGTHS; `prefix` begins the names of its quantities."""
    promises = tuple(bounded_promise(prefix + quantity, limits) for quantity, limits in CIRCLE_LIMITS.items())
    look = partial(measure_circle, length=SHIP_LENGTHS[name])
    return Problem(scene, promises, look, f"circle of the {name}", slot="ship", schemes=COMPARED_SHIPS)


def bounded_promise(name: str, limits: tuple[float, float] | None) -> Promise:
    """Promised result: a quantity lies within `limits` (None: only reported); its `name` ends with its unit."""
    unit = name[name.index("[") + 1 : -1]
    if limits is None:
        return Promise(name, unit, "reported")
    return Promise(name, unit, SOURCE_TEXT, dict.fromkeys(COMPARED_SHIPS, 0.5 * (limits[1] - limits[0])))


def bounded_number(value: float | None, limits: tuple[float, float] | None) -> Number:
    """Number (value, reference, error) with the middle of the limits as reference; the last two None without limits."""
    if limits is None or value is None:
        return value, None, None
    middle = 0.5 * (limits[0] + limits[1])
    return value, middle, value - middle


def zigzag_limits(angle: float) -> dict[str, tuple[float, float] | None]:
    """Lowest and highest allowed value (None: no limits) of each quantity of a zig-zag by an angle [deg]."""
    name = f"zig-zag {angle:g}/{angle:g}: "
    first, second = ((0.0, most) if most is not None else None for most in MAX_OVERSHOOTS[angle])
    limits = {"first overshoot [deg]": first, "second overshoot [deg]": second, "first execute to second [s]": None}
    return {name + quantity: within for quantity, within in limits.items()}


def sail_rows(
    simulation: Simulation, orders: Orders, duration: float, throttle: float = 1.0, approach: float = APPROACH_TIME
) -> Iterator[tuple[float, ...]]:
    """Sail ahead for `approach` [s], then for a duration [s] at the rudder angle [rad] that `orders` gives by time and
    yaw, at a `throttle` of -1 to 1. Yield after every step time [s], x, z [m], yaw, heel [rad], velocity along x, z
    [m/s]; time, place and yaw relative to the first order."""
    ship = ship_of(simulation)
    helm = ship.hand_over()
    helm.give(throttle, 0.0)
    while simulation.time < approach:
        simulation.step()
    begin = simulation.time
    start, yaw = ship.body.position.copy(), float(ship.body.angles[1])
    while simulation.time < begin + duration:
        helm.give(throttle, orders(simulation.time - begin, float(ship.body.angles[1]) - yaw))
        simulation.step()
        body = ship.body
        x, _, z = body.position - start
        yield simulation.time - begin, x, z, body.angles[1] - yaw, body.angles[2], body.velocity[0], body.velocity[2]


def circle_values(rows: np.ndarray, length: float, settled: float) -> list[float | None]:
    """Indices of `rows` (n, 7) of `sail_rows`: advance, transfer, tactical diameter (None if not reached), radius over
    the ship's `length` [m]; speed [m/s], drift angle, heel [deg]; the last four over the last `settled` [s]."""
    t, x, z, yaw, heel, vx, vz = rows.T
    turned = np.abs(np.unwrap(yaw))
    last = t > t[-1] - settled
    speed, rate = np.hypot(vx, vz), np.polyfit(t[last], turned[last], 1)[0]
    drift = np.unwrap(np.arctan2(vx, vz)) - np.unwrap(yaw)

    def at(angle: float, y: np.ndarray) -> float | None:
        return float(np.interp(radians(angle), turned, np.abs(y))) if turned[-1] > radians(angle) else None

    lengths = [at(90.0, z), at(90.0, x), at(180.0, x), speed[last].mean() / rate]
    found = [None if way is None else way / length for way in lengths]
    return [*found, speed[last].mean(), degrees(abs(drift[last].mean())), degrees(heel[last].mean())]


def measure_circle(simulation: Simulation, length: float) -> Finding:
    """Turn a ship of a length [m] to port; measure advance, transfer, diameter, speeds, drift angle and heel."""
    rows = np.array(list(sail_rows(simulation, lambda time, yaw: radians(RUDDER_ANGLE), TURN_TIME)))
    found = [np.hypot(rows[0, 5], rows[0, 6]), *circle_values(rows, length, 10.0)]
    numbers = [bounded_number(*pair) for pair in zip(found, CIRCLE_LIMITS.values(), strict=True)]
    return Finding(numbers, [Curve("track", rows[:, 1], rows[:, 2])], [], ("x, to port [m]", "z, ahead [m]"), True)


def zigzag_record(
    simulation: Simulation, angle: float, way: float, *sailing: float
) -> tuple[np.ndarray, list[float], list[float]]:
    """Run a zig-zag by an angle [deg], first to port (`way` 1) or starboard (-1): `sail_rows` (time, place, yaw, ...),
    reversal times [s], overshoot after each but the last [deg]. `sailing`: duration [s], throttle, approach [s]."""
    ways, executed = [way], []

    def orders(time: float, yaw: float) -> float:
        """Rudder angle [rad]; once yaw [rad] has reached the zig-zag's `angle`, it is reversed and `time` [s] noted."""
        if ways[0] * yaw >= radians(angle):
            ways[0] = -ways[0]
            executed.append(time)
        return ways[0] * radians(angle)

    rows = np.array(list(sail_rows(simulation, orders, *sailing)))
    spans = [rows[(rows[:, 0] >= a) & (rows[:, 0] <= b), 3] for a, b in pairwise(executed)]
    return rows, executed, [degrees(np.abs(yaw).max()) - angle for yaw in spans]


def measure_zigzag(simulation: Simulation, angle: float) -> Finding:
    """Run a zig-zag by an angle [deg], first to port; measure overshoots, and time between rudder orders."""
    rows, executed, overshoots = zigzag_record(simulation, angle, 1.0, ZIGZAG_TIME)
    values = [*overshoots[:2], executed[1] - executed[0]] if len(executed) > 2 else [None] * 3
    numbers = [bounded_number(*pair) for pair in zip(values, zigzag_limits(angle).values(), strict=True)]
    return Finding(numbers, [Curve("heading", rows[:, 0], np.degrees(rows[:, 3]))], [], ("t [s]", "heading [deg]"))
