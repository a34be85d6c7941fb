"""Checkpoint files: HDF5 behind a header of 512 bytes with the hash of the rest.

The hash is compared before the file is read, so a torn or changed file is recognised before any library parses it.
Inside, `tree`, `scene` and `made` are JSON in bytes, since HDF5 keeps strings in a heap, and may never end reading a
damaged one; `arrays` holds one data set per field or array, by its path in the simulation.
"""

import hashlib
import json
import os
from collections.abc import Iterator
from contextlib import suppress
from io import BytesIO
from math import isfinite
from pathlib import Path
from sys import maxsize
from typing import Any, NamedTuple

import numpy as np

from ocean_sim.files import input_file
from ocean_sim.files.atomic_file import atomic_write
from ocean_sim.files.input_file import read_data_set

HEADER_BYTES = 512  # bytes, the least block that HDF5 leaves to its user
HEADER_LINE = "ocean-sim checkpoint 1"
COMPRESSION_MIN_SIZE = 4096  # numbers that are worth packing
MAX_COMPRESSION_RATIO = 300  # times that LZF makes anything smaller, less than that


class UnreadableCheckpoint(Exception):
    """Error: a file is no intact checkpoint; the message gives the reason."""


class Checkpoint(NamedTuple):
    """Content of a checkpoint file: state of a run at a time, with its scene and the versions that computed it."""

    time: float  # [s]
    steps: int
    scene: dict[str, Any]  # as in manifest.json
    made: dict[str, Any]  # versions, backend and sources that made it
    tree: Any  # the state, see walk.py
    arrays: dict[str, np.ndarray]


def checkpoint_name(time: float) -> str:
    return f"checkpoint_{time:013.6f}.h5"


def write_checkpoint(checkpoint: Checkpoint, folder: Path) -> Path:
    """Write a checkpoint into a folder atomically; returns its path. Raises OSError if the disk is full."""
    import h5py

    content = BytesIO()
    with h5py.File(content, "w", userblock_size=HEADER_BYTES) as file:
        file.attrs["time_s"], file.attrs["steps"] = checkpoint.time, checkpoint.steps
        for key in ("scene", "made", "tree"):
            file[key] = np.frombuffer(json.dumps(getattr(checkpoint, key)).encode(), np.uint8)
        group = file.create_group("arrays")
        for key, array in checkpoint.arrays.items():
            packed = {"compression": "lzf", "shuffle": True} if array.size >= COMPRESSION_MIN_SIZE else {}
            group.create_dataset(key.lstrip("."), data=array, **packed)
    data = content.getvalue()[HEADER_BYTES:]
    path = folder / checkpoint_name(checkpoint.time)
    with atomic_write(path) as draft, draft.open("wb") as file:
        file.write(file_header(data) + data)
        file.flush()
        os.fsync(file.fileno())
    return path


def file_header(data: bytes) -> bytes:
    """Header of 512 bytes for a checkpoint file with this data: name of the format, and SHA-256 of the data."""
    return f"{HEADER_LINE}\nsha256 {hashlib.sha256(data).hexdigest()}\n".encode().ljust(HEADER_BYTES, b"\0")


def read_checkpoint(path: Path) -> Checkpoint:
    """Content of a checkpoint file; raises UnreadableCheckpoint if it is damaged or holds no state of a run."""
    import h5py

    try:
        data = input_file.read_bytes(path, maxsize)
    except input_file.Unreadable as error:
        raise UnreadableCheckpoint(f"{path.name} cannot be read: {error.reason}") from None
    if data[:HEADER_BYTES] != file_header(data[HEADER_BYTES:]):
        raise UnreadableCheckpoint(f"{path.name} is damaged, or not a checkpoint: its content does not match its hash")
    try:
        with h5py.File(BytesIO(data), "r") as file:
            most = max(input_file.MAX_FILE_BYTES, MAX_COMPRESSION_RATIO * len(data))
            texts = {key: bytes(read_data_set(file, key, "u", most)) for key in ("scene", "made", "tree")}
            parts = {key: json.loads(text) for key, text in texts.items()}
            arrays = {f".{path}": read_data_set(file["arrays"], path, "biufc", most) for path in file["arrays"]}
            time, steps = float(file.attrs["time_s"]), int(file.attrs["steps"])
            mappings = all(isinstance(part, dict) for part in parts.values())
            if not (mappings and isfinite(time) and time >= 0.0 and steps >= 0):
                raise ValueError
            return Checkpoint(time, steps, **parts, arrays=arrays)
    except Exception:  # HDF5 has errors of its own
        raise UnreadableCheckpoint(f"{path.name} is whole, but holds no state of a run") from None


def time_of(path: Path) -> float:
    """Simulated time [s] in the name of a checkpoint file; raises ValueError if there is none."""
    return float(path.stem.removeprefix("checkpoint_"))


def checkpoint_files(folder: Path) -> Iterator[Path]:
    """Paths of the checkpoints in a run folder, newest first."""
    times = {}
    for path in folder.glob("checkpoint_*.h5"):
        with suppress(ValueError):
            times[path] = time_of(path)
    return iter(sorted(times, key=lambda path: times[path], reverse=True))
