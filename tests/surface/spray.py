"""Particles that lie outside a surface by marching cubes."""

import numpy as np

from ocean_sim.kernel_library import ti, tm
from ocean_sim.surface.marching_cubes import MarchingCubes


def spray(surface: MarchingCubes) -> np.ndarray:
    """(n,) True for particles, in storage order, that lie outside the surface drawn."""
    surface.update_field()
    lonely = np.empty(surface.map.particles.count.now, dtype=np.int32)
    find_spray(surface, lonely)
    return lonely.astype(bool)


@ti.kernel
def find_spray(surface: ti.template(), lonely: ti.types.ndarray(ndim=1)):  # type: ignore[valid-type]
    for i in range(lonely.shape[0]):
        p = surface.map.particles.position
        lonely[i] = int(surface.map.shares_along(tm.vec3(p.x[i], p.y[i], p.z[i]), 0.0, 1)[0] < surface.isovalue)
