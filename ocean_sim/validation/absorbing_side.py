"""Reflection of a piston's regular waves by an absorbing side, against linear theory for its zone.

The zone is the default one, one wavelength long. Three gauges separate incident and reflected waves, once the waves
have gone there and back.
"""

from math import pi

import numpy as np

from ocean_sim import waves
from ocean_sim.conventions import GRAVITY
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise
from ocean_sim.validation.shared.flume import flume_scene, gauge_records, reflection_ratio, resample_evenly
from ocean_sim.waves import absorption

DEPTH, HEIGHT, PERIOD = 0.5, 0.03, 1.5  # [m], [m], [s]
K = float(waves.wavenumber(2.0 * pi / PERIOD, DEPTH))
WAVELENGTH = 2.0 * pi / K  # 2.827 m
LENGTH = 4.0 * WAVELENGTH
GAUGE_POSITIONS = np.array([0.0, 0.35, 0.6])  # [m] from two wavelengths before the piston
RECORD_START, SAMPLE_INTERVAL = 16.0, 0.05  # [s]
PROMISES = (Promise("reflection", "%", "three gauges; 2 %, linear theory", {"delta_sph": 2.0}),)


def problems(coarse: bool) -> list[Problem]:
    spacing = WAVELENGTH / (40 if coarse else 80)
    scene = flume_scene(LENGTH, DEPTH, spacing, RECORD_START + 8.0 * PERIOD, {"height": HEIGHT, "period": PERIOD})
    return [Problem(scene, PROMISES, measure, slow=not coarse)]


def measure(simulation: Simulation) -> Finding:
    points = np.stack([GAUGE_POSITIONS, 0.0 * GAUGE_POSITIONS], axis=1)
    time, found = resample_evenly(*gauge_records(simulation, points, SAMPLE_INTERVAL), RECORD_START, SAMPLE_INTERVAL)
    back = reflection_ratio(SAMPLE_INTERVAL, found, GAUGE_POSITIONS, DEPTH, (0.7 / PERIOD, 1.3 / PERIOD))
    rate = absorption.damping_rate(K, DEPTH, GRAVITY, WAVELENGTH)
    theory = float(absorption.wave_reflection(np.array([2.0 * pi / PERIOD]), DEPTH, GRAVITY, WAVELENGTH, rate)[0])
    measured = [Curve(f"{x:g} m", time, column) for x, column in zip(GAUGE_POSITIONS, found.T)]
    return Finding([(back, theory, 100.0 * back)], measured, [], ("time [s]", "elevation [m]"))
