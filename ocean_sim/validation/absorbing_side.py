"""How much of a piston's regular waves an absorbing side returns, against linear theory for its zone.

The zone is that which a side gets of which no more is said: one wavelength long. Incident and reflected waves are
separated by three gauges, when the waves have gone there and back. Measured under delta_sph: 1.2 % at a spacing of 1/80
of a wavelength, 1.3 % at 1/40; theory has 1.1 %. A zone whose rate is 2.5 sqrt(g / h) at the side and falls with the
square of the distance sends 2.0 % back at 1/80, in theory 2.1 %.
"""

from math import pi

import numpy as np

from ocean_sim import waves
from ocean_sim.conventions import GRAVITY
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared import flume
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise
from ocean_sim.validation.shared.reflection import reflected
from ocean_sim.waves import absorption

DEPTH, HEIGHT, PERIOD = 0.5, 0.03, 1.5  # [m], [m], [s]
K = float(waves.wavenumber(2.0 * pi / PERIOD, DEPTH))
WAVELENGTH = 2.0 * pi / K  # 2.827 m
LENGTH = 4.0 * WAVELENGTH
GAUGES = np.array([0.0, 0.35, 0.6])  # [m] from two wavelengths before the piston
BEGIN, EVERY = 16.0, 0.05  # [s]
PROMISES = (Promise("reflection", "%", "three gauges; 2 %, linear theory", {"delta_sph": 2.0}),)


def problems(coarse: bool) -> list[Problem]:
    spacing = WAVELENGTH / (40 if coarse else 80)
    scene = flume.scene(LENGTH, DEPTH, spacing, BEGIN + 8.0 * PERIOD, {"height": HEIGHT, "period": PERIOD})
    return [Problem(scene, PROMISES, measure, slow=not coarse)]


def theory() -> float:
    """What linear theory has the zone send back."""
    rate = absorption.damping_rate(K, DEPTH, GRAVITY, WAVELENGTH)
    return float(absorption.wave_reflection(np.array([2.0 * pi / PERIOD]), DEPTH, GRAVITY, WAVELENGTH, rate)[0])


def measure(simulation: Simulation) -> Finding:
    """Records of the gauges, once what comes back has come back."""
    points = np.stack([GAUGES, 0.0 * GAUGES], axis=1)
    time, found = flume.resampled(*flume.records(simulation, points, EVERY), BEGIN, EVERY)
    back = reflected(EVERY, found, GAUGES, DEPTH, (0.7 / PERIOD, 1.3 / PERIOD))
    return Finding(
        {PROMISES[0].quantity: (back, theory(), 100.0 * back)},
        [Curve(f"{x:g} m", time, column) for x, column in zip(GAUGES, found.T)],
        [],
        ("time [s]", "elevation [m]"),
    )
