"""Decaying vortices in a periodic square, from a disturbed lattice: a regular one would give too small an error.

u = -U e^(bt) cos 2 pi x sin 2 pi y, v = U e^(bt) sin 2 pi x cos 2 pi y, b = -8 pi^2 / Re, in a square of 1 m, U =
1 m/s, Re 100 (Taylor & Green 1937; set-up of Adami, Hu & Adams 2013, J. Comput. Phys. 241, 292-307). Peers with 50 x 50
particles disturbed by 0.1 spacings: transport velocity 8.2 %, EDAC 0.9 %.
"""

from math import exp, pi

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, absolute_error, free_space, percent_error
from ocean_sim.validation.shared.state import State, particle_state, random_shifts, sampled_states, set_state

SPEED, REYNOLDS = 1.0, 100.0  # U [m/s], Re
DECAY_RATE = 8.0 * pi**2 / REYNOLDS  # [1/s] of the speed
SHIFT_SIZE = 0.1  # [spacings] by which the lattice is disturbed
SOURCE_TEXT = "exp(-8 pi^2 t / Re), Taylor & Green 1937"
PROMISES = (
    Promise("L1 of the speed at t = 1", "%", f"{SOURCE_TEXT}; a peer: 8.2 %", {"delta_sph": 8.0, "dfsph": 15.0}),
    Promise("L1 of the speed at t = 1, stretch", "%", f"{SOURCE_TEXT}; a peer: 0.9 %", {"delta_sph": 1.0}),
    Promise("largest speed at t = 1 [m/s]", "%", SOURCE_TEXT),
    Promise("kinetic energy over the exact one at t = 1", "%", SOURCE_TEXT),
)


def problems(coarse: bool) -> list[Problem]:
    spacing = 0.04 if coarse else 0.02
    scene = {
        "duration": 1.0,
        "basin": free_space(1.0, 1.0) | {"walls": {"x": "periodic", "y": "periodic"}},
        "fluid": {"spacing": spacing, "kinematic_viscosity": SPEED / REYNOLDS, "reference_speed": SPEED},
    }
    return [Problem(scene, PROMISES, measure)]


def exact_flow(position: np.ndarray, time: float) -> np.ndarray:
    """Exact velocity (n, 3) [m/s] at positions (n, 3) [m] and a time [s]."""
    x, y = 2.0 * pi * position[:, 0], 2.0 * pi * position[:, 1]
    field = np.stack([-np.cos(x) * np.sin(y), np.sin(x) * np.cos(y), 0.0 * x], axis=1)
    return SPEED * exp(-DECAY_RATE * time) * field


def measure(simulation: Simulation) -> Finding:
    """Disturb the lattice, start the exact flow, run, and compare its decay with theory."""
    start = particle_state(simulation)
    low, period = np.array(simulation.basin.lower), np.array(simulation.basin.periods)
    at = start.position + random_shifts(simulation, start.position, SHIFT_SIZE * start.spacing)
    at[:, :2] = low[:2] + np.mod(at[:, :2] - low[:2], period[:2])
    waves = np.cos(4.0 * pi * at[:, 0]) + np.cos(4.0 * pi * at[:, 1])
    set_state(simulation, at, exact_flow(at, 0.0), -0.25 * simulation.fluid.rest_density * SPEED**2 * waves)
    return compare_decay(list(sampled_states(simulation, simulation.scene.duration, simulation.scene.duration / 20)))


def compare_decay(waters: list[State]) -> Finding:
    """Compare states of the vortices at successive times with the exact flow."""
    times = np.array([water.time for water in waters])
    fastest = np.array([water.max_speed for water in waters])
    last = waters[-1]
    exact = exact_flow(last.position, last.time)
    speed, wanted = (np.linalg.norm(values, axis=1) for values in (last.velocity, exact))
    l1 = 100.0 * float(np.abs(speed - wanted).sum() / wanted.sum())
    numbers = (
        absolute_error(l1),
        absolute_error(l1),
        percent_error(float(fastest[-1]), SPEED * exp(-DECAY_RATE * last.time)),
        percent_error(last.kinetic_energy / (0.5 * last.mass * float((exact**2).sum())), 1.0),
    )
    measured = [Curve("largest speed", times, fastest)]
    expected = [Curve("exact", times, SPEED * np.exp(-DECAY_RATE * times))]
    return Finding(numbers, measured, expected, ("time [s]", "largest speed [m/s]"))
