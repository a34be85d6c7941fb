"""A standing wave in a tank: its period, and how fast it decays.

Set-up of Colagrossi, Souto-Iglesias, Antuono & Marrone (2013, Phys. Rev. E 87, 023302): g = 1 m/s2, H = 1 m, tank and
wave 2 m long, amplitude 0.05 m, free slip. The amplitude falls as exp(-2 nu k^2 t) (Lamb, Hydrodynamics, art. 348).
That is the leading order for small viscosity; at Re 250 the full relation (art. 349, deep water) decays 10 %
slower, and its period is 0.5 % longer than without viscosity. As steep as it is, k a = 0.16, its period is 0.3 % longer
than that of linear theory while it lasts (Tadjbakhsh & Keller 1960).
The set-up with nominal viscosity 0 measures the viscosity that a scheme adds by itself.
"""

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Finding, Problem, Promise, relative
from ocean_sim.validation.shared.standing import DEEP, STEEP, VISCOUS

SOURCE = "Colagrossi et al. 2013"
LAMB = f"exp(-2 nu k^2 t), Lamb art. 348; {SOURCE}"


def problems(coarse: bool) -> list[Problem]:
    return [
        problem(250.0, coarse, {"delta_sph": 10.0}),
        problem(None, coarse, {}),
        problem(2500.0, coarse, {}, slow=True),
    ]


def problem(reynolds: float | None, coarse: bool, decay: dict[str, float], slow: bool = False) -> Problem:
    """The wave at a Reynolds number sqrt(g H) H / nu; None: without viscosity."""
    name = f"Re {reynolds:g}" if reynolds else "nu 0"
    viscosity = DEEP.viscosity(reynolds) if reynolds else 0.0
    scene = {
        "duration": 4.0 * DEEP.period,
        "basin": {"length": DEEP.length, "depth": DEEP.depth, "gravity": [0.0, -DEEP.gravity, 0.0]},
        "fluid": {"spacing": 0.04 if coarse else 0.02, "kinematic_viscosity": viscosity},
    }
    promises = (
        Promise(f"{name}: period [s]", "%", STEEP, {"delta_sph": 1.0, "dfsph": 2.0}),
        Promise(f"{name}: period over that without viscosity [s]", "%", f"w^2 = g k tanh(k H); {SOURCE}"),
        Promise(f"{name}: decay rate [1/s]", "%" if reynolds else "1/s", VISCOUS, decay),
        Promise(f"{name}: decay rate over its leading order [1/s]", "%" if reynolds else "1/s", LAMB),
        Promise(f"{name}: amplitude per period", "%", LAMB, decay),
        Promise(f"{name}: effective viscosity [m2/s]", "m2/s", f"decay rate / (2 k^2); {SOURCE}"),
    )
    return Problem(scene, promises, lambda simulation: measure(simulation, promises, viscosity), name, slow)


def measure(simulation: Simulation, promises: tuple[Promise, ...], viscosity: float) -> Finding:
    """The part of the velocity that is the wave's, over time."""
    return compared(*DEEP.run(simulation), promises, viscosity)


def compared(times: np.ndarray, share: np.ndarray, promises: tuple[Promise, ...], viscosity: float) -> Finding:
    """Period and decay rate of a signal that should be cos(w t) exp(-2 nu k^2 t)."""
    period, rate = DEEP.damped_cosine(times, share)
    expected, root = DEEP.leading_rate(viscosity), DEEP.viscous_root(viscosity)
    effective = rate / DEEP.leading_rate(1.0)
    per_period, wanted = DEEP.amplitude_kept(rate), DEEP.amplitude_kept(expected)
    numbers = (
        relative(period, DEEP.finite_period(root, times)),
        relative(period, DEEP.period),
        relative(rate, -root.real) if viscosity else (rate, 0.0, rate),
        relative(rate, expected) if viscosity else (rate, 0.0, rate),
        relative(per_period, wanted),
        (effective, viscosity, effective - viscosity),
    )
    return DEEP.finding(promises, numbers, times, share, expected)
