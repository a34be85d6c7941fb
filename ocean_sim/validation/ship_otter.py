"""The Otter in still water: straight ahead, and a turn with unequal propellers, against the published program.

Fossen, PythonVehicleSimulator (MIT), run with a step of 5 ms: both propellers at 100 rad/s, then 100 and 60 rad/s.
"""

from collections.abc import Callable
from math import pi

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, relative
from ocean_sim.validation.shared.ship import at_sea, track

FASTEST = (0.5 * 24.4 * 9.81 / 0.01108) ** 0.5  # [rad/s]
FULL = pi * 35.0 / 180.0  # [rad] of the rudder order
STRAIGHT = {"speed [m/s]": 2.98196, "way to 95 % of it [m]": 7.197, "trim [deg]": 2.2584}
TURN = {"speed in the turn [m/s]": 1.94624, "yaw rate [deg/s]": 15.6166, "radius [m]": 7.1406}
TACTICAL = {"advance [m]": 9.673, "transfer [m]": 6.522, "tactical diameter [m]": 14.374}
LIMIT, SOURCE = {"manoeuvring": 0.5}, "PythonVehicleSimulator, otter.py"


def problems(coarse: bool) -> list[Problem]:
    ahead = {"throttle": 100.0 / FASTEST}
    turn = {"throttle": 80.0 / FASTEST, "rudder": -20.0 / FASTEST * FULL}
    straight = tuple(Promise(name, "%", SOURCE, LIMIT) for name in STRAIGHT)
    round_ = tuple(Promise(name, "%", SOURCE, LIMIT) for name in TURN)
    reported = tuple(Promise(name, "%", SOURCE) for name in TACTICAL)
    return [
        problem("straight", [{"time": 0.0} | ahead], 15.0, straight, measure_straight),
        problem(
            "turn",
            [{"time": 0.0} | ahead, {"time": 20.0} | ahead, {"time": 20.01} | turn],
            60.0,
            round_ + reported,
            measure_turn,
        ),
    ]


def problem(
    name: str, rows: list[dict], seconds: float, promises: tuple[Promise, ...], measure: Callable[[Simulation], Finding]
) -> Problem:
    scene = at_sea({"controls": rows}, 5.0, 0.01, seconds)
    return Problem(scene, promises, measure, name, slot="ship", schemes=("manoeuvring",))


def sailed(simulation: Simulation) -> np.ndarray:
    """(7, n): time, x, z, speed, pitch, yaw, yaw rate."""
    seconds = simulation.scene.duration
    rows = [
        (t, b.position[0], b.position[2], np.hypot(b.velocity[0], b.velocity[2]), b.angles[0], b.angles[1], b.rates[1])
        for t, b in track(simulation, seconds)
    ]
    return np.array(rows).T


def measure_straight(simulation: Simulation) -> Finding:
    t, _, z, u, pitch, _, _ = sailed(simulation)
    way = z[np.argmax(u >= 0.95 * u[-1])] - z[0]
    found = (u[-1], way, np.degrees(pitch[-1]))
    numbers = {name: relative(float(a), b) for a, (name, b) in zip(found, STRAIGHT.items(), strict=True)}
    return Finding(numbers, [Curve("speed", t, u)], [], ("t [s]", "speed [m/s]"))


def measure_turn(simulation: Simulation) -> Finding:
    t, x, z, u, _, yaw, rate = sailed(simulation)
    begin = np.argmax(t >= 20.0)
    turned = np.abs(np.degrees(np.unwrap(yaw)))
    at = lambda angle, y: float(np.interp(angle, turned[begin:], y[begin:]))
    spin = abs(float(rate[-1]))
    found = (u[-1], np.degrees(spin), u[-1] / spin)
    numbers = {name: relative(float(a), b) for a, (name, b) in zip(found, TURN.items(), strict=True)}
    aside = np.abs(x)
    marks = (at(90.0, z) - z[begin], at(90.0, aside), at(180.0, aside))
    numbers |= {name: relative(a, b) for a, (name, b) in zip(marks, TACTICAL.items(), strict=True)}
    return Finding(numbers, [Curve("track", x, z)], [], ("x [m]", "z [m]"))
