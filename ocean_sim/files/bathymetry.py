"""Reader of heights of a sea bed on a regular grid: CSV, ESRI ASCII and netCDF files."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ocean_sim.files.csv_file import Table
from ocean_sim.files.input_file import Checked, Rule, Unreadable, open_netcdf, read_text

ESRI_ENDINGS, NETCDF_ENDINGS = (".asc", ".grd"), (".nc", ".cdf")
HIGHEST_GROUND = 9000.0  # [m] above which a height is none
METRE_UNITS = ("", "m", "meter", "meters", "metre", "metres")
EAST_PREFIXES = ("x", "e", "lon")  # how names of places along east begin
UNEVEN_SHARE = 1e-3  # of a step by which nodes may lie off a regular grid
GRID_RULE = Rule("heights [m], upwards from the still water, are finite and on a regular grid of two rows and columns")
METRES_RULE = Rule("places are in metres, in a projection, not in degrees; heights are in metres")
CHECKS = (Checked("Heights of a bed, `basin.floor.grid`: CSV, .asc or .nc", (GRID_RULE, METRES_RULE)),)


class Heights(NamedTuple):
    """Heights `y` (n, m) [m] of a sea bed on a regular grid x (n,), z (m,) [m]; NaN where one is missing."""

    x: np.ndarray
    z: np.ndarray
    y: np.ndarray

    def around(self, sides: Sequence[tuple[float, float]]) -> "Heights":
        """Part of the grid that covers a basin: the points between its `sides`, (lowest, highest) [m] along x and z,
        and the next point beyond each."""
        (i, k), (j, n) = (
            (max(np.searchsorted(nodes, low, "right") - 1, 0), np.searchsorted(nodes, up) + 1)
            for nodes, (low, up) in zip((self.x, self.z), sides)
        )
        return Heights(self.x[i:k], self.z[j:n], self.y[i:k, j:n])


def read_heights(path: str | Path, centre: Sequence[float]) -> Heights:
    """Heights of a bed in a file, with `centre` (2,) [m] as origin: a table with columns x_m, z_m, y_m, or a map (ESRI
    ASCII grid, netCDF 3), whose north becomes +z and whose east -x. Raises Unreadable."""
    ending = Path(path).suffix.lower()
    read = _read_esri if ending in ESRI_ENDINGS else _read_netcdf if ending in NETCDF_ENDINGS else _read_table
    x, z, y = read(path)
    x, z, y = x - centre[0], z - centre[1], np.where(np.abs(y) < HIGHEST_GROUND, y, np.nan)
    if is_map(path):
        x, y = -x[::-1], y[::-1]
    if min(y.shape, default=0) < 2:
        raise GRID_RULE.broken(path, f"it has {' x '.join(map(str, y.shape))} heights")
    for name, nodes in (("x", x), ("z", z)):
        steps = np.diff(nodes)
        if np.ptp(steps) > UNEVEN_SHARE * abs(steps.mean()):
            raise GRID_RULE.broken(path, f"its steps along {name} are {steps.min():g} to {steps.max():g} m")
    return Heights(x, z, y)


def is_map(path: str | Path) -> bool:
    """True if coordinates in this kind of file are east and north, not x and z."""
    return Path(path).suffix.lower() in (*ESRI_ENDINGS, *NETCDF_ENDINGS)


def _read_table(path: str | Path) -> Heights:
    """Heights in a table with a row for each grid point, in any order."""
    along, across, height = Table(path).finite("x_m", "z_m", "y_m")
    x, i = np.unique(along, return_inverse=True)
    z, j = np.unique(across, return_inverse=True)
    y = np.full((len(x), len(z)), np.nan)
    y[i, j] = height
    if (twice := y[i, j] != height).any():
        raise GRID_RULE.broken(path, f"x = {along[twice][0]:g}, z = {across[twice][0]:g} m has two heights")
    return Heights(x, z, y)


def _read_esri(path: str | Path) -> Heights:
    """Heights in an ESRI ASCII grid: rows from north to south; its header gives the corner or the centre of a cell."""
    words = ((word, k) for k, line in enumerate(read_text(path).splitlines(), 1) for word in line.split())
    head, numbers = dict[str, float](), list[float]()
    try:
        for word, k in words:
            if word[:1].isalpha() and not numbers:
                key, (word, k) = word.lower(), next(words, ("", k))
                head[key] = float(word)
            else:
                numbers.append(float(word))
    except ValueError:
        raise GRID_RULE.broken(path, f"line {k}: {word!r} is not a number") from None
    absent = [f"{axis}llcorner" for axis in "xy" if not {f"{axis}llcorner", f"{axis}llcenter"} & head.keys()]
    if absent := [*(name for name in ("ncols", "nrows", "cellsize") if name not in head), *absent]:
        raise GRID_RULE.broken(path, f"its head lacks {', '.join(absent)}")
    shape, size = (head["nrows"], head["ncols"]), head["cellsize"]
    if shape[0] * shape[1] != len(numbers) or any(count < 1.0 or count % 1.0 for count in shape):
        raise GRID_RULE.broken(path, f"it has {len(numbers)} heights, by its head {shape[0]:g} rows of {shape[1]:g}")
    rows, half = np.reshape(numbers, [int(count) for count in shape]), 0.5 * size
    first = [head.get(f"{axis}llcenter", head.get(f"{axis}llcorner", 0.0) + half) for axis in "xy"]
    rows[rows == head.get("nodata_value", -9999.0)] = np.nan
    x, z = (first[k] + size * np.arange(n) for k, n in enumerate(rows.shape[::-1]))
    return Heights(x, z, rows[::-1].T)


def _read_netcdf(path: str | Path) -> Heights:
    """Heights in a netCDF 3 file: its only variable of two dimensions, both of which have coordinate variables."""
    try:
        with open_netcdf(path) as file:
            (flat,) = [each for each in file.variables.values() if len(each.dimensions) == 2]
            names = sorted(flat.dimensions, key=lambda name: name.lower().startswith(EAST_PREFIXES))
            north, east = (file.variables[name] for name in names)
            told = [vars(each).items() for each in (east, north, flat)]
            traits = [{key: value.decode() for key, value in each if isinstance(value, bytes)} for each in told]
            x, z, y = (np.asarray(np.ma.filled(1.0 * each[:], np.nan), dtype=float) for each in (east, north, flat))
    except (KeyError, TypeError, ValueError, OSError) as error:
        if isinstance(error, Unreadable):
            raise
        raise GRID_RULE.broken(path, "it has no single variable of two dimensions with places along both") from None
    units = [each.get("units", "m") for each in traits]
    if not {unit.lower() for unit in units} <= set(METRE_UNITS):
        raise METRES_RULE.broken(path, f"its places and heights are in {', '.join(units)}")
    downwards = traits[2].get("positive") == "down" or "depth" in traits[2].get("standard_name", "")
    order = np.argsort(x), np.argsort(z)
    y = (y.T if names == list(flat.dimensions) else y) * (-1.0 if downwards else 1.0)
    return Heights(x[order[0]], z[order[1]], y[np.ix_(*order)])
