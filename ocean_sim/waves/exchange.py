"""Seas as other programs keep them: `spectral-wave-data` (.swd) of plane waves, and elevations of OpenFAST (.Elev).

A .swd file of shape 6 (SpectralWaveData, format 100) holds linear waves A cos(omega t - k x + delta) by amplitude,
wavenumber, direction and phase, in single precision; its x-axis is heading 0 here, its y-axis heading 90.

OpenFAST reads a surface elevation (`WaveMod` 5, `WvKinFile`) as two columns, time [s] and elevation [m] at a place,
under lines that do not begin with a number; its rows are evenly spaced.
"""

import struct
from math import isfinite
from pathlib import Path

import numpy as np

from ocean_sim import waves
from ocean_sim.files import csv_file, input_file
from ocean_sim.files.input_file import Rule, Unreadable

MAGIC, FORMAT, AIRY = 37.0221, 100, 6
BEGIN = struct.pack("<fi", MAGIC, FORMAT)
HEAD, SIZES, TAIL = struct.Struct("<fiii30s20si"), struct.Struct("<ffiifi"), struct.Struct("<if")
NAME = b"ocean-sim"
SWD = Rule(
    f"a .swd file is of format {FORMAT} and has plane waves (shape {AIRY}) of finite numbers, wavenumbers above 0"
)
EVEN = Rule("an .Elev file has two or more rows of time [s] and elevation [m], evenly spaced in time, under its head")


def swd(sea: waves.Components, note: str = "", date: str = "") -> bytes:
    """A sea as the content of a .swd file; `note` is whatever text describes it. It has grown to its full height."""
    text = note.encode("ascii", "replace") or b"-"
    heading = np.arctan2(sea.wavevector[:, 0], sea.wavevector[:, 1])
    rows = np.stack([sea.amplitude, sea.wavenumber, heading, -sea.phase], axis=1).astype("<f4")
    head = HEAD.pack(MAGIC, FORMAT, AIRY, 1, NAME.ljust(30), date.encode().ljust(20), len(text))
    return head + text + SIZES.pack(sea.gravity, 1.0, 0, 0, -1.0, 1) + TAIL.pack(len(rows), sea.depth) + rows.tobytes()


def of_swd(path: str | Path, gravity: float = waves.GRAVITY) -> waves.Components:
    """The sea in a .swd file of plane waves; raises Unreadable."""
    data = input_file.content(path)
    if not data.startswith(BEGIN):
        raise SWD.broken(path, "it begins otherwise")
    try:
        _, _, shape, _, _, _, length = HEAD.unpack_from(data)
        if shape != AIRY:
            raise SWD.broken(path, f"its waves are of shape {shape}")
        at = HEAD.size + length + SIZES.size
        count, depth = TAIL.unpack_from(data, at)
        rows = np.frombuffer(data, "<f4", 4 * count, at + TAIL.size).reshape(count, 4).astype(float)
    except (struct.error, ValueError) as error:
        if isinstance(error, Unreadable):
            raise
        raise SWD.broken(path, "it ends too early") from None
    amplitude, k, heading, phase = rows.T
    if not (np.isfinite(rows).all() and (k > 0.0).all()):
        raise SWD.broken(path, f"component {int(np.argmin(np.isfinite(rows).all(axis=1) & (k > 0.0))) + 1} is none")
    deep = depth if depth > 0.0 else 1e3 * 2.0 * np.pi / float(k.min())  # infinite where it is below 0
    wavevector = k[:, None] * np.stack([np.sin(heading), np.cos(heading)], axis=1)
    return waves.Components(amplitude, wavevector, -phase, deep, gravity)


def openfast(time: np.ndarray, elevation: np.ndarray, note: str = "") -> str:
    """A series of elevations (n,) [m] at (n,) even times [s] as the text of an .Elev file."""
    head = f"! Surface elevation by ocean-sim{': ' if note else ''}{note}\nTime WaveElev\n(s) (m)\n"
    return head + "".join(f"{t:.6f} {eta:.9e}\n" for t, eta in zip(time.tolist(), elevation.tolist()))


def of_openfast(path: str | Path) -> tuple[np.ndarray, np.ndarray]:
    """(n,) times [s] and (n,) elevations [m] of an .Elev file; raises Unreadable."""
    lines = [line.split()[:2] for line in input_file.text(path).splitlines() if line.strip()]
    rows = lines[next((k for k, row in enumerate(lines) if isfinite(csv_file.number(row[0]))), len(lines)) :]
    table = np.array([[csv_file.number(word) for word in [*row, ""][:2]] for row in rows]).reshape(-1, 2)
    wrong = np.flatnonzero(~np.isfinite(table).all(axis=1))
    if len(wrong):
        raise EVEN.broken(path, f"row {wrong[0] + 1} is {' '.join(rows[wrong[0]])!r:.60}")
    if len(rows) < 2:
        raise EVEN.broken(path, f"it has {len(rows)}")
    steps = np.diff(table[:, 0])
    uneven = np.flatnonzero((steps <= 0.0) | (np.abs(steps - np.median(steps)) > 0.01 * np.median(steps)))
    if len(uneven):
        k, before = int(uneven[0]) + 1, table[uneven[0], 0]
        raise EVEN.broken(path, f"row {k + 1} has {table[k, 0]:.12g} s after {before:.12g} s")
    return table[:, 0], table[:, 1]
