"""Seas exchanged with other programs: files of plane waves (`spectral-wave-data`, .swd) and of elevations (OpenFAST,
.Elev), and a wave field that other programs query.

A .swd file of shape 6 (SpectralWaveData, format 100) holds linear waves A cos(omega t - k x + delta) by amplitude,
wavenumber, direction and phase, in single precision; its x-axis is heading 0 here, its y-axis heading 90.

OpenFAST reads a surface elevation (`WaveMod` 5, `WvKinFile`) as two columns, time [s] and elevation [m] at a place,
under lines that do not begin with a number; its rows are evenly spaced.

The methods of `WaveField` are those of the wave fields of robot simulators: height and normal at points, the velocity
of the water, and a square of n x n heights that fits to itself on all sides, to be laid on any plane.
"""

import struct
from math import isfinite
from pathlib import Path

import numpy as np

from ocean_sim import waves
from ocean_sim.conventions import number, row_array, whole_number
from ocean_sim.files import csv_file, input_file
from ocean_sim.files.input_file import Rule, Unreadable

SWD_MAGIC, SWD_FORMAT, AIRY_SHAPE = 37.0221, 100, 6
SWD_BEGIN = struct.pack("<fi", SWD_MAGIC, SWD_FORMAT)
SWD_HEAD, SWD_SIZES, SWD_TAIL = struct.Struct("<fiii30s20si"), struct.Struct("<ffiifi"), struct.Struct("<if")
PROGRAM_NAME = b"ocean-sim"
SWD_RULE = Rule(
    f"a .swd file is of format {SWD_FORMAT} and has plane waves (shape {AIRY_SHAPE}) of finite numbers, "
    "wavenumbers above 0"
)
ELEV_RULE = Rule(
    "an .Elev file has two or more rows of time [s] and elevation [m], evenly spaced in time, under its head"
)
MIN_SQUARE_SIDE = 1e-6  # side of a square [m]


def to_swd(sea: waves.Components, note: str = "", date: str = "") -> bytes:
    """Content of a .swd file that holds a sea at its full height; `note`, `date`: texts stored in its head."""
    text = note.encode("ascii", "replace") or b"-"
    heading = np.arctan2(sea.wavevector[:, 0], sea.wavevector[:, 1])
    rows = np.stack([sea.amplitude, sea.wavenumber, heading, -sea.phase], axis=1).astype("<f4")
    names = PROGRAM_NAME.ljust(30), date.encode().ljust(20)
    head = SWD_HEAD.pack(SWD_MAGIC, SWD_FORMAT, AIRY_SHAPE, 1, *names, len(text))
    sizes = SWD_SIZES.pack(sea.gravity, 1.0, 0, 0, -1.0, 1) + SWD_TAIL.pack(len(rows), sea.depth)
    return head + text + sizes + rows.tobytes()


def of_swd(path: str | Path, gravity: float = waves.GRAVITY) -> waves.Components:
    """Read a sea from a .swd file of plane waves; raises Unreadable if it is faulty. `gravity`: of the sea [m/s2]."""
    data = input_file.read_bytes(path)
    if not data.startswith(SWD_BEGIN):
        raise SWD_RULE.broken(path, "it begins otherwise")
    try:
        _, _, shape, _, _, _, length = SWD_HEAD.unpack_from(data)
        if shape != AIRY_SHAPE:
            raise SWD_RULE.broken(path, f"its waves are of shape {shape}")
        at = SWD_HEAD.size + length + SWD_SIZES.size
        count, depth = SWD_TAIL.unpack_from(data, at)
        rows = np.frombuffer(data, "<f4", 4 * count, at + SWD_TAIL.size).reshape(count, 4).astype(float)
    except (struct.error, ValueError) as error:
        if isinstance(error, Unreadable):
            raise
        raise SWD_RULE.broken(path, "it ends too early") from None
    amplitude, k, heading, phase = rows.T
    if not (np.isfinite(rows).all() and (k > 0.0).all()):
        first = int(np.argmin(np.isfinite(rows).all(axis=1) & (k > 0.0)))
        raise SWD_RULE.broken(path, f"component {first + 1} is none")
    deep = depth if depth > 0.0 else 1e3 * 2.0 * np.pi / float(k.min())  # infinite where it is below 0
    wavevector = k[:, None] * np.stack([np.sin(heading), np.cos(heading)], axis=1)
    return waves.Components(amplitude, wavevector, -phase, deep, gravity)


