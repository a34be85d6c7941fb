"""Circulation about the vertical and white-cap cover of the water of a run, over time."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ocean_sim.waves.orbits import breaking_cover, circulation, falling

BAND = 2.0  # [spacings] width of the ring of particles on whose circle circulation is taken
SHORTEST = 4.0  # [points of the grid] waves that count: shorter ones are the particles themselves


class Frame(Protocol):
    """The water at one time."""

    time: float
    """[s]."""
    elevation: np.ndarray
    """(nx, nz) height of the surface at the points of a grid [m]."""
    position: np.ndarray | None
    """(n, 3) of particles [m]; None where they are not kept."""
    velocity: np.ndarray | None
    """(n, 3) of particles [m/s]; None where they are not kept."""
    origin: np.ndarray
    """(2,) x and z by which all these lie beside the grid [m]: a patch of open sea is kept around its ships."""


@dataclass(frozen=True)
class Grid:
    """The points at which frames hold the surface, and the basin around them."""

    x: np.ndarray
    """(nx,) [m]."""
    z: np.ndarray
    """(nz,) [m]; one in 2-D."""
    lower: np.ndarray
    """(3,) lowest corner of the basin [m]."""
    upper: np.ndarray
    """(3,) highest corner of the basin [m]."""
    depth: float
    """Of the still water [m]."""
    spacing: float
    """Of the particles [m]."""

    @property
    def is_slice(self) -> bool:
        """Whether the water is a vertical slice in x-y."""
        return len(self.z) == 1

    @property
    def intervals(self) -> tuple[float, float]:
        """Between points along x and z [m]; 1 where there is one point."""
        dx, dz = (float(points[1] - points[0]) if len(points) > 1 else 1.0 for points in (self.x, self.z))
        return dx, dz

    @property
    def shortest(self) -> float:
        """Wavelength [m] of the shortest waves that count."""
        dx, dz = self.intervals
        return SHORTEST * (dx if self.is_slice else max(dx, dz))

    @property
    def radius(self) -> float:
        """Of the circle along which circulation is taken [m]: a quarter of the narrower side of the basin."""
        return 0.25 * float(min((self.upper - self.lower)[[0, 2]]))

    @property
    def middle(self) -> tuple[float, float]:
        """Of the basin, in x and z [m]."""
        x, z = 0.5 * (self.upper + self.lower)[[0, 2]]
        return float(x), float(z)


@dataclass(frozen=True)
class SurfaceRecord:
    """Circulation and white-cap cover of each frame."""

    time: np.ndarray
    """(n,) [s]."""
    radius: float
    """Of the circle about the middle of the basin, or of a patch as it is kept around its ships [m]."""
    circulation: np.ndarray | None
    """(n,) [m2/s] closed integral of the velocity along that circle, by the right hand about the vertical: the mean
    velocity along it of the particles in a ring, over all depths, times its length. None in 2-D, or where frames
    keep no particles."""
    cover: np.ndarray
    """(n,) part of the surface where crests break: where it falls faster than 0.4 g by linear theory."""
    shortest: float
    """Wavelength of the shortest waves that `cover` counts [m]: four points of the frames apart."""

    def means(self) -> dict[str, float | None]:
        """Means over time, by name."""
        turn = None if self.circulation is None else float(self.circulation.mean())
        return {"circulation_m2_s": turn, "white_cap_cover": float(self.cover.mean())}


def surface_record(grid: Grid, frames: Iterable[Frame], begin: float) -> SurfaceRecord | None:
    """Of the frames from a time [s] on; None where there are none."""
    times, cover, turning = [], [], []
    for frame in frames:
        if frame.time >= begin:
            times.append(frame.time)
            cover.append(breaking_cover(falling(frame.elevation, *grid.intervals, grid.depth, grid.shortest)))
            turning.append(turn(grid, frame))
    if not times:
        return None
    known = bool(np.isfinite(turning).all())
    return SurfaceRecord(
        np.array(times), grid.radius, np.array(turning) if known else None, np.array(cover), grid.shortest
    )


def turn(grid: Grid, frame: Frame) -> float:
    """Circulation of the particles of a frame [m2/s]; not a number in 2-D, or where none are on the circle."""
    if grid.is_slice or frame.position is None or frame.velocity is None:
        return np.nan
    try:
        x, z = np.array(grid.middle) + frame.origin
        return circulation(frame.position, frame.velocity, grid.radius, BAND * grid.spacing, (x, z))
    except ValueError:
        return np.nan
