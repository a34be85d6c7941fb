"""A flat raft that a steady wind W drives against a resistance X u |u|: the wind's drag k (W - u)^2 has one coefficient
below 7.5 m/s (Wu 1982).

m' u' = k (W - u)^2 - X u^2 is Riccati's equation: (u - a) / (u - b) = (a / b) exp(-r t), with a, b = W sqrt k /
(sqrt k +- sqrt X), r = 2 W sqrt(k X) / m'. k follows from the exposed faces and (2.22); how the cubes of an edge, which
face two ways, count in it, is reported.
"""

from math import sqrt

import numpy as np

from ocean_sim.conventions import AIR_DENSITY
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, relative
from ocean_sim.validation.shared.ship import OF_WATER, acting, at_sea, ship_of, track

LENGTH, BREADTH, HEIGHT, DRAUGHT = 2.0, 1.0, 0.10, 0.02  # [m]
COEFFICIENT = 1.2875e-3  # of drag, below 7.5 m/s
MASS, DRAG, WIND, LASTS = 1000.0 * LENGTH * BREADTH * DRAUGHT, 0.08, 7.0, 500.0  # [kg], [N s2/m2], [m/s], [s]


def problems(coarse: bool) -> list[Problem]:
    shape = {"kind": "box", "length": LENGTH, "breadth": BREADTH, "height": HEIGHT}
    ship = {
        "hull": {"shape": shape, "mass": MASS},
        "cells_per_draught": 4,
        "free": ["surge"],
        "damping": {"surge": DRAG},
    }
    limit = dict.fromkeys(OF_WATER, 2.0)
    promises = (
        *(Promise(name, "%", "closed form", limit) for name in ("speed after 100 s [m/s]", "way after 500 s [m]")),
        Promise("speed after 500 s over the wind's", "%", "closed form", limit),
        Promise("drag at rest [N]", "%", "(2.22) on deck and sides"),
    )
    scene = at_sea(ship, 2.0, 0.5, LASTS) | {"wind": {"kind": "stress", "u10": WIND, "targets": ["ship"]}}
    return [Problem(scene, promises, lambda s: measure(s, promises), slot="ship", schemes=OF_WATER)]


def measure(simulation: Simulation, promises: tuple[Promise, ...]) -> Finding:
    """Speed and way."""
    ship = ship_of(simulation)
    whole = MASS + float(ship.added[2])
    first = float(acting(simulation).parts[2, 0, 2])
    k, faces = first / WIND**2, LENGTH * BREADTH + 2.0 * (LENGTH + BREADTH) * (HEIGHT - DRAUGHT)
    start = ship.body.position[2]
    t, u, x = np.array([(t, b.velocity[2], b.position[2] - start) for t, b in track(simulation, LASTS)]).T
    a, b = (WIND * sqrt(k) / (sqrt(k) + sign * sqrt(DRAG)) for sign in (1.0, -1.0))
    fine = np.linspace(0.0, t[-1], 20001)
    left = a / b * np.exp(-2.0 * WIND * sqrt(k * DRAG) / whole * fine)
    exact = (a - b * left) / (1.0 - left)
    way = float(np.sum(0.5 * (exact[1:] + exact[:-1]) * np.diff(fine)))
    at = lambda when: float(np.interp(when, t, u))
    numbers = (
        relative(at(100.0), float(np.interp(100.0, fine, exact))),
        relative(float(x[-1]), way),
        relative(float(u[-1]) / WIND, float(exact[-1]) / WIND),
        relative(first, AIR_DENSITY * COEFFICIENT * WIND**2 * faces),
    )
    found = {p.quantity: number for p, number in zip(promises, numbers, strict=True)}
    return Finding(found, [Curve("speed", t, u)], [Curve("Riccati", fine, exact)], ("t [s]", "speed [m/s]"))
