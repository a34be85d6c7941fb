"""A sphere of 5 m, half under water, dropped by 1 m: heave against the six participants of OES Task 10.

Added mass and damping are those of Hulme (1982, J. Fluid Mech. 121), once at the natural frequency (T 4.365 s, 0.0835
of critical), once over all frequencies, with the memory of the waves made. The participants lie up to 0.033 m (rms)
apart. Wendt et al. (2019), J. Mar. Sci. Eng. 7, 379.
"""

from math import pi
from typing import Any

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, absolute_error
from ocean_sim.validation.shared.ship import at_sea, follow_body, set_pose, ship_of
from ocean_sim.validation.shared.tables import table, table_path

MASS, STIFFNESS = 261799.39, 770.475e3  # [kg], [N/m] rho g pi R^2
PERIOD, DAMPING_RATIO = 4.365, 0.0835  # [s], of critical
ADDED_MASS = STIFFNESS * (PERIOD / 2.0 / pi) ** 2 * (1.0 - DAMPING_RATIO**2) - MASS  # [kg]
PARTICIPANT_SPREAD, MEMORY_TOLERANCE = 0.033, 0.016  # [m] rms
CONSTANT_KEYS = {"added_mass": {"heave": ADDED_MASS}, "damping": {"heave": DAMPING_RATIO}}


def problems(coarse: bool) -> list[Problem]:
    """Set-ups to run: the drop with constant added mass, and with wave memory; 8 (coarse: 4) cubes over the draught."""
    return [
        drop_problem("constant", CONSTANT_KEYS, PARTICIPANT_SPREAD, coarse),
        drop_problem("memory", {"radiation": str(table_path("sphere_radiation"))}, MEMORY_TOLERANCE, coarse),
    ]


def drop_problem(name: str, keys: dict[str, Any], limit: float, coarse: bool) -> Problem:
    """Set-up `name` of the drop. `keys`: ship keys of added mass and damping or memory; `limit`: tolerance of heave
    [m]; `coarse`: cubes of twice the size."""
    ship = {"hull": "sphere", "free": ["heave"], "cells_per_draught": 4 if coarse else 8} | keys
    promise = Promise(f"{name}: rms of heave [m]", "m", "OES Task 10, mean of six; their spread", {"dynamic": limit})

    def measure(simulation: Simulation) -> Finding:
        real = table("oes_task10_sphere_1m")
        others = np.stack([column for name, column in real.items() if name != "time_s"])
        rest = ship_of(simulation).body.position
        set_pose(simulation, position=rest + np.array([0.0, 1.0, 0.0]))
        path = [(0.0, 1.0), *((t, b.position[1] - rest[1]) for t, b in follow_body(simulation, 20.0))]
        times, heights = np.array(path).T
        until = real["time_s"] <= 20.0
        found, mean = np.interp(real["time_s"][until], times, heights), others.mean(axis=0)[until]
        rms = float(np.sqrt(np.mean((found - mean) ** 2)))
        expected = [Curve("mean of six", real["time_s"][until], mean)]
        return Finding([absolute_error(rms)], [Curve("heave", times, heights)], expected, ("t [s]", "heave [m]"))

    return Problem(at_sea(ship, 10.0, 0.02), (promise,), measure, name, slot="ship", schemes=("dynamic",))
