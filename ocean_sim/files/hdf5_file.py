"""Data sets of HDF5 files: their type and size are judged by what the file declares, before anything is unpacked."""

from math import prod
from typing import Any

import numpy as np

from ocean_sim.files.input_file import MOST_BYTES, Rule

NUMBERS, WORDS = "iuf", "SO"  # kinds of NumPy types
MAX_WORDS = 1000
DECLARED = Rule(
    f"a data set lies in the file itself, holds what its name says and unpacks to at most {MOST_BYTES / 1e6:g} MB"
)


def data_set(group: Any, name: str, kinds: str = NUMBERS, most: int = MOST_BYTES) -> np.ndarray:
    """The content of a data set of these kinds of at most so many bytes; raises ValueError, and what HDF5 raises of a
    damaged file."""
    import h5py

    own = isinstance(group.get(name, getlink=True), h5py.HardLink)  # a link leads to any file, or to itself
    found = group[name] if own else None
    if not isinstance(found, h5py.Dataset) or found.shape is None:
        raise ValueError(f"it has no data set {name}")
    if found.external or found.is_virtual:
        raise ValueError(f"the numbers of {name} lie in another file")
    word = h5py.check_string_dtype(found.dtype) is not None
    if found.dtype.kind not in kinds or (found.dtype.kind == "O" and not word):
        raise ValueError(f"{name} holds {found.dtype}")
    size = max(prod(found.shape), prod(found.chunks or ())) * found.dtype.itemsize
    if size > most or (word and found.size > MAX_WORDS):
        raise ValueError(f"{name} unpacks to {size / 1e6:g} MB")
    return np.asarray(found[()])
