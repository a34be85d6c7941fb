"""Growth of a wave under the pressure of a wind: its energy grows at the rate beta - 4 nu k^2.

Jeffreys's pressure, P times the slope, does work on the wave at the rate beta = P k w / (rho g) of its energy, exactly
in linear theory: P w / (rho c^2) on deep water. The damping of the scheme is that of the same water under still air,
whose decay gives the effective viscosity.
"""

from math import pi

import numpy as np

from ocean_sim import waves
from ocean_sim.conventions import AIR_DENSITY, GRAVITY, WATER_DENSITY
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, percent_error, reported
from ocean_sim.validation.shared.state import State, record_run
from ocean_sim.validation.wind_stress import WIND_SPEED, WU_STRESS, wind_keys, without_wind

WAVELENGTH, DEPTH, STEEPNESS, PERIODS = 1.0, 0.5, 0.06, 8  # [m], [m], ka at the start, periods
K = 2.0 * pi / WAVELENGTH
OMEGA = float(waves.angular_frequency(K, DEPTH))
PERIOD, CREST_SPEED = 2.0 * pi / OMEGA, OMEGA / K
PRESSURE_STRENGTH, SHELTERING = 0.02, 0.27  # P / (rho c^2); s of Jeffreys (1925)
PRESSURE = PRESSURE_STRENGTH * WATER_DENSITY * CREST_SPEED**2  # [Pa]
WIND_GAIN = PRESSURE / (SHELTERING * AIR_DENSITY * (WIND_SPEED - CREST_SPEED) ** 2)
GROWTH_RATE = PRESSURE * K * OMEGA / (WATER_DENSITY * GRAVITY)  # beta [1/s]
SOURCE_TEXT = "work of P times the slope in linear theory"
PROMISES = (
    Promise("growth rate of the energy, over beta - 4 nu_eff k^2 [1/s]", "%", SOURCE_TEXT, {"delta_sph": 4.0}),
    Promise("growth rate more than under still air, over beta [1/s]", "%", SOURCE_TEXT, {"delta_sph": 4.0}),
    Promise("still air: growth rate [1/s]", "1/s", "decay of the same wave"),
    Promise("effective viscosity [m2/s]", "m2/s", "decay of the same wave under still air over 4 k^2"),
    Promise("gain of the wind", "1", f"Jeffreys's pressure of {WIND_SPEED:g} m/s, s {SHELTERING}, times this"),
)


def problems(coarse: bool) -> list[Problem]:
    wave = {"kind": "regular_wave", "height": 2.0 * STEEPNESS / K, "period": PERIOD}
    scene = {
        "duration": PERIODS * PERIOD,
        "basin": {"length": WAVELENGTH, "depth": DEPTH, "walls": {"x": "periodic"}},
        "fluid": {"spacing": WAVELENGTH / (32 if coarse else 64), "kinematic_viscosity": 1e-6, "initial": wave},
        "wind": wind_keys(WIND_GAIN * WU_STRESS, sheltering=SHELTERING, wave_speed=CREST_SPEED),
    }
    return [Problem(scene, PROMISES, measure)]


def wave_amplitude(water: State) -> float:
    """Amplitude [m] of the wave that travels along +x, from the velocities of the water."""
    position, velocity = water.position, water.velocity
    c, s = waves.profiles(K, np.minimum(position[:, 1], 0.0), DEPTH)
    turn = np.exp(-1j * K * position[:, 0])
    half = np.sum((velocity[:, 0] * c + 1j * velocity[:, 1] * s) * turn) / np.sum(c * c + s * s)  # a cosine has two
    return 2.0 * float(abs(half)) * OMEGA / (GRAVITY * K)


def growth_rate(times: np.ndarray, sizes: np.ndarray) -> float:
    """Growth rate [1/s] of the wave's energy after the first period, from amplitudes `sizes` (n,) at times (n,) [s]."""
    later = times > PERIOD
    return 2.0 * float(np.polyfit(times[later], np.log(sizes[later]), 1)[0])


def measure(simulation: Simulation) -> Finding:
    """Run under the wind and under still air, and compare the growth rates of the wave with theory."""
    times, under_wind = record_run(simulation, PERIOD / 20, wave_amplitude)
    with without_wind(simulation) as without:
        _, under_still = record_run(without, PERIOD / 20, wave_amplitude)
    grown, calm = growth_rate(times, under_wind), growth_rate(times, under_still)
    rates = (percent_error(grown, GROWTH_RATE + calm), percent_error(grown - calm, GROWTH_RATE))
    numbers = (*rates, reported(calm), reported(-calm / (4.0 * K**2)), reported(WIND_GAIN))
    first = under_still[0]
    t = times / PERIOD
    measured = [Curve("wind", t, under_wind / first), Curve("still air", t, under_still / first)]
    expected = [Curve("beta - 4 nu_eff k^2", t, np.exp(0.5 * (GROWTH_RATE + calm) * times))]
    return Finding(numbers, measured, expected, ("t / T", "amplitude over its first"))
