"""An imposed sea: random waves of a piston in 2-D, at a gauge two wavelengths away, against linear theory for the
same amplitudes and phases there; and the reflection of the absorbing side.

The basin is five wavelengths of the peak long, the last two of which absorb. Three gauges separate incident and
reflected waves. The spectrum ends at twice the peak frequency: shorter waves have too few particles to travel.

The height that is missing at the gauge is lost to the scheme itself on the way there.
"""

from math import pi

import numpy as np

from ocean_sim import waves
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, percent_error
from ocean_sim.validation.shared.flume import flume_scene, gauge_records, reflection_ratio, resample_evenly
from ocean_sim.waves.record import measure_record

DEPTH, HEIGHT, PERIOD, SEED = 0.5, 0.04, 1.5, 3  # [m], [m], [s]
WAVELENGTH = 2.0 * pi / float(waves.wavenumber(2.0 * pi / PERIOD, DEPTH))  # 2.827 m
LENGTH = 5.0 * WAVELENGTH
GAUGE_DISTANCE = 2.0 * WAVELENGTH  # [m] from the piston to the first gauge
GAUGE_POSITIONS = np.array([0.0, 0.35, 0.6])  # [m] from the first gauge
FREQUENCY_BAND = (0.5 / PERIOD, 2.0 / PERIOD)  # [Hz]
RECORD_START, SAMPLE_INTERVAL = 20.0, 0.05  # [s]
SOURCE_TEXT = "linear theory, same amplitudes and phases"
PROMISES = (
    Promise("4 sqrt m0 2 wavelengths away [m]", "%", f"{SOURCE_TEXT}; 5 %", {"delta_sph": 5.0}),
    Promise("T_m02 2 wavelengths away [s]", "%", f"{SOURCE_TEXT}; 5 %", {"delta_sph": 5.0}),
    Promise("H1/3 2 wavelengths away [m]", "%", SOURCE_TEXT),
    Promise("reflection", "%", "three gauges; 2 %", {"delta_sph": 2.0}),
)


def problems(coarse: bool) -> list[Problem]:
    spectrum = {"significant_wave_height": HEIGHT, "peak_period": PERIOD, "seed": SEED, "cut_off": 2.0}
    spacing = WAVELENGTH / (40 if coarse else 200)
    scene = flume_scene(LENGTH, DEPTH, spacing, RECORD_START + 20.0 * PERIOD, {"spectrum": spectrum})
    return [Problem(scene, PROMISES, measure, slow=not coarse)]


def measure(simulation: Simulation) -> Finding:
    away = np.stack([GAUGE_DISTANCE + GAUGE_POSITIONS, 0.0 * GAUGE_POSITIONS], axis=1)
    piston = simulation.basin.piston
    assert piston is not None and piston.path.sea is not None
    records = gauge_records(simulation, away + [simulation.basin.lower[0], 0.0], SAMPLE_INTERVAL)
    time, found = resample_evenly(*records, RECORD_START, SAMPLE_INTERVAL)
    theory = np.array([waves.elevation(piston.path.sea, away[:1], t)[0] for t in time])
    sea, wanted = measure_record(time, found[:, 0]), measure_record(time, theory)
    back = reflection_ratio(SAMPLE_INTERVAL, found, GAUGE_POSITIONS, DEPTH, FREQUENCY_BAND)
    pairs = ((sea.hm0_m, wanted.hm0_m), (sea.tm02_s, wanted.tm02_s), (sea.hs_m, wanted.hs_m))
    numbers = [percent_error(a, b) for a, b in pairs if a is not None and b is not None]
    numbers.append((back, 0.0, 100.0 * back))
    measured = [Curve("gauge 2 wavelengths away", time, found[:, 0])]
    return Finding(numbers, measured, [Curve("linear theory", time, theory)], ("time [s]", "elevation [m]"))
