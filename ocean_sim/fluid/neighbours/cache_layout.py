"""Fields that are read and written together, laid out for a processor's cache.

A processor keeps a line of memory only next to few others that lie as far from the beginning of their pages as it does.
Of fields as long as some pages, as those of 1024 particles are, all that belongs to one particle would lie equally far.
"""

from typing import Any

import numpy as np

from ocean_sim.kernel_library import ti, to_numpy_type

PAGE, LINE = 4096, 64  # [bytes]
GAP = ti.i32


def staggered(dtype: Any, n: int) -> Any:
    """A field of n numbers, and of a page or more so long that the next begins an odd number of lines further: the 64
    of a page are all passed before one comes again."""
    field = ti.field(dtype, shape=n)
    taken = n * np.dtype(to_numpy_type(field.dtype)).itemsize
    if taken >= PAGE and (gap := (LINE - taken) % (2 * LINE)):
        ti.field(GAP, shape=gap // np.dtype(to_numpy_type(GAP)).itemsize)
    return field
