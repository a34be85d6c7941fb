"""A yacht that gathers way under a constant thrust T against a resistance X u |u|, then coasts.

u = U tanh(t / tau), x = U tau ln cosh(t / tau) with U = sqrt(T / X), tau = m' U / T and m' the mass with the added mass
of surge; coasting from u0, x = m' / X ln(u0 / u).
"""

from math import cosh, log, sqrt, tanh

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, percent_error
from ocean_sim.validation.shared.ship import COMPARED_SHIPS, at_sea, follow_body, ship_of

THRUST, DRAG, MASS = 14400.0, 400.0, 30000.0  # [N], [N s2/m2], [kg]
THRUST_TIME, COAST_TIME = 30.0, 20.0  # [s]


def problems(coarse: bool) -> list[Problem]:
    ship = {
        "hull": "yacht",
        "cells_per_draught": 4,
        "free": ["surge"],
        "damping": {"surge": DRAG},
        "propeller": {"thrust": THRUST},
        "controls": [*({"time": t, "throttle": 1.0} for t in (0.0, THRUST_TIME)), {"time": THRUST_TIME + 0.01}],
    }
    limit = dict.fromkeys(COMPARED_SHIPS, 2.0)
    names = ("speed after 10 s [m/s]", "speed after 30 s [m/s]", "way after 30 s [m]", "way while coasting [m]")
    promises = tuple(Promise(name, "%", "closed form", limit) for name in names)
    scene = at_sea(ship, 15.0, 0.05, THRUST_TIME + COAST_TIME)
    return [Problem(scene, promises, measure, slot="ship", schemes=COMPARED_SHIPS)]


def measure(simulation: Simulation) -> Finding:
    ship = ship_of(simulation)
    whole = MASS + float(ship.added[2])
    top = sqrt(THRUST / DRAG)
    tau = whole * top / THRUST
    start = ship.body.position[2]
    until = THRUST_TIME + COAST_TIME
    t, u, x = np.array([(t, b.velocity[2], b.position[2] - start) for t, b in follow_body(simulation, until)]).T
    at = lambda when, y: float(np.interp(when, t, y))
    found = (at(10.0, u), at(THRUST_TIME, u), at(THRUST_TIME, x), x[-1] - at(THRUST_TIME, x))
    exact = (
        top * tanh(10.0 / tau),
        top * tanh(THRUST_TIME / tau),
        top * tau * log(cosh(THRUST_TIME / tau)),
        whole / DRAG * log(1.0 + DRAG / whole * top * tanh(THRUST_TIME / tau) * (t[-1] - THRUST_TIME)),
    )
    numbers = [percent_error(a, b) for a, b in zip(found, exact, strict=True)]
    curve = Curve("U tanh(t / tau)", t[t < THRUST_TIME], top * np.tanh(t[t < THRUST_TIME] / tau))
    return Finding(numbers, [Curve("speed", t, u)], [curve], ("t [s]", "speed [m/s]"))
