"""Steep waves on a tile of open sea at order 3.

A Stokes wave keeps its speed and energy for fifty periods; Fenton (1985, J. Waterway 111) has the speed to the fifth
order. Side-bands of a wave of steepness 0.1 grow as Benjamin & Feir found (1967, J. Fluid Mech. 27), at the rate of
Dysthe's equation (1979, Proc. R. Soc. A 369), which near this steepness agrees with experiments (Tulin & Waseda 1999,
J. Fluid Mech. 378): omega delta / sqrt(8) sqrt(s^2 (1 - delta) - delta^2 / 8) for side-bands at k (1 +- delta).
"""

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, relative
from ocean_sim.validation.shared.sea import SCHEMES, G, scene, sea_of, stokes

STEEPNESSES = {0.1: 0.1, 0.2: 0.3, 0.3: 1.0}  # and how much the speed may be wrong [%]
WAVES, PERIODS, STEPS = 2, 50, 60
CARRIERS, SIDE_BAND, GROWING = 7, 1e-3, 60  # waves on the tile, part of their height, periods
JUDGED = (25, 50)  # periods between which the growth is measured


def problems(coarse: bool) -> list[Problem]:
    return [running(), growing()]


def running() -> Problem:
    speeds = {
        s: Promise(f"speed of a wave of steepness {s:g} [m/s]", "%", "Fenton 1985", {"spectral_sea": most})
        for s, most in STEEPNESSES.items()
    }
    energies = {
        s: Promise(f"energy of a wave of steepness {s:g}, change", "%", "none is lost", {"spectral_sea": 0.1})
        for s in STEEPNESSES
    }

    def measure(simulation: Simulation) -> Finding:
        from ocean_sim.fluid.open_sea.high_order import HighOrder

        tile, found = sea_of(simulation).tile, {}
        k = 2.0 * np.pi * WAVES / tile.side
        for s in STEEPNESSES:
            eta, phi, speed = stokes(s, k, tile.nodes()[0][:, None])
            sea, dt = HighOrder(tile, 0.0), 2.0 * np.pi / (k * speed) / STEPS
            sea.begin(eta, phi)
            first, turns = sea.energy(), [np.angle(tile.to_modes(sea.eta)[WAVES, 0])]
            for _ in range(PERIODS * STEPS):
                sea.advance(dt)
                turns.append(np.angle(tile.to_modes(sea.eta)[WAVES, 0]))
            time = dt * np.arange(len(turns))
            found[speeds[s].quantity] = relative(-np.polyfit(time, np.unwrap(turns), 1)[0] / k, speed)
            change = 100.0 * (sea.energy() / first - 1.0)
            found[energies[s].quantity] = (change, 0.0, change)
        return Finding(found)

    promises = (*speeds.values(), *energies.values())
    return Problem(scene(100.0, 64, slice_=True), promises, measure, "Stokes", schemes=SCHEMES, only=True)


def growing() -> Problem:
    promise = Promise("growth of side-bands [1/s]", "%", "Dysthe 1979", {"spectral_sea": 10.0})

    def measure(simulation: Simulation) -> Finding:
        from ocean_sim.fluid.open_sea.high_order import HighOrder

        tile, s, delta = sea_of(simulation).tile, 0.1, 1.0 / CARRIERS
        k = 2.0 * np.pi * CARRIERS / tile.side
        x, omega = tile.nodes()[0][:, None], np.sqrt(G * k)
        eta, phi, _ = stokes(s, k, x)
        for n in (CARRIERS - 1, CARRIERS + 1):
            other, angle = n * k / CARRIERS, n * k / CARRIERS * x - 0.25 * np.pi
            a = SIDE_BAND * s / k
            eta = eta + a * np.cos(angle)
            phi = phi + a * np.sqrt(G / other) * np.sin(angle)
        sea, dt = HighOrder(tile, 0.0), 2.0 * np.pi / omega / STEPS
        sea.begin(eta, phi)
        size = []
        for _ in range(GROWING * STEPS):
            sea.advance(dt)
            e = np.abs(tile.to_modes(sea.eta)[:, 0])
            size.append(np.log(np.hypot(e[CARRIERS - 1], e[CARRIERS + 1])))
        time = dt * np.arange(1, len(size) + 1)
        of = slice(JUDGED[0] * STEPS, JUDGED[1] * STEPS)
        rate = float(np.polyfit(time[of], size[of], 1)[0])
        dysthe = omega * delta / np.sqrt(8.0) * np.sqrt(s**2 * (1.0 - delta) - delta**2 / 8.0)
        grown = np.array(size) - size[0]
        return Finding(
            {promise.quantity: relative(rate, float(dysthe))},
            [Curve("side-bands", time, grown)],
            [Curve("Dysthe 1979", time, dysthe * time)],
            ("t [s]", "logarithm of their growth"),
        )

    return Problem(scene(100.0, 256, slice_=True), (promise,), measure, "side-bands", schemes=SCHEMES, only=True)
