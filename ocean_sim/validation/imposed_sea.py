"""An imposed sea: random waves of a piston in a slice, at a gauge in the middle, against linear theory for the same
amplitudes and phases there; and what the absorbing side sends back.

The basin is four wavelengths of the peak long, the last of which absorbs. Incident and reflected waves are separated by
three gauges (Mansard & Funke 1980, by least squares). The spectrum ends at twice the peak frequency: shorter waves have
too few particles to travel.

The missing height is lost on the way to the middle, two wavelengths from the piston, and to the scheme itself: half of
it to the diffusion of density. Measured under delta_sph, at spacings over the peak's wavelength of
- 1/40: 4 sqrt m0 31 % short, 4 to 5.5 % reflected;
- 1/160: 4 sqrt m0 6.1 % short, T_m02 2.6 % long, since short waves are damped first, 4.0 % reflected;
- 1/200, the default: 4 sqrt m0 5.5 % short, past its limit of 5 %, T_m02 2.1 % long, 4.0 % reflected.
So the height misses its limit in the coarse set-up and, narrowly, in the default.
"""

from math import pi

import numpy as np

from ocean_sim import waves
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, relative
from ocean_sim.validation.shared.state import sampled
from ocean_sim.waves.record import measured

DEPTH, HEIGHT, PERIOD, SEED = 0.5, 0.04, 1.5, 3  # [m], [m], [s]
WAVELENGTH = 2.0 * pi / float(waves.wavenumber(2.0 * pi / PERIOD, DEPTH))  # 2.827 m
LENGTH = 4.0 * WAVELENGTH
GAUGES = np.array([0.0, 0.35, 0.6])  # [m] from the middle
BEGIN, EVERY = 20.0, 0.05  # [s]
SOURCE = "linear theory, same amplitudes and phases"
PROMISES = (
    Promise("4 sqrt m0 in the middle [m]", "%", f"{SOURCE}; 5 %", {"delta_sph": 5.0}),
    Promise("T_m02 in the middle [s]", "%", f"{SOURCE}; 5 %", {"delta_sph": 5.0}),
    Promise("H1/3 in the middle [m]", "%", SOURCE),
    Promise("reflection", "%", "three gauges, Mansard & Funke 1980; 5 %", {"delta_sph": 5.0}),
)


def problems(coarse: bool) -> list[Problem]:
    spectrum = {"significant_wave_height": HEIGHT, "peak_period": PERIOD, "seed": SEED, "cut_off": 2.0}
    scene = {
        "duration": BEGIN + (10.0 if coarse else 20.0) * PERIOD,
        "basin": {
            "length": LENGTH,
            "depth": DEPTH,
            "walls": {"x_max": "absorbing"},
            "wavemaker": {"wall": "x_min", "spectrum": spectrum},
        },
        "fluid": {"spacing": WAVELENGTH / (40 if coarse else 200), "kinematic_viscosity": 1e-6},
    }
    return [Problem(scene, PROMISES, measure, slow=not coarse)]


def reflected(every: float, elevation: np.ndarray, positions: np.ndarray, depth: float) -> float:
    """Reflection coefficient of the wave height: records (n, 3) at three positions (3,) [m] along the waves."""
    n = len(elevation)
    frequency = np.fft.rfftfreq(n, every)
    window = np.hanning(n)[:, None]
    parts = np.fft.rfft(window * (elevation - elevation.mean(axis=0)), axis=0)
    there, back = 0.0, 0.0
    for f, part in zip(frequency, parts):
        if 0.5 / PERIOD < f < 2.0 / PERIOD:
            k = float(waves.wavenumber(2.0 * pi * f, depth))
            both = np.exp(np.outer(positions, [-1j * k, 1j * k]))
            ahead, astern = np.linalg.lstsq(both, part, rcond=None)[0]
            there, back = there + abs(ahead) ** 2, back + abs(astern) ** 2
    return float((back / there) ** 0.5)


def measure(simulation: Simulation) -> Finding:
    """Records of the gauges, from when the shortest waves have arrived on."""
    points, times, rows = np.stack([GAUGES, 0.0 * GAUGES], axis=1), [], []
    for water in sampled(simulation, simulation.scene.duration, EVERY):
        times.append(water.time)
        rows.append(simulation.fluid.elevations(points))
    piston = simulation.basin.piston
    assert piston is not None
    away = points - [simulation.basin.lower[0], 0.0]
    time = np.arange(BEGIN, times[-1], EVERY)
    found = np.stack([np.interp(time, times, column) for column in np.array(rows).T], axis=1)
    theory = np.array([waves.elevation(piston.sea, away[:1], t)[0] for t in time])
    sea, wanted = measured(time, found[:, 0]), measured(time, theory)
    back = reflected(EVERY, found, GAUGES, DEPTH)
    pairs = ((sea.hm0_m, wanted.hm0_m), (sea.tm02_s, wanted.tm02_s), (sea.hs_m, wanted.hs_m))
    numbers = [relative(a, b) for a, b in pairs if a is not None and b is not None]
    numbers.append((back, 0.0, 100.0 * back))
    return Finding(
        {promise.quantity: number for promise, number in zip(PROMISES, numbers, strict=True)},
        [Curve("gauge in the middle", time, found[:, 0])],
        [Curve("linear theory", time, theory)],
        ("time [s]", "elevation [m]"),
    )
