"""A flat raft that a steady wind W drives against a resistance X u |u|: the wind's drag k (W - u)^2 has one coefficient
below 7.5 m/s (Wu 1982).

m' u' = k (W - u)^2 - X u^2 is Riccati's equation: (u - a) / (u - b) = (a / b) exp(-r t), with a, b = W sqrt k /
(sqrt k +- sqrt X), r = 2 W sqrt(k X) / m'. k follows from the exposed faces and (2.22); the part of the cubes of an
edge, which face two ways, is reported.
"""

from math import sqrt

import numpy as np

from ocean_sim.conventions import AIR_DENSITY
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, percent_error
from ocean_sim.validation.shared.ship import COMPARED_SHIPS, at_sea, current_load, follow_body, ship_of

LENGTH, BREADTH, HEIGHT, DRAUGHT = 2.0, 1.0, 0.10, 0.02  # [m]
WIND_DRAG_COEFFICIENT = 1.2875e-3  # below 7.5 m/s
MASS, DRAG = 1000.0 * LENGTH * BREADTH * DRAUGHT, 0.08  # [kg], [N s2/m2]
WIND_SPEED, DURATION = 7.0, 500.0  # [m/s], [s]


def problems(coarse: bool) -> list[Problem]:
    hull = {"shape": {"kind": "box", "length": LENGTH, "breadth": BREADTH, "height": HEIGHT}, "mass": MASS}
    ship = {"hull": hull, "cells_per_draught": 4, "free": ["surge"], "damping": {"surge": DRAG}}
    limit = dict.fromkeys(COMPARED_SHIPS, 2.0)
    promises = (
        *(Promise(name, "%", "closed form", limit) for name in ("speed after 100 s [m/s]", "way after 500 s [m]")),
        Promise("speed after 500 s over the wind's", "%", "closed form", limit),
        Promise("drag at rest [N]", "%", "(2.22) on deck and sides"),
    )
    scene = at_sea(ship, 2.0, 0.5, DURATION) | {"wind": {"kind": "stress", "u10": WIND_SPEED, "targets": ["ship"]}}
    return [Problem(scene, promises, measure, slot="ship", schemes=COMPARED_SHIPS)]


def measure(simulation: Simulation) -> Finding:
    ship = ship_of(simulation)
    whole = MASS + float(ship.added[2])
    first = float(current_load(simulation).parts[2, 0, 2])
    k, faces = first / WIND_SPEED**2, LENGTH * BREADTH + 2.0 * (LENGTH + BREADTH) * (HEIGHT - DRAUGHT)
    start = ship.body.position[2]
    t, u, x = np.array([(t, b.velocity[2], b.position[2] - start) for t, b in follow_body(simulation, DURATION)]).T
    a, b = (WIND_SPEED * sqrt(k) / (sqrt(k) + sign * sqrt(DRAG)) for sign in (1.0, -1.0))
    fine = np.linspace(0.0, t[-1], 20001)
    left = a / b * np.exp(-2.0 * WIND_SPEED * sqrt(k * DRAG) / whole * fine)
    exact = (a - b * left) / (1.0 - left)
    way = float(np.sum(0.5 * (exact[1:] + exact[:-1]) * np.diff(fine)))
    numbers = (
        percent_error(float(np.interp(100.0, t, u)), float(np.interp(100.0, fine, exact))),
        percent_error(float(x[-1]), way),
        percent_error(float(u[-1]) / WIND_SPEED, float(exact[-1]) / WIND_SPEED),
        percent_error(first, AIR_DENSITY * WIND_DRAG_COEFFICIENT * WIND_SPEED**2 * faces),
    )
    return Finding(numbers, [Curve("speed", t, u)], [Curve("Riccati", fine, exact)], ("t [s]", "speed [m/s]"))
