"""Incident and reflected waves apart, from the records of a few gauges along their way."""

import numpy as np

from ocean_sim import waves

DENSER = 1.25  # frequencies over those of a record's own length: waves that enter and leave it
SMALLEST = 1e-3  # of the largest part that the records could show


def reflected(
    every: float, elevation: np.ndarray, positions: np.ndarray, depth: float, band: tuple[float, float]
) -> float:
    """Height of the waves that return over that of those that come: records (n, m) at positions (m,) [m] along the
    waves, of a band of frequencies [Hz].

    Waves of the dispersion relation that run both ways are fitted to all records at once, by least squares in space and
    time (three gauges of Mansard & Funke 1980, ICCE, without their Fourier transform): the spectra of records that end
    differ from gauge to gauge, which looks like 2.5 % of reflection in 20 periods. This finds 0.2 % where none is.
    """
    n, m = elevation.shape
    time = every * np.arange(n)
    frequency = np.arange(*band, 1.0 / (DENSER * time[-1]))
    omega = 2.0 * np.pi * frequency
    k = waves.wavenumber(omega, depth)

    def running(x: np.ndarray, way: float) -> np.ndarray:
        """(n * len(x), 2 * frequencies) waves that run up the positions, or down."""
        angle = way * np.outer(x, k)[None] - np.outer(time, omega)[:, None]
        return np.concatenate([np.cos(angle), np.sin(angle)], axis=2).reshape(n * len(x), -1)

    ahead, astern = running(positions, 1.0), running(positions, -1.0)
    both = np.concatenate([ahead, astern], axis=1)
    products = both.T @ both + SMALLEST**2 * 0.5 * n * m * np.eye(both.shape[1])
    found = np.linalg.solve(products, both.T @ (elevation - elevation.mean(axis=0)).ravel())
    middle, inner = np.array([positions.mean()]), slice(n // 12, -(n // 12))  # ends are known from one side alone
    there = running(middle, 1.0) @ found[: ahead.shape[1]]
    back = running(middle, -1.0) @ found[ahead.shape[1] :]
    return float(back[inner].std() / there[inner].std())
