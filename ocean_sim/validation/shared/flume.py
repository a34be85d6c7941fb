"""A flume: a slice with a piston at one end and an absorbing side at the other, and records of gauges in it."""

from typing import Any

import numpy as np

from ocean_sim import waves
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.state import record_run

FREQUENCY_DENSITY = 1.25  # fitted frequencies over those of a record's length: waves enter and leave during it
MIN_FIT_SHARE = 1e-3  # regularisation: amplitude over the largest that the records could hold


def flume_scene(length: float, depth: float, spacing: float, duration: float, piston: dict[str, Any]) -> dict[str, Any]:
    """Scene of a flume: length, depth, spacing [m], duration [s]; `piston`: keys of its wavemaker but the wall."""
    maker = {"wall": "x_min", **piston}
    return {
        "duration": duration,
        "basin": {"length": length, "depth": depth, "walls": {"x_max": "absorbing"}, "wavemaker": maker},
        "fluid": {"spacing": spacing, "kinematic_viscosity": 1e-6},
    }


def gauge_records(simulation: Simulation, points: np.ndarray, every: float) -> tuple[np.ndarray, np.ndarray]:
    """Run to the end, with wave gauges at points (m, 2) x, z [m]. Return times (n,) [s], about `every` [s] apart, and
    elevations (n, m) [m]."""
    return record_run(simulation, every, lambda _: simulation.fluid.elevations(points))


def resample_evenly(
    times: np.ndarray, elevation: np.ndarray, begin: float, every: float
) -> tuple[np.ndarray, np.ndarray]:
    """Interpolate records `elevation` (n, m) at times (n,) [s] to even times (k,), `every` [s] from `begin` on; returns
    these times and records (k, m)."""
    even = np.arange(begin, times[-1], every)
    return even, np.stack([np.interp(even, times, column) for column in elevation.T], axis=1)


def reflection_ratio(
    every: float, elevation: np.ndarray, positions: np.ndarray, depth: float, band: tuple[float, float]
) -> float:
    """Ratio of reflected to incident wave height, from elevations (n, m) [m] at times `every` [s] apart and at
    `positions` (m,) [m] along the waves, in water `depth` [m] deep; `band`: lowest and highest frequency [Hz] used.

    Waves that run both ways and obey the dispersion relation are fitted to all records at once, by least squares in
    space and time (three gauges of Mansard & Funke 1980, ICCE, without their Fourier transform). Spectra of finite
    records differ by gauge, which looks like 2.5 % of reflection in 20 periods; the fit finds 0.2 % where none is.
    """
    n, m = elevation.shape
    time = every * np.arange(n)
    omega = 2.0 * np.pi * np.arange(*band, 1.0 / (FREQUENCY_DENSITY * time[-1]))
    k = waves.wavenumber(omega, depth)

    def wave_columns(x: np.ndarray, way: float) -> np.ndarray:
        """Columns (n m, 2 k) to fit: cos, sin of k waves at n times, positions x (m,) [m]; `way`: 1 to +x, -1 to -x."""
        angle = way * np.outer(x, k)[None] - np.outer(time, omega)[:, None]
        return np.concatenate([np.cos(angle), np.sin(angle)], axis=2).reshape(n * len(x), -1)

    ahead, astern = wave_columns(positions, 1.0), wave_columns(positions, -1.0)
    both = np.concatenate([ahead, astern], axis=1)
    products = both.T @ both + MIN_FIT_SHARE**2 * 0.5 * n * m * np.eye(both.shape[1])
    found = np.linalg.solve(products, both.T @ (elevation - elevation.mean(axis=0)).ravel())
    # Leave out the ends of the record, which are known from one side alone.
    middle, inner = np.array([positions.mean()]), slice(n // 12, -(n // 12))
    there = wave_columns(middle, 1.0) @ found[: ahead.shape[1]]
    back = wave_columns(middle, -1.0) @ found[ahead.shape[1] :]
    return float(back[inner].std() / there[inner].std())
