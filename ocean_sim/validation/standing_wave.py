"""A standing wave in a tank: its period, and how fast it decays.

Set-up of Colagrossi, Souto-Iglesias, Antuono & Marrone (2013, Phys. Rev. E 87, 023302): g = 1 m/s2, H = 1 m, tank and
wave 2 m long, amplitude 0.05 m, free slip. The amplitude falls as exp(-2 nu k^2 t) (Lamb, Hydrodynamics, art. 348).
That is the leading order for small viscosity; at Re 250 the full relation (art. 349, deep water) is 10 % slower.
The set-up with nominal viscosity 0 measures the viscosity that a scheme adds by itself.
"""

from math import exp, pi, sqrt, tanh

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, relative
from ocean_sim.validation.shared.state import sampled, set_state, state

G, DEPTH, LENGTH, AMPLITUDE = 1.0, 1.0, 2.0, 0.05
K = 2.0 * pi / LENGTH  # [1/m]
OMEGA = sqrt(G * K * tanh(K * DEPTH))  # [1/s] dispersion relation
PERIOD = 2.0 * pi / OMEGA
SOURCE = "Colagrossi et al. 2013"
LAMB = f"exp(-2 nu k^2 t), Lamb art. 348; {SOURCE}"
FULL = "viscous dispersion relation, Lamb art. 349"


def problems(coarse: bool) -> list[Problem]:
    return [
        problem(250.0, coarse, {"delta_sph": 10.0}),
        problem(None, coarse, {}),
        problem(2500.0, coarse, {}, slow=True),
    ]


def problem(reynolds: float | None, coarse: bool, decay: dict[str, float], slow: bool = False) -> Problem:
    """The wave at a Reynolds number sqrt(g H) H / nu; None: without viscosity."""
    name = f"Re {reynolds:g}" if reynolds else "nu 0"
    viscosity = sqrt(G * DEPTH) * DEPTH / reynolds if reynolds else 0.0
    scene = {
        "duration": 4.0 * PERIOD,
        "basin": {"length": LENGTH, "depth": DEPTH, "gravity": [0.0, -G, 0.0]},
        "fluid": {"spacing": 0.04 if coarse else 0.02, "kinematic_viscosity": viscosity},
    }
    promises = (
        Promise(f"{name}: period [s]", "%", f"w^2 = g k tanh(k H); {SOURCE}", {"delta_sph": 1.0, "dfsph": 2.0}),
        Promise(f"{name}: decay rate [1/s]", "%" if reynolds else "1/s", FULL, decay),
        Promise(f"{name}: decay rate over its leading order [1/s]", "%" if reynolds else "1/s", LAMB),
        Promise(f"{name}: amplitude per period", "%", LAMB, decay),
        Promise(f"{name}: effective viscosity [m2/s]", "m2/s", f"decay rate / (2 k^2); {SOURCE}"),
    )
    return Problem(scene, promises, lambda simulation: measure(simulation, promises, viscosity), name, slow)


def flow(position: np.ndarray) -> np.ndarray:
    """Velocity of the wave of amplitude 1 m as it passes through the level, in linear theory [m/s]."""
    x, y = position[:, 0], position[:, 1] + DEPTH
    scale = G * K / OMEGA / np.cosh(K * DEPTH)
    along, up = np.sin(K * x) * np.cosh(K * y), -np.cos(K * x) * np.sinh(K * y)
    return scale * np.stack([along, up, np.zeros_like(x)], axis=1)


def viscous_rate(viscosity: float) -> float:
    """Decay rate [1/s] of (n + 2 nu k^2)^2 + w^2 = 4 nu^2 k^4 sqrt(1 + n / (nu k^2)), the root near n = i w."""
    if viscosity == 0.0:
        return 0.0
    shear = viscosity * K**2
    n = 1j * OMEGA
    for _ in range(100):
        n = -2.0 * shear + 1j * np.sqrt(OMEGA**2 - 4.0 * shear**2 * np.sqrt(1.0 + n / shear))
    return -float(n.real)


def measure(simulation: Simulation, promises: tuple[Promise, ...], viscosity: float) -> Finding:
    """The part of the velocity that is the wave's, over time."""
    start = state(simulation).position
    set_state(simulation, start, AMPLITUDE * flow(start))
    times, share = [], []
    for water in sampled(simulation, simulation.scene.duration, PERIOD / 60):
        mode = flow(np.minimum(water.position, [np.inf, 0.0, np.inf]))
        times.append(water.time)
        share.append(float((water.velocity * mode).sum() / (mode * mode).sum()) / AMPLITUDE)
    return compared(np.array(times), np.array(share), promises, viscosity)


def compared(times: np.ndarray, share: np.ndarray, promises: tuple[Promise, ...], viscosity: float) -> Finding:
    """Period and decay rate of a signal that should be cos(w t) exp(-2 nu k^2 t)."""
    period, rate = damped_cosine(times, share)
    expected, full = 2.0 * viscosity * K**2, viscous_rate(viscosity)
    effective = rate / (2.0 * K**2)
    per_period, wanted = exp(-rate * PERIOD), exp(-expected * PERIOD)
    numbers = (
        relative(period, PERIOD),
        relative(rate, full) if viscosity else (rate, 0.0, rate),
        relative(rate, expected) if viscosity else (rate, 0.0, rate),
        relative(per_period, wanted),
        (effective, viscosity, effective - viscosity),
    )
    exact = np.cos(OMEGA * times) * np.exp(-expected * times)
    return Finding(
        {promise.quantity: number for promise, number in zip(promises, numbers, strict=True)},
        [Curve("wave", times / PERIOD, share)],
        [Curve("linear theory", times / PERIOD, exact)],
        ("t / T", "velocity over its first amplitude"),
    )


def damped_cosine(times: np.ndarray, signal: np.ndarray) -> tuple[float, float]:
    """Period [s] and decay rate [1/s] of the a cos(w t + b) exp(-c t) nearest to a signal, from a period on."""
    from scipy.optimize import curve_fit

    def model(t: np.ndarray, a: float, b: float, omega: float, rate: float) -> np.ndarray:
        return a * np.cos(omega * t + b) * np.exp(-rate * t)

    # The first quarter of a period holds the sound of the start.
    settled = times > 0.25 * PERIOD
    (_, _, omega, rate), _ = curve_fit(model, times[settled], signal[settled], p0=(1.0, 0.0, OMEGA, 0.01))
    return 2.0 * pi / abs(omega), rate
