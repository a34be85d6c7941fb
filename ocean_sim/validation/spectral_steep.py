"""Steep waves on a tile of open sea at order 3.

A Stokes wave keeps its speed and energy for fifty periods; Fenton (1985, J. Waterway 111) has the speed to the fifth
order. Side-bands of a wave of steepness 0.1 grow as Benjamin & Feir found (1967, J. Fluid Mech. 27), at the rate of
Dysthe's equation (1979, Proc. R. Soc. A 369), which near this steepness agrees with experiments (Tulin & Waseda 1999,
J. Fluid Mech. 378): omega delta / sqrt(8) sqrt(s^2 (1 - delta) - delta^2 / 8) for side-bands at k (1 +- delta).
"""

import numpy as np

from ocean_sim.conventions import GRAVITY
from ocean_sim.fluid.open_sea.high_order import HighOrder
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, absolute_error, percent_error
from ocean_sim.validation.shared.sea import SPECTRAL_SCHEMES, sea_of, stokes_wave, tile_scene

SPEED_TOLERANCES = {0.1: 0.1, 0.2: 0.3, 0.3: 1.0}  # [%] by steepness
WAVE_COUNT, PERIOD_COUNT, PERIOD_STEPS = 2, 50, 60  # waves on the tile, periods, steps in each
CARRIER_COUNT, SIDE_BAND_SHARE, GROWTH_PERIODS = 7, 1e-3, 60  # waves on the tile, share of their height, periods
JUDGED_PERIODS = (25, 50)  # start and end of the measured growth


def problems(coarse: bool) -> list[Problem]:
    return [stokes_problem(), side_band_problem()]


def stokes_problem() -> Problem:
    promises = [
        Promise(f"speed of a wave of steepness {s:g} [m/s]", "%", "Fenton 1985", {"spectral_sea": most})
        for s, most in SPEED_TOLERANCES.items()
    ]
    promises += [
        Promise(f"energy of a wave of steepness {s:g}, change", "%", "none is lost", {"spectral_sea": 0.1})
        for s in SPEED_TOLERANCES
    ]

    def measure(simulation: Simulation) -> Finding:
        tile, speeds, energies = sea_of(simulation).tile, [], []
        k = 2.0 * np.pi * WAVE_COUNT / tile.side
        for s in SPEED_TOLERANCES:
            eta, phi, speed = stokes_wave(s, k, tile.nodes()[0][:, None])
            sea, dt = HighOrder(tile, 0.0), 2.0 * np.pi / (k * speed) / PERIOD_STEPS
            sea.begin(eta, phi)
            first, turns = sea.energy(), [np.angle(tile.to_modes(sea.eta)[WAVE_COUNT, 0])]
            for _ in range(PERIOD_COUNT * PERIOD_STEPS):
                sea.advance(dt)
                turns.append(np.angle(tile.to_modes(sea.eta)[WAVE_COUNT, 0]))
            time = dt * np.arange(len(turns))
            speeds.append(percent_error(-np.polyfit(time, np.unwrap(turns), 1)[0] / k, speed))
            energies.append(absolute_error(100.0 * (sea.energy() / first - 1.0)))
        return Finding([*speeds, *energies])

    stokes_scene = tile_scene(100.0, 64, slice_=True)
    return Problem(stokes_scene, tuple(promises), measure, "Stokes", schemes=SPECTRAL_SCHEMES)


def side_band_problem() -> Problem:
    promise = Promise("growth of side-bands [1/s]", "%", "Dysthe 1979", {"spectral_sea": 10.0})

    def measure(simulation: Simulation) -> Finding:
        tile, s, delta = sea_of(simulation).tile, 0.1, 1.0 / CARRIER_COUNT
        k = 2.0 * np.pi * CARRIER_COUNT / tile.side
        x, omega = tile.nodes()[0][:, None], np.sqrt(GRAVITY * k)
        eta, phi, _ = stokes_wave(s, k, x)
        for n in (CARRIER_COUNT - 1, CARRIER_COUNT + 1):
            other, angle = n * k / CARRIER_COUNT, n * k / CARRIER_COUNT * x - 0.25 * np.pi
            a = SIDE_BAND_SHARE * s / k
            eta = eta + a * np.cos(angle)
            phi = phi + a * np.sqrt(GRAVITY / other) * np.sin(angle)
        sea, dt = HighOrder(tile, 0.0), 2.0 * np.pi / omega / PERIOD_STEPS
        sea.begin(eta, phi)
        size = []
        for _ in range(GROWTH_PERIODS * PERIOD_STEPS):
            sea.advance(dt)
            e = np.abs(tile.to_modes(sea.eta)[:, 0])
            size.append(np.log(np.hypot(e[CARRIER_COUNT - 1], e[CARRIER_COUNT + 1])))
        time = dt * np.arange(1, len(size) + 1)
        of = slice(JUDGED_PERIODS[0] * PERIOD_STEPS, JUDGED_PERIODS[1] * PERIOD_STEPS)
        dysthe = omega * delta / np.sqrt(8.0) * np.sqrt(s**2 * (1.0 - delta) - delta**2 / 8.0)
        numbers = [percent_error(float(np.polyfit(time[of], size[of], 1)[0]), float(dysthe))]
        measured = [Curve("side-bands", time, np.array(size) - size[0])]
        expected = [Curve("Dysthe 1979", time, dysthe * time)]
        return Finding(numbers, measured, expected, ("t [s]", "logarithm of their growth"))

    scene = tile_scene(100.0, 256, slice_=True)
    return Problem(scene, (promise,), measure, "side-bands", schemes=SPECTRAL_SCHEMES)
