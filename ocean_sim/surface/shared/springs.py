"""The springs of a sheet (thesis figure 3-3): stretch, shear and bend, as steps from node to node."""

import numpy as np

STRETCH = ((1, 0), (0, 1))  # nodes along x and z from a node to the other end
SHEAR = ((1, 1), (1, -1))
BEND = ((2, 0), (0, 2))
KINDS = {"stretch": STRETCH, "shear": SHEAR, "bend": BEND}


def springs(nx: int, nz: int) -> dict[str, np.ndarray]:
    """(m, 2) ends of every spring of a sheet of nx by nz nodes, by kind; node (i, k) has the number i nz + k.

    There are nx (nz - 1) + nz (nx - 1) stretch, 2 (nx - 1)(nz - 1) shear and nx (nz - 2) + nz (nx - 2) bend springs.
    """
    number = np.arange(nx * nz).reshape(nx, nz)
    found = {}
    for kind, steps in KINDS.items():
        ends = []
        for i, k in steps:
            here = number[: max(nx - i, 0), max(-k, 0) : nz - max(k, 0) if nz > k else 0]
            there = number[i:, max(k, 0) : nz + min(k, 0)]
            ends.append(np.stack([here.ravel(), there.ravel()], axis=1))
        found[kind] = np.concatenate(ends)
    return found
