"""A yacht of 30 t at rest in calm water for a minute: it neither drifts nor rolls by itself."""

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise
from ocean_sim.validation.shared.ship import OF_WATER, at_sea, ship_of, track

SECONDS = 60.0


def problems(coarse: bool) -> list[Problem]:
    ship = {"hull": "yacht", "cells_per_draught": 4 if coarse else 8, "heading_deg": 30.0}
    scene = at_sea(ship, 15.0, 0.05, SECONDS) | {"runtime": {"precision": "f32"}}
    promises = (
        Promise("drift [mm/s]", "mm/s", "at rest", dict.fromkeys(OF_WATER, 1.0)),
        Promise("largest roll [deg]", "deg", "at rest", dict.fromkeys(OF_WATER, 0.05)),
    )
    return [
        Problem(scene, promises, lambda simulation: measure(simulation, promises), slot="ship", schemes=OF_WATER),
    ]


def measure(simulation: Simulation, promises: tuple[Promise, ...]) -> Finding:
    """How far it gets, and how far it heels."""
    ship = ship_of(simulation)
    start = ship.body.position
    rows = [(t, *(b.position - start), b.angles[2]) for t, b in track(simulation, SECONDS)]
    t, x, _, z, roll = np.array(rows).T
    drift, heel = 1e3 * float(np.hypot(x[-1], z[-1])) / t[-1], float(np.degrees(np.abs(roll).max()))
    numbers = {promises[0].quantity: (drift, 0.0, drift), promises[1].quantity: (heel, 0.0, heel)}
    return Finding(numbers, [Curve("roll", t, np.degrees(roll))], [], ("t [s]", "roll [deg]"))
