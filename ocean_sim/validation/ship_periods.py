"""Natural periods of heave, roll and pitch of a barge of 20 m in calm water, from small releases.

With added mass 4.348, 6.295 and 3.996 s (panel method at the natural frequencies: 431.7 t, 1167.8 and 11261 t m2), by
`dynamic`, whose own rules of thumb come within a tenth; without it 2.837, 5.200 and 2.576 s, by `hydrostatic`.
"""

from math import pi, sqrt
from typing import Any

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared import ship as ships
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, percent_error

STIFFNESS = {"heave": 1569.6e3, "roll": 3662.4e3, "pitch": 47611e3}  # [N/m], [N m/rad]
INERTIA = {"heave": 320e3, "roll": 2508.8e3, "pitch": 8000e3}  # [kg], [kg m2]
ADDED_MASS = {"heave": 431.7e3, "roll": 1167.8e3, "pitch": 11261e3}
SOURCE_TEXT = "Capytaine, panel method; rho g A, W GM"


def problems(coarse: bool) -> list[Problem]:
    """Set-ups to run: the barge with added mass by rule of thumb, and given; 8 (coarse: 4) cubes over the draught."""
    cells = 4 if coarse else 8
    given = {"added_mass": ADDED_MASS, "damping": {"heave": 0.0, "pitch": 0.0, "roll": 0.0}}
    return [
        release_problem("by rule", {}, {"hydrostatic": 1.0, "dynamic": 10.0}, ("hydrostatic", "dynamic"), cells),
        release_problem("given", given, {"dynamic": 1.0}, ("dynamic",), cells),
    ]


def release_problem(
    name: str, keys: dict[str, Any], limits: dict[str, float], schemes: tuple[str, ...], cells: int
) -> Problem:
    """Set-up `name`: the barge, displaced and released, with `cells` cubes over its draught and ship `keys` (none:
    added mass by rule of thumb); `limits`: tolerances [%] by scheme."""
    ship = {"hull": "barge20", "cells_per_draught": cells, "free": list(STIFFNESS)} | keys
    promises = tuple(Promise(f"{name}: {motion} period [s]", "%", SOURCE_TEXT, limits) for motion in STIFFNESS)

    def measure(simulation: Simulation) -> Finding:
        wet = ships.ship_of(simulation).added.any()
        numbers, curves = [], []
        for motion, k in STIFFNESS.items():
            exact = 2.0 * pi * sqrt((INERTIA[motion] + (ADDED_MASS[motion] if wet else 0.0)) / k)
            times, values = release_record(simulation, motion, 3.2 * exact)
            numbers.append(percent_error(ships.zero_crossing_period(times, values), exact))
            curves.append(Curve(motion, times, values / np.abs(values).max()))
        return Finding(numbers, curves, [], ("t [s]", "over its first value"))

    return Problem(ships.at_sea(ship, 20.0, 0.04), promises, measure, name, slot="ship", schemes=schemes)


def release_record(simulation: Simulation, motion: str, seconds: float) -> tuple[np.ndarray, np.ndarray]:
    """Displace the ship by 2 cm or half a degree in a `motion` (heave, pitch or roll), release it, and run for so many
    `seconds`. Return times (n,) [s] and values of the motion (n,) [m] or [rad]."""
    rest = np.array([0.0, 0.5, 0.0])
    turn = ships.turn_quaternion(*{"roll": (2, 0.5), "pitch": (0, 0.5), "heave": (0, 0.0)}[motion])
    ships.set_pose(simulation, position=rest + [0.0, 0.02 if motion == "heave" else 0.0, 0.0], orientation=turn)
    begin, times, values = simulation.time, [], []
    number = {"roll": 2, "pitch": 0, "heave": 1}[motion]
    for time, body in ships.follow_body(simulation, begin + seconds):
        times.append(time - begin)
        values.append(body.position[1] - 0.5 if motion == "heave" else body.angles[number])
    return np.array(times), np.array(values)
