"""Packets as a page reads them: the other way round of `ocean_sim.viewer.protocol`."""

import json
import zlib
from typing import Any

import numpy as np

from ocean_sim.viewer.protocol import FULL_SCALE, PACKET_MAGIC


def unpack(data: bytes) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Header and arrays of a packet; raises ValueError."""
    if data[:1] == b"\x78":
        data = zlib.decompress(data)
    if data[:4] != PACKET_MAGIC:
        raise ValueError("this is not a packet")
    begin = 8 + int.from_bytes(data[4:8], "little")
    header = json.loads(data[8:begin])
    arrays = {}
    for row in header["arrays"]:
        dtype, shape = np.dtype(row["dtype"]), tuple(row["shape"])
        count = int(np.prod(shape))
        arrays[row["name"]] = np.frombuffer(data, dtype, count, begin).reshape(shape)
        begin += -(-count * dtype.itemsize // 4) * 4
    return header, arrays


def opened(whole: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """The positions [m] that whole numbers in a box stand for."""
    return 0.5 * (high + low) + 0.5 * (high - low) / FULL_SCALE * whole


def summed(planes: np.ndarray) -> np.ndarray:
    """The int16 (moments, n) that differences stand for."""
    step = (planes[0].astype(np.uint16) << 8) | planes[1]
    return np.cumsum(step, axis=0, dtype=np.uint16).astype(np.int16)
