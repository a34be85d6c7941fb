"""Waves from a piston: their height over its stroke, one and two wavelengths away.

H/S = 2 (cosh 2kh - 1) / (sinh 2kh + 2kh) of Biesel & Suquet (1951), far from the wall and in linear theory: 1.082 in
water 0.5 m deep at a period of 1.5 s. The height is that of the first harmonic over whole periods, after the front of
the waves has gone by and before a reflection could arrive.
Behind the front waves are higher for a while, by 4 % at two wavelengths and 10 % at six when they are read; so what is
expected is linear theory of a piston that begins at rest (the steady part: Dean & Dalrymple 1991, chapter 6).

The absorbing zone begins so far off that what it returns, about 1 % of the height, is not back at the far gauge while
that is read: with the zone 1 m behind the gauge heights at two wavelengths were 2.4 % too low, at h / 20 and at h / 40.

Under `delta_sph`, at h / 20, where a wave is two spacings high, it is 0.9 % too low at one wavelength, 0.8 % at two and
2.1 % at six; crests are 0.2 % slow.

Under `mueller` there is no wave here: in water of 1e-6 m2/s its H/S is 3 to 6, and as large with the piston at rest
(6.5 and 2.4). That its density is summed with one kernel while its pressure acts along the gradient of another, so that
no energy belongs to the pressures, may be why the lattice boils once it gives way: in a still tank of 10 rows the
particles move at 0.1 m/s after 1 s, 2.7 after 3 s, as fast with steps a quarter as long (2.6) and nearly with a support
of 3.0 spacings (1.9). Viscosity of 1e-3 m2/s slows that (1.1 at 3 s); 1e-2 stops it, but damps the waves to H/S = 0.58
and 0.28.
"""

from math import pi

import numpy as np

from ocean_sim import waves
from ocean_sim.basin.motion import Piston
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared import flume
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, relative

DEPTH, HEIGHT, PERIOD = 0.5, 0.05, 1.5  # [m], [m], [s]
OMEGA = 2.0 * pi / PERIOD
K = float(waves.wavenumber(OMEGA, DEPTH))
WAVELENGTH = 2.0 * pi / K  # 2.827 m
GROUP_SPEED = float(waves.group_speed(K, DEPTH))  # [m/s]
TRANSFER = float(waves.piston_transfer(K * DEPTH))  # H/S
MEASURED = 2.0 * PERIOD  # [s]
RESOLVED, SHORTEST = 0.005, 40.0  # [1/m] step and end of the wavenumbers that a begun wave is made of
STEPS = 200  # a period, of the piston's motion
SOURCE = "linear theory of a piston that begins"


def problems(coarse: bool) -> list[Problem]:
    return [problem(2, 6.5, 2.0, coarse), problem(6, 15.5, 5.0, coarse, slow=True)]


def problem(far: int, begin: float, kept: float, coarse: bool, slow: bool = False) -> Problem:
    """A flume with gauges one and `far` wavelengths from the piston, read from `begin` on [s]; the height at the far
    one is right within `kept` [%]. What the absorbing zone, a wavelength long, returns is not back there at the end."""
    zone = 0.5 * (GROUP_SPEED * (begin + MEASURED) + far * WAVELENGTH)  # [m] how far off it begins
    waves_made = {"height": HEIGHT, "period": PERIOD}
    scene = flume.scene(zone + WAVELENGTH, DEPTH, DEPTH / (10 if coarse else 20), begin + MEASURED, waves_made)
    name = "" if far == 2 else f"{far} wavelengths: "
    promises = (
        Promise(f"{name}H/S at 1 wavelength", "%", SOURCE),
        Promise(f"{name}H/S at {far} wavelengths", "%", f"{SOURCE}; {kept:g} %", {"delta_sph": kept}),
        Promise(f"{name}H/S there, over that of steady waves", "%", "Biesel & Suquet 1951"),
        Promise(f"{name}speed of the crests [m/s]", "%", "w^2 = g k tanh(k h)"),
    )
    away = (1, far)

    def measure(simulation: Simulation) -> Finding:
        """The elevation at both gauges over time."""
        piston, distances = simulation.basin.piston, WAVELENGTH * np.array(away)
        assert piston is not None
        gauges = np.stack([simulation.basin.lower[0] + distances, np.zeros(2)], axis=1)
        times, elevation = flume.records(simulation, gauges, PERIOD / 40)
        return compared(times, elevation, begun(piston, distances, times), piston.stroke, promises, away)

    return Problem(scene, promises, measure, name.rstrip(": "), slow)


