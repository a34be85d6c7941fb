"""How water moves under waves: the orbits of tagged particles, the drift that they leave, circulation, white caps.

Formulae of linear theory as in Dean & Dalrymple (1991), chapters 4 and 10.
"""

from dataclasses import dataclass
from math import inf
from pathlib import Path

import numpy as np

from ocean_sim.conventions import GRAVITY
from ocean_sim.files import csv_file
from ocean_sim.waves import Values, angular_frequency

BREAKING = 0.4  # of gravity: downward acceleration from which crests break (Snyder & Kennedy 1983, J. Phys. Oceanogr.)


@dataclass(frozen=True)
class Orbit:
    """The path of a particle over whole periods, less its mean drift."""

    along_m: float
    """Half its length along the waves."""
    up_m: float
    """Half its height."""
    drift_m_s: float
    """Mean velocity along the waves."""

    @property
    def ratio(self) -> float:
        """Height over length: 1 on deep water, 0 on the bed."""
        return self.up_m / self.along_m


def orbit(time: np.ndarray, path: np.ndarray, period: float, towards: tuple[float, float] = (1.0, 0.0)) -> Orbit:
    """The orbit of a path (n, 3) [m] at times (n,) [s], under waves of a period [s] that go along a unit vector in x
    and z: the first harmonic next to a mean and a drift. Raises ValueError where it is shorter than two periods."""
    if time[-1] - time[0] < 2.0 * period:
        raise ValueError(f"a path of {time[-1] - time[0]:g} s is shorter than two periods of {period:g} s")
    angle = 2.0 * np.pi * (time - time[0]) / period
    parts = np.stack([np.ones_like(angle), time - time[0], np.cos(angle), np.sin(angle)], axis=1)
    along = path[:, 0] * towards[0] + path[:, 2] * towards[1]
    found = np.linalg.lstsq(parts, np.stack([along, path[:, 1]], axis=1), rcond=None)[0]
    sizes = np.hypot(found[2], found[3])
    return Orbit(float(sizes[0]), float(sizes[1]), float(found[1, 0]))


def orbit_ratio(k: float, y: Values, depth: float) -> np.ndarray:
    """Height over length of the orbits at a level y [m] below the still surface, on water of this depth [m]."""
    return np.tanh(k * (np.asarray(y) + depth))


def orbit_sizes(amplitude: float, k: float, y: Values, depth: float) -> tuple[np.ndarray, np.ndarray]:
    """Half length and half height [m] of the orbits under a wave of this amplitude [m]: they fall with depth."""
    above = k * (np.asarray(y) + depth)
    return amplitude * np.cosh(above) / np.sinh(k * depth), amplitude * np.sinh(above) / np.sinh(k * depth)


def stokes_drift(amplitude: float, k: float, y: Values, depth: float, gravity: float = GRAVITY) -> np.ndarray:
    """Mean velocity [m/s] of the particles along the waves (Stokes 1847): a^2 w k cosh 2k(y+h) / (2 sinh^2 kh)."""
    above, omega = k * (np.asarray(y) + depth), angular_frequency(k, depth, gravity)
    return amplitude**2 * omega * k * np.cosh(2.0 * above) / (2.0 * np.sinh(k * depth) ** 2)


def circulation(
    position: np.ndarray, velocity: np.ndarray, radius: float, width: float, centre: tuple[float, float] = (0.0, 0.0)
) -> float:
    """Circulation [m2/s] by the right hand about the vertical through centre (x, z) of the particles (n, 3) whose
    distance from it is within half a width of a radius [m]; raises ValueError where there are none."""
    x, z = position[:, 0] - centre[0], position[:, 2] - centre[1]
    r = np.hypot(x, z)
    ring = np.abs(r - radius) <= 0.5 * width
    if not ring.any():
        raise ValueError(f"there are no particles {radius:g} m from the axis")
    around = (velocity[ring, 0] * z[ring] - velocity[ring, 2] * x[ring]) / np.maximum(r[ring], 1e-12)
    return 2.0 * np.pi * radius * float(around.mean())


