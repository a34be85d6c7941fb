"""Fields that are read and written together, laid out for a processor's cache.

A processor keeps a line of memory only next to few others that lie as far from the beginning of their pages as it does.
Of fields as long as some pages, as those of 1024 particles are, all that belongs to one particle would lie equally far.
"""

from typing import Any

import numpy as np

from ocean_sim.kernel_library import ti, to_numpy_type

PAGE = 4096  # [bytes]
FURTHER = 320  # [bytes] five lines of a cache: the 64 in a page are all passed before one comes again
GAP = ti.i32


def staggered(dtype: Any, n: int) -> Any:
    """A field of n numbers, behind which the next begins FURTHER along its page than this one does."""
    field = ti.field(dtype, shape=n)
    bytes_left = (FURTHER - n * np.dtype(to_numpy_type(field.dtype)).itemsize) % PAGE
    if bytes_left > 0:
        ti.field(GAP, shape=bytes_left // np.dtype(to_numpy_type(GAP)).itemsize)
    return field
