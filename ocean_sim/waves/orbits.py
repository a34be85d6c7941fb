"""Motion of water under waves: orbits and drift of tagged particles, and over time the circulation about the vertical
and the cover of white caps.

Formulae of linear theory as in Dean & Dalrymple (1991), chapters 4 and 10.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Protocol

import numpy as np

from ocean_sim.files import csv_file

# [gravity] downward acceleration from which crests break (Snyder & Kennedy 1983, J. Phys. Oceanogr.).
BREAKING_ACCELERATION = 0.4
RING_SPACINGS = 2.0  # [spacings] width of the ring of particles on whose circle circulation is taken
MIN_WAVE_POINTS = 4.0  # [points of the grid] waves that count: shorter ones are the particles themselves


@dataclass(frozen=True)
class Orbit:
    """Size of a particle's orbit under waves, and its drift, over whole wave periods."""

    along_m: float  # half its length along the waves
    up_m: float  # half its height
    drift_m_s: float  # mean velocity along the waves

    @property
    def ratio(self) -> float:
        """Ratio of the vertical to the horizontal axis of the orbit: 1 in deep water, 0 at the bed."""
        return self.up_m / self.along_m


def fit_orbit(time: np.ndarray, path: np.ndarray, period: float, towards: tuple[float, float] = (1.0, 0.0)) -> Orbit:
    """Fit an orbit to a particle's path (n, 3) [m] at times (n,) [s], under waves of a period [s] along a unit vector
    `towards` (x, z): mean, drift and first harmonic. Raises ValueError for a path shorter than two periods."""
    if time[-1] - time[0] < 2.0 * period:
        raise ValueError(f"a path of {time[-1] - time[0]:g} s is shorter than two periods of {period:g} s")
    angle = 2.0 * np.pi * (time - time[0]) / period
    parts = np.stack([np.ones_like(angle), time - time[0], np.cos(angle), np.sin(angle)], axis=1)
    along = path[:, 0] * towards[0] + path[:, 2] * towards[1]
    found = np.linalg.lstsq(parts, np.stack([along, path[:, 1]], axis=1), rcond=None)[0]
    sizes = np.hypot(found[2], found[3])
    return Orbit(float(sizes[0]), float(sizes[1]), float(found[1, 0]))


def circulation(
    position: np.ndarray, velocity: np.ndarray, radius: float, width: float, centre: tuple[float, float] = (0.0, 0.0)
) -> float:
    """Circulation [m2/s] about the vertical axis through `centre` (x, z), by the right hand, from positions [m] and
    velocities [m/s] (n, 3) of particles in a ring of a radius and width [m]; raises ValueError if the ring is empty."""
    x, z = position[:, 0] - centre[0], position[:, 2] - centre[1]
    r = np.hypot(x, z)
    ring = np.abs(r - radius) <= 0.5 * width
    if not ring.any():
        raise ValueError(f"there are no particles {radius:g} m from the axis")
    around = (velocity[ring, 0] * z[ring] - velocity[ring, 2] * x[ring]) / np.maximum(r[ring], 1e-12)
    return 2.0 * np.pi * radius * float(around.mean())


def surface_fall(
    elevation: np.ndarray, spacing_x: float, spacing_z: float, depth: float = inf, shortest: float = 0.0
) -> np.ndarray:
    """Downward acceleration of the surface over gravity, (nx, nz), by linear theory from its `elevation` (nx, nz) [m]:
    each wave times k tanh(k depth). Points are spacing_x and spacing_z [m] apart, and the slope across the grid's sides
    is 0; waves shorter than `shortest` [m] are left out."""
    from scipy.fft import dctn, idctn

    nx, nz = elevation.shape
    kx = np.pi * np.arange(nx) / (nx * spacing_x)
    kz = np.pi * np.arange(nz) / (nz * spacing_z)
    k = np.hypot(kx[:, None], kz[None, :])
    kept = k * shortest <= 2.0 * np.pi * (1.0 + 1e-9)
    return idctn(dctn(elevation, type=2) * np.where(kept, k * np.tanh(k * min(depth, 1e9)), 0.0), type=2)


def breaking_cover(falling: np.ndarray) -> float:
    """Share of a surface where crests break: where `falling`, from `surface_fall`, exceeds BREAKING_ACCELERATION."""
    return float(np.mean(falling > BREAKING_ACCELERATION))


@dataclass(frozen=True)
class Motion:
    """Orbits of several tagged particles, and the decay of orbit size with depth."""

    level_m: np.ndarray  # (n,) mean height of each path over the still surface
    orbits: list[Orbit]  # their orbits, in the same order
    decay_per_m: float | None
    """Fall of the logarithm of the orbits' length per metre downwards; k on deep water. None: all at one level."""


def read_tracers(path: Path) -> tuple[list[int], np.ndarray, np.ndarray, np.ndarray]:
    """Numbers of the n particles of a tracers.csv, times (m,) [s], and their positions [m] and velocities [m/s], each
    (n, m, 3); raises OSError or ValueError if the file cannot be read or has no particles."""
    table = csv_file.Table(path)
    names = [int(column[1 : -len("_x_m")]) for column in table if column.endswith("_x_m")]
    if "time_s" not in table or not names:
        raise ValueError("has no column time_s, or no particle")
    positions = [np.stack([table[f"p{name}_{axis}_m"] for axis in "xyz"], axis=1) for name in names]
    velocities = [np.stack([table[f"p{name}_{axis}_m_s"] for axis in "uvw"], axis=1) for name in names]
    return names, table["time_s"], np.array(positions), np.array(velocities)