def falling(
    elevation: np.ndarray, spacing_x: float, spacing_z: float, depth: float = inf, shortest: float = 0.0
) -> np.ndarray:
    """(nx, nz) downward acceleration of a surface over gravity by linear theory: each wave in it times k tanh(k depth).

    On deep water it is also how far the water is drawn together. Waves stand level at the sides of the grid of points
    spacing_x and spacing_z [m] apart; those shorter than `shortest` [m] are left out.
    """
    from scipy.fft import dctn, idctn

    nx, nz = elevation.shape
    kx = np.pi * np.arange(nx) / (nx * spacing_x)
    kz = np.pi * np.arange(nz) / (nz * spacing_z)
    k = np.hypot(kx[:, None], kz[None, :])
    kept = k * shortest <= 2.0 * np.pi * (1.0 + 1e-9)
    return idctn(dctn(elevation, type=2) * np.where(kept, k * np.tanh(k * min(depth, 1e9)), 0.0), type=2)


def breaking_cover(falling: np.ndarray) -> float:
    """Part of a surface that falls by more than BREAKING times gravity: where its crests break."""
    return float(np.mean(falling > BREAKING))


def white_cap_cover(speed: np.ndarray, crest_speed: float, share: float = 0.85) -> float:
    """Part of the surface whose water runs with the crests: speeds along the waves (n,) [m/s] at points spread evenly,
    above a share of the crest speed [m/s] (Barthelemy et al. 2018, J. Fluid Mech. 841: waves break from 0.85 on)."""
    return float(np.mean(np.asarray(speed) > share * crest_speed))


def white_caps_of(u10: float) -> float:
    """Part of the sea that is white under a wind [m/s]: 3.84e-6 U^3.41 (Monahan & O'Muircheartaigh 1980)."""
    return 3.84e-6 * u10**3.41


@dataclass(frozen=True)
class Motion:
    """The orbits of tagged particles."""

    level_m: np.ndarray
    """(n,) mean height of each path over the still surface."""
    orbits: list[Orbit]
    """Their orbits, in the same order."""
    decay_per_m: float | None
    """Fall of the logarithm of the orbits' length per metre downwards; k on deep water. None: all at one level."""


def motion(time: np.ndarray, paths: np.ndarray, period: float, towards: tuple[float, float] = (1.0, 0.0)) -> Motion:
    """Orbits of paths (n, m, 3) [m] at times (m,) [s] under waves of a period [s], over the whole periods that the
    record holds; raises ValueError where it is shorter than two."""
    whole = time <= time[0] + period * np.floor((time[-1] - time[0]) / period + 1e-6)
    level = paths[:, whole, 1].mean(axis=1)
    found = [orbit(time[whole], path[whole], period, towards) for path in paths]
    decay = None
    if np.ptp(level) > 1e-6:
        decay = float(np.polyfit(level, np.log([each.along_m for each in found]), 1)[0])
    return Motion(level, found, decay)


def read_tracers(path: Path) -> tuple[list[int], np.ndarray, np.ndarray, np.ndarray]:
    """Numbers of the n particles of a tracers.csv, times (m,) [s], and their positions [m] and velocities [m/s], each
    (n, m, 3); raises OSError or ValueError."""
    table = csv_file.Table(path)
    names = [int(column[1 : -len("_x_m")]) for column in table if column.endswith("_x_m")]
    if "time_s" not in table or not names:
        raise ValueError("has no column time_s, or no particle")
    positions = [np.stack([table[f"p{name}_{axis}_m"] for axis in "xyz"], axis=1) for name in names]
    velocities = [np.stack([table[f"p{name}_{axis}_m_s"] for axis in "uvw"], axis=1) for name in names]
    return names, table["time_s"], np.array(positions), np.array(velocities)


def towards(positions: np.ndarray, velocities: np.ndarray) -> tuple[float, float]:
    """Unit vector in x and z of where waves go to, by the water in them, (n, m, 3) each: the axis along which it moves
    most, to the side to which it goes when it is high."""
    level = velocities[..., [0, 2]] - velocities[..., [0, 2]].mean(axis=1, keepdims=True)
    flat = level.reshape(-1, 2)
    axis = np.linalg.eigh(flat.T @ flat)[1][:, -1]
    high = positions[..., 1] - positions[..., 1].mean(axis=1, keepdims=True)
    side = float(np.sum((level @ axis) * high))
    return (float(axis[0]), float(axis[1])) if side >= 0.0 else (-float(axis[0]), -float(axis[1]))


def tracer_motion(path: Path, begin: float, period: float) -> tuple[list[int], Motion]:
    """Numbers and orbits of the particles of a tracers.csv from a time [s] on, under waves of a period [s]; raises
    OSError, ValueError or IndexError."""
    names, time, positions, velocities = read_tracers(path)
    kept = time >= begin
    along = towards(positions[:, kept], velocities[:, kept])
    return names, motion(time[kept], positions[:, kept], period, along)
