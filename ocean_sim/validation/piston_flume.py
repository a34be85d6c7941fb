"""Waves from a piston: their height over its stroke, one and two wavelengths away.

H/S = 2 (cosh 2kh - 1) / (sinh 2kh + 2kh) of Biesel & Suquet (1951), far from the wall and in linear theory: 1.082 in
water 0.5 m deep at a period of 1.5 s. The height is that of the first harmonic over whole periods, after the front of
the waves has gone by and before a reflection could arrive.
Behind the front waves are higher for a while, by 4 % at two wavelengths and 10 % at six in the record; so the reference
is linear theory of a piston that begins at rest (the steady part: Dean & Dalrymple 1991, chapter 6).

The absorbing zone begins so far off that its reflection, about 1 % of the height, does not reach the far gauge within
the record.
"""

from math import pi

import numpy as np

from ocean_sim import waves
from ocean_sim.basin.motion import Piston
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, percent_error
from ocean_sim.validation.shared.flume import flume_scene, gauge_records

DEPTH, HEIGHT, PERIOD = 0.5, 0.05, 1.5  # [m], [m], [s]
OMEGA = 2.0 * pi / PERIOD
K = float(waves.wavenumber(OMEGA, DEPTH))
WAVELENGTH = 2.0 * pi / K  # 2.827 m
GROUP_SPEED = float(waves.group_speed(K, DEPTH))  # [m/s]
TRANSFER = float(waves.piston_transfer(K * DEPTH))  # H/S
RECORD_LENGTH = 2.0 * PERIOD  # [s]
WAVENUMBER_STEP, MAX_WAVENUMBER = 0.005, 40.0  # [1/m] of the transient of linear theory
PISTON_STEPS = 200  # in a period, of the piston's motion
SOURCE_TEXT = "linear theory of a piston that begins"


def problems(coarse: bool) -> list[Problem]:
    """Set-ups to run: flumes with the far gauge at 2 or 6 wavelengths, 20 (coarse: 10) particles over the depth."""
    return [flume_problem(2, 6.5, 2.0, coarse), flume_problem(6, 15.5, 5.0, coarse, slow=True)]


def flume_problem(far: int, begin: float, tolerance: float, coarse: bool, slow: bool = False) -> Problem:
    """Set-up of a flume with gauges 1 and `far` wavelengths from the piston, whose records count from `begin` [s] on.
    `tolerance` [%]: of the height at the far gauge; `coarse`: twice the spacing; `slow`: takes minutes."""
    zone = 0.5 * (GROUP_SPEED * (begin + RECORD_LENGTH) + far * WAVELENGTH)  # [m] from the piston to the zone
    waves_made = {"height": HEIGHT, "period": PERIOD}
    scene = flume_scene(zone + WAVELENGTH, DEPTH, DEPTH / (10 if coarse else 20), begin + RECORD_LENGTH, waves_made)
    name = "" if far == 2 else f"{far} wavelengths: "
    promises = (
        Promise(f"{name}H/S at 1 wavelength", "%", SOURCE_TEXT),
        Promise(f"{name}H/S at {far} wavelengths", "%", f"{SOURCE_TEXT}; {tolerance:g} %", {"delta_sph": tolerance}),
        Promise(f"{name}H/S there, over that of steady waves", "%", "Biesel & Suquet 1951"),
        Promise(f"{name}speed of the crests [m/s]", "%", "w^2 = g k tanh(k h)"),
    )
    away = (1, far)

    def measure(simulation: Simulation) -> Finding:
        piston, distances = simulation.basin.piston, WAVELENGTH * np.array(away)
        assert piston is not None
        gauges = np.stack([simulation.basin.lower[0] + distances, np.zeros(2)], axis=1)
        times, elevation = gauge_records(simulation, gauges, PERIOD / 40)
        theory = transient_elevation(piston, distances, times)
        return compare_harmonics(times, elevation, theory, 2.0 * piston.path.advance, away)

    return Problem(scene, promises, measure, name.rstrip(": "), slow)


def transient_elevation(piston: Piston, distances: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Elevations (n, m) [m] by linear theory at times t (n,) [s] and distances s (m,) [m] from a piston that starts at
    rest and moves at u(t): the integral over k > 0 of 2 / pi cos(k s) tanh(k h) / k times the integral over t' from 0
    to t of u(t') cos(w (t - t')), with w^2 = g k tanh(k h)."""
    k = WAVENUMBER_STEP * (np.arange(round(MAX_WAVENUMBER / WAVENUMBER_STEP)) + 0.5)
    shape = 2.0 / pi * WAVENUMBER_STEP * np.tanh(k * DEPTH) / k * np.cos(distances[:, None] * k)
    turning, time, found = 1j * waves.angular_frequency(k, DEPTH), 0.0, []
    moved = np.zeros(len(k), dtype=complex)  # integral of u(t') exp(i w (t - t'))
    for until in times:
        steps = max(1, round((until - time) * PISTON_STEPS / PERIOD))
        leap = (until - time) / steps
        turn = np.exp(turning * leap)
        for _ in range(steps):
            moved = (moved + 0.5 * leap * piston.at(time)[1]) * turn + 0.5 * leap * piston.at(time + leap)[1]
            time += leap
        found.append(shape @ moved.real)
    return np.array(found)


def first_harmonic(times: np.ndarray, signal: np.ndarray) -> complex:
    """Complex amplitude a of Re(a exp(i w t)), fitted with mean and second harmonic to a signal (n,) at times (n,) [s];
    w: OMEGA."""
    angle = OMEGA * times
    parts = np.stack([np.cos(angle), -np.sin(angle), np.cos(2 * angle), np.sin(2 * angle), np.ones_like(angle)], axis=1)
    found = np.linalg.lstsq(parts, signal, rcond=None)[0]
    return complex(found[0], found[1])


def compare_harmonics(
    times: np.ndarray, elevation: np.ndarray, theory: np.ndarray, stroke: float, away: tuple[int, int]
) -> Finding:
    """Compare elevations (n, 2) [m] of two gauges at times (n,) [s] with `theory` (n, 2) [m]; `stroke`: of the piston
    [m]; `away`: distances of the gauges from it [wavelengths]."""
    late = times >= times[-1] - RECORD_LENGTH
    near, far = (first_harmonic(times[late], column[late]) for column in elevation.T)
    near_theory, far_theory = (first_harmonic(times[late], column[late]) for column in theory.T)
    apart = away[1] - away[0]  # [wavelengths]
    waves_between = apart - float(np.angle(far / near * near_theory / far_theory)) / (2.0 * pi)
    numbers = (
        percent_error(2.0 * abs(near) / stroke, 2.0 * abs(near_theory) / stroke),
        percent_error(2.0 * abs(far) / stroke, 2.0 * abs(far_theory) / stroke),
        percent_error(2.0 * abs(far) / stroke, TRANSFER),
        percent_error(apart * WAVELENGTH / (waves_between * PERIOD), WAVELENGTH / PERIOD),
    )
    measured = [Curve(f"{n} wavelengths away", times, column) for n, column in zip(away, elevation.T)]
    expected = [Curve(f"linear theory, {n}", times, column) for n, column in zip(away, theory.T)]
    return Finding(numbers, measured, expected, ("time [s]", "elevation [m]"))
