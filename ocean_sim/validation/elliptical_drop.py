"""A round drop that becomes an ellipse, without walls or gravity: u = (-A0 x, A0 y), and an exact solution.

Monaghan (1994, J. Comput. Phys. 110, 399-406): radius 1 m, A0 = 100 /s, sound at 1400 m/s, to A0 t = 0.76. The
semi-axes obey A' = A^2 (a^4 - 1) / (a^4 + 1), a' = -a A with a b = 1; kinetic energy is kept. Axes are measured by
second moments, a = 2 sqrt(<x^2>), so that no single particle decides.
"""

from math import sqrt

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, free_space, percent_error
from ocean_sim.validation.shared.state import State, particle_state, sampled_states, set_state

STRAIN_RATE = 100.0  # A0 [1/s]
END_TIME = 0.76  # A0 t
TIP_SPEED = 140.0  # [m/s] at the end
SOURCE_TEXT = "Monaghan 1994, exact; a peer with 5025 particles: "
PROMISES = (
    Promise("major semi-axis [m]", "%", SOURCE_TEXT + "-0.4 %", {"delta_sph": 0.4, "dfsph": 2.0}),
    Promise("minor semi-axis [m]", "%", SOURCE_TEXT + "+2.6 %", {"delta_sph": 2.6, "dfsph": 2.0}),
    Promise("kinetic energy over its first", "%", SOURCE_TEXT + "-3.1 %", {"delta_sph": 3.1, "dfsph": 2.0}),
)


def problems(coarse: bool) -> list[Problem]:
    spacing = 0.1 if coarse else 0.025
    scene = {
        "duration": END_TIME / STRAIN_RATE,
        "basin": free_space(6.0, 3.0),
        "fluid": {"spacing": spacing, "reference_speed": TIP_SPEED, "fill": disc_rows(spacing)},
    }
    return [Problem(scene, PROMISES, measure)]


def disc_rows(spacing: float) -> list[dict]:
    """Boxes of water (`min`, `max` [m]), one per row of a lattice of this spacing [m], that fill the unit disc."""
    rows = round(1.0 / spacing)
    boxes = []
    for k in range(-rows, rows):
        half = spacing * round(sqrt(1.0 - ((k + 0.5) * spacing) ** 2) / spacing)
        if half > 0.0:
            boxes.append({"min": [-half, k * spacing], "max": [half, (k + 1) * spacing]})
    return boxes


def exact_ellipse(end: float, steps: int = 2000) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Exact shape of the drop up to A0 t = `end`: times A0 t, minor and major semi-axes [m], (steps + 1,) each."""
    from scipy.integrate import solve_ivp

    def change(_: float, y: np.ndarray) -> tuple[float, float]:
        rate, minor = y
        return rate**2 * (minor**4 - 1.0) / (minor**4 + 1.0), -minor * rate

    tau = np.linspace(0.0, end, steps + 1)
    minor = solve_ivp(change, (0.0, end), (1.0, 1.0), "DOP853", tau, rtol=1e-12, atol=1e-12).y[1]
    return tau, minor, 1.0 / minor


def measure(simulation: Simulation) -> Finding:
    """Give the drop its exact initial flow, run, and compare its shape over time with the exact ellipse."""
    start = particle_state(simulation).position
    density, radius2 = simulation.fluid.rest_density, (start**2).sum(axis=1)
    pressure = 0.5 * density * STRAIN_RATE**2 * (1.0 - radius2)
    set_state(simulation, start, STRAIN_RATE * start * [-1.0, 1.0, 0.0], pressure)
    return compare_axes(list(sampled_states(simulation, END_TIME / STRAIN_RATE, END_TIME / STRAIN_RATE / 20)))


def compare_axes(drops: list[State]) -> Finding:
    """Compare semi-axes and kinetic energy of a drop at several times with the exact ellipse."""
    tau, minor, major = exact_ellipse(END_TIME)
    wide = np.array([2.0 * sqrt(float((drop.position[:, 0] ** 2).mean())) for drop in drops])
    high = np.array([2.0 * sqrt(float((drop.position[:, 1] ** 2).mean())) for drop in drops])
    times = np.array([STRAIN_RATE * drop.time for drop in drops])
    last = times[-1]
    numbers = (
        percent_error(high[-1], float(np.interp(last, tau, major))),
        percent_error(wide[-1], float(np.interp(last, tau, minor))),
        percent_error(drops[-1].kinetic_energy / drops[0].kinetic_energy, 1.0),
    )
    measured = [Curve("minor", times, wide), Curve("major", times, high)]
    expected = [Curve("exact minor", tau, minor), Curve("exact major", tau, major)]
    return Finding(numbers, measured, expected, ("A0 t", "semi-axis [m]"))
