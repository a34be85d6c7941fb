"""A round drop that becomes an ellipse, without walls or gravity: u = (-A0 x, A0 y), and an exact solution.

Monaghan (1994, J. Comput. Phys. 110, 399-406): radius 1 m, A0 = 100 /s, sound at 1400 m/s, to A0 t = 0.76. The
semi-axes obey A' = A^2 (a^4 - 1) / (a^4 + 1), a' = -a A with a b = 1; kinetic energy is kept. Axes are measured by
second moments, a = 2 sqrt(<x^2>), so no single particle decides.
"""

from math import sqrt

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, relative
from ocean_sim.validation.shared.state import State, sampled, set_state, state

RATE = 100.0  # A0 [1/s]
END = 0.76  # A0 t
FASTEST = 140.0  # [m/s] at the tips, at the end
SOURCE = "Monaghan 1994, exact; a peer with 5025 particles: "
PROMISES = (
    Promise("major semi-axis [m]", "%", SOURCE + "-0.4 %", {"delta_sph": 0.4, "dfsph": 2.0}),
    Promise("minor semi-axis [m]", "%", SOURCE + "+2.6 %", {"delta_sph": 2.6, "dfsph": 2.0}),
    Promise("kinetic energy over its first", "%", SOURCE + "-3.1 %", {"delta_sph": 3.1, "dfsph": 2.0}),
)


def problems(coarse: bool) -> list[Problem]:
    spacing = 0.1 if coarse else 0.025
    scene = {
        "duration": END / RATE,
        "basin": {
            "length": 6.0,
            "depth": 3.0,
            "gravity": [0.0, 0.0, 0.0],
            "walls": "none",
            "floor": "none",
        },
        "fluid": {"spacing": spacing, "reference_speed": FASTEST, "fill": disc(spacing)},
    }
    return [Problem(scene, PROMISES, measure)]


def disc(spacing: float) -> list[dict]:
    """The unit disc as rows of water, each a spacing high, of the lattice points inside it."""
    rows = round(1.0 / spacing)
    boxes = []
    for k in range(-rows, rows):
        half = spacing * round(sqrt(1.0 - ((k + 0.5) * spacing) ** 2) / spacing)
        if half > 0.0:
            boxes.append({"min": [-half, k * spacing], "max": [half, (k + 1) * spacing]})
    return boxes


def ellipse(end: float, steps: int = 2000) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A0 t, minor and major semi-axis [m] up to A0 t = `end`, by the classical Runge-Kutta rule."""

    def change(y: np.ndarray) -> np.ndarray:
        rate, minor = y
        return np.array([rate**2 * (minor**4 - 1.0) / (minor**4 + 1.0), -minor * rate])

    h, y = end / steps, np.array([1.0, 1.0])
    minor = [1.0]
    for _ in range(steps):
        k1 = change(y)
        k2 = change(y + 0.5 * h * k1)
        k3 = change(y + 0.5 * h * k2)
        k4 = change(y + h * k3)
        y = y + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        minor.append(y[1])
    return np.linspace(0.0, end, steps + 1), np.array(minor), 1.0 / np.array(minor)


def measure(simulation: Simulation) -> Finding:
    """Give the drop its flow, and follow its shape."""
    start = state(simulation).position
    density, radius2 = simulation.fluid.rest_density, (start**2).sum(axis=1)
    set_state(simulation, start, RATE * start * [-1.0, 1.0, 0.0], 0.5 * density * RATE**2 * (1.0 - radius2))
    return compared(list(sampled(simulation, END / RATE, END / RATE / 20)))


def compared(drops: list[State]) -> Finding:
    """A drop at several moments against the exact ellipse."""
    tau, minor, major = ellipse(END)
    wide = np.array([2.0 * sqrt(float((drop.position[:, 0] ** 2).mean())) for drop in drops])
    high = np.array([2.0 * sqrt(float((drop.position[:, 1] ** 2).mean())) for drop in drops])
    times = np.array([RATE * drop.time for drop in drops])
    last = times[-1]
    numbers = (
        relative(high[-1], float(np.interp(last, tau, major))),
        relative(wide[-1], float(np.interp(last, tau, minor))),
        relative(drops[-1].kinetic_energy / drops[0].kinetic_energy, 1.0),
    )
    return Finding(
        {promise.quantity: number for promise, number in zip(PROMISES, numbers, strict=True)},
        [Curve("minor", times, wide), Curve("major", times, high)],
        [Curve("exact minor", tau, minor), Curve("exact major", tau, major)],
        ("A0 t", "semi-axis [m]"),
    )