def wave_direction(positions: np.ndarray, velocities: np.ndarray) -> tuple[float, float]:
    """Unit vector (x, z) along which waves travel, from positions and velocities (n, m, 3) of water particles: the axis
    of the largest horizontal motion, in the sense of the motion of particles above their mean height."""
    level = velocities[..., [0, 2]] - velocities[..., [0, 2]].mean(axis=1, keepdims=True)
    flat = level.reshape(-1, 2)
    axis = np.linalg.eigh(flat.T @ flat)[1][:, -1]
    high = positions[..., 1] - positions[..., 1].mean(axis=1, keepdims=True)
    side = float(np.sum((level @ axis) * high))
    return (float(axis[0]), float(axis[1])) if side >= 0.0 else (-float(axis[0]), -float(axis[1]))


def tracer_motion(path: Path, begin: float, period: float) -> tuple[list[int], Motion]:
    """Numbers of the particles of a tracers.csv and their orbits over whole periods [s] of the waves from time `begin`
    [s] on; raises OSError, ValueError or IndexError if the file or the record (of two periods) does not suffice."""
    names, time, positions, velocities = read_tracers(path)
    kept = time >= begin
    time, paths = time[kept], positions[:, kept]
    along = wave_direction(paths, velocities[:, kept])
    whole = time <= time[0] + period * np.floor((time[-1] - time[0]) / period + 1e-6)
    level = paths[:, whole, 1].mean(axis=1)
    found = [fit_orbit(time[whole], path[whole], period, along) for path in paths]
    decay = None
    if np.ptp(level) > 1e-6:
        decay = float(np.polyfit(level, np.log([each.along_m for each in found]), 1)[0])
    return names, Motion(level, found, decay)


class Frame(Protocol):
    """Interface of one output frame: heights of the surface, and particles if the run stores them."""

    time: float  # [s]
    elevation: np.ndarray  # (nx, nz) height of the surface at the points of a grid [m]
    position: np.ndarray | None  # (n, 3) of particles [m]; None where they are not kept
    velocity: np.ndarray | None  # (n, 3) of particles [m/s]; None where they are not kept
    origin: np.ndarray
    """(2,) x and z by which all these lie beside the grid [m]: a patch of open sea is kept around its ships."""


@dataclass(frozen=True)
class Grid:
    """Points (x, z) [m] at which output frames hold the height of the surface, and the basin around them."""

    x: np.ndarray  # (nx,) [m]
    z: np.ndarray  # (nz,) [m]; one in 2-D
    lower: np.ndarray  # (3,) lowest corner of the basin [m]
    upper: np.ndarray  # (3,) highest corner of the basin [m]
    depth: float  # depth of the still water [m]
    spacing: float  # spacing of the particles [m]

    @property
    def is_slice(self) -> bool:
        """True for a 2-D run, a vertical slice in x-y."""
        return len(self.z) == 1

    @property
    def radius(self) -> float:
        """Radius [m] of the circle of which circulation is taken: a quarter of the narrower side of the basin."""
        return 0.25 * float(min((self.upper - self.lower)[[0, 2]]))


@dataclass(frozen=True)
class SurfaceRecord:
    """Time series of the water's circulation about a vertical axis and white-cap cover, one value per output frame."""

    time: np.ndarray  # (n,) [s]
    radius: float  # radius of the circle about the middle of the basin, or of a patch around its ships [m]
    circulation: np.ndarray | None
    """(n,) [m2/s] closed integral of the velocity along that circle, by the right hand about the vertical: the mean
    velocity along it of the particles in a ring, over all depths, times its length. None in 2-D, or where frames
    keep no particles."""
    cover: np.ndarray  # (n,) part of the surface where crests break: where it falls faster than 0.4 g by linear theory
    shortest: float  # wavelength of the shortest waves that `cover` counts [m]: four points of the frames apart

    def means(self) -> dict[str, float | None]:
        turn = None if self.circulation is None else float(self.circulation.mean())
        return {"circulation_m2_s": turn, "white_cap_cover": float(self.cover.mean())}


def surface_record(grid: Grid, frames: Iterable[Frame], begin: float) -> SurfaceRecord | None:
    """Circulation of the water about the vertical axis in the basin's middle, and white-cap cover, in all frames from
    time `begin` [s] on; None if there are no such frames."""
    dx, dz = (float(points[1] - points[0]) if len(points) > 1 else 1.0 for points in (grid.x, grid.z))
    shortest = MIN_WAVE_POINTS * (dx if grid.is_slice else max(dx, dz))
    times, cover, turning = [], [], []
    for frame in frames:
        if frame.time >= begin:
            times.append(frame.time)
            cover.append(breaking_cover(surface_fall(frame.elevation, dx, dz, grid.depth, shortest)))
            turning.append(frame_circulation(grid, frame))
    if not times:
        return None
    swirl = np.array(turning) if np.isfinite(turning).all() else None
    return SurfaceRecord(np.array(times), grid.radius, swirl, np.array(cover), shortest)


def frame_circulation(grid: Grid, frame: Frame) -> float:
    """Circulation [m2/s] of a frame's particles about the middle of the basin; NaN in 2-D or without particles."""
    if grid.is_slice or frame.position is None or frame.velocity is None:
        return np.nan
    try:
        x, z = 0.5 * (grid.upper + grid.lower)[[0, 2]] + frame.origin
        return circulation(frame.position, frame.velocity, grid.radius, RING_SPACINGS * grid.spacing, (x, z))
    except ValueError:
        return np.nan
