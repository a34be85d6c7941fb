"""A flume: a slice with a piston at one end and an absorbing side at the other, and records of gauges in it."""

from typing import Any

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.state import sampled


def scene(length: float, depth: float, spacing: float, duration: float, waves: dict[str, Any]) -> dict[str, Any]:
    """So long and deep [m], its particles so far apart [m], for a duration [s]; `waves` are keys of the wavemaker."""
    return {
        "duration": duration,
        "basin": {
            "length": length,
            "depth": depth,
            "walls": {"x_max": "absorbing"},
            "wavemaker": {"wall": "x_min", **waves},
        },
        "fluid": {"spacing": spacing, "kinematic_viscosity": 1e-6},
    }


def records(simulation: Simulation, points: np.ndarray, every: float) -> tuple[np.ndarray, np.ndarray]:
    """(n,) times [s], about so far apart [s], and (n, m) elevations [m] at (m, 2) points x, z [m]."""
    times, elevation = [], []
    for water in sampled(simulation, simulation.scene.duration, every):
        times.append(water.time)
        elevation.append(simulation.fluid.elevations(points))
    return np.array(times), np.array(elevation)


def resampled(times: np.ndarray, elevation: np.ndarray, begin: float, every: float) -> tuple[np.ndarray, np.ndarray]:
    """The same at even times from `begin` on [s]."""
    even = np.arange(begin, times[-1], every)
    return even, np.stack([np.interp(even, times, column) for column in elevation.T], axis=1)
