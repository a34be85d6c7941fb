"""A yacht of 30 t at rest in calm water for a minute: it neither drifts nor rolls by itself."""

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, absolute_error
from ocean_sim.validation.shared.ship import COMPARED_SHIPS, at_sea, follow_body, ship_of

REST_DURATION = 60.0  # [s]


def problems(coarse: bool) -> list[Problem]:
    ship = {"hull": "yacht", "cells_per_draught": 4 if coarse else 8, "heading_deg": 30.0}
    scene = at_sea(ship, 15.0, 0.05, REST_DURATION) | {"runtime": {"precision": "f32"}}
    promises = (
        Promise("drift [mm/s]", "mm/s", "at rest", dict.fromkeys(COMPARED_SHIPS, 1.0)),
        Promise("largest roll [deg]", "deg", "at rest", dict.fromkeys(COMPARED_SHIPS, 0.05)),
    )
    return [Problem(scene, promises, measure, slot="ship", schemes=COMPARED_SHIPS)]


def measure(simulation: Simulation) -> Finding:
    """Run for a minute in calm water; measure the drift speed [mm/s] and the largest roll [deg]."""
    start = ship_of(simulation).body.position
    rows = [(t, *(b.position - start), b.angles[2]) for t, b in follow_body(simulation, REST_DURATION)]
    t, x, _, z, roll = np.array(rows).T
    drift, heel = 1e3 * float(np.hypot(x[-1], z[-1])) / t[-1], float(np.degrees(np.abs(roll).max()))
    curve = Curve("roll", t, np.degrees(roll))
    return Finding([absolute_error(drift), absolute_error(heel)], [curve], [], ("t [s]", "roll [deg]"))
