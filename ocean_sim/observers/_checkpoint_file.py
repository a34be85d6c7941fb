"""Checkpoint files: HDF5 behind a head of 512 bytes that holds the hash of all the rest.

The hash is compared before the file is read, so a torn or changed file is known before any library parses it. Inside,
`state`, `scene` and `made` are JSON, and `arrays` holds one data set a field or array, by its place in the simulation.
"""

import hashlib
import json
import os
import re
from collections.abc import Iterator
from errno import EIO
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

HEAD = 512  # bytes, the least that HDF5 leaves to others
MAGIC = "ocean-sim checkpoint 1"
LARGE = 4096  # numbers that are worth packing
PATTERN = "checkpoint_*.h5"


class Unreadable(Exception):
    """A file is not a whole checkpoint; the message says so."""


class Checkpoint(NamedTuple):
    """What a run needs to go on."""

    time: float  # [s]
    steps: int
    scene: dict[str, Any]  # as in manifest.json
    made: dict[str, str | None]  # versions and backend that made it
    tree: Any  # the state, see _state.py
    arrays: dict[str, np.ndarray]


def name(time: float) -> str:
    """Of the checkpoint at a time [s]."""
    return f"checkpoint_{time:013.6f}.h5"


def written(checkpoint: Checkpoint, folder: Path) -> Path:
    """The file of a checkpoint: it appears whole or not at all; raises OSError where there is no room for it."""
    import h5py

    beside, path = folder / ".checkpoint.tmp", folder / name(checkpoint.time)
    try:
        with h5py.File(beside, "w", userblock_size=HEAD) as file:
            file.attrs["time_s"], file.attrs["steps"] = checkpoint.time, checkpoint.steps
            for key in ("scene", "made", "tree"):
                file[key] = json.dumps(getattr(checkpoint, key))
            group = file.create_group("arrays")
            for place, array in checkpoint.arrays.items():
                packed = {"compression": "lzf", "shuffle": True} if array.size >= LARGE else {}
                group.create_dataset(place.lstrip("."), data=array, **packed)
        with beside.open("r+b") as file:
            file.seek(HEAD)
            digest = hashlib.file_digest(file, "sha256").hexdigest()
            file.seek(0)
            file.write(f"{MAGIC}\nsha256 {digest}\n".encode())
            file.flush()
            os.fsync(file.fileno())
        os.replace(beside, path)
    except OSError as error:  # HDF5 tells the number in its words
        number = error.errno or int((re.findall(r"errno = (\d+)", str(error)) or [EIO])[0])
        raise OSError(number, os.strerror(number), str(path)) from None
    finally:
        beside.unlink(missing_ok=True)
    return path


def read(path: Path) -> Checkpoint:
    """The checkpoint in a file; raises Unreadable."""
    import h5py

    try:
        data = path.read_bytes()
    except OSError as error:
        raise Unreadable(f"{path.name} cannot be read: {error.strerror}") from None
    digest = hashlib.sha256(data[HEAD:]).hexdigest()
    if data[:HEAD].rstrip(b"\0") != f"{MAGIC}\nsha256 {digest}\n".encode():
        raise Unreadable(f"{path.name} is damaged or no checkpoint: its content does not match its hash")
    with h5py.File(BytesIO(data), "r") as file:
        told = {key: json.loads(file[key][()]) for key in ("scene", "made", "tree")}
        arrays = {f".{place}": np.asarray(array[()]) for place, array in file["arrays"].items()}
        return Checkpoint(float(file.attrs["time_s"]), int(file.attrs["steps"]), **told, arrays=arrays)


def kept(folder: Path) -> Iterator[Path]:
    """The checkpoints of a run folder, newest first."""
    times = {}
    for path in folder.glob(PATTERN):
        try:
            times[path] = float(path.stem.removeprefix("checkpoint_"))
        except ValueError:
            continue
    return iter(sorted(times, key=lambda path: times[path], reverse=True))
