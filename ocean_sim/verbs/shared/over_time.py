"""What a run's frames say of its water as a whole over time: circulation about the vertical, and white-cap cover."""

import csv
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from ocean_sim.pictures.frame_files import Frame, frame_files
from ocean_sim.waves.orbits import BREAKING, breaking_cover, circulation, falling

BAND = 2.0  # [spacings] width of the ring of particles on whose circle circulation is taken
SHORTEST = 4.0  # [points of the grid] waves that count: shorter ones are the particles themselves


@dataclass(frozen=True)
class OverTime:
    """Circulation and white-cap cover of each frame."""

    time: np.ndarray
    """(n,) [s]."""
    radius: float
    """Of the circle about the middle of the basin [m]: a quarter of its narrower side."""
    circulation: np.ndarray | None
    """(n,) [m2/s] closed integral of the velocity along that circle, by the right hand about the vertical: the mean
    velocity along it of the particles in a ring, over all depths, times its length. None in a slice, or where frames
    keep no particles."""
    cover: np.ndarray
    """(n,) part of the surface where crests break: where it falls faster than 0.4 g by linear theory."""

    def told(self) -> dict[str, Any]:
        """Means over time."""
        turn = None if self.circulation is None else float(self.circulation.mean())
        return {"circulation_m2_s": turn, "white_cap_cover": float(self.cover.mean())}

    def sentence(self) -> str:
        """Means over time, for people."""
        cover = f"white caps on {100.0 * self.cover.mean():.3g} % of the surface in the mean, "
        said = f"{cover}{100.0 * self.cover.max():.3g} % at most: where it falls faster than {BREAKING:g} g"
        if self.circulation is None:
            return said
        turn = f"circulation about the vertical {self.circulation.mean():.3g} m2/s in the mean, "
        spread = f"standard deviation {self.circulation.std():.2g}, on a circle of {self.radius:.3g} m about the middle"
        return f"{turn}{spread}\n{said}"

    def write(self, path: Path) -> None:
        """A row a frame."""
        columns = {"time_s": self.time, "circulation_m2_s": self.circulation, "white_cap_cover": self.cover}
        given = {name: values for name, values in columns.items() if values is not None}
        with path.open("w", encoding="utf-8", newline="") as file:
            rows = csv.writer(file, lineterminator="\n")
            rows.writerow(given)
            rows.writerows([f"{value:.9g}" for value in row] for row in zip(*given.values()))


class Unreadable(ValueError):
    """Frames that cannot be read."""


def over_time(folder: Path, begin: float) -> OverTime | None:
    """Of the frames of a run from a time [s] on; None where it kept none. Raises Unreadable."""
    if not (folder / "frames" / "grid.npz").is_file():
        return None
    try:
        return read(folder, begin)
    except (OSError, ValueError, KeyError, IndexError, EOFError, BadZipFile):
        raise Unreadable(f"{folder / 'frames'}: cannot be read, so circulation and white caps are not told") from None


def read(folder: Path, begin: float) -> OverTime | None:
    """As `over_time`, with whatever a damaged file raises."""
    with np.load(folder / "frames" / "grid.npz") as grid:
        x, z, lower, upper = (grid[name] for name in ("x", "z", "lower", "upper"))
        depth, spacing = float(grid["depth"]), float(grid["spacing"])
    dx, dz = (float(a[1] - a[0]) if len(a) > 1 else 1.0 for a in (x, z))
    flat = len(z) == 1
    shortest = SHORTEST * (dx if flat else max(dx, dz))
    radius, middle = 0.25 * float(min((upper - lower)[[0, 2]])), 0.5 * (upper + lower)[[0, 2]]
    times, cover, turning = [], [], []
    for frame in map(Frame, frame_files(folder)):  # one at a time: a frame of a large run is large
        if frame.time >= begin:
            times.append(frame.time)
            cover.append(breaking_cover(falling(frame.elevation, dx, dz, depth, shortest)))
            turning.append(np.nan if flat else around(frame, radius, BAND * spacing, middle))
    if not times:
        return None
    known = bool(np.isfinite(turning).all())
    return OverTime(np.array(times), radius, np.array(turning) if known else None, np.array(cover))


def around(frame: Frame, radius: float, width: float, middle: np.ndarray) -> float:
    """Circulation of the particles of a frame [m2/s]; not a number where it has none on the circle."""
    if frame.position is None or frame.velocity is None:
        return np.nan
    try:
        return circulation(frame.position, frame.velocity, radius, width, (float(middle[0]), float(middle[1])))
    except ValueError:
        return np.nan
