"""Draught of four shapes from light to nearly sunk, and trim of a barge whose load is shifted, against Archimedes."""

from functools import partial
from math import acos, atan, degrees, pi, sqrt
from typing import Any

import numpy as np

from ocean_sim.conventions import WATER_DENSITY
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, percent_error
from ocean_sim.validation.shared.ship import COMPARED_SHIPS, UPRIGHT, at_sea, balance_heave, floating_ship, ship_of

HEIGHT = 1.0  # [m] of every shape
SHAPES: dict[str, dict[str, Any]] = {
    "box": {"kind": "box", "length": 5.0, "breadth": 2.0, "height": HEIGHT},
    "cylinder": {"kind": "cylinder", "length": 4.0, "radius": 0.5},
    "wigley": {"kind": "wigley", "length": 5.0, "breadth": 1.0, "draught": 0.6, "height": HEIGHT},
    "sphere": {"kind": "sphere", "radius": 0.5},
}
RELATIVE_DENSITIES = (0.1, 0.3, 0.5, 0.7, 0.95)
BARGE_TRIM = atan(10.0 * 5.0 / (320.0 * 15.166667))  # [rad] by 10 t moved 5 m aft: w x / (W GM_L)
SOURCE_TEXT = "Archimedes, closed form"


def problems(coarse: bool) -> list[Problem]:
    """Set-ups to run: four shapes, each at five relative densities (coarse: one), and a trimmed barge."""
    wanted = (0.95,) if coarse else RELATIVE_DENSITIES
    return [*(shape_problem(shape, density) for shape in SHAPES for density in wanted), trim_problem()]


def submerged_volume(shape: str, draught: float) -> float:
    """Volume under water [m3] of a shape of SHAPES at a draught [m]."""
    s, t = SHAPES[shape], draught
    if shape == "box":
        return s["length"] * s["breadth"] * t
    if shape == "cylinder":
        r = s["radius"]
        return s["length"] * (r * r * acos((r - t) / r) - (r - t) * sqrt(max(2.0 * r * t - t * t, 0.0)))
    if shape == "sphere":
        return pi * t * t * (s["radius"] - t / 3.0)
    depth, area = s["draught"], s["breadth"] * s["length"] * 2.0 / 3.0
    curved = min(t, depth)
    share = curved - (depth**3 - (depth - curved) ** 3) / (3.0 * depth**2)
    return area * (share + max(t - depth, 0.0))


def exact_draught(shape: str, density: float) -> float:
    """Draught [m] of a shape of SHAPES at a density relative to water."""
    from scipy.optimize import brentq

    displaced = density * submerged_volume(shape, HEIGHT)
    return brentq(lambda draught: submerged_volume(shape, draught) - displaced, 0.0, HEIGHT, xtol=1e-15)


def shape_problem(shape: str, density: float) -> Problem:
    """Set-up of a shape of SHAPES at a density relative to water."""
    name = f"{shape} {density:g}"
    hull = {"shape": SHAPES[shape], "mass": density * submerged_volume(shape, HEIGHT) * WATER_DENSITY}
    promise = Promise(f"{name}: draught [m]", "%", SOURCE_TEXT, dict.fromkeys(COMPARED_SHIPS, 1.0))
    measure = partial(measure_draught, exact=exact_draught(shape, density))
    return Problem(at_sea({"hull": hull}, 5.0, 0.01), (promise,), measure, name, slot="ship", schemes=("hydrostatic",))


def measure_draught(simulation: Simulation, exact: float) -> Finding:
    """Balance the upright ship, and compare its draught with the exact one [m]."""
    ship = floating_ship(simulation)
    balance_heave(simulation, UPRIGHT)
    found = float(ship.hydrostatics.matter.centre[1] - ship.body.position[1])
    return Finding([percent_error(found, exact)], [Curve("draught", np.array([exact]), np.array([found]), True)])


def trim_problem() -> Problem:
    """Set-up of the barge whose load of 10 t is moved 5 m aft."""
    limits = dict.fromkeys(COMPARED_SHIPS, 1.0)
    promise = Promise("trim of a barge by shifted load [deg]", "%", "w x / (W GM_L)", limits)

    def measure(simulation: Simulation) -> Finding:
        return Finding([percent_error(-degrees(ship_of(simulation).body.angles[0]), degrees(BARGE_TRIM))])

    ship = {"hull": "barge20", "centre_of_mass": [0.0, 2.5, -10.0 * 5.0 / 320.0]}
    return Problem(at_sea(ship, 20.0, 0.01), (promise,), measure, "trim", slot="ship", schemes=("hydrostatic",))
