"""Uniform flow down a rough channel of slope S, driven by g S along it: the stress of the bed, and the speed.

In the steady state the bed bears the weight along the slope under any law: tau = rho g S h, u* = sqrt(g S h). The law
gives the speed of the water next to the bed, at the height z1 of half a spacing in the middle of the lowest row:

    u(z1) = u* / kappa ln(z1 / z0),   z0 = k_s / 30.

The water is laminar, of constant viscosity and without stress on its surface, so that its profile is a parabola,

    u(z) = u_b + g S / nu (h z - z^2 / 2),   with u_b by u(z1),

and its mean U = u_b + g S h^2 / (3 nu), nine tenths of which are u_b. It starts from 0.8 of the profile. Since the
stress rises as the square of the speed, the mean comes near U as U tanh(t / T + artanh 0.8), T = U / (g S), 15 s; the
shape of the profile is settled sooner, in h^2 / nu.

The stress of the bed is the weight of the water along the slope less its gain of momentum.
"""

from math import atanh, log, sqrt

import numpy as np

from ocean_sim.basin import GRAINS_PER_Z0, KARMAN_CONSTANT
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, percent_error
from ocean_sim.validation.shared.state import particle_state, sampled_states, set_state

LENGTH, DEPTH, VISCOSITY, ROUGHNESS = 0.2, 0.1, 2e-3, 3e-3  # [m], [m], [m2/s], [m]
DENSITY, SLOPE_GRAVITY = 1000.0, 0.05  # [kg/m3], g S [m/s2]: a slope of 0.0051
STRESS = DENSITY * SLOPE_GRAVITY * DEPTH  # [Pa]
START_SHARE = 0.8  # of the steady speed
END_TIME, JUDGED_TIME = 45.0, 5.0  # [s] of the run; [s] at its end for the means
FLOW_SOURCE = "a parabola on the logarithmic law"
LAW_SOURCE = "rho (kappa u / ln(z / z0))^2, u and z means of the lowest row"
PROMISES = (
    Promise("stress of the bed, of that by its law [Pa]", "%", LAW_SOURCE, {"delta_sph": 5.0, "dfsph": 5.0}),
    Promise("stress of the bed [Pa]", "%", "rho g S h", {"delta_sph": 2.0, "dfsph": 2.0}),
    Promise("mean speed [m/s]", "%", f"u_b + g S h^2 / (3 nu); {FLOW_SOURCE}", {"delta_sph": 3.0, "dfsph": 3.0}),
    Promise("speed of the lowest row [m/s]", "%", "u* / kappa ln(z1 / z0)"),
    Promise("speed of the uppermost row [m/s]", "%", FLOW_SOURCE),
    Promise("mean speed on its way, worst [U]", "%", "tanh(t / T + artanh 0.8): as if it kept its profile"),
)


def problems(coarse: bool) -> list[Problem]:
    spacing = DEPTH / (5 if coarse else 10)
    scene = {
        "duration": END_TIME,
        "basin": {"length": LENGTH, "depth": DEPTH, "walls": {"x": "periodic"}, "floor": {"roughness": ROUGHNESS}},
        "fluid": {"spacing": spacing, "kinematic_viscosity": VISCOSITY, "body_force": [SLOPE_GRAVITY, 0.0, 0.0]},
    }
    return [Problem(scene, PROMISES, lambda run: measure_flow(run, spacing), schemes=("delta_sph", "dfsph"))]


def bed_stress(speed: float, height: float) -> float:
    """Stress of the bed [Pa] by the logarithmic law, for a speed [m/s] at a height [m] above the bed."""
    return DENSITY * (KARMAN_CONSTANT * speed / log(GRAINS_PER_Z0 * height / ROUGHNESS)) ** 2


def steady_profile(z: np.ndarray | float, spacing: float) -> np.ndarray:
    """Exact speed (n,) [m/s] of the steady flow at heights `z` (n,) [m] above the bed, for a particle spacing [m]."""
    z, lowest = np.asarray(z, dtype=float), 0.5 * spacing
    lowest_speed = sqrt(STRESS / DENSITY) / KARMAN_CONSTANT * log(GRAINS_PER_Z0 * lowest / ROUGHNESS)
    return lowest_speed + SLOPE_GRAVITY / VISCOSITY * (DEPTH * (z - lowest) - 0.5 * (z**2 - lowest**2))


def mean_speed(spacing: float) -> float:
    """Exact mean speed U [m/s] of the steady flow for a particle spacing [m]."""
    return float(steady_profile(0.0, spacing)) + SLOPE_GRAVITY * DEPTH**2 / (3.0 * VISCOSITY)


def measure_flow(simulation: Simulation, spacing: float) -> Finding:
    """Start the flow too slow, run, compare bed stress and last speeds with theory for a particle `spacing` [m]."""
    start = particle_state(simulation).position
    set_state(simulation, start, START_SHARE * np.outer(steady_profile(start[:, 1] + DEPTH, spacing), [1.0, 0.0, 0.0]))
    times, means, rows, seen = [], [], [], []
    for water in sampled_states(simulation, END_TIME, 0.5):
        z, u = water.position[:, 1] + DEPTH, water.velocity[:, 0]
        lowest, uppermost = z < spacing, z > DEPTH - spacing
        times.append(water.time)
        means.append(u.mean())
        rows.append([u[lowest].mean(), z[lowest].mean(), u[uppermost].mean()])
        if water.time > END_TIME - JUDGED_TIME:
            seen.append(np.stack([u, z], axis=1))
    t, mean = np.array(times), np.array(means)
    last = t > END_TIME - JUDGED_TIME
    gained = (mean[last][-1] - mean[last][0]) / (t[last][-1] - t[last][0])  # [m/s2]
    stress = STRESS - DENSITY * DEPTH * gained
    next_to_it, height, on_top = np.array(rows)[last].mean(axis=0)
    steady = mean_speed(spacing)
    way = np.tanh(t * SLOPE_GRAVITY / steady + atanh(START_SHARE))
    worst = int(np.argmax(np.abs(mean / steady - way)))
    numbers = (
        percent_error(stress, bed_stress(next_to_it, height)),
        percent_error(stress, STRESS),
        percent_error(mean[last].mean(), steady),
        percent_error(next_to_it, float(steady_profile(0.5 * spacing, spacing))),
        percent_error(on_top, float(steady_profile(DEPTH - 0.5 * spacing, spacing))),
        (mean[worst] / steady, way[worst], 100.0 * (mean[worst] / steady - way[worst])),
    )
    u, z = np.concatenate(seen).T
    order, depths = np.argsort(z), np.linspace(0.0, DEPTH, 41)
    measured = [Curve("last seconds", u[order], z[order] / DEPTH, points=True)]
    expected = [Curve(FLOW_SOURCE, steady_profile(depths, spacing), depths / DEPTH)]
    return Finding(numbers, measured, expected, ("u [m/s]", "z / h"))
