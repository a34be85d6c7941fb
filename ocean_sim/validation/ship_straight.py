"""A yacht that gathers way under a constant thrust T against a resistance X u |u|, then coasts.

u = U tanh(t / tau), x = U tau ln cosh(t / tau) with U = sqrt(T / X), tau = m' U / T and m' the mass with the added mass
of surge; coasting from u0, x = m' / X ln(u0 / u).
"""

from math import cosh, log, sqrt, tanh

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, relative
from ocean_sim.validation.shared.ship import OF_WATER, at_sea, ship_of, track

THRUST, DRAG, MASS, AHEAD, COAST = 14400.0, 400.0, 30000.0, 30.0, 20.0  # [N], [N s2/m2], [kg], [s], [s]


def problems(coarse: bool) -> list[Problem]:
    ship = {
        "hull": "yacht",
        "cells_per_draught": 4,
        "free": ["surge"],
        "damping": {"surge": DRAG},
        "propeller": {"thrust": THRUST},
        "controls": [{"time": 0.0, "throttle": 1.0}, {"time": AHEAD, "throttle": 1.0}, {"time": AHEAD + 0.01}],
    }
    limit = dict.fromkeys(OF_WATER, 2.0)
    names = ("speed after 10 s [m/s]", "speed after 30 s [m/s]", "way after 30 s [m]", "way while coasting [m]")
    promises = tuple(Promise(name, "%", "closed form", limit) for name in names)
    scene = at_sea(ship, 15.0, 0.05, AHEAD + COAST)
    return [Problem(scene, promises, lambda s: measure(s, promises), slot="ship", schemes=OF_WATER)]


def measure(simulation: Simulation, promises: tuple[Promise, ...]) -> Finding:
    """Speed and way."""
    ship = ship_of(simulation)
    whole = MASS + float(ship.added[2])
    top = sqrt(THRUST / DRAG)
    tau = whole * top / THRUST
    start = ship.body.position[2]
    t, u, x = np.array([(t, b.velocity[2], b.position[2] - start) for t, b in track(simulation, AHEAD + COAST)]).T
    at = lambda when, y: float(np.interp(when, t, y))
    found = (at(10.0, u), at(AHEAD, u), at(AHEAD, x), x[-1] - at(AHEAD, x))
    exact = (
        top * tanh(10.0 / tau),
        top * tanh(AHEAD / tau),
        top * tau * log(cosh(AHEAD / tau)),
        whole / DRAG * log(1.0 + DRAG / whole * top * tanh(AHEAD / tau) * (t[-1] - AHEAD)),
    )
    numbers = {p.quantity: relative(a, b) for p, a, b in zip(promises, found, exact, strict=True)}
    curve = Curve("U tanh(t / tau)", t[t < AHEAD], top * np.tanh(t[t < AHEAD] / tau))
    return Finding(numbers, [Curve("speed", t, u)], [curve], ("t [s]", "speed [m/s]"))
