"""Water in a tank that sways: the first mode rings with its own period, next to the response to the motion.

Linear theory in the axes of the tank, in which the water starts at rest: for a sway A sin(w t) the first mode of the
potential, cos(pi x / L) cosh(pi (y + h) / L) with x from the left wall, is C (cos(w1 t) - cos(w t)), with C = 4 L /
pi^2 A w^3 / (w1^2 - w^2) and w1^2 = g k tanh(k h) (Faltinsen & Timokha 2009, Sloshing, chapter 5). The slow set-up is
series 5 of Bouscasse et al. (2013), shallow water in which a bore runs back and forth. Its time, though called seconds,
is in periods of the sway: the bores of the table are 0.99 apart, the period is 3.0 s. The table names neither the
position of the gauge nor the start of the motion, so crest and arrival are only reported.
"""

from dataclasses import replace
from math import pi

import numpy as np

from ocean_sim.conventions import GRAVITY
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, percent_error
from ocean_sim.validation.shared.flume import gauge_records
from ocean_sim.validation.shared.state import record_run
from ocean_sim.validation.shared.tables import table
from ocean_sim.validation.standing_wave import StandingWave

LENGTH, DEPTH, SWAY = 1.0, 0.5, 0.01  # [m]
FREE_WAVE = StandingWave(LENGTH, DEPTH, mode=1, amplitude=1.0, gravity=GRAVITY)  # the first mode
OMEGA, PERIOD = FREE_WAVE.omega, FREE_WAVE.period  # [1/s], 1.182 s
SWAY_OMEGA = OMEGA / 1.6  # [1/s], far from every mode
# C [m2/s] at the still surface
POTENTIAL_AMPLITUDE = 4.0 * LENGTH / pi**2 * SWAY * SWAY_OMEGA**3 / (OMEGA**2 - SWAY_OMEGA**2)
FIRST_MODE = replace(FREE_WAVE, amplitude=POTENTIAL_AMPLITUDE * OMEGA / GRAVITY)
DISPERSION_SOURCE = "w1^2 = g k tanh(k h)"
PROMISES = (
    Promise("period of the first mode [s]", "%", f"{DISPERSION_SOURCE}; 1 %", {"delta_sph": 1.0}),
    Promise("share that rings freely, at the start", "%", "linear theory"),
    Promise("share that follows the tank", "%", "linear theory"),
)

SHALLOW_DEPTH = 0.03  # [m]
SHALLOW_OMEGA = 1.231 * replace(FREE_WAVE, depth=SHALLOW_DEPTH).omega
SHALLOW_PERIOD = 2.0 * pi / SHALLOW_OMEGA
GAUGE_DISTANCE = 0.05  # [m] from the left wall, assumed
SERIES_SOURCE = "Bouscasse et al. 2013, series 5, digitised"
SERIES_PROMISES = (
    Promise("series 5: crest at the gauge [m]", "%", SERIES_SOURCE),
    Promise("series 5: arrival of the bore [periods]", "% of a period", f"{SERIES_SOURCE}; its start is assumed"),
)


def problems(coarse: bool) -> list[Problem]:
    """Set-ups to run: a deep tank in sway and, slow, the shallow tank of series 5; coarse: with fewer particles."""
    free = {
        "duration": 8.0 * PERIOD,
        "basin": {"length": LENGTH, "depth": DEPTH, "motion": sway_motion(SWAY, SWAY_OMEGA)},
        "fluid": {"spacing": DEPTH / (10 if coarse else 25), "kinematic_viscosity": 1e-6},
    }
    bore_sway = sway_motion(2.333 * SHALLOW_DEPTH, SHALLOW_OMEGA)
    series = {
        "duration": 11.0 * SHALLOW_PERIOD,
        "basin": {"length": LENGTH, "depth": SHALLOW_DEPTH, "motion": bore_sway},
        "fluid": {"spacing": SHALLOW_DEPTH / (8 if coarse else 15), "kinematic_viscosity": 1e-6},
    }
    return [
        Problem(free, PROMISES, lambda run: compare_mode(*record_run(run, PERIOD / 40, FIRST_MODE.amplitude_share))),
        Problem(series, SERIES_PROMISES, measure_series, name="series 5", slow=True),
    ]


def sway_motion(amplitude: float, omega: float) -> dict[str, str | float]:
    """Basin keys that prescribe a sway A sin(w t), A = `amplitude` [m], w = `omega` [rad/s], from full speed on."""
    return {"kind": "harmonic", "axis": "x", "amplitude": amplitude, "period": 2.0 * pi / omega, "ramp": 0.0}


def compare_mode(times: np.ndarray, signal: np.ndarray) -> Finding:
    """Compare a signal (n,) of the first mode at times (n,) [s] with theory, by fits of free and forced oscillation."""
    from scipy.optimize import curve_fit

    def model(t: np.ndarray, a: float, b: float, omega: float, rate: float, c: float, d: float) -> np.ndarray:
        rings = (a * np.cos(omega * t) + b * np.sin(omega * t)) * np.exp(-rate * t)
        return rings + c * np.cos(SWAY_OMEGA * t) + d * np.sin(SWAY_OMEGA * t)

    (a, b, omega, _, c, d), _ = curve_fit(model, times, signal, p0=(1.0, 0.0, OMEGA, 0.01, -1.0, 0.0))
    numbers = (
        percent_error(2.0 * pi / abs(omega), PERIOD),
        percent_error(float(np.hypot(a, b)), 1.0),
        percent_error(float(np.hypot(c, d)), 1.0),
    )
    measured = [Curve("first mode", times, signal)]
    expected = [Curve("linear theory", times, np.cos(OMEGA * times) - np.cos(SWAY_OMEGA * times))]
    return Finding(numbers, measured, expected, ("time [s]", "first mode over its amplitude"))


def measure_series(simulation: Simulation) -> Finding:
    """Run the shallow tank, and compare crest and arrival near the left wall with those measured."""
    gauge = np.array([[simulation.basin.lower[0] + GAUGE_DISTANCE, 0.0]])
    times, elevation = gauge_records(simulation, gauge, SHALLOW_PERIOD / 100)
    times, elevation = times / SHALLOW_PERIOD, elevation[:, 0]
    data = table("sloshing_bouscasse2013_series5")
    order = np.argsort(data["t_s"], kind="stable")
    known_times, known = data["t_s"][order], data["eta_m"][order]
    at = (times >= known_times[0]) & (times <= known_times[-1])
    level = 0.5 * float(known.max())
    came, due = arrival_time(times[at], elevation[at], level), arrival_time(known_times, known, level)
    numbers = (percent_error(float(elevation[at].max()), float(known.max())), (came, due, 100.0 * (came - due)))
    expected = [Curve(SERIES_SOURCE, known_times, known, points=True)]
    return Finding(numbers, [Curve("gauge", times, elevation)], expected, ("time [periods]", "elevation [m]"))


def arrival_time(times: np.ndarray, elevation: np.ndarray, level: float) -> float:
    """Time, in the unit of `times`, at which an elevation (n,) first exceeds a level [m]; the last time if never."""
    above = np.flatnonzero((elevation[1:] > level) & (elevation[:-1] <= level))
    return float(times[1 + above[0]]) if above.size else float(times[-1])
