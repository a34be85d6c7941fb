"""Momentum that a wind gives: over a periodic slice on a bed that slips, dP/dt = stress times plan area.

Nothing else acts along x, so this is exact, whatever the resolution and however many particles count as surface; in
single precision but for rounding: a particle's velocity gains in each step what is some 1e-5 of it, in digits of 1e-7.
On 10 layers single precision is at its limit: -2e-6 to -1.1e-5, still air -3e-6 to 1.7e-5, as its sums are rounded.

In water of 5 layers 3e-7 of the momentum goes in double precision, too (6 layers 3e-8, 7 layers 8e-10), and that is no
rounding: the bed takes it, as `impulse_walls_x_Ns` of accuracy.csv says. The pressure of a ghost particle is continued
hydrostatically from the height of its own particle, so what a particle and the image of another give each other along
the bed cancels to the mean of many, not pair by pair. On 10 layers nothing near the bed moves within this time.
"""

from typing import Any

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise
from ocean_sim.validation.shared.state import sampled
from ocean_sim.validation.shared.wind import blowing, stilled

LENGTH, DEPTH, STRESS, DURATION = 1.0, 0.5, 5.0, 0.5  # [m], [m], [Pa], [s]
LIMIT = {"f32": 1e-5, "f64": 1e-11}
SOURCE = "dP/dt = tau A, exact"


def problems(coarse: bool) -> list[Problem]:
    if coarse:
        return [problem(DEPTH / 5, "f32"), problem(DEPTH / 10, "f64")]
    return [*(problem(DEPTH / n, "f32") for n in (10, 20)), problem(DEPTH / 20, "f64")]


def problem(spacing: float, precision: str) -> Problem:
    name = f"spacing {spacing:g} m" if precision == "f32" else f"spacing {spacing:g} m, {precision}"
    limit = {"delta_sph": LIMIT[precision]}
    scene = {
        "duration": DURATION,
        "basin": {"length": LENGTH, "depth": DEPTH, "walls": {"x": "periodic"}},
        "fluid": {"spacing": spacing, "kinematic_viscosity": 1e-3},
        "wind": blowing(STRESS),
        "runtime": {"precision": precision},
    }
    promises = (
        Promise(f"{name}: dP/dt over tau A", "1", SOURCE, limit),
        Promise(f"{name}: still air, dP/dt over tau A", "1", "no wind, no momentum", limit),
        Promise(f"{name}: particles that the wind reaches", "particles", "exposed surface"),
    )
    return Problem(scene, promises, lambda simulation: measure(simulation, promises), name)


def gained(simulation: Simulation) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] and momentum along x [N s] since the start."""
    states = list(sampled(simulation, DURATION, DURATION / 20))
    momentum = np.array([water.momentum[0] for water in states])
    return np.array([water.time for water in states]), momentum - momentum[0]


def measure(simulation: Simulation, promises: tuple[Promise, ...]) -> Finding:
    """The momentum over time, compared with that of still air."""
    times, momentum = gained(simulation)
    water: Any = simulation.fluid  # of a kind that has exposed areas
    reached = np.count_nonzero(water.exposure.area.to_numpy()[:, 1])
    with stilled(simulation) as without:
        _, calm = gained(without)
    wanted = STRESS * LENGTH * times
    part, rest = momentum[-1] / wanted[-1], calm[-1] / wanted[-1]
    numbers = ((part, 1.0, part - 1.0), (rest, 0.0, rest), (float(reached), None, None))
    return Finding(
        {promise.quantity: number for promise, number in zip(promises, numbers, strict=True)},
        [Curve("momentum", times, momentum, points=True)],
        [Curve("tau A t", times, wanted)],
        ("time [s]", "momentum along the wind [N s/m]"),
    )
