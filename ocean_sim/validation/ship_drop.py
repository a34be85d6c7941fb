"""A sphere of 5 m, half under water, dropped by 1 m: heave against the six participants of OES Task 10.

Added mass and damping are those of Hulme (1982, J. Fluid Mech. 121), once at the natural frequency (T 4.365 s, 0.0835
of critical), once over all frequencies, with the memory of the waves made. The participants lie up to 0.033 m (rms)
apart. Wendt et al. (2019), J. Mar. Sci. Eng. 7, 379.
"""

from math import pi
from typing import Any

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise
from ocean_sim.validation.shared.ship import at_sea, pose, ship_of, track
from ocean_sim.validation.shared.tables import table, table_path

MASS, STIFFNESS, PERIOD, SHARE = 261799.39, 770.475e3, 4.365, 0.0835  # [kg], [N/m] rho g pi R^2, [s], of critical
ADDED = STIFFNESS * (PERIOD / 2.0 / pi) ** 2 * (1.0 - SHARE**2) - MASS  # [kg]
SPREAD, CLOSE = 0.033, 0.016  # [m]
CONSTANT = {"added_mass": {"heave": ADDED}, "damping": {"heave": SHARE}}


def problems(coarse: bool) -> list[Problem]:
    memory = {"radiation": str(table_path("sphere_radiation"))}
    return [problem("constant", CONSTANT, SPREAD, coarse), problem("memory", memory, CLOSE, coarse)]


def problem(name: str, keys: dict[str, Any], limit: float, coarse: bool) -> Problem:
    """The drop with constant added mass and damping, or with a memory."""
    ship = {"hull": "sphere", "free": ["heave"], "cells_per_draught": 4 if coarse else 8} | keys
    promise = Promise(f"{name}: rms of heave [m]", "m", "OES Task 10, mean of six; their spread", {"dynamic": limit})

    def measure(simulation: Simulation) -> Finding:
        real = table("oes_task10_sphere_1m")
        others = np.stack([column for name, column in real.items() if name != "time_s"])
        ship = ship_of(simulation)
        rest = ship.body.position
        pose(simulation, position=rest + np.array([0.0, 1.0, 0.0]))
        path = [(0.0, 1.0), *((t, b.position[1] - rest[1]) for t, b in track(simulation, 20.0))]
        times, heights = np.array(path).T
        until = real["time_s"] <= 20.0
        found, mean = np.interp(real["time_s"][until], times, heights), others.mean(axis=0)[until]
        rms = float(np.sqrt(np.mean((found - mean) ** 2)))
        curves = [Curve("heave", times, heights)]
        expected = [Curve("mean of six", real["time_s"][until], mean)]
        return Finding({promise.quantity: (rms, 0.0, rms)}, curves, expected, ("t [s]", "heave [m]"))

    return Problem(at_sea(ship, 10.0, 0.02), (promise,), measure, name, slot="ship", schemes=("dynamic",))
