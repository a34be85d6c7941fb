"""An imposed sea: random waves of a piston in 2-D, at a gauge two wavelengths away, against linear theory for the
same amplitudes and phases there; and what the absorbing side sends back.

The basin is five wavelengths of the peak long, the last two of which absorb. Incident and reflected waves are separated
by three gauges. The spectrum ends at twice the peak frequency: shorter waves have too few particles to travel.

What height is missing is lost on the way to the gauge, to the scheme itself: under delta_sph, at a spacing of 1/40 of
the peak's wavelength, 4 sqrt m0 is 5.0 % short, T_m02 3.9 % long, and 1.9 % comes back. At 1/80 it is 1.7 % short,
T_m02 0.2 % long, and 1.2 % comes back (1.1 to 1.4 % elsewhere in the basin, 1.2 to 2.3 % in half the record, with
another kernel), in linear theory 0.3 %.
A sea four times as high, 0.16 m on half a metre of water, breaks on its way: it is 20 % short at 1/40, 13 % at 1/80.
A zone of 1.5 wavelengths sends 1.4 to 2.5 % back at 1/60, in theory 0.5 %; one wavelength damped with 2.5 sqrt(g / h)
at the side and the square of the distance 2.8 to 3.8 %, in theory 2.7 %. What is more than the theory's may be bound
waves.
"""

from math import pi

import numpy as np

from ocean_sim import waves
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared import flume
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, relative
from ocean_sim.validation.shared.reflection import reflected
from ocean_sim.waves.record import measure_record

DEPTH, HEIGHT, PERIOD, SEED = 0.5, 0.04, 1.5, 3  # [m], [m], [s]
WAVELENGTH = 2.0 * pi / float(waves.wavenumber(2.0 * pi / PERIOD, DEPTH))  # 2.827 m
LENGTH = 5.0 * WAVELENGTH
AWAY = 2.0 * WAVELENGTH  # [m] from the piston
GAUGES = np.array([0.0, 0.35, 0.6])  # [m] beyond that
BAND = (0.5 / PERIOD, 2.0 / PERIOD)  # [Hz]
BEGIN, EVERY = 20.0, 0.05  # [s]
SOURCE = "linear theory, same amplitudes and phases"
PROMISES = (
    Promise("4 sqrt m0 2 wavelengths away [m]", "%", f"{SOURCE}; 5 %", {"delta_sph": 5.0}),
    Promise("T_m02 2 wavelengths away [s]", "%", f"{SOURCE}; 5 %", {"delta_sph": 5.0}),
    Promise("H1/3 2 wavelengths away [m]", "%", SOURCE),
    Promise("reflection", "%", "three gauges; 2 %", {"delta_sph": 2.0}),
)


def problems(coarse: bool) -> list[Problem]:
    spectrum = {"significant_wave_height": HEIGHT, "peak_period": PERIOD, "seed": SEED, "cut_off": 2.0}
    spacing = WAVELENGTH / (40 if coarse else 200)
    scene = flume.scene(LENGTH, DEPTH, spacing, BEGIN + 20.0 * PERIOD, {"spectrum": spectrum})
    return [Problem(scene, PROMISES, measure, slow=not coarse)]


def measure(simulation: Simulation) -> Finding:
    """Records of the gauges, from when the shortest waves have arrived on."""
    away = np.stack([AWAY + GAUGES, 0.0 * GAUGES], axis=1)
    piston = simulation.basin.piston
    assert piston is not None
    records = flume.records(simulation, away + [simulation.basin.lower[0], 0.0], EVERY)
    time, found = flume.resampled(*records, BEGIN, EVERY)
    theory = np.array([waves.elevation(piston.sea, away[:1], t)[0] for t in time])
    sea, wanted = measure_record(time, found[:, 0]), measure_record(time, theory)
    back = reflected(EVERY, found, GAUGES, DEPTH, BAND)
    pairs = ((sea.hm0_m, wanted.hm0_m), (sea.tm02_s, wanted.tm02_s), (sea.hs_m, wanted.hs_m))
    numbers = [relative(a, b) for a, b in pairs if a is not None and b is not None]
    numbers.append((back, 0.0, 100.0 * back))
    return Finding(
        {promise.quantity: number for promise, number in zip(PROMISES, numbers, strict=True)},
        [Curve("gauge 2 wavelengths away", time, found[:, 0])],
        [Curve("linear theory", time, theory)],
        ("time [s]", "elevation [m]"),
    )
