"""Arrays that are slow to make, kept in the user's cache by the content they were made of."""

import hashlib
import os
from collections.abc import Callable

import numpy as np

from ocean_sim.files import input_file
from ocean_sim.machine import cache_directory


def kept(folder: str, content: bytes, made: Callable[[], dict[str, np.ndarray]]) -> dict[str, np.ndarray]:
    """What `made` returns, from the cache where it was made of the same content before; a cache that cannot be
    written is not a failure."""
    path = cache_directory() / folder / f"{hashlib.sha256(content).hexdigest()}.npz"
    try:
        return input_file.arrays(path)
    except input_file.Unreadable:
        arrays = made()
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        unfinished = path.with_suffix(f".{os.getpid()}.npz")
        np.savez(unfinished, **arrays)  # type: ignore[arg-type]
        os.replace(unfinished, path)
    except OSError:
        pass
    return arrays
