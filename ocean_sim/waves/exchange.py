"""Seas as other programs keep them: `spectral-wave-data` (.swd) of plane waves, and elevations of OpenFAST (.Elev).

A .swd file of shape 6 (SpectralWaveData, format 100) holds linear waves A cos(omega t - k x + delta) by amplitude,
wavenumber, direction and phase, in single precision; its x-axis is heading 0 here, its y-axis heading 90.

OpenFAST reads a surface elevation (`WaveMod` 5, `WvKinFile`) as two columns, time [s] and elevation [m] at a place,
under lines that do not begin with a number; its rows are evenly spaced.
"""

import struct
from pathlib import Path

import numpy as np

from ocean_sim import waves
from ocean_sim.files import input_file
from ocean_sim.files.input_file import Unreadable

MAGIC, FORMAT, AIRY = 37.0221, 100, 6
BEGIN = struct.pack("<fi", MAGIC, FORMAT)
HEAD, SIZES, TAIL = struct.Struct("<fiii30s20si"), struct.Struct("<ffiifi"), struct.Struct("<if")
NAME = b"ocean-sim"


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
        raise Unreadable(path, "this is not a .swd file of format 100")
    try:
        _, _, shape, _, _, _, length = HEAD.unpack_from(data)
        if shape != AIRY:
            raise Unreadable(path, f"its waves are of shape {shape}; plane waves, shape {AIRY}, are read")
        at = HEAD.size + length + SIZES.size
        count, depth = TAIL.unpack_from(data, at)
        rows = np.frombuffer(data, "<f4", 4 * count, at + TAIL.size).reshape(count, 4).astype(float)
    except (struct.error, ValueError) as error:
        if isinstance(error, Unreadable):
            raise
        raise Unreadable(path, "this .swd file ends too early") from None
    amplitude, k, heading, phase = rows.T
    if not (np.isfinite(rows).all() and (k > 0.0).all()):
        raise Unreadable(path, "it has a value that is not a number, or a wavenumber that is not above 0")
    deep = depth if depth > 0.0 else 1e3 * 2.0 * np.pi / float(k.min())  # infinite where it is below 0
    wavevector = k[:, None] * np.stack([np.sin(heading), np.cos(heading)], axis=1)
    return waves.Components(amplitude, wavevector, -phase, deep, gravity)


def openfast(time: np.ndarray, elevation: np.ndarray, note: str = "") -> str:
    """A series of elevations (n,) [m] at (n,) even times [s] as the text of an .Elev file."""
    head = f"! Surface elevation by ocean-sim{': ' if note else ''}{note}\nTime WaveElev\n(s) (m)\n"
    return head + "".join(f"{t:.6f} {eta:.9e}\n" for t, eta in zip(time.tolist(), elevation.tolist()))


def of_openfast(path: str | Path) -> tuple[np.ndarray, np.ndarray]:
    """(n,) times [s] and (n,) elevations [m] of an .Elev file; raises Unreadable."""
    rows = [line.split()[:2] for line in input_file.text(path).splitlines() if line.strip()]
    first = next((k for k, row in enumerate(rows) if numeric(row[0])), len(rows))
    try:
        table = np.array([[float(cell) for cell in row] for row in rows[first:]])
    except ValueError:
        raise Unreadable(path, "a row under its head is not two numbers") from None
    if table.ndim != 2 or table.shape[1] != 2 or len(table) < 2:
        raise Unreadable(path, "it has no two rows of time and elevation")
    steps = np.diff(table[:, 0])
    if not (np.isfinite(table).all() and steps.min() > 0.0 and np.ptp(steps) < 0.01 * steps.mean()):
        raise Unreadable(path, "its times are not evenly spaced")
    return table[:, 0], table[:, 1]


def numeric(word: str) -> bool:
    """Whether a line that begins with it is a row, as OpenFAST sees it."""
    try:
        float(word)
    except ValueError:
        return False
    return True
