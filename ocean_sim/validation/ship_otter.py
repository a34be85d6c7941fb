"""The Otter in still water: straight ahead, and a turn with unequal propellers, against the published program.

Fossen, PythonVehicleSimulator (MIT), run with a step of 5 ms: both propellers at 100 rad/s, then 100 and 60 rad/s.
"""

from math import pi

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, percent_error
from ocean_sim.validation.shared.ship import at_sea, follow_body

MAX_PROPELLER_RATE = (0.5 * 24.4 * 9.81 / 0.01108) ** 0.5  # [rad/s]
MAX_RUDDER = pi * 35.0 / 180.0  # [rad] of the order
STRAIGHT_RESULTS = {"speed [m/s]": 2.98196, "way to 95 % of it [m]": 7.197, "trim [deg]": 2.2584}
TURN_RESULTS = {"speed in the turn [m/s]": 1.94624, "yaw rate [deg/s]": 15.6166, "radius [m]": 7.1406}
TACTICAL_RESULTS = {"advance [m]": 9.673, "transfer [m]": 6.522, "tactical diameter [m]": 14.374}
TOLERANCE, SOURCE_TEXT = {"manoeuvring": 0.5}, "PythonVehicleSimulator, otter.py"


def problems(coarse: bool) -> list[Problem]:
    ahead = {"throttle": 100.0 / MAX_PROPELLER_RATE}
    turn = {"throttle": 80.0 / MAX_PROPELLER_RATE, "rudder": -20.0 / MAX_PROPELLER_RATE * MAX_RUDDER}
    straight = tuple(Promise(name, "%", SOURCE_TEXT, TOLERANCE) for name in STRAIGHT_RESULTS)
    round_ = tuple(Promise(name, "%", SOURCE_TEXT, TOLERANCE) for name in TURN_RESULTS)
    reported = tuple(Promise(name, "%", SOURCE_TEXT) for name in TACTICAL_RESULTS)
    orders = [{"time": 0.0} | ahead, {"time": 20.0} | ahead, {"time": 20.01} | turn]
    straight_scene = at_sea({"controls": orders[:1]}, 5.0, 0.01, 15.0)
    turn_scene = at_sea({"controls": orders}, 5.0, 0.01, 60.0)
    return [
        Problem(straight_scene, straight, measure_straight, "straight", slot="ship", schemes=tuple(TOLERANCE)),
        Problem(turn_scene, round_ + reported, measure_turn, "turn", slot="ship", schemes=tuple(TOLERANCE)),
    ]


def sail_record(simulation: Simulation) -> np.ndarray:
    """Run to the end: rows (7, n) of time [s], x, z [m], speed [m/s], pitch, yaw [rad] and yaw rate [rad/s]."""
    rows = [
        (t, b.position[0], b.position[2], np.hypot(b.velocity[0], b.velocity[2]), b.angles[0], b.angles[1], b.rates[1])
        for t, b in follow_body(simulation, simulation.scene.duration)
    ]
    return np.array(rows).T


def measure_straight(simulation: Simulation) -> Finding:
    """Run straight ahead; compare final speed, distance to 95 % of it, and trim with the published program."""
    t, _, z, u, pitch, _, _ = sail_record(simulation)
    found = (u[-1], z[np.argmax(u >= 0.95 * u[-1])] - z[0], np.degrees(pitch[-1]))
    numbers = [percent_error(float(a), b) for a, b in zip(found, STRAIGHT_RESULTS.values(), strict=True)]
    return Finding(numbers, [Curve("speed", t, u)], [], ("t [s]", "speed [m/s]"))


def measure_turn(simulation: Simulation) -> Finding:
    """Run the turn; compare the steady turn, and distances from the throttle order on, with the published program."""
    t, x, z, u, _, yaw, rate = sail_record(simulation)
    begin = np.argmax(t >= 20.0)
    turned = np.abs(np.degrees(np.unwrap(yaw)))
    at = lambda angle, y: float(np.interp(angle, turned[begin:], y[begin:]))
    spin = abs(float(rate[-1]))
    found = (u[-1], np.degrees(spin), u[-1] / spin)
    marks = (at(90.0, z) - z[begin], at(90.0, np.abs(x)), at(180.0, np.abs(x)))
    pairs = zip((*found, *marks), (*TURN_RESULTS.values(), *TACTICAL_RESULTS.values()), strict=True)
    numbers = [percent_error(float(a), b) for a, b in pairs]
    return Finding(numbers, [Curve("track", x, z)], [], ("x [m]", "z [m]"), True)
