"""Draught of four shapes from light to nearly sunk, and trim of a barge whose load is shifted, against Archimedes."""

from functools import partial
from math import acos, atan, degrees, pi, sqrt
from typing import Any

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, relative
from ocean_sim.validation.shared.ship import DENSITY, OF_WATER, at_sea, balanced, floating, ship_of

HEIGHT = 1.0  # [m] of every shape
SHAPES: dict[str, dict[str, Any]] = {
    "box": {"kind": "box", "length": 5.0, "breadth": 2.0, "height": HEIGHT},
    "cylinder": {"kind": "cylinder", "length": 4.0, "radius": 0.5},
    "wigley": {"kind": "wigley", "length": 5.0, "breadth": 1.0, "draught": 0.6, "height": HEIGHT},
    "sphere": {"kind": "sphere", "radius": 0.5},
}
RELATIVE = (0.1, 0.3, 0.5, 0.7, 0.95)
SHIFT = atan(10.0 * 5.0 / (320.0 * 15.166667))  # [rad] 10 t moved 5 m aft on the barge: w x / (W GM_L)
SOURCE = "Archimedes, closed form"


def problems(coarse: bool) -> list[Problem]:
    wanted = (0.95,) if coarse else RELATIVE
    return [*(problem(shape, density) for shape in SHAPES for density in wanted), trimmed()]


def volume(shape: str, draught: float) -> float:
    """Under water at a draught [m3]."""
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


def draught(shape: str, density: float) -> float:
    """Where the shape floats [m], by halving."""
    low, high = 0.0, HEIGHT
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if volume(shape, middle) < density * volume(shape, HEIGHT) else (low, middle)
    return low


def problem(shape: str, density: float) -> Problem:
    """A shape at a relative density."""
    name = f"{shape} {density:g}"
    hull = {"shape": SHAPES[shape], "mass": density * volume(shape, HEIGHT) * DENSITY}
    promise = Promise(f"{name}: draught [m]", "%", SOURCE, dict.fromkeys(OF_WATER, 1.0))
    measure = partial(measured, promise=promise, exact=draught(shape, density))
    return Problem(at_sea({"hull": hull}, 5.0, 0.01), (promise,), measure, name, slot="ship", schemes=("hydrostatic",))


def measured(simulation: Simulation, promise: Promise, exact: float) -> Finding:
    """Where weight and buoyancy balance, upright."""
    ship = floating(simulation)
    balanced(simulation, np.array([1.0, 0.0, 0.0, 0.0]))
    found = float(ship.hydrostatics.matter.centre[1] - ship.body.position[1])
    return Finding(
        {promise.quantity: relative(found, exact)}, [Curve("draught", np.array([exact]), np.array([found]), True)]
    )


def trimmed() -> Problem:
    """The barge with 10 t moved 5 m aft."""
    promise = Promise("trim of a barge by shifted load [deg]", "%", "w x / (W GM_L)", dict.fromkeys(OF_WATER, 1.0))

    def measure(simulation: Simulation) -> Finding:
        ship = ship_of(simulation)
        return Finding({promise.quantity: relative(-degrees(ship.body.angles[0]), degrees(SHIFT))})

    ship = {"hull": "barge20", "centre_of_mass": [0.0, 2.5, -10.0 * 5.0 / 320.0]}
    return Problem(at_sea(ship, 20.0, 0.01), (promise,), measure, "trim", slot="ship", schemes=("hydrostatic",))