def begun(piston: Piston, distances: np.ndarray, times: np.ndarray) -> np.ndarray:
    """(n, m) elevations [m] of linear theory at times (n,) [s] and distances (m,) [m] from a piston that moves at u(t)
    from time 0 on: 2 / pi times the integral over k of cos(k s) tanh(k h) / k times that of u(t') cos(w (t - t')) over
    the time, w^2 = g k tanh(k h)."""
    k = RESOLVED * (np.arange(round(SHORTEST / RESOLVED)) + 0.5)
    shape = 2.0 / pi * RESOLVED * np.tanh(k * DEPTH) / k * np.cos(distances[:, None] * k)
    turning, time, found = 1j * waves.angular_frequency(k, DEPTH), 0.0, []
    moved = np.zeros(len(k), dtype=complex)  # integral of u(t') exp(i w (t - t'))
    for until in times:
        steps = max(1, round((until - time) * STEPS / PERIOD))
        leap = (until - time) / steps
        turn = np.exp(turning * leap)
        for _ in range(steps):
            moved = (moved + 0.5 * leap * piston.at(time)[1]) * turn + 0.5 * leap * piston.at(time + leap)[1]
            time += leap
        found.append(shape @ moved.real)
    return np.array(found)


def first_harmonic(times: np.ndarray, signal: np.ndarray) -> complex:
    """a of the Re(a exp(i w t)) nearest to a signal, in addition to a mean and a second harmonic."""
    angle = OMEGA * times
    parts = np.stack([np.cos(angle), -np.sin(angle), np.cos(2 * angle), np.sin(2 * angle), np.ones_like(angle)], axis=1)
    found = np.linalg.lstsq(parts, signal, rcond=None)[0]
    return complex(found[0], found[1])


def compared(
    times: np.ndarray,
    elevation: np.ndarray,
    theory: np.ndarray,
    stroke: float,
    promises: tuple[Promise, ...],
    away: tuple[int, int],
) -> Finding:
    """Elevations, a column a gauge, so many wavelengths from a piston that moves by S/2 sin(w t), against those of
    linear theory."""
    late = times >= times[-1] - MEASURED
    near, far = (first_harmonic(times[late], column[late]) for column in elevation.T)
    near_theory, far_theory = (first_harmonic(times[late], column[late]) for column in theory.T)
    apart = away[1] - away[0]  # [wavelengths]
    waves_between = apart - float(np.angle(far / near * near_theory / far_theory)) / (2.0 * pi)
    speed = apart * WAVELENGTH / (waves_between * PERIOD)
    numbers = (
        relative(2.0 * abs(near) / stroke, 2.0 * abs(near_theory) / stroke),
        relative(2.0 * abs(far) / stroke, 2.0 * abs(far_theory) / stroke),
        relative(2.0 * abs(far) / stroke, TRANSFER),
        relative(speed, WAVELENGTH / PERIOD),
    )
    return Finding(
        {promise.quantity: number for promise, number in zip(promises, numbers, strict=True)},
        [Curve(f"{n} wavelengths away", times, column) for n, column in zip(away, elevation.T)],
        [Curve(f"linear theory, {n}", times, column) for n, column in zip(away, theory.T)],
        ("time [s]", "elevation [m]"),
    )
