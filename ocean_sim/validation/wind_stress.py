"""Momentum of the water under a wind: over a periodic slice on a bed that slips, dP/dt = stress times plan area.

Nothing else acts along x, so this is exact at any resolution and for any number of surface particles, in single
precision but for rounding: in each step a particle gains some 1e-5 of its velocity, in digits of 1e-7.

On 5 layers the bed takes some momentum in double precision, too (`impulse_walls_x_Ns` of accuracy.csv): the pressure of
a ghost particle is continued hydrostatically from the height of its own particle, so that the forces along the bed
between a particle and the image of another cancel in the mean of many, not pair by pair.
"""

from typing import Any

import numpy as np

from ocean_sim.parts import config_of
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, absolute_error, reported
from ocean_sim.validation.shared.state import record_run

WIND_SPEED = 10.0  # u10 [m/s]
WU_STRESS = 0.177625  # [Pa] of that wind by Wu (1982), in air of 1.225 kg/m3
LENGTH, DEPTH, STRESS, DURATION = 1.0, 0.5, 5.0, 0.5  # [m], [m], [Pa], [s]
MOMENTUM_TOLERANCE = {"f32": 1e-5, "f64": 1e-11}
SOURCE_TEXT = "dP/dt = tau A, exact"


def problems(coarse: bool) -> list[Problem]:
    """Set-ups to run: slices of several spacings in single and double precision; coarse: fewer layers."""
    if coarse:
        return [slice_problem(DEPTH / 5, "f32"), slice_problem(DEPTH / 10, "f64")]
    return [*(slice_problem(DEPTH / n, "f32") for n in (10, 20)), slice_problem(DEPTH / 20, "f64")]


def slice_problem(spacing: float, precision: str) -> Problem:
    """Set-up of a slice, periodic along the wind, with a particle spacing [m], in a precision, `f32` or `f64`."""
    name = f"spacing {spacing:g} m" if precision == "f32" else f"spacing {spacing:g} m, {precision}"
    limit = {"delta_sph": MOMENTUM_TOLERANCE[precision]}
    scene = {
        "duration": DURATION,
        "basin": {"length": LENGTH, "depth": DEPTH, "walls": {"x": "periodic"}},
        "fluid": {"spacing": spacing, "kinematic_viscosity": 1e-3},
        "wind": wind_keys(STRESS),
        "runtime": {"precision": precision},
    }
    promises = (
        Promise(f"{name}: dP/dt over tau A", "1", SOURCE_TEXT, limit),
        Promise(f"{name}: still air, dP/dt over tau A", "1", "no wind, no momentum", limit),
        Promise(f"{name}: particles that the wind reaches", "particles", "exposed surface"),
    )
    return Problem(scene, promises, measure, name)


def gained_momentum(simulation: Simulation) -> tuple[np.ndarray, np.ndarray]:
    """Run to the end: times (n,) [s], and momentum along x (n,) [N s] gained since the start."""
    times, momentum = record_run(simulation, DURATION / 20, lambda water: water.momentum[0])
    return times, momentum - momentum[0]


def measure(simulation: Simulation) -> Finding:
    """Run with and without wind, and compare the gain of momentum with stress times plan area."""
    times, momentum = gained_momentum(simulation)
    water: Any = simulation.fluid  # of a kind that has exposed areas
    reached = np.count_nonzero(water.exposure.area.to_numpy()[:, 1])
    with without_wind(simulation) as without:
        _, calm = gained_momentum(without)
    wanted = STRESS * LENGTH * times
    part, rest = momentum[-1] / wanted[-1], calm[-1] / wanted[-1]
    numbers = (absolute_error(part, 1.0), absolute_error(rest), reported(float(reached)))
    measured = [Curve("momentum", times, momentum, points=True)]
    expected = [Curve("tau A t", times, wanted)]
    return Finding(numbers, measured, expected, ("time [s]", "momentum along the wind [N s/m]"))


def wind_keys(stress: float, **keys: float) -> dict:
    """Scene keys of a wind along +x, its drag law scaled by `gain` to give this stress [Pa]; `keys`: further keys."""
    return {"kind": "stress", "u10": WIND_SPEED, "heading_deg": 90.0, "gain": stress / WU_STRESS, **keys}


def without_wind(simulation: Simulation) -> Simulation:
    still = config_of("wind", "still").model_validate({"kind": "still"})
    return Simulation(simulation.scene.model_copy(update={"wind": still}))
