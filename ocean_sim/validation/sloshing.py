"""Water in a tank that sways: the first mode rings with its own period, next to the response to the motion.

Linear theory in the axes of the tank, in which the water starts at rest: for a sway A sin(w t) the first mode of the
potential, cos(pi x / L) cosh(pi (y + h) / L) with x from the left wall, is C (cos(w1 t) - cos(w t)), with C = 4 L /
pi^2 A w^3 / (w1^2 - w^2) and w1^2 = g k tanh(k h) (Faltinsen & Timokha 2009, Sloshing, chapter 5). The slow set-up is
series 5 of Bouscasse et al. (2013), shallow water in which a bore runs back and forth. Its time, though called seconds,
is in periods of the sway: the bores of the table are 0.99 apart, the period is 3.0 s. The table does not say where the
gauge was nor how the motion began, so crest and arrival are only reported.
"""

from math import cosh, pi, sqrt, tanh

import numpy as np

from ocean_sim.conventions import GRAVITY
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, relative
from ocean_sim.validation.shared.state import State, sampled
from ocean_sim.validation.shared.tables import table

LENGTH, DEPTH, SWAY = 1.0, 0.5, 0.01  # [m]
K = pi / LENGTH
OMEGA = sqrt(GRAVITY * K * tanh(K * DEPTH))  # first mode
PERIOD = 2.0 * pi / OMEGA  # 1.182 s
DRIVEN = OMEGA / 1.6  # [1/s], far from every mode
AMPLITUDE = 4.0 * LENGTH / pi**2 * SWAY * DRIVEN**3 / (OMEGA**2 - DRIVEN**2)  # C [m2/s] at the still surface
DISPERSION = "w1^2 = g k tanh(k h)"
PROMISES = (
    Promise("period of the first mode [s]", "%", f"{DISPERSION}; 1 %", {"delta_sph": 1.0}),
    Promise("share that rings freely, at the start", "%", "linear theory"),
    Promise("share that follows the tank", "%", "linear theory"),
)

SHALLOW = 0.03  # [m]
SHALLOW_OMEGA = 1.231 * sqrt(GRAVITY * K * tanh(K * SHALLOW))
SHALLOW_PERIOD = 2.0 * pi / SHALLOW_OMEGA
GAUGE = 0.05  # [m] from the left wall, assumed
SERIES = "Bouscasse et al. 2013, series 5, digitised"
SERIES_PROMISES = (
    Promise("series 5: crest at the gauge [m]", "%", SERIES),
    Promise("series 5: arrival of the bore [periods]", "% of a period", f"{SERIES}; its start is assumed"),
)


def problems(coarse: bool) -> list[Problem]:
    free = {
        "duration": 8.0 * PERIOD,
        "basin": {"length": LENGTH, "depth": DEPTH, "motion": sway(SWAY, DRIVEN)},
        "fluid": {"spacing": DEPTH / (10 if coarse else 25), "kinematic_viscosity": 1e-6},
    }
    series = {
        "duration": 11.0 * SHALLOW_PERIOD,
        "basin": {"length": LENGTH, "depth": SHALLOW, "motion": sway(2.333 * SHALLOW, SHALLOW_OMEGA)},
        "fluid": {"spacing": SHALLOW / (8 if coarse else 15), "kinematic_viscosity": 1e-6},
    }
    return [
        Problem(free, PROMISES, measure),
        Problem(series, SERIES_PROMISES, measure_series, name="series 5", slow=True),
    ]


def sway(amplitude: float, omega: float) -> dict[str, str | float]:
    """The motion of a tank that has its full speed at once, and the water with it."""
    return {"kind": "harmonic", "axis": "x", "amplitude": amplitude, "period": 2.0 * pi / omega, "ramp": 0.0}


def flow(position: np.ndarray) -> np.ndarray:
    """Velocity [m/s] of the first mode whose potential is 1 m2/s at the still surface; x from the middle."""
    x, y = position[:, 0] + LENGTH / 2, position[:, 1] + DEPTH
    along, up = -np.sin(K * x) * np.cosh(K * y), np.cos(K * x) * np.sinh(K * y)
    return K / cosh(K * DEPTH) * np.stack([along, up, np.zeros_like(x)], axis=1)


def share(water: State) -> float:
    """The first mode in the velocities, over the amplitude of linear theory."""
    mode = flow(np.minimum(water.position, [np.inf, 0.0, np.inf]))
    return float((water.velocity * mode).sum() / (mode * mode).sum()) / AMPLITUDE


def measure(simulation: Simulation) -> Finding:
    """The first mode over time."""
    seen = [(water.time, share(water)) for water in sampled(simulation, simulation.scene.duration, PERIOD / 40)]
    times, signal = np.array(seen).T
    return compared(times, signal)


def compared(times: np.ndarray, signal: np.ndarray) -> Finding:
    """A first mode that should be cos(w1 t) - cos(w t)."""
    from scipy.optimize import curve_fit

    def model(t: np.ndarray, a: float, b: float, omega: float, rate: float, c: float, d: float) -> np.ndarray:
        rings = (a * np.cos(omega * t) + b * np.sin(omega * t)) * np.exp(-rate * t)
        return rings + c * np.cos(DRIVEN * t) + d * np.sin(DRIVEN * t)

    (a, b, omega, _, c, d), _ = curve_fit(model, times, signal, p0=(1.0, 0.0, OMEGA, 0.01, -1.0, 0.0))
    numbers = (
        relative(2.0 * pi / abs(omega), PERIOD),
        relative(float(np.hypot(a, b)), 1.0),
        relative(float(np.hypot(c, d)), 1.0),
    )
    return Finding(
        {promise.quantity: number for promise, number in zip(PROMISES, numbers, strict=True)},
        [Curve("first mode", times, signal)],
        [Curve("linear theory", times, np.cos(OMEGA * times) - np.cos(DRIVEN * times))],
        ("time [s]", "first mode over its amplitude"),
    )


def measure_series(simulation: Simulation) -> Finding:
    """The elevation near the left wall over time."""
    gauge = np.array([[simulation.basin.lower[0] + GAUGE, 0.0]])
    seen = [
        (water.time, simulation.fluid.elevations(gauge)[0])
        for water in sampled(simulation, simulation.scene.duration, SHALLOW_PERIOD / 100)
    ]
    times, elevation = np.array(seen).T
    return compared_series(times / SHALLOW_PERIOD, elevation)


def arrival(times: np.ndarray, elevation: np.ndarray, level: float) -> float:
    """When the elevation first rises above a level; the last time where it does not."""
    above = np.flatnonzero((elevation[1:] > level) & (elevation[:-1] <= level))
    return float(times[1 + above[0]]) if above.size else float(times[-1])


def compared_series(times: np.ndarray, elevation: np.ndarray) -> Finding:
    """An elevation [m] over times [periods] against the measured one, where that was measured."""
    data = table("sloshing_bouscasse2013_series5")
    order = np.argsort(data["t_s"], kind="stable")
    known_times, known = data["t_s"][order], data["eta_m"][order]
    at = (times >= known_times[0]) & (times <= known_times[-1])
    level = 0.5 * float(known.max())
    came, expected = arrival(times[at], elevation[at], level), arrival(known_times, known, level)
    numbers = (
        relative(float(elevation[at].max()), float(known.max())),
        (came, expected, 100.0 * (came - expected)),
    )
    return Finding(
        {promise.quantity: number for promise, number in zip(SERIES_PROMISES, numbers, strict=True)},
        [Curve("gauge", times, elevation)],
        [Curve(SERIES, known_times, known, points=True)],
        ("time [periods]", "elevation [m]"),
    )
