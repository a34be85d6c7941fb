"""Cache for arrays that are slow to compute, keyed by the hash of their input and of the source files."""

import hashlib
import os
from collections.abc import Callable
from contextlib import suppress

import numpy as np

from ocean_sim.files import input_file
from ocean_sim.files.atomic_file import atomic_write
from ocean_sim.machine import cache_directory, source_hashes

MAX_FOLDER_BYTES = 300_000_000  # of a folder; beyond them what was not used for the longest time goes


def cached_arrays(
    folder: str, content: bytes, made: Callable[[], dict[str, np.ndarray]], *asked: type
) -> dict[str, np.ndarray]:
    """Arrays by name: a copy cached in `folder`, else the result of `made()`, which is then cached. A copy is valid for
    equal input bytes, `content`, and equal source files of the packages of `made` and of the classes `asked`."""
    packages = tuple(f"{each.__module__.split('.')[1]}/" for each in (made, *asked))
    laws = [item for item in source_hashes().items() if item[0].startswith(packages)]
    path = cache_directory() / folder / f"{hashlib.sha256(repr(laws).encode() + content).hexdigest()}.npz"
    with suppress(input_file.Unreadable):
        arrays = input_file.read_npz(path)
        with suppress(OSError):
            os.utime(path)
        return arrays
    arrays = made()
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        with atomic_write(path) as draft:
            np.savez(draft, **arrays)  # type: ignore[arg-type]
        stored = ((each.stat(), each) for each in path.parent.glob("*.npz"))
        files = sorted(stored, key=lambda file: -file[0].st_mtime_ns)
        for (_, old), size in zip(files, np.cumsum([stat.st_size for stat, _ in files]), strict=True):
            if size > MAX_FOLDER_BYTES:
                old.unlink(missing_ok=True)
    return arrays