def to_openfast(time: np.ndarray, elevation: np.ndarray, note: str = "") -> str:
    """Text of an .Elev file with elevations (n,) [m] at evenly spaced times (n,) [s]; `note`: added to its head."""
    head = f"! Surface elevation by ocean-sim{': ' if note else ''}{note}\nTime WaveElev\n(s) (m)\n"
    return head + "".join(f"{t:.6f} {eta:.9e}\n" for t, eta in zip(time.tolist(), elevation.tolist()))


def of_openfast(path: str | Path) -> tuple[np.ndarray, np.ndarray]:
    """Read times (n,) [s] and elevations (n,) [m] from an .Elev file; raises Unreadable if its rows are faulty."""
    lines = [line.split()[:2] for line in input_file.read_text(path).splitlines() if line.strip()]
    rows = lines[next((k for k, row in enumerate(lines) if isfinite(csv_file.parse_number(row[0]))), len(lines)) :]
    table = np.array([[csv_file.parse_number(word) for word in [*row, ""][:2]] for row in rows]).reshape(-1, 2)
    wrong = np.flatnonzero(~np.isfinite(table).all(axis=1))
    if len(wrong):
        raise ELEV_RULE.broken(path, f"row {wrong[0] + 1} is {' '.join(rows[wrong[0]])!r:.60}")
    if len(rows) < 2:
        raise ELEV_RULE.broken(path, f"it has {len(rows)}")
    steps = np.diff(table[:, 0])
    uneven = np.flatnonzero((steps <= 0.0) | (np.abs(steps - np.median(steps)) > 0.01 * np.median(steps)))
    if len(uneven):
        k, before = int(uneven[0]) + 1, table[uneven[0], 0]
        raise ELEV_RULE.broken(path, f"row {k + 1} has {table[k, 0]:.12g} s after {before:.12g} s")
    return table[:, 0], table[:, 1]


class WaveField:
    """Field of plane waves for other programs; x and z are horizontal, y is up, the still water is at y = 0 [m]."""

    def __init__(self, sea: waves.Components) -> None:
        self.sea = sea

    def elevation(self, points: np.ndarray, time: float) -> np.ndarray:
        """Heights (n,) of the water [m] at points x, z (n, 2) [m] and a time [s]."""
        return waves.elevation(self.sea, row_array("points", points, "x, z"), number("time", time, "s"))

    def normal(self, points: np.ndarray, time: float) -> np.ndarray:
        """Upward unit normals (n, 3) of the surface at points x, z (n, 2) [m] and a time [s]."""
        at, time = row_array("points", points, "x, z"), number("time", time, "s")
        slope = np.zeros((len(at), 2))
        for some, angle in self.sea.angles(at, time):
            steepness = self.sea.amplitude[some, None] * self.sea.wavevector[some]
            slope -= np.stack([waves.weighted_sum(steepness[:, axis], np.sin(angle)) for axis in (0, 1)], axis=1)
        slope *= self.sea.ramp_share(time)
        found = np.stack([-slope[:, 0], np.ones(len(at)), -slope[:, 1]], axis=1)
        return found / np.linalg.norm(found, axis=1, keepdims=True)

    def velocity(self, points: np.ndarray, time: float) -> np.ndarray:
        """Water velocities (n, 3) [m/s] at points x, y, z (n, 3) [m] and a time [s], by `waves.velocity`."""
        return waves.velocity(self.sea, row_array("points", points, "x, y, z"), number("time", time, "s"))

    def periodic(self, side: float) -> "WaveField":
        """Copy of this field with wavelengths that fit a square of this side [m], so that it can be tiled."""
        return WaveField(waves.fit_periods(self.sea, 2 * [number("side", side, "m", MIN_SQUARE_SIDE)]))

    def field(self, cells: int, side: float, time: float) -> np.ndarray:
        """Heights (cells, cells) [m], over x and z, at a time [s] on a square of `side` [m] from the origin on."""
        at = np.arange(whole_number("cells", cells)) * (number("side", side, "m", MIN_SQUARE_SIDE) / cells)
        x, z = np.meshgrid(at, at, indexing="ij")
        heights = self.periodic(side).elevation(np.stack([x.ravel(), z.ravel()], axis=1), time)
        return heights.reshape(cells, cells)
